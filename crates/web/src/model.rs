//! The page's whole state and everything that can happen to it; knows no window, no browser and no clock.
//!
//! The model never works itself: it puts jobs into three queues, one for each engine, and takes in their answers.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::Vec2;
use ldwrap::shapes::Shape;
use serde_json::{Value, json};

use crate::camera::{Orbit, PlaneView, Up};
use crate::engine::{Answer, Job, PLACED, Slot};
use crate::export::Export;
use crate::figure::Figure;
use crate::judge::{Measure, Verdict};
use crate::look::{Look, Looking, Occluder};
use crate::pick::Pick;
use crate::scene::{Layout, MeshScene, RunScene};
use crate::settings::{Link, Method, Settings};
use crate::source::Source;

/// Which engine a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Desk {
    /// Loads, wraps, makes files.
    Maker,
    /// Measures, so that a long measure keeps nobody waiting.
    Judge,
    /// Finds what the camera sees, many times a second.
    Looker,
}

/// What the judge has in hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Judging {
    /// Nothing.
    #[default]
    Idle,
    /// A mesh, points, or a measure that nobody waits for any more.
    Prepares,
    /// A measure.
    Measures(Slot, Measure),
}

/// What colours the triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colouring {
    /// Their strip.
    #[default]
    Strip,
    /// Whether points stand too dense or too thin around them.
    Local,
}

/// What is drawn besides the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown {
    /// The points.
    pub points: bool,
    /// The sides of all triangles.
    pub wireframe: bool,
    /// Cuts and borders.
    pub borders: bool,
    /// The band along the open border where the distribution is broken.
    pub band: bool,
}

/// What a person is told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// Something went well.
    Done(String),
    /// Something failed; everything else is as it was.
    Problem(String),
}

/// The share of points minus the share of surface that a view showed, for A and B.
pub type TrailStep = [Option<f64>; 2];

/// A file's name and bytes.
pub type NamedFile = (String, Vec<u8>);

/// The largest sample figure that the page offers.
pub const MOST_RINGS: u32 = 60;

/// How many views the trail remembers.
const TRAIL: usize = 160;

/// The state of the page.
#[derive(Debug)]
pub struct Model {
    /// The settings of both slots.
    pub settings: [Settings; 2],
    /// Whether B is shown beside A.
    pub comparing: bool,
    /// The mesh shown.
    pub mesh: Option<Arc<MeshScene>>,
    /// The runs shown.
    pub runs: [Option<Arc<RunScene>>; 2],
    /// What the measures said of them.
    pub verdicts: [Vec<(Measure, Verdict)>; 2],
    /// The camera of the surface view.
    pub orbit: Orbit,
    /// The view of the plane; `None` shows all.
    pub plane: Option<PlaneView>,
    /// How the strips are laid out.
    pub layout: Layout,
    /// What colours the triangles.
    pub colouring: Colouring,
    /// What is drawn.
    pub shown: Shown,
    /// What the pointer is on.
    pub hover: Option<Pick>,
    /// What was clicked.
    pub pinned: Option<Pick>,
    /// The sample figure around the pinned triangle.
    pub figure: Option<Figure>,
    /// How many rings it grows.
    pub rings: u32,
    /// The obstacle before the camera.
    pub occluder: Option<Occluder>,
    /// What the camera sees.
    pub look: Option<Look>,
    /// What it saw before.
    pub trail: VecDeque<TrailStep>,
    /// What the person is told.
    pub notice: Option<Notice>,
    /// Files made, to be saved.
    pub files: Vec<NamedFile>,
    /// Whether a picture of the views is to be saved.
    pub picture_wanted: bool,
    /// Where the work in hand stands.
    pub stage: Option<(String, Option<f32>)>,
    source: Option<Source>,
    loading: Option<Source>,
    queue: VecDeque<Job>,
    in_hand: Option<Job>,
    cancels: Vec<Desk>,
    wrapped: [Option<Settings>; 2],
    looker_queue: VecDeque<Job>,
    judge_queue: VecDeque<Job>,
    judging: Judging,
    /// What looker and judge are to load before they get points.
    unseen: Option<Source>,
    looked: Option<Looking>,
    looking: bool,
}

