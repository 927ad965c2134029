//! Normals at the corners of faces, averaged around each vertex over the faces of one patch: smooth over a patch,
//! sharp between patches.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;

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
    patch_of_face: &'a [Option<u32>],
    around: Vec<Around>,
    /// The corners of vertices between patches, by vertex and patch.
    between: BTreeMap<(u32, u32), u32>,
    /// The vertices of those.
    vertices: Vec<u32>,
    /// The sums of the normals, weighted by area.
    sums: Vec<DVec3>,
}

impl<'a> CornerNormals<'a> {
    pub(super) fn new(mesh: &'a SurfaceMesh, patch_of_face: &'a [Option<u32>]) -> Self {
        let mut around = vec![Around::Nothing; mesh.vertex_count()];
        for (corners, patch) in mesh.topology().faces().iter().zip(patch_of_face) {
            let Some(patch) = *patch else { continue };
            for v in corners {
                let around = &mut around[v.index()];
                *around = match *around {
                    Around::Nothing => Around::One(patch),
                    Around::One(p) if p == patch => Around::One(patch),
                    Around::One(_) | Around::Several => Around::Several,
                };
            }
        }
        let mut corners = Self {
            mesh,
            patch_of_face,
            around,
            between: BTreeMap::new(),
            vertices: Vec::new(),
            sums: vec![DVec3::ZERO; mesh.vertex_count()],
        };
        for face in mesh.topology().face_ids() {
            let Some(patch) = patch_of_face[face.index()] else { continue };
            let weighted = mesh.face_normal(face) * mesh.face_area(face);
            for v in mesh.topology().corners(face) {
                if corners.around[v.index()] == Around::Several {
                    let next = corners.sums.len() as u32;
                    let id = *corners.between.entry((v.0, patch)).or_insert(next);
                    if id == next {
                        corners.sums.push(DVec3::ZERO);
                        corners.vertices.push(v.0);
                    }
                    corners.sums[id as usize] += weighted;
                } else {
                    corners.sums[v.index()] += weighted;
                }
            }
        }
        corners
    }

    /// How many corners there are.
    pub(super) fn count(&self) -> usize {
        self.sums.len()
    }

    /// The vertex of a corner.
    pub(super) fn vertex(&self, id: usize) -> usize {
        let vertices = self.mesh.vertex_count();
        if id < vertices { id } else { self.vertices[id - vertices] as usize }
    }

    /// The unit normal of a corner; zero where faces that fold back cancel out.
    pub(super) fn at(&self, id: usize) -> DVec3 {
        self.sums[id].normalize_or_zero()
    }

    /// The corners of a face.
    pub(super) fn ids(&self, face: FaceId) -> [u32; 3] {
        let patch = self.patch_of_face[face.index()];
        self.mesh.topology().corners(face).map(|v| match (self.around[v.index()], patch) {
            (Around::Several, Some(patch)) => self.between.get(&(v.0, patch)).copied().unwrap_or(v.0),
            _ => v.0,
        })
    }
}
