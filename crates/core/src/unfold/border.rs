//! The border of a strip: its edges in ordered loops, and where each cut edge lies a second time.

use std::ops::Range;

use prefetch_index::prefetch_index;

use super::lay::{AHEAD, Links, NEXT, Planar, first_corner};
use super::{BorderEdge, FacePlace, Twin};
use crate::ids::{HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::segment::Segment;

/// So many edges are changed together.
const PIECE: usize = 1 << 12;

/// A side in the border, and the planar vertex at which it starts.
#[derive(Clone, Copy)]
struct Step {
    side: HalfedgeId,
    from: u32,
}

/// The sides in the border, loop after loop, and where the loops lie among them.
pub(super) struct Loops {
    steps: Vec<Step>,
    pub(super) loops: Vec<Range<usize>>,
}

impl Loops {
    /// The way around a tree of triangles, along all sides but those at which one hangs on another: it has as many steps
    /// behind a triangle's side as those that hang there have together. Linear time.
    pub(super) fn around(segment: &Segment, links: &Links) -> Self {
        // How many steps the way has behind each side; one if nothing hangs there.
        let attachments = &segment.attachments[..];
        let mut lengths = vec![[1_u32; 3]; attachments.len()];
        for i in (0..attachments.len()).rev() {
            if let Some(on) = links.of(i) {
                // All but the side that is attached.
                lengths[on as usize / 3][on as usize % 3] = lengths[i].iter().sum::<u32>() - 1;
            }
        }
        // The lengths give way to the first steps.
        let mut starts = lengths;
        let mut steps: Vec<Step> = Vec::new();
        let mut roots = Vec::new();
        let mut vertex = 0;
        for (i, attachment) in attachments.iter().enumerate() {
            let side = |corner: usize| HalfedgeId::of(attachment.face, corner);
            // Where a triangle hangs its own sides, which come later, take the place. The first starts where the side did
            // on which it hangs.
            if let Some(on) = links.of(i) {
                let one = NEXT[first_corner(attachment)];
                let other = NEXT[one];
                let start = starts[on as usize / 3][on as usize % 3];
                let middle = start + starts[i][one];
                starts[i][one] = start;
                starts[i][other] = middle;
                steps[start as usize].side = side(one);
                steps[middle as usize] = Step { side: side(other), from: vertex };
                vertex += 1;
            } else {
                let start = steps.len();
                for (corner, place) in starts[i].iter_mut().enumerate() {
                    let length = std::mem::replace(place, steps.len() as u32) as usize;
                    steps.resize(steps.len() + length, Step { side: side(corner), from: vertex });
                    vertex += 1;
                }
                roots.push((i, start..steps.len()));
            }
        }
        // Each loop starts with the side that is first among those of the strip's faces.
        for (root, range) in &roots {
            let first = (*root..starts.len())
                .flat_map(|i| [0, 1, 2].map(|corner| (i, corner)))
                .map(|(i, corner)| (starts[i][corner] as usize, HalfedgeId::of(attachments[i].face, corner)))
                .find(|&(step, side)| range.contains(&step) && steps[step].side == side);
            if let Some((first, _)) = first {
                steps[range.clone()].rotate_left(first - range.start);
            }
        }
        Self { steps, loops: roots.into_iter().map(|(_, range)| range).collect() }
    }

    /// The step after one.
    fn next(&self, step: usize) -> usize {
        let range = &self.loops[self.loops.partition_point(|range| range.end <= step)];
        if step + 1 == range.end { range.start } else { step + 1 }
    }

    /// The edges of the border.
    pub(super) fn edges(
        &self,
        mesh: &SurfaceMesh,
        strip: StripId,
        places: &[FacePlace],
        planar: &Planar,
    ) -> Vec<BorderEdge> {
        let side = |i: usize| self.steps.get(i).map(|step| step.side);
        let place = |side: HalfedgeId| Some(places[mesh.topology().twin(side)?.face().index()]);
        parallel::map(self.steps.len(), |i| {
            side(i + 3 * AHEAD).into_iter().for_each(|side| mesh.topology().fetch_twin(side));
            if let Some(twin) = side(i + 2 * AHEAD).and_then(|side| mesh.topology().twin(side)) {
                prefetch_index(places, twin.face().index());
            }
            if let Some(place) = side(i + AHEAD).and_then(place) {
                prefetch_index(&planar.corners, place.index as usize);
            }
            let Step { side, from } = self.steps[i];
            let to = self.steps[self.next(i)].from;
            let twin = mesh.topology().twin(side).map_or(Twin::MeshBorder, |twin| {
                let place = places[twin.face().index()];
                if place.strip == strip {
                    let (to, from) = planar.ends(3 * place.index + twin.corner() as u32);
                    Twin::SameStrip { from, to }
                } else {
                    Twin::OtherStrip(place.strip)
                }
            });
            BorderEdge { halfedge: side, from, to, twin }
        })
    }

    /// What is left of the border, whose edges are given, when edges that coincide with their copies are none.
    pub(super) fn without_closed(
        self,
        mesh: &SurfaceMesh,
        places: &[FacePlace],
        edges: Vec<BorderEdge>,
    ) -> (Vec<BorderEdge>, Vec<Range<usize>>) {
        let is_closed = |i: usize| {
            let edge = edges[i];
            matches!(edge.twin, Twin::SameStrip { from, to } if (from, to) == (edge.from, edge.to))
        };
        let closed = parallel::map_chunks(edges.len(), PIECE, |piece| {
            let closed = piece.filter(|&i| is_closed(i)).map(|i| (edges[i].halfedge, i));
            closed.collect::<Vec<_>>()
        });
        let mut closed = closed.concat();
        if closed.is_empty() {
            // Vertices may coincide though no edge does.
            return (edges, self.loops);
        }
        closed.sort_unstable();
        let copy = |i: usize| {
            let twin = mesh.topology().twin(edges[i].halfedge)?;
            closed.binary_search_by_key(&twin, |edge| edge.0).ok().map(|found| closed[found].1)
        };
        let number = |i: u32| {
            let side = edges[i as usize].halfedge;
            (places[side.face().index()].index, side.corner())
        };
        let mut left = vec![true; edges.len()];
        closed.iter().for_each(|edge| left[edge.1] = false);
        let mut order: Vec<u32> = Vec::with_capacity(edges.len());
        let mut loops: Vec<Range<usize>> = Vec::new();
        for first in 0..edges.len() {
            let start = order.len();
            let mut i = first;
            while left[i] {
                left[i] = false;
                order.push(i as u32);
                i = self.next(i);
                // Across edges that are none.
                while let Some(copy) = Some(i).filter(|&i| is_closed(i)).and_then(copy) {
                    i = self.next(copy);
                }
            }
            let around = &mut order[start..];
            // The first edge of all is the smallest; else all must be looked at, which lie anywhere.
            let smallest = match around {
                [] => continue,
                [0, ..] if self.loops.len() == 1 => 0,
                _ => (1..around.len())
                    .fold(0, |m, k| if number(around[k]) < number(around[m]) { k } else { m }),
            };
            around.rotate_left(smallest);
            loops.push(start..order.len());
        }
        loops.sort_unstable_by_key(|range| number(order[range.start]));
        let mut rest = Vec::with_capacity(order.len());
        for range in &mut loops {
            let start = rest.len();
            rest.extend(order[range.clone()].iter().map(|&i| edges[i as usize]));
            *range = start..rest.len();
        }
        (rest, loops)
    }
}

/// The edges when vertices are called by other names.
pub(super) fn rename(edges: &mut [BorderEdge], names: &[u32]) {
    let name = |v: &mut u32| *v = names[*v as usize];
    parallel::change_chunks(edges, PIECE, |_, edges| {
        for edge in edges {
            name(&mut edge.from);
            name(&mut edge.to);
            if let Twin::SameStrip { from, to } = &mut edge.twin {
                name(from);
                name(to);
            }
        }
    });
}
