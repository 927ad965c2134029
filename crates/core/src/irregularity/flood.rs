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

/// Gives the nearest arrivals first, up to the width of a bucket: exact order would cost more than it saves.
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

/// More than rounding does to a distance, relative to it.
const SLACK: f64 = 1e-9;

/// So many arrivals of sources are followed for each face, and [`FEW_ARRIVALS`] more.
const ARRIVALS: usize = 256;

/// See [`ARRIVALS`].
const FEW_ARRIVALS: usize = 1 << 17;

/// So many sources are kept with their face.
const KEPT: usize = 6;

/// Sources that reached a face later; numbers as in [`Reached`].
#[derive(Clone, Copy)]
struct More {
    sources: [Option<NonZero<u32>>; 7],
    /// The place of those before them.
    before: Option<NonZero<u32>>,
}

/// What is known of a face, in one line of the cache. Numbers of faces, sources and places are one more than they are.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Reached {
    /// For each side: no point of it is farther than this from the nearest of the sources that reached the face.
    farthest: [f64; 3],
    /// The face beyond each side.
    neighbours: [Option<NonZero<u32>>; 3],
    /// The sources that reached it first.
    first: [Option<NonZero<u32>>; KEPT],
    /// The place of the last of all others, in a list linked through [`Flooded::more`].
    last: Option<NonZero<u32>>,
}

/// For each face of a strip the sources that are near.
pub(super) struct Flooded {
    faces: Vec<Reached>,
    /// No point of each face is farther than this from the nearest open edge.
    farthest: Vec<f64>,
    more: Vec<More>,
}

impl Flooded {
    pub(super) fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Whether all of a face is nearer than `distance` to one open edge.
    pub(super) fn is_within(&self, face: usize, distance: f64) -> bool {
        self.farthest[face] <= distance
    }

    /// The sources to which points of a face may be near. There are no others.
    pub(super) fn sources(&self, face: usize) -> impl Iterator<Item = u32> {
        let reached = &self.faces[face];
        let place = |number: NonZero<u32>| &self.more[number.get() as usize - 1];
        let more = std::iter::successors(reached.last.map(place), move |more| more.before.map(place));
        let later = more.flat_map(|more| more.sources.iter().rev());
        later.chain(reached.first.iter().rev()).flatten().map(|number| number.get() - 1)
    }

    /// Adds a source to those of a face, if it is not among them.
    #[inline]
    fn add(&mut self, face: usize, source: u32) -> bool {
        let number = NonZero::new(source + 1);
        let reached = &mut self.faces[face];
        // Free places come last.
        for kept in &mut reached.first {
            if kept.is_none() {
                *kept = number;
                return true;
            }
            if *kept == number {
                return false;
            }
        }
        let mut next = reached.last;
        while let Some(place) = next {
            let more = &self.more[place.get() as usize - 1];
            if more.sources.contains(&number) {
                return false;
            }
            next = more.before;
        }
        let last = reached.last.map(|place| &mut self.more[place.get() as usize - 1]);
        if let Some(free) = last.and_then(|last| last.sources.iter_mut().find(|source| source.is_none())) {
            *free = number;
            return true;
        }
        let mut more = More { sources: [None; 7], before: reached.last };
        more.sources[0] = number;
        self.more.push(more);
        reached.last = NonZero::new(self.more.len() as u32);
        true
    }
}

/// For each face of the strip the sources nearer than `d_m` to it. `open` holds, for each open edge, its place in
/// the strip's border; cuts that are not among them are crossed.
///
/// `None` if there are too many near too many faces, as on needles that lie side by side within d_m.
pub(super) fn flood(strip: &Strip, open: &[usize], sources: &Sources, d_m: f64) -> Option<Flooded> {
    let sides = Sides::new(strip);
    let reached =
        |neighbours| Reached { farthest: [f64::INFINITY; 3], neighbours, first: [None; KEPT], last: None };
    let faces: Vec<Reached> = neighbours(strip, &sides, open).into_iter().map(reached).collect();
    let most = (FEW_ARRIVALS + ARRIVALS * faces.len()).min(u32::MAX as usize);
    let mut queue = Queue::new(d_m.min(strip.extent.length()));
    for (&place, source) in open.iter().zip(0u32..) {
        let edge = &strip.border[place];
        if let Some(side) = sides.find(edge.from, edge.to) {
            queue.push(Arrival { distance: 0.0, face: side / 3, source });
        }
    }
    drop(sides);
    let farthest = vec![f64::INFINITY; faces.len()];
    let mut flooded = Flooded { faces, farthest, more: Vec::new() };
    let mut arrived = 0;
    while let Some(Arrival { distance, face, source }) = queue.pop() {
        let f = face as usize;
        if distance >= flooded.farthest[f] || !flooded.add(f, source) {
            continue;
        }
        arrived += 1;
        if arrived > most {
            return None;
        }
        let segment = sources.segment(source);
        let [a, b, c] = strip.triangle(f);
        let (to_a, to_b, to_c) = (segment.distance(a), segment.distance(b), segment.distance(c));
        flooded.farthest[f] = flooded.farthest[f].min(to_a.max(to_b).max(to_c));
        let Reached { farthest, neighbours, .. } = &mut flooded.faces[f];
        let sides = [(a, b, to_a, to_b), (b, c, to_b, to_c), (c, a, to_c, to_a)];
        for ((known, neighbour), (from, to, far, other)) in farthest.iter_mut().zip(neighbours).zip(sides) {
            // What is behind a side, all of which is nearer to another source, is nearer to that one as well.
            let nearest = d_m.min(*known);
            *known = known.min(far.max(other));
            let Some(neighbour) = neighbour.map(|number| number.get() - 1) else { continue };
            let nearest = nearest.min(flooded.farthest[neighbour as usize]);
            let side = Segment { from, to };
            let Some(source) = sources.through(source, &segment, &side) else { continue };
            // The distances at both ends differ by no more than the length of the side: many are too far by this alone.
            let least = 0.5 * (far + other - from.distance(to));
            if least * (1.0 - SLACK) >= nearest {
                continue;
            }
            let mut distance = far.min(other);
            // An end of the source is nearer to the inside of the side than to its ends, or those are the nearest.
            for end in [segment.from, segment.to] {
                if side.lies_beside(end) {
                    distance = distance.min(side.distance(end));
                }
            }
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
