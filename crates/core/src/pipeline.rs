//! Chains the stages and keeps every value; no logic of its own.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::correct::Correction;
use crate::density::Density;
use crate::domain::PlanarDomain;
use crate::equalize::{Allotment, EqualizeOptions, EqualizeReport, Equalized, equalize_allotted};
use crate::ids::FaceId;
use crate::irregularity::{Irregularity, irregularity};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::progressive::progressive;
use crate::request::{Points, Scattered, Scattering};
use crate::sample::{Origin, Sample};
use crate::segment::{SegmentOptions, Segmentation, segment, segment_for};
use crate::sequence::{self, Sequence, SequenceError};
use crate::unfold::{Strips, unfold};

pub use crate::request::Request;
pub use crate::selection::{SampleOrder, Selection};

/// Everything that decides the points, besides the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Options {
    /// How many points. Default: exactly 1,000.
    pub request: Request,
    /// How the surface is cut.
    pub segment: SegmentOptions,
    /// The point set on the planar domain.
    pub sequence: Sequence,
    /// Shifts the point set (Cranley-Patterson rotation); 0 leaves it as it is.
    pub seed: u64,
    /// How the points are chosen among those that wrapping gives. Default: the most central of regions of equal mass.
    pub selection: Selection,
    /// Interstices and overlaps thinner than this many d_m are corrected (paper, 4.2 step 5). Default: 0.1.
    pub tolerance: f64,
    /// Equalize after the correction; `None` gives the paper's result. Default: `None` in the library until asked.
    pub equalize: Option<EqualizeOptions>,
    /// In which order the points are. Default: that of the sequence.
    pub order: SampleOrder,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            request: Request::Count(1000),
            segment: SegmentOptions::default(),
            sequence: Sequence::default(),
            seed: 0,
            selection: Selection::default(),
            tolerance: 0.1,
            equalize: None,
            order: SampleOrder::default(),
        }
    }
}

impl Options {
    /// Checks what can be checked without a mesh.
    ///
    /// # Errors
    /// [`OptionsError`] when an option is out of range or two exclude each other.
    pub fn validate(&self) -> Result<(), OptionsError> {
        self.sequence.validate()?;
        if self.selection == Selection::Extensible {
            match self.sequence {
                Sequence::Hammersley { .. } => {
                    return Err(OptionsError::NotExtensible { sequence: "Hammersley" });
                }
                Sequence::Fibonacci => return Err(OptionsError::NotExtensible { sequence: "Fibonacci" }),
                Sequence::Halton { .. } | Sequence::Sobol { .. } | Sequence::R2 => {}
            }
            if self.equalize.is_some() {
                return Err(OptionsError::Extensible { what: "equalized" });
            }
            if self.order == SampleOrder::Progressive {
                return Err(OptionsError::Extensible { what: "put in another order" });
            }
        }
        let finite = |name, value: f64, ok: bool, allowed| {
            if ok {
                Ok(())
            } else {
                Err(OptionsError::OutOfRange { name, value: value.to_string(), allowed })
            }
        };
        let for_views = self.equalize.and_then(|equalize| equalize.for_views);
        if let Some((name, value, allowed)) = for_views.and_then(|views| views.fault()) {
            return Err(OptionsError::OutOfRange { name, value, allowed });
        }
        let SegmentOptions { flatness_angle, smallest_share, order: _ } = self.segment;
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
            self.tolerance,
            (0.0..=1.0).contains(&self.tolerance),
            "from 0 to 1 (in units of d_m)",
        )
    }
}

/// The value of every stage.
#[derive(Clone, Debug)]
pub struct Run<S = Vec<Sample>> {
    /// Which triangles form a segment.
    pub segmentation: Segmentation,
    /// The segments in the plane.
    pub strips: Strips,
    /// Where the strips lie.
    pub domain: PlanarDomain,
    /// What wrapping and the correction did.
    pub correction: Correction,
    /// What equalizing did, if it was asked for.
    pub equalize: Option<EqualizeReport>,
    /// The mean distance between neighbours, sqrt(area / number of points), in units of the mesh.
    pub d_m: f64,
    /// Cuts whose gap is at most this were closed, in units of the mesh.
    pub tolerance: f64,
    /// The points; where they were handed on, how many there were.
    pub samples: S,
}

