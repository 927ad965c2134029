//! Measures the points of a run, each relative to independent random points.

use ldwrap::{Progress, SurfaceMesh, SurfacePoint};
use serde::{Deserialize, Serialize};

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Measure {
    /// The energy discrepancy.
    Energy,
    /// How much area each point stands for, place by place.
    Local,
}

impl Measure {
    /// All, in the order in which they are shown; quick ones first.
    pub const ALL: [Self; 2] = [Self::Energy, Self::Local];

    /// What a person reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Energy => "Energy",
            Self::Local => "Local",
        }
    }

    /// What it says, in a sentence.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Energy => "Error of the share of points on one side of any plane, over all planes.",
            Self::Local => "How much area each point stands for; shown as colours.",
        }
    }
}

/// What a measure says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The error over that of independent random points of the same number: 1 is random, smaller is better.
    pub error: Option<f64>,
    /// Further numbers, in words.
    pub note: String,
    /// For each triangle the area that the point nearest to it stands for, over what it should be; empty for
    /// measures that are not local.
    pub local: Vec<f32>,
}

/// Measures points.
pub fn judge(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    measure: Measure,
    progress: &dyn Progress,
) -> Verdict {
    let _ = (mesh, points, measure, progress);
    Verdict::default()
}
