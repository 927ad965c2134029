//! Where the triangles of segments lie in the plane, as far as growth needs to know: by face, in no common place.

use glam::DVec2;

use super::Segmentation;
use crate::geometry::triangle;
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::{Components, SurfaceMesh};
use crate::parallel;

/// A triangle seen from one of its sides, in single precision: enough to choose by, and little to look at.
#[derive(Clone, Copy)]
struct Side {
    length: f32,
    /// Where the opposite corner lies when the side goes from (0, 0) to (1, 0).
    apex: [f32; 2],
    /// The squared distance of the unit normals on both sides of it: 0 where flat, 4 where folded back.
    bend: f32,
}

/// The shapes of all triangles, seen from each of their sides.
pub(super) struct Shapes {
    sides: Vec<[Side; 3]>,
}

impl Shapes {
    pub(super) fn new(mesh: &SurfaceMesh) -> Self {
        let of_face = |face: usize| {
            let face = FaceId::new(face);
            let corners = mesh.triangle(face);
            [0, 1, 2].map(|corner| {
                let [a, b, c] = [0, 1, 2].map(|turn| corners[(corner + turn) % 3]);
                let (length, x, y) = triangle::flatten(a, b, c);
                let twin = mesh.topology().twin(HalfedgeId::of(face, corner));
                let bend = twin.map_or(0.0, |twin| {
                    mesh.face_normal(face).distance_squared(mesh.face_normal(twin.face()))
                });
                // Faces have an area, so no side is zero.
                let apex = [x / length, y / length].map(|x| x as f32);
                Side { length: length as f32, apex, bend: bend as f32 }
            })
        };
        Self { sides: parallel::map(mesh.face_count(), of_face) }
    }

    #[inline]
    fn side(&self, side: HalfedgeId) -> Side {
        self.sides[side.face().index()][side.corner()]
    }

    #[inline]
    pub(super) fn length(&self, side: HalfedgeId) -> f64 {
        self.side(side).length.into()
    }

    /// How much the surface bends at a side; 0 at the border.
    #[inline]
    pub(super) fn bend(&self, side: HalfedgeId) -> f64 {
        self.side(side).bend.into()
    }

    /// The corners of a face when its side `side` goes from `from` to `to`.
    #[inline]
    fn beside(&self, side: HalfedgeId, from: DVec2, to: DVec2) -> [DVec2; 3] {
        let [x, y] = self.side(side).apex.map(f64::from);
        let along = to - from;
        let apex = from + along * x + along.perp() * y;
        match side.corner() {
            0 => [from, to, apex],
            1 => [apex, from, to],
            _ => [to, apex, from],
        }
    }

    /// The corners of the first face of a segment.
    fn first(&self, face: FaceId) -> [DVec2; 3] {
        let side = HalfedgeId::of(face, 0);
        self.beside(side, DVec2::ZERO, DVec2::new(self.length(side), 0.0))
    }
}

/// The planar corners of each face that is laid.
pub(super) struct Planar<'a> {
    shapes: &'a Shapes,
    corners: Vec<[DVec2; 3]>,
}

impl<'a> Planar<'a> {
    pub(super) fn new(shapes: &'a Shapes) -> Self {
        Self { shapes, corners: vec![[DVec2::ZERO; 3]; shapes.sides.len()] }
    }

    /// The planar corners of all faces of a segmentation.
    pub(super) fn of(mesh: &SurfaceMesh, shapes: &'a Shapes, segmentation: &Segmentation) -> Self {
        let mut planar = Self::new(shapes);
        for attachment in segmentation.segments.iter().flat_map(|s| &s.attachments) {
            planar.lay(attachment.face, planar.beside(mesh, attachment.face, attachment.across));
        }
        planar
    }

    #[inline]
    pub(super) fn lay(&mut self, face: FaceId, corners: [DVec2; 3]) {
        self.corners[face.index()] = corners;
    }

    /// The corners of a face when it is attached across its side `across` to the face behind it.
    #[inline]
    pub(super) fn beside(&self, mesh: &SurfaceMesh, face: FaceId, across: Option<HalfedgeId>) -> [DVec2; 3] {
        match across.and_then(|across| Some((across, mesh.topology().twin(across)?))) {
            Some((across, twin)) => {
                // The twin runs the other way.
                let (to, from) = self.ends(twin);
                self.shapes.beside(across, from, to)
            }
            None => self.shapes.first(face),
        }
    }

    /// The ends of a side of a face that is laid.
    #[inline]
    fn ends(&self, side: HalfedgeId) -> (DVec2, DVec2) {
        let corners = &self.corners[side.face().index()];
        match side.corner() {
            0 => (corners[0], corners[1]),
            1 => (corners[1], corners[2]),
            _ => (corners[2], corners[0]),
        }
    }

    /// How far apart a side that goes from `from` to `to` and its twin, on a face that is laid, would lie.
    #[inline]
    pub(super) fn gap(&self, from: DVec2, to: DVec2, twin: HalfedgeId) -> f64 {
        let (twin_from, twin_to) = self.ends(twin);
        libm::sqrt(from.distance_squared(twin_to).max(to.distance_squared(twin_from)))
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
                let (from, to) = self.ends(side);
                if segment[face.index()] != segment[twin.face().index()]
                    || self.gap(from, to, twin) > tolerance
                {
                    open[components.of_face[face.index()] as usize] += self.shapes.length(side);
                }
            }
        }
        open
    }
}
