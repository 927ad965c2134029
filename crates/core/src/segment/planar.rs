//! Where the triangles of segments lie in the plane, as far as growth needs to know: by face, in no common place.

use std::num::NonZero;

use glam::{DVec2, DVec3};
use prefetch_index::prefetch_index;

use super::Segmentation;
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::{Components, SurfaceMesh};
use crate::parallel;

/// A side of a triangle and what lies behind it, in single precision: enough to choose by, and little to look at.
#[derive(Clone, Copy)]
pub(super) struct Side {
    /// In units of [`Shapes::unit`], so that what is rounded here does not hang on the unit of the mesh.
    length: f32,
    /// The squared distance of the unit normals on both sides of it: 0 where flat, 4 where folded back.
    bend: f32,
    /// Where the opposite corner of the triangle behind it lies when the side, as that triangle sees it, goes from (0, 0)
    /// to (1, 0).
    apex: [f32; 2],
    /// One more than the number of the side as the triangle behind it sees it.
    twin: Option<NonZero<u32>>,
}

impl Side {
    /// A side and where it starts and ends.
    fn of(mesh: &SurfaceMesh, unit: f64, side: HalfedgeId, from: DVec3, to: DVec3) -> Self {
        let topology = mesh.topology();
        let square = from.distance_squared(to);
        let length = (square.sqrt() / unit) as f32;
        let Some(twin) = topology.twin(side) else {
            return Self { length, bend: 0.0, apex: [0.0; 2], twin: None };
        };
        let behind = twin.face();
        let bend = mesh.face_normal(side.face()).distance_squared(mesh.face_normal(behind)) as f32;
        let opposite = mesh.position(topology.corners(behind)[twin.previous().corner()]);
        let apex = apex(to, from, opposite, mesh.face_area(behind));
        Self { length, bend, apex, twin: NonZero::new(twin.0 + 1) }
    }

    #[inline]
    pub(super) fn length(&self) -> f64 {
        self.length.into()
    }

    /// How much the surface bends here; 0 at the border.
    #[inline]
    pub(super) fn bend(&self) -> f64 {
        self.bend.into()
    }

    /// The same edge as the triangle behind it sees it.
    #[inline]
    pub(super) fn twin(&self) -> Option<HalfedgeId> {
        self.twin.map(|number| HalfedgeId(number.get() - 1))
    }

    /// The corners of the triangle behind it when this side goes from `from` to `to`.
    #[inline]
    pub(super) fn behind(&self, twin: HalfedgeId, (from, to): (DVec2, DVec2)) -> [DVec2; 3] {
        // The twin runs the other way.
        laid(twin.corner(), (to, from), self.apex)
    }
}

/// Where the corner `c` of a triangle lies when the side `a b` goes from (0, 0) to (1, 0).
fn apex(a: DVec3, b: DVec3, c: DVec3, area: f64) -> [f32; 2] {
    // Faces have an area, so no side is zero.
    let square = a.distance_squared(b);
    [(b - a).dot(c - a) / square, 2.0 * area / square].map(|x| x as f32)
}

/// The corners of a triangle when its side at `corner` goes from `from` to `to`.
#[inline]
fn laid(corner: usize, (from, to): (DVec2, DVec2), apex: [f32; 2]) -> [DVec2; 3] {
    let [x, y] = apex.map(f64::from);
    let along = to - from;
    let apex = from + along * x + along.perp() * y;
    match corner {
        0 => [from, to, apex],
        1 => [apex, from, to],
        _ => [to, apex, from],
    }
}

/// The ends of the side at `corner`.
#[inline]
pub(super) fn ends(corners: &[DVec2; 3], corner: usize) -> (DVec2, DVec2) {
    match corner {
        0 => (corners[0], corners[1]),
        1 => (corners[1], corners[2]),
        _ => (corners[2], corners[0]),
    }
}

/// All that growing from a triangle asks of it and of those beside it, in one line of the cache.
#[repr(align(64))]
pub(super) struct Shape(pub(super) [Side; 3]);

/// The shapes of all triangles.
pub(super) struct Shapes {
    of_face: Vec<Shape>,
    /// The root of the surface's area: lengths, in the plane too, are multiples of it.
    unit: f64,
}

impl Shapes {
    pub(super) fn new(mesh: &SurfaceMesh) -> Self {
        let unit = libm::sqrt(mesh.area());
        let of_face = |face: usize| {
            let face = FaceId::new(face);
            let [a, b, c] = mesh.triangle(face);
            let side = |corner, from, to| Side::of(mesh, unit, HalfedgeId::of(face, corner), from, to);
            Shape([side(0, a, b), side(1, b, c), side(2, c, a)])
        };
        Self { of_face: parallel::map(mesh.face_count(), of_face), unit }
    }

