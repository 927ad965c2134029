//! What a camera sees: the visible share of the surface against the visible share of the points, the paper's purpose.

use glam::{Mat4, Vec2, Vec3};
use ldwrap::{SurfaceMesh, SurfacePoint};
use serde::{Deserialize, Serialize};

/// An obstacle before the camera: a box of the picture, in clip space (-1 to 1, y up).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Occluder {
    /// Its lower left corner.
    pub low: Vec2,
    /// Its upper right corner.
    pub high: Vec2,
}

/// A camera and an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Looking {
    /// Where the eye is.
    pub eye: Vec3,
    /// From space to clip space.
    pub matrix: Mat4,
    /// What stands in the way.
    pub occluder: Option<Occluder>,
}

/// What was seen, in shares from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// The visible share of the surface.
    pub surface: f64,
    /// The visible share of the points of A and of B, where they hold points.
    pub points: [Option<f64>; 2],
}

/// Casts rays on a mesh.
pub struct Looker {}

impl Looker {
    /// Prepares a mesh.
    pub fn new(mesh: &SurfaceMesh) -> Self {
        let _ = mesh;
        Self {}
    }

    /// Finds what a camera sees.
    pub fn look(&self, mesh: &SurfaceMesh, points: [Option<&[SurfacePoint]>; 2], looking: &Looking) -> Look {
        let _ = (mesh, points, looking);
        Look { surface: 0.0, points: [None, None] }
    }
}
