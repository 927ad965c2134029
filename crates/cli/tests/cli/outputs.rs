//! Outputs are complete or not there, and go where they are sent.

use std::io::Read;
use std::process::{Command, Stdio};

use crate::common::{Folder, OCTAHEDRON, rows, square};

#[test]
fn all_outputs_of_one_run() {
    let folder = Folder::with_octahedron();
    let ran =
        folder.run("wrap octahedron.obj -n 50 -o p.ply --strips s.svg --report r.json --preview v.png").ok();
    assert_eq!(folder.names(), ["octahedron.obj", "p.ply", "r.json", "s.svg", "v.png"]);
    assert!(folder.read("p.ply").starts_with(b"ply\nformat binary_little_endian 1.0\n"));
    assert!(folder.text("s.svg").contains("<svg"));
    assert!(folder.read("v.png").starts_with(b"\x89PNG\r\n\x1a\n"));
    assert_eq!(folder.json("r.json")["points"]["count"], 50);
    assert_eq!(ran.stdout, b"");
    for name in ["p.ply", "s.svg", "r.json", "v.png"] {
        assert!(ran.stderr.contains(&format!("wrote {name}")), "{}", ran.stderr);
    }
}

#[test]
fn without_outputs_a_summary_is_all() {
    let folder = Folder::with_octahedron();
    let ran = folder.run("wrap octahedron.obj -n 50").ok();
    assert_eq!(ran.stdout, b"");
    ran.says(&["50 points", "8 triangles", "irregularity"]);
    assert_eq!(folder.names(), ["octahedron.obj"]);
}

#[test]
fn quiet_says_nothing() {
    let folder = Folder::with_octahedron();
    let ran = folder.run("wrap octahedron.obj -n 50 -q -o p.xyz").ok();
    assert_eq!((ran.stdout.as_slice(), ran.stderr.as_str()), (&b""[..], ""));
}

#[test]
fn points_to_stdout() {
    let folder = Folder::with_octahedron();
    let ran = folder.run("wrap octahedron.obj -n 25 -o - --format xyz").ok();
    assert_eq!(rows(ran.text()).len(), 25);
    folder.run("wrap octahedron.obj -n 25 -o p.xyz").ok();
    assert_eq!(ran.stdout, folder.read("p.xyz"));
}

#[test]
fn a_report_to_stdout() {
    let folder = Folder::with_octahedron();
    let ran = folder.run("wrap octahedron.obj -n 25 --report - -o p.xyz").ok();
    assert_eq!(ran.json()["points"]["count"], 25);
    assert_eq!(folder.names(), ["octahedron.obj", "p.xyz"]);
}

#[test]
fn a_mesh_from_stdin() {
    let folder = Folder::with_octahedron();
    let read = folder.run("wrap octahedron.obj -n 25 -o - --format csv").ok();
    for format in ["", "--mesh-format obj"] {
        let piped =
            folder.run_with_input(&format!("wrap - {format} -n 25 -o - --format csv"), OCTAHEDRON).ok();
        assert_eq!(piped.stdout, read.stdout);
        assert!(piped.stderr.contains("stdin"), "{}", piped.stderr);
    }
    folder.run_with_input("info -", "").failed(&["stdin", "empty"]);
}

#[test]
fn a_format_beats_the_extension() {
    let folder = Folder::with_octahedron();
    folder.run("wrap octahedron.obj -n 5 -o points.dat --format xyz").ok();
    assert_eq!(rows(&folder.text("points.dat")).len(), 5);
    folder.run("wrap octahedron.obj -n 5 -o points.PLY --format ply-ascii").ok();
    assert!(folder.text("points.PLY").starts_with("ply\nformat ascii 1.0\n"));
}

#[test]
fn a_missing_folder_is_seen_before_the_work() {
    let folder = Folder::with_octahedron();
    folder.write("keep.xyz", "as it was");
    folder.run("wrap octahedron.obj -o keep.xyz --report missing/r.json").failed(&[
        "missing/r.json",
        "no folder missing",
        "create it",
    ]);
    folder.run("wrap octahedron.obj -o keep.xyz/p.xyz").failed(&["keep.xyz/p.xyz", "not a folder"]);
    assert_eq!(folder.text("keep.xyz"), "as it was");
    assert_eq!(folder.names(), ["keep.xyz", "octahedron.obj"]);
}

