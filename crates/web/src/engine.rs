//! Does the work: jobs in, answers out. It runs in a thread or a web worker, never in the page itself, and keeps the
//! mesh and the runs between jobs.

use ldwrap::baseline;
use ldwrap::pipeline::{self, OptionsError, Run};
use ldwrap::{FaceId, Progress, RepairReport, Sample, SurfaceMesh, SurfacePoint};
use serde::{Deserialize, Serialize};

use crate::export::{self, Export};
use crate::figure::{self, Figure};
use crate::judge::{self, Measure, Verdict};
use crate::look::{Look, Looker, Looking};
use crate::report;
use crate::scene::{MeshScene, RunScene};
use crate::settings::{Method, Settings};
use crate::source::Source;

/// One of the two runs that are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Slot {
    /// The first, always shown.
    #[default]
    A,
    /// The second, shown when comparing.
    B,
}

impl Slot {
    /// Both.
    pub const ALL: [Self; 2] = [Self::A, Self::B];

    /// Its place in an array of two.
    pub fn index(self) -> usize {
        self as usize
    }

    /// What a person reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

/// Work to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Job {
    /// Read and check a mesh; the runs are forgotten when it holds.
    Load(Source),
    /// Place points.
    Wrap(Slot, Settings),
    /// Measure the points of a run.
    Judge(Slot, Measure),
    /// Grow a sample figure of this many rings around a triangle.
    Grow(Slot, u32, u32),
    /// Make a file.
    Export(Slot, Export),
    /// Take over points that another engine made of the same mesh.
    Place(Slot, Vec<(u32, [f64; 3])>),
    /// Find what a camera sees of the surface and of the points of both runs.
    Look(Looking),
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// Where the work stands: the stage, and the share done of it when known.
    Progress(String, Option<f32>),
    /// A mesh was loaded.
    Loaded(Box<MeshScene>),
    /// Points were placed.
    Wrapped(Slot, Box<RunScene>),
    /// Points were measured.
    Judged(Slot, Measure, Verdict),
    /// A sample figure was grown.
    Grown(Slot, Figure),
    /// A file was made: its name and bytes.
    Exported(String, Vec<u8>),
    /// What a camera saw.
    Looked(Look),
    /// A job failed, with the reason for a person; everything is as it was before.
    Failed(String),
    /// The caller cancelled.
    Cancelled,
}

/// The stage that answers [`Job::Place`].
pub const PLACED: &str = "placed";

/// Keeps the mesh and the runs between jobs.
#[derive(Default)]
pub struct Engine {
    loaded: Option<Loaded>,
    looker: Option<Looker>,
}

struct Loaded {
    name: String,
    mesh: SurfaceMesh,
    repaired: RepairReport,
    placed: [Option<Placed>; 2],
}

/// The points of a slot and what they came from.
pub(crate) struct Placed {
    pub(crate) points: Vec<SurfacePoint>,
    pub(crate) made: Option<Made>,
}

/// A run that this engine made itself.
pub(crate) struct Made {
    pub(crate) run: Run,
    pub(crate) scene: RunScene,
}

impl Engine {
    /// Does a job. `clock` gives seconds since any fixed time.
    pub fn handle(&mut self, job: Job, progress: &dyn Progress, clock: &dyn Fn() -> f64) -> Answer {
        match self.try_handle(job, progress, clock) {
            Ok(_) if progress.is_cancelled() => Answer::Cancelled,
            Ok(answer) => answer,
            Err(_) if progress.is_cancelled() => Answer::Cancelled,
            Err(reason) => Answer::Failed(reason),
        }
    }

    fn try_handle(
        &mut self,
        job: Job,
        progress: &dyn Progress,
        clock: &dyn Fn() -> f64,
    ) -> Result<Answer, String> {
        if let Job::Load(source) = job {
            progress.begin("load", 1);
            let (mesh, repaired) = source.load()?;
            let scene = MeshScene::new(&source, &mesh, &repaired);
            self.looker = None;
            self.loaded =
                Some(Loaded { name: source.name().to_owned(), mesh, repaired, placed: [None, None] });
            return Ok(Answer::Loaded(Box::new(scene)));
        }
        let loaded = self.loaded.as_mut().ok_or("no mesh is loaded")?;
        match job {
            Job::Load(_) => Err("loaded already".into()),
            Job::Wrap(slot, settings) => {
                let made = make(&loaded.mesh, &loaded.repaired, settings, progress, clock)?;
                let points = made.run.samples.iter().map(|s| s.point).collect();
                let scene = Box::new(made.scene.clone());
                loaded.placed[slot.index()] = Some(Placed { points, made: Some(made) });
                Ok(Answer::Wrapped(slot, scene))
            }
            Job::Judge(slot, measure) => {
                let points = &loaded.placed(slot)?.points;
                Ok(Answer::Judged(slot, measure, judge::judge(&loaded.mesh, points, measure, progress)))
            }
            Job::Grow(slot, seed, rings) => {
                let made = loaded.made(slot)?;
                if seed as usize >= loaded.mesh.face_count() {
                    return Err(format!("there is no triangle {seed}"));
                }
                Ok(Answer::Grown(slot, figure::grow(&loaded.mesh, &made.scene, seed, rings)))
            }
            Job::Export(slot, what) => {
                let made = loaded.made(slot)?;
                let bytes = export::export(&loaded.mesh, made, what)?;
                Ok(Answer::Exported(export::file_name(&loaded.name, what), bytes))
            }
            Job::Place(slot, points) => {
                let points = points
                    .into_iter()
                    .map(|(face, barycentric)| SurfacePoint { face: FaceId(face), barycentric })
                    .filter(|p| p.face.index() < loaded.mesh.face_count())
                    .collect();
                loaded.placed[slot.index()] = Some(Placed { points, made: None });
                Ok(Answer::Progress(PLACED.into(), None))
            }
            Job::Look(looking) => {
                let looker = self.looker.get_or_insert_with(|| Looker::new(&loaded.mesh));
                let points =
                    Slot::ALL.map(|slot| loaded.placed[slot.index()].as_ref().map(|p| p.points.as_slice()));
                Ok(Answer::Looked(looker.look(&loaded.mesh, points, &looking)))
            }
        }
    }
}

