//! Points that are written while they are made.

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use ldwrap::io::points::{PointFormat, PointRow, write_points};
use ldwrap::pipeline::{Options, Request, Run, run};
use ldwrap::{CheckOptions, Silent, SurfaceMesh, io};

use crate::common::{Folder, OCTAHEDRON};

/// What the library makes of the octahedron, all points at once.
fn whole(count: usize, format: PointFormat) -> (Run, Vec<u8>) {
    let soup = io::read_mesh(OCTAHEDRON.as_bytes(), Some("octahedron.obj"), &|_| Err("no file".into()));
    let (mesh, _) =
        SurfaceMesh::from_soup(&soup.expect("a mesh"), &CheckOptions::default()).expect("checked");
    let options = Options { request: Request::Count(count), ..Options::default() };
    let run = run(&mesh, &options, &Silent).expect("points");
    let rows: Vec<_> = run.samples.iter().map(|sample| PointRow::new(&mesh, sample)).collect();
    let mut bytes = Vec::new();
    write_points(format, &rows, &mut bytes).expect("memory takes every byte");
    (run, bytes)
}

#[test]
fn blocks_make_the_file_of_all_points_at_once() {
    let folder = Folder::with_octahedron();
    for format in PointFormat::ALL {
        let (run, bytes) = whole(150_000, format);
        let wrap = format!("wrap octahedron.obj -n 150000 --no-equalize --format {format}");
        let ran = folder.run(&format!("{wrap} -o points --report r.json")).ok();
        ran.says(&["150000 points", "wrote points"]);
        assert!(folder.read("points") == bytes, "{format}");
        let report = folder.json("r.json");
        assert_eq!(report["points"]["count"], 150_000);
        assert_eq!(report["points"]["projected"], run.correction.projected);
        assert_eq!(report["points"]["removed"], run.correction.removed);
        assert!(report["seconds"]["write"].is_f64(), "{report}");
        if format.takes_blocks() {
            let piped = folder.run(&format!("{wrap} -o - -q")).ok();
            assert!(piped.stdout == bytes, "{format}");
        }
        folder.run(&format!("batch octahedron.obj -n 150000 --no-equalize --format {format} -o out -q")).ok();
        let name =
            format!("out/octahedron.{}", if format == PointFormat::PlyAscii { "ply" } else { format.name() });
        assert!(folder.read(&name) == bytes, "{format}");
        std::fs::remove_dir_all(folder.path("out")).expect("the folder goes");
    }
}

#[test]
fn points_that_something_else_looks_at_are_the_same() {
    let folder = Folder::with_octahedron();
    let (_, bytes) = whole(150_000, PointFormat::Csv);
    let wrap = "wrap octahedron.obj -n 150000 --no-equalize -q -o p.csv";
    folder.run(&format!("{wrap} --strips s.svg --preview v.png")).ok();
    assert!(folder.read("p.csv") == bytes);
    assert_eq!(folder.text("s.svg").matches("<circle").count(), 150_000);
    // Nothing is written but the report, and points that are measured are all of them.
    folder.run("wrap octahedron.obj -n 2000 --no-equalize -q --quality --report r.json").ok();
    let worst = folder.json("r.json")["quality"]["components"]["worst"].as_f64();
    assert!(worst.is_some_and(|worst| worst < 1e-9), "{worst:?} points are missing");
}

#[test]
fn attributes_come_in_blocks_and_those_of_all_points_whole() {
    let folder = Folder::with_octahedron();
    let wrap = "wrap octahedron.obj -n 140000 --no-equalize -q -o p.csv --attributes";
    folder.run(&format!("{wrap} smooth-normal,polygon,origin")).ok();
    let blocks = folder.text("p.csv");
    folder.run(&format!("{wrap} smooth-normal,polygon,origin,cell-area")).ok();
    let all = folder.text("p.csv");
    assert_eq!((blocks.lines().count(), all.lines().count()), (140_001, 140_001));
    let mut sum = 0.0;
    for (number, (blocks, all)) in blocks.lines().zip(all.lines()).enumerate() {
        let (same, area) = all.rsplit_once(',').expect("columns");
        assert_eq!(blocks, same);
        if number > 0 {
            sum += area.parse::<f64>().expect("an area");
        }
    }
    assert!((sum - crate::common::OCTAHEDRON_AREA).abs() < 1e-9, "cells are those of all points: {sum}");
}

