//! Segmentation (paper, 4.1): which triangles form a segment, joined across which edges.

mod choice;
mod fitting;
mod frontier;
mod growth;
mod merge;
mod planar;
mod rehang;
mod seeds;
mod skeleton;

use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use growth::{Growth, Next};
use merge::merge_small;
use rehang::rehang;
use seeds::Seeds;
use skeleton::skeleton;

/// In which order the neighbours of a growing segment are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum GrowthOrder {
    /// The one that opens the least border in the plane first; several ways to break ties, and the other orders, are
    /// tried, and each component takes the one that leaves the least border open.
    #[default]
    LeastOpen,
    /// As [`LeastOpen`](Self::LeastOpen), then parts of up to 300 triangles are hung elsewhere as long as that shortens the
    /// open border: by a tenth to a half on what was tried. On one core, in up to 25 times the time.
    Rehung,
    /// The paper's: along the boundary, first in, first out.
    BoundaryWalk,
    /// The smallest angle between the normals first.
    FlattestFirst,
    /// The longest edge first.
    LongestFirst,
}

/// How the surface is cut into segments.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SegmentOptions {
    /// The largest angle between the normals of neighbours, in radians, that counts as almost flat. Larger gives
    /// fewer, larger segments. Default: 60 degrees.
    pub flatness_angle: f64,
    /// Segments with fewer triangles than this share of all go on growing whatever the angle (paper, 4.1 step 4), and
    /// with [`GrowthOrder::FlattestFirst`] join a neighbour when they cannot grow. Default: 0.002.
    pub smallest_share: f64,
    /// In which order a segment grows. Default: what leaves the least border open.
    pub order: GrowthOrder,
}

impl Default for SegmentOptions {
    fn default() -> Self {
        Self { flatness_angle: 60.0_f64.to_radians(), smallest_share: 0.002, order: GrowthOrder::default() }
    }
}

/// A triangle of a segment and the edge across which it joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// The triangle.
    pub face: FaceId,
    /// The side of `face` whose twin belongs to an earlier triangle of the segment; `None` for the first one.
    pub across: Option<HalfedgeId>,
}

/// A connected set of triangles with a spanning tree: each triangle comes after the one it is attached to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Segment {
    /// The triangles in the order in which they joined.
    pub attachments: Vec<Attachment>,
}

/// Every face of the mesh in exactly one segment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Segmentation {
    /// The segments; the index is the [`StripId`].
    pub segments: Vec<Segment>,
}

impl Segmentation {
    /// The segment of every face.
    pub fn segment_of_face(&self, face_count: usize) -> Vec<StripId> {
        let mut of_face = vec![StripId(0); face_count];
        for (s, segment) in self.segments.iter().enumerate() {
            for attachment in &segment.attachments {
                of_face[attachment.face.index()] = StripId::new(s);
            }
        }
        of_face
    }
}

/// Cuts the surface into segments (paper, 4.1 steps 1 to 5). Every face ends up in exactly one segment. What is best is
/// judged as for 1,000 points: see [`segment_for`].
///
/// Cost: O(F log F) for F faces.
pub fn segment(mesh: &SurfaceMesh, options: &SegmentOptions) -> Segmentation {
    segment_for(mesh, options, 0.1 * libm::sqrt(mesh.area() / 1000.0))
}

/// As [`segment`], for a correction that closes cuts up to `tolerance` wide (in units of the mesh): only
/// [`GrowthOrder::LeastOpen`] and [`GrowthOrder::Rehung`] look at it.
pub fn segment_for(mesh: &SurfaceMesh, options: &SegmentOptions, tolerance: f64) -> Segmentation {
    match options.order {
        GrowthOrder::LeastOpen => choice::least_open(mesh, options, tolerance),
        GrowthOrder::Rehung => rehang(mesh, choice::least_open(mesh, options, tolerance), tolerance),
        GrowthOrder::BoundaryWalk => grow(mesh, options, Next::Oldest),
        GrowthOrder::FlattestFirst => grow(mesh, options, Next::Flattest),
        GrowthOrder::LongestFirst => grow(mesh, options, Next::Longest),
    }
}

/// Grows segments by the angle between neighbours (paper, 4.1 steps 1 to 5).
fn grow(mesh: &SurfaceMesh, options: &SegmentOptions, next: Next) -> Segmentation {
    let mut seeds = Seeds::new(mesh);
    let mut growth = Growth::new(mesh, options, next);
    let smallest = (options.smallest_share * mesh.face_count() as f64).ceil() as usize;
    let mut segments = Vec::new();
    while let Some(seed) = seeds.next(&growth) {
        growth.start_segment();
        match next {
            Next::Oldest | Next::Longest => skeleton(&mut growth, seed),
            // A skeleton along long edges crosses creases, which is what flattest first is there to avoid.
            Next::Flattest => growth.plant(seed.face()),
        }
        growth.grow_flat();
        growth.take_leftovers();
        while growth.size() < smallest && growth.grow_ring() {
            growth.grow_flat();
            growth.take_leftovers();
        }
        let segment = growth.finish_segment();
        seeds.save_border(mesh, &growth, &segment);
        segments.push(segment);
    }
    if next == Next::Flattest {
        segments = merge_small(mesh, segments, smallest);
    }
    Segmentation { segments }
}

#[cfg(test)]
mod tests;
