//! Wrapping (paper, 4.2 steps 2 and 4): points of the planar domain mapped back to the surface.

use glam::DVec2;

use crate::domain::{DomainPoints, PlanarDomain};
use crate::geometry::plane;
use crate::ids::{FaceId, StripId};
use crate::lanes::{LANES, Lanes};
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
        let mut ends = Vec::with_capacity(range.len());
        // Slots of points are written whether they are caught or not, and only counted if they are: no processor foresees
        // which.
        let (mut slots, mut caught) = (vec![0; ROOM], 0);
        let mut s = firsts.partition_point(|&first| first <= range.start) - 1;
        for face in range {
            while s + 1 < firsts.len() && firsts[s + 1] <= face {
                s += 1;
            }
            let corners = laid(&strips.strips[s], face - firsts[s], domain.offsets[s]);
            let triangle = Triangle::new(corners);
            points.in_triangle(corners, |some, places| {
                if caught + LANES > slots.len() {
                    slots.resize(2 * slots.len(), 0);
                }
                for (&slot, is_held) in some.iter().zip(triangle.holds(places)) {
                    slots[caught] = slot;
                    caught += usize::from(is_held);
                }
            });
            ends.push(caught as u32);
        }
        Piece { ends, slots: slots[..caught].to_vec() }
    });
    Wrapping { firsts, faces, pieces }
}

/// Slots for which there is room at first: as many as most pieces have.
const ROOM: usize = 1 << 14;

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
struct Triangle {
    corners: [DVec2; 3],
    /// No corner lies farther from the first one in x or in y.
    extent: f64,
}

impl Triangle {
    #[inline]
    fn new(corners: [DVec2; 3]) -> Self {
        let [a, b, c] = corners;
        Self { corners, extent: (b - a).abs().max((c - a).abs()).max_element() }
    }

    /// As [`plane::triangle_holds`], to the bit; where rounding cannot change the sign without the exact test.
    #[inline]
    fn holds(&self, [x, y]: &[Lanes; 2]) -> [bool; LANES] {
        let (mut least, mut error) = ([0.0; LANES], [0.0; LANES]);
        let [a, b, c] = self.corners;
        let lower = |s: f64, t: f64| if s < t { s } else { t };
        for lane in 0..LANES {
            let p = DVec2::new(x[lane], y[lane]);
            let (a, b, c) = (a - p, b - p, c - p);
            least[lane] = lower(lower(a.perp_dot(b), b.perp_dot(c)), c.perp_dot(a));
            let (aside, above) = (a.x.abs(), a.y.abs());
            let far = self.extent + if aside > above { aside } else { above };
            // Shewchuk's bound, (3 + 16 e) e times the sum of the two products, is less than this.
            error[lane] = 8e-16 * far * far;
        }
        let mut holds = [false; LANES];
        for lane in 0..LANES {
            holds[lane] = least[lane] > error[lane];
        }
        for lane in 0..LANES {
            if least[lane].abs() <= error[lane] {
                let [a, b, c] = self.corners;
                holds[lane] = plane::triangle_holds(a, b, c, DVec2::new(x[lane], y[lane]));
            }
        }
        holds
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
            let triangle = plane::Triangle::new(laid(own, index as usize, domain.offsets[strip.index()]));
            let slots = self.slots(FacePlace { strip, index });
            slots.chunks(LANES).flat_map(move |some| {
                let mut slots = [some[0]; LANES];
                slots[..some.len()].copy_from_slice(some);
                let places = points.places(&slots);
                let weights = triangle.barycentric(&places);
                some.iter().enumerate().map(move |(lane, &slot)| {
                    let point = SurfacePoint { face, barycentric: weights.map(|weight| weight[lane]) };
                    let place = DVec2::new(places[0][lane], places[1][lane]);
                    WrappedPoint { index: points.index(slot), point, place }
                })
            })
        })
    }

    /// What `f` makes of pieces that are worth a visit of a core, in order.
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
    /// Calls `f` with the place of each face and its slots.
    pub(crate) fn for_each_face(&self, mut f: impl FnMut(FacePlace, &[u64])) {
        let Wrapping { firsts, faces, pieces } = self.wrapping;
        let Piece { ends, slots } = &pieces[self.piece];
        let first = self.piece * faces;
        let mut strip = firsts.partition_point(|&f| f <= first) - 1;
        let mut start = 0;
        for (face, &end) in (first..).zip(ends) {
            while strip + 1 < firsts.len() && firsts[strip + 1] <= face {
                strip += 1;
            }
            let place = FacePlace { strip: StripId::new(strip), index: (face - firsts[strip]) as u32 };
            f(place, &slots[start..end as usize]);
            start = end as usize;
        }
    }
}

/// The face of a strip that holds a place of the domain, if any.
pub fn locate(strip: &Strip, offset: DVec2, place: DVec2) -> Option<FaceId> {
    (0..strip.faces.len()).find_map(|i| {
        let [a, b, c] = laid(strip, i, offset);
        plane::triangle_holds(a, b, c, place).then(|| strip.faces[i])
    })
}
