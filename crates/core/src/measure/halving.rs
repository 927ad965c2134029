//! Cutting triangles in two.

use glam::DVec3;

use crate::geometry::triangle::longest_side;

/// The squared length of the triangle's longest edge, and its two halves when cut across that edge; halving again
/// and again keeps the angles bounded (Rosenberg and Stenger, DOI 10.1137/0712033).
pub(super) fn halve(corners: [DVec3; 3]) -> (f64, [[DVec3; 3]; 2]) {
    let (first, squared) = longest_side(corners);
    let [p, q, r] = [0, 1, 2].map(|turn| corners[(first + turn) % 3]);
    let middle = (p + q) * 0.5;
    (squared, [[p, middle, r], [middle, q, r]])
}
