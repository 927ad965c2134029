//! Where the work stands: how long each stage took, and bars on stderr when a person looks; of one mesh or of many.

use std::io::{IsTerminal, Write, stderr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use ldwrap::Progress;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// Times the stages of a run, and shows a bar on stderr when it is a terminal.
pub(crate) struct Stages {
    state: Mutex<State>,
    bar: Option<ProgressBar>,
    quiet: bool,
}

struct State {
    done: Seconds,
    current: Option<(&'static str, Instant)>,
}

/// How many seconds each stage took, in the order in which they began.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seconds(Vec<(&'static str, f64)>);

impl Seconds {
    /// Each stage with its seconds.
    pub(crate) fn stages(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.0.iter().copied()
    }
}

impl Stages {
    /// Begins to listen; `quiet` shows no bar and says nothing.
    pub(crate) fn new(quiet: bool) -> Self {
        let bar = bar(quiet, "{spinner} {prefix}{msg:<16} {wide_bar} {percent:>3}% {elapsed}");
        Self { state: Mutex::new(State { done: Seconds::default(), current: None }), bar, quiet }
    }

    /// Prints a line on stderr, above the bar; nothing if the run is quiet.
    pub(crate) fn say(&self, line: &str) {
        say(self.quiet, self.bar.as_ref(), line);
    }

    /// What the bar shows before the name of the stage.
    pub(crate) fn prefix(&self, prefix: &str) {
        if let Some(bar) = &self.bar {
            bar.set_prefix(prefix.to_owned());
        }
    }

    /// The seconds of every stage so far; the one that is running ends now and its bar goes away.
    pub(crate) fn finish(&self) -> Seconds {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        let mut state = self.lock();
        state.close();
        state.done.clone()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        // The state is whole between any two statements: a panic elsewhere does not spoil it.
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl State {
    fn close(&mut self) {
        let Some((stage, since)) = self.current.take() else { return };
        let seconds = since.elapsed().as_secs_f64();
        match self.done.0.iter_mut().find(|(name, _)| *name == stage) {
            Some((_, sum)) => *sum += seconds,
            None => self.done.0.push((stage, seconds)),
        }
    }
}

impl Progress for Stages {
    fn begin(&self, stage: &'static str, steps: u64) {
        let mut state = self.lock();
        state.close();
        state.current = Some((stage, Instant::now()));
        drop(state);
        if let Some(bar) = &self.bar {
            bar.set_message(stage);
            bar.reset();
            bar.set_length(steps);
        }
    }

    fn advance(&self, steps: u64) {
        if let Some(bar) = &self.bar {
            bar.inc(steps);
        }
    }
}

impl Serialize for Seconds {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (stage, seconds) in &self.0 {
            map.serialize_entry(stage, seconds)?;
        }
        map.end()
    }
}

/// How many files are done with, and how long the rest will take; a bar on stderr when it is a terminal.
pub(crate) struct Files {
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Files {
    /// Begins to count up to `count`; `quiet` shows no bar and says nothing.
    pub(crate) fn new(quiet: bool, count: usize) -> Self {
        let bar = bar(quiet, "{spinner} {pos}/{len} {wide_bar} {percent:>3}% {elapsed}, {eta} left");
        if let Some(bar) = &bar {
            bar.set_length(count as u64);
        }
        Self { bar, quiet }
    }

    /// One more is done with.
    pub(crate) fn advance(&self) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }

    /// Prints a line on stderr, above the bar; nothing if the run is quiet.
    pub(crate) fn say(&self, line: &str) {
        say(self.quiet, self.bar.as_ref(), line);
    }

    /// The bar goes away.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar(quiet: bool, template: &str) -> Option<ProgressBar> {
    (!quiet && stderr().is_terminal()).then(|| {
        let bar = ProgressBar::new(0);
        bar.set_style(
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    })
}

fn say(quiet: bool, bar: Option<&ProgressBar>, line: &str) {
    if quiet {
        return;
    }
    let print = || {
        // A closed stderr is no reason to stop.
        let _ = writeln!(stderr(), "{line}");
    };
    match bar {
        Some(bar) => bar.suspend(print),
        None => print(),
    }
}
