//! Normals at the corners of faces, averaged around each vertex over the faces of one patch: smooth over a patch,
//! sharp between patches.

use std::collections::BTreeMap;

use glam::DVec3;

use super::patches::Patches;
use crate::ids::{FaceId, VertexId};
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// Which patches meet at a vertex.
#[derive(Clone, Copy, PartialEq)]
enum Around {
    Nothing,
    One(u32),
    Several,
}

/// The corners of the faces, one for each vertex and patch: first the vertices, for those that lie in one patch, then
/// those of vertices between patches.
pub(super) struct CornerNormals<'a> {
    mesh: &'a SurfaceMesh,
    patches: &'a Patches,
    /// Where there are several patches.
    around: Option<Vec<Around>>,
    /// The corners of vertices between patches, by vertex and patch.
    between: BTreeMap<(u32, u32), u32>,
    /// The vertices of those.
    vertices: Vec<u32>,
    /// Unit vectors; zero where faces that fold back cancel out.
    normals: Vec<DVec3>,
}

impl<'a> CornerNormals<'a> {
    pub(super) fn new(mesh: &'a SurfaceMesh, patches: &'a Patches) -> Self {
        let mut corners = Self {
            mesh,
            patches,
            around: (!patches.is_one()).then(|| around(mesh, patches)),
            between: BTreeMap::new(),
            vertices: Vec::new(),
            normals: vec![DVec3::ZERO; mesh.vertex_count()],
        };
        // First the sums, weighted by area.
        for face in mesh.topology().face_ids() {
            let Some(patch) = patches.of(face) else { continue };
            let weighted = mesh.face_normal(face) * mesh.face_area(face);
            for v in mesh.topology().corners(face) {
                if corners.is_between(v) {
                    let next = corners.normals.len() as u32;
                    let id = *corners.between.entry((v.0, patch)).or_insert(next);
                    if id == next {
                        corners.normals.push(DVec3::ZERO);
                        corners.vertices.push(v.0);
                    }
                    corners.normals[id as usize] += weighted;
                } else {
                    corners.normals[v.index()] += weighted;
                }
            }
        }
        const CHUNK: usize = 1 << 12;
        parallel::change_chunks(&mut corners.normals, CHUNK, |_, chunk| {
            chunk.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
        });
        corners
    }

    fn is_between(&self, vertex: VertexId) -> bool {
        self.around.as_ref().is_some_and(|around| around[vertex.index()] == Around::Several)
    }

    /// How many corners there are.
    pub(super) fn count(&self) -> usize {
        self.normals.len()
    }

    /// Gives the memory of the normals back.
    pub(super) fn give_back(&mut self) {
        self.normals = Vec::new();
    }

    /// The position of a corner.
    #[inline]
    pub(super) fn position(&self, id: u32) -> DVec3 {
        let (id, vertices) = (id as usize, self.mesh.vertex_count());
        self.mesh.positions()[if id < vertices { id } else { self.vertices[id - vertices] as usize }]
    }

    /// The unit normal of a corner; zero where faces that fold back cancel out.
    #[inline]
    pub(super) fn at(&self, id: u32) -> DVec3 {
        self.normals[id as usize]
    }

    /// The corners of a face.
    pub(super) fn ids(&self, face: FaceId) -> [u32; 3] {
        self.mesh.topology().corners(face).map(|v| match self.patches.of(face) {
            Some(patch) if self.is_between(v) => self.between.get(&(v.0, patch)).copied().unwrap_or(v.0),
            _ => v.0,
        })
    }
}

/// Which patches meet at each vertex.
fn around(mesh: &SurfaceMesh, patches: &Patches) -> Vec<Around> {
    let mut all = vec![Around::Nothing; mesh.vertex_count()];
    for face in mesh.topology().face_ids() {
        let Some(patch) = patches.of(face) else { continue };
        for v in mesh.topology().corners(face) {
            let around = &mut all[v.index()];
            *around = match *around {
                Around::Nothing => Around::One(patch),
                Around::One(p) if p == patch => Around::One(patch),
                Around::One(_) | Around::Several => Around::Several,
            };
        }
    }
    all
}
