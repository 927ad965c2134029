//! A short run of every fuzz target.

use std::fs;
use std::process::Stdio;

use crate::command::{command, find_program, run};
use crate::{Failure, root, target};

/// Where `cargo fuzz` looks for the targets.
const CRATE: &str = "crates/core";

/// How the targets are built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// In little time: with overflow checks, without a sanitizer. The library has no unsafe code.
    Quick,
    /// Optimised, with the address sanitizer, which also watches what the libraries below do.
    Sanitized,
}

impl Build {
    fn arguments(self) -> &'static [&'static str] {
        match self {
            Self::Quick => &["--dev", "--sanitizer", "none"],
            Self::Sanitized => &[],
        }
    }
}

/// Fuzzes every target for `seconds`, from its committed corpus on; what is new stays in the target folder. Without
/// `cargo-fuzz` or a nightly compiler nothing is fuzzed, which is said: the tests replay the corpus in any case.
///
/// # Errors
/// A target that does not build, or an input that breaks a promise; its file is named.
pub fn run_all(seconds: u32, build: Build) -> Result<(), Failure> {
    if let Some(missing) = missing() {
        eprintln!(
            "SKIPPED: FUZZING: {missing}; `cargo install cargo-fuzz --locked` and `rustup toolchain install nightly` \
             would enable it. The corpus is replayed by the tests."
        );
        return Ok(());
    }
    let built = target().join("fuzz");
    run(command("cargo")
        .args(["+nightly", "fuzz", "build"])
        .args(build.arguments())
        .arg("--target-dir")
        .arg(&built)
        .current_dir(root().join(CRATE))
        .env_remove("RUSTUP_TOOLCHAIN")
        .env_remove("CARGO")
        .env_remove("RUSTC"))?;
    for name in targets()? {
        let found = built.join("found").join(&name);
        let broken = built.join("broken").join(&name);
        fs::create_dir_all(&found)?;
        fs::create_dir_all(&broken)?;
        run(command("cargo")
            .args(["+nightly", "fuzz", "run"])
            .args(build.arguments())
            .arg("--target-dir")
            .arg(&built)
            .arg(&name)
            .arg(&found)
            .arg(root().join(CRATE).join("fuzz/corpus").join(&name))
            .arg("--")
            .arg(format!("-max_total_time={seconds}"))
            .arg(format!("-artifact_prefix={}/", broken.display()))
            .args(["-rss_limit_mb=2048", "-timeout=20", "-max_len=4096", "-verbosity=0"])
            .arg("-print_final_stats=1")
            .current_dir(root().join(CRATE))
            .env_remove("RUSTUP_TOOLCHAIN")
            .env_remove("CARGO")
            .env_remove("RUSTC"))?;
    }
    Ok(())
}

/// What is not there.
fn missing() -> Option<&'static str> {
    if find_program("cargo-fuzz").is_none() {
        return Some("there is no cargo-fuzz");
    }
    let nightly = command("cargo")
        .args(["+nightly", "--version"])
        .env_remove("RUSTUP_TOOLCHAIN")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if nightly.is_ok_and(|status| status.success()) { None } else { Some("there is no nightly compiler") }
}

/// The targets, by name.
fn targets() -> Result<Vec<String>, Failure> {
    let mut names = Vec::new();
    for entry in fs::read_dir(root().join(CRATE).join("fuzz/fuzz_targets"))? {
        let path = entry?.path();
        names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
    }
    names.sort();
    Ok(names)
}