#[test]
fn an_output_that_is_a_folder() {
    let folder = Folder::with_octahedron();
    std::fs::create_dir(folder.path("out.xyz")).expect("a folder");
    folder.run("wrap octahedron.obj -o out.xyz").failed(&["out.xyz", "is a folder"]);
}

#[test]
fn a_failed_run_leaves_what_was_there() {
    let folder = Folder::new();
    folder.write("broken.obj", "v 0 0 0\n");
    folder.write("p.xyz", "as it was");
    folder.run("wrap broken.obj -o p.xyz --report r.json").failed(&["broken.obj"]);
    assert_eq!(folder.text("p.xyz"), "as it was");
    assert_eq!(folder.names(), ["broken.obj", "p.xyz"]);
}

#[test]
fn an_existing_file_is_replaced_whole() {
    let folder = Folder::with_octahedron();
    folder.write("p.xyz", "x".repeat(1_000_000));
    folder.run("wrap octahedron.obj -n 3 -o p.xyz").ok();
    assert_eq!(rows(&folder.text("p.xyz")).len(), 3);
}

#[cfg(target_os = "linux")]
#[test]
fn when_one_output_fails_no_file_changes() {
    let folder = Folder::with_octahedron();
    folder.write("p.xyz", "as it was");
    folder
        .run("wrap octahedron.obj -q -o p.xyz --strips s.svg --report /dev/full")
        .failed(&["/dev/full", "cannot be written"]);
    assert_eq!(folder.text("p.xyz"), "as it was");
    assert_eq!(folder.names(), ["octahedron.obj", "p.xyz"]);
    folder.run("wrap octahedron.obj -o /dev/null --format ply").ok();
}

#[cfg(unix)]
#[test]
fn permissions_and_links_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = Folder::with_octahedron();
    let mode =
        |name: &str| std::fs::metadata(folder.path(name)).expect("a file").permissions().mode() & 0o777;
    folder.run("wrap octahedron.obj -n 3 -o new.xyz").ok();
    folder.write("plain", "");
    assert_eq!(mode("new.xyz"), mode("plain"), "as any new file");
    folder.write("own.xyz", "");
    std::fs::set_permissions(folder.path("own.xyz"), PermissionsExt::from_mode(0o640)).expect("permissions");
    symlink("own.xyz", folder.path("link.xyz")).expect("a link");
    folder.run("wrap octahedron.obj -n 3 -o link.xyz").ok();
    assert_eq!(rows(&folder.text("own.xyz")).len(), 3);
    assert_eq!(mode("own.xyz"), 0o640);
    assert!(std::fs::symlink_metadata(folder.path("link.xyz")).expect("a link").is_symlink());
    std::fs::set_permissions(folder.path("own.xyz"), PermissionsExt::from_mode(0o440)).expect("permissions");
    folder.run("wrap octahedron.obj -n 3 -o own.xyz").failed(&["own.xyz", "read-only"]);
}

#[test]
fn a_reader_that_stops_reading_is_no_error() {
    let folder = Folder::with_octahedron();
    let mut child = Command::new(env!("CARGO_BIN_EXE_ldwrap-cli"))
        .args(["wrap", "octahedron.obj", "-n", "20000", "--no-equalize", "-o", "-", "--format", "xyz", "-q"])
        .current_dir(folder.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    let mut first = [0; 10];
    child.stdout.take().expect("stdout").read_exact(&mut first).expect("a few bytes");
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn no_bars_on_a_pipe() {
    let folder = Folder::new();
    folder.write("square.obj", square(20));
    let ran = folder.run("wrap square.obj -n 2000 -o p.xyz").ok();
    assert!(!ran.stderr.contains('\x1b') && !ran.stderr.contains('\r'), "{:?}", ran.stderr);
}

#[test]
fn strips_alone() {
    let folder = Folder::with_octahedron();
    folder.run("strips octahedron.obj -o s.svg").ok().says(&["strip"]);
    assert!(folder.text("s.svg").contains("<svg"));
    let piped = folder.run("strips octahedron.obj -o - -q").ok();
    assert_eq!(piped.stdout, folder.read("s.svg"));
    assert_eq!(piped.stderr, "");
    folder.run("strips octahedron.obj -o missing/s.svg").failed(&["missing/s.svg", "no folder"]);
}
