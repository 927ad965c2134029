//! The journal: a line for each mesh as soon as it is done with, safe on the disk. Each part of a list has its own, and
//! one run at a time may write it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::args::Shard;
use crate::batch::record::Record;
use crate::exit::Outcome;

/// In OUT_DIR: locks, and outputs that are not complete yet.
const HIDDEN: &str = ".ldwrap-batch";

/// The journal of this run, which no other run can write meanwhile.
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
    /// Where outputs grow before they get their names.
    temporaries: PathBuf,
    /// Held to the end of the run; the system lets go of it however the run ends.
    _lock: File,
}

impl Journal {
    /// Opens or makes the journal in the folder `out`, which is there, and clears away what a killed run left half done.
    pub(crate) fn open(out: &Path, shard: Option<Shard>) -> Outcome<Self> {
        let hidden = out.join(HIDDEN);
        let own = shard.map_or_else(|| "all".to_owned(), |shard| shard.to_string());
        let temporaries = hidden.join(&own);
        let cannot = |path: &Path| format!("{}: cannot be made", path.display());
        fs::create_dir_all(&temporaries).with_context(|| cannot(&temporaries))?;
        let Some(lock) = Lock::take(&hidden.join(format!("{own}.lock")))? else {
            let what =
                shard.map_or_else(|| "this folder".to_owned(), |shard| format!("the part {shard} of it"));
            let problem = format!("another run works on {what}: wait for it, or use --shard to run several");
            return Err(anyhow::anyhow!("{}: {problem}", out.display()).into());
        };
        clear(&temporaries)?;
        if shard.is_none() && lock.works {
            clear_abandoned(&hidden, &own)?;
        }
        let path = out.join(name(shard));
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .with_context(|| format!("{}: cannot be opened", path.display()))?;
        cut_torn(&mut file).with_context(|| format!("{}: cannot be mended", path.display()))?;
        Ok(Self { path, file, temporaries, _lock: lock.file })
    }

    /// Adds a line and waits until the disk has it.
    pub(crate) fn append(&mut self, record: &Record) -> anyhow::Result<()> {
        let mut line = serde_json::to_vec(record)?;
        line.push(b'\n');
        let written = self.file.write_all(&line).and_then(|()| self.file.sync_data());
        written.with_context(|| format!("{}: cannot be written", self.path.display()))
    }

    /// A folder for files that are not complete yet, on the same disk as the outputs.
    pub(crate) fn temporaries(&self) -> &Path {
        &self.temporaries
    }
}

/// The name of a journal.
fn name(shard: Option<Shard>) -> String {
    shard.map_or_else(|| "journal.jsonl".to_owned(), |shard| format!("journal.{shard}.jsonl"))
}

/// The records of each journal in a folder, in the order in which they were written. Lines that are torn are left out:
/// what they tell of is done again.
pub(crate) fn read_all(out: &Path) -> anyhow::Result<Vec<Vec<Record>>> {
    let entries = fs::read_dir(out).with_context(|| format!("{}: cannot be listed", out.display()))?;
    let mut names = Vec::new();
    for entry in entries {
        let name = entry.with_context(|| format!("{}: cannot be listed", out.display()))?.file_name();
        if name.to_str().is_some_and(|name| name.starts_with("journal.") && name.ends_with(".jsonl")) {
            names.push(name);
        }
    }
    names.sort();
    let mut journals = Vec::new();
    for name in names {
        let path = out.join(name);
        let bytes = fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
        let lines = complete(&bytes).split(|&byte| byte == b'\n');
        journals.push(lines.filter_map(|line| serde_json::from_slice(line).ok()).collect());
    }
    Ok(journals)
}

/// Everything up to the last end of a line.
fn complete(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    &bytes[..end]
}

/// Cuts off a line without an end, and goes to the end of the file.
fn cut_torn(file: &mut File) -> std::io::Result<()> {
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    let kept = complete(&bytes).len() as u64;
    if kept < bytes.len() as u64 {
        file.set_len(kept)?;
    }
    file.seek(SeekFrom::Start(kept))?;
    Ok(())
}

