//! The correction (paper, 4.2 step 5): thin interstices and thin overlaps.
//!
//! A place lies in a thin interstice or overlap when it is near both copies of a cut edge: the distances to them
//! add up to at most the tolerance. Not covered by the strip, it lies in an interstice and is projected onto the
//! nearer copy; covered more than once, it lies in an overlap and of its surface points beside that edge one is kept.

mod seams;

use glam::DVec2;

use crate::buckets::Buckets;
use crate::domain::{DomainPoints, PlanarDomain};
use crate::geometry::plane;
use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::{Origin, Sample, SurfacePoint};
use crate::unfold::Strips;
use crate::wrap::Wrapping;

/// What the correction did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Correction {
    /// Points in thin interstices that were projected onto the closest edge.
    pub projected: usize,
    /// Copies in thin overlaps that were removed.
    pub removed: usize,
}

/// A sample with the number of the domain point that it came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrected {
    /// Which point of the sequence it is.
    pub index: u64,
    /// How many other copies of it were removed from overlaps.
    pub copies_removed: u32,
    /// The sample.
    pub sample: Sample,
}

/// Mends thin interstices and overlaps, thinner than the length `tolerance`, and returns all samples ordered by the
/// number of their domain point, then by strip and face.
///
/// Cost: linear in the cut edges, the points near them, and the points caught.
pub fn correct(
    mesh: &SurfaceMesh,
    strips: &Strips,
    domain: &PlanarDomain,
    points: &DomainPoints,
    wrapping: Wrapping,
    tolerance: f64,
) -> (Vec<Corrected>, Correction) {
    Mended::new(mesh, strips, domain, points, wrapping, tolerance).in_order(mesh)
}

/// What was caught and what the correction does to it, face by face; samples are made when they are asked for.
pub(crate) struct Mended<'a> {
    strips: &'a Strips,
    domain: &'a PlanarDomain,
    points: &'a DomainPoints,
    wrapping: Wrapping,
    mends: Mends,
}

/// The little that the correction changes, each list ordered by face.
#[derive(Default)]
struct Mends {
    /// Copies that were removed, by their slot.
    removed: Vec<(FaceId, u64)>,
    /// Copies that stay where others of them were removed, and how many.
    kept: Vec<(FaceId, u64, u32)>,
    projected: Vec<Projection>,
}

/// A point of an interstice and the edge onto which it is projected.
#[derive(Clone, Copy)]
struct Projection {
    slot: u64,
    distance: f64,
    halfedge: HalfedgeId,
    /// How far along the half-edge, 0 to 1.
    along: f64,
    place: DVec2,
}

/// The slice of a list ordered by face that belongs to one.
fn of_face<T>(list: &[T], face: FaceId, of: impl Fn(&T) -> FaceId) -> &[T] {
    let start = list.partition_point(|item| of(item) < face);
    let end = start + list[start..].iter().take_while(|item| of(item) == face).count();
    &list[start..end]
}

impl<'a> Mended<'a> {
    pub(crate) fn new(
        mesh: &SurfaceMesh,
        strips: &'a Strips,
        domain: &'a PlanarDomain,
        points: &'a DomainPoints,
        wrapping: Wrapping,
        tolerance: f64,
    ) -> Self {
        let mends = seams::mend(mesh, strips, domain, points, &wrapping, tolerance);
        Self { strips, domain, points, wrapping, mends }
    }

    /// How many samples there are.
    pub(crate) fn count(&self) -> usize {
        self.wrapping.count() + self.mends.projected.len() - self.mends.removed.len()
    }

    /// What is on a face.
    pub(crate) fn on(&self, face: FaceId) -> OnFace<'_> {
        let place = self.strips.places[face.index()];
        OnFace {
            points: self.points,
            face,
            strip: place.strip,
            corners: self.domain.triangle(self.strips, face),
            slots: self.wrapping.slots(place),
            removed: of_face(&self.mends.removed, face, |r| r.0),
            kept: of_face(&self.mends.kept, face, |k| k.0),
            projected: of_face(&self.mends.projected, face, |p| p.halfedge.face()),
        }
    }

    /// All samples, ordered by the number of their domain point, then by strip and face.
    pub(crate) fn in_order(&self, mesh: &SurfaceMesh) -> (Vec<Corrected>, Correction) {
        const SAMPLES: usize = 8192;
        let faces = mesh.face_count();
        let size = (SAMPLES * faces / self.count().max(1)).clamp(1, SAMPLES);
        let piece = |piece: usize| {
            (piece * size..((piece + 1) * size).min(faces))
                .flat_map(|face| self.on(FaceId::new(face)).into_samples())
                .collect()
        };
        in_order(faces.div_ceil(size), piece, self.points.end(), |c| *c)
    }

    /// Above the number of every point.
    pub(crate) fn end(&self) -> u64 {
        self.points.end()
    }
}

