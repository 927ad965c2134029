//! The built-in shapes as files, and back.

use crate::common::Folder;

#[test]
fn the_papers_counts_in_every_format() {
    let folder = Folder::new();
    for extension in ["ply", "obj", "stl", "off"] {
        folder.run(&format!("shape sphere -o sphere.{extension}")).ok().says(&["760 triangles"]);
        let info = folder.run(&format!("info sphere.{extension} --json -q")).ok().json();
        let counts =
            ["vertices", "edges", "faces", "border_edges"].map(|key| info[key].as_u64().expect("a count"));
        assert_eq!(counts, [382, 1140, 760, 0], "{extension}");
    }
    folder.run("shape cup -o cup.ply -q").ok();
    let cup = folder.run("info cup.ply --json -q").ok().json();
    let counts =
        ["vertices", "edges", "faces", "border_edges"].map(|key| cup[key].as_u64().expect("a count"));
    assert_eq!(counts, [7024, 20976, 13952, 96]);
    assert_eq!(cup["euler_characteristic"], 0);
}

#[test]
fn every_shape_can_be_wrapped_from_a_pipe() {
    let folder = Folder::new();
    let help = folder.run("shape --help").ok();
    for shape in
        ["sphere", "cup", "scan", "torus", "trefoil", "cube", "plate", "capsule", "square", "tetrahedron"]
    {
        assert!(help.text().contains(shape), "{shape}");
        let mesh = folder.run(&format!("shape {shape} --faces 200 -o - --format ply -q")).ok();
        let ran = folder.run_with_input("wrap - -n 57 --report - -q", mesh.stdout).ok();
        assert_eq!(ran.json()["points"]["count"], 57, "{shape}");
    }
}

#[test]
fn about_as_many_faces_as_asked_for() {
    let folder = Folder::new();
    folder.run("shape sphere --faces 50000 -o s.ply -q").ok();
    let faces = folder.run("info s.ply --json").ok().json()["faces"].as_u64().expect("a count");
    assert!(faces.abs_diff(50_000) < 1000, "{faces}");
}

#[test]
fn wrong_use() {
    let folder = Folder::new();
    folder.run("shape dodecahedron -o d.ply").refused(&["dodecahedron", "tetrahedron"]);
    folder.run("shape cube -o cube.docx").refused(&["cube.docx", "ply"]);
    folder.run("shape cube -o cube").refused(&["cube", "ply"]);
    folder.run("shape cube -o -").refused(&["--format"]);
    folder.run("shape cube").refused(&["--output"]);
    folder.run("shape cube --faces 0 -o cube.ply").refused(&["--faces"]);
    folder.run("shape cube -o missing/cube.ply").failed(&["missing/cube.ply", "no folder"]);
    assert!(folder.names().is_empty());
}

#[test]
fn units_and_axes_are_stated_where_the_format_has_them() {
    let folder = Folder::new();
    folder.run("shape cube -q -o cube.stl").ok();
    let told = folder.run("info cube.stl").ok();
    assert!(
        told.text().contains("STL does not say, nor which axis is up; coordinates are left"),
        "{}",
        told.text()
    );
    let json = folder.run("info cube.stl --json").ok().json();
    assert_eq!(json["format"], "stl");
    assert!(json["unit"].is_null() && json["up"].is_null(), "{json}");
    folder.run("info cube.stl --mesh-format ply").failed(&["cube.stl"]);
}
