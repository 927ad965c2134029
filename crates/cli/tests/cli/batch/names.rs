//! Which meshes are taken, in which order, and what their outputs are called.

use std::io::Write;

use super::column;
use crate::common::{Folder, OCTAHEDRON};

/// What the summary calls the outputs of a run with `-n 5`.
#[track_caller]
fn outputs(folder: &Folder, arguments: &str, list: &str) -> Vec<String> {
    let _ = std::fs::remove_dir_all(folder.path("out"));
    folder.run_with_input(&format!("batch {arguments} -o out -n 5"), list).ok();
    let rows = folder.summary("out/summary.csv");
    let names = column(&rows, "output");
    let mut made: Vec<String> = folder.outputs("out").into_keys().collect();
    let mut told = names.clone();
    made.sort();
    told.sort();
    assert_eq!(made, told);
    names
}

fn with_meshes(names: &[&str]) -> Folder {
    let folder = Folder::new();
    for name in names {
        folder.put(name, OCTAHEDRON);
    }
    folder
}

#[test]
fn folders_are_walked_in_order_and_mirrored() {
    let folder = with_meshes(&[
        "in/b.obj",
        "in/a/z.OBJ",
        "in/a/y.ply",
        "in/c.v2.off",
        "in/.hidden.obj",
        "in/.git/x.obj",
    ]);
    folder.put("in/a/notes.txt", "no mesh");
    folder.put("in/a/y.mtl", "newmtl red");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(OCTAHEDRON.as_bytes()).expect("packed");
    folder.put("in/d.obj.gz", packed.finish().expect("packed"));
    let expected = ["a/y.ply", "a/z.ply", "b.ply", "c.v2.ply", "d.ply"];
    assert_eq!(outputs(&folder, "in", ""), expected);
    assert_eq!(outputs(&folder, "./in/", ""), expected);
    assert_eq!(outputs(&folder, "in --full-names", "")[4], "d.obj.gz.ply");
    assert_eq!(outputs(&folder, "in in/b.obj ./in/a", ""), [&expected[..], &["y.ply", "z.ply"]].concat());
    assert_eq!(outputs(&folder, "in --base .", "")[0], "in/a/y.ply");
    assert_eq!(outputs(&folder, "in --format ply-ascii", "")[0], "a/y.ply");
}

#[test]
fn patterns_are_those_of_the_shell() {
    let folder = with_meshes(&[
        "in/a/1.obj",
        "in/a/2.obj",
        "in/b/1.obj",
        "in/b/.3.obj",
        "in/b/c/4.obj",
        "in/b/[5].obj",
    ]);
    assert_eq!(outputs(&folder, "in/a/?.obj", ""), ["1.ply", "2.ply"]);
    assert_eq!(outputs(&folder, "in/*/1.obj", ""), ["a/1.ply", "b/1.ply"]);
    assert_eq!(outputs(&folder, "in/**/[1-3].obj", ""), ["a/1.ply", "a/2.ply", "b/1.ply"]);
    assert_eq!(outputs(&folder, "in/b/**/*.obj", ""), ["1.ply", "[5].ply", "c/4.ply"]);
    assert_eq!(outputs(&folder, "in/b/[5].obj", ""), ["[5].ply"], "a file that is there is no pattern");
    // Points of an earlier run are no meshes.
    assert_eq!(outputs(&folder, "**/1.*", ""), ["in/a/1.ply", "in/b/1.ply"]);
    folder.run("batch **/1.* -o out -n 5").ok().says(&["2 meshes: 2 done, 2 of them before"]);
}

#[test]
fn lists_name_files_and_folders() {
    let folder = with_meshes(&["in/a/1.obj", "in/a/2.obj", "in/b/1.obj", "in/c/x*.obj"]);
    let list = "in/a/2.obj\r\n\nin/c\nin/c/x*.obj\nin/a/1.obj\n";
    assert_eq!(outputs(&folder, "--list -", list), ["2.ply", "x*.ply", "1.ply"]);
    folder.write("list.txt", list);
    assert_eq!(
        outputs(&folder, "in/b --list list.txt --base in", ""),
        ["b/1.ply", "a/2.ply", "c/x*.ply", "a/1.ply"]
    );
    // What is not there is told like what cannot be used.
    let ran = folder.run_with_input("batch --list - -o more -n 5", "in/a/1.obj\nin/none.obj\nin/a/2.obj");
    assert_eq!(ran.code, 1);
    let rows = folder.summary("more/summary.csv");
    assert_eq!(column(&rows, "error_kind"), ["", "read", ""]);
    assert!(rows[1]["error"].contains("No such file"), "{}", rows[1]["error"]);
}

