//! Surfels: discs that stand for a surface, as renderers of points and reconstructions take them.
//! `cargo run --release -p ldwrap --example surfels -- assets/scan.ply 3000 surfels.ply`
//!
//! Each disc lies in the tangent plane and is as large as the part of the surface nearest to its point, so all discs
//! together have the area of the surface. The PLY file has `x y z nx ny nz radius`.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::PI;

use ldwrap::attributes::{MeshAttributes, Places};
use ldwrap::io::points::{Field, FieldData, PointFormat, Precision, write_fields};
use ldwrap::io::read_mesh;
use ldwrap::measure::cell_areas;
use ldwrap::{CheckOptions, SurfaceMesh, SurfacePoint};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: surfels MESH [POINTS [FILE.ply]]")?;
    let count = arguments.next().map_or(Ok(3000), |text| text.parse())?;
    let file = arguments.next().unwrap_or_else(|| "surfels.ply".into());
    let soup = read_mesh(&std::fs::read(&path)?, Some(&path), &|_| Err("one file only".into()))?;
    let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;

    let mut bytes = Vec::new();
    write_fields(PointFormat::Ply, &surfels(&mesh, count)?, &mut bytes)?;
    std::fs::write(&file, bytes)?;
    println!("{file}: {count} surfels");
    Ok(())
}

/// Positions, smooth normals and radii.
pub(crate) fn surfels(mesh: &SurfaceMesh, count: usize) -> Result<Vec<Field>, Box<dyn Error>> {
    let points: Vec<SurfacePoint> = ldwrap::sample(mesh, count)?.iter().map(|s| s.point).collect();
    // Discs on flat normals show the triangles.
    let attributes = MeshAttributes::default();
    let normals = Places::new(mesh, &attributes);
    // Equalized points have nearly equal cells, but a cell at a border or on a thin part may still be smaller.
    let radii = cell_areas(mesh, &points).into_iter().map(|area| (area / PI).sqrt());
    let field = |key: &str, columns: &[&str], values, precision| Field {
        key: key.into(),
        columns: columns.iter().map(|&column| column.into()).collect(),
        data: FieldData::Real(values, precision),
    };
    let positions = mesh.locate_all(&points).flat_map(|place| place.to_array()).collect();
    let directions = points.iter().flat_map(|point| normals.normal(mesh, point).to_array()).collect();
    Ok(vec![
        field("position", &["x", "y", "z"], positions, Precision::Double),
        field("normal", &["nx", "ny", "nz"], directions, Precision::Single),
        field("radius", &["radius"], radii.collect(), Precision::Single),
    ])
}
