//! Writes the meshes of `assets/` and the table that describes them: `cargo run -p ldwrap --example assets [FOLDER]`.

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

use ldwrap::io::mesh_out::write_mesh;
use ldwrap::shapes::{Shape, cube, drink_like, plate, scan_like, torus, trefoil};
use ldwrap::{CheckOptions, PolygonSoup, SurfaceMesh};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("assets"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    for (name, bytes) in files()? {
        std::fs::write(folder.join(name), bytes)?;
    }
    Ok(())
}

/// Files with their names.
type Files = Vec<(String, Vec<u8>)>;

/// All files.
pub(crate) fn files() -> Result<Files, Box<dyn Error>> {
    let meshes: [(&str, &str, PolygonSoup); 8] = [
        ("sphere.obj", "the paper's sphere (figure 4)", Shape::Sphere.generate()),
        ("cup.ply", "a cup with the paper's counts (figure 5)", Shape::Cup.generate()),
        (
            "drink.ply",
            "a scanned drink with the counts of the paper's \"Fruit Drink\" (figure 6)",
            drink_like(1),
        ),
        ("scan.ply", "a bumpy body with unstructured triangles", scan_like(1, 6_000)),
        ("trefoil.ply", "a knotted tube", trefoil(200, 20, 0.5)),
        ("torus.off", "a torus, smooth area 15.791367", torus(50, 20, 0.4)),
        ("cube.stl", "a cube", cube(4)),
        ("plate.obj", "a thin plate: its two sides are 0.01 apart", plate(8, 0.01)),
    ];
    let mut readme = String::from(
        "# Meshes\n\nMade by `cargo run -p ldwrap --example assets` from the generators in `ldwrap::shapes`; a test keeps \
         the files and this table equal to what the generators make.\n\nV, E, F: vertices, edges, triangles after checking \
         (equal positions welded). Border: edges with one triangle. Areas are those of the triangles.\n\n\
         | file | what | V | E | F | border | area |\n|---|---|---:|---:|---:|---:|---:|\n",
    );
    let mut files = Vec::new();
    for (name, what, soup) in meshes {
        let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;
        writeln!(
            readme,
            "| {name} | {what} | {} | {} | {} | {} | {:.6} |",
            mesh.vertex_count(),
            mesh.topology().edge_count(),
            mesh.face_count(),
            mesh.topology().border_edge_count(),
            mesh.area()
        )?;
        files.push((name.to_owned(), write_mesh(&soup, name)?));
    }
    files.push(("README.md".to_owned(), readme.into_bytes()));
    Ok(files)
}
