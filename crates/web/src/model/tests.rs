//! What can happen to the page, one thing after another.

use super::*;
use crate::engine::Engine;
use ldwrap::Silent;

/// All engines, working at once in the test's own thread.
struct Office {
    maker: Engine,
    looker: Engine,
    judge: Engine,
}

impl Office {
    fn new() -> Self {
        Self { maker: Engine::default(), looker: Engine::default(), judge: Engine::default() }
    }

    fn work(&mut self, model: &mut Model) {
        loop {
            let jobs = model.take_jobs();
            if jobs.is_empty() {
                return;
            }
            for (desk, job) in jobs {
                match desk {
                    Desk::Maker => model.receive(self.maker.handle(job, &Silent, &|| 0.0)),
                    Desk::Judge => model.receive_verdict(self.judge.handle(job, &Silent, &|| 0.0)),
                    Desk::Looker => model.receive_look(self.looker.handle(job, &Silent, &|| 0.0)),
                }
            }
        }
    }
}

#[test]
fn it_opens_with_a_mesh_wrapped() {
    let mut model = Model::open(None);
    Office::new().work(&mut model);
    assert_eq!(model.runs[0].as_ref().unwrap().points.len(), 1000);
    assert!(!model.is_busy());
    assert!(model.status().contains("1000 points"), "{}", model.status());
}

#[test]
fn settings_wrap_again_only_when_they_change() {
    let (mut model, mut office) = (Model::open(None), Office::new());
    office.work(&mut model);
    model.settle();
    assert!(!model.is_busy());
    model.settings[0].request = ldwrap::pipeline::Request::Count(64);
    model.settle();
    assert!(model.is_busy());
    office.work(&mut model);
    assert_eq!(model.runs[0].as_ref().unwrap().points.len(), 64);
}

#[test]
fn a_broken_file_is_told_and_the_old_mesh_stays() {
    let (mut model, mut office) = (Model::open(None), Office::new());
    office.work(&mut model);
    model.load(Source::alone("broken.ply".into(), b"no mesh".to_vec()));
    office.work(&mut model);
    assert!(matches!(&model.notice, Some(Notice::Problem(text)) if text.contains("broken.ply")));
    assert_eq!(model.mesh.as_ref().unwrap().name, "cup");
    assert_eq!(model.link().shape, "cup");
    model.settings[0].seed = 5;
    model.settle();
    office.work(&mut model);
    assert_eq!(model.runs[0].as_ref().unwrap().points.len(), 1000);
}

#[test]
fn of_two_methods_the_first_is_shown_first() {
    let other = Some(Settings { method: Method::Hilbert, ..Settings::default() });
    let mut model = Model::open(Some(Link { shape: "cube".into(), other, ..Link::default() }));
    let mut engine = Engine::default();
    for _ in 0..2 {
        for (desk, job) in model.take_jobs() {
            assert_eq!(desk, Desk::Maker);
            model.receive(engine.handle(job, &Silent, &|| 0.0));
        }
    }
    assert!(model.runs[0].is_some() && model.runs[1].is_none());
}

#[test]
fn points_are_shown_before_they_are_equalized_and_measured_after() {
    let (mut model, mut office) = (Model::open(None), Office::new());
    let mut shown = Vec::new();
    for _ in 0..3 {
        for (desk, job) in model.take_jobs() {
            match desk {
                Desk::Maker => model.receive(office.maker.handle(job, &Silent, &|| 0.0)),
                Desk::Judge => {
                    assert!(matches!(job, Job::Load(_)), "points that are replaced were measured");
                    model.receive_verdict(office.judge.handle(job, &Silent, &|| 0.0));
                }
                Desk::Looker => model.receive_look(office.looker.handle(job, &Silent, &|| 0.0)),
            }
        }
        shown.push((model.runs[0].as_ref().map(|run| run.points.len()), model.is_busy()));
    }
    assert_eq!(shown, [(None, true), (Some(1000), true), (Some(1000), false)]);
    office.work(&mut model);
    assert_eq!(model.verdicts[0].len(), Measure::ALL.len());
}

#[test]
fn what_is_shown_when_the_person_stops_is_measured() {
    let (mut model, mut office) = (Model::open(None), Office::new());
    for _ in 0..3 {
        for (desk, job) in model.take_jobs() {
            match desk {
                Desk::Maker if model.runs[0].is_some() => {
                    model.cancel();
                    model.receive(Answer::Cancelled);
                }
                Desk::Maker => model.receive(office.maker.handle(job, &Silent, &|| 0.0)),
                Desk::Judge => model.receive_verdict(office.judge.handle(job, &Silent, &|| 0.0)),
                Desk::Looker => model.receive_look(office.looker.handle(job, &Silent, &|| 0.0)),
            }
        }
    }
    assert!(!model.is_busy() && model.notice.is_some());
    office.work(&mut model);
    assert_eq!(model.verdicts[0].len(), Measure::ALL.len());
}

#[test]
fn comparing_fills_the_second_slot() {
    let (mut model, mut office) = (Model::open(None), Office::new());
    office.work(&mut model);
    assert!(model.runs[1].is_none());
    model.comparing = true;
    model.settle();
    office.work(&mut model);
    assert!(model.runs[1].is_some());
}

#[test]
fn pinning_a_point_grows_its_figure() {
    let (mut model, mut office) = (Model::open(None), Office::new());
    office.work(&mut model);
    model.pin_neighbour(1);
    office.work(&mut model);
    let figure = model.figure.as_ref().unwrap();
    assert_eq!(figure.seed, model.runs[0].as_ref().unwrap().points[0].face);
    assert!(figure.degree >= 1);
    assert!((0.005..0.1).contains(&figure.area_share), "too small to be seen: {}", figure.area_share);
    assert!(!model.describe(model.pinned.unwrap()).is_empty());
    model.pin(None);
    assert!(model.figure.is_none());
}

#[test]
fn cancelling_keeps_the_old_points() {
    let (mut model, mut office) = (Model::open(None), Office::new());
    office.work(&mut model);
    model.settings[0].seed = 9;
    model.settle();
    let job = model.take_jobs();
    assert!(matches!(job.as_slice(), [(Desk::Maker, Job::Wrap(..))]));
    model.cancel();
    assert_eq!(model.take_cancels(), [Desk::Maker]);
    model.receive(Answer::Cancelled);
    assert!(!model.is_busy());
    assert!(model.runs[0].is_some());
}

#[test]
fn the_trail_follows_the_camera() {
    let (mut model, mut office) = (Model::open(None), Office::new());
    office.work(&mut model);
    for step in 0..3 {
        model.orbit.yaw = step as f32;
        model.watch(1.0);
        model.watch(1.0);
        office.work(&mut model);
    }
    assert_eq!(model.trail.len(), 3);
    let look = model.look.unwrap();
    assert!(look.points[1].is_none());
}
