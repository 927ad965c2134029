//! Triangulates polygons with more than three corners: constrained Delaunay in the best-fit plane.

use glam::{DVec2, DVec3};
use robust::{Coord, incircle, orient2d};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::ids::VertexId;

/// How a polygon was cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// Into the constrained Delaunay triangulation of its interior.
    Delaunay,
    /// Into a fan around its first corner: it has no interior in its plane, or crosses itself there.
    Fan,
}

/// Appends the triangles of a polygon to `triangles`, each as three places in `corners`, wound like the polygon.
/// There are at least three corners, neighbouring ones differ. Concave polygons and ones that visit a vertex twice
/// (holes joined to the outside by a bridge) are cut as they should be. No vertices are added; a corner that is
/// visited twice is always named by its first place. O(n log n) as a rule.
pub(super) fn triangulate(positions: &[DVec3], corners: &[VertexId], triangles: &mut Vec<[usize; 3]>) -> Cut {
    if let [_, _, _] = corners {
        triangles.push([0, 1, 2]);
        return Cut::Delaunay;
    }
    let before = triangles.len();
    if let Some(plane) = project(positions, corners) {
        if let Some(cut) = convex_quad(corners, &plane.points) {
            triangles.extend(cut);
            return Cut::Delaunay;
        }
        if interior(corners, &plane, triangles).is_some() && triangles.len() > before {
            return Cut::Delaunay;
        }
    }
    triangles.truncate(before);
    triangles.extend((2..corners.len()).map(|i| [0, i - 1, i]));
    Cut::Fan
}

/// A polygon laid into a plane.
struct Plane {
    /// The corners, counterclockwise, at a scale at which the polygon's size is near 1.
    points: Vec<DVec2>,
    /// How far the corners lie from the plane through the first one, at that scale.
    depth: f64,
}

/// A polygon that is not deeper is flat.
const FLAT: f64 = 1e-9;

/// The corners in the polygon's best-fit plane (Newell's normal);
/// `None` if the polygon has no area there. The scale is a power of two and the axes of a polygon in an axis plane
/// are exact, so that collinear corners stay collinear.
fn project(positions: &[DVec3], corners: &[VertexId]) -> Option<Plane> {
    let origin = positions[corners[0].index()];
    let mut points: Vec<DVec3> = corners.iter().map(|v| positions[v.index()] - origin).collect();
    let size = points.iter().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
    let scale = libm::ldexp(1.0, -libm::frexp(size).1);
    for p in &mut points {
        *p *= scale;
    }
    let normal: DVec3 = points.windows(2).map(|pair| pair[0].cross(pair[1])).sum();
    let length = normal.length();
    // The sum's rounding error: below this its direction says nothing.
    (length > f64::EPSILON * points.len() as f64).then(|| {
        let normal = normal / length;
        let (u, v) = normal.any_orthonormal_pair();
        Plane {
            points: points.iter().map(|p| DVec2::new(p.dot(u), p.dot(v))).collect(),
            depth: points.iter().fold(0.0, |depth: f64, p| depth.max(p.dot(normal).abs())),
        }
    })
}

fn coord(p: DVec2) -> Coord<f64> {
    Coord { x: p.x, y: p.y }
}

/// The Delaunay triangles of a strictly convex quadrangle, without building a triangulation: most polygons are.
fn convex_quad(corners: &[VertexId], plane: &[DVec2]) -> Option<[[usize; 3]; 2]> {
    let [a, b, c, d] = *plane else { return None };
    if corners[0] == corners[2] || corners[1] == corners[3] {
        return None;
    }
    let [a, b, c, d] = [a, b, c, d].map(coord);
    let left = |p, q, r| orient2d(p, q, r) > 0.0;
    if !(left(a, b, c) && left(b, c, d) && left(c, d, a) && left(d, a, b)) {
        return None;
    }
    Some(if incircle(a, b, c, d) > 0.0 { [[1, 2, 3], [1, 3, 0]] } else { [[0, 1, 2], [0, 2, 3]] })
}

/// A corner in the plane and its first place in the polygon.
struct Corner {
    point: DVec2,
    place: usize,
}

impl HasPosition for Corner {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        // Spade refuses coordinates nearer to zero; relative to the size of 1 they are zero.
        let flush = |x: f64| if x.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { x };
        Point2::new(flush(self.point.x), flush(self.point.y))
    }
}

/// Appends the triangles of the constrained Delaunay triangulation that the boundary winds around exactly once;
/// `None` if the boundary crosses itself.
fn interior(corners: &[VertexId], plane: &Plane, triangles: &mut Vec<[usize; 3]>) -> Option<()> {
    let mut cdt = ConstrainedDelaunayTriangulation::<Corner>::new();
    let first = first_places(corners);
    let mut handles = Vec::with_capacity(corners.len());
    for (place, &point) in plane.points.iter().enumerate() {
        let handle = if first[place] == place {
            let count = cdt.num_vertices();
            let handle = cdt.insert(Corner { point, place }).ok()?;
            if cdt.num_vertices() == count {
                return None; // two vertices in the same place of the plane
            }
            handle
        } else {
            handles[first[place]]
        };
        handles.push(handle);
    }
    // How often the boundary runs along each edge, in the edge's own direction minus against it.
    let mut pieces = Vec::with_capacity(corners.len());
    for (i, &from) in handles.iter().enumerate() {
        let added = cdt.try_add_constraint(from, handles[(i + 1) % handles.len()]);
        if added.is_empty() {
            return None; // crosses a constraint
        }
        if added.len() > 1 && plane.depth > FLAT {
            return None; // runs over or under a corner
        }
        pieces.extend(added);
    }
    let mut along = vec![0i32; cdt.num_directed_edges()];
    for piece in pieces {
        along[piece.index()] += 1;
        along[piece.rev().index()] -= 1;
    }
    // The winding number changes by that much across the edge; flood it inward from the outer face.
    let mut winding = vec![None; cdt.num_all_faces()];
    winding[cdt.outer_face().index()] = Some(0);
    let mut open: Vec<_> =
        cdt.directed_edges().filter(|e| e.rev().is_outer_edge()).map(|e| e.fix()).collect();
    while let Some(edge) = open.pop() {
        let edge = cdt.directed_edge(edge);
        let face = edge.face();
        let value = winding[edge.rev().face().fix().index()].map(|w: i32| w + along[edge.fix().index()]);
        match winding[face.fix().index()] {
            None => {
                winding[face.fix().index()] = value;
                open.push(edge.next().rev().fix());
                open.push(edge.prev().rev().fix());
            }
            known if known == value => {}
            _ => return None,
        }
    }
    for face in cdt.inner_faces() {
        match winding[face.fix().index()] {
            Some(0) => {}
            Some(1) => triangles.push(face.vertices().map(|v| v.data().place)),
            _ => return None, // wound twice or backwards
        }
    }
    Some(())
}

/// For each corner the first place of its vertex in the polygon.
fn first_places(corners: &[VertexId]) -> Vec<usize> {
    let mut order: Vec<(VertexId, usize)> = corners.iter().copied().zip(0..).collect();
    order.sort_unstable();
    let mut first = vec![0; corners.len()];
    for group in order.chunk_by(|a, b| a.0 == b.0) {
        for &(_, place) in group {
            first[place] = group[0].1;
        }
    }
    first
}

#[cfg(test)]
#[path = "polygon_tests.rs"]
mod tests;
