//! Lays the triangles of a segment side by side in the plane.

use glam::{DMat2, DVec2};

use super::FacePlace;
use crate::geometry::triangle;
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::segment::{Attachment, Segment};

/// The triangles of a strip in the plane.
pub(super) struct Planar {
    pub(super) faces: Vec<FaceId>,
    pub(super) corners: Vec<[u32; 3]>,
    pub(super) vertices: Vec<DVec2>,
}

impl Planar {
    /// The planar vertices at the ends of a side: start, end.
    pub(super) fn ends(&self, side: u32) -> (u32, u32) {
        let corners = &self.corners[side as usize / 3];
        let corner = side as usize % 3;
        (corners[corner], corners[if corner == 2 { 0 } else { corner + 1 }])
    }
}

/// How a triangle hangs on the one before it in the segment.
struct Hung {
    /// The side of the strip's faces that it is attached to; `None` for the first triangle.
    on: Option<u32>,
    /// Where its third corner lies when the side starts at the origin and runs along the x-axis, and the side's length.
    apex: DVec2,
    length: f64,
}

impl Hung {
    fn new(mesh: &SurfaceMesh, attachment: &Attachment, places: &[FacePlace]) -> Self {
        let corners = mesh.triangle(attachment.face);
        let first = attachment.across.map_or(0, HalfedgeId::corner);
        let (length, x, y) =
            triangle::flatten(corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]);
        let twin = attachment.across.and_then(|across| mesh.topology().twin(across));
        let on = twin.map(|twin| 3 * places[twin.face().index()].index + twin.corner() as u32);
        Self { on, apex: DVec2::new(x, y), length }
    }
}

/// Lays the triangles along the segment's spanning tree.
pub(super) fn lay(mesh: &SurfaceMesh, segment: &Segment, places: &[FacePlace]) -> Planar {
    let count = segment.attachments.len();
    let mut planar = Planar {
        faces: segment.attachments.iter().map(|attachment| attachment.face).collect(),
        corners: Vec::with_capacity(count),
        vertices: Vec::with_capacity(count + 2),
    };
    // Shapes do not depend on each other, only places do: pieces that are small enough to stay in the cache.
    const PIECE: usize = 1 << 14;
    for attachments in segment.attachments.chunks(PIECE) {
        let hung = parallel::map(attachments.len(), |i| Hung::new(mesh, &attachments[i], places));
        for (attachment, Hung { on, apex, length }) in attachments.iter().zip(hung) {
            let corners = match on {
                Some(on) => {
                    // The side runs the other way.
                    let (to, from) = planar.ends(on);
                    let a = planar.vertices[from as usize];
                    let along = (planar.vertices[to as usize] - a).try_normalize().unwrap_or(DVec2::X);
                    let third = planar.vertices.len() as u32;
                    planar.vertices.push(a + along * apex.x + along.perp() * apex.y);
                    match attachment.across.map(HalfedgeId::corner) {
                        Some(1) => [third, from, to],
                        Some(2) => [to, third, from],
                        _ => [from, to, third],
                    }
                }
                None => {
                    let base = planar.vertices.len() as u32;
                    planar.vertices.extend([DVec2::ZERO, DVec2::new(length, 0.0), apex]);
                    [base, base + 1, base + 2]
                }
            };
            planar.corners.push(corners);
        }
    }
    planar
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
    let turns = parallel::map(TURNS as usize, |t| {
        let (sin, cos) = libm::sincos(t as f64 * std::f64::consts::FRAC_PI_2 / f64::from(TURNS));
        let turn = DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos));
        let (low, high) = box_of(turn, &planar.vertices);
        (turn, low, (high - low).max_element())
    });
    let mut best = (f64::INFINITY, DMat2::IDENTITY, DVec2::ZERO);
    for (turn, low, side) in turns {
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
