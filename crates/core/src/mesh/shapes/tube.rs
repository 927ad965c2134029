//! A knotted tube.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::mesh::shapes::grid::{closed_tube, on_circle};
use crate::mesh::soup::PolygonSoup;

/// A tube around the trefoil knot (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t): `along` (at least 3) rings of `across` (at
/// least 3) vertices at `tube_radius` (below 0.6: wider tubes meet themselves). 2 along across triangles; the smooth tube
/// has area 2 pi tube_radius times the knot's length, 28.8263.
pub fn trefoil(along: u32, across: u32, tube_radius: f64) -> PolygonSoup {
    let (along, across) = (along.max(3), across.max(3));
    let rings: Vec<_> = (0..along)
        .map(|ring| {
            let t = TAU * f64::from(ring) / f64::from(along);
            let (s1, c1) = libm::sincos(t);
            let (s2, c2) = libm::sincos(2.0 * t);
            let (s3, c3) = libm::sincos(3.0 * t);
            let place = DVec3::new(s1 + 2.0 * s2, c1 - 2.0 * c2, -s3);
            let first = DVec3::new(c1 + 4.0 * c2, -s1 + 4.0 * s2, -3.0 * c3);
            let second = DVec3::new(-s1 - 8.0 * s2, -c1 + 8.0 * c2, 9.0 * s3);
            // Frenet's frame; the knot's curvature is nowhere zero, so the frame closes.
            let tangent = first.normalize();
            let binormal = first.cross(second).normalize();
            (place, binormal.cross(tangent), binormal)
        })
        .collect();
    closed_tube(along, across, |ring, segment| {
        let (place, normal, binormal) = rings[ring as usize];
        let p = on_circle(segment, across) * tube_radius;
        place + normal * p.x + binormal * p.y
    })
    .into_soup()
}
