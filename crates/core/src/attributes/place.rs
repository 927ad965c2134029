//! Attributes at points of the checked surface.

use glam::{DVec2, DVec3, DVec4};

use super::texture::{Material, Tint};
use super::{CornerValues, MeshAttributes};
use crate::geometry::triangle;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::sample::SurfacePoint;

/// Looks attributes up at points of the surface that was made from the same soup.
#[derive(Clone, Debug)]
pub struct Places<'a> {
    attributes: &'a MeshAttributes,
    /// For each vertex of the mesh a normal; only where the file has none.
    vertex_normals: Option<Vec<DVec3>>,
}

impl<'a> Places<'a> {
    /// For the attributes of the file that `mesh` was made from. Linear time.
    pub fn new(mesh: &SurfaceMesh, attributes: &'a MeshAttributes) -> Self {
        let vertex_normals = attributes.normals.is_empty().then(|| vertex_normals(mesh));
        Self { attributes, vertex_normals }
    }

    /// The smooth unit normal: interpolated between the normals of the file, or, if the file has none, between those of
    /// the vertices, for which the normals of the faces around are weighted with their angles (Thuermer and Wuethrich
    /// 1998, doi:10.1080/10867651.1998.10487494). The normal of the face where the file leaves corners without, or
    /// where they cancel out. Components that the check turned outward have their normals turned too.
    pub fn normal(&self, mesh: &SurfaceMesh, point: &SurfacePoint) -> DVec3 {
        let normal = self.mixed_normal(mesh, point);
        normal.and_then(DVec3::try_normalize).unwrap_or_else(|| mesh.face_normal(point.face))
    }

    /// What lies between the normals of the corners, of any length; `None` where a corner has none.
    pub(super) fn mixed_normal(&self, mesh: &SurfaceMesh, point: &SurfacePoint) -> Option<DVec3> {
        let source = &mesh.sources()[point.face.index()];
        match &self.vertex_normals {
            Some(normals) => {
                let [a, b, c] = mesh.topology().corners(point.face).map(|v| normals[v.index()]);
                Some(triangle::at(a, b, c, point.barycentric))
            }
            None => {
                let normal = self.attributes.normals.at(source.corners, point.barycentric);
                normal.map(|n| if source.turned { -n } else { n })
            }
        }
    }

    /// The texture coordinates of the first set, origin at the lower left of the picture.
    pub fn uv(&self, mesh: &SurfaceMesh, point: &SurfacePoint) -> Option<DVec2> {
        self.uv_of_set(mesh, point, 0)
    }

    fn uv_of_set(&self, mesh: &SurfaceMesh, point: &SurfacePoint, set: usize) -> Option<DVec2> {
        at(self.attributes.uv.get(set)?, mesh, point)
    }

    /// The colour between the corners, linear.
    pub fn vertex_color(&self, mesh: &SurfaceMesh, point: &SurfacePoint) -> Option<DVec4> {
        at(&self.attributes.colors, mesh, point)
    }

    /// The base colour, linear: the factor of the material times its texture; [`Tint`] says what the colours at the
    /// corners do to it. Without a material the colours at the corners; `None` where there are none either.
    pub fn color(&self, mesh: &SurfaceMesh, point: &SurfacePoint) -> Option<DVec4> {
        let corners = self.vertex_color(mesh, point);
        let material =
            self.material(mesh, point.face).and_then(|m| self.attributes.materials.get(m)?.as_ref());
        let Some(material) = material else { return corners };
        let color = self.material_color(mesh, point, material);
        match (material.tint, corners) {
            (_, None) => Some(color),
            (Tint::Multiply, Some(corners)) => Some(color * corners),
            (Tint::Replace, Some(corners)) => Some(if material.texture.is_some() { color } else { corners }),
        }
    }

    /// Where the corners of a face lie in the picture of its material, in texels from the upper left of the first repetition;
    /// `None` where there is no picture or no texture coordinates.
    pub fn texels(&self, mesh: &SurfaceMesh, face: FaceId) -> Option<[DVec2; 3]> {
        let material = self.attributes.materials.get(self.material(mesh, face)?)?.as_ref()?;
        let texture = material.texture.as_ref()?;
        let (width, height) = self.attributes.images.get(texture.image)?.size();
        let uv = self.attributes.uv.get(texture.uv_set)?;
        let [a, b, c] = mesh.sources()[face.index()].corners.map(|corner| {
            let uv = uv.get(corner)?;
            let place = texture.transform.transform_point2(DVec2::new(uv.x, 1.0 - uv.y));
            Some(place * DVec2::new(width.into(), height.into()))
        });
        Some([a?, b?, c?])
    }

    fn material_color(&self, mesh: &SurfaceMesh, point: &SurfacePoint, material: &Material) -> DVec4 {
        let texel = material.texture.as_ref().and_then(|texture| {
            let image = self.attributes.images.get(texture.image)?;
            // Without coordinates all of the polygon has one place, as programs that draw it take it.
            let uv = self.uv_of_set(mesh, point, texture.uv_set).unwrap_or(DVec2::Y);
            let place = texture.transform.transform_point2(DVec2::new(uv.x, 1.0 - uv.y));
            Some(image.at(place, texture.wrap, texture.filter))
        });
        texel.map_or(material.base_color, |texel| texel * material.base_color)
    }

    /// The material of a face: an index into [`MeshAttributes::materials`].
    pub fn material(&self, mesh: &SurfaceMesh, face: FaceId) -> Option<usize> {
        self.attributes.material_of.get(mesh.sources()[face.index()].polygon.index())
    }

    /// The part of a face: an index into the names of [`MeshAttributes::parts`].
    pub fn part(&self, mesh: &SurfaceMesh, face: FaceId) -> Option<usize> {
        self.attributes.parts.get(mesh.sources()[face.index()].polygon.index())
    }

    /// A number of the file, by its index in [`MeshAttributes::numbers`].
    pub fn number(&self, mesh: &SurfaceMesh, point: &SurfacePoint, index: usize) -> Option<f64> {
        at(&self.attributes.numbers.get(index)?.1, mesh, point)
    }
}

fn at<T>(values: &CornerValues<T>, mesh: &SurfaceMesh, point: &SurfacePoint) -> Option<T>
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    values.at(mesh.sources()[point.face.index()].corners, point.barycentric)
}

/// The normals of the faces around each vertex, weighted with their angles there; zero where they cancel out.
fn vertex_normals(mesh: &SurfaceMesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.vertex_count()];
    for face in mesh.topology().face_ids() {
        let corners = mesh.triangle(face);
        for (corner, vertex) in mesh.topology().corners(face).into_iter().enumerate() {
            let [u, v] = [1, 2].map(|k| corners[(corner + k) % 3] - corners[corner]);
            let angle = libm::atan2(u.cross(v).length(), u.dot(v));
            normals[vertex.index()] += mesh.face_normal(face) * angle;
        }
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}
