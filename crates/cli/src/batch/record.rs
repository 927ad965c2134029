//! What became of one mesh: a line of the journal, a row of the summary.

use std::collections::BTreeMap;
use std::fs::Metadata;
use std::time::{SystemTime, UNIX_EPOCH};

use ldwrap::irregularity::Irregularity;
use serde::{Deserialize, Serialize};

/// A line of the journal. Its keys are documented in docs/BATCH.md and stay as they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// The path of the mesh as it was given or found.
    pub(crate) input: String,
    /// Where its points go, below OUT_DIR; none for what is no mesh file.
    pub(crate) output: Option<String>,
    /// The version of the program.
    pub(crate) version: String,
    /// The same for the same options.
    pub(crate) options: String,
    /// The mesh file as it was before it was read; none if that could not be told.
    pub(crate) source: Option<Source>,
    pub(crate) result: Ended,
    /// How long each stage took, in seconds.
    pub(crate) seconds: BTreeMap<String, f64>,
    /// When it ended, in milliseconds since 1970.
    pub(crate) at: u64,
}

/// What tells that a file is still the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Source {
    /// Its size in bytes.
    pub(crate) bytes: u64,
    /// When it was changed last, in nanoseconds since 1970, where the file system knows.
    pub(crate) modified: Option<u64>,
}

/// How the work on a mesh ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "lowercase")]
pub(crate) enum Ended {
    Done(Made),
    Failed(Trouble),
}

/// What was made of a mesh. A number that does not exist is null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Made {
    /// The size of the output.
    pub(crate) bytes: u64,
    pub(crate) vertices: usize,
    pub(crate) triangles: usize,
    pub(crate) components: usize,
    pub(crate) area: Option<f64>,
    pub(crate) strips: usize,
    pub(crate) points: usize,
    pub(crate) d_m: Option<f64>,
    pub(crate) irregularity: Ratios,
    /// With `--eta`.
    pub(crate) eta: Option<f64>,
    /// What the check changed, without what it did not.
    pub(crate) repairs: BTreeMap<String, u64>,
}

/// The irregularity ratio R.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Ratios {
    pub(crate) bound: Option<f64>,
    pub(crate) refined: Option<f64>,
    pub(crate) exact: Option<f64>,
    /// How much of the exact one is not known.
    #[serde(default)]
    pub(crate) undecided: Option<f64>,
}

/// Why there are no points.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Trouble {
    pub(crate) kind: Kind,
    pub(crate) message: String,
}

/// What went wrong. The names are documented in docs/BATCH.md.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    /// The file cannot be opened or read, or the folder cannot be listed.
    Read,
    /// The name cannot be written down.
    Name,
    /// The bytes are not a mesh.
    Format,
    /// They are, but not of a surface.
    Surface,
    /// The options ask for what this mesh does not have or allow.
    Options,
    /// The points cannot be written.
    Write,
    /// A mistake in this program.
    Panic,
}

impl Kind {
    /// As in the journal.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Name => "name",
            Self::Format => "format",
            Self::Surface => "surface",
            Self::Options => "options",
            Self::Write => "write",
            Self::Panic => "panic",
        }
    }
}

impl Source {
    /// Of a file.
    pub(crate) fn of(file: &Metadata) -> Self {
        let since = file.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        Self { bytes: file.len(), modified: since.and_then(|since| u64::try_from(since.as_nanos()).ok()) }
    }
}

impl Ratios {
    /// Those that are numbers.
    pub(crate) fn of(irregularity: &Irregularity) -> Self {
        let Irregularity { bound, refined, exact, undecided } = *irregularity;
        Self {
            bound: number(bound),
            refined: number(refined),
            exact: number(exact),
            undecided: number(undecided),
        }
    }
}

impl Record {
    /// How the work on it ended, if well.
    pub(crate) fn made(&self) -> Option<&Made> {
        match &self.result {
            Ended::Done(made) => Some(made),
            Ended::Failed(_) => None,
        }
    }
}

/// JSON has finite numbers alone.
pub(crate) fn number(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// Milliseconds since 1970.
pub(crate) fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A record of a mesh that went well.
    pub(crate) fn done(output: &str, options: &str, at: u64) -> Record {
        let irregularity =
            Ratios { bound: Some(0.1 + 0.2), refined: Some(1e-300), exact: None, undecided: Some(0.0) };
        Record {
            input: format!("in/{output}"),
            output: Some(output.to_owned()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            options: options.to_owned(),
            source: Some(Source { bytes: 7, modified: Some(1_790_000_000_123_456_789) }),
            result: Ended::Done(Made {
                bytes: 3,
                vertices: 4,
                triangles: 4,
                components: 1,
                area: Some(1.0 / 3.0),
                strips: 2,
                points: 5,
                d_m: Some(0.25),
                irregularity,
                eta: None,
                repairs: BTreeMap::from([("welded_vertices".to_owned(), 2)]),
            }),
            seconds: BTreeMap::from([("read".to_owned(), 0.125)]),
            at,
        }
    }

    /// A record of one that did not.
    pub(crate) fn failed(output: &str, options: &str, at: u64) -> Record {
        let trouble = Trouble { kind: Kind::Format, message: "no \"mesh\",\nat all".to_owned() };
        Record { result: Ended::Failed(trouble), ..done(output, options, at) }
    }

    #[test]
    fn records_come_back_to_the_bit() {
        for record in [done("a.ply", "x", 1), failed("b/c.ply", "y", 2)] {
            let line = serde_json::to_string(&record).unwrap();
            assert_eq!(line.lines().count(), 1);
            assert_eq!(serde_json::from_str::<Record>(&line).unwrap(), record);
        }
    }

    #[test]
    fn kinds_have_the_names_of_the_journal() {
        use Kind::{Format, Name, Options, Panic, Read, Surface, Write};
        for kind in [Read, Name, Format, Surface, Options, Write, Panic] {
            assert_eq!(serde_json::to_value(kind).unwrap(), kind.name());
        }
    }
}
