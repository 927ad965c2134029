//! What the pieces of cut faces have at their corners.

use std::ops::{Add, Mul};

use super::{CornerValues, MeshAttributes, Places};
use crate::ids::FaceId;
use crate::mesh::{FaceSource, SurfaceMesh};
use crate::sample::SurfacePoint;

/// A polygon on a face.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    pub(crate) face: FaceId,
    /// Its corners, in barycentric coordinates of the face.
    pub(crate) corners: Vec<[f64; 3]>,
}

impl MeshAttributes {
    /// The attributes of the soup that has these pieces of `mesh` as polygons, corner after corner. Every place keeps its
    /// values. Normals are those of the surface as it is now: turned where the mesh is, and there also where the file has
    /// none; between the corners of a face they are not of length 1, because then those between them would change.
    pub(crate) fn cut(&mut self, mesh: &SurfaceMesh, pieces: &[Piece]) {
        let places = Places::new(mesh, self);
        let mut normals = CornerValues::default();
        let mut corner = 0;
        for piece in pieces {
            for &barycentric in &piece.corners {
                let point = SurfacePoint { face: piece.face, barycentric };
                if let Some(normal) = places.mixed_normal(mesh, &point) {
                    let index = normals.extend([normal]);
                    normals.set(corner, index);
                }
                corner += 1;
            }
        }
        let sources = mesh.sources();
        self.normals = normals;
        self.colors = self.colors.cut(sources, pieces);
        self.uv.iter_mut().for_each(|uv| *uv = uv.cut(sources, pieces));
        self.numbers.iter_mut().for_each(|(_, numbers)| *numbers = numbers.cut(sources, pieces));
        let polygons: Vec<usize> =
            pieces.iter().map(|piece| sources[piece.face.index()].polygon.index()).collect();
        self.select_polygons(&polygons);
    }
}

impl<T: Copy + Add<Output = T> + Mul<f64, Output = T>> CornerValues<T> {
    fn cut(&self, sources: &[FaceSource], pieces: &[Piece]) -> Self {
        let mut cut = Self::default();
        let mut corner = 0;
        for piece in pieces {
            for &barycentric in &piece.corners {
                if let Some(value) = self.at(sources[piece.face.index()].corners, barycentric) {
                    let index = cut.extend([value]);
                    cut.set(corner, index);
                }
                corner += 1;
            }
        }
        cut
    }
}
