//! Where the triangles of segments lie in the plane, as far as growth needs to know: by face, in no common place.

use glam::DVec2;

use super::Segmentation;
use crate::geometry::triangle;
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::{Components, SurfaceMesh};

/// The planar corners of each face that is laid.
pub(super) struct Planar(Vec<[DVec2; 3]>);

impl Planar {
    pub(super) fn new(mesh: &SurfaceMesh) -> Self {
        Self(vec![[DVec2::ZERO; 3]; mesh.face_count()])
    }

    /// The planar corners of all faces of a segmentation.
    pub(super) fn of(mesh: &SurfaceMesh, segmentation: &Segmentation) -> Self {
        let mut planar = Self::new(mesh);
        for attachment in segmentation.segments.iter().flat_map(|s| &s.attachments) {
            let corners = match attachment.across {
                Some(across) => planar.beside(mesh, across),
                None => first(mesh, attachment.face),
            };
            planar.lay(attachment.face, corners);
        }
        planar
    }

    pub(super) fn lay(&mut self, face: FaceId, corners: [DVec2; 3]) {
        self.0[face.index()] = corners;
    }

    /// The corners of the face of `across` when it is attached across that side to the face behind it.
    pub(super) fn beside(&self, mesh: &SurfaceMesh, across: HalfedgeId) -> [DVec2; 3] {
        let Some(twin) = mesh.topology().twin(across) else { return first(mesh, across.face()) };
        let space = mesh.triangle(across.face());
        let own = across.corner();
        let (_, x, y) = triangle::flatten(space[own], space[(own + 1) % 3], space[(own + 2) % 3]);
        let parent = self.0[twin.face().index()];
        // The twin runs the other way.
        let (to, from) = (parent[twin.corner()], parent[(twin.corner() + 1) % 3]);
        let along = (to - from).try_normalize().unwrap_or(DVec2::X);
        let mut corners = [DVec2::ZERO; 3];
        corners[own] = from;
        corners[(own + 1) % 3] = to;
        corners[(own + 2) % 3] = from + along * x + along.perp() * y;
        corners
    }

    /// How far apart a side of a face, whose corners these are, and its twin on a face that is laid would lie.
    pub(super) fn gap(&self, corners: &[DVec2; 3], side: HalfedgeId, twin: HalfedgeId) -> f64 {
        let other = self.0[twin.face().index()];
        let start = corners[side.corner()].distance_squared(other[(twin.corner() + 1) % 3]);
        let end = corners[(side.corner() + 1) % 3].distance_squared(other[twin.corner()]);
        libm::sqrt(start.max(end))
    }

    /// For each component the length of its edges, each once, whose two sides lie in different segments or farther
    /// apart than `tolerance`. Linear time.
    pub(super) fn open_lengths(
        &self,
        mesh: &SurfaceMesh,
        segmentation: &Segmentation,
        components: &Components,
        tolerance: f64,
    ) -> Vec<f64> {
        let segment = segmentation.segment_of_face(mesh.face_count());
        let mut open = vec![0.0; components.count];
        for face in mesh.topology().face_ids() {
            for side in (0..3).map(|c| HalfedgeId::of(face, c)) {
                let Some(twin) = mesh.topology().twin(side).filter(|twin| side < *twin) else { continue };
                if segment[face.index()] != segment[twin.face().index()]
                    || self.gap(&self.0[face.index()], side, twin) > tolerance
                {
                    open[components.of_face[face.index()] as usize] += mesh.edge_length(side);
                }
            }
        }
        open
    }
}

/// The corners of the first face of a segment.
pub(super) fn first(mesh: &SurfaceMesh, face: FaceId) -> [DVec2; 3] {
    let [a, b, c] = mesh.triangle(face);
    let (length, x, y) = triangle::flatten(a, b, c);
    [DVec2::ZERO, DVec2::new(length, 0.0), DVec2::new(x, y)]
}
