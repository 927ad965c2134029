//! `view`: shows a mesh in the window of `ldwrap-web`, a program of its own, so that this one stays small.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, anyhow};

use crate::args::{MeshArgs, ReadingArgs, ViewArgs};
use crate::exit::{Failure, Outcome};
use crate::input;
use crate::progress::Stages;

const VIEWER: &str = "ldwrap-web";

/// Runs the command; it ends when the window is closed.
pub(crate) fn run(args: &ViewArgs, quiet: bool) -> Outcome {
    if args.mesh.as_os_str() == "-" {
        return Err(Failure::wrong_use("view: the window reads the mesh itself; name a file instead of `-`"));
    }
    // A mesh that cannot be used is told here, as every command does, and not by a window.
    let stages = Stages::new(quiet);
    let mesh = MeshArgs { mesh: args.mesh.clone(), reading: ReadingArgs::default() };
    input::read(&mesh, &stages)?;
    stages.finish();
    let viewer = find()?;
    let path = std::path::absolute(&args.mesh).context("the mesh's place cannot be told")?;
    let ended = Command::new(&viewer)
        .arg(path)
        .status()
        .with_context(|| format!("{} cannot be started", viewer.display()))?;
    if ended.success() {
        Ok(())
    } else {
        Err(anyhow!("{} did not show the mesh ({ended})", viewer.display()).into())
    }
}

/// The viewer beside this program, else the first on PATH.
fn find() -> anyhow::Result<PathBuf> {
    let file = format!("{VIEWER}{}", std::env::consts::EXE_SUFFIX);
    let own = std::env::current_exe().ok().and_then(|program| program.parent().map(Path::to_owned));
    let path = std::env::var_os("PATH").unwrap_or_default();
    own.into_iter()
        .chain(std::env::split_paths(&path))
        .map(|folder| folder.join(&file))
        .find(|p| p.is_file())
        .ok_or_else(|| {
            anyhow!(
                "{VIEWER}, which shows meshes in a window, is neither beside this program nor on PATH; \
                 `cargo install {VIEWER}` installs it"
            )
        })
}
