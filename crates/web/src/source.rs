//! Where a mesh comes from: a built-in shape, or the bytes of a person's file.

use ldwrap::shapes::Shape;
use ldwrap::{CheckOptions, PolygonSoup, RepairReport, SurfaceMesh};
use serde::{Deserialize, Serialize};

/// A mesh to load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Source {
    /// A built-in shape.
    #[serde(with = "by_name")]
    Shape(Shape),
    /// A file: its name says the format.
    File {
        /// Its name, with the extension.
        name: String,
        /// Its bytes.
        bytes: Vec<u8>,
    },
}

impl Source {
    /// What a person calls it.
    pub fn name(&self) -> &str {
        match self {
            Self::Shape(shape) => shape.name(),
            Self::File { name, .. } => name,
        }
    }

    /// Reads and checks it.
    ///
    /// # Errors
    /// What is wrong with it, for a person.
    pub fn load(&self) -> Result<(SurfaceMesh, RepairReport), String> {
        let soup = match self {
            Self::Shape(shape) => shape.generate(),
            Self::File { name, bytes } => read(name, bytes)?,
        };
        SurfaceMesh::from_soup(&soup, &CheckOptions::default()).map_err(|e| format!("{}: {e}", self.name()))
    }
}

/// Reads the bytes of a mesh file; the name's extension says the format.
///
/// # Errors
/// What is wrong, for a person.
pub fn read(name: &str, bytes: &[u8]) -> Result<PolygonSoup, String> {
    let alone =
        |address: &str| Err(format!("{address} lies beside the file: open a .glb, which holds everything"));
    ldwrap::io::read_mesh(bytes, Some(name), &alone).map_err(|e| format!("{name}: {e}"))
}

/// Shapes are sent by their names.
mod by_name {
    use ldwrap::shapes::Shape;
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::ser::Serializer;

    pub(super) fn serialize<S: Serializer>(shape: &Shape, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(shape.name())
    }

    pub(super) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Shape, D::Error> {
        String::deserialize(from)?.parse().map_err(D::Error::custom)
    }
}
