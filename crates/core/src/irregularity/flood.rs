//! Which open edges lie near which faces of a strip.
//!
//! Near is meant through the strip: where a strip overlaps itself, an edge of one sheet is far from the other. So
//! all open edges are flooded over the faces at once, nearest first, across sides and closed cuts. An edge passes
//! on from a face only through sides that a straight line from it can leave by; where only lines from one of its
//! ends can, that end passes on alone. It stops at a face or side all of which is nearer to another edge, because
//! so is everything behind it.

use glam::DVec2;

use super::capsule::Segment;
use crate::unfold::{Strip, Twin};

/// For each face of a strip how the zone reaches it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Near {
    /// All of the face is nearer than d_m to one open edge.
    Whole,
    /// Its points may be nearer than d_m to these sources and to no others.
    Sources(Vec<u32>),
}

/// What is flooded: the open edges, numbered from 0, and behind them all their starts and all their ends.
pub(super) struct Sources {
    edges: Vec<Segment>,
}

impl Sources {
    pub(super) fn new(edges: Vec<Segment>) -> Self {
        Self { edges }
    }

    /// A source as a segment, which has no length if it is an end.
    pub(super) fn segment(&self, source: u32) -> Segment {
        let source = source as usize;
        let edge = self.edges[source % self.edges.len()];
        match source / self.edges.len() {
            0 => edge,
            1 => Segment { from: edge.from, to: edge.from },
            _ => Segment { from: edge.to, to: edge.to },
        }
    }

    /// What of a source passes straight through the side of a face: the whole if some of it lies inside of the
    /// side's line, an end if only that lies on it.
    fn through(&self, source: u32, side: &Segment) -> Option<u32> {
        let segment = self.segment(source);
        let along = side.to - side.from;
        let inside = |p: DVec2| along.perp_dot(p - side.from);
        let (from, to) = (inside(segment.from), inside(segment.to));
        if from > 0.0 || to > 0.0 {
            return Some(source);
        }
        let count = self.edges.len() as u32;
        let edge = source % count;
        match source / count {
            0 if from == 0.0 => Some(count + edge),
            0 if to == 0.0 => Some(2 * count + edge),
            1 | 2 if from == 0.0 => Some(source),
            _ => None,
        }
    }
}

/// A source on its way into a face.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    /// No point of the face that the source reaches is nearer to it than this.
    distance: f64,
    face: u32,
    source: u32,
}

/// Gives the nearest arrivals first, up to the width of a bucket: their order decides about the work only, and
/// exact order would cost more than it saves.
struct Queue {
    buckets: Vec<Vec<Arrival>>,
    first: usize,
    per_distance: f64,
}

impl Queue {
    const BUCKETS: usize = 1024;

    fn new(farthest: f64) -> Self {
        let per_distance = Self::BUCKETS as f64 / farthest;
        Self { buckets: vec![Vec::new(); Self::BUCKETS], first: 0, per_distance }
    }

    fn push(&mut self, arrival: Arrival) {
        // The cast saturates; what is nearer than the front joins the front.
        let bucket = (arrival.distance * self.per_distance) as usize;
        self.buckets[bucket.clamp(self.first, Self::BUCKETS - 1)].push(arrival);
    }

    fn pop(&mut self) -> Option<Arrival> {
        while self.buckets[self.first].is_empty() && self.first + 1 < Self::BUCKETS {
            self.first += 1;
        }
        self.buckets[self.first].pop()
    }
}

/// So many arrivals of sources are followed for each face, and [`FEW_ARRIVALS`] more.
const ARRIVALS: usize = 256;

/// See [`ARRIVALS`].
const FEW_ARRIVALS: usize = 1 << 17;

