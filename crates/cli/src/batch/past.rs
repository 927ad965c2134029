//! What earlier runs did, by the journals.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use crate::batch::Task;
use crate::batch::record::{Record, Source};

/// The last record of each output.
pub(crate) struct Past(HashMap<String, Record>);

/// Where the work on a mesh stands.
#[derive(Debug, PartialEq)]
pub(crate) enum State {
    /// Its points are there, made of this mesh with these options.
    Finished(Record),
    /// Points are there, but made with other options, by another version, or of another mesh.
    Foreign(Record),
    /// There are none; the record says why, if it was tried.
    Open(Option<Record>),
}

impl Past {
    /// From the records of each journal. Of several with the same output the last of a journal counts, and of several
    /// journals the one that was written latest.
    pub(crate) fn new(journals: Vec<Vec<Record>>) -> Self {
        let mut latest: HashMap<String, (usize, Record)> = HashMap::new();
        for (journal, records) in journals.into_iter().enumerate() {
            for record in records {
                let Some(output) = &record.output else { continue };
                let counts = |&(of, ref known): &(usize, Record)| of == journal || known.at <= record.at;
                if latest.get(output).is_none_or(counts) {
                    latest.insert(output.clone(), (journal, record));
                }
            }
        }
        Self(latest.into_iter().map(|(output, (_, record))| (output, record)).collect())
    }

    /// Where a mesh stands whose points go below `out`, by the `options` of this run.
    pub(crate) fn state(&self, task: &Task, out: &Path, options: &str) -> State {
        let Some((output, record)) =
            task.output.as_ref().ok().and_then(|output| Some((output, self.0.get(output)?)))
        else {
            return State::Open(None);
        };
        let fits = record.version == env!("CARGO_PKG_VERSION") && record.options == options;
        let Some(made) = record.made() else { return State::Open(fits.then(|| record.clone())) };
        let is_there = |file: fs::Metadata| file.is_file() && file.len() == made.bytes;
        if !fs::metadata(out.join(output)).is_ok_and(is_there) {
            return State::Open(None);
        }
        if !fits {
            return State::Foreign(record.clone());
        }
        // The path may be written in another way now. A mesh that has gone since cannot be made anew: its points stay.
        let input = task.input.display().to_string();
        let is_same = fs::metadata(&task.input).map_or(true, |file| Some(Source::of(&file)) == record.source);
        match (is_same, input == record.input) {
            (true, _) => State::Finished(Record { input, ..record.clone() }),
            (false, true) => State::Open(None),
            (false, false) => State::Foreign(record.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::batch::record::tests::{done, failed};

    /// A folder with a mesh `in` of 7 bytes and points `a.ply` of 3, and the record that says so.
    fn finished() -> (tempfile::TempDir, Task, Record) {
        let out = tempfile::tempdir().unwrap();
        let input = out.path().join("in");
        fs::write(&input, "a mesh!").unwrap();
        fs::write(out.path().join("a.ply"), "abc").unwrap();
        let source = Some(Source::of(&fs::metadata(&input).unwrap()));
        let record = Record { input: input.display().to_string(), source, ..done("a.ply", "x", 5) };
        (out, Task { input, output: Ok("a.ply".to_owned()) }, record)
    }

    #[test]
    fn points_that_are_there_are_finished() {
        let (out, task, record) = finished();
        let state = |records, options| Past::new(vec![records]).state(&task, out.path(), options);
        assert_eq!(state(vec![record.clone()], "x"), State::Finished(record.clone()));
        assert_eq!(state(vec![], "x"), State::Open(None));
        assert_eq!(state(vec![record.clone()], "y"), State::Foreign(record.clone()));
        let old = Record { version: "0.0.1".to_owned(), ..record.clone() };
        assert_eq!(state(vec![old.clone()], "x"), State::Foreign(old));
        // In one journal the last counts, of several journals the latest.
        let (earlier, later) = (failed("a.ply", "x", 4), failed("a.ply", "x", 6));
        assert_eq!(state(vec![later.clone(), record.clone()], "x"), State::Finished(record.clone()));
        assert_eq!(state(vec![record.clone(), earlier.clone()], "x"), State::Open(Some(earlier.clone())));
        let state = |journals: [&Record; 2]| {
            Past::new(journals.map(|record| vec![record.clone()]).to_vec()).state(&task, out.path(), "x")
        };
        for journals in [[&record, &later], [&later, &record]] {
            assert_eq!(state(journals), State::Open(Some(later.clone())));
        }
        for journals in [[&record, &earlier], [&earlier, &record]] {
            assert_eq!(state(journals), State::Finished(record.clone()));
        }
    }

    #[test]
    fn points_that_are_not_whole_are_open() {
        let (out, task, record) = finished();
        let past = Past::new(vec![vec![record]]);
        fs::write(out.path().join("a.ply"), "ab").unwrap();
        assert_eq!(past.state(&task, out.path(), "x"), State::Open(None));
        fs::remove_file(out.path().join("a.ply")).unwrap();
        assert_eq!(past.state(&task, out.path(), "x"), State::Open(None));
        assert_eq!(past.state(&task, out.path(), "y"), State::Open(None));
    }

    #[test]
    fn another_mesh_is_not_the_same() {
        let (out, task, record) = finished();
        let past = Past::new(vec![vec![record.clone()]]);
        fs::write(&task.input, "a longer mesh").unwrap();
        assert_eq!(past.state(&task, out.path(), "x"), State::Open(None));
        let elsewhere = Task { input: out.path().join("./in"), ..task.clone() };
        assert_eq!(past.state(&elsewhere, out.path(), "x"), State::Foreign(record.clone()));
        fs::remove_file(&task.input).unwrap();
        assert_eq!(past.state(&task, out.path(), "x"), State::Finished(record));
        let nothing = Task { input: PathBuf::from("x"), output: Ok("b.ply".to_owned()) };
        assert_eq!(past.state(&nothing, out.path(), "x"), State::Open(None));
    }
}
