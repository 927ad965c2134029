//! Fixed jobs whose instructions `cargo xtask instructions` counts: `instructions JOB` does one and prints nothing.
//!
//! Each job does everything from the shape on, so that what a stage costs is the difference to the job before it, which
//! `xtask/src/instructions.rs` names. Built without `parallel`, so there is one thread and one order.

use std::hint::black_box;

use ldwrap::density::Density;
use ldwrap::equalize::{EqualizeOptions, equalize};
use ldwrap::pipeline::{Options, Request, Run, run};
use ldwrap::segment::segment;
use ldwrap::unfold::unfold;
use ldwrap::{CheckOptions, PolygonSoup, Silent, StripId, SurfaceMesh, SurfacePoint, io, measure, shapes};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Enough for each stage to meet all its cases, few enough for a simulated processor.
const POINTS: usize = 1_000;
const MANY_POINTS: usize = 20_000;

fn main() -> Outcome {
    let job = std::env::args().nth(1).ok_or("usage: instructions JOB")?;
    let soup = shapes::cup(1);
    match job.as_str() {
        "shape" => drop(black_box(soup)),
        "ply-write" => drop(black_box(ply_of(&soup))),
        "ply-read" => drop(black_box(io::read_mesh(&ply_of(&soup), None, &|_| Err("no other file".into()))?)),
        "check" => drop(black_box(checked(&soup)?)),
        "segment" => drop(black_box(segment(&checked(&soup)?, &Default::default()))),
        "unfold" => {
            let mesh = checked(&soup)?;
            drop(black_box(unfold(&mesh, &segment(&mesh, &Default::default()))));
        }
        "wrap" => drop(black_box(wrapped(&checked(&soup)?, POINTS)?)),
        "wrap-many" => drop(black_box(wrapped(&checked(&soup)?, MANY_POINTS)?)),
        // What a region costs must not hang on how many faces it has, again and again.
        "wrap-one" => drop(black_box(wrapped(&checked(&shapes::cube(90))?, 1)?)),
        "irregularity" => drop(black_box(wrapped(&checked(&soup)?, POINTS)?.irregularity())),
        "equalize" | "energy" | "half-space" => {
            let mesh = checked(&soup)?;
            let wrapped = wrapped(&mesh, POINTS)?;
            let points: Vec<SurfacePoint> = wrapped.samples.iter().map(|s| s.point).collect();
            match job.as_str() {
                "energy" => drop(black_box(measure::energy(&mesh, &points, &Default::default(), &Silent))),
                "half-space" => {
                    black_box(measure::half_space(&mesh, &points, &Default::default(), &Silent));
                }
                _ => {
                    let strips: Vec<StripId> = wrapped.strips.places.iter().map(|p| p.strip).collect();
                    let options = EqualizeOptions::default();
                    drop(black_box(equalize(&mesh, &points, &strips, &Density::UNIFORM, &options, &Silent)));
                }
            }
        }
        unknown => return Err(format!("no job is named {unknown}").into()),
    }
    Ok(())
}

fn checked(soup: &PolygonSoup) -> Outcome<SurfaceMesh> {
    Ok(SurfaceMesh::from_soup(soup, &CheckOptions::default())?.0)
}

fn wrapped(mesh: &SurfaceMesh, count: usize) -> Outcome<Run> {
    Ok(run(mesh, &Options { request: Request::Count(count), ..Options::default() }, &Silent)?)
}

/// A binary PLY as scanners write them, in single precision.
fn ply_of(soup: &PolygonSoup) -> Vec<u8> {
    let mut ply = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        soup.positions.len(),
        soup.polygon_count()
    )
    .into_bytes();
    for position in &soup.positions {
        for coordinate in position.to_array() {
            ply.extend_from_slice(&(coordinate as f32).to_le_bytes());
        }
    }
    for polygon in 0..soup.polygon_count() {
        let corners = soup.polygon(polygon);
        ply.push(corners.len() as u8);
        for corner in corners {
            ply.extend_from_slice(&corner.to_le_bytes());
        }
    }
    ply
}
