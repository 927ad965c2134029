//! Chains the stages and keeps every value; no logic of its own.

use crate::correct::Correction;
use crate::domain::PlanarDomain;
use crate::equalize::{EqualizeOptions, EqualizeReport, equalize};
use crate::irregularity::{Irregularity, irregularity};
use crate::mesh::SurfaceMesh;
use crate::progress::Progress;
use crate::request::{Scattered, Scattering};
use crate::sample::{Origin, Sample};
use crate::segment::{SegmentOptions, Segmentation, segment};
use crate::sequence::{self, Sequence, SequenceError};
use crate::unfold::{Strips, unfold};

pub use crate::request::Request;

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
    /// The sequence does not exist.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// More points of the planar domain would be needed than memory is spent on.
    #[error("{wanted:.3e} points of the planar domain are needed, which is too many: ask for fewer points")]
    TooMany {
        /// How many.
        wanted: f64,
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
    check(options)?;
    let stage = |name| {
        progress.begin(name, 1);
        if progress.is_cancelled() { Err(OptionsError::Cancelled) } else { Ok(()) }
    };
    stage("segment")?;
    let segmentation = segment(mesh, &options.segment);
    stage("unfold")?;
    let strips = unfold(mesh, &segmentation);
    let domain = PlanarDomain::lay_out(&strips);
    stage("wrap")?;
    let scattering = Scattering {
        mesh,
        strips: &strips,
        domain: &domain,
        sequence: options.sequence,
        shift: sequence::shift_of_seed(options.seed),
        tolerance: options.tolerance,
    };
    let Scattered { samples, correction, d_m } = scattering.meet(options.request)?;
    stage("irregularity")?;
    let irregularity = irregularity(&strips, d_m, options.tolerance * d_m);
    let (samples, equalize) = match &options.equalize {
        None => (samples, None),
        Some(options) => {
            stage("equalize")?;
            let (samples, report) = equalize_samples(mesh, &strips, &domain, samples, options, progress);
            (samples, Some(report))
        }
    };
    if progress.is_cancelled() {
        return Err(OptionsError::Cancelled);
    }
    Ok(Run { segmentation, strips, domain, correction, irregularity, equalize, d_m, samples })
}

/// Equalizes samples: those that moved lie in the planar domain where their new face lies.
fn equalize_samples(
    mesh: &SurfaceMesh,
    strips: &Strips,
    domain: &PlanarDomain,
    samples: Vec<Sample>,
    options: &EqualizeOptions,
    progress: &dyn Progress,
) -> (Vec<Sample>, EqualizeReport) {
    let points: Vec<_> = samples.iter().map(|s| s.point).collect();
    let strip_of_face: Vec<_> = strips.places.iter().map(|p| p.strip).collect();
    let equalized = equalize(mesh, &points, &strip_of_face, options, progress);
    let samples = equalized.points.into_iter().zip(samples).map(|(point, before)| {
        let (strip, place) = strips.lay_point(&point);
        // What the correction moved stays known: equalizing keeps the order of the points.
        let origin = if before.origin == Origin::Projected { Origin::Projected } else { Origin::Equalized };
        Sample { point, strip, place: place + domain.offsets[strip.index()], origin }
    });
    (samples.collect(), equalized.report)
}

fn check(options: &Options) -> Result<(), OptionsError> {
    options.sequence.validate()?;
    let finite = |name, value: f64, ok: bool, allowed| {
        if ok { Ok(()) } else { Err(OptionsError::OutOfRange { name, value: value.to_string(), allowed }) }
    };
    let SegmentOptions { flatness_angle, smallest_share, order: _ } = options.segment;
    let half_turn = std::f64::consts::PI;
    finite(
        "flatness angle",
        flatness_angle,
        (0.0..=half_turn).contains(&flatness_angle),
        "from 0 to pi radians",
    )?;
    finite("smallest share", smallest_share, (0.0..=1.0).contains(&smallest_share), "from 0 to 1")?;
    finite(
        "tolerance",
        options.tolerance,
        (0.0..=1.0).contains(&options.tolerance),
        "from 0 to 1 (in units of d_m)",
    )
}
