//! The correction (paper, 4.2 step 5): thin interstices and thin overlaps.
//!
//! A place lies in a thin interstice or overlap when it is near both copies of a cut edge: the distances to them
//! add up to at most the tolerance. Not covered by the strip, it lies in an interstice and is projected onto the
//! nearer copy; covered more than once, it lies in an overlap and of its surface points beside that edge one is kept.

mod order;
mod seams;

use std::borrow::Cow;
use std::convert::Infallible;

use glam::DVec2;

use crate::domain::{DomainPoints, PlanarDomain};
use crate::geometry::plane;
use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::{Origin, Sample, SurfacePoint};
use crate::unfold::Strips;
use crate::wrap::Wrapping;

pub(crate) use order::{Keep, Pick, Picks};

/// What the correction did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Correction {
    /// Points in thin interstices that were projected onto the closest edge.
    pub projected: usize,
    /// Copies in thin overlaps that were removed.
    pub removed: usize,
}

impl Correction {
    /// Counts what was done to these too.
    pub(crate) fn add(&mut self, corrected: &[&Corrected]) {
        let counted = parallel::map_chunks(corrected.len(), 1 << 16, |range| {
            corrected[range].iter().fold((0, 0), |(projected, removed), c| {
                let is_projected = usize::from(c.sample.origin == Origin::Projected);
                (projected + is_projected, removed + c.copies_removed as usize)
            })
        });
        for (projected, removed) in counted {
            self.projected += projected;
            self.removed += removed;
        }
    }
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
    let mended = Mended::new(mesh, strips, domain, Cow::Borrowed(points), wrapping, tolerance);
    let picks = Picks::new(&mended, mended.pick(|on, nth| !on.is_removed(nth)));
    let mut corrected = Vec::with_capacity(picks.count());
    let mut correction = Correction::default();
    let blocks = picks.blocks(&mended, Keep::All, |block| {
        correction.add(block);
        corrected.extend(block.iter().map(|c| **c));
        Ok::<(), Infallible>(())
    });
    match blocks {
        Ok(()) => (corrected, correction),
        Err(never) => match never {},
    }
}

/// What was caught and what the correction does to it, face by face; samples are made when they are asked for.
pub(crate) struct Mended<'a> {
    strips: &'a Strips,
    domain: &'a PlanarDomain,
    points: Cow<'a, DomainPoints>,
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
        points: Cow<'a, DomainPoints>,
        wrapping: Wrapping,
        tolerance: f64,
    ) -> Self {
        let mends = seams::mend(mesh, strips, domain, &points, &wrapping, tolerance);
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
            points: &self.points,
            face,
            strip: place.strip,
            corners: self.domain.triangle(self.strips, face),
            slots: self.wrapping.slots(place),
            removed: of_face(&self.mends.removed, face, |r| r.0),
            kept: of_face(&self.mends.kept, face, |k| k.0),
            projected: of_face(&self.mends.projected, face, |p| p.halfedge.face()),
        }
    }

    /// Which samples stay, in pieces of faces; `stays` hears what is on a face and which of it.
    pub(crate) fn pick(&self, stays: impl Fn(&OnFace<'_>, usize) -> bool + Sync + Send) -> Vec<Vec<Pick>> {
        const SAMPLES: usize = 8192;
        let faces = self.strips.places.len();
        let size = (SAMPLES * faces / self.count().max(1)).clamp(1, SAMPLES);
        parallel::map_chunks(faces, size, |range| {
            let mut picked = Vec::new();
            for face in range.map(FaceId::new) {
                let on = self.on(face);
                let staying = (0..on.len()).filter(|&nth| stays(&on, nth));
                picked.extend(staying.map(|nth| Pick { face, nth: nth as u32 }));
            }
            picked
        })
    }

    /// Above the number of every point.
    pub(crate) fn end(&self) -> u64 {
        self.points.end()
    }
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

    /// Whether the sample at a place was removed.
    #[inline]
    pub(crate) fn is_removed(&self, at: usize) -> bool {
        let slot = self.slots.get(at);
        slot.is_some_and(|&slot| self.removed.iter().any(|r| r.1 == slot))
    }

    /// Which point of the sequence is at a place; `None` beyond the last.
    #[inline]
    fn index(&self, at: usize) -> Option<u64> {
        let slot = match self.slots.get(at) {
            Some(&slot) => slot,
            None => self.projected.get(at - self.slots.len())?.slot,
        };
        Some(self.points.at(slot).1)
    }

    /// The sample at a place; `None` where one was removed.
    #[inline]
    pub(crate) fn sample(&self, at: usize) -> Option<Corrected> {
        let Some(&slot) = self.slots.get(at) else {
            return self.projected.get(at - self.slots.len()).map(|p| self.projection(p));
        };
        if self.is_removed(at) {
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
}
