//! Real meshes, read and checked. The folder is named by `LDWRAP_MESHES`; without it these tests say so and pass.
#![cfg(feature = "io")]

use std::path::PathBuf;

use ldwrap::io::{MeshFormat, detect, read_mesh};
use ldwrap::{CheckOptions, PolygonSoup, RepairReport, SurfaceMesh};

fn read(name: &str) -> Option<PolygonSoup> {
    let Some(folder) = std::env::var_os("LDWRAP_MESHES") else {
        eprintln!("skipped: LDWRAP_MESHES does not name the folder of {name}");
        return None;
    };
    let bytes = std::fs::read(PathBuf::from(folder).join(name)).expect("the mesh is there");
    // The content tells the format without the name.
    assert_eq!(detect(&bytes, None), MeshFormat::from_name(name));
    Some(
        read_mesh(&bytes, None, &|uri| Err(format!("{uri} is not looked for")))
            .expect("the mesh can be read"),
    )
}

struct Expected {
    vertices: usize,
    edges: usize,
    faces: usize,
    components: usize,
    border_edges: usize,
    report: fn(&mut RepairReport),
}

fn check(name: &str, expected: Expected) -> Option<SurfaceMesh> {
    let soup = read(name)?;
    let (mesh, report) =
        SurfaceMesh::from_soup(&soup, &CheckOptions::default()).expect("the mesh is a surface");
    let topology = mesh.topology();
    let mut expected_report = RepairReport::default();
    (expected.report)(&mut expected_report);
    assert_eq!(report, expected_report, "{name}");
    let counts = (mesh.vertex_count(), topology.edge_count(), mesh.face_count());
    assert_eq!(counts, (expected.vertices, expected.edges, expected.faces), "{name}");
    assert_eq!(topology.components().count, expected.components, "{name}");
    assert_eq!(topology.border_edge_count(), expected.border_edges, "{name}");
    for face in topology.face_ids() {
        assert!(mesh.face_area(face) > 0.0 && (mesh.face_normal(face).length() - 1.0).abs() < 1e-14);
    }
    Some(mesh)
}

/// Closed, of genus 0 (V - E + F = 2), wound inward in the file.
#[test]
fn horse() {
    let expected = Expected {
        vertices: 48_485,
        edges: 145_449,
        faces: 96_966,
        components: 1,
        border_edges: 0,
        report: |r| r.turned_components = 1,
    };
    let Some(mesh) = check("horse.ply", expected) else { return };
    assert!(volume(&mesh) > 0.0);
    // Sources were turned with their faces.
    let soup = read("horse.ply").unwrap();
    for face in mesh.topology().face_ids() {
        let corners = mesh.sources()[face.index()].corners.map(|place| soup.corners[place as usize]);
        assert_eq!(corners.map(|v| soup.positions[v as usize]), mesh.triangle(face));
    }
    let as_it_is = SurfaceMesh::from_soup(&soup, &CheckOptions { turn_outward: false }).unwrap();
    assert!(as_it_is.1.is_clean() && volume(&as_it_is.0) < 0.0);
}

fn volume(mesh: &SurfaceMesh) -> f64 {
    mesh.topology()
        .face_ids()
        .map(|face| {
            let [a, b, c] = mesh.triangle(face);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

#[test]
fn fruit_drink() {
    let expected = Expected {
        vertices: 390,
        edges: 1_164,
        faces: 776,
        components: 1,
        border_edges: 0,
        report: |r| r.turned_components = 1,
    };
    check("fruit-drink-800.obj", expected);
}

#[test]
fn bunny() {
    let expected = Expected {
        vertices: 34_834,
        edges: 104_288,
        faces: 69_451,
        components: 1,
        border_edges: 223,
        report: |r| r.isolated_vertices = 1_113,
    };
    check("stanford-bunny.obj", expected);
}

#[test]
fn fandisk() {
    let expected = Expected {
        vertices: 6_475,
        edges: 19_419,
        faces: 12_946,
        components: 1,
        border_edges: 0,
        report: |_| {},
    };
    check("fandisk.obj", expected);
}

#[test]
fn teapot() {
    let expected = Expected {
        vertices: 3_241,
        edges: 9_560,
        faces: 6_320,
        components: 4,
        border_edges: 160,
        report: |r| r.welded_vertices = 403,
    };
    check("teapot.obj", expected);
}

/// 468 quadrangles and 32 triangles.
#[test]
fn suzanne() {
    let expected = Expected {
        vertices: 505,
        edges: 1_474,
        faces: 967,
        components: 4,
        border_edges: 47,
        report: |r| {
            // Two vertices lie on others, which makes one triangle a copy and one edge an edge of three.
            r.welded_vertices = 2;
            r.polygons_triangulated = 468;
            r.duplicate_faces = 1;
            r.non_manifold_edges = 1;
        },
    };
    check("suzanne.obj", expected);
}
