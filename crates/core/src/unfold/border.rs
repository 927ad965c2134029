//! The border of a strip: its edges in ordered loops, and where each cut edge lies a second time.

use super::lay::{Planar, ends};
use super::{BorderEdge, FacePlace, Strip, Twin};
use crate::ids::{HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;

/// What lies on the other side of an edge; `None` for an edge inside the strip.
fn across(
    mesh: &SurfaceMesh,
    strip: StripId,
    places: &[FacePlace],
    corners: &[[u32; 3]],
    halfedge: HalfedgeId,
) -> Option<Twin> {
    let Some(twin) = mesh.topology().twin(halfedge) else { return Some(Twin::MeshBorder) };
    let place = places[twin.face().index()];
    if place.strip != strip {
        return Some(Twin::OtherStrip(place.strip));
    }
    let own = corners[places[halfedge.face().index()].index as usize];
    // The twin runs the other way.
    let (to, from) = ends(corners[place.index as usize], twin);
    (ends(own, halfedge) != (from, to)).then_some(Twin::SameStrip { from, to })
}

/// Finds the border loops and puts the strip together. Linear time.
pub(super) fn strip(mesh: &SurfaceMesh, strip: StripId, places: &[FacePlace], planar: Planar) -> Strip {
    let Planar { faces, corners, vertices } = planar;
    let twin_of = |halfedge| across(mesh, strip, places, &corners, halfedge);
    let mut border = Vec::new();
    let mut loops = Vec::new();
    let mut done = vec![false; faces.len() * 3];
    let slot = |h: HalfedgeId| places[h.face().index()].index as usize * 3 + h.corner();
    for &face in &faces {
        for corner in 0..3 {
            let first = HalfedgeId::of(face, corner);
            if done[slot(first)] || twin_of(first).is_none() {
                continue;
            }
            let start = border.len();
            let mut halfedge = first;
            while let Some(twin) = twin_of(halfedge).filter(|_| !done[slot(halfedge)]) {
                done[slot(halfedge)] = true;
                let (from, to) = ends(corners[slot(halfedge) / 3], halfedge);
                border.push(BorderEdge { halfedge, from, to, twin });
                halfedge = next_around(mesh, &twin_of, halfedge);
            }
            loops.push(start..border.len());
        }
    }
    let area = faces.iter().map(|&f| mesh.face_area(f)).sum();
    let extent = vertices.iter().fold(glam::DVec2::ZERO, |m, &v| m.max(v));
    Strip { faces, corners, vertices, border, loops, area, extent }
}

/// The border edge that follows: turn around the end of this one, across the edges inside the strip.
fn next_around(
    mesh: &SurfaceMesh,
    twin_of: &impl Fn(HalfedgeId) -> Option<Twin>,
    halfedge: HalfedgeId,
) -> HalfedgeId {
    let mut next = halfedge.next();
    while twin_of(next).is_none() {
        let Some(twin) = mesh.topology().twin(next) else { break };
        next = twin.next();
    }
    next
}
