//! How the program ends: what went wrong, in words, and the exit code for it.

use std::fmt::Display;
use std::io::Write;
use std::process::ExitCode;

/// Why the program cannot do what it was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line asks for something that makes no sense: exit code 2, as clap's own errors.
    WrongUse(String),
    /// Something failed on the way: exit code 1.
    Failed(anyhow::Error),
}

/// What a command returns.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// Wrong use, with what is wrong and what to do instead.
    pub(crate) fn wrong_use(message: impl Display) -> Self {
        Self::WrongUse(message.to_string())
    }

    /// Tells what went wrong on stderr and gives the exit code for it.
    pub(crate) fn tell(&self) -> ExitCode {
        // Nothing is left to be done when even stderr is closed.
        match self {
            Self::WrongUse(message) => {
                let _ =
                    writeln!(std::io::stderr(), "error: {message}\n\nFor more information, try '--help'.");
                ExitCode::from(2)
            }
            Self::Failed(error) => {
                let _ = writeln!(std::io::stderr(), "error: {error:#}");
                ExitCode::FAILURE
            }
        }
    }
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}
