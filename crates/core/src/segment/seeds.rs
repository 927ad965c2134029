//! Where segments start: step 1 and step 5 of 4.1.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::Segment;
use super::growth::Growth;
use crate::ids::HalfedgeId;
use crate::mesh::SurfaceMesh;

/// An edge with its length; longer is greater, then the smaller id.
#[derive(Clone, Copy, PartialEq)]
struct LongEdge {
    length: f64,
    halfedge: HalfedgeId,
}

impl Eq for LongEdge {}

impl Ord for LongEdge {
    fn cmp(&self, other: &Self) -> Ordering {
        self.length.total_cmp(&other.length).then(other.halfedge.cmp(&self.halfedge))
    }
}

impl PartialOrd for LongEdge {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The next seed: the largest saved border edge with a free triangle behind it, else the largest edge of a
/// component that has not been reached.
pub(super) struct Seeds {
    saved: BinaryHeap<LongEdge>,
    /// The longest edge of each component, the longest of all last.
    components: Vec<LongEdge>,
}

impl Seeds {
    pub(super) fn new(mesh: &SurfaceMesh) -> Self {
        Self { saved: BinaryHeap::new(), components: longest_edges(mesh) }
    }

    /// A side of a free triangle: the one to start from, as that triangle sees it.
    pub(super) fn next(&mut self, growth: &Growth<'_>) -> Option<HalfedgeId> {
        while let Some(edge) = self.saved.pop() {
            if growth.is_free(edge.halfedge.face()) {
                return Some(edge.halfedge);
            }
        }
        // A component is left only when no saved border edge has a free triangle behind it, so the components not
        // reached yet are free as a whole.
        while let Some(edge) = self.components.pop() {
            if growth.is_free(edge.halfedge.face()) {
                return Some(edge.halfedge);
            }
        }
        None
    }

    /// Saves the border of a finished segment (step 5): the edges with a free triangle behind them.
    pub(super) fn save_border(&mut self, mesh: &SurfaceMesh, growth: &Growth<'_>, segment: &Segment) {
        for attachment in &segment.attachments {
            for corner in 0..3 {
                let Some(twin) = mesh.topology().twin(HalfedgeId::of(attachment.face, corner)) else {
                    continue;
                };
                if growth.is_free(twin.face()) {
                    self.saved.push(LongEdge { length: mesh.edge_length(twin), halfedge: twin });
                }
            }
        }
    }
}

/// The longest edge of each component, the longest of all last.
fn longest_edges(mesh: &SurfaceMesh) -> Vec<LongEdge> {
    let components = mesh.topology().components();
    let mut longest: Vec<Option<LongEdge>> = vec![None; components.count];
    let mut squares = vec![f64::NEG_INFINITY; components.count];
    for face in mesh.topology().face_ids() {
        let component = components.of_face[face.index()] as usize;
        let [a, b, c] = mesh.triangle(face);
        let sides = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        for (corner, square) in sides.into_iter().enumerate() {
            // Most are shorter than what is known, which squares tell without a root.
            if square <= squares[component] {
                continue;
            }
            let edge = LongEdge { length: square.sqrt(), halfedge: HalfedgeId::of(face, corner) };
            if longest[component].is_none_or(|longest| edge > longest) {
                longest[component] = Some(edge);
                squares[component] = square;
            }
        }
    }
    let mut components: Vec<LongEdge> = longest.into_iter().flatten().collect();
    components.sort_unstable();
    components
}

/// The longest edge of each component, the longest of all first.
pub(super) fn component_seeds(mesh: &SurfaceMesh) -> Vec<HalfedgeId> {
    longest_edges(mesh).into_iter().rev().map(|edge| edge.halfedge).collect()
}
