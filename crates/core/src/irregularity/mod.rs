//! The irregularity ratio R (paper, 4.3): how much of the surface lies so close to a torn border of its strip
//! that the even spread of the points is broken there.
//!
//! Which border edges count: those of every strip whose gap is wider than the tolerance
//! ([`Strip::is_open`](crate::unfold::Strip::is_open)). A cut whose two copies lie closer is mended by the
//! correction (paper, 4.2 step 5) and is treated as if it had never been made: the border is followed across it, and the angle of a corner
//! there is that of both copies together.
//!
//! | estimate | counts | may exceed 1 |
//! |---|---|---|
//! | [`bound`](Irregularity::bound) | eq. 8: a rectangle an edge, two squares a concave corner | yes |
//! | [`refined`](Irregularity::refined) | cases a to c: the band of each edge, ended by the half-angle lines | yes: thin fingers count twice |
//! | [`exact`](Irregularity::exact) | the area of the points nearer than d_m to an open border edge, through the strip | never |

mod bound;
mod capsule;
mod exact;
mod flood;
mod open;
mod refined;
#[cfg(test)]
mod tests;

pub use bound::bound;

use crate::unfold::Strips;

/// The three estimates of R; each counts the border edges whose gap is wider than the correction's tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Irregularity {
    /// Eq. 8: length of the open border times d_m plus 2 d_m squared for each concave corner, over the area.
    pub bound: f64,
    /// The estimate of the cases a to c.
    pub refined: f64,
    /// The area of the band of width d_m along the open border over the total area: never above 1.
    pub exact: f64,
    /// The share of the area of which `exact` leaves open whether it lies in the band; it counts half. At most 1e-4, but
    /// where needles lie side by side and finding out would take too long.
    pub undecided: f64,
}

/// The three estimates of R at mean spacing `d_m`, where cuts with a gap of at most `tolerance` count as closed;
/// both are lengths in units of the mesh. All are 0 for strips without area.
///
/// Cost: linear in the faces for the first two; the exact one adds a flood from all open edges at once, and a
/// subdivision of those faces that the rim of the zone crosses.
pub fn irregularity(strips: &Strips, d_m: f64, tolerance: f64) -> Irregularity {
    let total = total_area(strips);
    if total <= 0.0 {
        return Irregularity { bound: 0.0, refined: 0.0, exact: 0.0, undecided: 0.0 };
    }
    let open: Vec<_> = strips.strips.iter().map(|strip| open::open_edges(strip, tolerance)).collect();
    let exact = exact::share(strips, &open, d_m);
    Irregularity {
        bound: open.iter().map(|edges| bound::zone(edges, d_m)).sum::<f64>() / total,
        refined: open.iter().map(|edges| refined::zone(edges, d_m)).sum::<f64>() / total,
        exact: exact.zone,
        undecided: exact.undecided,
    }
}

/// The area of all strips.
fn total_area(strips: &Strips) -> f64 {
    strips.strips.iter().map(|strip| strip.area).sum()
}
