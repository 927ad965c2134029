//! Parts of a list, by themselves and by GNU parallel.

use std::process::{Command, Stdio};

use super::{column, planted};
use crate::common::Folder;

const OPTIONS: &str = "-n 12 --threads 1";

#[test]
fn parts_make_the_whole() {
    let folder = Folder::new();
    let bad = planted(&folder, 50, 9);
    folder.run(&format!("batch meshes -o whole {OPTIONS}")).says(&["5 of 50 meshes failed"]);
    // All at the same time, into one folder.
    let children: Vec<_> = (1..=3)
        .map(|i| {
            Command::new(env!("CARGO_BIN_EXE_ldwrap-cli"))
                .args(format!("batch meshes -o out {OPTIONS} --shard {i}/3").split_whitespace())
                .current_dir(folder.path(""))
                .stderr(Stdio::null())
                .spawn()
                .expect("the program runs")
        })
        .collect();
    for mut child in children {
        assert!(child.wait().expect("it ends").code().is_some_and(|code| code < 2));
    }
    assert_eq!(folder.outputs("out"), folder.outputs("whole"));
    let whole = folder.summary_without_times("whole/summary.csv");
    let parts: Vec<_> =
        (1..=3).map(|i| folder.summary_without_times(&format!("out/summary.{i}-of-3.csv"))).collect();
    assert_eq!(parts.iter().map(Vec::len).collect::<Vec<_>>(), [17, 17, 16]);
    for (place, row) in whole.iter().enumerate() {
        assert_eq!(parts[place % 3][place / 3], *row);
    }
    folder.run(&format!("batch meshes -o out {OPTIONS} --summary-only")).failed_with(bad.len());
    assert_eq!(folder.summary_without_times("out/summary.csv"), whole);
    // A run of the whole finds all done but what failed; so do other parts.
    folder.run(&format!("batch meshes -o out {OPTIONS}")).says(&["45 of them before"]);
    assert_eq!(folder.summary_without_times("out/summary.csv"), whole);
    folder.run(&format!("batch meshes -o out {OPTIONS} --shard 2/2")).says(&["done, "]);
    assert!(
        folder
            .journal("out/journal.2-of-2.jsonl")
            .iter()
            .all(|record| record["result"]["status"] == "failed")
    );
}

#[test]
fn more_parts_than_meshes_leave_some_empty() {
    let folder = Folder::new();
    planted(&folder, 2, 9);
    folder.run(&format!("batch meshes -o out {OPTIONS} --shard 3/3")).ok().says(&["0 meshes: 0 done"]);
    assert_eq!(folder.text("out/summary.3-of-3.csv").lines().count(), 1);
    let ran = folder.run(&format!("batch meshes -o out {OPTIONS} --summary-only"));
    assert_eq!(ran.code, 1);
    assert_eq!(column(&folder.summary("out/summary.csv"), "status"), ["pending", "pending"]);
}

/// The commands of docs/BATCH.md, as they stand there, by a shell.
#[cfg(unix)]
#[test]
fn gnu_parallel_runs_the_parts() {
    use std::path::Path;
    let has_parallel =
        |out: std::process::Output| String::from_utf8_lossy(&out.stdout).contains("GNU parallel");
    if !Command::new("parallel").arg("--version").output().is_ok_and(has_parallel) {
        eprintln!("SKIPPED: GNU parallel is not installed (Debian: apt-get install parallel)");
        return;
    }
    let folder = Folder::new();
    planted(&folder, 30, 40);
    let program = Path::new(env!("CARGO_BIN_EXE_ldwrap-cli")).parent().expect("a folder");
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::env::join_paths([program.to_path_buf()].into_iter().chain(std::env::split_paths(&path)));
    let path = paths.expect("a path");
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/BATCH.md"))
        .expect("docs/BATCH.md");
    let start = text.find("```sh\nparallel").expect("the commands") + "```sh\n".len();
    let commands = &text[start..start + text[start..].find("```").expect("their end")];
    assert!(commands.contains("--shard {}/4") && commands.contains("--summary-only"), "{commands}");
    let ran = Command::new("sh")
        .args(["-euc", commands])
        .current_dir(folder.path(""))
        .env("PATH", path)
        .env("HOME", folder.path(""))
        .output()
        .expect("a shell");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    folder.run("batch meshes -o whole -n 1000").ok();
    assert_eq!(folder.outputs("points"), folder.outputs("whole"));
    assert_eq!(
        folder.summary_without_times("points/summary.csv"),
        folder.summary_without_times("whole/summary.csv")
    );
}

impl crate::common::Ran {
    /// The run ended in this many failures.
    #[track_caller]
    fn failed_with(self, count: usize) {
        assert_eq!(self.code, 1, "{}", self.stderr);
        self.says(&[&format!("error: {count} of ")]);
    }
}