/// Puts the samples that are made in pieces in order: by the number of their domain point, then by strip and face.
/// `end` is above all numbers. With what the correction did to them. Linear time, but for sorting within some thousands.
pub(crate) fn in_order<R: Send>(
    pieces: usize,
    make: impl Fn(usize) -> Vec<Corrected> + Sync + Send,
    end: u64,
    take: impl Fn(&Corrected) -> R + Sync + Send,
) -> (Vec<R>, Correction) {
    /// Buckets of this many numbers, which hold some thousands of samples, as long as there are not too many of them.
    const NUMBERS: u32 = 14;
    const MOST: u32 = 12;
    let shift = (u64::BITS - end.leading_zeros()).saturating_sub(MOST).max(NUMBERS);
    let buckets = Buckets::new(pieces, make, ((end >> shift) + 1) as usize, |c| (c.index >> shift) as usize);
    let order = buckets.by_key(|c| (c.index, c.sample.strip, c.sample.point.face));
    let counted = parallel::map_chunks(order.len(), 1 << 16, |range| {
        order[range].iter().fold(Correction::default(), |sum, c| Correction {
            projected: sum.projected + usize::from(c.sample.origin == Origin::Projected),
            removed: sum.removed + c.copies_removed as usize,
        })
    });
    let correction = counted.iter().fold(Correction::default(), |sum, c| Correction {
        projected: sum.projected + c.projected,
        removed: sum.removed + c.removed,
    });
    (parallel::map(order.len(), |i| take(order[i])), correction)
}

/// The samples of one face.
pub(crate) struct OnFace<'a> {
    points: &'a DomainPoints,
    face: FaceId,
    strip: StripId,
    /// In the domain.
    corners: [DVec2; 3],
    slots: &'a [u64],
    removed: &'a [(FaceId, u64)],
    kept: &'a [(FaceId, u64, u32)],
    projected: &'a [Projection],
}

impl<'a> OnFace<'a> {
    /// How many places for samples there are; a few may be empty.
    pub(crate) fn len(&self) -> usize {
        self.slots.len() + self.projected.len()
    }

    /// The sample at a place; `None` where one was removed.
    #[inline]
    pub(crate) fn sample(&self, at: usize) -> Option<Corrected> {
        let Some(&slot) = self.slots.get(at) else {
            return self.projected.get(at - self.slots.len()).map(|p| self.projection(p));
        };
        if self.removed.iter().any(|r| r.1 == slot) {
            return None;
        }
        let (place, index) = self.points.at(slot);
        let [a, b, c] = self.corners;
        let point = SurfacePoint { face: self.face, barycentric: plane::barycentric(a, b, c, place) };
        let sample = Sample { point, strip: self.strip, place, origin: Origin::Wrapped };
        let copies_removed = self.kept.iter().find(|k| k.1 == slot).map_or(0, |k| k.2);
        Some(Corrected { index, copies_removed, sample })
    }

    fn projection(&self, projection: &Projection) -> Corrected {
        let Projection { slot, place, halfedge, along, .. } = *projection;
        let mut barycentric = [0.0; 3];
        barycentric[halfedge.corner()] = 1.0 - along;
        barycentric[(halfedge.corner() + 1) % 3] = along;
        let point = SurfacePoint { face: self.face, barycentric };
        let sample = Sample { point, strip: self.strip, place, origin: Origin::Projected };
        Corrected { index: self.points.at(slot).1, copies_removed: 0, sample }
    }

    fn into_samples(self) -> impl Iterator<Item = Corrected> + 'a {
        (0..self.len()).filter_map(move |at| self.sample(at))
    }
}
