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

    /// The leftmost and the rightmost x of the polygon in some bands of this height, by their lower sides, to rounding; the
    /// leftmost one lies to the right of the other where it is not there.
    #[inline]
    pub(super) fn between<const LANES: usize>(
        &self,
        bottoms: &[f64; LANES],
        height: f64,
    ) -> [[f64; LANES]; 2] {
        let (mut left, mut right) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
        for Side { low, high, slope } in self.sides {
            for lane in 0..LANES {
                let (bottom, top) = (bottoms[lane], bottoms[lane] + height);
                let at_bottom = low.x + (bottom - low.y) * slope;
                let at_top = low.x + (top - low.y) * slope;
                let x = if low.y < bottom { at_bottom } else { low.x };
                let z = if high.y > top { at_top } else { high.x };
                let (near, far) = if x < z { (x, z) } else { (z, x) };
                let is_there = (low.y <= top) & (high.y >= bottom);
                left[lane] = if is_there & (near < left[lane]) { near } else { left[lane] };
                right[lane] = if is_there & (far > right[lane]) { far } else { right[lane] };
            }
        }
        [left, right]
    }
}
