//! The open border edges of a strip with the angles of their corners.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::unfold::{BorderEdge, Strip, Twin};

/// A border edge at which the distribution is broken. The strip lies to its left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OpenEdge {
    /// Its place in [`Strip::border`].
    pub(super) place: usize,
    /// Where it starts.
    pub(super) from: DVec2,
    /// Where it ends.
    pub(super) to: DVec2,
    /// Its length.
    pub(super) length: f64,
    /// The angle inside the strip, in radians, between the open edge before it and itself. It adds up the
    /// triangles between them, across closed cuts too, so it may exceed a full turn where the strip overlaps
    /// itself.
    pub(super) start_angle: f64,
    /// The same between itself and the open edge after it.
    pub(super) end_angle: f64,
}

/// All border edges of `strip` whose gap is wider than `tolerance`, in the order of the border.
pub(super) fn open_edges(strip: &Strip, tolerance: f64) -> Vec<OpenEdge> {
    let border = Border::new(strip, tolerance);
    let mut edges: Vec<OpenEdge> = Vec::new();
    for (place, edge) in strip.border.iter().enumerate() {
        if border.open[place] {
            edges.push(OpenEdge {
                place,
                from: strip.vertices[edge.from as usize],
                to: strip.vertices[edge.to as usize],
                length: strip.border_length(edge),
                start_angle: 0.0,
                end_angle: 0.0,
            });
        }
    }
    for i in 0..edges.len() {
        let (after, angle) = border.next_open(edges[i].place);
        edges[i].end_angle = angle;
        if let Ok(after) = edges.binary_search_by_key(&after, |edge| edge.place) {
            edges[after].start_angle = angle;
        }
    }
    edges
}

/// The border of a strip, to walk along.
struct Border<'a> {
    strip: &'a Strip,
    /// Which border edges are open.
    open: Vec<bool>,
    /// The border edge after each in its loop.
    next: Vec<usize>,
    /// `(from, to, place)` of the closed border edges, sorted.
    closed: Vec<(u32, u32, usize)>,
    /// The angle of each border edge's end.
    angle: Vec<f64>,
}

impl<'a> Border<'a> {
    fn new(strip: &'a Strip, tolerance: f64) -> Self {
        let open: Vec<bool> = strip.border.iter().map(|edge| strip.is_open(edge, tolerance)).collect();
        let mut next = vec![0; strip.border.len()];
        for range in &strip.loops {
            for i in range.clone() {
                next[i] = if i + 1 == range.end { range.start } else { i + 1 };
            }
        }
        let mut closed: Vec<_> = strip
            .border
            .iter()
            .enumerate()
            .filter(|(i, _)| !open[*i])
            .map(|(i, edge)| (edge.from, edge.to, i))
            .collect();
        closed.sort_unstable();
        let angle = corner_angles(strip, &next);
        Self { strip, open, next, closed, angle }
    }

    /// The open edge that follows the open edge `start`, and the angle between them. Closed cuts are crossed: the
    /// walk goes on behind the other copy.
    fn next_open(&self, start: usize) -> (usize, f64) {
        let mut angle = self.angle[start];
        let mut edge = self.next[start];
        // Crossing cuts permutes the border edges, so the walk ends at an open edge; the count only guards
        // against strips whose cuts do not pair up.
        for _ in 0..self.closed.len() {
            if self.open[edge] {
                break;
            }
            let Some(copy) = self.copy(&self.strip.border[edge]) else { break };
            angle += self.angle[copy];
            edge = self.next[copy];
        }
        if self.open[edge] { (edge, angle) } else { (start, angle) }
    }

    /// The border edge that is the other copy of a closed cut.
    fn copy(&self, edge: &BorderEdge) -> Option<usize> {
        let Twin::SameStrip { from, to } = edge.twin else { return None };
        // The copy runs along the border the other way.
        let at = self.closed.partition_point(|&(f, t, _)| (f, t) < (to, from));
        self.closed.get(at).filter(|&&(f, t, _)| (f, t) == (to, from)).map(|&(_, _, place)| place)
    }
}

/// The angle inside the strip at the end of each border edge.
fn corner_angles(strip: &Strip, next: &[usize]) -> Vec<f64> {
    let mut visits = vec![0u32; strip.vertices.len()];
    for edge in &strip.border {
        visits[edge.to as usize] += 1;
    }
    // The triangles at a vertex that the border passes once all lie at that one corner; their angles add up to the
    // corner's, beyond a full turn if need be.
    let mut sums = vec![0.0; strip.vertices.len()];
    for (index, corners) in strip.corners.iter().enumerate() {
        if corners.iter().all(|&v| visits[v as usize] == 0) {
            continue;
        }
        let points = strip.triangle(index);
        for c in 0..3 {
            if visits[corners[c] as usize] == 1 {
                let (p, q, r) = (points[c], points[(c + 1) % 3], points[(c + 2) % 3]);
                sums[corners[c] as usize] += turn(q - p, r - p);
            }
        }
    }
    strip
        .border
        .iter()
        .zip(next)
        .map(|(edge, &after)| {
            if visits[edge.to as usize] == 1 {
                return sums[edge.to as usize];
            }
            // Where the border touches itself the triangles cannot be told apart by the vertex: take the
            // directions of the edges.
            let at = |v: u32| strip.vertices[v as usize];
            let corner = at(edge.to);
            turn(at(strip.border[after].to) - corner, at(edge.from) - corner)
        })
        .collect()
}

/// The angle from `a` counterclockwise to `b`, in (0, 2 pi].
fn turn(a: DVec2, b: DVec2) -> f64 {
    let angle = libm::atan2(a.perp_dot(b), a.dot(b));
    if angle > 0.0 { angle } else { angle + TAU }
}
