//! Where the preview is seen from.

use glam::{DVec2, DVec3};
use ldwrap::SurfaceMesh;

/// Looks along parallel lines and fits the mesh into the picture. Files do not say which way is up: see [`Frame`].
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

/// How much larger the mesh's foot must be along z for z to be taken as up.
const CLEARLY: f64 = 1.5;

/// The mesh's own directions, guessed.
struct Frame {
    right: DVec3,
    up: DVec3,
    front: DVec3,
}

impl Frame {
    /// y is up and z in front, as most files have it; or z is up and -y in front, if the mesh stands on its lowest
    /// points much better that way.
    fn guess(mesh: &SurfaceMesh) -> Self {
        if foot(mesh, DVec3::Z) > CLEARLY * foot(mesh, DVec3::Y) {
            Self { right: DVec3::X, up: DVec3::Z, front: -DVec3::Y }
        } else {
            Self { right: DVec3::X, up: DVec3::Y, front: DVec3::Z }
        }
    }

    /// From the front, right and above, more from where the mesh is wider.
    fn three_quarter(&self, mesh: &SurfaceMesh) -> DVec3 {
        let (low, high) = mesh.bounds();
        let extent = |axis: DVec3| (high - low).dot(axis.abs());
        let (right, front) =
            if extent(self.front) > extent(self.right) { (0.76, 0.55) } else { (0.55, 0.76) };
        (right * self.right + 0.36 * self.up + front * self.front).normalize()
    }
}

/// The share of its box's base that a mesh stands on when `up` is up: the box around what lies in the lowest
/// three percent.
fn foot(mesh: &SurfaceMesh, up: DVec3) -> f64 {
    let (low, high) = mesh.bounds();
    let level = low.dot(up) + 0.03 * (high - low).dot(up);
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in mesh.topology().faces().iter().flatten() {
        let p = mesh.position(*corner);
        if p.dot(up) <= level {
            least = least.min(p);
            most = most.max(p);
        }
    }
    let sides = (most - least) / (high - low);
    [DVec3::X, DVec3::Y, DVec3::Z].iter().filter(|&&axis| axis != up).map(|&axis| sides.dot(axis)).product()
}

impl Camera {
    /// From the front, right and above (as guessed), with all of `mesh` in a picture of `size` pixels.
    pub(crate) fn three_quarter(mesh: &SurfaceMesh, size: DVec2) -> Self {
        let frame = Frame::guess(mesh);
        let toward = frame.three_quarter(mesh);
        let right = frame.up.cross(toward).normalize();
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
        0.45 + 0.55 * normal.dot(light).abs()
    }
}
