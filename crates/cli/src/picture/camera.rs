//! Where the preview is seen from.

use glam::{DVec2, DVec3};
use ldwrap::SurfaceMesh;

/// Looks along parallel lines and fits the mesh into the picture. Files do not say which way is up; y is taken.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    right: DVec3,
    up: DVec3,
    toward: DVec3,
    scale: f64,
    shift: DVec2,
}

/// How much of the picture the mesh fills.
const FILLED: f64 = 0.92;

impl Camera {
    /// From the front, right and above, with all of `mesh` in a picture of `size` pixels.
    pub(crate) fn three_quarter(mesh: &SurfaceMesh, size: DVec2) -> Self {
        let toward = DVec3::new(0.55, 0.36, 0.76).normalize();
        let right = DVec3::Y.cross(toward).normalize();
        let up = toward.cross(right);
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in mesh.topology().faces().iter().flatten() {
            let p = mesh.position(*corner);
            let flat = DVec2::new(p.dot(right), -p.dot(up));
            low = low.min(flat);
            high = high.max(flat);
        }
        let ratio = size / (high - low);
        let scale = FILLED * ratio.x.min(ratio.y);
        let shift = 0.5 * size - 0.5 * scale * (low + high);
        Self { right, up, toward, scale, shift }
    }

    /// The unit vector towards the viewer.
    pub(crate) fn toward(&self) -> DVec3 {
        self.toward
    }

    /// Pixels a unit of the mesh.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// x and y in pixels from the upper left corner, z in pixels towards the viewer.
    pub(crate) fn project(&self, p: DVec3) -> DVec3 {
        let flat = self.scale * DVec2::new(p.dot(self.right), -p.dot(self.up)) + self.shift;
        flat.extend(self.scale * p.dot(self.toward))
    }

    /// How bright a surface with this normal is, 0 to 1: Lambert's law, both sides alike, the light over the
    /// viewer's left shoulder, and some from everywhere.
    pub(crate) fn brightness(&self, normal: DVec3) -> f64 {
        let light = (self.toward + 0.55 * self.up - 0.45 * self.right).normalize();
        0.38 + 0.62 * normal.dot(light).abs()
    }
}
