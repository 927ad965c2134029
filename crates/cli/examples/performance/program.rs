//! The whole program from its start to its end.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use ldwrap::{io, shapes};

use crate::table::{Row, Target};
use crate::timing::{Times, interleaved, timed};
use crate::{Bench, Outcome};

const COUNT: &str = "10000";

pub(crate) fn rows(bench: &mut Bench) -> Outcome<Vec<Row>> {
    let program = built()?;
    let folder = tempfile::tempdir()?;
    let mut rows = Vec::new();
    if let Some(python) = &bench.python {
        let (ours, theirs) = (folder.path().join("ours.ply"), folder.path().join("theirs.ply"));
        let mut wrap = || {
            let mut command = Command::new(&program);
            // The script computes and prints nothing beside the points either.
            seconds_of(
                command.args(["wrap", "--quiet"]).arg(&bench.file).args(["-n", COUNT, "-o"]).arg(&ours),
            )
        };
        let mut script = || {
            let mut command = Command::new(python);
            command.args(["-c", include_str!("script.py")]).arg(&bench.file).arg(COUNT).arg(&theirs);
            seconds_of(&mut command)
        };
        let [wrap, script] = interleaved(bench.rounds, [&mut wrap, &mut script])?;
        rows.push(Row::ratio(
            "whole program: horse.ply to 10,000 equalized points in PLY",
            &wrap,
            "Python with Open3D: import, load, Poisson disk, save",
            &script,
            Target::AtMost(0.4),
        ));
    }
    let cube = folder.path().join("cube.ply");
    std::fs::write(&cube, io::mesh_out::write_ply(&shapes::cube(1))?)?;
    // A start takes milliseconds, so many are needed.
    let mut info = || seconds_of(Command::new(&program).arg("info").arg(&cube));
    let [info] = interleaved(bench.rounds.max(20), [&mut info])?;
    let figure = info.over_number(1e-3);
    rows.push(Row::alone("start: `info` on a cube", info.shown(), figure, "ms", Target::AtMost(20.0)));
    let size = std::fs::metadata(&program)?.len() as f64 / f64::from(1 << 20);
    let bytes = format!("{size:.1} MiB");
    rows.push(Row::alone("release binary", bytes, Times(vec![size]), "MiB", Target::AtMost(10.0)));
    Ok(rows)
}

/// The program beside this one, built now so that it is not an older one.
fn built() -> Outcome<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .args(["build", "--quiet", "--release", "-p", "ldwrap-cli", "--bin", "ldwrap-cli"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .status()?;
    if !built.success() {
        return Err("ldwrap-cli could not be built".into());
    }
    let here = std::env::current_exe()?;
    let folder = here.parent().and_then(Path::parent).ok_or("this program is in no folder of cargo's")?;
    let program = folder.join(format!("ldwrap-cli{}", std::env::consts::EXE_SUFFIX));
    if cfg!(debug_assertions) || !program.is_file() {
        return Err("times are those of `cargo run --release`".into());
    }
    Ok(program)
}

fn seconds_of(command: &mut Command) -> Outcome<f64> {
    let (output, seconds) = timed(|| command.stdin(Stdio::null()).output());
    let output = output?;
    if output.status.success() {
        return Ok(seconds);
    }
    let said = String::from_utf8_lossy(&output.stderr);
    Err(format!("{}: {}: {said}", command.get_program().display(), output.status).into())
}
