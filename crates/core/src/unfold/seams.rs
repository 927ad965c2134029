//! Which sides of a strip's faces are the same edge, and which of these lie together.

use std::num::NonZero;
use std::ops::Range;

use super::FacePlace;
use super::lay::Planar;
use crate::ids::{HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::segment::Segment;
use crate::sets::Sets;

/// Two copies of a vertex nearer than this, relative to the strip's extent, are one: rounding moved them apart, not
/// the surface's curvature.
const COINCIDENT: f64 = 1e-11;

/// For each side of the strip's faces the same edge as its neighbour in the strip sees it. Side `c` of the strip's
/// `i`-th face is `3 i + c`.
pub(super) struct Twins(Vec<[Option<NonZero<u32>>; 3]>);

impl Twins {
    pub(super) fn new(mesh: &SurfaceMesh, strip: StripId, places: &[FacePlace], segment: &Segment) -> Self {
        let side = |face, corner| {
            let twin = mesh.topology().twin(HalfedgeId::of(face, corner))?;
            let place = places[twin.face().index()];
            // One more than its number, which needs no room to say that there is none.
            (place.strip == strip).then(|| NonZero::new(3 * place.index + twin.corner() as u32 + 1))?
        };
        let of_face = |i: usize| {
            let face = segment.attachments[i].face;
            [side(face, 0), side(face, 1), side(face, 2)]
        };
        Self(parallel::map(segment.attachments.len(), of_face))
    }

    /// `None` where the surface or the strip ends.
    #[inline]
    pub(super) fn of(&self, side: u32) -> Option<u32> {
        self.0[side as usize / 3][side as usize % 3].map(|number| number.get() - 1)
    }
}

/// Joins copies of a vertex on both sides of a cut that lie together exactly (up to rounding), so that no gap or
/// overlap of rounding's width can lose or double a point. Tells for each side whether it lies in the border.
pub(super) fn close(planar: &mut Planar, twins: &Twins) -> Vec<[bool; 3]> {
    let in_border = in_border(planar, twins);
    let extent = planar.vertices.iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()));
    let tolerance = COINCIDENT * extent;
    let near =
        |a: u32, b: u32| planar.vertices[a as usize].distance(planar.vertices[b as usize]) <= tolerance;
    // No cut of a curved surface has such copies, so most of the work is to see that there are none: in pieces.
    const PIECE: usize = 1 << 12;
    let copies = parallel::map_chunks(planar.faces.len(), PIECE, |faces: Range<usize>| {
        let mut copies = Vec::new();
        for side in 3 * faces.start as u32..3 * faces.end as u32 {
            if !in_border[side as usize / 3][side as usize % 3] {
                continue;
            }
            let Some(twin) = twins.of(side).filter(|twin| side < *twin) else { continue };
            let (from, to) = planar.ends(side);
            // The twin runs the other way.
            let (twin_to, twin_from) = planar.ends(twin);
            copies.extend(
                [(from, twin_from), (to, twin_to)].into_iter().filter(|&(a, b)| a != b && near(a, b)),
            );
        }
        copies
    });
    if copies.iter().all(Vec::is_empty) {
        return in_border;
    }
    let mut joined = Sets::new(planar.vertices.len());
    for (a, b) in copies.into_iter().flatten() {
        joined.join(a, b);
    }
    for v in planar.corners.iter_mut().flatten() {
        *v = joined.root(*v);
    }
    self::in_border(planar, twins)
}

/// For each side whether its twin does not lie together with it.
fn in_border(planar: &Planar, twins: &Twins) -> Vec<[bool; 3]> {
    parallel::map(planar.faces.len(), |i| {
        [0, 1, 2].map(|corner| {
            let side = 3 * i as u32 + corner;
            let (from, to) = planar.ends(side);
            twins.of(side).is_none_or(|twin| planar.ends(twin) != (to, from))
        })
    })
}
