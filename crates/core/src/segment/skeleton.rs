//! Step 1 of 4.1: the skeleton of a strip, a run of triangles across longest edges in both directions.

use super::growth::Growth;
use crate::ids::HalfedgeId;

/// Plants the triangle of `seed`, its longest edge, and runs from it in both directions: each next triangle lies
/// across the longest edge of the last one that is not the edge of entry, until that triangle is taken already.
pub(super) fn skeleton(growth: &mut Growth<'_>, seed: HalfedgeId) {
    growth.plant(seed.face());
    run(growth, growth.longer(seed.next(), seed.previous()));
    run(growth, seed);
}

fn run(growth: &mut Growth<'_>, mut across: HalfedgeId) {
    while let Some(entry) = growth.attach_across(across) {
        across = growth.longer(entry.next(), entry.previous());
    }
}