impl Default for Model {
    fn default() -> Self {
        let paper = Settings { method: Method::Paper, ..Settings::default() };
        Self {
            settings: [Settings::default(), paper],
            comparing: false,
            mesh: None,
            runs: [None, None],
            verdicts: [Vec::new(), Vec::new()],
            orbit: Orbit::around(glam::Vec3::ZERO, 1.0, Up::default()),
            plane: None,
            layout: Layout::default(),
            colouring: Colouring::default(),
            shown: Shown { points: true, wireframe: false, borders: true, band: false },
            hover: None,
            pinned: None,
            figure: None,
            rings: 4,
            occluder: None,
            look: None,
            trail: VecDeque::new(),
            notice: None,
            files: Vec::new(),
            picture_wanted: false,
            stage: None,
            source: None,
            loading: None,
            queue: VecDeque::new(),
            in_hand: None,
            cancels: Vec::new(),
            wrapped: [None, None],
            looker_queue: VecDeque::new(),
            judge_queue: VecDeque::new(),
            judging: Judging::default(),
            unseen: None,
            looked: None,
            looking: false,
        }
    }
}

impl Model {
    /// Starts with a link's shape and settings.
    pub fn open(link: Option<Link>) -> Self {
        let mut model = Self::default();
        let Link { shape, settings, other } = link.unwrap_or_default();
        model.settings[0] = settings;
        if let Some(other) = other {
            model.settings[1] = other;
            model.comparing = true;
        }
        model.load(Source::Shape(shape.parse().unwrap_or(Shape::Cup)));
        model
    }

    /// What a link to this page should hold.
    pub fn link(&self) -> Link {
        let shape = match &self.source {
            Some(Source::Shape(shape)) => shape.name().to_owned(),
            _ => String::new(),
        };
        let [settings, other] = self.settings.clone();
        Link { shape, settings, other: self.comparing.then_some(other) }
    }

    /// The built-in shape that is shown, if it is one.
    pub fn shape(&self) -> Option<Shape> {
        match self.loading.as_ref().or(self.source.as_ref())? {
            Source::Shape(shape) => Some(*shape),
            Source::File { .. } => None,
        }
    }

    /// Asks for another mesh; the one shown stays until the new one is checked.
    pub fn load(&mut self, source: Source) {
        self.queue.clear();
        self.cancels.extend(self.in_hand.is_some().then_some(Desk::Maker));
        self.loading = Some(source.clone());
        self.queue.push_back(Job::Load(source));
    }

    /// Asks for points wherever the settings changed. To be called when no control is being dragged.
    pub fn settle(&mut self) {
        if self.mesh.is_none() || self.loading.is_some() {
            return;
        }
        // Each goes before all that waits, so A goes last to be first.
        let slots: Vec<Slot> = self.slots().collect();
        for slot in slots.into_iter().rev() {
            let wanted = &self.settings[slot.index()];
            if self.wrapped[slot.index()].as_ref() != Some(wanted) {
                self.wrapped[slot.index()] = Some(wanted.clone());
                self.queue.retain(|job| !matches!(job, Job::Wrap(s, _) if *s == slot));
                if matches!(&self.in_hand, Some(Job::Wrap(s, _)) if *s == slot) {
                    self.cancels.push(Desk::Maker);
                }
                self.queue.push_front(Job::Wrap(slot, wanted.clone()));
                // Equalizing takes most of the time: while nothing is shown yet, what it starts from is shown first.
                if slot == Slot::A && self.runs[0].is_none() && wanted.equalizes() {
                    self.queue.push_front(Job::Wrap(slot, Settings { equalize: false, ..wanted.clone() }));
                }
            }
        }
    }

    /// The slots shown.
    pub fn slots(&self) -> impl Iterator<Item = Slot> + use<> {
        let comparing = self.comparing;
        Slot::ALL.into_iter().filter(move |s| comparing || *s == Slot::A)
    }

    /// Whether an engine works on something that the person waits for.
    pub fn is_busy(&self) -> bool {
        matches!(self.in_hand, Some(Job::Load(_) | Job::Wrap(..) | Job::Export(..))) || !self.queue.is_empty()
    }

