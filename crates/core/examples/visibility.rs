//! How much of a surface can be seen? Counts points instead of measuring areas:
//! `cargo run --release -p ldwrap --example visibility -- assets/cup.ply 500`
//!
//! Printed are, for some cameras, the visible share of the points, that of the area (found with 400,000 places), and the
//! error that as many random points would have.
#![allow(clippy::print_stdout)]

use std::error::Error;

use ldwrap::io::read_mesh;
use ldwrap::measure::{ViewOptions, Views};
use ldwrap::{CheckOptions, Silent, SurfaceMesh};

/// What one camera sees.
pub(crate) struct Seen {
    /// The visible share of the points.
    pub(crate) points: f64,
    /// The visible share of the area.
    pub(crate) area: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: visibility MESH [POINTS]")?;
    let count = arguments.next().map_or(Ok(500), |text| text.parse())?;
    let soup = read_mesh(&std::fs::read(&path)?, Some(&path), &|_| Err("one file only".into()))?;
    let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;

    println!("{count} points\n  points    area    error  (random)");
    for Seen { points, area } in visible_shares(&mesh, count)? {
        // Random points are seen or not like coins that fall.
        let random = (area * (1.0 - area) / count as f64).sqrt();
        println!("{points:8.4}{area:8.4}{:+9.4}{random:10.4}", points - area);
    }
    Ok(())
}

/// The visible shares from 16 cameras around the mesh, every other one orthographic.
pub(crate) fn visible_shares(mesh: &SurfaceMesh, count: usize) -> Result<Vec<Seen>, Box<dyn Error>> {
    let samples = ldwrap::sample(mesh, count)?;
    let places: Vec<_> = samples.iter().map(|s| (s.point.face, mesh.locate(&s.point))).collect();
    // The areas are here only to compare with: a program that wants to know what is visible needs the next lines alone,
    // with a Caster::new(&mesh) and its own cameras.
    let options = ViewOptions { views: 16, occlusions: 0, ..ViewOptions::default() };
    let views = Views::new(mesh, &options, &Silent);
    let of_camera = |(camera, area)| {
        let visible = views.caster().visible(&camera, &places).into_iter().filter(|&seen| seen).count();
        Seen { points: visible as f64 / count as f64, area }
    };
    Ok(views.cameras().zip(views.visible_areas()).map(of_camera).collect())
}
