//! The correction (paper, 4.2 step 5): thin interstices and thin overlaps.
//!
//! A place lies in a thin interstice or overlap when it is near both copies of a cut edge: the distances to them
//! add up to at most the tolerance. Not covered by the strip, it lies in an interstice and is projected onto the
//! nearer copy; covered more than once, it lies in an overlap and of its surface points beside that edge one is kept.

mod order;
mod seams;

use std::borrow::Cow;
use std::convert::Infallible;
use std::ops::Range;

use glam::DVec2;

use crate::domain::{DomainPoints, PlanarDomain};
use crate::geometry::plane;
use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::lanes::{LANES, Lanes};
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
    /// Counts what was done to others too.
    pub(crate) fn add(&mut self, other: Self) {
        self.projected += other.projected;
        self.removed += other.removed;
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
    let caught = Caught::new(mesh, strips, domain, Cow::Borrowed(points), wrapping, tolerance);
    let picked = caught.pick(|_| true);
    let mended = caught.into_mended();
    let picks = Picks::new(&mended, picked);
    let mut corrected = Vec::with_capacity(picks.count());
    let mut correction = Correction::default();
    let blocks = picks.blocks(&mended, Keep::All, |block| {
        correction.add(mended.correction(block));
        parallel::extend(&mut corrected, block.len(), |i| mended.corrected(block[i]));
        Ok::<(), Infallible>(())
    });
    match blocks {
        Ok(()) => (corrected, correction),
        Err(never) => match never {},
    }
}

/// Samples are made here, when they are asked for, of what the correction left.
pub(crate) struct Mended<'a> {
    strips: &'a Strips,
    domain: &'a PlanarDomain,
    points: Cow<'a, DomainPoints>,
    mends: Mends,
}

/// What was caught, face by face, and what the correction does to it.
pub(crate) struct Caught<'a> {
    mended: Mended<'a>,
    wrapping: Wrapping,
}

/// The little that the correction changes, each list ordered by face.
#[derive(Default)]
struct Mends {
    /// Copies that were removed, by their slot.
    removed: Vec<(FaceId, u64)>,
    /// Copies that stay where others of them were removed, and how many.
    kept: Vec<(FaceId, u64, u32)>,
    projected: Vec<Projection>,
    /// For each 64 faces those to which any of these belongs, and how many such faces there are before.
    touched: Vec<(u64, u32)>,
    /// For each touched face where its part of each list starts, and where the lists end.
    starts: Vec<[u32; 3]>,
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

impl Mends {
    fn new(
        faces: usize,
        removed: Vec<(FaceId, u64)>,
        kept: Vec<(FaceId, u64, u32)>,
        projected: Vec<Projection>,
    ) -> Self {
        let mut touched = vec![(0, 0); faces.div_ceil(64)];
        let of_removed = removed.iter().map(|r| r.0);
        let of_kept = kept.iter().map(|k| k.0);
        let of_projected = projected.iter().map(Projection::face);
        for face in of_removed.chain(of_kept).chain(of_projected) {
            touched[face.index() / 64].0 |= 1 << (face.index() % 64);
        }
        let (mut starts, mut start) = (Vec::new(), [0; 3]);
        for (i, (faces, before)) in touched.iter_mut().enumerate() {
            *before = starts.len() as u32;
            for face in (64 * i..).zip(0..64).filter(|(_, bit)| *faces >> bit & 1 == 1).map(|(face, _)| face)
            {
                starts.push(start.map(|s| s as u32));
                let face = FaceId::new(face);
                start[0] += removed[start[0]..].iter().take_while(|r| r.0 == face).count();
                start[1] += kept[start[1]..].iter().take_while(|k| k.0 == face).count();
                start[2] += projected[start[2]..].iter().take_while(|p| p.face() == face).count();
            }
        }
        starts.push(start.map(|s| s as u32));
        Self { removed, kept, projected, touched, starts }
    }

    /// Which of the touched faces one is; the correction leaves most as they are.
    #[inline]
    fn touched(&self, face: FaceId) -> Option<usize> {
        let (faces, before) = self.touched[face.index() / 64];
        let bit = 1 << (face.index() % 64);
        (faces & bit != 0).then(|| (before + (faces & (bit - 1)).count_ones()) as usize)
    }

    /// Which part of a list belongs to a face.
    #[inline]
    fn of(&self, face: FaceId, list: usize) -> Range<usize> {
        self.touched(face).map_or(0..0, |touched| {
            let [start, end] = [touched, touched + 1].map(|at| self.starts[at][list] as usize);
            start..end
        })
    }

    #[inline]
    fn removed(&self, face: FaceId) -> &[(FaceId, u64)] {
        &self.removed[self.of(face, 0)]
    }

    #[inline]
    fn kept(&self, face: FaceId) -> &[(FaceId, u64, u32)] {
        &self.kept[self.of(face, 1)]
    }

    #[inline]
    fn projected(&self, face: FaceId) -> &[Projection] {
        &self.projected[self.of(face, 2)]
    }
}

impl Projection {
    fn face(&self) -> FaceId {
        self.halfedge.face()
    }
}

impl<'a> Caught<'a> {
    pub(crate) fn new(
        mesh: &SurfaceMesh,
        strips: &'a Strips,
        domain: &'a PlanarDomain,
        points: Cow<'a, DomainPoints>,
        wrapping: Wrapping,
        tolerance: f64,
    ) -> Self {
        let mends = seams::mend(mesh, strips, domain, &points, &wrapping, tolerance);
        Self { mended: Mended { strips, domain, points, mends }, wrapping }
    }

