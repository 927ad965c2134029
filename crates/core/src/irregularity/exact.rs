//! The exact area of the irregular zone: the points of a strip nearer than d_m to an open border edge, the distance
//! measured in the plane and through the strip (so an edge that lies over another sheet of a strip that overlaps
//! itself does not count there).
//!
//! A triangle inside the zone of a single edge counts whole; one that a single edge reaches, or two neighbouring
//! ones, is measured in closed form; others are cut into four until the area still undecided is below [`UNDECIDED`]
//! of the total.

use glam::DVec2;

use super::capsule::{Segment, covered_area, covered_area_of_pair, drop_dominated};
use super::flood::{Near, Sources, flood};
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

/// Comparing every segment with every other pays only when few are left.
const FEW: usize = 16;

/// A triangle whose part in the zone is not known yet.
struct Piece {
    corners: [DVec2; 3],
    /// Open edges, and ends of such, to which at least one point of the triangle may be nearer than d_m.
    edges: Vec<Segment>,
}

/// What is known of a triangle.
enum Verdict {
    /// The area of its part in the zone.
    Covered(f64),
    /// Has to be cut.
    Undecided(Piece),
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
    let mut undecided = Vec::new();
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
    // Every undecided face may leave undecided the same share of its own area.
    let left: f64 = undecided.iter().map(|piece| area(&piece.corners)).sum();
    let allowed = UNDECIDED * total / left;
    let looks = MOST_LOOKS / undecided.len().max(1);
    for (part, left) in map(undecided.len(), |i| refine(&undecided[i], d_m, allowed, looks)) {
        covered += part;
        unknown += left;
    }
    Exact { zone: ((covered + 0.5 * unknown) / total).min(1.0), undecided: unknown / total }
}

/// The area that is known to lie in the zone, and the faces of which that is not known; `None` if nothing is known.
fn judge_strip(strip: &Strip, open: &[OpenEdge], d_m: f64) -> Option<(f64, Vec<Piece>)> {
    if open.is_empty() {
        return Some((0.0, Vec::new()));
    }
    let places: Vec<usize> = open.iter().map(|e| e.place).collect();
    let sources = Sources::new(open.iter().map(|e| Segment { from: e.from, to: e.to }).collect());
    let mut covered = 0.0;
    let mut undecided = Vec::new();
    let near = flood(strip, &places, &sources, d_m)?;
    let judged = map_chunks(near.len(), CHUNK, |range| {
        let mut covered = 0.0;
        let mut undecided = Vec::new();
        for face in range {
            let corners = strip.triangle(face);
            let edges: Vec<Segment> = match &near[face] {
                Near::Whole => {
                    covered += area(&corners);
                    continue;
                }
                Near::Sources(near) => near.iter().map(|&s| sources.segment(s)).collect(),
            };
            match judge(Piece { corners, edges }, d_m) {
                Verdict::Covered(part) => covered += part,
                Verdict::Undecided(piece) => undecided.push(piece),
            }
        }
        (covered, undecided)
    });
    for (part, pieces) in judged {
        covered += part;
        undecided.extend(pieces);
    }
    Some((covered, undecided))
}

fn judge(mut piece: Piece, d_m: f64) -> Verdict {
    let (centre, radius) = around(&piece.corners);
    piece.edges.retain(|edge| edge.distance(centre) < d_m + radius);
    // The points near an edge form a convex set: if it holds the corners it holds the triangle.
    if piece.edges.iter().any(|edge| piece.corners.iter().all(|&p| edge.distance(p) <= d_m)) {
        return Verdict::Covered(area(&piece.corners));
    }
    if (2..=FEW).contains(&piece.edges.len()) {
        // Copies of an edge that differ by rounding must not keep each other in play for ever.
        drop_dominated(&mut piece.edges, &piece.corners, 1e-9 * d_m);
    }
    let known = match piece.edges.as_slice() {
        [] => Some(0.0),
        [edge] => Some(covered_area(&piece.corners, edge, d_m)),
        [one, other] => covered_area_of_pair(&piece.corners, one, other, d_m),
        _ => None,
    };
    known.map_or(Verdict::Undecided(piece), Verdict::Covered)
}

/// The area of the part of an undecided triangle that is known to be in the zone, and the area that stays undecided: at
/// most the share `allowed` of the triangle, if that takes no more than about so many looks at edges.
fn refine(whole: &Piece, d_m: f64, allowed: f64, looks: usize) -> (f64, f64) {
    let mut covered = 0.0;
    let mut level: Vec<Piece> = cut(whole).into();
    let mut piece_area = 0.25 * area(&whole.corners);
    let mut allowed_pieces = 4.0 * allowed;
    let mut looked = 0;
    for _ in 0..DEEPEST {
        looked += level.iter().map(|piece| piece.edges.len()).sum::<usize>();
        let mut undecided = Vec::new();
        for piece in level {
            match judge(piece, d_m) {
                Verdict::Covered(part) => covered += part,
                Verdict::Undecided(piece) => undecided.push(piece),
            }
        }
        level = undecided;
        if level.len() as f64 <= allowed_pieces || looked > looks {
            break;
        }
        level = level.iter().flat_map(cut).collect();
        piece_area *= 0.25;
        allowed_pieces *= 4.0;
    }
    (covered, piece_area * level.len() as f64)
}

/// Four triangles of half the size.
fn cut(piece: &Piece) -> [Piece; 4] {
    let [a, b, c] = piece.corners;
    let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
        .map(|corners| Piece { corners, edges: piece.edges.clone() })
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
