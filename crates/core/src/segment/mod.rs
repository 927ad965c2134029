//! Segmentation (paper, 4.1): which triangles form a segment, joined across which edges.

mod growth;
mod merge;
mod seeds;
mod skeleton;

use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use growth::Growth;
use merge::merge_small;
use seeds::Seeds;
use skeleton::skeleton;

/// In which order the neighbours of a growing segment are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum GrowthOrder {
    /// The paper's: along the boundary, first in, first out.
    BoundaryWalk,
    /// The smallest angle between the normals first.
    #[default]
    FlattestFirst,
    /// The longest edge first.
    LongestFirst,
}

/// How the surface is cut into segments.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SegmentOptions {
    /// The largest angle between the normals of neighbours, in radians, that counts as almost flat. Larger gives
    /// fewer, larger segments. Default: 60 degrees.
    pub flatness_angle: f64,
    /// Segments with fewer triangles than this share of all go on growing whatever the angle (paper, 4.1 step 4), and
    /// with [`GrowthOrder::FlattestFirst`] join a neighbour when they cannot grow. Default: 0.002.
    pub smallest_share: f64,
    /// In which order a segment grows. Default: flattest first, which measures best.
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

/// Cuts the surface into segments (paper, 4.1 steps 1 to 5). Every face ends up in exactly one segment.
///
/// Cost: O(F log F) for F faces.
pub fn segment(mesh: &SurfaceMesh, options: &SegmentOptions) -> Segmentation {
    let mut seeds = Seeds::new(mesh);
    let mut growth = Growth::new(mesh, options);
    let smallest = (options.smallest_share * mesh.face_count() as f64).ceil() as usize;
    let mut segments = Vec::new();
    while let Some(seed) = seeds.next(&growth) {
        growth.start_segment();
        match options.order {
            GrowthOrder::BoundaryWalk | GrowthOrder::LongestFirst => skeleton(&mut growth, seed),
            // A skeleton along long edges crosses creases, which is what flattest first is there to avoid.
            GrowthOrder::FlattestFirst => growth.plant(seed.face()),
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
    if options.order == GrowthOrder::FlattestFirst {
        segments = merge_small(mesh, segments, smallest);
    }
    Segmentation { segments }
}