    /// Gives up the work in hand and all that waits.
    pub fn cancel(&mut self) {
        self.queue.clear();
        self.loading = None;
        self.cancels.extend(self.in_hand.is_some().then_some(Desk::Maker));
    }

    /// The engines that are to be told to stop.
    pub fn take_cancels(&mut self) -> Vec<Desk> {
        std::mem::take(&mut self.cancels)
    }

    /// The jobs to post now, each to its engine.
    pub fn take_jobs(&mut self) -> Vec<(Desk, Job)> {
        let mut jobs: Vec<_> = self.looker_queue.drain(..).map(|job| (Desk::Looker, job)).collect();
        if self.in_hand.is_none()
            && let Some(job) = self.queue.pop_front()
        {
            self.in_hand = Some(job.clone());
            jobs.push((Desk::Maker, job));
        }
        if self.judging == Judging::Idle
            && let Some(job) =
                self.judge_queue.pop_front_if(|job| !is_replaced(job, &self.queue, &self.in_hand))
        {
            self.judging = match job {
                Job::Judge(slot, measure) => Judging::Measures(slot, measure),
                _ => Judging::Prepares,
            };
            jobs.push((Desk::Judge, job));
        }
        jobs
    }

    /// Asks what the camera sees, unless it was asked already. `aspect` is the width of the surface view over its
    /// height.
    pub fn watch(&mut self, aspect: f32) {
        let looking =
            Looking { eye: self.orbit.eye(), matrix: self.orbit.matrix(aspect), occluder: self.occluder };
        if self.mesh.is_some() && self.runs[0].is_some() && !self.looking && self.looked != Some(looking) {
            self.looked = Some(looking);
            self.looking = true;
            self.looker_queue.push_back(Job::Look(looking));
        }
    }

    /// Takes in what the looker answered.
    pub fn receive_look(&mut self, answer: Answer) {
        match answer {
            Answer::Looked(look) => {
                self.looking = false;
                self.trail.push_back(look.points.map(|p| p.map(|p| p - look.surface)));
                if self.trail.len() > TRAIL {
                    self.trail.pop_front();
                }
                self.look = Some(look);
            }
            Answer::Failed(_) | Answer::Cancelled => self.looking = false,
            _ => {}
        }
    }

    /// Takes in what the judge answered.
    pub fn receive_verdict(&mut self, answer: Answer) {
        match answer {
            Answer::Progress(stage, _) if stage != PLACED => return,
            // Of points that were replaced meanwhile nothing is kept.
            Answer::Judged(slot, measure, verdict) if self.judging == Judging::Measures(slot, measure) => {
                self.verdicts[slot.index()].push((measure, verdict));
            }
            Answer::Failed(reason) => self.notice = Some(Notice::Problem(reason)),
            _ => {}
        }
        self.judging = Judging::Idle;
    }

    /// Points were replaced: what is measured of them is of no use any more.
    fn stop_judging(&mut self, replaced: impl Fn(Slot) -> bool) {
        self.judge_queue
            .retain(|job| !matches!(job, Job::Judge(slot, _) | Job::Place(slot, _) if replaced(*slot)));
        if matches!(self.judging, Judging::Measures(slot, _) if replaced(slot)) {
            self.judging = Judging::Prepares;
            self.cancels.push(Desk::Judge);
        }
    }

    /// Takes in what the maker answered.
    pub fn receive(&mut self, answer: Answer) {
        if let Answer::Progress(stage, share) = answer {
            self.stage = Some((stage, share));
            return;
        }
        self.stage = None;
        let job = self.in_hand.take();
        match answer {
            Answer::Loaded(mesh) => self.accept_mesh(*mesh),
            Answer::Wrapped(slot, run) => self.accept_run(slot, *run),
            Answer::Grown(_, figure) => self.figure = Some(figure),
            Answer::Exported(name, bytes) => {
                self.notice = Some(Notice::Done(format!("saved {name}")));
                self.files.push((name, bytes));
            }
            Answer::Failed(reason) => {
                if matches!(job, Some(Job::Load(_))) {
                    self.loading = None;
                }
                self.notice = Some(Notice::Problem(reason));
            }
            Answer::Cancelled => {
                if let Some(Job::Wrap(slot, _)) = job
                    && self.loading.is_none()
                    && !self.queue.iter().any(|j| matches!(j, Job::Wrap(s, _) if *s == slot))
                {
                    self.notice = Some(Notice::Done("stopped; the points are those from before".into()));
                }
            }
            Answer::Progress(..) | Answer::Looked(_) | Answer::Judged(..) => {}
        }
    }

