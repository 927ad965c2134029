//! Unfolding (paper, 4.1): segments laid congruently in the plane.

mod border;
mod lay;
mod seams;

use std::ops::Range;

use glam::DVec2;

use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::SurfacePoint;
use crate::segment::{Segment, Segmentation};
use border::Loops;
use lay::{Links, Planar};

/// What lies on the other side of a border edge of a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twin {
    /// Nothing: the surface ends here.
    MeshBorder,
    /// A face of another strip.
    OtherStrip(StripId),
    /// A face of the same strip: the cut edge lies in the plane a second time, between these planar vertices
    /// (`from` is the copy of the border edge's own `from`).
    SameStrip {
        /// The copy of the edge's start.
        from: u32,
        /// The copy of the edge's end.
        to: u32,
    },
}

/// An edge of a strip's border, directed so that the strip lies to its left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BorderEdge {
    /// The side of the face that lies along it.
    pub halfedge: HalfedgeId,
    /// The planar vertex at which it starts.
    pub from: u32,
    /// The planar vertex at which it ends.
    pub to: u32,
    /// What lies on the other side.
    pub twin: Twin,
}

/// A segment laid in the plane; each triangle is congruent to its original. A strip may overlap itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// The faces, in the order of the segment's attachments.
    pub faces: Vec<FaceId>,
    /// For each of `faces` the planar vertices of its corners, counterclockwise.
    pub corners: Vec<[u32; 3]>,
    /// The planar vertices, in units of the mesh. The box around them starts at (0, 0).
    pub vertices: Vec<DVec2>,
    /// The border edges, loop after loop, each loop in order.
    pub border: Vec<BorderEdge>,
    /// Where each border loop lies in `border`.
    pub loops: Vec<Range<usize>>,
    /// The area: that of its faces.
    pub area: f64,
    /// The upper right corner of the box around it.
    pub extent: DVec2,
}

/// Where a face lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FacePlace {
    /// Its strip.
    pub strip: StripId,
    /// Its place in [`Strip::faces`].
    pub index: u32,
}

/// All strips of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Strips {
    /// The strips; the index is the [`StripId`].
    pub strips: Vec<Strip>,
    /// For each face of the mesh where it lies.
    pub places: Vec<FacePlace>,
}

impl Strip {
    /// The length of a border edge in the plane.
    pub fn border_length(&self, edge: &BorderEdge) -> f64 {
        self.vertices[edge.from as usize].distance(self.vertices[edge.to as usize])
    }

    /// How far apart the two copies of a cut edge lie, measured at its ends; infinite where there is no second
    /// copy in this strip.
    pub fn gap(&self, edge: &BorderEdge) -> f64 {
        match edge.twin {
            Twin::SameStrip { from, to } => {
                let at = |v: u32| self.vertices[v as usize];
                at(edge.from).distance(at(from)).max(at(edge.to).distance(at(to)))
            }
            Twin::MeshBorder | Twin::OtherStrip(_) => f64::INFINITY,
        }
    }

    /// Whether the distribution is broken at a border edge: its gap is wider than `tolerance`.
    pub fn is_open(&self, edge: &BorderEdge, tolerance: f64) -> bool {
        self.gap(edge) > tolerance
    }

    /// The corners of its `index`-th face in the plane.
    #[inline]
    pub fn triangle(&self, index: usize) -> [DVec2; 3] {
        // `map` of an array is not made one with what is around it.
        let [a, b, c] = self.corners[index];
        [self.vertices[a as usize], self.vertices[b as usize], self.vertices[c as usize]]
    }
}

impl Strips {
    /// The strip that holds a surface point and where it lies in it.
    pub fn lay_point(&self, point: &SurfacePoint) -> (StripId, DVec2) {
        let place = self.places[point.face.index()];
        let [a, b, c] = self.strips[place.strip.index()].triangle(place.index as usize);
        let [u, v, w] = point.barycentric;
        (place.strip, a * u + b * v + c * w)
    }

    /// The length of all border edges whose gap is wider than `tolerance`.
    pub fn open_border_length(&self, tolerance: f64) -> f64 {
        self.strips
            .iter()
            .flat_map(|s| {
                s.border.iter().filter(move |e| s.is_open(e, tolerance)).map(move |e| s.border_length(e))
            })
            .sum()
    }
}

/// Lays every segment in the plane, each triangle congruent to its original. Linear time.
///
/// The corners of a triangle are computed from its own shape in space and the edge it is attached to, so edge
/// lengths are off by a few rounding errors of the strip's extent however long the chain of triangles is.
pub fn unfold(mesh: &SurfaceMesh, segmentation: &Segmentation) -> Strips {
    let mut places = vec![FacePlace { strip: StripId(0), index: 0 }; mesh.face_count()];
    for (s, segment) in segmentation.segments.iter().enumerate() {
        for (i, attachment) in segment.attachments.iter().enumerate() {
            places[attachment.face.index()] = FacePlace { strip: StripId::new(s), index: i as u32 };
        }
    }
    let strips = parallel::map(segmentation.segments.len(), |s| {
        lay_strip(mesh, StripId::new(s), &segmentation.segments[s], &places)
    });
    Strips { strips, places }
}

fn lay_strip(mesh: &SurfaceMesh, strip: StripId, segment: &Segment, places: &[FacePlace]) -> Strip {
    let links = Links::new(mesh, segment, places);
    // The way along the border does not depend on where triangles lie, unless edges coincide.
    let (mut planar, border) =
        parallel::join(|| lay::lay(mesh, segment, &links), || Loops::around(segment, &links));
    drop(links);
    let mut edges = border.edges(mesh, strip, places, &planar);
    let (border, loops) = match seams::coincident(&planar.vertices, &edges) {
        None => (edges, border.loops),
        Some(first) => {
            planar.rename(&first);
            border::rename(&mut edges, &first);
            border.without_closed(mesh, places, edges)
        }
    };
    let extent = lay::settle(&mut planar.vertices);
    let Planar { faces, corners, vertices, area } = planar;
    Strip { faces, corners, vertices, border, loops, area, extent }
}
