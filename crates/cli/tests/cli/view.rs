//! `view` hands a good mesh to `ldwrap-web`, here a script in its place, and says what to do where that is missing.
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::common::{Folder, OCTAHEDRON};

/// The program in a folder where no viewer is beside it, and a mesh.
struct Installed(TempDir);

impl Installed {
    fn new() -> Self {
        let folder = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
        for inside in ["bin", "elsewhere"] {
            std::fs::create_dir(folder.path().join(inside)).expect("a folder");
        }
        std::fs::hard_link(env!("CARGO_BIN_EXE_ldwrap-cli"), folder.path().join("bin/ldwrap-cli"))
            .expect("the program");
        std::fs::write(folder.path().join("octahedron.obj"), OCTAHEDRON).expect("a mesh");
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Puts a script in the viewer's place. Another program writes it: a file that this one, or a fork of it, has open
    /// could not be run.
    fn with_viewer(self, folder: &str, script: &str) -> Self {
        std::fs::write(self.path("script"), format!("#!/bin/sh\n{script}\n")).expect("a script");
        let to = self.path(folder).join("ldwrap-web");
        let copied = Command::new("install").args(["-m", "755"]).arg(self.path("script")).arg(to).status();
        assert!(copied.expect("install runs").success());
        self
    }

    fn view(&self, mesh: &str) -> Output {
        Command::new(self.path("bin/ldwrap-cli"))
            .args(["view", mesh])
            .current_dir(self.0.path())
            .env("PATH", self.path("elsewhere"))
            .output()
            .expect("the program runs")
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_viewer_gets_the_mesh_from_beside_the_program_or_from_the_path() {
    for folder in ["bin", "elsewhere"] {
        let installed = Installed::new().with_viewer(folder, "echo shown \"$@\"");
        let output = installed.view("octahedron.obj");
        assert!(output.status.success(), "{folder}: {}", said(&output));
        let text = String::from_utf8(output.stdout).expect("text");
        let mesh = text.trim().strip_prefix("shown ").expect("the viewer's words");
        assert!(Path::new(mesh).is_absolute() && mesh.ends_with("octahedron.obj"), "{folder}: {mesh}");
    }
}

#[test]
fn the_viewer_beside_the_program_comes_first() {
    let installed = Installed::new().with_viewer("elsewhere", "echo far").with_viewer("bin", "echo near");
    assert_eq!(installed.view("octahedron.obj").stdout, b"near\n");
}

#[test]
fn without_a_viewer_it_is_told_how_to_get_one() {
    let output = Installed::new().view("octahedron.obj");
    assert_eq!(output.status.code(), Some(1));
    let said = said(&output);
    assert!(said.contains("ldwrap-web") && said.contains("cargo install ldwrap-web"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}

#[test]
fn a_viewer_that_fails_is_told() {
    let output = Installed::new().with_viewer("bin", "exit 3").view("octahedron.obj");
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("ldwrap-web did not show the mesh (exit status: 3)"), "{}", said(&output));
}

#[test]
fn a_bad_mesh_opens_no_window() {
    let installed = Installed::new().with_viewer("bin", "echo shown");
    std::fs::write(installed.path("broken.ply"), "ply\nformat ascii 1.0\n").expect("a file");
    for mesh in ["broken.ply", "missing.obj"] {
        let output = installed.view(mesh);
        assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(1), b"".as_slice()), "{mesh}");
        assert!(said(&output).contains(mesh), "{}", said(&output));
    }
    Folder::new().run("view -").refused(&["name a file"]);
}
