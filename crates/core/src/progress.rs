//! How long work tells where it stands, and how it is told to stop.

/// Receives the progress of stages. All methods may be called from several threads.
pub trait Progress: Sync {
    /// A stage with this name begins and will take `steps` steps.
    fn begin(&self, stage: &'static str, steps: u64);
    /// `steps` more steps of the stage are done.
    fn advance(&self, steps: u64);
    /// Whether the caller no longer wants the result. A stage that sees `true` returns early with a value that is
    /// not to be used.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Ignores progress and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &'static str, _: u64) {}
    fn advance(&self, _: u64) {}
}
