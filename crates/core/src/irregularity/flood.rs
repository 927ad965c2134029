//! Which open edges lie near which faces of a strip.
//!
//! Near is meant through the strip: where a strip overlaps itself, an edge of one sheet is far from the other. So
//! all open edges are flooded over the faces at once, nearest first, across sides and closed cuts. An edge passes
//! on from a face only through sides that a straight line from it can leave by; where only lines from one of its
//! ends can, that end passes on alone. It stops at a face or side all of which is nearer to another edge, because
//! so is everything behind it.

use std::num::NonZero;

use glam::DVec2;

use super::capsule::Segment;
use crate::parallel;
use crate::unfold::{Strip, Twin};

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
        let count = self.edges.len();
        if source < count {
            self.edges[source]
        } else if source < 2 * count {
            let from = self.edges[source - count].from;
            Segment { from, to: from }
        } else {
            let to = self.edges[source - 2 * count].to;
            Segment { from: to, to }
        }
    }

    /// What of a source passes straight through the side of a face: the whole if some of it lies inside of the
    /// side's line, an end if only that lies on it.
    fn through(&self, source: u32, segment: &Segment, side: &Segment) -> Option<u32> {
        let along = side.to - side.from;
        let inside = |p: DVec2| along.perp_dot(p - side.from);
        let (from, to) = (inside(segment.from), inside(segment.to));
        if from > 0.0 || to > 0.0 {
            return Some(source);
        }
        let count = self.edges.len() as u32;
        if source >= count {
            return (from == 0.0).then_some(source);
        }
        if from == 0.0 { Some(count + source) } else { (to == 0.0).then_some(2 * count + source) }
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

/// The corner after each of a triangle.
const NEXT: [usize; 3] = [1, 2, 0];

/// More than rounding does to a distance, relative to it.
const SLACK: f64 = 1e-9;

/// So many arrivals of sources are followed for each face, and [`FEW_ARRIVALS`] more.
const ARRIVALS: usize = 256;

/// See [`ARRIVALS`].
const FEW_ARRIVALS: usize = 1 << 17;

/// What is known of a face.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Reached {
    /// No point of it is farther than this from the nearest open edge.
    farthest: f64,
    /// The same for each of its sides and the sources that reached it.
    farthest_side: [f64; 3],
    /// One more than the face beyond each side.
    neighbours: [Option<NonZero<u32>>; 3],
    /// One more than the place of the last source that reached it, in a list linked through [`Flooded::arrived`].
    latest: Option<NonZero<u32>>,
}

/// For each face of a strip the sources that are near.
pub(super) struct Flooded {
    faces: Vec<Reached>,
    /// Sources, and one more than the place of the one that reached the same face before.
    arrived: Vec<(u32, Option<NonZero<u32>>)>,
}

impl Flooded {
    pub(super) fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Whether all of a face is nearer than `distance` to one open edge.
    pub(super) fn is_within(&self, face: usize, distance: f64) -> bool {
        self.faces[face].farthest <= distance
    }

    /// The sources to which points of a face may be near. There are no others.
    pub(super) fn sources(&self, face: usize) -> impl Iterator<Item = u32> {
        let mut next = self.faces[face].latest;
        std::iter::from_fn(move || {
            let (source, before) = self.arrived[next?.get() as usize - 1];
            next = before;
            Some(source)
        })
    }
}

/// For each face of the strip the sources nearer than `d_m` to it. `open` holds, for each open edge, its place in
/// the strip's border; cuts that are not among them are crossed.
///
/// `None` if there are too many near too many faces, as on needles that lie side by side within d_m.
pub(super) fn flood(strip: &Strip, open: &[usize], sources: &Sources, d_m: f64) -> Option<Flooded> {
    let sides = Sides::new(strip);
    let reached = |neighbours| Reached {
        farthest: f64::INFINITY,
        farthest_side: [f64::INFINITY; 3],
        neighbours,
        latest: None,
    };
    let faces: Vec<Reached> = neighbours(strip, &sides, open).into_iter().map(reached).collect();
    let most = FEW_ARRIVALS + ARRIVALS * faces.len();
    let mut queue = Queue::new(d_m.min(strip.extent.length()));
    for (&place, source) in open.iter().zip(0u32..) {
        let edge = &strip.border[place];
        if let Some(side) = sides.find(edge.from, edge.to) {
            queue.push(Arrival { distance: 0.0, face: side / 3, source });
        }
    }
    drop(sides);
    let mut flooded = Flooded { faces, arrived: Vec::new() };
    while let Some(Arrival { distance, face, source }) = queue.pop() {
        let f = face as usize;
        if distance >= flooded.faces[f].farthest || flooded.sources(f).any(|known| known == source) {
            continue;
        }
        if flooded.arrived.len() >= most {
            return None;
        }
        flooded.arrived.push((source, flooded.faces[f].latest));
        let segment = sources.segment(source);
        let corners = strip.triangle(f);
        let distances = corners.map(|p| segment.distance(p));
        let reached = &mut flooded.faces[f];
        reached.latest = NonZero::new(u32::try_from(flooded.arrived.len()).ok()?);
        reached.farthest = reached.farthest.min(distances[0].max(distances[1]).max(distances[2]));
        // What is behind a side, all of which is nearer to another source, is nearer to that one as well.
        let known = reached.farthest_side;
        for c in 0..3 {
            let far = distances[c].max(distances[NEXT[c]]);
            reached.farthest_side[c] = known[c].min(far);
        }
        let neighbours = reached.neighbours;
        for c in 0..3 {
            let Some(neighbour) = neighbours[c].map(|number| number.get() - 1) else { continue };
            let nearest = d_m.min(known[c]).min(flooded.faces[neighbour as usize].farthest);
            let side = Segment { from: corners[c], to: corners[NEXT[c]] };
            // The two distances differ along the side by no more than its length; most sides are too far by this alone.
            let least = 0.5 * (distances[c] + distances[NEXT[c]] - side.from.distance(side.to));
            if least * (1.0 - SLACK) >= nearest {
                continue;
            }
            let Some(source) = sources.through(source, &segment, &side) else { continue };
            let ends = distances[c].min(distances[NEXT[c]]);
            let distance = ends.min(side.distance(segment.from)).min(side.distance(segment.to));
            if distance < nearest {
                queue.push(Arrival { distance, face: neighbour, source });
            }
        }
    }
    Some(flooded)
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

/// One more than the face beyond each side of each face, closed cuts crossed.
fn neighbours(strip: &Strip, sides: &Sides, open: &[usize]) -> Vec<[Option<NonZero<u32>>; 3]> {
    let mut neighbours = parallel::map(strip.corners.len(), |face| {
        let [a, b, c] = strip.corners[face];
        [(b, a), (c, b), (a, c)].map(|(from, to)| NonZero::new(sides.find(from, to)? / 3 + 1))
    });
    let mut is_open = vec![false; strip.border.len()];
    for &place in open {
        is_open[place] = true;
    }
    for (edge, _) in strip.border.iter().zip(is_open).filter(|(_, open)| !open) {
        let Twin::SameStrip { from, to } = edge.twin else { continue };
        if let (Some(side), Some(beyond)) = (sides.find(edge.from, edge.to), sides.find(to, from)) {
            neighbours[side as usize / 3][side as usize % 3] = NonZero::new(beyond / 3 + 1);
        }
    }
    neighbours
}
