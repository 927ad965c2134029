//! Which meshes: files, folders, patterns and lists, in an order that is the same on every machine.

use std::collections::HashSet;
use std::fs;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, anyhow};
use walkdir::WalkDir;

use crate::args::BatchArgs;
use crate::batch::Task;
use crate::batch::names::{Naming, mesh_extension};
use crate::batch::pattern::{Matcher, is_pattern};
use crate::batch::record::{Kind, Trouble};
use crate::exit::{Failure, Outcome};

/// Finds all meshes, each once, with the names of their outputs.
pub(crate) fn find(args: &BatchArgs, naming: &Naming) -> Outcome<Vec<Task>> {
    let mut finder = Finder { naming, out: fs::canonicalize(&args.outputs.output).ok(), tasks: Vec::new() };
    for input in &args.inputs {
        finder.add_typed(input)?;
    }
    if let Some(list) = &args.list {
        for path in listed(list)? {
            finder.add_named(&path)?;
        }
    }
    let mut seen = HashSet::new();
    let mut tasks = finder.tasks;
    tasks.retain(|task| seen.insert((plain(&task.input), task.output.clone().ok())));
    if tasks.is_empty() {
        return Err(anyhow!("no mesh was found: name files, folders or patterns that have some").into());
    }
    Ok(tasks)
}

/// The paths in a list, one a line.
fn listed(list: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut bytes = Vec::new();
    if list.as_os_str() == "-" {
        std::io::stdin().lock().read_to_end(&mut bytes).context("stdin: cannot be read")?;
    } else {
        bytes = fs::read(list).with_context(|| format!("{}: cannot be read", list.display()))?;
    }
    let text = String::from_utf8_lossy(&bytes);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    Ok(text.lines().filter(|line| !line.is_empty()).map(PathBuf::from).collect())
}

struct Finder<'a> {
    naming: &'a Naming,
    /// OUT_DIR, if there is one yet: its files are outputs, not inputs.
    out: Option<PathBuf>,
    tasks: Vec<Task>,
}

impl Finder<'_> {
    /// What was typed: it may be a pattern.
    fn add_typed(&mut self, path: &Path) -> Outcome {
        if path.as_os_str() == "-" {
            return Err(Failure::wrong_use(
                "-: meshes come from files: add --list - to read their names from stdin",
            ));
        }
        match path.to_str() {
            Some(text) if is_pattern(text) && !path.exists() => self.add_matches(text),
            _ => self.add_named(path),
        }
    }

    /// A file or a folder. One that is not there is told in the summary.
    fn add_named(&mut self, path: &Path) -> Outcome {
        if path.is_dir() { self.add_folder(path) } else { self.add_file(path, path.parent()) }
    }

    fn add_matches(&mut self, pattern: &str) -> Outcome {
        let wrong = |problem: &str| Failure::wrong_use(format!("{pattern}: {problem}"));
        let matcher = Matcher::new(pattern).map_err(|error| wrong(error.msg))?;
        let start = matcher.folder();
        let before = self.tasks.len();
        // A pattern that starts in OUT_DIR means what lies there.
        let out = self.out.clone().filter(|_| !self.is_output(start));
        let walk = WalkDir::new(if start.as_os_str().is_empty() { Path::new(".") } else { start });
        let walk = walk.min_depth(1).max_depth(matcher.most_depth()).follow_links(true).sort_by_file_name();
        let is_wanted = |entry: &walkdir::DirEntry| {
            entry.depth() == 0 || (matcher.leads_on(entry) && !is_folder(entry, out.as_deref()))
        };
        for entry in walk.into_iter().filter_entry(is_wanted) {
            match entry {
                Ok(entry) if entry.file_type().is_dir() => {}
                Ok(entry) => {
                    if let Some(path) = matcher.matched(entry.path()) {
                        self.add_file(&path, Some(start))?;
                    }
                }
                // A link to a folder above: its files are found there.
                Err(error) if error.loop_ancestor().is_some() => {}
                Err(error) => match error.path() {
                    Some(path) if is_link(path) => {
                        if let Some(path) = matcher.matched(path) {
                            self.add_file(&path, Some(start))?;
                        }
                    }
                    Some(path) if path.exists() => self.add_unlisted(path, &reason(&error)),
                    _ => {}
                },
            }
        }
        if self.tasks.len() == before {
            return Err(wrong("no file matches this pattern"));
        }
        Ok(())
    }

    fn add_folder(&mut self, folder: &Path) -> Outcome {
        if self.out.is_some() && fs::canonicalize(folder).ok() == self.out {
            return Err(Failure::wrong_use(format!(
                "{}: --output is the folder of the meshes itself: choose another one, which may be in it",
                folder.display()
            )));
        }
        let walk = WalkDir::new(folder).min_depth(1).follow_links(true).sort_by_file_name().into_iter();
        let out = self.out.clone();
        let is_shown = move |entry: &walkdir::DirEntry| {
            !entry.file_name().as_encoded_bytes().starts_with(b".") && !is_folder(entry, out.as_deref())
        };
        for entry in walk.filter_entry(is_shown) {
            match entry {
                Ok(entry) if entry.file_type().is_dir() => {}
                Ok(entry) if mesh_extension(entry.path()).is_some() => {
                    self.add_file(entry.path(), Some(folder))?
                }
                Ok(_) => {}
                // A link to a folder above: its files are found there.
                Err(error) if error.loop_ancestor().is_some() => {}
                Err(error) => self.add_missing(folder, &error)?,
            }
        }
        Ok(())
    }

    /// Something in a folder that cannot be opened: a file that a link promises, or a folder.
    fn add_missing(&mut self, folder: &Path, error: &walkdir::Error) -> Outcome {
        let path = error.path().unwrap_or(folder);
        if !is_link(path) {
            self.add_unlisted(path, &reason(error));
        } else if mesh_extension(path).is_some() {
            return self.add_file(path, Some(folder));
        }
        Ok(())
    }

    fn add_unlisted(&mut self, folder: &Path, problem: &str) {
        let message = format!("the folder cannot be listed: {problem}");
        self.tasks
            .push(Task { input: folder.to_path_buf(), output: Err(Trouble { kind: Kind::Read, message }) });
    }

    fn add_file(&mut self, path: &Path, start: Option<&Path>) -> Outcome {
        let output = self.naming.output(path, start.unwrap_or(Path::new("")))?;
        // `-` alone would be stdin.
        let input = if path.as_os_str() == "-" { Path::new(".").join(path) } else { path.to_path_buf() };
        self.tasks.push(Task { input, output });
        Ok(())
    }

    /// Whether a folder is OUT_DIR or in it.
    fn is_output(&self, folder: &Path) -> bool {
        let Some(out) = &self.out else { return false };
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        fs::canonicalize(folder).is_ok_and(|folder| folder.starts_with(out))
    }
}

/// Whether an entry is this folder. Asking for the full path of every folder is cheap; of every file it is not.
fn is_folder(entry: &walkdir::DirEntry, folder: Option<&Path>) -> bool {
    entry.file_type().is_dir()
        && folder.is_some_and(|folder| fs::canonicalize(entry.path()).is_ok_and(|entry| entry == folder))
}

fn is_link(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink())
}

fn reason(error: &walkdir::Error) -> String {
    error.io_error().map_or_else(|| error.to_string(), ToString::to_string)
}

/// A path without `.` in it.
fn plain(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_the_same_without_dots() {
        assert_eq!(plain(Path::new("./a/./b.ply")), plain(Path::new("a/b.ply")));
        assert_ne!(plain(Path::new("../a")), plain(Path::new("a")));
    }
}
