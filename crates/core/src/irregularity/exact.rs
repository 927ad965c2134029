//! The exact area of the irregular zone: the points of a strip nearer than d_m to an open border edge, the distance
//! measured in the plane and through the strip (so an edge that lies over another sheet of a strip that overlaps
//! itself does not count there).
//!
//! A triangle inside the zone of a single edge counts whole; one that a single edge reaches, or two neighbouring
//! ones, is measured in closed form; others are cut into four until the area still undecided is below [`UNDECIDED`]
//! of the total.

use glam::DVec2;

use super::capsule::{FEW, Segment, covered_area, covered_area_of_pair, drop_dominated};
use super::flood::{Sources, flood};
use super::open::OpenEdge;
use super::total_area;
use crate::parallel::{map, map_chunks};
use crate::unfold::{Strip, Strips};

/// The largest share of the total area that may stay undecided; it is counted half.
const UNDECIDED: f64 = 1e-4;

/// Triangles are not cut more often than this: their pieces are then a millionth of their size.
const DEEPEST: usize = 20;

/// How many faces are judged together.
const CHUNK: usize = 1 << 12;

/// Triangles whose part in the zone is not known yet.
#[derive(Default)]
struct Pieces {
    /// Each with where in `edges` those start to which at least one of its points may be nearer than d_m: open edges,
    /// and ends of such.
    corners: Vec<([DVec2; 3], u32)>,
    edges: Vec<Segment>,
}

impl Pieces {
    /// Each piece with its edges.
    fn iter(&self) -> impl Iterator<Item = (&[DVec2; 3], &[Segment])> {
        let ends = self.corners.iter().skip(1).map(|piece| piece.1 as usize).chain([self.edges.len()]);
        self.corners
            .iter()
            .zip(ends)
            .map(|((corners, start), end)| (corners, &self.edges[*start as usize..end]))
    }

    /// The area of a triangle's part in the zone; `None` if that is not known, and then it is one of the pieces.
    fn judge(
        &mut self,
        corners: [DVec2; 3],
        edges: impl IntoIterator<Item = Segment>,
        d_m: f64,
    ) -> Option<f64> {
        let start = self.edges.len();
        let known = self.part_in_zone(&corners, edges, d_m);
        match known {
            Some(_) => self.edges.truncate(start),
            None => self.corners.push((corners, start as u32)),
        }
        known
    }

    /// As [`judge`](Self::judge), leaving what edges are near behind the others.
    fn part_in_zone(
        &mut self,
        corners: &[DVec2; 3],
        edges: impl IntoIterator<Item = Segment>,
        d_m: f64,
    ) -> Option<f64> {
        let start = self.edges.len();
        let (centre, radius) = around(corners);
        let mut distances = [[0.0; 3]; FEW];
        for edge in edges {
            if edge.distance(centre) >= d_m + radius {
                continue;
            }
            let [a, b, c] = *corners;
            let far = [edge.distance(a), edge.distance(b), edge.distance(c)];
            // The points near an edge form a convex set: if it holds the corners it holds the triangle.
            if far.iter().all(|&far| far <= d_m) {
                return Some(area(corners));
            }
            if let Some(slot) = distances.get_mut(self.edges.len() - start) {
                *slot = far;
            }
            self.edges.push(edge);
        }
        let near = &mut self.edges[start..];
        if (2..=FEW).contains(&near.len()) {
            // Copies of an edge that differ by rounding must not keep each other in play for ever.
            let count = drop_dominated(near, &distances, corners, 1e-9 * d_m);
            self.edges.truncate(start + count);
        }
        match self.edges[start..] {
            [] => Some(0.0),
            [edge] => Some(covered_area(corners, &edge, d_m)),
            [one, other] => covered_area_of_pair(corners, &one, &other, d_m),
            _ => None,
        }
    }
}

/// So many times at most pieces are held against edges.
const MOST_LOOKS: usize = 1 << 26;

/// Shares of the total area.
pub(super) struct Exact {
    /// The zone, at most 1.
    pub(super) zone: f64,
    /// What was left undecided; half of it counts.
    pub(super) undecided: f64,
}

