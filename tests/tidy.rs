//! The repository itself: what every file must keep, checked by reading them.

use std::fs;
use std::path::{Path, PathBuf};

/// Longer files are listed, so that a person looks whether they hold one thing.
const LONG: usize = 500;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in the workspace").to_owned()
}

/// All text files of the repository, by extension, without what is built or fetched.
fn files(extensions: &[&str]) -> Vec<PathBuf> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        let mut entries: Vec<_> =
            fs::read_dir(folder).expect("readable folder").map(|e| e.expect("entry")).collect();
        entries.sort_by_key(fs::DirEntry::file_name);
        for entry in entries {
            let name = entry.file_name().into_string().expect("names are UTF-8");
            if entry.file_type().expect("type").is_dir() {
                if !["target", ".git", "node_modules", "artefacts", "corpus"].contains(&name.as_str()) {
                    walk(&entry.path(), found);
                }
            } else {
                found.push(entry.path());
            }
        }
    }
    let mut found = Vec::new();
    walk(&root(), &mut found);
    found.retain(|p| p.extension().and_then(|e| e.to_str()).is_some_and(|e| extensions.contains(&e)));
    assert!(!found.is_empty(), "no file with {extensions:?} under {}", root().display());
    found
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// Lines that hold one of `words`, as `file:line: text`; this file, which names them, is left out.
fn lines_with(words: &[String], extensions: &[&str]) -> Vec<String> {
    let mut hits = Vec::new();
    for path in files(extensions).into_iter().filter(|p| !p.ends_with("tests/tidy.rs")) {
        for (number, line) in read(&path).lines().enumerate() {
            if words.iter().any(|w| line.contains(w.as_str())) {
                hits.push(format!("{}:{}: {}", shown(&path), number + 1, line.trim()));
            }
        }
    }
    hits
}

#[test]
fn no_path_of_one_machine() {
    let words = ["/work/", "/tmp/", "/root/", "/home/", "/Users/", "C:\\\\"].map(str::to_owned);
    let hits = lines_with(&words, &["rs", "toml", "md", "js", "mjs", "ts", "html", "json", "svg", "yml"]);
    assert!(hits.is_empty(), "paths that only one machine has:\n{}", hits.join("\n"));
}

#[test]
fn nothing_is_left_to_do() {
    let words = ["TODO", "FIXME", "XXX", "HACK", "todo!(", "unimplemented!(", "STUB"].map(str::to_owned);
    let hits = lines_with(&words, &["rs", "toml", "js", "mjs", "ts", "html"]);
    assert!(hits.is_empty(), "work that is left:\n{}", hits.join("\n"));
}

#[test]
fn every_source_file_says_what_it_is() {
    let silent: Vec<_> = files(&["rs"])
        .into_iter()
        .filter(|path| !read(path).trim_start().starts_with("//!"))
        .map(|path| shown(&path))
        .collect();
    assert!(silent.is_empty(), "no head comment (//!):\n{}", silent.join("\n"));
}

#[test]
fn long_files_are_listed() {
    for path in files(&["rs"]) {
        let lines = read(&path).lines().count();
        if lines > LONG {
            eprintln!("{}: {lines} lines: does it hold one thing?", shown(&path));
        }
        assert!(lines <= 2 * LONG, "{}: {lines} lines are more than one thing", shown(&path));
    }
}

/// Words in backticks that look like paths of this repository.
fn named_paths(text: &str) -> Vec<&str> {
    let tops = ["crates/", "tests/", "xtask/", "assets/", "docs/", ".ci/", ".cargo/"];
    text.split('`')
        .skip(1)
        .step_by(2)
        .filter(|w| tops.iter().any(|t| w.starts_with(t)) && !w.contains(['*', ' ', '{', '<']))
        .collect()
}

#[test]
fn documents_name_files_that_exist() {
    let mut missing = Vec::new();
    for path in files(&["md"]) {
        for name in named_paths(&read(&path)) {
            let file = name.split([':', '#']).next().unwrap_or(name);
            if !root().join(file).exists() {
                missing.push(format!("{}: {name}", shown(&path)));
            }
        }
    }
    assert!(missing.is_empty(), "files named in documents that do not exist:\n{}", missing.join("\n"));
}
