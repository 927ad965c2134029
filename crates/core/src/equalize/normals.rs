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

pub(super) struct CornerNormals<'a> {
    mesh: &'a SurfaceMesh,
    patch_of_face: &'a [Option<u32>],
    around: Vec<Around>,
    /// The normal of vertices that lie in one patch.
    inner: Vec<DVec3>,
    /// The normals of vertices between patches, by vertex and patch.
    between: BTreeMap<(u32, u32), DVec3>,
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
        let mut inner = vec![DVec3::ZERO; mesh.vertex_count()];
        let mut between = BTreeMap::new();
        for face in mesh.topology().face_ids() {
            let Some(patch) = patch_of_face[face.index()] else { continue };
            let weighted = mesh.face_normal(face) * mesh.face_area(face);
            for v in mesh.topology().corners(face) {
                match around[v.index()] {
                    Around::Several => *between.entry((v.0, patch)).or_insert(DVec3::ZERO) += weighted,
                    Around::One(_) | Around::Nothing => inner[v.index()] += weighted,
                }
            }
        }
        Self { mesh, patch_of_face, around, inner, between }
    }

    /// The unit normals at the corners of a face; its own where the mean is zero.
    pub(super) fn of(&self, face: FaceId) -> [DVec3; 3] {
        let own = self.mesh.face_normal(face);
        self.mesh.topology().corners(face).map(|v| {
            let sum = match (self.around[v.index()], self.patch_of_face[face.index()]) {
                (Around::Several, Some(patch)) => self.between.get(&(v.0, patch)).copied().unwrap_or(own),
                _ => self.inner[v.index()],
            };
            sum.try_normalize().unwrap_or(own)
        })
    }
}
