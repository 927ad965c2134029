//! The correction (paper, 4.2 step 5): thin interstices and thin overlaps.
//!
//! A place lies in a thin interstice or overlap when it is near both copies of a cut edge: the distances to them
//! add up to at most the tolerance. Not covered by the strip, it lies in an interstice and is projected onto the
//! nearer copy; covered more than once, it lies in an overlap and of its surface points beside that edge one is kept.

use glam::{DVec2, DVec3};

use crate::domain::{DomainPoints, PlanarDomain};
use crate::geometry::plane;
use crate::ids::{HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::{Origin, Sample, SurfacePoint};
use crate::unfold::{Strip, Strips, Twin};
use crate::wrap::{WrappedPoint, Wrapping};

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
/// Cost: linear in the cut edges and the points near them.
pub fn correct(
    mesh: &SurfaceMesh,
    strips: &Strips,
    domain: &PlanarDomain,
    points: &DomainPoints,
    wrapping: Wrapping,
    tolerance: f64,
) -> (Vec<Corrected>, Correction) {
    let mends = parallel::map(strips.strips.len(), |s| {
        let strip = &strips.strips[s];
        let seams =
            Seams { mesh, strip, offset: domain.offsets[s], points, caught: &wrapping.strips[s], tolerance };
        seams.mend()
    });
    let mut correction = Correction::default();
    let mut corrected = Vec::with_capacity(wrapping.count());
    for (s, (caught, mend)) in wrapping.strips.into_iter().zip(mends).enumerate() {
        let strip = StripId::new(s);
        correction.projected += mend.projected.len();
        correction.removed += mend.removed.len();
        let mut removed = mend.removed.iter().copied().peekable();
        let first = corrected.len();
        for (i, wrapped) in caught.iter().enumerate() {
            if removed.next_if_eq(&i).is_none() {
                let WrappedPoint { index, point, place } = *wrapped;
                let sample = Sample { point, strip, place, origin: Origin::Wrapped };
                corrected.push(Corrected { index, copies_removed: 0, sample });
            }
        }
        for removed in mend.removed {
            // Of copies that lie beside an edge one is kept, so there is one to remember it.
            let index = caught[removed].index;
            let kept = first + corrected[first..].partition_point(|c| c.index < index);
            if let Some(kept) = corrected.get_mut(kept).filter(|c| c.index == index) {
                kept.copies_removed += 1;
            }
        }
        for projection in mend.projected {
            let Projection { index, place, halfedge, along, .. } = projection;
            let mut barycentric = [0.0; 3];
            barycentric[halfedge.corner()] = 1.0 - along;
            barycentric[(halfedge.corner() + 1) % 3] = along;
            let point = SurfacePoint { face: halfedge.face(), barycentric };
            let sample = Sample { point, strip, place, origin: Origin::Projected };
            corrected.push(Corrected { index, copies_removed: 0, sample });
        }
    }
    corrected.sort_by_key(|c| (c.index, c.sample.strip, c.sample.point.face));
    (corrected, correction)
}

/// A point of an interstice and the edge onto which it is projected.
struct Projection {
    index: u64,
    distance: f64,
    halfedge: HalfedgeId,
    /// How far along the half-edge, 0 to 1.
    along: f64,
    place: DVec2,
}

struct Mend {
    projected: Vec<Projection>,
    /// Places in the strip's caught points, ascending.
    removed: Vec<usize>,
}

struct Seams<'a> {
    mesh: &'a SurfaceMesh,
    strip: &'a Strip,
    offset: DVec2,
    points: &'a DomainPoints,
    caught: &'a [WrappedPoint],
    tolerance: f64,
}

impl Seams<'_> {
    fn mend(&self) -> Mend {
        let mut mend = Mend { projected: Vec::new(), removed: Vec::new() };
        for edge in &self.strip.border {
            let Twin::SameStrip { from, to } = edge.twin else { continue };
            // Each cut edge lies in the border twice: once is enough.
            let Some(twin) = self.mesh.topology().twin(edge.halfedge).filter(|t| edge.halfedge < *t) else {
                continue;
            };
            if self.strip.gap(edge) > self.tolerance {
                continue;
            }
            let at = |v: u32| self.strip.vertices[v as usize] + self.offset;
            let near = [at(edge.from), at(edge.to)];
            let far = [at(from), at(to)];
            let low = near[0].min(near[1]).min(far[0]).min(far[1]) - self.tolerance;
            let high = near[0].max(near[1]).max(far[0]).max(far[1]) + self.tolerance;
            for slot in self.points.in_box(low, high).flatten() {
                let (place, index) = self.points.at(slot);
                let distance = plane::segment_distance(near[0], near[1], place);
                let twin_distance = plane::segment_distance(far[0], far[1], place);
                if distance + twin_distance > self.tolerance {
                    continue;
                }
                let first = self.caught.partition_point(|c| c.index < index);
                let copies = self.caught[first..].iter().take_while(|c| c.index == index).count();
                if copies == 0 {
                    let (distance, halfedge, along) = if distance <= twin_distance {
                        (distance, edge.halfedge, plane::nearest_on_segment(near[0], near[1], place))
                    } else {
                        (twin_distance, twin, 1.0 - plane::nearest_on_segment(far[0], far[1], place))
                    };
                    mend.projected.push(Projection { index, distance, halfedge, along, place });
                } else if copies > 1 {
                    self.remove_copies(first..first + copies, edge.halfedge, &mut mend.removed);
                }
            }
        }
        // A place near several edges is projected onto the nearest.
        mend.projected.sort_by(|a, b| {
            a.index.cmp(&b.index).then(a.distance.total_cmp(&b.distance)).then(a.halfedge.cmp(&b.halfedge))
        });
        mend.projected.dedup_by_key(|p| p.index);
        mend
    }

    /// Of the copies that lie beside the edge on the surface, keeps the first that was not removed before.
    fn remove_copies(&self, copies: std::ops::Range<usize>, halfedge: HalfedgeId, removed: &mut Vec<usize>) {
        let (a, b) = self.mesh.topology().ends(halfedge);
        let (a, b) = (self.mesh.position(a), self.mesh.position(b));
        let mut kept = false;
        for copy in copies {
            let position = self.mesh.locate(&self.caught[copy].point);
            if distance_to_edge(a, b, position) > self.tolerance {
                continue;
            }
            if let Err(slot) = removed.binary_search(&copy) {
                if kept {
                    removed.insert(slot, copy);
                }
                kept = true;
            }
        }
    }
}

fn distance_to_edge(a: DVec3, b: DVec3, p: DVec3) -> f64 {
    let ab = b - a;
    let squared = ab.length_squared();
    let t = if squared == 0.0 { 0.0 } else { ((p - a).dot(ab) / squared).clamp(0.0, 1.0) };
    p.distance(a + ab * t)
}
