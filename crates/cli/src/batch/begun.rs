//! Which meshes were being worked on when a run was killed. One of them may be the reason, by needing more memory than
//! there is: they come last in the next run, so that it does all others first.

use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::Context;

const EXTENSION: &str = "begun";

/// A list of the outputs that were begun by this run and by those before it that were killed.
pub(crate) struct Begun {
    path: PathBuf,
    file: Mutex<File>,
    before: HashSet<String>,
}

impl Begun {
    /// Beside the folder `own` of a run, where the lists of other parts are too.
    pub(crate) fn open(own: &Path) -> anyhow::Result<Self> {
        let mut before = HashSet::new();
        let lists =
            own.parent().into_iter().flat_map(fs::read_dir).flatten().flatten().map(|entry| entry.path());
        for list in lists.filter(|path| path.extension().is_some_and(|extension| extension == EXTENSION)) {
            // A list that cannot be read is as good as none: only the order depends on it.
            let text = fs::read(list).unwrap_or_default();
            before.extend(String::from_utf8_lossy(&text).lines().map(str::to_owned));
        }
        let path = own.with_added_extension(EXTENSION);
        let file = OpenOptions::new().append(true).create(true).open(&path);
        let file = file.with_context(|| format!("{}: cannot be made", path.display()))?;
        Ok(Self { path, file: Mutex::new(file), before })
    }

    /// Whether a run was killed after it had begun with this output.
    pub(crate) fn has(&self, output: &str) -> bool {
        self.before.contains(output)
    }

    /// Notes that the work on an output begins.
    pub(crate) fn note(&self, output: &str) {
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        // Only the order of the next run depends on it.
        let _ = file.write_all(format!("{output}\n").as_bytes());
    }

    /// The run comes to its end by itself.
    pub(crate) fn finish(self) {
        let _ = fs::remove_file(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_run_had_begun_is_known_to_the_next() {
        let folder = tempfile::tempdir().unwrap();
        let (own, other) = (folder.path().join("all"), folder.path().join("1-of-2"));
        let first = Begun::open(&own).unwrap();
        first.note("a.ply");
        first.note("b/c.ply");
        assert!(!first.has("a.ply"));
        drop(first);
        for own in [&other, &own] {
            let next = Begun::open(own).unwrap();
            assert!(next.has("a.ply") && next.has("b/c.ply") && !next.has("c.ply"));
            next.finish();
        }
        assert!(!Begun::open(&other).unwrap().has("a.ply"));
    }
}
