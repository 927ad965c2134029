//! Questions about places in space: what a ray meets, what can be seen, which point of the surface is nearest.
//!
//! Trees of boxes only leave out triangles that cannot matter; what decides is arithmetic in double precision on
//! the triangles themselves, so the answers do not depend on the shape of the tree nor on the platform.

mod bins;
mod caster;
mod frame;
mod nearest;

pub use caster::{Camera, Caster, Hit};
pub use nearest::{Projected, nearest};

#[cfg(test)]
mod tests;