/// Writes of more than some megabytes fail, as on a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_nothing_behind() {
    let folder = Folder::with_octahedron();
    folder.write("old.npy", "as it was");
    for (command, name) in [
        ("wrap octahedron.obj -n 300000 --no-equalize -q -o p.ply", "p.ply"),
        ("wrap octahedron.obj -n 300000 --no-equalize -q -o old.npy", "old.npy"),
        ("wrap octahedron.obj -n 300000 --no-equalize -q -o p.npz --report r.json", "p.npz"),
    ] {
        let shell =
            format!("trap '' XFSZ; ulimit -f 4000; exec {} {command}", env!("CARGO_BIN_EXE_ldwrap-cli"));
        let output =
            Command::new("sh").args(["-c", &shell]).current_dir(folder.path("")).output().expect("a shell");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(stderr.starts_with(&format!("error: {name}: cannot be written: ")), "{stderr}");
        assert_eq!(folder.names(), ["octahedron.obj", "old.npy"], "{stderr}");
        assert_eq!(folder.text("old.npy"), "as it was");
    }
}

/// A run of many points, once the first of them are in a temporary file.
#[cfg(unix)]
fn begun(folder: &Folder) -> std::process::Child {
    let mut child = Command::new(env!("CARGO_BIN_EXE_ldwrap-cli"))
        .args("wrap octahedron.obj -n 2000000 --no-equalize -q -o p.csv".split_whitespace())
        .current_dir(folder.path(""))
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    while !folder.names().iter().any(|name| name.starts_with(".ldwrap-")) {
        assert!(child.try_wait().expect("a state").is_none(), "it ended without a temporary file");
        sleep(Duration::from_millis(1));
    }
    child
}

#[cfg(unix)]
#[test]
fn what_is_stopped_leaves_nothing_behind() {
    // What is started in the background of a script has signals ignored, and ignores them on.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap_or("0").trim();
    const HUP_INT_TERM: u64 = 1 | 1 << 1 | 1 << 14;
    if u64::from_str_radix(mask, 16).is_ok_and(|mask| mask & HUP_INT_TERM != 0) {
        eprintln!("skipped: signals are ignored here");
        return;
    }
    for signal in ["INT", "TERM"] {
        let folder = Folder::with_octahedron();
        let child = begun(&folder);
        let sent = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status();
        assert!(sent.expect("kill runs").success());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{signal}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
        assert_eq!(folder.names(), ["octahedron.obj"], "{signal}");
    }
}

/// Samples alone would be 448 MB; what the allocator keeps differs by some 30 MB from run to run.
#[cfg(target_os = "linux")]
#[test]
fn never_are_all_points_in_memory() {
    const POINTS: usize = 8_000_000;
    let folder = Folder::with_octahedron();
    let mut child = Command::new(env!("CARGO_BIN_EXE_ldwrap-cli"))
        .args("--threads 2 wrap octahedron.obj -n 8000000 --no-equalize -q -o p.npy".split_whitespace())
        .current_dir(folder.path(""))
        .spawn()
        .expect("the program runs");
    let mut peak = 0;
    while child.try_wait().expect("a state").is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<u64>().ok());
        peak = peak.max(1024 * kilobytes.unwrap_or(0));
        sleep(Duration::from_millis(2));
    }
    assert_eq!(folder.read("p.npy").len(), 128 + 24 * POINTS);
    let samples = size_of::<ldwrap::Sample>() * POINTS;
    assert!(peak > 10_000_000 && peak < samples as u64, "{peak} bytes");
}
