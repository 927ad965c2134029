//! Builds the page and the JavaScript package.

use std::fs;
use std::path::{Path, PathBuf};

use crate::command::{command, find_program, run};
use crate::toolchain::{WasmToolchain, wasm_bindgen};
use crate::{Failure, root, target};

const PROFILE: &str = "web";

/// Builds the page into `target/web`: `index.html`, its scripts and the wasm module, ready for any static server.
///
/// # Errors
/// When a tool is missing or the build fails.
pub fn build_page() -> Result<PathBuf, Failure> {
    let folder = target().join("web");
    build(&folder, &[])?;
    copy_all(&root().join("crates/web/static"), &folder)?;
    report_size(&folder)?;
    Ok(folder)
}

/// Builds the JavaScript package into `target/npm`: the API without the interface, with its types.
///
/// # Errors
/// When a tool is missing or the build fails.
pub fn build_package() -> Result<PathBuf, Failure> {
    let folder = target().join("npm");
    build(&folder, &["--no-default-features"])?;
    copy_all(&root().join("crates/web/npm"), &folder)?;
    for file in ["LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(root().join(file), folder.join(file))?;
    }
    report_size(&folder)?;
    Ok(folder)
}

fn build(folder: &Path, features: &[&str]) -> Result<(), Failure> {
    let toolchain = WasmToolchain::find()?;
    let bindgen = wasm_bindgen()?;
    run(toolchain
        .cargo_build()
        .args(["--package", "ldwrap-web", "--lib", "--profile", PROFILE, "--target-dir"])
        .arg(target().join("wasm"))
        .args(features)
        // Without this the build would carry this machine's paths in its panic messages.
        .env("RUSTFLAGS", format!("--remap-path-prefix={}=.", root().display())))?;
    fs::create_dir_all(folder)?;
    run(command(bindgen)
        .args([
            "--target",
            "web",
            "--remove-name-section",
            "--remove-producers-section",
            "--out-name",
            "ldwrap_web",
            "--out-dir",
        ])
        .arg(folder)
        .arg(toolchain.built(PROFILE, "ldwrap_web.wasm")))
}

fn copy_all(from: &Path, to: &Path) -> Result<(), Failure> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from).map_err(|e| Failure(format!("{}: {e}", from.display())))? {
        let entry = entry?;
        let place = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_all(&entry.path(), &place)?;
        } else {
            fs::copy(entry.path(), place)?;
        }
    }
    Ok(())
}

/// Says what a visitor downloads: the sizes, and compressed where gzip is installed.
fn report_size(folder: &Path) -> Result<(), Failure> {
    for file in ["ldwrap_web_bg.wasm", "ldwrap_web.js"] {
        let path = folder.join(file);
        let size = path.metadata()?.len();
        let packed = find_program("gzip").and_then(|gzip| {
            let bytes = command(gzip).args(["-9", "-c"]).arg(&path).output().ok()?.stdout;
            Some(format!(", {} kB compressed", bytes.len() / 1000))
        });
        eprintln!("{file}: {} kB{}", size / 1000, packed.unwrap_or_default());
    }
    Ok(())
}
