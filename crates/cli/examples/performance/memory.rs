//! The peak of memory, by processes that do nothing else.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use ldwrap::equalize::EqualizeOptions;
use ldwrap::io::mesh_out::write_ply;
use ldwrap::pipeline::Options;
use ldwrap::shapes;

use crate::table::{Row, Target};
use crate::timing::Times;
use crate::{Bench, Outcome, all_stages, machine, read};

/// The first argument of a process that is measured.
const CHILD: &str = "--measure-memory-of";

/// What a process is to do: read a mesh and make points.
pub(crate) struct Order {
    file: PathBuf,
    count: usize,
    equalize: bool,
}

/// The order in the arguments, if they are those of a child.
pub(crate) fn order(mut arguments: impl Iterator<Item = OsString>) -> Option<Order> {
    if arguments.next()? != CHILD {
        return None;
    }
    let file = PathBuf::from(arguments.next()?);
    let count = arguments.next()?.to_str()?.parse().ok()?;
    Some(Order { file, count, equalize: arguments.next()? == "equalize" })
}

/// Does what it is told and prints by how many bytes the peak of its memory rose. Reading is part of it.
pub(crate) fn child(order: &Order) -> Outcome {
    let before = peak()?;
    let mesh = read(&order.file)?;
    let equalize = order.equalize.then(EqualizeOptions::default);
    std::hint::black_box(all_stages(&mesh, order.count, Options { equalize, ..Options::default() })?);
    writeln!(std::io::stdout(), "{}", peak()? - before)?;
    Ok(())
}

/// The most memory that this process ever had, in bytes.
fn peak() -> Outcome<u64> {
    let peak =
        machine::field("/proc/self/status", "VmHWM").ok_or("this system does not tell the peak of memory")?;
    let kilobytes: u64 = peak.trim_end_matches("kB").trim().parse()?;
    Ok(1024 * kilobytes)
}

pub(crate) fn rows(bench: &mut Bench) -> Outcome<Vec<Row>> {
    if !cfg!(target_os = "linux") {
        eprintln!("the peak of memory is measured on Linux only");
        return Ok(Vec::new());
    }
    let folder = tempfile::tempdir()?;
    let mut sizes = vec![(1_000_000, "1,000,000")];
    if bench.large {
        sizes.push((10_000_000, "10,000,000"));
    }
    let mut rows = Vec::new();
    for (faces, shown) in sizes {
        let file = folder.path().join("scan.ply");
        let bytes = write_ply(&shapes::scan_like(1, faces))?;
        std::fs::write(&file, &bytes)?;
        let input = bytes.len() as u64;
        drop(bytes);
        for (way, count, points) in cases(faces) {
            let peak = rise(&file, count, way)?.saturating_sub(input) as f64;
            let allowed = 300.0 * f64::from(faces) + 64.0 * count as f64;
            rows.push(Row {
                work: format!("peak of memory beyond the file: {way} {points} points on {shown} triangles"),
                ours: mebibytes(peak),
                against: "300 bytes a triangle and 64 a point".into(),
                theirs: mebibytes(allowed),
                figure: Times(vec![peak / allowed]),
                unit: "",
                target: Target::AtMost(1.0),
            });
            if faces == 10_000_000 {
                let whole = peak + input as f64;
                let figure = Times(vec![whole / f64::from(1 << 30)]);
                let work = format!("the same with the file of {}", mebibytes(input as f64));
                rows.push(Row::alone(&work, mebibytes(whole), figure, "GiB", Target::AtMost(4.0)));
            }
        }
    }
    Ok(rows)
}

/// Few points show what triangles cost, many what points cost.
fn cases(faces: u32) -> Vec<(&'static str, usize, &'static str)> {
    let mut cases = vec![("wrap", 1_000, "1,000"), ("equalize", 1_000, "1,000")];
    if faces == 1_000_000 {
        cases.push(("wrap", 1_000_000, "1,000,000"));
    }
    cases
}

fn rise(file: &Path, count: usize, way: &str) -> Outcome<u64> {
    let output = Command::new(std::env::current_exe()?)
        .arg(CHILD)
        .arg(file)
        .arg(count.to_string())
        .arg(way)
        .output()?;
    let said = String::from_utf8_lossy(&output.stdout);
    said.trim().parse().map_err(|_| {
        format!("memory of {way} {count}: {}: {}", output.status, String::from_utf8_lossy(&output.stderr))
            .into()
    })
}

fn mebibytes(bytes: f64) -> String {
    format!("{:.0} MiB", bytes / f64::from(1 << 20))
}
