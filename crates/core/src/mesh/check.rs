//! The check that turns a soup into a surface.

use crate::mesh::defect::{MeshError, RepairReport};
use crate::mesh::soup::PolygonSoup;
use crate::mesh::surface::SurfaceMesh;

/// What checking may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckOptions {
    /// Turn closed components that are wound inward outward. Default: true.
    pub turn_outward: bool,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self { turn_outward: true }
    }
}

impl SurfaceMesh {
    /// Checks a soup. STUB until the mesh branch lands.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn from_soup(soup: &PolygonSoup, options: &CheckOptions) -> Result<(Self, RepairReport), MeshError> {
        let _ = options;
        use crate::ids::*;
        use crate::mesh::surface::FaceSource;
        use crate::mesh::topology::Topology;
        let mut faces = Vec::new();
        let mut sources = Vec::new();
        for p in 0..soup.polygon_count() {
            let r = soup.corner_range(p);
            for i in 1..r.len() - 1 {
                let c = [r.start, r.start + i, r.start + i + 1];
                faces.push(c.map(|k| VertexId(soup.corners[k])));
                sources.push(FaceSource { polygon: PolygonId::new(p), corners: c.map(|k| k as u32) });
            }
        }
        let (topology, _) = Topology::new(soup.positions.len(), faces);
        Ok((Self::assemble(soup.positions.clone(), topology, sources), RepairReport::default()))
    }
}
