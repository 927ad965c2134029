//! Triangles in space: area, normal, barycentric coordinates, nearest point.

use glam::DVec3;

/// Twice the area of the triangle times its unit normal (counterclockwise seen from the tip of the normal).
#[inline]
pub fn area_vector(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    (b - a).cross(c - a)
}

/// The area of the triangle `a b c`.
#[inline]
pub fn area(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    0.5 * area_vector(a, b, c).length()
}

/// The point with barycentric coordinates `w` (sum 1).
#[inline]
pub fn at(a: DVec3, b: DVec3, c: DVec3, w: [f64; 3]) -> DVec3 {
    a * w[0] + b * w[1] + c * w[2]
}

/// The corners laid congruently in the plane: `a` at the origin, `b` on the positive x-axis, `c` above it.
/// Returns `(|ab|, x of c, y of c)`.
#[inline]
pub fn flatten(a: DVec3, b: DVec3, c: DVec3) -> (f64, f64, f64) {
    let ab = b - a;
    let ac = c - a;
    let length = ab.length();
    if length == 0.0 {
        return (0.0, ac.length(), 0.0);
    }
    (length, ac.dot(ab) / length, ab.cross(ac).length() / length)
}

/// Its first longest side, as the number of the corner that the side starts at, and the square of its length.
#[inline]
pub fn longest_side([a, b, c]: [DVec3; 3]) -> (usize, f64) {
    let sides = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
    let first = (1..3).fold(0, |best, side| if sides[side] > sides[best] { side } else { best });
    (first, sides[first])
}

/// A triangle whose doubled area is less than this part of the square over its longest side is a needle.
const NEEDLE: f64 = 1e-6;

/// The barycentric coordinates of the point of the triangle nearest to `p` (Ericson, Real-Time Collision
/// Detection, 2005, section 5.1.5); never negative, sum 1. In needles, a million times as long as high or longer, where
/// areas have no digits left, at most their height from the nearest one.
pub fn nearest(a: DVec3, b: DVec3, c: DVec3, p: DVec3) -> [f64; 3] {
    let (_, longest) = longest_side([a, b, c]);
    if area_vector(a, b, c).length_squared() < (NEEDLE * longest) * (NEEDLE * longest) {
        return nearest_in_needle([a, b, c], p);
    }
    nearest_inside(a, b, c, p)
}

/// The nearest on a side, or what areas say, whichever is nearer.
fn nearest_in_needle(corners: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let [a, b, c] = corners;
    let [_, v, w] = nearest_inside(a, b, c, p);
    let v = v.clamp(0.0, 1.0);
    let w = w.clamp(0.0, 1.0 - v);
    let mut best = [1.0 - v - w, v, w];
    let distance = |weights| at(a, b, c, weights).distance_squared(p);
    for first in 0..3 {
        let (from, side) = (corners[first], corners[(first + 1) % 3] - corners[first]);
        let squared = side.length_squared();
        let along = if squared == 0.0 { 0.0 } else { ((p - from).dot(side) / squared).clamp(0.0, 1.0) };
        let mut weights = [0.0; 3];
        weights[first] = 1.0 - along;
        weights[(first + 1) % 3] = along;
        if distance(weights) < distance(best) {
            best = weights;
        }
    }
    best
}

fn nearest_inside(a: DVec3, b: DVec3, c: DVec3, p: DVec3) -> [f64; 3] {
    let ab = b - a;
    let ac = c - a;
    let ap = p - a;
    let d1 = ab.dot(ap);
    let d2 = ac.dot(ap);
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let d3 = ab.dot(bp);
    let d4 = ac.dot(bp);
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    // The parts of the area by cross products: by products of the numbers above (Ericson) they lose twice as many digits.
    let normal = ab.cross(ac);
    let vc = normal.dot(ab.cross(ap));
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let cp = p - c;
    let d5 = ab.dot(cp);
    let d6 = ac.dot(cp);
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = normal.dot(ap.cross(ac));
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let va = normal.dot((c - b).cross(bp));
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let sum = va + vb + vc;
    let v = vb / sum;
    let w = vc / sum;
    [(1.0 - v - w).max(0.0), v, w]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point on a needle is found again, to its height.
    #[test]
    fn nearest_on_needles() {
        for exponent in 0..14 {
            let aspect = libm::exp10(f64::from(exponent));
            let [a, b, c] =
                [DVec3::ZERO, DVec3::new(0.8, -0.36, -0.48), DVec3::new(0.6, 0.48, 0.64) * aspect];
            for weights in [[0.25, 0.25, 0.5], [0.0, 0.125, 0.875], [0.5, 0.0, 0.5], [0.03125, 0.46875, 0.5]]
            {
                let p = at(a, b, c, weights);
                let found = nearest(a, b, c, p);
                assert!(found.iter().all(|w| (0.0..=1.0).contains(w)), "{found:?}");
                let off = at(a, b, c, found).distance(p);
                assert!(off <= 1.0, "{aspect:e}: {off:e}");
            }
        }
    }
}
