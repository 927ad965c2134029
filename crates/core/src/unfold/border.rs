//! The border of a strip: its edges in ordered loops, and where each cut edge lies a second time.

use super::lay::Planar;
use super::{BorderEdge, FacePlace, Strip, Twin};
use crate::ids::{HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;

/// Finds the border loops and puts the strip together. `twins` holds, for each side, the same edge in the same strip.
/// Linear time.
pub(super) fn strip(
    mesh: &SurfaceMesh,
    strip: StripId,
    places: &[FacePlace],
    planar: Planar,
    twins: &[Option<u32>],
) -> Strip {
    let reversed = |(from, to)| (to, from);
    // Which sides lie in the border and in no loop yet.
    let mut left: Vec<bool> = (0u32..)
        .zip(twins)
        .map(|(side, twin)| twin.is_none_or(|twin| planar.ends(side) != reversed(planar.ends(twin))))
        .collect();
    let in_border = left.clone();
    let halfedge = |side: u32| HalfedgeId::of(planar.faces[side as usize / 3], side as usize % 3);
    let behind = |side: u32| match twins[side as usize] {
        Some(twin) => {
            let (to, from) = planar.ends(twin);
            Twin::SameStrip { from, to }
        }
        None => match mesh.topology().twin(halfedge(side)) {
            Some(twin) if places[twin.face().index()].strip != strip => {
                Twin::OtherStrip(places[twin.face().index()].strip)
            }
            _ => Twin::MeshBorder,
        },
    };
    let mut border = Vec::new();
    let mut loops = Vec::new();
    for first in 0..twins.len() as u32 {
        let start = border.len();
        let mut side = first;
        while left[side as usize] {
            left[side as usize] = false;
            let (from, to) = planar.ends(side);
            border.push(BorderEdge { halfedge: halfedge(side), from, to, twin: behind(side) });
            // The next one: turn around the end of this one, across the edges inside the strip.
            side = next(side);
            while let Some(twin) = twins[side as usize].filter(|_| !in_border[side as usize]) {
                side = next(twin);
            }
        }
        if border.len() > start {
            loops.push(start..border.len());
        }
    }
    let Planar { faces, corners, vertices } = planar;
    let area = faces.iter().map(|&f| mesh.face_area(f)).sum();
    let extent = vertices.iter().fold(glam::DVec2::ZERO, |m, &v| m.max(v));
    Strip { faces, corners, vertices, border, loops, area, extent }
}

/// The next side of the same face.
fn next(side: u32) -> u32 {
    if side % 3 == 2 { side - 2 } else { side + 1 }
}