struct Lock {
    file: File,
    /// Whether the file system has locks at all; some of clusters have none.
    works: bool,
}

impl Lock {
    /// `None` if another process has it.
    fn take(path: &Path) -> anyhow::Result<Option<Self>> {
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(path);
        let file = file.with_context(|| format!("{}: cannot be made", path.display()))?;
        Ok(match file.try_lock() {
            Ok(()) => Some(Self { file, works: true }),
            Err(TryLockError::WouldBlock) => None,
            Err(TryLockError::Error(_)) => Some(Self { file, works: false }),
        })
    }
}

fn clear(folder: &Path) -> anyhow::Result<()> {
    let cleared = fs::read_dir(folder)
        .and_then(|mut entries| entries.try_for_each(|entry| fs::remove_file(entry?.path())));
    cleared.with_context(|| format!("{}: cannot be cleared", folder.display()))
}

/// Clears the temporary files of the parts that nobody works on now.
fn clear_abandoned(hidden: &Path, own: &str) -> anyhow::Result<()> {
    let entries = fs::read_dir(hidden).with_context(|| format!("{}: cannot be listed", hidden.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() && !path.ends_with(own) && Lock::take(&path.with_added_extension("lock"))?.is_some()
        {
            clear(&path)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::record::tests::{done, failed};

    fn opened(out: &Path, shard: Option<&str>) -> Outcome<Journal> {
        Journal::open(out, shard.map(|shard| shard.parse().unwrap()))
    }

    #[test]
    fn what_is_written_is_read_again() {
        let out = tempfile::tempdir().unwrap();
        let records = [done("a.ply", "x", 1), failed("b.ply", "x", 2), done("b.ply", "x", 3)];
        for record in &records {
            opened(out.path(), None).unwrap().append(record).unwrap();
        }
        assert_eq!(read_all(out.path()).unwrap(), [records.to_vec()]);
        let mut part = opened(out.path(), Some("1/2")).unwrap();
        part.append(&records[0]).unwrap();
        let part = vec![records[0].clone()];
        assert_eq!(read_all(out.path()).unwrap(), [part, records.to_vec()]);
    }

    #[test]
    fn a_torn_line_is_cut_wherever_it_is_torn() {
        let out = tempfile::tempdir().unwrap();
        let path = out.path().join("journal.jsonl");
        let (first, second) = (done("a.ply", "x", 1), done("b.ply", "x", 2));
        let line = serde_json::to_string(&first).unwrap();
        for cut in 0..line.len() {
            fs::write(&path, format!("{line}\n{}", &line[..cut])).unwrap();
            assert_eq!(read_all(out.path()).unwrap(), [vec![first.clone()]]);
            opened(out.path(), None).unwrap().append(&second).unwrap();
            assert_eq!(read_all(out.path()).unwrap(), [vec![first.clone(), second.clone()]]);
        }
    }

    #[test]
    fn one_run_at_a_time_has_a_journal() {
        let out = tempfile::tempdir().unwrap();
        let all = opened(out.path(), None).unwrap();
        assert!(opened(out.path(), None).is_err());
        let part = opened(out.path(), Some("1/2")).unwrap();
        assert!(opened(out.path(), Some("1/2")).is_err());
        assert!(opened(out.path(), Some("2/2")).is_ok());
        drop((all, part));
        assert!(opened(out.path(), None).is_ok() && opened(out.path(), Some("1/2")).is_ok());
    }

    #[test]
    fn what_killed_runs_left_is_cleared() {
        let out = tempfile::tempdir().unwrap();
        let (one, two) = (opened(out.path(), Some("1/2")).unwrap(), opened(out.path(), Some("2/2")).unwrap());
        let left = [&one, &two].map(|journal| journal.temporaries().join(".ldwrap-x"));
        for left in &left {
            fs::write(left, "half").unwrap();
        }
        drop(one);
        // The second is at work, so what it has is not touched.
        drop(opened(out.path(), None).unwrap());
        assert!(!left[0].exists() && left[1].exists());
        drop(two);
        drop(opened(out.path(), Some("2/2")).unwrap());
        assert!(!left[1].exists());
    }
}