/// For each face of the strip the sources nearer than `d_m` to it. `open` holds, for each open edge, its place in
/// the strip's border; cuts that are not among them are crossed.
///
/// `None` if there are too many near too many faces, as on needles that lie side by side within d_m.
pub(super) fn flood(strip: &Strip, open: &[usize], sources: &Sources, d_m: f64) -> Option<Vec<Near>> {
    let sides = Sides::new(strip);
    let neighbours = neighbours(strip, &sides, open);
    let count = strip.corners.len();
    // For each face the sources that reached it so far, as a list linked through `arrived`.
    let mut latest: Vec<Option<u32>> = vec![None; count];
    let mut arrived: Vec<(u32, Option<u32>)> = Vec::new();
    // No point of the face is farther than this from the nearest open edge.
    let mut farthest = vec![f64::INFINITY; count];
    // The same for each side of each face and the sources that reached that face.
    let mut farthest_side = vec![[f64::INFINITY; 3]; count];
    let most = FEW_ARRIVALS + ARRIVALS * count;
    let mut queue = Queue::new(d_m.min(strip.extent.length()));
    for (&place, source) in open.iter().zip(0u32..) {
        let edge = &strip.border[place];
        if let Some(side) = sides.find(edge.from, edge.to) {
            queue.push(Arrival { distance: 0.0, face: side / 3, source });
        }
    }
    let linked = |from: Option<u32>, arrived: &[(u32, Option<u32>)]| {
        let mut all = Vec::new();
        let mut next = from;
        while let Some(i) = next {
            let (source, before) = arrived[i as usize];
            all.push(source);
            next = before;
        }
        all
    };
    while let Some(Arrival { distance, face, source }) = queue.pop() {
        let f = face as usize;
        if distance >= farthest[f] {
            continue;
        }
        let mut known = latest[f];
        while let Some(i) = known.filter(|&i| arrived[i as usize].0 != source) {
            known = arrived[i as usize].1;
        }
        if known.is_some() {
            continue;
        }
        if arrived.len() >= most {
            return None;
        }
        let place = u32::try_from(arrived.len()).ok()?;
        arrived.push((source, latest[f]));
        latest[f] = Some(place);
        let segment = sources.segment(source);
        let corners = strip.triangle(f);
        let distances = corners.map(|p| segment.distance(p));
        farthest[f] = farthest[f].min(distances[0].max(distances[1]).max(distances[2]));
        for c in 0..3 {
            let far = &mut farthest_side[f][c];
            let known = *far;
            *far = known.min(distances[c].max(distances[(c + 1) % 3]));
            let Some(neighbour) = neighbours[f][c] else { continue };
            let side = Segment { from: corners[c], to: corners[(c + 1) % 3] };
            let Some(source) = sources.through(source, &side) else { continue };
            let ends = distances[c].min(distances[(c + 1) % 3]);
            let distance = ends.min(side.distance(segment.from)).min(side.distance(segment.to));
            // What is behind a side, all of which is nearer to another source, is nearer to that one as well.
            if distance < d_m && distance < known && distance < farthest[neighbour as usize] {
                queue.push(Arrival { distance, face: neighbour, source });
            }
        }
    }
    let near = |f| if farthest[f] <= d_m { Near::Whole } else { Near::Sources(linked(latest[f], &arrived)) };
    Some((0..count).map(near).collect())
}

/// The sides of a strip's faces by the planar vertices at their ends.
struct Sides {
    /// Where the sides that start at each vertex begin in `sides`.
    starts: Vec<u32>,
    /// The end of each side and the side: `3 face + corner`, with the face's place in the strip.
    sides: Vec<(u32, u32)>,
}

impl Sides {
    fn new(strip: &Strip) -> Self {
        let mut starts = vec![0u32; strip.vertices.len() + 1];
        for &v in strip.corners.iter().flatten() {
            starts[v as usize + 1] += 1;
        }
        for v in 0..strip.vertices.len() {
            starts[v + 1] += starts[v];
        }
        let mut cursor = starts.clone();
        let mut sides = vec![(0, 0); strip.corners.len() * 3];
        for (face, corners) in (0u32..).zip(&strip.corners) {
            for c in 0..3 {
                let slot = &mut cursor[corners[c] as usize];
                sides[*slot as usize] = (corners[(c + 1) % 3], 3 * face + c as u32);
                *slot += 1;
            }
        }
        Self { starts, sides }
    }

    /// The side between two planar vertices, in this direction.
    fn find(&self, from: u32, to: u32) -> Option<u32> {
        let range = self.starts[from as usize] as usize..self.starts[from as usize + 1] as usize;
        self.sides[range].iter().find(|(end, _)| *end == to).map(|&(_, side)| side)
    }
}

/// The face beyond each side of each face, closed cuts crossed.
fn neighbours(strip: &Strip, sides: &Sides, open: &[usize]) -> Vec<[Option<u32>; 3]> {
    let mut neighbours: Vec<[Option<u32>; 3]> = strip
        .corners
        .iter()
        .map(|&[a, b, c]| [(b, a), (c, b), (a, c)].map(|(from, to)| Some(sides.find(from, to)? / 3)))
        .collect();
    let mut is_open = vec![false; strip.border.len()];
    for &place in open {
        is_open[place] = true;
    }
    for (edge, _) in strip.border.iter().zip(is_open).filter(|(_, open)| !open) {
        let Twin::SameStrip { from, to } = edge.twin else { continue };
        if let (Some(side), Some(beyond)) = (sides.find(edge.from, edge.to), sides.find(to, from)) {
            neighbours[side as usize / 3][side as usize % 3] = Some(beyond / 3);
        }
    }
    neighbours
}
