//! Beyond the paper: segments that stayed small because all their neighbours were taken join one of them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{Attachment, Segment};
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::SurfaceMesh;

/// Joins every segment of fewer than `smallest` triangles to the neighbour across its flattest border edge, the
/// smallest first. A segment without neighbours stays.
pub(super) fn merge_small(mesh: &SurfaceMesh, segments: Vec<Segment>, smallest: usize) -> Vec<Segment> {
    let mut owner = vec![0u32; mesh.face_count()];
    for (s, segment) in (0..).zip(&segments) {
        for attachment in &segment.attachments {
            owner[attachment.face.index()] = s;
        }
    }
    let mut small: Vec<usize> =
        (0..segments.len()).filter(|&s| segments[s].attachments.len() < smallest).collect();
    small.sort_by_key(|&s| segments[s].attachments.len());
    let mut segments = segments;
    for s in small {
        // It may have grown by others that joined it.
        if segments[s].attachments.len() >= smallest {
            continue;
        }
        let Some(entry) = flattest_exit(mesh, &owner, &segments[s]) else { continue };
        let Some(twin) = mesh.topology().twin(entry) else { continue };
        let target = owner[twin.face().index()] as usize;
        let joined = hung_from(mesh, &owner, entry);
        for attachment in &joined {
            owner[attachment.face.index()] = target as u32;
        }
        segments[s].attachments.clear();
        segments[target].attachments.extend(joined);
    }
    segments.retain(|s| !s.attachments.is_empty());
    segments
}

fn bend(mesh: &SurfaceMesh, a: FaceId, b: FaceId) -> f64 {
    mesh.face_normal(a).distance_squared(mesh.face_normal(b))
}

/// The side of one of the segment's faces across which the surface goes on most evenly into another segment.
fn flattest_exit(mesh: &SurfaceMesh, owner: &[u32], segment: &Segment) -> Option<HalfedgeId> {
    segment
        .attachments
        .iter()
        .flat_map(|a| (0..3).map(|c| HalfedgeId::of(a.face, c)))
        .filter_map(|h| {
            let neighbour = mesh.topology().twin(h)?.face();
            (owner[neighbour.index()] != owner[h.face().index()])
                .then(|| (bend(mesh, h.face(), neighbour), h))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
        .map(|(_, h)| h)
}

/// The faces of the segment that `entry` belongs to, attached anew from `entry` on, flattest first.
fn hung_from(mesh: &SurfaceMesh, owner: &[u32], entry: HalfedgeId) -> Vec<Attachment> {
    let own = owner[entry.face().index()];
    let mut reached = std::collections::BTreeSet::new();
    let mut frontier = BinaryHeap::from([Reverse((0u64, entry))]);
    let mut joined = Vec::new();
    while let Some(Reverse((_, across))) = frontier.pop() {
        let face = across.face();
        if !reached.insert(face) {
            continue;
        }
        joined.push(Attachment { face, across: Some(across) });
        for c in 0..3 {
            let Some(twin) = mesh.topology().twin(HalfedgeId::of(face, c)) else { continue };
            let neighbour = twin.face();
            if owner[neighbour.index()] == own && !reached.contains(&neighbour) {
                frontier.push(Reverse((bend(mesh, face, neighbour).to_bits(), twin)));
            }
        }
    }
    joined
}
