//! What an engine has done, so that another one can be brought to the same state after the first was ended.

use std::collections::VecDeque;

use crate::engine::{Answer, Job, Slot};

/// The jobs that made the state of an engine.
#[derive(Debug, Default)]
pub struct Journal {
    load: Option<Job>,
    places: [Option<Held>; 2],
    posted: VecDeque<Posted>,
}

/// What put points into a slot.
#[derive(Debug)]
struct Held {
    job: Job,
    here: Here,
}

/// Whether the engine that runs now holds a slot's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Here {
    Yes,
    /// Only the one before held them: they are made again when a job needs them.
    Lost,
}

#[derive(Debug)]
enum Posted {
    Asked(Job),
    /// Done again after a restart: the answer is known already. A slot's points, or the mesh.
    Again(Option<Slot>),
}

impl Journal {
    /// A job is to be posted: what to send, which is the job itself after what it needs and a restart has lost.
    pub fn post(&mut self, job: Job) -> Vec<Job> {
        let needed: &[Slot] = match &job {
            Job::Grow(slot, ..) | Job::Judge(slot, _) | Job::Export(slot, _) => &[*slot],
            Job::Look(_) => &Slot::ALL,
            Job::Load(_) | Job::Wrap(..) | Job::Place(..) => &[],
        };
        let mut jobs = Vec::new();
        for slot in needed {
            if let Some(held) = &mut self.places[slot.index()]
                && held.here == Here::Lost
            {
                held.here = Here::Yes;
                jobs.push(held.job.clone());
                self.posted.push_back(Posted::Again(Some(*slot)));
            }
        }
        jobs.push(job.clone());
        self.posted.push_back(Posted::Asked(job));
        jobs
    }

    /// Whether an answer is awaited.
    pub fn is_working(&self) -> bool {
        !self.posted.is_empty()
    }

    /// An answer has come; whether it is news.
    pub fn receive(&mut self, answer: &Answer) -> bool {
        if let Answer::Progress(stage, _) = answer
            && stage != crate::engine::PLACED
        {
            return matches!(self.posted.front(), Some(Posted::Asked(_)));
        }
        if *answer == Answer::Cancelled {
            return true;
        }
        let Some(Posted::Asked(job)) = self.posted.pop_front() else { return false };
        match (answer, job) {
            (Answer::Loaded(_), job) => {
                self.load = Some(job);
                self.places = [None, None];
            }
            (Answer::Wrapped(..), job @ Job::Wrap(slot, _))
            | (Answer::Progress(..), job @ Job::Place(slot, _)) => {
                self.places[slot.index()] = Some(Held { job, here: Here::Yes });
            }
            _ => {}
        }
        true
    }

    /// The engine was ended and a new one started: what to send so that it holds the mesh that the old one held. Its
    /// points are made again when a job needs them. What broke while it was done again is forgotten.
    pub fn restart(&mut self) -> Option<Job> {
        match self.posted.front() {
            Some(Posted::Again(None)) => (self.load, self.places) = (None, [None, None]),
            Some(Posted::Again(Some(slot))) => self.places[slot.index()] = None,
            Some(Posted::Asked(_)) | None => {}
        }
        for held in self.places.iter_mut().flatten() {
            held.here = Here::Lost;
        }
        self.posted = self.load.iter().map(|_| Posted::Again(None)).collect();
        self.load.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Engine;
    use crate::settings::Settings;
    use crate::source::Source;
    use ldwrap::Silent;
    use ldwrap::shapes::Shape;

    /// Sends what the journal says and returns the answers that are news.
    fn send(engine: &mut Engine, journal: &mut Journal, jobs: impl IntoIterator<Item = Job>) -> Vec<Answer> {
        let answers = jobs.into_iter().map(|job| engine.handle(job, &Silent, &|| 0.0));
        answers.filter(|answer| journal.receive(answer)).collect()
    }

    fn work(engine: &mut Engine, journal: &mut Journal, job: Job) -> Vec<Answer> {
        let jobs = journal.post(job);
        send(engine, journal, jobs)
    }

    fn names(jobs: &[Job]) -> Vec<&'static str> {
        jobs.iter()
            .map(|job| match job {
                Job::Load(_) => "load",
                Job::Wrap(..) => "wrap",
                Job::Grow(..) => "grow",
                _ => "other",
            })
            .collect()
    }

    #[test]
    fn a_restarted_engine_holds_what_the_old_one_held() {
        let (mut engine, mut journal) = (Engine::default(), Journal::default());
        work(&mut engine, &mut journal, Job::Load(Source::Shape(Shape::Sphere)));
        let settings = Settings { seed: 3, ..Settings::default() };
        assert_eq!(work(&mut engine, &mut journal, Job::Wrap(Slot::A, settings)).len(), 1);
        let before = work(&mut engine, &mut journal, Job::Grow(Slot::A, 5, 3));
        journal.post(Job::Wrap(Slot::A, Settings::default()));
        assert!(journal.is_working());
        let mut other = Engine::default();
        let again = journal.restart();
        assert_eq!(send(&mut other, &mut journal, again), [], "what is done again is no news");
        assert!(!journal.is_working());
        let jobs = journal.post(Job::Grow(Slot::A, 5, 3));
        assert_eq!(names(&jobs), ["wrap", "grow"], "points are made again when they are needed");
        assert_eq!(send(&mut other, &mut journal, jobs), before);
        assert_eq!(names(&journal.post(Job::Grow(Slot::A, 5, 3))), ["grow"]);
    }

    #[test]
    fn what_breaks_when_it_is_done_again_is_not_tried_for_ever() {
        let (mut engine, mut journal) = (Engine::default(), Journal::default());
        work(&mut engine, &mut journal, Job::Load(Source::Shape(Shape::Cube)));
        work(&mut engine, &mut journal, Job::Wrap(Slot::A, Settings::default()));
        let mut other = Engine::default();
        let again = journal.restart();
        send(&mut other, &mut journal, again);
        assert_eq!(names(&journal.post(Job::Grow(Slot::A, 5, 3))), ["wrap", "grow"]);
        assert!(journal.restart().is_some(), "the points broke it, the mesh did not");
        assert_eq!(journal.restart(), None, "now the mesh did");
        assert_eq!(names(&journal.post(Job::Grow(Slot::A, 5, 3))), ["grow"]);
    }

    #[test]
    fn a_mesh_that_failed_to_load_is_not_loaded_again() {
        let (mut engine, mut journal) = (Engine::default(), Journal::default());
        work(&mut engine, &mut journal, Job::Load(Source::Shape(Shape::Cube)));
        work(&mut engine, &mut journal, Job::Load(Source::alone("x.obj".into(), Vec::new())));
        assert_eq!(journal.restart(), Some(Job::Load(Source::Shape(Shape::Cube))));
    }
}
