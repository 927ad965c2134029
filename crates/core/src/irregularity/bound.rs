//! The rough estimate of the irregular zone (paper, eq. 8).

use std::f64::consts::PI;

use super::open::{OpenEdge, open_edges};
use super::total_area;
use crate::unfold::Strips;

/// Corners of a straight border are only straight up to rounding; below this many radians beyond 180 degrees
/// they are not concave.
const STRAIGHT: f64 = 1e-6;

/// Only [`Irregularity::bound`](super::Irregularity::bound), for searching the density that meets a wanted R.
/// Lengths in units of the mesh; linear in the size of the strips.
pub fn bound(strips: &Strips, d_m: f64, tolerance: f64) -> f64 {
    let total = total_area(strips);
    if total <= 0.0 {
        return 0.0;
    }
    strips.strips.iter().map(|strip| zone(&open_edges(strip, tolerance), d_m)).sum::<f64>() / total
}

/// The right side of eq. 8 for one strip: d_m times the length of its open edges, plus 2 d_m squared for each
/// concave corner between them.
pub(super) fn zone(edges: &[OpenEdge], d_m: f64) -> f64 {
    let length: f64 = edges.iter().map(|edge| edge.length).sum();
    // Every corner ends exactly one open edge, so counting at the ends counts each once.
    let concave = edges.iter().filter(|edge| edge.end_angle > PI + STRAIGHT).count();
    d_m * length + 2.0 * d_m * d_m * concave as f64
}
