//! The finer estimate of the irregular zone: the cases a to c of section 4.3.
//!
//! How the cases are read here. The zone beside an edge is the band of width d_m inside the strip, ended on both
//! sides by the half-angle lines of its corners, so that a convex corner is shared by its two edges and not
//! counted twice (what case b asks for). That makes it
//! - a) a triangle, when the half-angle lines meet before d_m;
//! - b) otherwise a trapezoid, which is a rectangle where both half-angles are 90 degrees;
//! - c) where a half-angle is larger than 90 degrees, the trapezoid would reach out to a spike; it ends at the
//!   perpendicular instead, and the corner is filled by a circular sector of radius d_m over the rest of the
//!   half-angle.
//!
//! The zones of different edges are added up. Zones narrower than 2 d_m count twice, as the paper wants them to.

use std::f64::consts::{FRAC_PI_2, PI};

use super::open::OpenEdge;

/// The zones of all open edges of a strip added up.
pub(super) fn zone(edges: &[OpenEdge], d_m: f64) -> f64 {
    edges
        .iter()
        .map(|edge| {
            let lean = lean(edge.start_angle) + lean(edge.end_angle);
            band(edge.length, lean, d_m) + sector(edge.start_angle, d_m) + sector(edge.end_angle, d_m)
        })
        .sum()
}

/// How far the half-angle line of a corner leans over the edge, a unit of height: 0 at straight and concave
/// corners.
fn lean(angle: f64) -> f64 {
    if angle >= PI {
        return 0.0;
    }
    let (sin, cos) = libm::sincos(0.5 * angle);
    // A corner of angle 0 leaves nothing of the band: infinite.
    cos / sin
}

/// The area of a band of width `d_m` along an edge whose ends lean in by `lean` a unit of height, together.
fn band(length: f64, lean: f64, d_m: f64) -> f64 {
    if lean * d_m >= length { 0.5 * length * (length / lean) } else { d_m * (length - 0.5 * lean * d_m) }
}

/// The sector beyond the perpendicular at a concave corner, up to the half-angle line.
fn sector(angle: f64, d_m: f64) -> f64 {
    0.5 * d_m * d_m * (0.5 * angle - FRAC_PI_2).max(0.0)
}