/// The value of every stage but the points, which were handed on.
pub type Streamed = Run<usize>;

impl<S> Run<S> {
    /// The irregularity ratios at the distance of the points (paper, 4.3). No stage needs them, so they are computed
    /// when asked for; see [`irregularity()`](irregularity()) for the cost.
    pub fn irregularity(&self) -> Irregularity {
        irregularity(&self.strips, self.d_m, self.tolerance)
    }

    /// The same with others in place of the points, and those.
    fn with<T>(self, samples: T) -> (Run<T>, S) {
        let Self { segmentation, strips, domain, correction, equalize, d_m, tolerance, samples: before } =
            self;
        (Run { segmentation, strips, domain, correction, equalize, d_m, tolerance, samples }, before)
    }
}

impl Run {
    /// The points apart from all else.
    pub fn split(self) -> (Streamed, Vec<Sample>) {
        let count = self.samples.len();
        self.with(count)
    }
}

/// Some of the points of a request, which follow on those of the block before.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// The points of this block.
    pub samples: &'a [Sample],
    /// How many points there are in all blocks.
    pub count: usize,
}

/// Why points were not all handed on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StreamError<E> {
    /// There are none, or the caller cancelled.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// Whoever takes them refused a block.
    #[error("{0}")]
    Sink(E),
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
    #[error(
        "{wanted:.3e} points of the planar domain are needed, which is too many: ask for fewer points; parts far \
         longer than wide need the most"
    )]
    TooMany {
        /// How many.
        wanted: f64,
    },
    /// A sequence whose points depend on their number cannot be extended.
    #[error(
        "the points of {sequence} depend on their number and cannot be extended: use Halton, Sobol or R2"
    )]
    NotExtensible {
        /// The sequence.
        sequence: &'static str,
    },
    /// What cannot be combined with extensible points, because it looks at all of them.
    #[error("extensible points cannot be {what}: that depends on how many there are")]
    Extensible {
        /// What was asked for.
        what: &'static str,
    },
    /// The caller cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// Runs all stages on a mesh. `progress` hears the stages' names: `segment`, `unfold`, `wrap`, `equalize`,
/// `order`. Of an exact number of points a part of equalizing is done beside `unfold` and `wrap`.
///
/// # Errors
/// [`OptionsError`] when an option is out of range or the caller cancelled.
pub fn run(mesh: &SurfaceMesh, options: &Options, progress: &dyn Progress) -> Result<Run, OptionsError> {
    run_weighted(mesh, &Density::UNIFORM, options, progress)
}

