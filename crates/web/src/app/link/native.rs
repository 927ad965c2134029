//! An engine in a thread.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use ldwrap::Progress;

use crate::engine::{Answer, Engine, Job};

/// A thread that works.
pub(crate) struct EngineLink {
    jobs: Sender<(u64, Job)>,
    /// How many jobs were posted.
    posted: u64,
    answers: Receiver<Answer>,
    /// Jobs up to this number are given up.
    cancelled: Arc<AtomicU64>,
}

impl EngineLink {
    /// Starts the thread; `wake` is called when it has something to say.
    pub(crate) fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (jobs, work) = channel();
        let (answer, answers) = channel();
        let cancelled = Arc::new(AtomicU64::new(0));
        let telling = Telling {
            answer: Mutex::new(answer.clone()),
            wake: Box::new(wake),
            cancelled: Arc::clone(&cancelled),
            stage: Mutex::new(("", 0)),
            done: AtomicU64::new(0),
            number: AtomicU64::new(0),
        };
        let (start, failed) = (Instant::now(), answer.clone());
        let started = std::thread::Builder::new().name("engine".into()).spawn(move || {
            let mut engine = Engine::default();
            for (number, job) in work {
                telling.number.store(number, Ordering::Relaxed);
                let said = engine.handle(job, &telling, &|| start.elapsed().as_secs_f64());
                if answer.send(said).is_err() {
                    return;
                }
                (telling.wake)();
            }
        });
        if let Err(error) = started {
            // The other end is held here.
            let _ = failed.send(Answer::Failed(format!("no thread: {error}")));
        }
        Self { jobs, posted: 0, answers, cancelled }
    }

    /// Gives it work.
    pub(crate) fn post(&mut self, job: Job) {
        self.posted += 1;
        // The thread ends only with the app: nobody is left to be told of a failure.
        let _ = self.jobs.send((self.posted, job));
    }

    /// What it has said since the last time.
    pub(crate) fn take(&mut self) -> Vec<Answer> {
        self.answers.try_iter().collect()
    }

    /// Asks it to give up the work in hand.
    pub(crate) fn cancel(&mut self) {
        self.cancelled.store(self.posted, Ordering::Relaxed);
    }
}

struct Telling {
    answer: Mutex<Sender<Answer>>,
    wake: Box<dyn Fn() + Send + Sync>,
    cancelled: Arc<AtomicU64>,
    /// Of the job in hand, from 1.
    number: AtomicU64,
    stage: Mutex<(&'static str, u64)>,
    done: AtomicU64,
}

impl Telling {
    fn tell(&self, stage: &str, share: Option<f32>) {
        if let Ok(answer) = self.answer.lock() {
            // As above: without the app nobody listens.
            let _ = answer.send(Answer::Progress(stage.to_owned(), share));
        }
        (self.wake)();
    }
}

impl Progress for Telling {
    fn begin(&self, stage: &'static str, steps: u64) {
        if let Ok(mut current) = self.stage.lock() {
            *current = (stage, steps);
        }
        self.done.store(0, Ordering::Relaxed);
        self.tell(stage, None);
    }

    fn advance(&self, steps: u64) {
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        let (stage, all) = self.stage.lock().map(|s| *s).unwrap_or_default();
        // About a hundred messages a stage are enough.
        if all > 1 && (100 * done / all) != (100 * (done - steps.min(done)) / all) {
            self.tell(stage, Some(done as f32 / all as f32));
        }
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed) >= self.number.load(Ordering::Relaxed)
    }
}