    fn accept_mesh(&mut self, mesh: MeshScene) {
        self.source = self.loading.take();
        // The others load it when there are points: until then the processor is the maker's.
        self.unseen = self.source.clone();
        self.stop_judging(|_| true);
        self.orbit = Orbit::around(mesh.centre, mesh.radius, mesh.up.0);
        self.rings = rings_for(mesh.report.faces);
        self.plane = None;
        self.runs = [None, None];
        self.verdicts = [Vec::new(), Vec::new()];
        self.wrapped = [None, None];
        (self.hover, self.pinned, self.figure, self.look, self.looked) = (None, None, None, None, None);
        self.trail.clear();
        self.notice = (!mesh.repaired.is_empty())
            .then(|| Notice::Done(format!("{} was repaired: {}", mesh.name, mesh.repaired.join(", "))));
        self.mesh = Some(Arc::new(mesh));
        self.settle();
    }

    fn accept_run(&mut self, slot: Slot, run: RunScene) {
        if let Some(source) = self.unseen.take() {
            self.looker_queue.push_back(Job::Load(source.clone()));
            self.judge_queue.push_back(Job::Load(source));
        }
        let points: Vec<_> = run.points.iter().map(|p| (p.face, p.barycentric)).collect();
        self.looker_queue.push_back(Job::Place(slot, points.clone()));
        self.stop_judging(|replaced| replaced == slot);
        self.judge_queue.push_back(Job::Place(slot, points));
        self.looked = None;
        self.trail.clear();
        self.verdicts[slot.index()].clear();
        for measure in Measure::ALL {
            self.judge_queue.push_back(Job::Judge(slot, measure));
        }
        if slot == Slot::A {
            self.hover = None;
            self.figure = None;
            // The point that was pinned is gone; its triangle is still there.
            self.pinned = self.pinned.map(|pick| Pick { point: None, ..pick });
            self.grow();
        }
        self.runs[slot.index()] = Some(Arc::new(run));
    }

    /// Pins what the pointer is on, or unpins by a click on nothing.
    pub fn pin(&mut self, pick: Option<Pick>) {
        self.pinned = pick;
        self.figure = None;
        self.grow();
    }

    /// Grows the sample figure around the pinned triangle.
    pub fn grow(&mut self) {
        if let Some(pick) = self.pinned
            && self.runs[0].is_some()
        {
            self.queue.retain(|job| !matches!(job, Job::Grow(..)));
            self.queue.push_front(Job::Grow(Slot::A, pick.face, self.rings));
        }
    }

    /// Pins the next (or the previous) point, so that all are reached by the keyboard.
    pub fn pin_neighbour(&mut self, step: i64) {
        let Some(run) = &self.runs[0] else { return };
        let count = run.points.len() as i64;
        if count == 0 {
            return;
        }
        let current = self.pinned.and_then(|p| p.point).map_or(if step > 0 { -1 } else { 0 }, i64::from);
        let point = (current + step).rem_euclid(count) as u32;
        let face = run.points[point as usize].face;
        self.pin(Some(Pick { face, point: Some(point) }));
    }

    /// Asks for a file.
    pub fn export(&mut self, what: Export) {
        self.queue.push_front(Job::Export(Slot::A, what));
    }

    /// Shows everything again as at the start.
    pub fn reset_views(&mut self) {
        if let Some(mesh) = &self.mesh {
            self.orbit = Orbit::around(mesh.centre, mesh.radius, self.orbit.up);
        }
        self.plane = None;
    }

    /// Puts an obstacle before the camera, or takes it away.
    pub fn toggle_occluder(&mut self) {
        self.occluder = match self.occluder {
            Some(_) => None,
            None => Some(Occluder { low: Vec2::new(-0.25, -0.45), high: Vec2::new(0.35, 0.45) }),
        };
    }

