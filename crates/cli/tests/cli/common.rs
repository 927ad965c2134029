//! A folder of its own for each test, small meshes, and the program.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use assert_cmd::Command;
use tempfile::TempDir;

/// A folder in which the program runs; it is gone at the end of the test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().expect("a temporary folder"))
    }

    /// A folder that holds `octahedron.obj`, a small closed mesh.
    pub(crate) fn with_octahedron() -> Self {
        let folder = Self::new();
        folder.write("octahedron.obj", OCTAHEDRON);
        folder
    }

    pub(crate) fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("a file is written");
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).expect("text")
    }

    pub(crate) fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.read(name)).expect("JSON")
    }

    /// The names of all files, hidden ones too, in order.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the folder can be listed");
        let mut names: Vec<_> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program with these arguments, separated by blanks, run in this folder.
    pub(crate) fn run(&self, arguments: &str) -> Ran {
        self.run_with_input(arguments, "")
    }

    pub(crate) fn run_with_input(&self, arguments: &str, input: impl AsRef<[u8]>) -> Ran {
        let output = Command::new(env!("CARGO_BIN_EXE_ldwrap-cli"))
            .args(arguments.split_whitespace())
            .current_dir(self.0.path())
            .write_stdin(input.as_ref())
            .timeout(Duration::from_secs(300))
            .output()
            .expect("the program runs");
        Ran {
            code: output.status.code().expect("an exit code"),
            stderr: String::from_utf8(output.stderr).expect("text on stderr"),
            stdout: output.stdout,
        }
    }
}

/// How a run ended.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
}

impl Ran {
    /// The run did what it was asked.
    #[track_caller]
    pub(crate) fn ok(self) -> Self {
        assert_eq!(self.code, 0, "stderr: {}", self.stderr);
        self
    }

    /// The run failed with one line on stderr that holds all of `words`, and printed nothing else.
    #[track_caller]
    pub(crate) fn failed(self, words: &[&str]) -> Self {
        assert_eq!(self.code, 1, "stderr: {}", self.stderr);
        assert_eq!(self.stdout, b"");
        assert!(self.stderr.starts_with("error: "), "{}", self.stderr);
        assert_eq!(self.stderr.lines().count(), 1, "{}", self.stderr);
        self.says(words)
    }

    /// The run was refused as wrong use, with all of `words` in what it says.
    #[track_caller]
    pub(crate) fn refused(self, words: &[&str]) -> Self {
        assert_eq!(self.code, 2, "stderr: {}", self.stderr);
        assert_eq!(self.stdout, b"");
        assert!(self.stderr.starts_with("error: "), "{}", self.stderr);
        self.says(words)
    }

    /// Stderr holds all of `words`.
    #[track_caller]
    pub(crate) fn says(self, words: &[&str]) -> Self {
        for word in words {
            assert!(self.stderr.contains(word), "no '{word}' in: {}", self.stderr);
        }
        self
    }

    pub(crate) fn text(&self) -> &str {
        std::str::from_utf8(&self.stdout).expect("text on stdout")
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.stdout).expect("JSON on stdout")
    }
}

/// A regular octahedron with edges of length sqrt(2), wound outward.
pub(crate) const OCTAHEDRON: &str = "\
v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n\
f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

/// Its area: 8 triangles of sqrt(3) / 2.
pub(crate) const OCTAHEDRON_AREA: f64 = 6.928_203_230_275_509;

/// A square of 2 x 2 in the plane z = 0, cut into `cells` x `cells` x 2 triangles.
pub(crate) fn square(cells: usize) -> String {
    let mut obj = String::new();
    for i in 0..=cells {
        for j in 0..=cells {
            let at = |k: usize| 2.0 * k as f64 / cells as f64;
            let _ = writeln!(obj, "v {} {} 0", at(i), at(j));
        }
    }
    for i in 0..cells {
        for j in 0..cells {
            let at = |i: usize, j: usize| i * (cells + 1) + j + 1;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            let _ = writeln!(obj, "f {a} {b} {c}\nf {a} {c} {d}");
        }
    }
    obj
}

/// The numbers of an XYZ text, a row a line.
pub(crate) fn rows(text: &str) -> Vec<Vec<f64>> {
    let number = |word: &str| word.parse::<f64>().unwrap_or_else(|_| panic!("'{word}' is not a number"));
    text.lines().map(|line| line.split_whitespace().map(number).collect()).collect()
}
