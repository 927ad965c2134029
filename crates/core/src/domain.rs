//! The planar domain (paper, 4.2 steps 1 and 3): where each strip lies.

use glam::DVec2;

/// The square that holds the strips and the points.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarDomain {
    /// The length of its sides, in units of the mesh.
    pub side: f64,
    /// Where the origin of each strip lies in it.
    pub offsets: Vec<DVec2>,
}