    /// The numbers of what the pointer is on, or of what is pinned, line by line.
    pub fn describe(&self, pick: Pick) -> Vec<String> {
        let (Some(mesh), Some(run)) = (&self.mesh, &self.runs[0]) else { return Vec::new() };
        let Some(&strip) = run.strip_of.get(pick.face as usize) else { return Vec::new() };
        let mut lines = Vec::new();
        if let Some(point) = pick.point.and_then(|p| run.points.get(p as usize)) {
            let p = point.position;
            let origin = match point.origin {
                ldwrap::Origin::Wrapped => "wrapped",
                ldwrap::Origin::Projected => "projected by the correction",
                ldwrap::Origin::Equalized => "equalized",
            };
            lines.push(format!("point {}: {origin}", pick.point.unwrap_or_default()));
            lines.push(format!("at {:.4}, {:.4}, {:.4}", p.x, p.y, p.z));
        }
        let [a, b, c] = mesh.triangle(pick.face);
        lines.push(format!("triangle {}: area {:.3e}", pick.face, 0.5 * (b - a).cross(c - a).length()));
        let of = &run.strips[strip as usize];
        lines.push(format!("strip {strip}: {} triangles, area {:.4}", of.faces, of.area));
        lines.push(format!("its border: {:.3}, of it open {:.3}", of.border_length, of.open_border_length));
        lines
    }

    /// One line about what is shown, for people who hear the page and for tests.
    pub fn status(&self) -> String {
        let (Some(mesh), run) = (&self.mesh, &self.runs[0]) else { return "loading".into() };
        match run {
            _ if self.is_busy() => format!("working on {}", mesh.name),
            None => format!("{}: {} triangles", mesh.name, mesh.report.faces),
            Some(run) => format!(
                "{}: {} triangles, {} strips, {} points, irregularity {:.2}",
                mesh.name,
                mesh.report.faces,
                run.strips.len(),
                run.points.len(),
                run.irregularity[0],
            ),
        }
    }

    /// The state as JSON, for tests of the page.
    pub fn inspect(&self) -> Value {
        let run = self.runs[0].as_deref();
        json!({
            "busy": self.is_busy(),
            "mesh": self.mesh.as_ref().map(|m| &m.name),
            "triangles": self.mesh.as_ref().map(|m| m.report.faces),
            "strips": run.map(|r| r.strips.len()),
            "points": run.map(|r| r.points.len()),
            "pointsOfB": self.runs[1].as_ref().map(|r| r.points.len()),
            "hover": self.hover.map(|p| json!({"face": p.face, "point": p.point})),
            "pinned": self.pinned.map(|p| json!({"face": p.face, "point": p.point})),
            "figure": self.figure.as_ref().map(|f| json!({"faces": f.faces.len(), "degree": f.degree})),
            "look": self.look.map(|l| json!({"surface": l.surface, "points": l.points})),
            "trail": self.trail.len(),
            "verdicts": self.verdicts[0].len(),
            "verdictsOfB": self.verdicts[1].len(),
            "up": self.orbit.up,
            "obstacle": self.occluder.map(|o| [o.low, o.high]),
            "plane": self.plane.map(|p| json!({"centre": p.centre, "halfHeight": p.half_height})),
            "yaw": self.orbit.yaw,
            "distance": self.orbit.distance,
            "stage": self.stage.as_ref().map(|(name, share)| json!([name, share])),
            "notice": self.notice.as_ref().map(|n| match n {
                Notice::Done(text) => json!({"done": text}),
                Notice::Problem(text) => json!({"problem": text}),
            }),
            "seconds": run.map(|r| r.seconds),
            "status": self.status(),
        })
    }
}

/// How many rings make a sample figure that can be seen: about a thirtieth of the triangles.
fn rings_for(faces: usize) -> u32 {
    ((0.02 * faces as f64).sqrt().round() as u32).clamp(2, MOST_RINGS)
}

/// Whether a job for the judge is about points that the maker's jobs will replace.
fn is_replaced(job: &Job, queue: &VecDeque<Job>, in_hand: &Option<Job>) -> bool {
    let (Job::Judge(slot, _) | Job::Place(slot, _)) = job else { return false };
    queue.iter().chain(in_hand).any(|waiting| matches!(waiting, Job::Wrap(replaced, _) if replaced == slot))
}

#[cfg(test)]
mod tests;
