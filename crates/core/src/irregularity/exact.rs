//! The exact area of the irregular zone: the points of a strip nearer than d_m to an open border edge of the same
//! strip, measured straight through the plane (so an edge that lies over another sheet of a strip that overlaps itself counts there too).
//!
//! A triangle that only one edge reaches is measured in closed form; one inside the zone of a single edge counts
//! whole; others are cut into four until the area still undecided is below [`UNDECIDED`] of the total.

use glam::DVec2;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

use super::capsule::{Segment, covered_area, drop_dominated};
use super::open::OpenEdge;
use super::total_area;
use crate::parallel::{map, map_chunks};
use crate::unfold::{Strip, Strips};

/// The largest share of the total area that may stay undecided; it is counted half.
const UNDECIDED: f64 = 1e-4;

/// Triangles are not cut more often than this: their pieces are then a millionth of their size.
const DEEPEST: usize = 20;

/// Faces that one piece of parallel work takes.
const FACES_AT_A_TIME: usize = 512;

/// Comparing every segment with every other pays only when few are left.
const FEW: usize = 16;

impl RTreeObject for Segment {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.from.to_array(), self.to.to_array())
    }
}

impl PointDistance for Segment {
    fn distance_2(&self, point: &[f64; 2]) -> f64 {
        let distance = self.distance(DVec2::from_array(*point));
        distance * distance
    }
}

/// The zone of one strip: private context of this file.
struct Zone<'a> {
    strip: &'a Strip,
    edges: RTree<Segment>,
    d_m: f64,
}

/// A triangle whose part in the zone is not known yet.
struct Piece {
    corners: [DVec2; 3],
    /// Open edges of which at least one point of the triangle may be nearer than d_m.
    edges: Vec<Segment>,
}

/// What is known of a triangle.
enum Verdict {
    /// The area of its part in the zone.
    Covered(f64),
    /// Has to be cut.
    Undecided(Piece),
}

/// The area of the zone over the total area, at most 1. `open` holds the open edges of each strip.
pub(super) fn share(strips: &Strips, open: &[Vec<OpenEdge>], d_m: f64) -> f64 {
    let total = total_area(strips);
    let zones: Vec<Zone> = strips
        .strips
        .iter()
        .zip(open)
        .filter(|(_, edges)| !edges.is_empty())
        .map(|(strip, edges)| {
            let segments = edges.iter().map(|e| Segment { from: e.from, to: e.to }).collect();
            Zone { strip, edges: RTree::bulk_load(segments), d_m }
        })
        .collect();
    let mut covered = 0.0;
    let mut undecided: Vec<(usize, Piece)> = Vec::new();
    for (z, zone) in zones.iter().enumerate() {
        for (area, pieces) in map_chunks(zone.strip.faces.len(), FACES_AT_A_TIME, |faces| {
            let mut area = 0.0;
            let mut pieces = Vec::new();
            for face in faces {
                match zone.judge_face(face) {
                    Verdict::Covered(part) => area += part,
                    Verdict::Undecided(piece) => pieces.push(piece),
                }
            }
            (area, pieces)
        }) {
            covered += area;
            undecided.extend(pieces.into_iter().map(|piece| (z, piece)));
        }
    }
    // Every undecided face may leave undecided the same share of its own area.
    let left: f64 = undecided.iter().map(|(_, piece)| area(&piece.corners)).sum();
    let allowed = UNDECIDED * total / left;
    covered += map(undecided.len(), |i| {
        let (z, piece) = &undecided[i];
        zones[*z].refine(piece, allowed)
    })
    .into_iter()
    .sum::<f64>();
    (covered / total).min(1.0)
}

impl Zone<'_> {
    fn judge_face(&self, face: usize) -> Verdict {
        let corners = self.strip.triangle(face);
        let (centre, radius) = around(&corners);
        let at = centre.to_array();
        let sure = self.d_m - radius;
        if sure >= 0.0 && self.edges.locate_within_distance(at, sure * sure).next().is_some() {
            return Verdict::Covered(area(&corners));
        }
        let reach = self.d_m + radius;
        let edges = self.edges.locate_within_distance(at, reach * reach).copied().collect();
        self.judge(Piece { corners, edges })
    }

    fn judge(&self, mut piece: Piece) -> Verdict {
        let (centre, radius) = around(&piece.corners);
        piece.edges.retain(|edge| edge.distance(centre) < self.d_m + radius);
        // The points near an edge form a convex set: if it holds the corners it holds the triangle.
        if piece.edges.iter().any(|edge| piece.corners.iter().all(|&p| edge.distance(p) <= self.d_m)) {
            return Verdict::Covered(area(&piece.corners));
        }
        if (2..=FEW).contains(&piece.edges.len()) {
            // Copies of an edge that differ by rounding must not keep each other in play for ever.
            drop_dominated(&mut piece.edges, &piece.corners, 1e-9 * self.d_m);
        }
        match piece.edges.as_slice() {
            [] => Verdict::Covered(0.0),
            [edge] => Verdict::Covered(covered_area(&piece.corners, edge, self.d_m)),
            _ => Verdict::Undecided(piece),
        }
    }

    /// The area of the part of an undecided triangle in the zone. At most the share `allowed` of the triangle is
    /// decided by counting half.
    fn refine(&self, whole: &Piece, allowed: f64) -> f64 {
        let mut covered = 0.0;
        let mut level = cut(whole);
        let mut piece_area = 0.25 * area(&whole.corners);
        let mut allowed_pieces = 4.0 * allowed;
        for _ in 0..DEEPEST {
            let mut undecided = Vec::new();
            for piece in level {
                match self.judge(piece) {
                    Verdict::Covered(part) => covered += part,
                    Verdict::Undecided(piece) => undecided.push(piece),
                }
            }
            level = undecided;
            if level.len() as f64 <= allowed_pieces {
                break;
            }
            level = level.iter().flat_map(cut).collect();
            piece_area *= 0.25;
            allowed_pieces *= 4.0;
        }
        covered + 0.5 * piece_area * level.len() as f64
    }
}

/// Four triangles of half the size.
fn cut(piece: &Piece) -> Vec<Piece> {
    let [a, b, c] = piece.corners;
    let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
        .map(|corners| Piece { corners, edges: piece.edges.clone() })
        .into()
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
