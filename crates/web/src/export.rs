//! Files to take away.

use ldwrap::SurfaceMesh;
use serde::{Deserialize, Serialize};

use crate::engine::Made;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Export {
    /// Points with normals and faces as PLY.
    Ply,
    /// Points as a table.
    Csv,
    /// Positions as a NumPy array.
    Npy,
    /// The strips as a picture.
    Svg,
    /// The report.
    Json,
}

impl Export {
    /// All, in the order in which they are offered.
    pub const ALL: [Self; 5] = [Self::Ply, Self::Csv, Self::Npy, Self::Svg, Self::Json];

    /// What a person reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => "Points, PLY",
            Self::Csv => "Points, CSV",
            Self::Npy => "Points, NPY",
            Self::Svg => "Strips, SVG",
            Self::Json => "Report, JSON",
        }
    }

    fn ending(self) -> &'static str {
        match self {
            Self::Ply => "-points.ply",
            Self::Csv => "-points.csv",
            Self::Npy => "-points.npy",
            Self::Svg => "-strips.svg",
            Self::Json => "-report.json",
        }
    }
}

/// The name of the file for a mesh.
pub fn file_name(mesh: &str, what: Export) -> String {
    let stem = mesh.rsplit_once('.').map_or(mesh, |(stem, _)| stem);
    format!("{stem}{}", what.ending())
}

/// Makes a file.
///
/// # Errors
/// What went wrong, for a person.
pub(crate) fn export(mesh: &SurfaceMesh, made: &Made, what: Export) -> Result<Vec<u8>, String> {
    let _ = mesh;
    match what {
        Export::Json => Ok(made.scene.report.clone().into_bytes()),
        _ => Err("not yet".into()),
    }
}
