//! Instruction counts: fixed jobs under valgrind, compared with the committed counts. Times of a busy machine differ by
//! a half from run to run, counts of instructions by less than a hundredth.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::command::{cargo, command, find_program, output, run};
use crate::{Failure, in_ci, root, target};

/// The jobs of `crates/core/benches/instructions/main.rs` that are compared, each with the job that does all but the
/// stage in question: the difference is counted.
const JOBS: [(&str, &str); 11] = [
    ("ply-read", "ply-write"),
    ("check", "shape"),
    ("segment", "check"),
    ("unfold", "segment"),
    ("wrap", "unfold"),
    ("wrap-many", "unfold"),
    // All stages, of another mesh.
    ("wrap-one", "shape"),
    ("irregularity", "wrap"),
    ("equalize", "wrap"),
    ("energy", "wrap"),
    ("half-space", "wrap"),
];

/// A rise by more than this many percent fails.
const MOST_RISE: u64 = 10;

/// Counts are those of this kind of processor; others are not compared.
const ARCHITECTURE: &str = "x86_64";

const HOW_TO_RENEW: &str = "`cargo xtask instructions --renew` writes the counts as they are now";

/// What to do with the counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Then {
    /// Fail on a rise.
    Compare,
    /// Write them as the ones to compare with.
    Renew,
}

fn committed() -> PathBuf {
    root().join("crates/core/benches/instructions.csv")
}

/// Counts and compares, or renews. Where it cannot be counted says so and skips; with `CI=true` a missing valgrind is an
/// error.
///
/// # Errors
/// A job that fails, or one that takes more instructions than before.
pub fn check(then: Then) -> Result<(), Failure> {
    let Some(valgrind) = find_program("valgrind") else {
        let reason = "valgrind was not found (on Debian `apt-get install valgrind`)".to_owned();
        return if in_ci() || then == Then::Renew { Err(Failure(reason)) } else { skip(&reason) };
    };
    if std::env::consts::ARCH != ARCHITECTURE || !cfg!(target_os = "linux") {
        return skip(&format!("the committed counts are those of {ARCHITECTURE} Linux"));
    }
    let now = count_all(&valgrind, &build()?)?;
    if then == Then::Renew {
        std::fs::write(committed(), written(&now, &tools(&valgrind)))?;
        eprintln!("{} is renewed", committed().display());
        return Ok(());
    }
    let text = std::fs::read_to_string(committed())?;
    let before = read(&text)?;
    for job in JOBS.map(|(job, _)| job) {
        eprintln!("{}", line(job, before.get(job).copied(), now[job]));
    }
    let comparison = compare(&before, &now);
    if !comparison.fallen.is_empty() {
        eprintln!(
            "fewer instructions: {}. {HOW_TO_RENEW}, so that the gain is kept",
            comparison.fallen.join(", ")
        );
    }
    if comparison.risen.is_empty() {
        return Ok(());
    }
    let counted_with = text.lines().find_map(|l| l.strip_prefix("# ")).unwrap_or("unknown tools");
    Err(Failure(format!(
        "more than {MOST_RISE}% more instructions than committed (with {counted_with}; here {}): {}. If that is the price of \
         something, {HOW_TO_RENEW}",
        tools(&valgrind),
        comparison.risen.join(", ")
    )))
}

fn skip(reason: &str) -> Result<(), Failure> {
    eprintln!("SKIPPED: INSTRUCTIONS WERE NOT COUNTED: {reason}");
    Ok(())
}

/// Builds the jobs: the release profile, one thread, the instruction set that every x86-64 has, and nothing from the
/// caller's surroundings.
fn build() -> Result<PathBuf, Failure> {
    let folder = target().join("instructions");
    run(cargo()
        .args(["build", "--release", "-p", "ldwrap", "--no-default-features", "--features", "ply"])
        .args(["--example", "instructions", "--target-dir"])
        .arg(&folder)
        .env("RUSTFLAGS", "-Ctarget-cpu=x86-64")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("CARGO_BUILD_TARGET"))?;
    Ok(folder.join("release/examples/instructions"))
}

/// What the counts depend on a little.
fn tools(valgrind: &Path) -> String {
    let version =
        |c: &mut std::process::Command| output(c).unwrap_or_else(|| "a tool of unknown version".into());
    format!("{}, {}", version(command("rustc").arg("-V")), version(command(valgrind).arg("--version")))
}

/// Each compared job's count less that of the job before it.
fn count_all(valgrind: &Path, program: &Path) -> Result<BTreeMap<String, u64>, Failure> {
    let mut totals = BTreeMap::new();
    for job in JOBS.iter().flat_map(|(job, before)| [*before, *job]) {
        if !totals.contains_key(job) {
            totals.insert(job, count(valgrind, program, job)?);
        }
    }
    Ok(JOBS
        .iter()
        .map(|(job, before)| ((*job).to_owned(), totals[job].saturating_sub(totals[before])))
        .collect())
}

