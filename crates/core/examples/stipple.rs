//! Draws a mesh in dots, as engravers do: dark places get many, bright ones few.
//! `cargo run --release -p ldwrap --example stipple -- assets/trefoil.ply 20000 trefoil.svg`
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fmt::Write;

use glam::{DVec2, DVec3};
use ldwrap::attributes::{MeshAttributes, Places};
use ldwrap::density::Density;
use ldwrap::io::read_mesh;
use ldwrap::pipeline::{Options, run_weighted};
use ldwrap::spatial::{Camera, Caster};
use ldwrap::{CheckOptions, Silent, SurfaceMesh, SurfacePoint};

/// From where it is looked at, and from where the light comes.
const TOWARD: DVec3 = DVec3::new(0.48, -0.64, 0.6);
const LIGHT: DVec3 = DVec3::new(-0.36, -0.48, 0.8);

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: stipple MESH [POINTS [FILE.svg]]")?;
    let count = arguments.next().map_or(Ok(20_000), |text| text.parse())?;
    let file = arguments.next().unwrap_or_else(|| "stipple.svg".into());
    let soup = read_mesh(&std::fs::read(&path)?, Some(&path), &|_| Err("one file only".into()))?;
    let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;

    let dots = dots(&mesh, count)?;
    std::fs::write(&file, svg(&dots))?;
    println!("{file}: {} dots of {count} points are seen", dots.len());
    Ok(())
}

/// Where in the picture the visible points lie.
pub(crate) fn dots(mesh: &SurfaceMesh, count: usize) -> Result<Vec<DVec2>, Box<dyn Error>> {
    let attributes = MeshAttributes::default();
    let normals = Places::new(mesh, &attributes);
    let weight = |point: SurfacePoint| {
        let normal = normals.normal(mesh, &point);
        // Lambert's law; never quite white, or bright places would have no outline.
        let darkness = 1.0 - 0.95 * normal.dot(LIGHT).max(0.0);
        // A slanted face covers less of the picture. What is turned away needs no points.
        darkness * normal.dot(TOWARD).max(0.0)
    };
    let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let weights: Vec<[f64; 3]> = mesh
        .topology()
        .face_ids()
        .map(|face| corners.map(|barycentric| weight(SurfacePoint { face, barycentric })))
        .collect();
    let density = Density::of_corners(mesh, &weights)?;
    let run = run_weighted(mesh, &density, &Options::for_count(count), &Silent)?;

    let places: Vec<_> = run.samples.iter().map(|s| (s.point.face, mesh.locate(&s.point))).collect();
    let seen = Caster::new(mesh).visible(&Camera::Orthographic { toward: TOWARD }, &places);
    let right = DVec3::Z.cross(TOWARD).normalize();
    let up = TOWARD.cross(right);
    let visible = places.iter().zip(seen).filter(|(_, seen)| *seen);
    // The y axis of SVG points down.
    Ok(visible.map(|(&(_, place), _)| DVec2::new(place.dot(right), -place.dot(up))).collect())
}

/// A picture 1,000 wide of black dots.
fn svg(dots: &[DVec2]) -> String {
    let low = dots.iter().fold(DVec2::INFINITY, |low, &dot| low.min(dot));
    let high = dots.iter().fold(DVec2::NEG_INFINITY, |high, &dot| high.max(dot));
    let scale = 980.0 / (high - low).x;
    let height = (high - low).y * scale + 20.0;
    // As much ink whatever the number of dots.
    let radius = 180.0 / (dots.len() as f64).sqrt();
    let mut svg = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1000 {height:.0}\">\n");
    for &dot in dots {
        let at = (dot - low) * scale + 10.0;
        let _ = writeln!(svg, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.2}\"/>", at.x, at.y);
    }
    svg + "</svg>\n"
}