/// The area of the zone over the total area. `open` holds the open edges of each strip.
pub(super) fn share(strips: &Strips, open: &[Vec<OpenEdge>], d_m: f64) -> Exact {
    let total = total_area(strips);
    let mut covered = 0.0;
    let mut unknown = 0.0;
    let mut undecided: Vec<Pieces> = Vec::new();
    for (s, judged) in
        map(strips.strips.len(), |s| judge_strip(&strips.strips[s], &open[s], d_m)).into_iter().enumerate()
    {
        match judged {
            Some((area, pieces)) => {
                covered += area;
                undecided.extend(pieces);
            }
            None => unknown += strips.strips[s].area,
        }
    }
    let undecided: Vec<_> = undecided.iter().flat_map(Pieces::iter).collect();
    // Every undecided face may leave undecided the same share of its own area.
    let left: f64 = undecided.iter().map(|(corners, _)| area(corners)).sum();
    let allowed = UNDECIDED * total / left;
    let looks = MOST_LOOKS / undecided.len().max(1);
    for (part, left) in map(undecided.len(), |i| refine(undecided[i], d_m, allowed, looks)) {
        covered += part;
        unknown += left;
    }
    Exact { zone: ((covered + 0.5 * unknown) / total).min(1.0), undecided: unknown / total }
}

/// The area that is known to lie in the zone, and the faces of which that is not known; `None` if nothing is known.
fn judge_strip(strip: &Strip, open: &[OpenEdge], d_m: f64) -> Option<(f64, Vec<Pieces>)> {
    if open.is_empty() {
        return Some((0.0, Vec::new()));
    }
    let places: Vec<usize> = open.iter().map(|e| e.place).collect();
    let sources = Sources::new(open.iter().map(|e| Segment { from: e.from, to: e.to }).collect());
    let flooded = flood(strip, &places, &sources, d_m)?;
    let judged = map_chunks(flooded.face_count(), CHUNK, |range| {
        let mut covered = 0.0;
        let mut undecided = Pieces::default();
        for face in range {
            let corners = strip.triangle(face);
            covered += if flooded.is_within(face, d_m) {
                area(&corners)
            } else {
                let edges = flooded.sources(face).map(|source| sources.segment(source));
                undecided.judge(corners, edges, d_m).unwrap_or(0.0)
            };
        }
        (covered, undecided)
    });
    let covered = judged.iter().map(|(part, _)| part).sum();
    Some((covered, judged.into_iter().map(|(_, pieces)| pieces).collect()))
}

/// The area of the part of an undecided triangle that is known to be in the zone, and the area that stays undecided: at
/// most the share `allowed` of the triangle, if that takes no more than about so many looks at edges.
fn refine((corners, edges): (&[DVec2; 3], &[Segment]), d_m: f64, allowed: f64, looks: usize) -> (f64, f64) {
    let mut covered = 0.0;
    let mut piece_area = area(corners);
    let mut allowed_pieces = allowed;
    let mut level = Pieces { corners: vec![(*corners, 0)], edges: edges.to_vec() };
    let mut looked = 0;
    for _ in 0..DEEPEST {
        piece_area *= 0.25;
        allowed_pieces *= 4.0;
        looked += 4 * level.edges.len();
        let mut undecided = Pieces::default();
        for (corners, edges) in level.iter() {
            for part in cut(corners) {
                covered += undecided.judge(part, edges.iter().copied(), d_m).unwrap_or(0.0);
            }
        }
        level = undecided;
        if level.corners.len() as f64 <= allowed_pieces || looked > looks {
            break;
        }
    }
    (covered, piece_area * level.corners.len() as f64)
}

/// Four triangles of half the size.
fn cut(&[a, b, c]: &[DVec2; 3]) -> [[DVec2; 3]; 4] {
    let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
}

/// A point inside a triangle and how far it is to its farthest corner.
fn around(corners: &[DVec2; 3]) -> (DVec2, f64) {
    let [a, b, c] = *corners;
    let centre = (a + b + c) / 3.0;
    (centre, centre.distance(a).max(centre.distance(b)).max(centre.distance(c)))
}

/// The area of a counterclockwise triangle.
fn area(corners: &[DVec2; 3]) -> f64 {
    let [a, b, c] = *corners;
    0.5 * (b - a).perp_dot(c - a)
}
