//! Which copies of a cut edge lie together, so that it is none.

use glam::DVec2;

use super::{BorderEdge, Twin};
use crate::parallel;
use crate::sets::Sets;

/// Two copies of a vertex nearer than this, relative to the strip's extent, are one: rounding moved them apart, not
/// the surface's curvature.
const COINCIDENT: f64 = 1e-11;

/// So many border edges are looked at together.
const PIECE: usize = 1 << 12;

/// For each vertex the first of its copies, if copies of a vertex on both sides of a cut lie together exactly (up to
/// rounding): these must be one, so that no gap or overlap of rounding's width can lose or double a point.
pub(super) fn coincident(vertices: &[DVec2], border: &[BorderEdge]) -> Option<Vec<u32>> {
    let extents = parallel::map_chunks(vertices.len(), PIECE, |piece| {
        vertices[piece].iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()))
    });
    let tolerance = COINCIDENT * extents.into_iter().fold(0.0, f64::max);
    let near = |a: u32, b: u32| vertices[a as usize].distance(vertices[b as usize]) <= tolerance;
    // No cut of a curved surface has such copies, so most of the work is to see that there are none: in pieces.
    let copies = parallel::map_chunks(border.len(), PIECE, |piece| {
        let mut copies = Vec::new();
        for edge in &border[piece] {
            let Twin::SameStrip { from, to } = edge.twin else { continue };
            // Each cut shows up twice, and its two copies differ in a vertex at least.
            let sorted = |a: u32, b: u32| (a.max(b), a.min(b));
            if sorted(edge.from, edge.to) < sorted(from, to) {
                let pairs = [(edge.from, from), (edge.to, to)];
                copies.extend(pairs.into_iter().filter(|&(a, b)| a != b && near(a, b)));
            }
        }
        copies
    });
    if copies.iter().all(Vec::is_empty) {
        return None;
    }
    let mut joined = Sets::new(vertices.len());
    for (a, b) in copies.into_iter().flatten() {
        joined.join(a, b);
    }
    Some((0..vertices.len() as u32).map(|v| joined.root(v)).collect())
}
