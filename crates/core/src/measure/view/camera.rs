//! Where the cameras of the view measure stand.

use glam::{DVec2, DVec3};

use super::purpose;
use crate::baseline::spherical_fibonacci;
use crate::mesh::SurfaceMesh;
use crate::random::Random;
use crate::spatial::Camera;

/// How far perspective cameras stand from the middle, in radii of the sphere around the box of the mesh.
const DISTANCES: [f64; 3] = [1.5, 2.5, 4.0];

/// A camera with what is needed to draw its image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Viewpoint {
    pub(super) camera: Camera,
    middle: DVec3,
    /// The radius of the sphere around the box of the mesh: the image of the mesh is about as large.
    pub(super) radius: f64,
    /// From the middle to the camera.
    toward: DVec3,
    /// The axes of the image.
    right: DVec3,
    up: DVec3,
    /// The distance of a perspective camera from the middle; infinite for an orthographic one.
    distance: f64,
}

impl Viewpoint {
    /// Where a place appears in the image, in units of the mesh as they are at the middle.
    pub(super) fn image(&self, place: DVec3) -> DVec2 {
        let from = place - self.middle;
        let flat = DVec2::new(from.dot(self.right), from.dot(self.up));
        match self.camera {
            Camera::Orthographic { .. } => flat,
            Camera::Perspective { .. } => flat * (self.distance / (self.distance - from.dot(self.toward))),
        }
    }
}

/// The cameras: every other one orthographic. They depend on the box around the mesh and the seed alone.
pub(super) fn viewpoints(mesh: &SurfaceMesh, views: usize, seed: u64) -> Vec<Viewpoint> {
    let (low, high) = mesh.bounds();
    let middle = low * 0.5 + high * 0.5;
    let radius = 0.5 * low.distance(high);
    let turn = Random::new(seed, purpose::TURN).rotation();
    spherical_fibonacci(views)
        .into_iter()
        .enumerate()
        .map(|(i, direction)| {
            let toward = (turn * direction).normalize();
            let (right, up) = toward.any_orthonormal_pair();
            let (camera, distance) = if i % 2 == 0 {
                (Camera::Orthographic { toward }, f64::INFINITY)
            } else {
                let distance = radius * DISTANCES[i / 2 % DISTANCES.len()];
                (Camera::Perspective { eye: middle + toward * distance }, distance)
            };
            Viewpoint { camera, middle, radius, toward, right, up, distance }
        })
        .collect()
}
