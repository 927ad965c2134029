//! What an engine has done, so that another one can be brought to the same state after the first was ended.

use std::collections::VecDeque;

use crate::engine::{Answer, Job};

/// The jobs that made the state of an engine.
#[derive(Debug, Default)]
pub struct Journal {
    load: Option<Job>,
    places: [Option<Job>; 2],
    posted: VecDeque<Posted>,
}

#[derive(Debug)]
enum Posted {
    Asked(Job),
    /// Done again after a restart: the answer is known already.
    Again,
}

impl Journal {
    /// A job was posted.
    pub fn post(&mut self, job: Job) {
        self.posted.push_back(Posted::Asked(job));
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
                self.places[slot.index()] = Some(job);
            }
            _ => {}
        }
        true
    }

    /// The engine was ended and a new one started: what to post so that it holds what the old one held.
    pub fn restart(&mut self) -> Vec<Job> {
        let jobs: Vec<Job> = self.load.iter().chain(self.places.iter().flatten()).cloned().collect();
        self.posted = jobs.iter().map(|_| Posted::Again).collect();
        jobs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{Engine, Slot};
    use crate::settings::Settings;
    use crate::source::Source;
    use ldwrap::Silent;
    use ldwrap::shapes::Shape;

    fn work(engine: &mut Engine, journal: &mut Journal, job: Job) -> (Answer, bool) {
        journal.post(job.clone());
        let answer = engine.handle(job, &Silent, &|| 0.0);
        let news = journal.receive(&answer);
        (answer, news)
    }

    #[test]
    fn a_restarted_engine_holds_what_the_old_one_held() {
        let (mut engine, mut journal) = (Engine::default(), Journal::default());
        work(&mut engine, &mut journal, Job::Load(Source::Shape(Shape::Sphere)));
        let settings = Settings { seed: 3, ..Settings::default() };
        let (before, news) = work(&mut engine, &mut journal, Job::Wrap(Slot::A, settings));
        assert!(news && matches!(before, Answer::Wrapped(..)));
        journal.post(Job::Wrap(Slot::A, Settings::default()));
        assert!(journal.is_working());
        let mut other = Engine::default();
        let mut last = None;
        for job in journal.restart() {
            let answer = other.handle(job, &Silent, &|| 0.0);
            assert!(!journal.receive(&answer), "what is done again is no news");
            last = Some(answer);
        }
        assert_eq!(last, Some(before));
        assert!(!journal.is_working());
    }

    #[test]
    fn a_mesh_that_failed_to_load_is_not_loaded_again() {
        let (mut engine, mut journal) = (Engine::default(), Journal::default());
        work(&mut engine, &mut journal, Job::Load(Source::Shape(Shape::Cube)));
        work(&mut engine, &mut journal, Job::Load(Source::File { name: "x.obj".into(), bytes: Vec::new() }));
        assert_eq!(journal.restart(), [Job::Load(Source::Shape(Shape::Cube))]);
    }
}
