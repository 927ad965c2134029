//! Beyond the paper: growth that looks at the plane. The triangle that opens the least border joins first, so that what
//! can lie together does, and cuts stay open only where the surface's curvature keeps them apart.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::planar::{Planar, first};
use super::seeds::component_seeds;
use super::{Attachment, Segment, Segmentation};
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

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Free,
    /// In the segment that grows now.
    Current,
    Taken,
}

/// What it costs to join a triangle: first the share of its sides beside the segment that opens, then the tie. Bits of
/// floats that are not negative sort as the floats do; the smallest is best.
type Cost = (u64, u64);

struct Fitting<'a> {
    mesh: &'a SurfaceMesh,
    /// Gaps up to this stay closed.
    tolerance: f64,
    tie: Tie,
    state: Vec<State>,
    planar: Planar,
    /// Sides of free triangles beside the segment, with what they cost when they were seen last.
    frontier: BinaryHeap<Reverse<(Cost, HalfedgeId)>>,
}

/// A segment for each component, grown from its longest edge. O(F log F).
pub(super) fn fit(mesh: &SurfaceMesh, tolerance: f64, tie: Tie) -> Segmentation {
    let mut fitting = Fitting {
        mesh,
        tolerance,
        tie,
        state: vec![State::Free; mesh.face_count()],
        planar: Planar::new(mesh),
        frontier: BinaryHeap::new(),
    };
    let seeds = component_seeds(mesh);
    Segmentation { segments: seeds.into_iter().map(|seed| fitting.grow(seed.face())).collect() }
}

impl Fitting<'_> {
    /// Grows a segment from a face until nothing is left beside it.
    fn grow(&mut self, seed: FaceId) -> Segment {
        let mut attachments = Vec::new();
        self.join(Attachment { face: seed, across: None }, first(self.mesh, seed), &mut attachments);
        while let Some(Reverse((cost, across))) = self.frontier.pop() {
            let face = across.face();
            if self.state[face.index()] != State::Free {
                continue;
            }
            let (corners, now) = self.place(across);
            if now > cost {
                // Others were laid beside it since: it may have to wait.
                self.frontier.push(Reverse((now, across)));
            } else {
                self.join(Attachment { face, across: Some(across) }, corners, &mut attachments);
            }
        }
        for attachment in &attachments {
            self.state[attachment.face.index()] = State::Taken;
        }
        Segment { attachments }
    }

    fn join(&mut self, attachment: Attachment, corners: [DVec2; 3], attachments: &mut Vec<Attachment>) {
        let face = attachment.face;
        self.state[face.index()] = State::Current;
        self.planar.lay(face, corners);
        attachments.push(attachment);
        for corner in 0..3 {
            let Some(twin) = self.mesh.topology().twin(HalfedgeId::of(face, corner)) else { continue };
            if self.state[twin.face().index()] == State::Free {
                let (_, cost) = self.place(twin);
                self.frontier.push(Reverse((cost, twin)));
            }
        }
    }

    /// Where a free face lies when it is attached across its side `across`, and what that costs.
    fn place(&self, across: HalfedgeId) -> ([DVec2; 3], Cost) {
        let corners = self.planar.beside(self.mesh, across);
        let topology = self.mesh.topology();
        let (mut open, mut closed) = (0.0, self.mesh.edge_length(across));
        let mut widest: Option<f64> = None;
        for side in [across.next(), across.previous()] {
            let Some(twin) = topology.twin(side) else { continue };
            if self.state[twin.face().index()] == State::Current {
                let gap = self.planar.gap(&corners, side, twin);
                widest = Some(widest.map_or(gap, |w| w.max(gap)));
                let length = self.mesh.edge_length(side);
                if gap > self.tolerance { open += length } else { closed += length }
            }
        }
        let tie = match (self.tie, widest) {
            (Tie::Flattest, Some(_)) => 0.0,
            (Tie::Flattest, None) => topology.twin(across).map_or(0.0, |twin| {
                let normals = [across, twin].map(|h| self.mesh.face_normal(h.face()));
                normals[0].distance_squared(normals[1])
            }),
            (Tie::Nearest, _) => (corners[0] + corners[1] + corners[2]).length(),
            (Tie::Tightest, widest) => widest.unwrap_or(0.0),
        };
        let share: f64 = open / (open + closed);
        (corners, (share.to_bits(), tie.to_bits()))
    }
}
