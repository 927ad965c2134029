//! A convex polygon cut into horizontal bands.

use glam::DVec2;

/// A side from its lower end to its upper one.
#[derive(Clone, Copy)]
struct Side {
    low: DVec2,
    high: DVec2,
    /// How far it goes to the right for each unit upward; used between its ends only, so not where it is level.
    slope: f64,
}

/// The sides of a convex polygon, ready to be cut.
#[derive(Clone, Copy)]
pub(super) struct Bands<const N: usize> {
    sides: [Side; N],
    /// The corners of the box around it.
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl<const N: usize> Bands<N> {
    #[inline]
    pub(super) fn new(corners: [DVec2; N]) -> Self {
        let side = |p: DVec2, q: DVec2| {
            let (low, high) = if p.y <= q.y { (p, q) } else { (q, p) };
            Side { low, high, slope: (high.x - low.x) / (high.y - low.y) }
        };
        Self {
            sides: std::array::from_fn(|i| side(corners[i], corners[(i + 1) % N])),
            low: corners.into_iter().fold(DVec2::INFINITY, DVec2::min),
            high: corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max),
        }
    }

    /// The leftmost and the rightmost x of the polygon between two heights, to rounding; `None` if it is not there.
    #[inline]
    pub(super) fn between(&self, bottom: f64, top: f64) -> Option<(f64, f64)> {
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for Side { low, high, slope } in self.sides {
            if low.y > top || high.y < bottom {
                continue;
            }
            let x = if low.y < bottom { low.x + (bottom - low.y) * slope } else { low.x };
            let z = if high.y > top { low.x + (top - low.y) * slope } else { high.x };
            left = left.min(x).min(z);
            right = right.max(x).max(z);
        }
        (left <= right).then_some((left, right))
    }
}
