//! Lays the triangles of a segment side by side in the plane, and joins what comes to lie together exactly.

use glam::{DMat2, DVec2};

use super::FacePlace;
use crate::geometry::triangle;
use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::segment::Segment;
use crate::sets::Sets;

/// Two copies of a vertex nearer than this, relative to the strip's extent, are one: rounding moved them apart, not
/// the surface's curvature.
const COINCIDENT: f64 = 1e-11;

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
            // The twin runs the other way.
            let (to, from) = planar.ends(3 * places[twin.face().index()].index + twin.corner() as u32);
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

/// For each side of the strip's faces (side `c` of its `i`-th face is `3 i + c`) the same edge as its neighbour in the
/// strip sees it; `None` where the surface or the strip ends.
pub(super) fn twins(
    mesh: &SurfaceMesh,
    strip: StripId,
    places: &[FacePlace],
    faces: &[FaceId],
) -> Vec<Option<u32>> {
    let side = |face, corner| {
        let twin = mesh.topology().twin(HalfedgeId::of(face, corner))?;
        let place = places[twin.face().index()];
        (place.strip == strip).then(|| 3 * place.index + twin.corner() as u32)
    };
    faces.iter().flat_map(|&face| [0, 1, 2].map(|corner| side(face, corner))).collect()
}

/// Joins copies of a vertex on both sides of a cut that lie together exactly (up to rounding), so that no gap or
/// overlap of rounding's width can lose or double a point.
pub(super) fn close_seams(planar: &mut Planar, twins: &[Option<u32>]) {
    let extent = planar.vertices.iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()));
    let tolerance = COINCIDENT * extent;
    let mut joined = Sets::new(planar.vertices.len());
    let mut any = false;
    for (side, twin) in (0u32..).zip(twins) {
        let Some(twin) = twin.filter(|twin| side < *twin) else { continue };
        let (from, to) = planar.ends(side);
        // The twin runs the other way.
        let (twin_to, twin_from) = planar.ends(twin);
        for (a, b) in [(from, twin_from), (to, twin_to)] {
            if a == b {
                continue;
            }
            let (a, b) = (joined.root(a), joined.root(b));
            if a != b && planar.vertices[a as usize].distance(planar.vertices[b as usize]) <= tolerance {
                joined.join(a, b);
                any = true;
            }
        }
    }
    if any {
        for v in planar.corners.iter_mut().flatten() {
            *v = joined.root(*v);
        }
    }
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
