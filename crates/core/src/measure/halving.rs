//! Cutting triangles in two.

use glam::DVec3;

/// The squared length of the triangle's longest edge, and its two halves when cut across that edge; halving again
/// and again keeps the angles bounded (Rosenberg and Stenger, DOI 10.1137/0712033).
pub(super) fn halve([a, b, c]: [DVec3; 3]) -> (f64, [[DVec3; 3]; 2]) {
    let (ab, bc, ca) = (a.distance_squared(b), b.distance_squared(c), c.distance_squared(a));
    // Turned so that the longest edge runs from p to q.
    let (p, q, r, squared) = if ab >= bc && ab >= ca {
        (a, b, c, ab)
    } else if bc >= ca {
        (b, c, a, bc)
    } else {
        (c, a, b, ca)
    };
    let middle = (p + q) * 0.5;
    (squared, [[p, middle, r], [middle, q, r]])
}
