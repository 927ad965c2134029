//! Everything that can be wrong with a soup: what was repaired, and what cannot be.

/// What checking changed; all zero for a clean mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RepairReport {
    /// Vertices merged into an earlier one at exactly the same position.
    pub welded_vertices: usize,
    /// Vertices left out because no face that was kept uses them (after welding).
    pub isolated_vertices: usize,
    /// Polygons left out because they have fewer than three different corners.
    pub degenerate_polygons: usize,
    /// Polygons with more than three corners, cut into triangles.
    pub polygons_triangulated: usize,
    /// Those of them that were cut as a fan from their first corner, because they cross themselves or have no
    /// area in their best-fit plane.
    pub fanned_polygons: usize,
    /// Triangles left out because their area is zero to the rounding of their coordinates.
    pub zero_area_faces: usize,
    /// Triangles left out because an earlier one has the same three corners, in whatever order.
    pub duplicate_faces: usize,
    /// Edges of more than two triangles, made borders.
    pub non_manifold_edges: usize,
    /// Edges of two triangles wound against each other, made borders.
    pub inconsistent_edges: usize,
    /// Closed components that were wound inward and were turned.
    pub turned_components: usize,
}

impl RepairReport {
    /// Whether the soup was taken as it is, but for the cutting of its polygons into triangles.
    pub fn is_clean(&self) -> bool {
        *self == Self { polygons_triangulated: self.polygons_triangulated, ..Self::default() }
    }
}

/// Why a soup is not a surface. Vertices, polygons and corners count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There is no polygon.
    #[error("the mesh has no face: points are spread over faces, so export it with them")]
    NoFace,
    /// No polygon has an area.
    #[error(
        "none of the {polygons} faces of the mesh has an area beyond the rounding of its coordinates: look whether its \
         vertices all lie on a line, or move it nearer to the origin"
    )]
    NoArea {
        /// How many polygons there are.
        polygons: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is at ({:?}, {:?}, {:?}): every coordinate must be a finite number; repair the mesh or export it \
         again", .position[0], .position[1], .position[2])]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// A corner names a vertex that does not exist.
    #[error(
        "corner {corner} of face {polygon} is vertex {index}, but there are only {vertices} vertices (counted from 0): the file is \
         damaged or was written wrong; export it again"
    )]
    IndexOutOfRange {
        /// The polygon.
        polygon: usize,
        /// Which of its corners.
        corner: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// [`PolygonSoup::ends`](crate::PolygonSoup::ends) does not cut `corners` into polygons.
    #[error("the corners of face {polygon} end before they start, or where there is no corner")]
    BrokenEnds {
        /// The first polygon whose end is wrong; the number of polygons if corners are left over.
        polygon: usize,
    },
    /// More than 32-bit indices can count.
    #[error("the mesh has {count} {what}, but at most {limit} can be held: split it")]
    TooMany {
        /// What there is too much of: vertices, corners or triangles.
        what: &'static str,
        /// How many there are, at least.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// Areas and volumes would overflow.
    #[error(
        "vertex {vertex} has the coordinate {coordinate:e}, too large for areas to be computed: scale the mesh down"
    )]
    TooLarge {
        /// The vertex.
        vertex: usize,
        /// Its largest coordinate.
        coordinate: f64,
    },
    /// Areas and volumes would underflow.
    #[error("the mesh is only {size:e} units wide, too small for areas to be computed: scale it up")]
    TooSmall {
        /// The longest side of the box around the vertices.
        size: f64,
    },
}
