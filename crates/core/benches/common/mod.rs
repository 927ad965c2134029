//! The meshes and points that are timed, and quick settings: a whole run of all benchmarks takes minutes.

use std::time::Duration;

use criterion::Criterion;
use ldwrap::pipeline::{Options, Request, Run, run};
use ldwrap::{CheckOptions, PolygonSoup, Silent, SurfaceMesh, SurfacePoint, io, shapes};

/// Criterion with few, short samples: enough to see a tenth.
pub(crate) fn quick() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1))
}

/// Shapes by name: the paper's cup, scans of 10,000, 100,000 and 1,000,000 triangles, and the horse where `LDWRAP_MESHES`
/// names a folder that holds `horse.ply`.
#[allow(dead_code, reason = "not every benchmark takes all meshes")]
pub(crate) fn soups() -> Vec<(&'static str, PolygonSoup)> {
    let mut soups = vec![("cup", shapes::cup(1))];
    for (name, faces) in [("scan 10k", 10_000), ("scan 100k", 100_000), ("scan 1M", 1_000_000)] {
        soups.push((name, shapes::scan_like(1, faces)));
    }
    soups.extend(horse().map(|soup| ("horse", soup)));
    soups
}

/// What most is timed on: the horse, else a scan of as many triangles.
#[allow(dead_code, reason = "not every benchmark takes one mesh")]
pub(crate) fn mesh() -> SurfaceMesh {
    checked(&horse().unwrap_or_else(|| shapes::scan_like(1, 97_000)))
}

fn horse() -> Option<PolygonSoup> {
    let Some(folder) = std::env::var_os("LDWRAP_MESHES") else {
        eprintln!("LDWRAP_MESHES is not set: the horse is skipped");
        return None;
    };
    let bytes =
        std::fs::read(std::path::Path::new(&folder).join("horse.ply")).expect("horse.ply can be read");
    Some(io::read_mesh(&bytes, None, &|_| Err("no other file".into())).expect("horse.ply is a mesh"))
}

/// The surface of a soup that is known to be good.
pub(crate) fn checked(soup: &PolygonSoup) -> SurfaceMesh {
    SurfaceMesh::from_soup(soup, &CheckOptions::default()).expect("the mesh is good").0
}

/// All stages but equalizing, and the points that they give.
#[allow(dead_code, reason = "not every benchmark takes points")]
pub(crate) fn wrapped(mesh: &SurfaceMesh, count: usize) -> (Run, Vec<SurfacePoint>) {
    let options = Options { request: Request::Count(count), ..Options::default() };
    let run = run(mesh, &options, &Silent).expect("the options can be met");
    let points = run.samples.iter().map(|s| s.point).collect();
    (run, points)
}
