//! Beyond the paper: growth that looks at the plane. The triangle that opens the least border joins first, so that what
//! can lie together does, and cuts stay open only where the surface's curvature keeps them apart.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::planar::{Planar, Shapes};
use super::{Attachment, Segment};
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::SurfaceMesh;

/// Of triangles that open equally little, which one joins first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tie {
    /// One that closes a cut, then the one behind the flattest edge: long flat fingers.
    Flattest,
    /// The one nearest in the plane to where the segment began: round strips.
    Nearest,
    /// The one that fits its other neighbours best.
    Tightest,
}

/// What is known of a face.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    /// So many of its neighbours are in the segment that grows now.
    Free(u8),
    /// In the segment that grows now.
    Current,
    Taken,
}

/// What it costs to join a triangle: first the share of its sides beside the segment that opens, then the tie, as the
/// bits of two singles. Those of floats that are not negative sort as the floats do; the smallest is best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Cost(u64);

impl Cost {
    fn new(share: f64, tie: f64) -> Self {
        Self(u64::from((share as f32).to_bits()) << 32 | u64::from((tie as f32).to_bits()))
    }

    fn opens_nothing(self) -> bool {
        self.0 >> 32 == 0
    }
}

/// A side of a free triangle beside the segment, as it was seen last.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Seen {
    cost: Cost,
    across: HalfedgeId,
    /// How many neighbours of the triangle were in the segment.
    beside: u8,
}

/// A segment, and the length of its cuts that are open: each edge counts once.
pub(super) struct Fitted {
    pub(super) segment: Segment,
    pub(super) open: f64,
}

struct Fitting<'a> {
    mesh: &'a SurfaceMesh,
    shapes: &'a Shapes,
    /// Gaps up to this stay closed.
    tolerance: f64,
    tie: Tie,
    state: Vec<State>,
    planar: Planar<'a>,
    frontier: BinaryHeap<Reverse<Seen>>,
}

/// A segment for each component, grown from the seeds, one in each. O(F log F).
pub(super) fn fit(
    mesh: &SurfaceMesh,
    shapes: &Shapes,
    seeds: &[HalfedgeId],
    tolerance: f64,
    tie: Tie,
) -> Vec<Fitted> {
    let mut fitting = Fitting {
        mesh,
        shapes,
        tolerance,
        tie,
        state: vec![State::Free(0); mesh.face_count()],
        planar: Planar::new(shapes),
        frontier: BinaryHeap::new(),
    };
    seeds.iter().map(|seed| fitting.grow(seed.face())).collect()
}

/// Where a free face lies when it is attached, and what that does.
struct Fit {
    corners: [DVec2; 3],
    cost: Cost,
    /// The length of its sides that open.
    open: f64,
}

impl Fitting<'_> {
    /// Grows a segment from a face until nothing is left beside it.
    fn grow(&mut self, seed: FaceId) -> Fitted {
        let mut fitted = Fitted { segment: Segment::default(), open: 0.0 };
        let attachments = &mut fitted.segment.attachments;
        let corners = self.planar.beside(self.mesh, seed, None);
        self.join(Attachment { face: seed, across: None }, corners, attachments);
        while let Some(Reverse(seen)) = self.frontier.pop() {
            let face = seen.across.face();
            let State::Free(beside) = self.state[face.index()] else { continue };
            let attachment = Attachment { face, across: Some(seen.across) };
            if beside == seen.beside && seen.cost.opens_nothing() {
                let corners = self.planar.beside(self.mesh, face, attachment.across);
                self.join(attachment, corners, attachments);
                continue;
            }
            let fit = self.place(seen.across);
            if fit.cost > seen.cost {
                // Others were laid beside it since: it may have to wait.
                self.frontier.push(Reverse(Seen { cost: fit.cost, beside, ..seen }));
            } else {
                fitted.open += fit.open;
                self.join(attachment, fit.corners, attachments);
            }
        }
        for attachment in &*attachments {
            self.state[attachment.face.index()] = State::Taken;
        }
        fitted
    }

    fn join(&mut self, attachment: Attachment, corners: [DVec2; 3], attachments: &mut Vec<Attachment>) {
        let face = attachment.face;
        self.state[face.index()] = State::Current;
        self.planar.lay(face, corners);
        attachments.push(attachment);
        for corner in 0..3 {
            let Some(across) = self.mesh.topology().twin(HalfedgeId::of(face, corner)) else { continue };
            let State::Free(beside) = &mut self.state[across.face().index()] else { continue };
            *beside += 1;
            let beside = *beside;
            let cost = self.place(across).cost;
            self.frontier.push(Reverse(Seen { cost, across, beside }));
        }
    }

    fn place(&self, across: HalfedgeId) -> Fit {
        let corners = self.planar.beside(self.mesh, across.face(), Some(across));
        let topology = self.mesh.topology();
        let (mut open, mut closed) = (0.0, self.shapes.length(across));
        let mut widest: Option<f64> = None;
        for side in [across.next(), across.previous()] {
            let Some(twin) = topology.twin(side) else { continue };
            if self.state[twin.face().index()] == State::Current {
                let (from, to) = (corners[side.corner()], corners[side.next().corner()]);
                let gap = self.planar.gap(from, to, twin);
                widest = Some(widest.map_or(gap, |w| w.max(gap)));
                let length = self.shapes.length(side);
                if gap > self.tolerance { open += length } else { closed += length }
            }
        }
        let tie = match (self.tie, widest) {
            (Tie::Flattest, Some(_)) => 0.0,
            (Tie::Flattest, None) => self.shapes.bend(across),
            (Tie::Nearest, _) => (corners[0] + corners[1] + corners[2]).length(),
            (Tie::Tightest, widest) => widest.unwrap_or(0.0),
        };
        Fit { corners, cost: Cost::new(open / (open + closed), tie), open }
    }
}
