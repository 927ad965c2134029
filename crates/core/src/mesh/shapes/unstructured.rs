//! Unstructured triangles all around: the Delaunay triangulation of directions.

use std::f64::consts::TAU;

use glam::DVec3;
use spade::{DelaunayTriangulation, Point2, Triangulation};

use crate::random::Random;

/// Joins directions (unit vectors, at least 4, all different, not in one half space) to the triangles of their
/// convex hull, which is their Delaunay triangulation on the sphere; counterclockwise seen from outside. The hull is
/// found in the plane: seen from the last direction, circles on the sphere are circles there (stereographic
/// projection). Exactly 2 n - 4 triangles; O(n log n).
pub(super) fn join_directions(directions: &[DVec3]) -> Vec<[u32; 3]> {
    let Some((&pole, others)) = directions.split_last() else {
        return Vec::new();
    };
    let (u, v) = pole.any_orthonormal_pair();
    let (u, v) = if u.cross(v).dot(pole) > 0.0 { (v, u) } else { (u, v) };
    let plane = others
        .iter()
        .map(|d| {
            let scale = 1.0 / (1.0 - d.dot(pole));
            Point2::new(d.dot(u) * scale, d.dot(v) * scale)
        })
        .collect();
    let triangulation: DelaunayTriangulation<Point2<f64>> = DelaunayTriangulation::bulk_load_stable(plane)
        .expect("directions other than the pole are finite in the plane");
    debug_assert_eq!(triangulation.num_vertices(), others.len(), "the directions are different");
    let mut faces: Vec<[u32; 3]> =
        triangulation.inner_faces().map(|face| face.vertices().map(|vertex| vertex.index() as u32)).collect();
    let pole = others.len() as u32;
    for edge in triangulation.convex_hull() {
        let outer = if edge.is_outer_edge() { edge } else { edge.rev() };
        faces.push([outer.from().index() as u32, outer.to().index() as u32, pole]);
    }
    faces
}

/// Uniform in the disc of radius 1.
pub(super) fn in_disc(random: &mut Random) -> (f64, f64) {
    let radius = random.unit().sqrt();
    let (sin, cos) = libm::sincos(TAU * random.unit());
    (radius * cos, radius * sin)
}
