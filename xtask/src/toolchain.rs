//! Which compiler builds for wasm, and wasm-bindgen of the version that the workspace is locked to.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::command::{command, find_program, output, run, succeeds_within};
use crate::{Failure, root, target};

const WASM: &str = "wasm32-unknown-unknown";

/// A way to compile for wasm.
#[derive(Debug)]
pub enum WasmToolchain {
    /// The toolchain in use has the wasm target.
    Installed,
    /// Another compiler that comes with its standard library's source, which is compiled too.
    StdFromSource {
        /// The compiler.
        rustc: PathBuf,
        /// Its cargo.
        cargo: PathBuf,
        /// The linker.
        linker: PathBuf,
    },
}

impl WasmToolchain {
    /// The toolchain in use when it has the wasm target or rustup can add it; else a system toolchain with the
    /// source of its standard library (on Debian the packages rustc-web, cargo-web and rust-web-src), which
    /// `LDWRAP_STD_FROM_SOURCE=1` asks for in any case.
    ///
    /// # Errors
    /// When there is neither; the message says what to install.
    pub fn find() -> Result<Self, Failure> {
        let from_source = std::env::var_os("LDWRAP_STD_FROM_SOURCE").is_some();
        if !from_source && (has_wasm_std(Path::new("rustc")) || add_by_rustup()) {
            return Ok(Self::Installed);
        }
        system_toolchain().ok_or_else(|| {
            Failure(format!(
                "no compiler for {WASM} was found: `rustup target add {WASM}` installs it, or on Debian \
                 `apt-get install rustc-web cargo-web rust-web-src`"
            ))
        })
    }

    /// `cargo build` for wasm; options are to be added.
    pub fn cargo_build(&self) -> Command {
        match self {
            Self::Installed => {
                let mut build = crate::command::cargo();
                build.args(["build", "--target", WASM]);
                build
            }
            Self::StdFromSource { rustc, cargo, linker } => {
                let mut build = command(cargo);
                build
                    .args(["build", "-Zbuild-std=std,panic_abort", "--target", WASM])
                    .env("RUSTC", rustc)
                    .env("RUSTC_BOOTSTRAP", "1")
                    .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker)
                    // The caller's toolchain, set by rustup's proxies, is not the one in use.
                    .env_remove("RUSTUP_TOOLCHAIN")
                    .env_remove("RUSTC_WRAPPER")
                    .env_remove("RUSTC_WORKSPACE_WRAPPER");
                build
            }
        }
    }

    /// Where that build leaves a file, given the profile.
    pub fn built(&self, profile: &str, file: &str) -> PathBuf {
        target().join("wasm").join(WASM).join(profile).join(file)
    }
}

fn sysroot(rustc: &Path) -> Option<PathBuf> {
    output(command(rustc).args(["--print", "sysroot"])).map(PathBuf::from)
}

fn has_wasm_std(rustc: &Path) -> bool {
    sysroot(rustc).is_some_and(|root| root.join("lib/rustlib").join(WASM).join("lib").is_dir())
}

fn add_by_rustup() -> bool {
    find_program("rustup").is_some_and(|rustup| {
        eprintln!("$ rustup target add {WASM}");
        succeeds_within(command(rustup).args(["target", "add", WASM]), Duration::from_secs(300))
    }) && has_wasm_std(Path::new("rustc"))
}

fn system_toolchain() -> Option<WasmToolchain> {
    let folders = std::env::split_paths(&std::env::var_os("PATH")?)
        .chain([PathBuf::from("/usr/bin")])
        .collect::<Vec<_>>();
    let rustc = folders.iter().map(|f| f.join("rustc")).find(|rustc| {
        rustc.is_file()
            && sysroot(rustc)
                .is_some_and(|root| root.join("lib/rustlib/src/rust/library/std/Cargo.toml").is_file())
    })?;
    let cargo = rustc.with_file_name("cargo");
    let linker = find_program("rust-lld")
        .or_else(|| {
            [sysroot(Path::new("rustc"))?, sysroot(&rustc)?].into_iter().find_map(|root| lld_of(&root))
        })
        .or_else(|| find_program("wasm-ld"))?;
    cargo.is_file().then_some(WasmToolchain::StdFromSource { rustc, cargo, linker })
}

fn lld_of(sysroot: &Path) -> Option<PathBuf> {
    let hosts = sysroot.join("lib/rustlib").read_dir().ok()?;
    hosts.flatten().map(|host| host.path().join("bin/rust-lld")).find(|lld| lld.is_file())
}

/// The version of a package in the workspace's lock file.
///
/// # Errors
/// When the lock file does not name it.
pub fn locked_version(package: &str) -> Result<String, Failure> {
    let lock = std::fs::read_to_string(root().join("Cargo.lock"))?;
    let name = format!("name = \"{package}\"");
    let mut lines = lock.lines().skip_while(|line| *line != name);
    lines
        .nth(1)
        .and_then(|line| line.strip_prefix("version = \"")?.strip_suffix('"'))
        .map(str::to_owned)
        .ok_or_else(|| Failure(format!("Cargo.lock does not name {package}")))
}

/// The `wasm-bindgen` program of exactly the version that the crate is locked to, installed into the target folder
/// when it is nowhere.
///
/// # Errors
/// When it cannot be installed.
pub fn wasm_bindgen() -> Result<PathBuf, Failure> {
    let version = locked_version("wasm-bindgen")?;
    let wanted = format!("wasm-bindgen {version}");
    let tools = target().join("tools");
    let own = tools.join("bin").join(if cfg!(windows) { "wasm-bindgen.exe" } else { "wasm-bindgen" });
    let has_version = |path: &PathBuf| output(command(path).arg("--version")).is_some_and(|v| v == wanted);
    if let Some(found) =
        [Some(own.clone()), find_program("wasm-bindgen")].into_iter().flatten().find(has_version)
    {
        return Ok(found);
    }
    run(crate::command::cargo()
        .args(["install", "wasm-bindgen-cli", "--version", &version, "--root"])
        .arg(&tools))?;
    Ok(own)
}