/// As [`run`], with points in proportion to a density of the mesh. Unfolding stays congruent; where `d_m` stands for a
/// length, it is that of places of mean density.
///
/// Exact counts are met whatever the weights. Places more than some times denser than the mean (four times for 100,000
/// points, thousands of times for 100) get fewer points than are due before equalizing.
///
/// # Errors
/// As [`run`].
///
/// # Panics
/// If the density was made for a mesh with fewer faces.
pub fn run_weighted(
    mesh: &SurfaceMesh,
    density: &Density,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Run, OptionsError> {
    let made: Result<_, OptionsError> =
        stages(mesh, density, options, progress, |points| Ok(points.into_samples()));
    let (streamed, samples) = made?;
    Ok(streamed.with(samples).0)
}

/// As [`run_weighted`], but the points are handed on in blocks of some 100,000, in their order, as they are made: never are
/// all of them there, unless equalizing or the progressive order needs them. `sink` hears at least one block, which is empty
/// if there are no points. Without either, the peak of memory is about 32 bytes a point and what the stages take of the mesh
/// where the points are those of a Hammersley set, ten times as much with other sequences, whose points are listed.
///
/// ```
/// use ldwrap::density::Density;
/// use ldwrap::pipeline::{Options, Request, run_into};
/// use ldwrap::{CheckOptions, Silent, SurfaceMesh, shapes};
///
/// let (mesh, _) = SurfaceMesh::from_soup(&shapes::cube(2), &CheckOptions::default())?;
/// let options = Options { request: Request::Count(300_000), ..Options::default() };
/// let mut sum = glam::DVec3::ZERO;
/// let streamed = run_into(&mesh, &Density::UNIFORM, &options, &Silent, |block| {
///     sum += block.samples.iter().map(|s| mesh.locate(&s.point)).sum::<glam::DVec3>() / block.count as f64;
///     Ok::<(), std::convert::Infallible>(())
/// })?;
/// assert_eq!(streamed.samples, 300_000);
/// let (low, high) = mesh.bounds();
/// assert!(sum.distance(0.5 * (low + high)) < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`run`], and the first error of `sink`, after which it is not called again.
///
/// # Panics
/// As [`run_weighted`].
pub fn run_into<E>(
    mesh: &SurfaceMesh,
    density: &Density,
    options: &Options,
    progress: &dyn Progress,
    mut sink: impl FnMut(Block<'_>) -> Result<(), E>,
) -> Result<Streamed, StreamError<E>> {
    let made: Result<_, StreamError<E>> = stages(mesh, density, options, progress, |points| {
        let count = points.count();
        let mut take = |samples: &[Sample]| {
            if progress.is_cancelled() {
                return Err(OptionsError::Cancelled.into());
            }
            sink(Block { samples, count }).map_err(StreamError::Sink)
        };
        if count == 0 {
            take(&[])?;
        }
        Ok(((), points.hand_on(take)?))
    });
    made.map(|(streamed, ())| streamed)
}

/// Runs all stages; `finish` makes what is wanted of the points, and says what the correction did to them.
fn stages<R, E: From<OptionsError>>(
    mesh: &SurfaceMesh,
    density: &Density,
    options: &Options,
    progress: &dyn Progress,
    finish: impl FnOnce(Points<'_>) -> Result<(R, Correction), E>,
) -> Result<(Streamed, R), E> {
    options.validate()?;
    // Extensible points are the same whatever their number, so nothing may depend on it.
    let tolerance = if options.selection == Selection::Extensible { 0.0 } else { options.tolerance };
    let stages = Stages { mesh, density, options, tolerance, progress };
    let segmentation = stages.segment()?;
    let planar;
    let (scattered, equalized) = match &options.equalize {
        None => {
            planar = stages.unfold(&segmentation)?;
            (stages.scatter(&planar)?, None)
        }
        Some(equalize) => {
            let (equalized, report);
            (planar, equalized, report) = parallel::inside(|| stages.equalize(&segmentation, equalize))?;
            (equalized, Some(report))
        }
    };
    let Scattered { mut points, d_m } = scattered;
    if options.order == SampleOrder::Progressive {
        stages.begin("order")?;
        let (samples, correction) = points.into_samples();
        let places: Vec<_> = samples.iter().map(|s| s.point).collect();
        let samples = progressive(mesh, &places).into_iter().map(|i| samples[i]).collect();
        points = Points::Made { samples, correction };
    }
    if progress.is_cancelled() {
        return Err(OptionsError::Cancelled.into());
    }
    let samples = points.count();
    let (made, correction) = finish(points)?;
    let (equalize, tolerance) = (equalized, tolerance * d_m);
    let Planar { strips, domain } = planar;
    let streamed = Run { segmentation, strips, domain, correction, equalize, d_m, tolerance, samples };
    Ok((streamed, made))
}

/// What every stage looks at.
struct Stages<'a> {
    mesh: &'a SurfaceMesh,
    density: &'a Density,
    options: &'a Options,
    /// In units of d_m.
    tolerance: f64,
    progress: &'a dyn Progress,
}

/// The surface in the plane.
struct Planar {
    strips: Strips,
    domain: PlanarDomain,
}

/// Up to so many triangles and so many points what equalizing allots is made while the surface is unfolded and points are
/// scattered. Beyond it takes too much memory at that time, and a count may be one that cannot be met at all.
const SIDE_BY_SIDE: usize = 300_000;

impl<'a> Stages<'a> {
    fn begin(&self, stage: &'static str) -> Result<(), OptionsError> {
        self.progress.begin(stage, 1);
        if self.progress.is_cancelled() { Err(OptionsError::Cancelled) } else { Ok(()) }
    }

    fn segment(&self) -> Result<Segmentation, OptionsError> {
        self.begin("segment")?;
        let Options { request, selection, segment: options, .. } = self.options;
        Ok(match *request {
            Request::Count(n) if *selection != Selection::Extensible => {
                let d_m = libm::sqrt(self.mesh.area() / n.max(1) as f64);
                segment_for(self.mesh, options, self.tolerance * d_m)
            }
            _ => segment(self.mesh, options),
        })
    }

    fn unfold(&self, segmentation: &Segmentation) -> Result<Planar, OptionsError> {
        self.begin("unfold")?;
        let strips = unfold(self.mesh, segmentation);
        let domain = PlanarDomain::lay_out(&strips);
        Ok(Planar { strips, domain })
    }

    fn scatter<'b>(&self, planar: &'b Planar) -> Result<Scattered<'b>, OptionsError>
    where
        'a: 'b,
    {
        self.begin("wrap")?;
        let Self { mesh, density, options, tolerance, .. } = *self;
        let scattering = Scattering {
            mesh,
            density,
            strips: &planar.strips,
            domain: &planar.domain,
            sequence: options.sequence,
            shift: sequence::shift_of_seed(options.seed),
            choice: options.selection.choice(options.equalize.is_some() && density.is_uniform()),
            tolerance,
        };
        scattering.meet(options.request)
    }

    /// All from unfolding to equalizing.
    fn equalize(
        &self,
        segmentation: &Segmentation,
        options: &EqualizeOptions,
    ) -> Result<(Planar, Scattered<'static>, EqualizeReport), OptionsError> {
        let Self { mesh, density, progress, .. } = *self;
        let scatter = || {
            let planar = self.unfold(segmentation)?;
            let Scattered { points, d_m } = self.scatter(&planar)?;
            Ok::<_, OptionsError>((points.into_samples(), d_m, planar))
        };
        // Where there are no points nothing is allotted to them, if it is known in time.
        let failed = AtomicBool::new(false);
        let allot = |n| Allotment::new(mesh, density, n, options);
        let (made, allotment) = match self.options.request {
            Request::Count(n) if (1..=SIDE_BY_SIDE).contains(&n) && mesh.face_count() <= SIDE_BY_SIDE => {
                let scatter = || scatter().inspect_err(|_| failed.store(true, Ordering::Relaxed));
                parallel::join(scatter, || (!failed.load(Ordering::Relaxed)).then(|| allot(n)))
            }
            _ => (scatter(), None),
        };
        let ((samples, correction), d_m, planar) = made?;
        self.begin("equalize")?;
        let points: Vec<_> = samples.iter().map(|s| s.point).collect();
        let equalized = if points.is_empty() {
            Equalized::nothing(options)
        } else {
            let allotment = allotment.filter(|allotment| allotment.count() == points.len());
            let allotment = allotment.unwrap_or_else(|| allot(points.len()));
            let strip_of_face = |face: FaceId| planar.strips.places[face.index()].strip;
            equalize_allotted(mesh, allotment, &points, strip_of_face, options, progress)
        };
        let sample = |i: usize| {
            let (point, before) = (equalized.points[i], &samples[i]);
            let (strip, place) = planar.strips.lay_point(&point);
            // What the correction moved stays known: equalizing keeps the order of the points.
            let origin =
                if before.origin == Origin::Projected { Origin::Projected } else { Origin::Equalized };
            Sample { point, strip, place: place + planar.domain.offsets[strip.index()], origin }
        };
        let samples = parallel::map(samples.len(), sample);
        Ok((planar, Scattered { points: Points::Made { samples, correction }, d_m }, equalized.report))
    }
}
