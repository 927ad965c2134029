//! Which points lie near both copies of a cut edge, and what becomes of them.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use super::{Mends, Projection};
use crate::domain::{DomainPoints, PlanarDomain};
use crate::geometry::plane;
use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::SurfacePoint;
use crate::unfold::{BorderEdge, Strips, Twin};
use crate::wrap::Wrapping;

/// A point near both copies of a cut edge.
#[derive(Clone, Copy)]
struct Near {
    strip: StripId,
    slot: u64,
    /// The edge as the strip's border has it first.
    halfedge: HalfedgeId,
    /// Onto the nearer copy.
    projection: Projection,
}

/// A point near a cut edge and a face that caught it.
type Copy = (StripId, u64, FaceId);

/// Edges, or points, in a piece of work.
const CHUNK: usize = 1 << 10;

/// Finds what the correction changes.
pub(super) fn mend(
    mesh: &SurfaceMesh,
    strips: &Strips,
    domain: &PlanarDomain,
    points: &DomainPoints,
    wrapping: &Wrapping,
    tolerance: f64,
) -> Mends {
    let seams = Seams { mesh, strips, domain, points, tolerance };
    let near = seams.near();
    let copies = copies(&near, strips, wrapping);
    let of = |strip: StripId, slot: u64| {
        let start = copies.partition_point(|c| (c.0, c.1) < (strip, slot));
        let count = copies[start..].iter().take_while(|c| (c.0, c.1) == (strip, slot)).count();
        &copies[start..start + count]
    };
    // Most were caught once, and nothing is done about them.
    let to_mend = parallel::map_chunks(near.len(), CHUNK, |range| {
        let mends = near[range].iter().map(|near| (near, of(near.strip, near.slot)));
        mends.filter(|(_, copies)| copies.len() != 1).collect::<Vec<_>>()
    });
    let mut projected = Vec::new();
    let mut removed = BTreeSet::new();
    for (near, copies) in to_mend.concat() {
        if copies.is_empty() {
            projected.push((near.strip, near.projection));
        } else {
            seams.remove_copies(copies, near, &mut removed);
        }
    }
    // A place near several edges is projected onto the nearest.
    projected.sort_by(|(s, a), (t, b)| {
        (s, a.slot)
            .cmp(&(t, b.slot))
            .then(a.distance.total_cmp(&b.distance))
            .then(a.halfedge.cmp(&b.halfedge))
    });
    projected.dedup_by_key(|(strip, p)| (*strip, p.slot));
    let mut projected: Vec<Projection> = projected.into_iter().map(|(_, p)| p).collect();
    projected.sort_by_key(|p| (p.halfedge.face(), p.slot));
    // Of copies that lie beside an edge one is kept, so there is one to remember the others.
    let mut kept: Vec<(FaceId, u64, u32)> = removed
        .iter()
        .filter_map(|&(face, slot)| {
            let copies = of(strips.places[face.index()].strip, slot);
            let keeper = copies.iter().find(|c| !removed.contains(&(c.2, slot)))?;
            Some((keeper.2, slot, 1))
        })
        .collect();
    kept.sort_unstable();
    kept.dedup_by(|next, kept| {
        let same = (next.0, next.1) == (kept.0, kept.1);
        kept.2 += if same { next.2 } else { 0 };
        same
    });
    Mends::new(mesh.face_count(), removed.into_iter().collect(), kept, projected)
}

/// Of the points near cut edges those that were caught, with all faces that caught them, in order.
fn copies(near: &[Near], strips: &Strips, wrapping: &Wrapping) -> Vec<Copy> {
    let mut wanted: Vec<(StripId, u64)> = near.iter().map(|n| (n.strip, n.slot)).collect();
    parallel::sort(&mut wanted);
    wanted.dedup();
    // Most that was caught is not near a cut: a sieve lets one in a hundred of the others pass.
    let sieve = Sieve::new(wanted.iter().map(|w| w.1), wanted.len());
    let mut copies = wrapping
        .map_pieces(|piece| {
            let mut copies: Vec<Copy> = Vec::new();
            piece.for_each_face(|place, slots| {
                for &slot in slots {
                    if sieve.passes(slot) && wanted.binary_search(&(place.strip, slot)).is_ok() {
                        let face = strips.strips[place.strip.index()].faces[place.index as usize];
                        copies.push((place.strip, slot, face));
                    }
                }
            });
            copies
        })
        .concat();
    parallel::sort(&mut copies);
    copies
}

/// Bloom's filter (DOI 10.1145/362686.362692): three bits of one word for each number, 16 bits a number.
struct Sieve(Vec<u64>);