/// The instructions of a whole run.
fn count(valgrind: &Path, program: &Path, job: &str) -> Result<u64, Failure> {
    let output = command(valgrind)
        .args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"])
        .arg(program)
        .arg(job)
        .output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    let counted = output.status.success().then(|| references(&said)).flatten();
    counted.ok_or_else(|| Failure(format!("valgrind could not count {job}: {said}")))
}

/// The number in cachegrind's line `==1== I   refs:      1,234`, whose spacing differs between versions.
fn references(said: &str) -> Option<u64> {
    said.lines().find_map(|line| {
        let (words, number) = line.split_once("refs:")?;
        let instructions = words.split_whitespace().last() == Some("I");
        instructions.then(|| number.trim().replace(',', "").parse().ok()).flatten()
    })
}

fn line(job: &str, before: Option<u64>, now: u64) -> String {
    let change = match before {
        Some(before) => format!("{:+.1}%", 100.0 * change(before, now)),
        None => "new".to_owned(),
    };
    format!("{job:>14} {:>12.3} million instructions ({change})", now as f64 / 1e6)
}

fn change(before: u64, now: u64) -> f64 {
    now as f64 / before.max(1) as f64 - 1.0
}

/// Jobs whose counts differ by more than the allowance, as text.
#[derive(Debug, PartialEq, Eq)]
struct Comparison {
    risen: Vec<String>,
    fallen: Vec<String>,
}

/// A job without a committed count counts as risen: it would never be compared.
fn compare(before: &BTreeMap<String, u64>, now: &BTreeMap<String, u64>) -> Comparison {
    let mut comparison = Comparison { risen: Vec::new(), fallen: Vec::new() };
    for (job, &count) in now {
        match before.get(job) {
            None => comparison.risen.push(format!("{job} (not committed)")),
            Some(&before) => {
                let text = format!("{job} {:+.1}%", 100.0 * change(before, count));
                if 100 * count > (100 + MOST_RISE) * before {
                    comparison.risen.push(text);
                } else if 100 * count < (100 - MOST_RISE) * before {
                    comparison.fallen.push(text);
                }
            }
        }
    }
    comparison
}

fn written(counts: &BTreeMap<String, u64>, tools: &str) -> String {
    let mut text = format!("# {tools}\njob,instructions\n");
    for (job, _) in JOBS {
        let _ = writeln!(text, "{job},{}", counts[job]);
    }
    text
}

fn read(text: &str) -> Result<BTreeMap<String, u64>, Failure> {
    let lines = text.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty()).skip(1);
    lines
        .map(|line| {
            let (job, count) = line.split_once(',')?;
            Some((job.to_owned(), count.trim().parse().ok()?))
        })
        .collect::<Option<_>>()
        .ok_or_else(|| Failure(format!("{} is not a list of job,instructions", committed().display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(of_each: u64) -> BTreeMap<String, u64> {
        JOBS.iter().map(|(job, _)| ((*job).to_owned(), of_each)).collect()
    }

    #[test]
    fn the_committed_counts_are_those_of_the_jobs() {
        let text = std::fs::read_to_string(committed()).expect("the counts are committed");
        let committed = read(&text).expect("job,instructions");
        assert!(committed.keys().eq(counts(0).keys()));
        assert!(committed.values().all(|c| *c > 0));
    }

    #[test]
    fn counts_are_read_as_they_were_written() {
        let counts: BTreeMap<_, _> =
            (7..).step_by(1_000_000_007).zip(JOBS).map(|(n, (job, _))| (job.to_owned(), n)).collect();
        assert_eq!(read(&written(&counts, "rustc 1, valgrind 3")).expect("read"), counts);
        assert!(read("job,instructions\nwrap,many\n").is_err());
    }

    #[test]
    fn a_rise_by_more_than_a_tenth_is_told_and_only_that() {
        let before = counts(1000);
        assert_eq!(compare(&before, &before), Comparison { risen: vec![], fallen: vec![] });
        for (now, risen, fallen) in [(1100, 0, 0), (1101, 1, 0), (900, 0, 0), (899, 0, 1)] {
            let mut after = before.clone();
            after.insert("wrap".into(), now);
            let comparison = compare(&before, &after);
            assert_eq!((comparison.risen.len(), comparison.fallen.len()), (risen, fallen), "{now}");
        }
    }

    #[test]
    fn a_job_without_a_count_is_told() {
        let mut before = counts(1000);
        before.remove("energy");
        assert_eq!(compare(&before, &counts(1000)).risen, ["energy (not committed)"]);
    }

    #[test]
    fn the_count_of_instructions_is_found_in_what_cachegrind_says() {
        let said = "==7== Cachegrind, a cache profiler\n==7== \n==7== I   refs:      1,234,567\n";
        assert_eq!(references(said), Some(1_234_567));
        assert_eq!(references("==7== I refs:        12\n"), Some(12));
        assert_eq!(references("==7== D   refs:      9\n"), None);
    }
}
