//! Steps 2 to 4 of 4.1: how a segment grows along its boundary.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use super::{Attachment, Segment, SegmentOptions};
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::SurfaceMesh;

/// Which neighbour of the growing segment is tried next.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Next {
    /// The one that has waited longest: along the boundary.
    Oldest,
    Flattest,
    /// The one behind the longest edge.
    Longest,
}

/// The state of one face.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FaceState {
    Free,
    /// In the segment that grows now.
    Current,
    Taken,
}

/// Edges of the growing segment's boundary, seen from inside, in the order in which they are tried.
enum Frontier {
    Walk(VecDeque<HalfedgeId>),
    /// Smallest key first; keys are bits of floats that are not negative, which sort as the floats do.
    Keyed(BinaryHeap<Reverse<(u64, HalfedgeId)>>),
}

impl Frontier {
    fn pop(&mut self) -> Option<HalfedgeId> {
        match self {
            Self::Walk(queue) => queue.pop_front(),
            Self::Keyed(heap) => heap.pop().map(|Reverse((_, h))| h),
        }
    }
}

pub(super) struct Growth<'a> {
    mesh: &'a SurfaceMesh,
    next: Next,
    /// Neighbours whose normals' squared distance is at most this are almost flat.
    flat: f64,
    state: Vec<FaceState>,
    attachments: Vec<Attachment>,
    frontier: Frontier,
    /// Boundary edges that were too bent for step 2, seen from inside.
    bent: Vec<HalfedgeId>,
}

impl<'a> Growth<'a> {
    pub(super) fn new(mesh: &'a SurfaceMesh, options: &SegmentOptions, next: Next) -> Self {
        let half = libm::sin(0.5 * options.flatness_angle.clamp(0.0, std::f64::consts::PI));
        Self {
            mesh,
            next,
            flat: 4.0 * half * half,
            state: vec![FaceState::Free; mesh.face_count()],
            attachments: Vec::new(),
            frontier: match next {
                Next::Oldest => Frontier::Walk(VecDeque::new()),
                Next::Flattest | Next::Longest => Frontier::Keyed(BinaryHeap::new()),
            },
            bent: Vec::new(),
        }
    }

    pub(super) fn is_free(&self, face: FaceId) -> bool {
        self.state[face.index()] == FaceState::Free
    }

    /// How many triangles the growing segment has.
    pub(super) fn size(&self) -> usize {
        self.attachments.len()
    }

    pub(super) fn start_segment(&mut self) {
        debug_assert!(self.attachments.is_empty());
        self.bent.clear();
    }

    pub(super) fn finish_segment(&mut self) -> Segment {
        for attachment in &self.attachments {
            self.state[attachment.face.index()] = FaceState::Taken;
        }
        Segment { attachments: std::mem::take(&mut self.attachments) }
    }

    /// Starts the segment with this face.
    pub(super) fn plant(&mut self, face: FaceId) {
        self.join(face, None);
    }

    /// Attaches the triangle behind an edge of the segment if it is free; returns the edge as that triangle sees it.
    pub(super) fn attach_across(&mut self, halfedge: HalfedgeId) -> Option<HalfedgeId> {
        let twin = self.mesh.topology().twin(halfedge)?;
        if !self.is_free(twin.face()) {
            return None;
        }
        self.join(twin.face(), Some(twin));
        Some(twin)
    }

    /// The longer of two edges, the first if they are equal.
    pub(super) fn longer(&self, a: HalfedgeId, b: HalfedgeId) -> HalfedgeId {
        if self.mesh.edge_length(b) > self.mesh.edge_length(a) { b } else { a }
    }

    fn join(&mut self, face: FaceId, across: Option<HalfedgeId>) {
        self.state[face.index()] = FaceState::Current;
        self.attachments.push(Attachment { face, across });
        for corner in 0..3 {
            let halfedge = HalfedgeId::of(face, corner);
            let Some(twin) = self.mesh.topology().twin(halfedge) else { continue };
            if self.is_free(twin.face()) {
                self.push(halfedge, twin);
            }
        }
    }

    fn push(&mut self, halfedge: HalfedgeId, twin: HalfedgeId) {
        let key = match self.next {
            Next::Oldest => 0.0,
            Next::Flattest => self.bend(halfedge.face(), twin.face()),
            Next::Longest => self.mesh.edge_length(halfedge).recip(),
        };
        match &mut self.frontier {
            Frontier::Walk(queue) => queue.push_back(halfedge),
            Frontier::Keyed(heap) => heap.push(Reverse((key.to_bits(), halfedge))),
        }
    }

    /// The squared distance of two faces' unit normals: 0 where flat, 4 where folded back; exact for small angles.
    fn bend(&self, a: FaceId, b: FaceId) -> f64 {
        self.mesh.face_normal(a).distance_squared(self.mesh.face_normal(b))
    }

    /// Whether a free face forms almost a plane with all its neighbours from the segment.
    fn is_flat(&self, face: FaceId) -> bool {
        self.neighbours(face)
            .all(|n| self.state[n.index()] != FaceState::Current || self.bend(face, n) <= self.flat)
    }

    fn neighbours(&self, face: FaceId) -> impl Iterator<Item = FaceId> + use<'_> {
        (0..3).filter_map(move |c| self.mesh.topology().twin(HalfedgeId::of(face, c)).map(HalfedgeId::face))
    }

    /// Step 2: along the boundary, adds the free triangles that form almost a plane with their neighbours.
    pub(super) fn grow_flat(&mut self) {
        while let Some(halfedge) = self.frontier.pop() {
            let Some(twin) = self.mesh.topology().twin(halfedge) else { continue };
            if !self.is_free(twin.face()) {
                continue;
            }
            if self.is_flat(twin.face()) {
                self.join(twin.face(), Some(twin));
            } else {
                self.bent.push(halfedge);
            }
        }
    }

    /// Step 3: adds free triangles that are surrounded by unfolded ones.
    pub(super) fn take_leftovers(&mut self) {
        let mut kept = Vec::new();
        while let Some(halfedge) = self.bent.pop() {
            let Some(twin) = self.mesh.topology().twin(halfedge) else { continue };
            let face = twin.face();
            if !self.is_free(face) {
                continue;
            }
            if self.neighbours(face).all(|n| !self.is_free(n)) {
                // Surrounded, so it opens no new boundary; of the edges that lead to it take the flattest.
                let across = (0..3)
                    .map(|c| HalfedgeId::of(face, c))
                    .filter_map(|h| self.mesh.topology().twin(h).map(|t| (h, t.face())))
                    .filter(|&(_, n)| self.state[n.index()] == FaceState::Current)
                    .min_by(|a, b| self.bend(face, a.1).total_cmp(&self.bend(face, b.1)).then(a.0.cmp(&b.0)))
                    .map(|(h, _)| h);
                self.join(face, across);
            } else {
                kept.push(halfedge);
            }
        }
        self.bent = kept;
    }

    /// Step 4: adds all free triangles along the boundary, whatever their angle; false if there are none.
    pub(super) fn grow_ring(&mut self) -> bool {
        let before = self.size();
        for halfedge in std::mem::take(&mut self.bent) {
            self.attach_across(halfedge);
        }
        self.size() > before
    }
}
