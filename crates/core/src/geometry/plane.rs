//! The plane: orientation with exact sign, the half-open rule, distances.

use glam::DVec2;
use robust::{Coord, orient2d};

use crate::lanes::{LANES, Lanes};

fn coord(p: DVec2) -> Coord<f64> {
    Coord { x: p.x, y: p.y }
}

/// Positive when `c` lies to the left of the line from `a` to `b`, negative to the right, zero exactly on it.
/// The sign is exact (Shewchuk, DOI 10.1007/PL00009321).
#[inline]
pub fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether `p` lies to the left of the directed line `a b`, where a point exactly on the line counts as shifted
/// by an infinitesimal (e, e^2). Of an edge and its reverse exactly one has any given point on its left.
#[inline]
pub fn is_left_half_open(a: DVec2, b: DVec2, p: DVec2) -> bool {
    let o = orientation(a, b, p);
    if o != 0.0 {
        return o > 0.0;
    }
    if a.y != b.y { a.y > b.y } else { b.x > a.x }
}

/// Whether the counterclockwise triangle holds `p` under the half-open rule of [`is_left_half_open`]: a point on
/// an edge or corner inside a region tiled by triangles belongs to exactly one of them.
#[inline]
pub fn triangle_holds(a: DVec2, b: DVec2, c: DVec2, p: DVec2) -> bool {
    is_left_half_open(a, b, p) && is_left_half_open(b, c, p) && is_left_half_open(c, a, p)
}

/// A triangle of less than this part of the square over its longest side is a needle: 2e-6 times as high as long.
const NEEDLE: f64 = 1e-6;

/// Barycentric coordinates of `p` in the triangle, clamped to it (never negative, sum 1).
/// A triangle without area gives its first corner.
#[inline]
pub fn barycentric(a: DVec2, b: DVec2, c: DVec2, p: DVec2) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let area = ab.perp_dot(ac);
    if area == 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let longest = ab.length_squared().max(ac.length_squared()).max((c - b).length_squared());
    if area.abs() < NEEDLE * longest {
        return in_needle([a, b, c], p);
    }
    let v = (ap.perp_dot(ac) / area).clamp(0.0, 1.0);
    let w = (ab.perp_dot(ap) / area).clamp(0.0, 1.0 - v);
    [1.0 - v - w, v, w]
}

/// A triangle in which many points are looked up.
pub(crate) struct Triangle {
    corners: [DVec2; 3],
    ab: DVec2,
    ac: DVec2,
    area: f64,
    /// Whether areas have no digits left, or there are none.
    is_needle: bool,
}

impl Triangle {
    #[inline]
    pub(crate) fn new(corners: [DVec2; 3]) -> Self {
        let [a, b, c] = corners;
        let (ab, ac) = (b - a, c - a);
        let area = ab.perp_dot(ac);
        let longest = ab.length_squared().max(ac.length_squared()).max((c - b).length_squared());
        // True also where one of them is no number.
        let is_needle = !(area != 0.0 && area.abs() >= NEEDLE * longest);
        Self { corners, ab, ac, area, is_needle }
    }

    /// As [`barycentric`], to the bit.
    #[inline]
    pub(crate) fn barycentric(&self, [x, y]: &[Lanes; 2]) -> [Lanes; 3] {
        let mut weights = [[0.0; LANES]; 3];
        if self.is_needle {
            let [a, b, c] = self.corners;
            for lane in 0..LANES {
                let of_lane = barycentric(a, b, c, DVec2::new(x[lane], y[lane]));
                (0..3).for_each(|corner| weights[corner][lane] = of_lane[corner]);
            }
            return weights;
        }
        let Self { corners: [a, ..], ab, ac, area, .. } = *self;
        for lane in 0..LANES {
            let ap = DVec2::new(x[lane] - a.x, y[lane] - a.y);
            let v = between(ap.perp_dot(ac) / area, 1.0);
            let w = between(ab.perp_dot(ap) / area, 1.0 - v);
            (weights[0][lane], weights[1][lane], weights[2][lane]) = (1.0 - v - w, v, w);
        }
        weights
    }
}

/// Clamped to the numbers from 0 to `most`.
#[inline]
fn between(x: f64, most: f64) -> f64 {
    let x = if x < 0.0 { 0.0 } else { x };
    if x > most { most } else { x }
}

/// As [`barycentric`], where areas have no digits left: the place along the longest side counts, and rounding moves `p`
/// across it alone, by less than the height.
#[cold]
fn in_needle(corners: [DVec2; 3], p: DVec2) -> [f64; 3] {
    let length = |i: usize| corners[i].distance_squared(corners[(i + 1) % 3]);
    let first = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j))).unwrap_or(0);
    let [from, to, apex] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
    let (side, up, at) = (to - from, apex - from, p - from);
    let squared = side.length_squared();
    let height = side.perp_dot(up);
    let [along, apex_along] = [at, up].map(|v| (v.dot(side) / squared).clamp(0.0, 1.0));
    // The triangle is no higher than this there.
    let left = if apex_along > 0.0 { along / apex_along } else { 1.0 };
    let right = if apex_along < 1.0 { (1.0 - along) / (1.0 - apex_along) } else { 1.0 };
    let most = left.min(right).min(1.0);
    let high = if height == 0.0 { 0.0 } else { (side.perp_dot(at) / height).clamp(0.0, most) };
    let far = (along - high * apex_along).clamp(0.0, 1.0 - high);
    let mut weights = [0.0; 3];
    weights[first] = 1.0 - high - far;
    weights[(first + 1) % 3] = far;
    weights[(first + 2) % 3] = high;
    weights
}

/// How far along the segment `a b` (0 to 1) its point nearest to `p` lies.
#[inline]
pub fn nearest_on_segment(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let ab = b - a;
    let squared = ab.length_squared();
    if squared == 0.0 { 0.0 } else { ((p - a).dot(ab) / squared).clamp(0.0, 1.0) }
}

/// Distance from `p` to the segment `a b`.
#[inline]
pub fn segment_distance(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    p.distance(a + (b - a) * nearest_on_segment(a, b, p))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A place on a needle is found again along it to 1e-9 of its length, whatever its corners are called.
    #[test]
    fn barycentric_coordinates_of_needles() {
        for exponent in 0..16 {
            let long = DVec2::new(0.6, 0.8) * libm::exp10(f64::from(exponent));
            let corners = [DVec2::ZERO, long, long * 0.25 + DVec2::new(-0.8, 0.6)];
            for first in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
                for weights in
                    [[0.25, 0.25, 0.5], [0.125, 0.875, 0.0], [0.0, 0.5, 0.5], [0.5, 0.46875, 0.03125]]
                {
                    let place = |w: [f64; 3]| a * w[0] + b * w[1] + c * w[2];
                    let found = barycentric(a, b, c, place(weights));
                    assert!(found.iter().all(|w| (0.0..=1.0).contains(w)), "{found:?}");
                    assert!((found.iter().sum::<f64>() - 1.0).abs() <= 1e-15, "{found:?}");
                    let off = place(found).distance(place(weights));
                    assert!(off <= 1e-9 * long.length() + 1e-15, "1e{exponent}: {off:e}");
                }
            }
        }
    }
}