    /// A length in the units of the mesh as a multiple of the unit here.
    pub(super) fn relative(&self, length: f64) -> f64 {
        length / self.unit
    }

    pub(super) fn face_count(&self) -> usize {
        self.of_face.len()
    }

    #[inline]
    pub(super) fn of(&self, face: FaceId) -> &Shape {
        &self.of_face[face.index()]
    }

    /// Asks for what is known of a face, so that it is under way while other work is done.
    #[inline]
    pub(super) fn fetch(&self, face: FaceId) {
        prefetch_index(&self.of_face, face.index());
    }

    #[inline]
    pub(super) fn side(&self, side: HalfedgeId) -> &Side {
        &self.of(side.face()).0[side.corner()]
    }

    /// The corners of the first face of a segment.
    pub(super) fn first(&self, mesh: &SurfaceMesh, face: FaceId) -> [DVec2; 3] {
        let [a, b, c] = mesh.triangle(face);
        let to = DVec2::new(self.of(face).0[0].length(), 0.0);
        laid(0, (DVec2::ZERO, to), apex(a, b, c, mesh.face_area(face)))
    }
}

/// Where each face lies that is laid.
pub(super) struct Planar {
    corners: Vec<[DVec2; 3]>,
}

impl Planar {
    pub(super) fn new(face_count: usize) -> Self {
        Self { corners: vec![[DVec2::ZERO; 3]; face_count] }
    }

    /// The planar corners of all faces of a segmentation.
    pub(super) fn of(mesh: &SurfaceMesh, shapes: &Shapes, segmentation: &Segmentation) -> Self {
        let mut planar = Self::new(shapes.face_count());
        for attachment in segmentation.segments.iter().flat_map(|s| &s.attachments) {
            let laid = match attachment.across.and_then(|across| planar.beside(shapes, across)) {
                Some(laid) => laid,
                None => shapes.first(mesh, attachment.face),
            };
            planar.lay(attachment.face, laid);
        }
        planar
    }

    #[inline]
    pub(super) fn lay(&mut self, face: FaceId, corners: [DVec2; 3]) {
        self.corners[face.index()] = corners;
    }

    /// Asks for where a face lies, so that it is under way while other work is done.
    #[inline]
    pub(super) fn fetch(&self, face: FaceId) {
        // The next one starts in the line of the cache in which this one ends, or behind it.
        prefetch_index(&self.corners, face.index());
        prefetch_index(&self.corners, face.index() + 1);
    }

    #[inline]
    pub(super) fn corners(&self, face: FaceId) -> &[DVec2; 3] {
        &self.corners[face.index()]
    }

    /// The corners of a face when it is attached across its side `across` to the face behind it.
    #[inline]
    pub(super) fn beside(&self, shapes: &Shapes, across: HalfedgeId) -> Option<[DVec2; 3]> {
        let twin = shapes.side(across).twin()?;
        Some(shapes.side(twin).behind(across, self.ends(twin)))
    }

    /// The ends of a side of a face that is laid.
    #[inline]
    fn ends(&self, side: HalfedgeId) -> (DVec2, DVec2) {
        ends(self.corners(side.face()), side.corner())
    }

    /// How far apart a side that goes from `from` to `to` and its twin, on a face that is laid, would lie.
    #[inline]
    pub(super) fn gap(&self, (from, to): (DVec2, DVec2), twin: HalfedgeId) -> f64 {
        let (twin_from, twin_to) = self.ends(twin);
        libm::sqrt(from.distance_squared(twin_to).max(to.distance_squared(twin_from)))
    }

    /// For each component the length of its edges, each once, whose two sides lie in different segments or farther
    /// apart than `tolerance`, all in units of the shapes. Linear time.
    pub(super) fn open_lengths(
        &self,
        shapes: &Shapes,
        segmentation: &Segmentation,
        components: &Components,
        tolerance: f64,
    ) -> Vec<f64> {
        let segment = segmentation.segment_of_face(shapes.face_count());
        let mut open = vec![0.0; components.count];
        for face in (0..shapes.face_count()).map(FaceId::new) {
            for side in (0..3).map(|c| HalfedgeId::of(face, c)) {
                let Some(twin) = shapes.side(side).twin().filter(|twin| side < *twin) else { continue };
                if segment[face.index()] != segment[twin.face().index()]
                    || self.gap(self.ends(side), twin) > tolerance
                {
                    open[components.of_face[face.index()] as usize] += shapes.side(side).length();
                }
            }
        }
        open
    }
}
