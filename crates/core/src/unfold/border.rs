//! The border of a strip: its edges in ordered loops, and where each cut edge lies a second time.

use std::ops::Range;

use super::lay::Planar;
use super::seams::Twins;
use super::{BorderEdge, FacePlace, Strip, Twin};
use crate::ids::{HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// Finds the loops of the sides that lie in the border and puts the strip together. Linear time.
pub(super) fn strip(
    mesh: &SurfaceMesh,
    strip: StripId,
    places: &[FacePlace],
    planar: Planar,
    twins: &Twins,
    in_border: Vec<[bool; 3]>,
) -> Strip {
    let (order, loops) = walk(twins, in_border);
    let border = parallel::map(order.len(), |i| {
        let side = order[i];
        let (from, to) = planar.ends(side);
        let halfedge = HalfedgeId::of(planar.faces[side as usize / 3], side as usize % 3);
        let twin = match twins.of(side) {
            Some(twin) => {
                let (to, from) = planar.ends(twin);
                Twin::SameStrip { from, to }
            }
            None => match mesh.topology().twin(halfedge) {
                Some(twin) if places[twin.face().index()].strip != strip => {
                    Twin::OtherStrip(places[twin.face().index()].strip)
                }
                _ => Twin::MeshBorder,
            },
        };
        BorderEdge { halfedge, from, to, twin }
    });
    let Planar { faces, corners, vertices } = planar;
    let area = faces.iter().map(|&f| mesh.face_area(f)).sum();
    let extent = vertices.iter().fold(glam::DVec2::ZERO, |m, &v| m.max(v));
    Strip { faces, corners, vertices, border, loops, area, extent }
}

/// The sides in the border, loop after loop, and where the loops lie among them.
fn walk(twins: &Twins, in_border: Vec<[bool; 3]>) -> (Vec<u32>, Vec<Range<usize>>) {
    // Which of them are in no loop yet.
    let mut left = in_border.clone();
    let in_border = in_border.as_flattened();
    let left = left.as_flattened_mut();
    let mut order = Vec::new();
    let mut loops = Vec::new();
    for first in 0..left.len() as u32 {
        let start = order.len();
        let mut side = first;
        while left[side as usize] {
            left[side as usize] = false;
            order.push(side);
            // The next one: turn around the end of this one, across the edges inside the strip.
            side = next(side);
            while let Some(twin) = twins.of(side).filter(|_| !in_border[side as usize]) {
                side = next(twin);
            }
        }
        if order.len() > start {
            loops.push(start..order.len());
        }
    }
    (order, loops)
}

/// The next side of the same face.
fn next(side: u32) -> u32 {
    if side % 3 == 2 { side - 2 } else { side + 1 }
}
