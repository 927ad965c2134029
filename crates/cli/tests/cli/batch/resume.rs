//! Runs that are killed, and what the next one makes of what it finds.

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::{column, planted};
use crate::common::{Folder, OCTAHEDRON, square};

/// Starts a run and kills it when the journal has so many lines more. Returns whether it was killed before it ended.
fn killed_after(folder: &Folder, arguments: &str, journal: &str, more: usize) -> bool {
    let lines =
        || std::fs::read(folder.path(journal)).map_or(0, |text| text.iter().filter(|&&b| b == b'\n').count());
    let before = lines();
    let mut child = Command::new(env!("CARGO_BIN_EXE_ldwrap-cli"))
        .args(arguments.split_whitespace())
        .current_dir(folder.path(""))
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs");
    while lines() < before + more && child.try_wait().expect("a state").is_none() {
        sleep(Duration::from_millis(1));
    }
    // On Unix this is SIGKILL: the program can do nothing about it.
    child.kill().expect("it can be killed");
    let status = child.wait().expect("it ends");
    status.code().is_none_or(|code| code > 2)
}

#[test]
fn a_run_that_is_killed_goes_on_without_loss() {
    const COUNT: usize = 1000;
    let folder = Folder::new();
    let bad = planted(&folder, COUNT, 23);
    let options = "-n 12 --jobs 4";
    let whole = folder.run(&format!("batch meshes -o whole {options}"));
    assert_eq!(whole.code, 1, "{}", whole.stderr);
    assert!(!whole.stderr.contains("panicked"), "{}", whole.stderr);

    let run = format!("batch meshes -o out {options}");
    let mut killed = 0;
    for more in [150, 0, 300, 1] {
        killed += usize::from(killed_after(&folder, &run, "out/journal.jsonl", more));
        // A power cut may leave a line torn, and the moment of the kill a file half written.
        let mut journal = OpenOptions::new()
            .append(true)
            .create(true)
            .open(folder.path("out/journal.jsonl"))
            .expect("a journal");
        journal.write_all(br#"{"input":"meshes/part-0/0000.ply","output":"part-0/00"#).expect("half a line");
        folder.put("out/.ldwrap-batch/all/.ldwrap-half", "ply");
        let done = folder.text("out/journal.jsonl").lines().filter(|line| line.contains("\"done\"")).count();
        assert!(done < COUNT - bad.len(), "it was killed too late");
    }
    assert!(killed >= 3, "{killed} runs were killed");
    let outputs = folder.outputs("out");
    assert!(outputs.len() > 100 && outputs.len() < COUNT - bad.len(), "{}", outputs.len());

    let last = folder.run(&run);
    assert_eq!(last.code, 1, "{}", last.stderr);
    // The same bits, and the same summary but for the times.
    let (out, whole) = (folder.outputs("out"), folder.outputs("whole"));
    assert_eq!(out.len(), COUNT - bad.len());
    assert!(out == whole, "outputs differ");
    let rows = folder.summary_without_times("out/summary.csv");
    assert_eq!(rows, folder.summary_without_times("whole/summary.csv"));
    assert_eq!(rows.len(), COUNT);
    // Nothing was made twice, and nothing half done is left.
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    for record in folder.journal("out/journal.jsonl") {
        if record["result"]["status"] == "done" {
            *times.entry(record["output"].as_str().expect("a name").to_owned()).or_default() += 1;
        }
    }
    assert!(times.len() == COUNT - bad.len() && times.values().all(|&times| times == 1));
    let left = std::fs::read_dir(folder.path("out/.ldwrap-batch/all")).expect("a folder").count();
    assert_eq!(left, 0);
    for (name, kind) in bad {
        let row = rows.iter().find(|row| row["input"] == format!("meshes/{name}")).expect("a row");
        assert_eq!((&*row["status"], &*row["error_kind"]), ("failed", kind), "{row:?}");
    }
}

/// Two meshes, done with `-n 10`.
fn done() -> Folder {
    let folder = Folder::new();
    folder.put("in/a.obj", OCTAHEDRON);
    folder.put("in/b.obj", square(4));
    folder.run("batch in -o out -n 10").ok().says(&["2 meshes: 2 done, 0 of them before; 0 failed"]);
    folder
}

#[test]
fn what_is_done_is_not_done_again() {
    let folder = done();
    let (journal, summary) = (folder.text("out/journal.jsonl"), folder.text("out/summary.csv"));
    folder.run("batch in -o out -n 10").ok().says(&["2 meshes: 2 done, 2 of them before"]);
    assert_eq!((folder.text("out/journal.jsonl"), folder.text("out/summary.csv")), (journal, summary));
    // Jobs, threads and how the path is written are no options of the points.
    folder.run("batch ./in/ -o out -n 10 --jobs 1 --threads 1").ok().says(&["2 of them before"]);
    assert_eq!(column(&folder.summary("out/summary.csv"), "input"), ["./in/a.obj", "./in/b.obj"]);
    // Without a record or without the whole file it is.
    let points = folder.read("out/a.ply");
    for damage in [&points[..points.len() - 1], &[]] {
        folder.write("out/a.ply", damage);
        folder.run("batch in -o out -n 10").ok().says(&["2 done, 1 of them before"]);
        assert_eq!(folder.read("out/a.ply"), points);
    }
    std::fs::remove_file(folder.path("out/b.ply")).expect("removed");
    folder.run("batch in -o out -n 10").ok().says(&["2 done, 1 of them before"]);
    std::fs::remove_file(folder.path("out/journal.jsonl")).expect("removed");
    folder.run("batch in -o out -n 10").ok().says(&["2 done, 0 of them before"]);
}

#[test]
fn other_options_are_not_mixed_in() {
    let folder = done();
    let before = folder.outputs("out");
    folder.write("weights.txt", "1\n2\n3\n4\n5\n6\n7\n8\n");
    for options in [
        "-n 11",
        "-n 10 --seed 1",
        "-n 10 --no-equalize",
        "-n 10 --attributes uv",
        "-n 10 --keep-winding",
        "-n 10 --eta",
        "-n 10 --weights weights.txt",
        "-n 10 --weights-by red",
        "-n 10 --mesh-format obj",
        "-n 10 --only part:x",
    ] {
        let run = folder.run(&format!("batch in -o out {options}"));
        run.refused(&["out/a.ply", "other options", "--redo"]);
        assert_eq!(folder.outputs("out"), before, "{options}");
    }
    folder.run("batch in -o out -n 11 --redo").ok().says(&["2 done, 0 of them before"]);
    assert_eq!(column(&folder.summary("out/summary.csv"), "points"), ["11", "11"]);
    folder.run("batch in -o out -n 11 --redo").ok().says(&["2 of them before"]);
    folder.run("batch in -o out -n 10").refused(&["other options"]);
    // Where the new options fail, the old points go.
    folder.run("batch in -o out -n 11 --attributes uv --redo").says(&["2 of 2 meshes failed"]);
    assert!(folder.outputs("out").is_empty());
    folder.run("batch in -o out -n 10").ok().says(&["2 done, 0 of them before"]);
    assert_eq!(folder.outputs("out"), before);
    // Another version may make other points.
    let journal = folder.text("out/journal.jsonl").replace(env!("CARGO_PKG_VERSION"), "0.0.9");
    folder.write("out/journal.jsonl", journal);
    folder.run("batch in -o out -n 10").refused(&["by version 0.0.9", "--redo"]);
}

#[test]
fn a_mesh_that_changed_is_done_again() {
    let folder = done();
    folder.put("in/a.obj", square(3));
    folder.run("batch in -o out -n 10").ok().says(&["2 done, 1 of them before"]);
    assert_eq!(column(&folder.summary("out/summary.csv"), "triangles"), ["18", "32"]);
    folder.put("in/a.obj", "v 0 0 0");
    folder.run("batch in -o out -n 10").says(&["1 of 2 meshes failed"]);
    assert_eq!(folder.outputs("out").into_keys().collect::<Vec<_>>(), ["b.ply"]);
    // Points of a mesh of another folder are not taken for those of this one.
    folder.put("in2/b.obj", OCTAHEDRON);
    folder.run("batch in2 -o out -n 10").refused(&["of another mesh", "in/b.obj", "in2/b.obj"]);
}

#[test]
fn weights_that_changed_are_other_options() {
    let folder = Folder::new();
    folder.put("in/a.obj", OCTAHEDRON);
    folder.write("weights.txt", "1\n2\n3\n4\n5\n6\n");
    folder.run("batch in -o out -n 10 --weights weights.txt").ok();
    folder.run("batch in -o out -n 10 --weights weights.txt").ok().says(&["1 of them before"]);
    folder.write("weights.txt", "2\n2\n3\n4\n5\n6\n");
    folder.run("batch in -o out -n 10 --weights weights.txt").refused(&["other options"]);
}

#[test]
fn a_summary_alone_does_no_work() {
    let folder = done();
    folder.put("in/c.obj", OCTAHEDRON);
    let ran = folder.run("batch in -o out -n 10 --summary-only");
    assert_eq!(ran.code, 1);
    ran.says(&["0 of 3 meshes failed and 1 not done"]);
    let rows = folder.summary("out/summary.csv");
    assert_eq!(column(&rows, "status"), ["done", "done", "pending"]);
    assert!(!folder.path("out/c.ply").exists());
    folder.put("in/c.obj", "v 0 0 0");
    assert_eq!(folder.run("batch in -o out -n 10").code, 1);
    folder.run("batch in -o out -n 10 --summary-only").says(&["1 of 3 meshes failed"]);
    assert_eq!(column(&folder.summary("out/summary.csv"), "status"), ["done", "done", "failed"]);
}

#[test]
fn what_may_have_killed_a_run_comes_last() {
    let folder = Folder::new();
    for name in ["a", "b", "c"] {
        folder.put(&format!("in/{name}.obj"), OCTAHEDRON);
    }
    folder.put("out/.ldwrap-batch/all.begun", "a.ply\nb.ply\n");
    folder.put("out/.ldwrap-batch/2-of-2.begun", "x.ply\n");
    folder.run("batch in -o out -n 10 --jobs 1").ok();
    let order: Vec<_> =
        folder.journal("out/journal.jsonl").into_iter().map(|record| record["output"].clone()).collect();
    assert_eq!(order, ["c.ply", "a.ply", "b.ply"]);
    assert_eq!(column(&folder.summary("out/summary.csv"), "output"), ["a.ply", "b.ply", "c.ply"]);
    assert!(!folder.path("out/.ldwrap-batch/all.begun").exists());
}
