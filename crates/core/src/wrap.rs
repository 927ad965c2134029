//! Wrapping (paper, 4.2 steps 2 and 4): points of the planar domain mapped back to the surface.

use std::ops::Range;

use glam::DVec2;

use crate::domain::{DomainPoints, PlanarDomain};
use crate::geometry::plane;
use crate::ids::{FaceId, StripId};
use crate::parallel;
use crate::sample::SurfacePoint;
use crate::unfold::{FacePlace, Strip, Strips};

/// A point of the domain caught by a face of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrappedPoint {
    /// Which point of the sequence it is.
    pub index: u64,
    /// Where it is on the surface.
    pub point: SurfacePoint,
    /// Where it lies in the planar domain.
    pub place: DVec2,
}

/// What each face of each strip caught, as slots of the domain's points: eight bytes a point.
#[derive(Clone, Debug)]
pub struct Wrapping {
    /// Where the faces of each strip start among those of all strips in order.
    firsts: Vec<usize>,
    /// How many faces a piece has.
    faces: usize,
    pieces: Vec<Piece>,
}

/// What some faces caught.
#[derive(Clone, Debug)]
struct Piece {
    /// For each face where its slots end.
    ends: Vec<u32>,
    slots: Vec<u64>,
}

/// Maps the points inside each planar triangle back to the surface. A point in a region covered once gives exactly
/// one surface point, also when it falls on an edge or a corner.
///
/// Cost: O(F + points near the strips).
pub fn wrap(strips: &Strips, domain: &PlanarDomain, points: &DomainPoints) -> Wrapping {
    let firsts: Vec<usize> = strips
        .strips
        .iter()
        .scan(0, |first, strip| {
            *first += strip.faces.len();
            Some(*first - strip.faces.len())
        })
        .collect();
    let count: usize = strips.strips.iter().map(|s| s.faces.len()).sum();
    let faces = faces_of_piece(count, points.count());
    let pieces = parallel::map_chunks(count, faces, |range| {
        let mut piece = Piece { ends: Vec::with_capacity(range.len()), slots: Vec::new() };
        let mut s = firsts.partition_point(|&first| first <= range.start) - 1;
        for face in range {
            while s + 1 < firsts.len() && firsts[s + 1] <= face {
                s += 1;
            }
            let corners = laid(&strips.strips[s], face - firsts[s], domain.offsets[s]);
            let triangle = Triangle(corners);
            points.in_triangle(corners, |slot, place| {
                if triangle.holds(place) {
                    piece.slots.push(slot);
                }
            });
            piece.ends.push(piece.slots.len() as u32);
        }
        piece
    });
    Wrapping { firsts, faces, pieces }
}

/// So many that a piece has some thousands of points, and is worth a visit of a core.
fn faces_of_piece(faces: usize, points: u64) -> usize {
    const POINTS: f64 = 16_384.0;
    const MOST: f64 = 4096.0;
    (POINTS * faces as f64 / points.max(1) as f64).clamp(1.0, MOST) as usize
}

/// The corners of a strip's face in the domain.
fn laid(strip: &Strip, index: usize, offset: DVec2) -> [DVec2; 3] {
    strip.triangle(index).map(|v| v + offset)
}

/// A triangle that is asked about many points.
struct Triangle([DVec2; 3]);

impl Triangle {
    /// As [`plane::triangle_holds`], to the bit; where rounding cannot change the sign without the exact test.
    #[inline]
    fn holds(&self, p: DVec2) -> bool {
        let [a, b, c] = self.0.map(|v| v - p);
        let least = a.perp_dot(b).min(b.perp_dot(c)).min(c.perp_dot(a));
        let far = a.abs().max(b.abs()).max(c.abs()).max_element();
        // Shewchuk's bound, (3 + 16 e) e times the sum of the two products, is less than this.
        let error = 8e-16 * far * far;
        least > error || (least >= -error && plane::triangle_holds(self.0[0], self.0[1], self.0[2], p))
    }
}

impl Wrapping {
    /// How many points were caught.
    pub fn count(&self) -> usize {
        self.pieces.iter().map(|p| p.slots.len()).sum()
    }

    /// The slots of what a face caught.
    #[inline]
    pub(crate) fn slots(&self, place: FacePlace) -> &[u64] {
        let face = self.firsts[place.strip.index()] + place.index as usize;
        let piece = &self.pieces[face / self.faces];
        let at = face % self.faces;
        let start = if at == 0 { 0 } else { piece.ends[at - 1] as usize };
        &piece.slots[start..piece.ends[at] as usize]
    }

    /// What a strip caught, face after face; where it covers a place twice, an index occurs twice.
    pub fn points_of<'a>(
        &'a self,
        strips: &'a Strips,
        domain: &'a PlanarDomain,
        points: &'a DomainPoints,
        strip: StripId,
    ) -> impl Iterator<Item = WrappedPoint> + 'a {
        let own = &strips.strips[strip.index()];
        (0u32..).zip(&own.faces).flat_map(move |(index, &face)| {
            let [a, b, c] = laid(own, index as usize, domain.offsets[strip.index()]);
            self.slots(FacePlace { strip, index }).iter().map(move |&slot| {
                let (place, index) = points.at(slot);
                let point = SurfacePoint { face, barycentric: plane::barycentric(a, b, c, place) };
                WrappedPoint { index, point, place }
            })
        })
    }

    /// Each caught slot with its strip's face, in pieces that are worth a visit of a core: what `f` makes of each piece,
    /// in order.
    pub(crate) fn map_pieces<R: Send>(&self, f: impl Fn(CaughtPiece<'_>) -> R + Sync + Send) -> Vec<R> {
        parallel::map(self.pieces.len(), |i| f(CaughtPiece { wrapping: self, piece: i }))
    }
}

/// What some faces that follow each other caught.
pub(crate) struct CaughtPiece<'a> {
    wrapping: &'a Wrapping,
    piece: usize,
}

impl CaughtPiece<'_> {
    /// Its slots, each with the place of its face.
    pub(crate) fn slots(&self) -> impl Iterator<Item = (u64, FacePlace)> + '_ {
        let Wrapping { firsts, faces, pieces } = self.wrapping;
        let Piece { ends, slots } = &pieces[self.piece];
        let first = self.piece * faces;
        let mut strip = firsts.partition_point(|&f| f <= first) - 1;
        ends.iter().enumerate().flat_map(move |(i, &end)| {
            while strip + 1 < firsts.len() && firsts[strip + 1] <= first + i {
                strip += 1;
            }
            let place = FacePlace { strip: StripId::new(strip), index: (first + i - firsts[strip]) as u32 };
            let range: Range<usize> = if i == 0 { 0 } else { ends[i - 1] as usize }..end as usize;
            slots[range].iter().map(move |&slot| (slot, place))
        })
    }
}

/// The face of a strip that holds a place of the domain, if any.
pub fn locate(strip: &Strip, offset: DVec2, place: DVec2) -> Option<FaceId> {
    (0..strip.faces.len()).find_map(|i| {
        let [a, b, c] = laid(strip, i, offset);
        plane::triangle_holds(a, b, c, place).then(|| strip.faces[i])
    })
}