#[test]
fn outputs_that_would_meet_are_refused_with_both_meshes() {
    let folder = with_meshes(&["in/a.obj", "in/b.obj", "in/a.ply", "two/a.obj"]);
    folder.run("batch in -o out").refused(&["in/a.obj", "in/a.ply", "out/a.ply", "--full-names"]);
    folder.run("batch in/a.obj two/a.obj -o out").refused(&["in/a.obj", "two/a.obj", "--base"]);
    assert_eq!(folder.names(), ["in", "two"]);
    assert_eq!(outputs(&folder, "in --full-names", ""), ["a.obj.ply", "a.ply.ply", "b.obj.ply"]);
    assert_eq!(outputs(&folder, "in/a.obj two/a.obj --base .", ""), ["in/a.ply", "two/a.ply"]);
    folder.put("in2/summary.obj", OCTAHEDRON);
    folder.run("batch in2 -o out --format csv").refused(&["summary", "--full-names"]);
}

#[test]
fn outputs_below_the_meshes_are_no_meshes() {
    let folder = with_meshes(&["in/a.obj", "in/b.obj"]);
    folder.run("batch in -o in/points -n 5").ok().says(&["2 meshes: 2 done"]);
    folder.run("batch in -o in/points -n 5").ok().says(&["2 meshes: 2 done, 2 of them before"]);
    folder.run("batch . -o in/points -n 5").ok().says(&["2 meshes: 2 done, 0 of them before"]);
    assert_eq!(
        folder.outputs("in/points").into_keys().collect::<Vec<_>>(),
        ["a.ply", "b.ply", "in/a.ply", "in/b.ply"]
    );
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_loops_are_not() {
    use std::os::unix::fs::symlink;
    let folder = with_meshes(&["in/a.obj", "store/b.obj", "store/deep/c.obj"]);
    for (to, link) in [("../store/b.obj", "in/b.obj"), ("../store/deep", "in/deep"), (".", "in/again")] {
        symlink(to, folder.path(link)).expect("a link");
    }
    assert_eq!(outputs(&folder, "in", ""), ["a.ply", "b.ply", "deep/c.ply"]);
    assert_eq!(outputs(&folder, "in/**/*.obj", ""), ["a.ply", "b.ply", "deep/c.ply"]);
    symlink("nowhere", folder.path("in/lost.obj")).expect("a link");
    let told = folder.run("batch in/*.obj -o lost -n 5").says(&["1 of 3 meshes failed"]);
    assert_eq!(told.code, 1);
}

/// A pipe that nobody writes to would be waited for.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_failures() {
    let folder = with_meshes(&["in/a.obj", "in/c.obj"]);
    folder
        .write("in/d.obj", format!("mtllib pipe.mtl\n{OCTAHEDRON}").replace("f 1 3 5", "usemtl m\nf 1 3 5"));
    for pipe in ["in/b.obj", "in/pipe.mtl"] {
        let made = std::process::Command::new("mkfifo").arg(folder.path(pipe)).status();
        assert!(made.expect("mkfifo runs").success());
    }
    for (meshes, out) in [("in", "1"), ("in/*.obj", "2"), ("in/a.obj in/b.obj in/c.obj in/d.obj", "3")] {
        let ran = folder.run(&format!("batch {meshes} -o {out} -n 5 --attributes color"));
        ran.says(&["no regular file", "pipe.mtl", "it is no file", "4 of 4 meshes failed"]);
        let rows = folder.summary(&format!("{out}/summary.csv"));
        // The octahedra have no colour.
        assert_eq!(column(&rows, "error_kind"), ["options", "read", "options", "format"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_name_that_is_no_text_is_a_failure_of_its_own() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = with_meshes(&["in/a.obj", "in/c.obj"]);
    std::fs::write(folder.path("in").join(OsStr::from_bytes(b"b\xff.obj")), OCTAHEDRON).expect("a file");
    let ran = folder.run("batch in -o out -n 5").says(&["not UTF-8", "1 of 3 meshes failed"]);
    assert_eq!(ran.code, 1);
    let rows = folder.summary("out/summary.csv");
    assert_eq!(column(&rows, "error_kind"), ["", "name", ""]);
    assert_eq!(column(&rows, "output"), ["a.ply", "", "c.ply"]);
    assert_eq!(folder.run("batch in -o out -n 5 --summary-only").code, 1);
    assert_eq!(column(&folder.summary("out/summary.csv"), "error_kind"), ["", "name", ""]);
    for (place, pattern) in ["in/*.obj", "**/??.obj", "i*/[!c]?.obj", "in/b*"].into_iter().enumerate() {
        let ran = folder.run(&format!("batch {pattern} -o out-{place} -n 5"));
        assert!(ran.code == 1 && ran.stderr.contains("not UTF-8"), "{pattern}: {}", ran.stderr);
    }
}
