//! The border of a strip: its edges in ordered loops, and where each cut edge lies a second time.

use std::ops::Range;

use super::lay::{Link, NEXT, Planar};
use super::{BorderEdge, FacePlace, Twin};
use crate::ids::{HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// So many edges are changed together.
const PIECE: usize = 1 << 12;

/// The sides in the border, loop after loop, and where the loops lie among them.
pub(super) struct Loops {
    sides: Vec<u32>,
    pub(super) loops: Vec<Range<usize>>,
}

impl Loops {
    /// The way around a tree of triangles, along all sides but those at which one hangs on another: it has as many sides
    /// behind a triangle's side as those that hang there have together. Linear time.
    pub(super) fn around(links: &[Link]) -> Self {
        // How many sides the way has behind each side; itself if nothing hangs there.
        let mut lengths = vec![[1_u32; 3]; links.len()];
        for (i, link) in links.iter().enumerate().rev() {
            if let Some(on) = link.on() {
                // All but the side that is attached.
                lengths[on as usize / 3][on as usize % 3] = lengths[i].iter().sum::<u32>() - 1;
            }
        }
        // The lengths give way to where the sides lie.
        let mut starts = lengths;
        let mut sides = Vec::new();
        let mut loops = Vec::new();
        for (i, link) in links.iter().enumerate() {
            let side = |corner: usize| 3 * i as u32 + corner as u32;
            // Where a triangle hangs its own sides, which come later, take the place.
            if let Some(on) = link.on() {
                let (one, other) = (NEXT[link.corner()], NEXT[NEXT[link.corner()]]);
                let start = starts[on as usize / 3][on as usize % 3];
                let middle = start + starts[i][one];
                starts[i][one] = start;
                starts[i][other] = middle;
                sides[start as usize] = side(one);
                sides[middle as usize] = side(other);
            } else {
                let start = sides.len();
                for corner in 0..3 {
                    let length = starts[i][corner] as usize;
                    starts[i][corner] = sides.len() as u32;
                    sides.resize(sides.len() + length, side(corner));
                }
                loops.push(start..sides.len());
            }
        }
        for range in &loops {
            let around = &mut sides[range.clone()];
            if let Some((first, _)) = around.iter().enumerate().min_by_key(|(_, side)| **side) {
                around.rotate_left(first);
            }
        }
        Self { sides, loops }
    }

    /// The edges of the border.
    pub(super) fn edges(
        &self,
        mesh: &SurfaceMesh,
        strip: StripId,
        places: &[FacePlace],
        planar: &Planar,
    ) -> Vec<BorderEdge> {
        parallel::map(self.sides.len(), |i| {
            let side = self.sides[i];
            let (from, to) = planar.ends(side);
            let halfedge = HalfedgeId::of(planar.faces[side as usize / 3], side as usize % 3);
            let twin = mesh.topology().twin(halfedge).map_or(Twin::MeshBorder, |twin| {
                let place = places[twin.face().index()];
                if place.strip == strip {
                    let (to, from) = planar.ends(3 * place.index + twin.corner() as u32);
                    Twin::SameStrip { from, to }
                } else {
                    Twin::OtherStrip(place.strip)
                }
            });
            BorderEdge { halfedge, from, to, twin }
        })
    }

    /// What is left of the border, whose edges are given, when edges that coincide with their copies are none.
    pub(super) fn without_closed(
        self,
        mesh: &SurfaceMesh,
        edges: &[BorderEdge],
    ) -> (Vec<BorderEdge>, Vec<Range<usize>>) {
        let is_closed = |i: usize| {
            let edge = edges[i];
            matches!(edge.twin, Twin::SameStrip { from, to } if (from, to) == (edge.from, edge.to))
        };
        let mut closed: Vec<_> =
            (0..edges.len()).filter(|&i| is_closed(i)).map(|i| (edges[i].halfedge, i)).collect();
        closed.sort_unstable();
        let copy = |i: usize| {
            let twin = mesh.topology().twin(edges[i].halfedge)?;
            closed.binary_search_by_key(&twin, |edge| edge.0).ok().map(|found| closed[found].1)
        };
        let next = |i: usize| {
            let range = &self.loops[self.loops.partition_point(|range| range.end <= i)];
            if i + 1 == range.end { range.start } else { i + 1 }
        };
        let mut left: Vec<bool> = (0..edges.len()).map(|i| !is_closed(i)).collect();
        let mut loops = Vec::new();
        for first in 0..edges.len() {
            let mut around = Vec::new();
            let mut i = first;
            while left[i] {
                left[i] = false;
                around.push(i);
                i = next(i);
                // Across edges that are none.
                while let Some(copy) = Some(i).filter(|&i| is_closed(i)).and_then(copy) {
                    i = next(copy);
                }
            }
            if let Some((smallest, _)) = around.iter().enumerate().min_by_key(|(_, i)| self.sides[**i]) {
                around.rotate_left(smallest);
                loops.push(around);
            }
        }
        loops.sort_unstable_by_key(|around| self.sides[around[0]]);
        let mut start = 0;
        let ranges = loops.iter().map(|around| {
            start += around.len();
            start - around.len()..start
        });
        let ranges = ranges.collect();
        (loops.into_iter().flatten().map(|i| edges[i]).collect(), ranges)
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
