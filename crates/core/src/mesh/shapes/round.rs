//! Surfaces of revolution.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use crate::mesh::shapes::grid::{between_poles, closed_tube, on_circle};
use crate::mesh::soup::PolygonSoup;

/// The unit sphere with vertices on circles of latitude: `segments` (at least 3) around, `rings` (at least 2) from pole to
/// pole. 2 segments (rings - 1) triangles; the paper's sphere (figure 4) is 20 x 20.
pub fn uv_sphere(segments: u32, rings: u32) -> PolygonSoup {
    let (segments, rings) = (segments.max(3), rings.max(2));
    between_poles(DVec3::NEG_Z, DVec3::Z, rings - 1, segments, |ring, segment| {
        let (sin, cos) = libm::sincos(PI * f64::from(ring + 1) / f64::from(rings));
        (on_circle(segment, segments) * sin).extend(-cos)
    })
    .into_soup()
}

/// A torus around the z-axis: its middle circle has radius 1 and `around` (at least 3) vertices, its tube the radius
/// `tube_radius` (below 1) and `across` (at least 3). 2 around across triangles; the smooth torus has area
/// 4 pi^2 tube_radius.
pub fn torus(around: u32, across: u32, tube_radius: f64) -> PolygonSoup {
    let (around, across) = (around.max(3), across.max(3));
    closed_tube(around, across, |ring, segment| {
        let direction = on_circle(ring, around);
        let tube = on_circle(segment, across) * tube_radius;
        // Counterclockwise around the direction of advance: from up to outward.
        (direction * (1.0 + tube.y)).extend(tube.x)
    })
    .into_soup()
}

/// A cylinder of radius 1 and height `length` around the z-axis, closed by half spheres: `segments` (at least 3) around,
/// `rings` (at least 1) along each half sphere and along the cylinder. 2 segments (3 rings - 1) triangles; the smooth
/// capsule has area 4 pi + 2 pi length.
pub fn capsule(segments: u32, rings: u32, length: f64) -> PolygonSoup {
    let (segments, rings) = (segments.max(3), rings.max(1));
    let half = 0.5 * length;
    let profile = |ring: u32| {
        let quarter = |k: u32| libm::sincos(FRAC_PI_2 * f64::from(k) / f64::from(rings));
        if ring < rings {
            let (sin, cos) = quarter(ring);
            DVec2::new(sin, -half - cos)
        } else if ring <= 2 * rings {
            DVec2::new(1.0, -half + length * f64::from(ring - rings) / f64::from(rings))
        } else {
            let (sin, cos) = quarter(3 * rings - ring);
            DVec2::new(sin, half + cos)
        }
    };
    let pole = DVec3::Z * (half + 1.0);
    between_poles(-pole, pole, 3 * rings - 1, segments, |ring, segment| {
        let p = profile(ring + 1);
        (on_circle(segment, segments) * p.x).extend(p.y)
    })
    .into_soup()
}
