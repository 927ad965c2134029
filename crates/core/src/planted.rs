//! Meshes for tests whose answers are known.

use glam::{DMat3, DVec3};

use crate::mesh::{CheckOptions, PolygonSoup, SurfaceMesh};

/// The checked mesh of a soup that has no fault.
pub(crate) fn mesh(soup: &PolygonSoup) -> SurfaceMesh {
    SurfaceMesh::from_soup(soup, &CheckOptions::default()).expect("a planted mesh passes the check").0
}

/// Adds the polygons of `other` as parts of their own.
pub(crate) fn join(soup: &mut PolygonSoup, other: &PolygonSoup) {
    let first = soup.positions.len() as u32;
    soup.positions.extend_from_slice(&other.positions);
    for polygon in 0..other.polygon_count() {
        let corners: Vec<u32> = other.polygon(polygon).iter().map(|c| c + first).collect();
        soup.push_polygon(&corners);
    }
}

/// The soup with every position moved.
pub(crate) fn moved(mut soup: PolygonSoup, f: impl Fn(DVec3) -> DVec3) -> PolygonSoup {
    for p in &mut soup.positions {
        *p = f(*p);
    }
    soup
}

/// Some turn about no axis in particular.
pub(crate) fn turn() -> DMat3 {
    DMat3::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 1.1)
}

/// What `f` gives with one thread and with two.
#[cfg(feature = "parallel")]
pub(crate) fn with_threads<R: Send>(f: impl Fn() -> R + Sync) -> [R; 2] {
    [1, 2].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("a small pool").install(&f))
}
