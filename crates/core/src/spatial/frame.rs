//! A cube around the mesh in which single precision boxes are safe whatever the units of the input are.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// The side of the cube. The ray traversal of obvhs leaves out boxes that end before 1e-4: in a cube of this side that is 1e-7 of the mesh.
pub(super) const SIDE: f64 = 1024.0;

/// How much every box is widened. Rounding to single precision moves a place of the cube by 6e-5 at most, and the
/// slab test of a ray by a few times that.
const MARGIN: f64 = 1e-3;

/// Shift and isotropic scale that take the box around the mesh into the cube around the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    middle: DVec3,
    pub(super) scale: f64,
}

impl Frame {
    pub(super) fn around(mesh: &SurfaceMesh) -> Self {
        if mesh.face_count() == 0 {
            return Self { middle: DVec3::ZERO, scale: 1.0 };
        }
        let (low, high) = mesh.bounds();
        // A checked mesh has a face with area, so the extent is positive.
        let extent = (high * 0.5 - low * 0.5).max_element() * 2.0;
        Self { middle: low * 0.5 + high * 0.5, scale: SIDE / extent }
    }

    #[inline]
    pub(super) fn enter(&self, p: DVec3) -> DVec3 {
        (p - self.middle) * self.scale
    }

    /// The corners of a face in the cube.
    pub(super) fn triangle(&self, mesh: &SurfaceMesh, face: FaceId) -> [DVec3; 3] {
        mesh.triangle(face).map(|p| self.enter(p))
    }
}

/// A box that holds the triangle with room to spare for single precision.
fn loose_box(corners: [DVec3; 3]) -> Aabb {
    let [a, b, c] = corners;
    let low = a.min(b).min(c) - MARGIN;
    let high = a.max(b).max(c) + MARGIN;
    let single = |p: DVec3| Vec3A::new(p.x as f32, p.y as f32, p.z as f32);
    Aabb::new(single(low), single(high))
}

/// A tree of boxes over the faces of the mesh, one face a leaf. obvhs' own shortcuts read the clock, which does not
/// exist in wasm; these are the steps they take.
pub(super) fn tree(mesh: &SurfaceMesh, frame: &Frame) -> Bvh2 {
    let boxes = parallel::map(mesh.face_count(), |f| loose_box(frame.triangle(mesh, FaceId::new(f))));
    let order = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        &boxes,
        order,
        SortPrecision::U64,
        3,
    );
    ReinsertionOptimizer::default().run(&mut tree, 0.05, None);
    tree
}