impl Sieve {
    fn new(numbers: impl Iterator<Item = u64>, count: usize) -> Self {
        let mut sieve = Self(vec![0; (count / 4).max(1).next_power_of_two()]);
        for number in numbers {
            let (word, bits) = sieve.bits(number);
            sieve.0[word] |= bits;
        }
        sieve
    }

    /// The word of a number and its bits there.
    #[inline]
    fn bits(&self, number: u64) -> (usize, u64) {
        let hash = number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let bit = |shift: u32| 1_u64 << (hash >> shift & 63);
        // The upper bits are mixed best.
        ((hash >> 32) as usize & (self.0.len() - 1), bit(58) | bit(52) | bit(46))
    }

    #[inline]
    fn passes(&self, number: u64) -> bool {
        let (word, bits) = self.bits(number);
        self.0[word] & bits == bits
    }
}

struct Seams<'a> {
    mesh: &'a SurfaceMesh,
    strips: &'a Strips,
    domain: &'a PlanarDomain,
    points: &'a DomainPoints,
    tolerance: f64,
}

impl Seams<'_> {
    /// The points near both copies of cut edges, edge after edge.
    fn near(&self) -> Vec<Near> {
        let edges: Vec<(StripId, &BorderEdge)> = (0..)
            .zip(&self.strips.strips)
            .flat_map(|(s, strip)| strip.border.iter().map(move |edge| (StripId(s), edge)))
            // Each cut edge lies in the border twice: once is enough.
            .filter(|(_, edge)| self.mesh.topology().twin(edge.halfedge).is_some_and(|t| edge.halfedge < t))
            .collect();
        parallel::map_chunks(edges.len(), CHUNK, |range| {
            let mut near = Vec::new();
            for &(strip, edge) in &edges[range] {
                self.near_edge(strip, edge, &mut near);
            }
            near
        })
        .concat()
    }

    fn near_edge(&self, strip: StripId, edge: &BorderEdge, found: &mut Vec<Near>) {
        let of_strip = &self.strips.strips[strip.index()];
        let Twin::SameStrip { from, to } = edge.twin else { return };
        let Some(twin) = self.mesh.topology().twin(edge.halfedge) else { return };
        if of_strip.gap(edge) > self.tolerance {
            return;
        }
        let at = |v: u32| of_strip.vertices[v as usize] + self.domain.offsets[strip.index()];
        let near = [at(edge.from), at(edge.to)];
        let far = [at(from), at(to)];
        self.points.along(near, self.tolerance, |slot, place| {
            let distance = plane::segment_distance(near[0], near[1], place);
            let twin_distance = plane::segment_distance(far[0], far[1], place);
            if distance + twin_distance > self.tolerance {
                return;
            }
            let projection = if distance <= twin_distance {
                let along = plane::nearest_on_segment(near[0], near[1], place);
                Projection { slot, distance, halfedge: edge.halfedge, along, place }
            } else {
                let along = 1.0 - plane::nearest_on_segment(far[0], far[1], place);
                Projection { slot, distance: twin_distance, halfedge: twin, along, place }
            };
            found.push(Near { strip, slot, halfedge: edge.halfedge, projection });
        });
    }

    /// Of the copies that lie beside the edge on the surface, keeps the first that was not removed before.
    fn remove_copies(&self, copies: &[Copy], near: &Near, removed: &mut BTreeSet<(FaceId, u64)>) {
        let (a, b) = self.mesh.topology().ends(near.halfedge);
        let (a, b) = (self.mesh.position(a), self.mesh.position(b));
        let mut kept = false;
        for &(_, slot, face) in copies {
            if distance_to_edge(a, b, self.position(face, near.projection.place)) > self.tolerance {
                continue;
            }
            if !removed.contains(&(face, slot)) {
                if kept {
                    removed.insert((face, slot));
                }
                kept = true;
            }
        }
    }

    /// Where a face puts a place of the domain.
    fn position(&self, face: FaceId, place: DVec2) -> DVec3 {
        let [a, b, c] = self.domain.triangle(self.strips, face);
        self.mesh.locate(&SurfacePoint { face, barycentric: plane::barycentric(a, b, c, place) })
    }
}

fn distance_to_edge(a: DVec3, b: DVec3, p: DVec3) -> f64 {
    let ab = b - a;
    let squared = ab.length_squared();
    let t = if squared == 0.0 { 0.0 } else { ((p - a).dot(ab) / squared).clamp(0.0, 1.0) };
    p.distance(a + ab * t)
}
