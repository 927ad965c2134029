//! The checked surface: triangles with positive area, joined across their edges. Immutable.

use glam::DVec3;
use prefetch_index::prefetch_index;

use crate::geometry::triangle;
use crate::ids::{FaceId, HalfedgeId, PolygonId, VertexId};
use crate::mesh::topology::Topology;
use crate::parallel;
use crate::sample::SurfacePoint;

/// Where a triangle of the checked mesh came from in the soup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceSource {
    /// The polygon.
    pub polygon: PolygonId,
    /// For each corner of the triangle its place in [`PolygonSoup::corners`](crate::PolygonSoup::corners).
    pub corners: [u32; 3],
    /// Whether the triangle is wound against its polygon, because its component was turned outward.
    pub turned: bool,
}

/// A checked triangle surface; made by [`SurfaceMesh::from_soup`]. Every coordinate is finite and every face has
/// positive area; borders, several components and any genus are allowed.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMesh {
    positions: Vec<DVec3>,
    topology: Topology,
    sources: Vec<FaceSource>,
    areas: Vec<f64>,
    normals: Vec<DVec3>,
    area: f64,
}

impl SurfaceMesh {
    /// Puts checked parts together. The caller has made sure that indices are in range, coordinates finite and
    /// areas positive.
    pub(crate) fn assemble(positions: Vec<DVec3>, topology: Topology, sources: Vec<FaceSource>) -> Self {
        let (areas, normals) = parallel::map_pairs(topology.face_count(), |face| {
            let [a, b, c] = topology.faces()[face];
            let [a, b, c] = [positions[a.index()], positions[b.index()], positions[c.index()]];
            let vector = triangle::area_vector(a, b, c);
            let length = vector.length();
            (0.5 * length, vector / length)
        });
        Self::measured(positions, topology, sources, areas, normals)
    }

    /// As [`assemble`](Self::assemble), when the areas and unit normals of the faces are known.
    pub(crate) fn measured(
        positions: Vec<DVec3>,
        topology: Topology,
        sources: Vec<FaceSource>,
        areas: Vec<f64>,
        normals: Vec<DVec3>,
    ) -> Self {
        debug_assert!([sources.len(), areas.len(), normals.len()] == [topology.face_count(); 3]);
        let area = areas.iter().sum();
        Self { positions, topology, sources, areas, normals, area }
    }

    /// Vertex positions, in the units of the input.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Which triangle lies beside which.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// How many vertices there are.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// How many triangles there are.
    pub fn face_count(&self) -> usize {
        self.areas.len()
    }

    /// The total area, in squared units of the input.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The area of each face.
    pub fn face_areas(&self) -> &[f64] {
        &self.areas
    }

    /// The area of a face.
    #[inline]
    pub fn face_area(&self, face: FaceId) -> f64 {
        self.areas[face.index()]
    }

    /// The outward unit normal of a face.
    #[inline]
    pub fn face_normal(&self, face: FaceId) -> DVec3 {
        self.normals[face.index()]
    }

    /// Where the faces came from in the soup.
    pub fn sources(&self) -> &[FaceSource] {
        &self.sources
    }

    /// The position of a vertex.
    #[inline]
    pub fn position(&self, vertex: VertexId) -> DVec3 {
        self.positions[vertex.index()]
    }

    /// Asks for the area of a face and the positions of its corners, so that they are under way while other work is done. Which
    /// corners it has should have been asked for before ([`Topology::fetch_corners`]): it is looked up here.
    #[inline]
    pub(crate) fn fetch(&self, face: FaceId) {
        prefetch_index(&self.areas, face.index());
        for vertex in self.topology.corners(face) {
            prefetch_index(&self.positions, vertex.index());
        }
    }

    /// The positions of a face's corners.
    #[inline]
    pub fn triangle(&self, face: FaceId) -> [DVec3; 3] {
        // `map` of an array is not made one with what is around it.
        let [a, b, c] = self.topology.corners(face);
        [self.position(a), self.position(b), self.position(c)]
    }

    /// The length of an edge.
    pub fn edge_length(&self, halfedge: HalfedgeId) -> f64 {
        let (a, b) = self.topology.ends(halfedge);
        self.position(a).distance(self.position(b))
    }

    /// The angle between the normals on the two sides of an edge, in radians: 0 where flat; `None` at the border.
    pub fn fold_angle(&self, halfedge: HalfedgeId) -> Option<f64> {
        let twin = self.topology.twin(halfedge)?;
        let (n, m) = (self.face_normal(halfedge.face()), self.face_normal(twin.face()));
        // atan2 keeps small angles exact where acos of the dot product loses them.
        Some(libm::atan2(n.cross(m).length(), n.dot(m)))
    }

    /// The place of a surface point in space.
    #[inline]
    pub fn locate(&self, point: &SurfacePoint) -> DVec3 {
        let [a, b, c] = self.triangle(point.face);
        triangle::at(a, b, c, point.barycentric)
    }

    /// The smallest and largest corner of the axis-parallel box around all faces.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for corner in self.topology.faces().iter().flatten() {
            let p = self.position(*corner);
            low = low.min(p);
            high = high.max(p);
        }
        (low, high)
    }

    /// The length of the diagonal of [`bounds`](Self::bounds): the size that tolerances are relative to.
    pub fn diagonal(&self) -> f64 {
        let (low, high) = self.bounds();
        low.distance(high)
    }
}