    /// How many samples there are.
    pub(crate) fn count(&self) -> usize {
        let Mends { removed, projected, .. } = &self.mended.mends;
        self.wrapping.count() + projected.len() - removed.len()
    }

    /// What is on a face.
    #[inline]
    pub(crate) fn on(&self, face: FaceId) -> OnFace<'_> {
        OnFace {
            face,
            slots: self.wrapping.slots(self.mended.strips.places[face.index()]),
            removed: self.mended.mends.removed(face),
            projected: self.mended.mends.projected(face),
        }
    }

    /// The samples that stay, in pieces of faces.
    pub(crate) fn pick(&self, stays: impl Fn(Pick) -> bool + Sync + Send) -> Vec<Vec<Pick>> {
        const SAMPLES: usize = 8192;
        let faces = self.mended.strips.places.len();
        let size = (SAMPLES * faces / self.count().max(1)).clamp(1, SAMPLES);
        parallel::map_chunks(faces, size, |range| {
            let mut picked = Vec::new();
            for face in range.map(FaceId::new) {
                picked.extend(self.on(face).picks().filter(|&pick| stays(pick)));
            }
            picked
        })
    }

    /// Where samples are made.
    pub(crate) fn mended(&self) -> &Mended<'a> {
        &self.mended
    }

    /// Without the lists of what was caught: samples that were picked need them no more.
    pub(crate) fn into_mended(self) -> Mended<'a> {
        self.mended
    }
}

/// The samples of one face.
pub(crate) struct OnFace<'a> {
    face: FaceId,
    slots: &'a [u64],
    removed: &'a [(FaceId, u64)],
    projected: &'a [Projection],
}

impl OnFace<'_> {
    /// All of them.
    pub(crate) fn picks(&self) -> impl Iterator<Item = Pick> + '_ {
        let projected = self.projected.iter().map(|p| p.slot);
        self.wrapped().chain(projected).map(|slot| Pick::new(self.face, slot))
    }

    /// The slots of those that were caught and stay.
    fn wrapped(&self) -> impl Iterator<Item = u64> + '_ {
        self.slots.iter().copied().filter(|slot| self.removed.iter().all(|r| r.1 != *slot))
    }

    /// Calls `visit` with all of them, some at a time, and their barycentric coordinates, of which those of other lanes
    /// mean nothing.
    #[inline]
    pub(crate) fn side_by_side(&self, mended: &Mended<'_>, mut visit: impl FnMut(&[u64], &[Lanes; 3])) {
        let alone = |slot| {
            let point = mended.sample(Pick::new(self.face, slot)).point;
            point.barycentric.map(|weight| [weight; LANES])
        };
        if self.removed.is_empty() && !self.slots.is_empty() {
            let triangle = plane::Triangle::new(mended.domain.triangle(mended.strips, self.face));
            for of_face in self.slots.chunks(LANES) {
                let mut slots = [of_face[0]; LANES];
                slots[..of_face.len()].copy_from_slice(of_face);
                visit(of_face, &triangle.barycentric(&mended.points.places(&slots)));
            }
        } else {
            self.wrapped().for_each(|slot| visit(&[slot], &alone(slot)));
        }
        for &Projection { slot, .. } in self.projected {
            visit(&[slot], &alone(slot));
        }
    }
}

impl Mended<'_> {
    /// Above the number of every point.
    pub(crate) fn end(&self) -> u64 {
        self.points.end()
    }

    /// Which point of the sequence a sample comes from.
    #[inline]
    pub(crate) fn index(&self, pick: Pick) -> u64 {
        self.points.index(pick.slot())
    }

    #[inline]
    fn strip(&self, face: FaceId) -> StripId {
        self.strips.places[face.index()].strip
    }

    /// A sample that was picked.
    #[inline]
    pub(crate) fn sample(&self, pick: Pick) -> Sample {
        let Pick { face, .. } = pick;
        let strip = self.strip(face);
        if let Some(projection) = self.projection(pick) {
            let Projection { place, halfedge, along, .. } = *projection;
            let mut barycentric = [0.0; 3];
            barycentric[halfedge.corner()] = 1.0 - along;
            barycentric[(halfedge.corner() + 1) % 3] = along;
            return Sample {
                point: SurfacePoint { face, barycentric },
                strip,
                place,
                origin: Origin::Projected,
            };
        }
        let place = self.points.at(pick.slot()).0;
        let [a, b, c] = self.domain.triangle(self.strips, face);
        let point = SurfacePoint { face, barycentric: plane::barycentric(a, b, c, place) };
        Sample { point, strip, place, origin: Origin::Wrapped }
    }

    #[inline]
    fn projection(&self, pick: Pick) -> Option<&Projection> {
        self.mends.projected(pick.face).iter().find(|p| p.slot == pick.slot())
    }

    /// How many other copies of a sample were removed.
    fn copies_removed(&self, pick: Pick) -> u32 {
        self.mends.kept(pick.face).iter().find(|k| k.1 == pick.slot()).map_or(0, |k| k.2)
    }

    pub(crate) fn corrected(&self, pick: Pick) -> Corrected {
        Corrected {
            index: self.index(pick),
            copies_removed: self.copies_removed(pick),
            sample: self.sample(pick),
        }
    }

    /// What the correction did to these.
    pub(crate) fn correction(&self, picks: &[Pick]) -> Correction {
        let mut correction = Correction::default();
        for &pick in picks.iter().filter(|pick| self.mends.touched(pick.face).is_some()) {
            correction.projected += usize::from(self.projection(pick).is_some());
            correction.removed += self.copies_removed(pick) as usize;
        }
        correction
    }
}
