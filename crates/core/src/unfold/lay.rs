//! Lays the triangles of a segment side by side in the plane, and joins what comes to lie together exactly.

use glam::{DMat2, DVec2};

use super::FacePlace;
use crate::geometry::triangle;
use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::segment::Segment;

/// Two copies of a vertex nearer than this, relative to the strip's extent, are one: rounding moved them apart, not
/// the surface's curvature.
const COINCIDENT: f64 = 1e-11;

/// The triangles of a strip in the plane.
pub(super) struct Planar {
    pub(super) faces: Vec<FaceId>,
    pub(super) corners: Vec<[u32; 3]>,
    pub(super) vertices: Vec<DVec2>,
}

/// The planar vertices at the ends of `halfedge` (start, end), whose face has these corners.
pub(super) fn ends(corners: [u32; 3], halfedge: HalfedgeId) -> (u32, u32) {
    (corners[halfedge.corner()], corners[(halfedge.corner() + 1) % 3])
}

/// Lays the triangles along the segment's spanning tree.
pub(super) fn lay(mesh: &SurfaceMesh, segment: &Segment, places: &[FacePlace]) -> Planar {
    let count = segment.attachments.len();
    let mut planar = Planar {
        faces: Vec::with_capacity(count),
        corners: Vec::with_capacity(count),
        vertices: Vec::with_capacity(count + 2),
    };
    for attachment in &segment.attachments {
        let face = attachment.face;
        let space = mesh.triangle(face);
        let twin = attachment.across.and_then(|h| mesh.topology().twin(h).map(|t| (h, t)));
        let corners = if let Some((across, twin)) = twin {
            let parent = planar.corners[places[twin.face().index()].index as usize];
            // The twin runs the other way.
            let (to, from) = ends(parent, twin);
            let first = across.corner();
            let (_, x, y) = triangle::flatten(space[first], space[(first + 1) % 3], space[(first + 2) % 3]);
            let a = planar.vertices[from as usize];
            let along = (planar.vertices[to as usize] - a).try_normalize().unwrap_or(DVec2::X);
            let apex = planar.vertices.len() as u32;
            planar.vertices.push(a + along * x + along.perp() * y);
            let mut corners = [0; 3];
            corners[first] = from;
            corners[(first + 1) % 3] = to;
            corners[(first + 2) % 3] = apex;
            corners
        } else {
            let (length, x, y) = triangle::flatten(space[0], space[1], space[2]);
            let base = planar.vertices.len() as u32;
            planar.vertices.extend([DVec2::ZERO, DVec2::new(length, 0.0), DVec2::new(x, y)]);
            [base, base + 1, base + 2]
        };
        planar.faces.push(face);
        planar.corners.push(corners);
    }
    planar
}

/// Joins copies of a vertex on both sides of a cut that lie together exactly (up to rounding), so that no gap or
/// overlap of rounding's width can lose or double a point.
pub(super) fn close_seams(mesh: &SurfaceMesh, strip: StripId, places: &[FacePlace], planar: &mut Planar) {
    let extent = planar.vertices.iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()));
    let tolerance = COINCIDENT * extent;
    let mut joined: Vec<u32> = (0..planar.vertices.len() as u32).collect();
    let mut any = false;
    for (i, &face) in planar.faces.iter().enumerate() {
        for corner in 0..3 {
            let halfedge = HalfedgeId::of(face, corner);
            let Some(twin) = mesh.topology().twin(halfedge) else { continue };
            let place = places[twin.face().index()];
            if place.strip != strip || twin < halfedge {
                continue;
            }
            let (from, to) = ends(planar.corners[i], halfedge);
            let (twin_to, twin_from) = ends(planar.corners[place.index as usize], twin);
            for (a, b) in [(from, twin_from), (to, twin_to)] {
                let (a, b) = (root(&mut joined, a), root(&mut joined, b));
                if a != b && planar.vertices[a as usize].distance(planar.vertices[b as usize]) <= tolerance {
                    joined[a.max(b) as usize] = a.min(b);
                    any = true;
                }
            }
        }
    }
    if any {
        for v in planar.corners.iter_mut().flatten() {
            *v = root(&mut joined, *v);
        }
    }
}

fn root(joined: &mut [u32], mut v: u32) -> u32 {
    while joined[v as usize] != v {
        joined[v as usize] = joined[joined[v as usize] as usize];
        v = joined[v as usize];
    }
    v
}

/// Turns the strip so that the square around it is small and moves it so that the box around it starts at (0, 0).
pub(super) fn settle(planar: &mut Planar) {
    const TURNS: u32 = 12;
    let box_of = |turn: DMat2, vertices: &[DVec2]| {
        let mut low = DVec2::INFINITY;
        let mut high = DVec2::NEG_INFINITY;
        for &v in vertices {
            let v = turn * v;
            low = low.min(v);
            high = high.max(v);
        }
        (low, high)
    };
    let mut best = (f64::INFINITY, DMat2::IDENTITY, DVec2::ZERO);
    for t in 0..TURNS {
        let (sin, cos) = libm::sincos(f64::from(t) * std::f64::consts::FRAC_PI_2 / f64::from(TURNS));
        let turn = DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos));
        let (low, high) = box_of(turn, &planar.vertices);
        let side = (high - low).max_element();
        // A turn must pay: for a plane figure drawn along the axes, staying put keeps its coordinates exact.
        if side < best.0 * (1.0 - 1e-6) {
            best = (side, turn, low);
        }
    }
    let (_, turn, low) = best;
    for v in &mut planar.vertices {
        *v = turn * *v - low;
    }
}
