//! Point clouds to learn from: as many points as the network takes, with normals, in the unit ball around their middle,
//! a cloud for each seed:
//! `cargo run --release -p ldwrap --example point_cloud -- assets/torus.off 1024 4 clouds`
//!
//! writes `clouds-1.npz` to `clouds-4.npz`; `numpy.load` finds in each `position` and `normal`, float32, 1024 x 3. Points
//! in proportion to area, evenly spread, are the same surface to a network with fewer of them, and another seed is
//! another look at the same surface: augmentation that invents nothing.
#![allow(clippy::print_stdout)]

use std::error::Error;

use glam::DVec3;
use ldwrap::io::points::{Field, FieldData, PointFormat, Precision, write_fields};
use ldwrap::io::read_mesh;
use ldwrap::pipeline::{Options, run};
use ldwrap::{CheckOptions, Silent, SurfaceMesh};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: point_cloud MESH [POINTS [CLOUDS [NAME]]]")?;
    let count = arguments.next().map_or(Ok(1024), |text| text.parse())?;
    let clouds = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let name = arguments.next().unwrap_or_else(|| "cloud".into());
    let soup = read_mesh(&std::fs::read(&path)?, Some(&path), &|_| Err("one file only".into()))?;
    let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;

    for seed in 1..=clouds {
        let mut bytes = Vec::new();
        write_fields(PointFormat::Npz, &cloud(&mesh, count, seed)?, &mut bytes)?;
        let file = format!("{name}-{seed}.npz");
        std::fs::write(&file, bytes)?;
        println!("{file}: {count} points");
    }
    Ok(())
}

/// Positions in the unit ball around their mean, one of them on its rim, and normals.
pub(crate) fn cloud(mesh: &SurfaceMesh, count: usize, seed: u64) -> Result<Vec<Field>, Box<dyn Error>> {
    let run = run(mesh, &Options { seed, ..Options::for_count(count) }, &Silent)?;
    let middle = run.places(mesh).sum::<DVec3>() / count as f64;
    let radius = run.places(mesh).map(|place| place.distance(middle)).fold(0.0, f64::max);
    // A single point is its own middle.
    let scale = if radius > 0.0 { radius.recip() } else { 1.0 };
    let field = |key: &str, vectors: Vec<[f64; 3]>| Field {
        key: key.into(),
        columns: ["x", "y", "z"].map(Into::into).into(),
        data: FieldData::Real(vectors.into_flattened(), Precision::Single),
    };
    let positions = run.places(mesh).map(|place| ((place - middle) * scale).to_array());
    let normals = run.points().map(|point| mesh.face_normal(point.face).to_array());
    Ok(vec![field("position", positions.collect()), field("normal", normals.collect())])
}
