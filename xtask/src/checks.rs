//! Everything that must hold before a change lands: formatting, lints, the page, tests, instruction counts, documentation,
//! packages.

use std::time::Instant;

use crate::command::{cargo, run};
use crate::fuzz::Build;
use crate::instructions::{self, Then};
use crate::{Failure, browser, fuzz, in_ci, web};

/// What is published.
const PACKAGES: [&str; 3] = ["ldwrap", "ldwrap-cli", "ldwrap-web"];

/// For how long each target is fuzzed; eight targets take a minute and a half, besides their build.
const FUZZ_SECONDS: u32 = 10;

/// Runs all checks, each shown; stops at the first that fails. Without a wasm compiler or a browser the tests of the
/// page are skipped, loudly; with `CI=true` that is an error.
///
/// # Errors
/// The first check that failed.
pub fn run_all() -> Result<(), Failure> {
    step("formatting", || run(cargo().args(["fmt", "--all", "--check"])))?;
    step("lints", || {
        run(cargo().args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
        run(cargo().args([
            "clippy",
            "-p",
            "ldwrap",
            "--no-default-features",
            "--all-targets",
            "--",
            "-D",
            "warnings",
        ]))?;
        run(cargo().args([
            "clippy",
            "-p",
            "ldwrap-web",
            "--no-default-features",
            "--lib",
            "--",
            "-D",
            "warnings",
        ]))
    })?;
    step("features", features)?;
    let page = step("page", page)?;
    step("tests", || {
        let mut test = cargo();
        test.args(["test", "--workspace"]);
        if let Some(page) = &page {
            test.env("LDWRAP_PAGE", &page.folder)
                .env("LDWRAP_PACKAGE", &page.package)
                .env("LDWRAP_BROWSER", &page.browser);
        }
        run(&mut test)
    })?;
    step("instructions", || instructions::check(Then::Compare))?;
    step("fuzz", || fuzz::run_all(FUZZ_SECONDS, Build::Quick))?;
    step("documentation", || {
        run(cargo()
            .args(["doc", "--workspace", "--no-deps", "--all-features"])
            .env("RUSTDOCFLAGS", "-D warnings"))
    })?;
    step("packages", || {
        run(cargo().args(["package", "--allow-dirty", "-p", PACKAGES[0]]))?;
        // The others are packed without being built from it: cargo keeps the library that it unpacked for an earlier run,
        // because the version is the same, and would build them against that.
        run(cargo()
            .args(["package", "--allow-dirty", "--no-verify"])
            .args(PACKAGES.iter().flat_map(|name| ["-p", name])))
    })?;
    if page.is_none() {
        eprintln!("\nSKIPPED: THE PAGE WAS NEITHER BUILT NOR TESTED; the reason is above.");
    }
    eprintln!("\nall checks hold");
    Ok(())
}

/// The library's features, each of which must compile alone.
const FEATURES: [&str; 12] =
    ["obj", "gltf", "ply", "stl", "csv", "json", "gz", "npz", "textures", "serde", "parallel", "rayon"];

/// The library with each feature alone, and with none for wasm.
fn features() -> Result<(), Failure> {
    for feature in FEATURES {
        run(cargo()
            .args(["clippy", "-p", "ldwrap", "--no-default-features", "--features", feature])
            .args(["--", "-D", "warnings"]))?;
    }
    match crate::toolchain::WasmToolchain::find() {
        Ok(toolchain) => run(toolchain
            .cargo_build()
            .args(["-p", "ldwrap", "--no-default-features", "--target-dir"])
            .arg(crate::target().join("wasm"))),
        Err(reason) if in_ci() => Err(reason),
        Err(reason) => {
            eprintln!("SKIPPED: THE LIBRARY FOR WASM: {reason}");
            Ok(())
        }
    }
}

struct Page {
    folder: std::path::PathBuf,
    package: std::path::PathBuf,
    browser: std::path::PathBuf,
}

/// The built page and a browser for it; `None` where a tool is missing.
fn page() -> Result<Option<Page>, Failure> {
    let missing = crate::toolchain::WasmToolchain::find().err().or_else(|| browser::find().err());
    match missing {
        Some(reason) if in_ci() => Err(reason),
        Some(reason) => {
            eprintln!("SKIPPED: THE TESTS OF THE PAGE: {reason}");
            Ok(None)
        }
        None => Ok(Some(Page {
            folder: web::build_page()?,
            package: web::build_package()?,
            browser: browser::find()?,
        })),
    }
}

fn step<T>(name: &str, work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    eprintln!("\n== {name}");
    let start = Instant::now();
    let value = work()?;
    eprintln!("== {name}: {:.0} s", start.elapsed().as_secs_f64());
    Ok(value)
}
