//! An engine in a web worker, which runs the same wasm module as the page.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

use wasm_bindgen::JsCast as _;
use wasm_bindgen::closure::Closure;
use web_sys::{Event, MessageEvent, Worker, WorkerOptions, WorkerType};

use crate::engine::{Answer, Job};
use crate::journal::Journal;

/// A worker that works.
pub(crate) struct EngineLink {
    worker: Option<Worker>,
    answers: Rc<RefCell<VecDeque<Answer>>>,
    wake: Rc<dyn Fn()>,
    broken: Rc<Cell<bool>>,
    journal: Journal,
}

impl EngineLink {
    /// The worker is started when there is work; `wake` is called when it has something to say.
    pub(crate) fn new(wake: impl Fn() + 'static) -> Self {
        Self {
            worker: None,
            answers: Rc::default(),
            wake: Rc::new(wake),
            broken: Rc::default(),
            journal: Journal::default(),
        }
    }

    /// Gives it work.
    pub(crate) fn post(&mut self, job: Job) {
        if self.worker.is_none() {
            self.start();
        }
        let jobs = self.journal.post(job);
        self.send(&jobs);
    }

    fn start(&mut self) {
        match start_worker(&self.answers, &self.wake, &self.broken) {
            Ok(worker) => self.worker = Some(worker),
            Err(reason) => {
                self.answers.borrow_mut().push_back(Answer::Failed(reason));
                (self.wake)();
            }
        }
    }

    fn send(&self, jobs: &[Job]) {
        for job in jobs {
            let bytes = postcard::to_stdvec(job).unwrap_or_default();
            if let Some(worker) = &self.worker {
                // A message of plain bytes can always be posted.
                let _ = worker.post_message(&js_sys::Uint8Array::from(bytes.as_slice()));
            }
        }
    }

    /// What it has said since the last time.
    pub(crate) fn take(&mut self) -> Vec<Answer> {
        if self.broken.take() {
            self.restart();
            let reason = "the work broke off, perhaps because it needs more memory than a browser gives; what was \
                          shown before is still here";
            return vec![Answer::Failed(reason.into())];
        }
        let said: Vec<Answer> = self.answers.borrow_mut().drain(..).collect();
        said.into_iter().filter(|answer| self.journal.receive(answer)).collect()
    }

    /// Gives up the work in hand. A worker that works hears nothing, so it is ended, and a new one does again what
    /// the old one had done.
    pub(crate) fn cancel(&mut self) {
        if !self.journal.is_working() {
            return;
        }
        self.restart();
        self.answers.borrow_mut().push_front(Answer::Cancelled);
        (self.wake)();
    }

    fn restart(&mut self) {
        if let Some(worker) = self.worker.take() {
            worker.terminate();
        }
        self.answers.borrow_mut().clear();
        self.start();
        let again = self.journal.restart();
        self.send(again.as_slice());
    }
}

fn start_worker(
    answers: &Rc<RefCell<VecDeque<Answer>>>,
    wake: &Rc<dyn Fn()>,
    broken: &Rc<Cell<bool>>,
) -> Result<Worker, String> {
    let options = WorkerOptions::new();
    options.set_type(WorkerType::Module);
    let worker =
        Worker::new_with_options("./worker.js", &options).map_err(|e| format!("no worker: {e:?}"))?;
    let (queue, called) = (Rc::clone(answers), Rc::clone(wake));
    let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        let bytes = js_sys::Uint8Array::new(&event.data()).to_vec();
        let answer =
            postcard::from_bytes(&bytes).unwrap_or_else(|e| Answer::Failed(format!("a garbled answer: {e}")));
        queue.borrow_mut().push_back(answer);
        called();
    });
    worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
    on_message.forget();
    let (broken, called) = (Rc::clone(broken), Rc::clone(wake));
    let on_error = Closure::<dyn FnMut(Event)>::new(move |event: Event| {
        event.prevent_default();
        broken.set(true);
        called();
    });
    worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));
    on_error.forget();
    // The module is sent as it is compiled, so that the worker neither loads nor compiles it again.
    worker.post_message(&wasm_bindgen::module()).map_err(|e| format!("no worker: {e:?}"))?;
    Ok(worker)
}