impl Loaded {
    fn placed(&self, slot: Slot) -> Result<&Placed, String> {
        self.placed[slot.index()].as_ref().ok_or_else(|| format!("{} holds no points yet", slot.name()))
    }

    fn made(&self, slot: Slot) -> Result<&Made, String> {
        self.placed(slot)?.made.as_ref().ok_or_else(|| format!("the run of {} is elsewhere", slot.name()))
    }
}

/// Runs the pipeline; a baseline's points take the place of the wrapped ones, on the same strips.
pub(crate) fn make(
    mesh: &SurfaceMesh,
    repaired: &RepairReport,
    settings: Settings,
    progress: &dyn Progress,
    clock: &dyn Fn() -> f64,
) -> Result<Made, String> {
    let start = clock();
    let options = settings.options();
    let mut run = pipeline::run(mesh, &options, progress).map_err(|e| match e {
        OptionsError::Cancelled => "cancelled".to_owned(),
        other => other.to_string(),
    })?;
    if let Some(points) = rival(mesh, settings.method, run.samples.len(), settings.seed) {
        run.samples = points.into_iter().map(|point| on_strips(&run, point)).collect();
        run.correction.projected = 0;
        run.correction.removed = 0;
    }
    let seconds = clock() - start;
    let irregularity = run.irregularity();
    let report = report::of_run(mesh, repaired, &options, &run, irregularity, seconds);
    let report = serde_json::to_string_pretty(&report).map_err(|e| e.to_string())?;
    let scene = RunScene::new(mesh, &run, irregularity, seconds, report);
    Ok(Made { run, scene })
}

/// The points of a baseline; `None` for the methods that wrap.
fn rival(mesh: &SurfaceMesh, method: Method, count: usize, seed: u64) -> Option<Vec<SurfacePoint>> {
    match method {
        Method::Wrap | Method::Paper => None,
        Method::Random => Some(baseline::random(mesh, count, seed)),
        Method::Hilbert => Some(baseline::hilbert(mesh, count, seed)),
        Method::Poisson => Some(baseline::poisson(mesh, count, seed)),
    }
}

/// A surface point with its place on the strips.
fn on_strips(run: &Run, point: SurfacePoint) -> Sample {
    let place = run.strips.places[point.face.index()];
    let [a, b, c] = run.strips.strips[place.strip.index()].triangle(place.index as usize);
    let [u, v, w] = point.barycentric;
    let at = a * u + b * v + c * w + run.domain.offsets[place.strip.index()];
    Sample { point, strip: place.strip, place: at, origin: ldwrap::Origin::Wrapped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ldwrap::Silent;
    use ldwrap::shapes::Shape;

    fn answer(engine: &mut Engine, job: Job) -> Answer {
        engine.handle(job, &Silent, &|| 0.0)
    }

    #[test]
    fn a_broken_file_leaves_the_old_mesh_in_place() {
        let mut engine = Engine::default();
        assert!(matches!(answer(&mut engine, Job::Load(Source::Shape(Shape::Sphere))), Answer::Loaded(_)));
        let broken = Source::alone("broken.obj".into(), b"f 1 2 3".to_vec());
        let Answer::Failed(reason) = answer(&mut engine, Job::Load(broken)) else {
            panic!("a broken file was read")
        };
        assert!(reason.contains("broken.obj"), "{reason}");
        let Answer::Wrapped(Slot::A, run) = answer(&mut engine, Job::Wrap(Slot::A, Settings::default()))
        else {
            panic!("the sphere is gone")
        };
        assert_eq!(run.points.len(), 1000);
    }

    #[test]
    fn a_figure_of_no_ring_is_one_triangle_and_one_part() {
        let mut engine = Engine::default();
        answer(&mut engine, Job::Load(Source::Shape(Shape::Sphere)));
        answer(&mut engine, Job::Wrap(Slot::A, Settings::default()));
        let Answer::Grown(_, figure) = answer(&mut engine, Job::Grow(Slot::A, 5, 0)) else {
            panic!("not grown")
        };
        assert_eq!((figure.faces.as_slice(), figure.degree), ([(5, 0)].as_slice(), 1));
        let Answer::Grown(_, all) = answer(&mut engine, Job::Grow(Slot::A, 5, 1000)) else {
            panic!("not grown")
        };
        assert_eq!(all.faces.len(), 760);
        assert!((all.area_share - 1.0).abs() < 1e-9 && (all.point_share - 1.0).abs() < 1e-9);
        assert!(all.degree >= 1);
    }

    #[test]
    fn work_without_a_mesh_says_so() {
        let Answer::Failed(reason) = answer(&mut Engine::default(), Job::Judge(Slot::A, Measure::Energy))
        else {
            panic!("no failure")
        };
        assert!(reason.contains("no mesh"), "{reason}");
    }
}
