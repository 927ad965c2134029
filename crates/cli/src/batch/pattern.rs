//! Patterns of file names, as the shell has them: the library tells what matches, but its own walk through folders gives
//! up at names that are not UTF-8 and follows links in circles.

use std::path::{Path, PathBuf};

use glob::{MatchOptions, Pattern, PatternError};

const AS_THE_SHELL: MatchOptions =
    MatchOptions { case_sensitive: true, require_literal_separator: true, require_literal_leading_dot: true };

/// What stands for folders of any depth.
const ANY_DEPTH: &str = "**";

/// A pattern, and where to look for what it matches.
pub(crate) struct Matcher {
    folder: PathBuf,
    /// What stands behind the folder.
    whole: Pattern,
    /// Its parts, up to the first `**`.
    parts: Vec<Pattern>,
    /// Whether there is a `**`.
    any_depth: bool,
    /// Whether a part behind it begins with a dot.
    hidden: bool,
}

impl Matcher {
    pub(crate) fn new(pattern: &str) -> Result<Self, PatternError> {
        let folder = pattern_folder(Path::new(pattern));
        let behind: Vec<&str> = Path::new(pattern)
            .components()
            .skip(folder.components().count())
            .filter_map(|part| part.as_os_str().to_str())
            .collect();
        // An error tells its place in the whole.
        Pattern::new(pattern)?;
        let whole = Pattern::new(&behind.join("/"))?;
        let mut parts = Vec::new();
        for part in behind.iter().take_while(|part| **part != ANY_DEPTH) {
            parts.push(Pattern::new(part)?);
        }
        let (any_depth, hidden) =
            (parts.len() < behind.len(), behind[parts.len()..].iter().any(|part| part.starts_with('.')));
        Ok(Self { folder, whole, parts, any_depth, hidden })
    }

    /// The folder before the first part that has a wildcard; empty for the current one.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// How deep below the folder files may lie.
    pub(crate) fn most_depth(&self) -> usize {
        if self.any_depth { usize::MAX } else { self.parts.len() }
    }

    /// Whether something below the folder matches as far as it goes.
    pub(crate) fn leads_on(&self, entry: &walkdir::DirEntry) -> bool {
        // What is not UTF-8 is matched by wildcards.
        let name = entry.file_name().to_string_lossy();
        match entry.depth().checked_sub(1).and_then(|depth| self.parts.get(depth)) {
            Some(part) => part.matches_with(&name, AS_THE_SHELL),
            None => self.hidden || !name.starts_with('.'),
        }
    }

    /// The path of a file that matches, as the shell would name it.
    pub(crate) fn matched(&self, path: &Path) -> Option<PathBuf> {
        let start = if self.folder.as_os_str().is_empty() { Path::new(".") } else { &self.folder };
        let below = path.strip_prefix(start).ok()?;
        let parts: Vec<_> = below.components().map(|part| part.as_os_str().to_string_lossy()).collect();
        self.whole.matches_with(&parts.join("/"), AS_THE_SHELL).then(|| self.folder.join(below))
    }
}

/// Whether a text has wildcards.
pub(crate) fn is_pattern(text: &str) -> bool {
    text.contains(['*', '?', '[']) && Pattern::escape(text) != text
}

fn pattern_folder(pattern: &Path) -> PathBuf {
    let parts = pattern.components();
    parts.take_while(|part| !part.as_os_str().to_str().is_some_and(is_pattern)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_of_a_pattern() {
        for (pattern, folder) in [
            ("a/b/*.ply", "a/b"),
            ("*.ply", ""),
            ("/data/**/x.ply", "/data"),
            ("a/b?/c/*.obj", "a"),
            ("../[ab]/c", ".."),
        ] {
            assert_eq!(pattern_folder(Path::new(pattern)), Path::new(folder), "{pattern}");
        }
    }

    #[test]
    fn what_matches() {
        let matched = |pattern: &str, path: &str| {
            Matcher::new(pattern).expect("a pattern").matched(Path::new(path)).is_some()
        };
        for (pattern, path) in [
            ("a/*.ply", "a/b.ply"),
            ("*.ply", "./b.ply"),
            ("./*.ply", "./b.ply"),
            ("a/**/*.ply", "a/b.ply"),
            ("a/**/*.ply", "a/x/y/b.ply"),
            ("a/*/[xy]?.ply", "a/b/x\u{e4}.ply"),
            ("a/*/.b.ply", "a/x/.b.ply"),
            ("/data/*", "/data/b"),
        ] {
            assert!(matched(pattern, path), "{pattern} {path}");
        }
        for (pattern, path) in [
            ("a/*.ply", "a/x/b.ply"),
            ("a/*.ply", "a/b.PLY"),
            ("a/*.ply", "a/.b.ply"),
            ("a/**/*.ply", "a/.x/b.ply"),
            ("a/**/x/*.ply", "a/y/b.ply"),
        ] {
            assert!(!matched(pattern, path), "{pattern} {path}");
        }
        assert!(Matcher::new("a/**b").is_err() && Matcher::new("a/[b").is_err());
    }
}
