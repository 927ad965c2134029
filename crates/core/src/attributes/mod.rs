//! What a file knows about its surface besides the shape: normals, texture coordinates, colours, materials, parts, and
//! any numbers at vertices; looked up at points of the checked surface.
//!
//! Values belong to corners of the soup's polygons, not to vertices, so that welding and cutting lose none of them:
//! [`FaceSource`](crate::FaceSource) leads from a face to the corners it came from. Readers make the values
//! ([`read_model`](crate::io::read_model)).
//!
//! Conventions, whatever the file's: colours are linear light (primaries of sRGB, D65) with straight alpha; texture
//! coordinates have their origin at the lower left corner of the picture, as in OBJ and PLY, so `v` of glTF is turned
//! over (1 - v).

mod color;
mod corners;
mod cut;
mod place;
#[cfg(all(test, feature = "io"))]
mod tests;
mod texture;

pub use color::{from_srgb, from_srgb8, to_srgb, to_srgb8};
pub use corners::{CornerValues, PolygonNames};
pub(crate) use cut::Piece;
pub use place::Places;
pub use texture::{Filter, Image, ImageError, Material, Texture, Tint, Wrap};

use glam::{DVec2, DVec3, DVec4};

/// Everything that a file says about its surface besides positions and polygons. What a file does not have is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshAttributes {
    /// Normals at corners, of length 1, in the axes of the positions.
    pub normals: CornerValues<DVec3>,
    /// Texture coordinates at corners: the sets of the file, in its order.
    pub uv: Vec<CornerValues<DVec2>>,
    /// Colours at corners: linear red, green, blue, and alpha, 0 to 1.
    pub colors: CornerValues<DVec4>,
    /// Other numbers at corners, with the names that the file gives them, as the scalar properties of PLY.
    pub numbers: Vec<(String, CornerValues<f64>)>,
    /// The material of each polygon: indices into `materials`.
    pub material_of: PolygonNames,
    /// The materials, in the order of `material_of.names`; `None` where the file only names one.
    pub materials: Vec<Option<Material>>,
    /// The pictures of the materials.
    pub images: Vec<Image>,
    /// The part that each polygon belongs to: node, object, group or solid, as the format calls it.
    pub parts: PolygonNames,
    /// The numbers in the file of the polygons, where only some were kept.
    pub kept: Option<Vec<u32>>,
}

impl MeshAttributes {
    /// Keeps what belongs to these polygons and corners, in this order.
    pub(crate) fn select(&mut self, polygons: &[usize], corners: &[usize]) {
        self.normals.select(corners);
        self.colors.select(corners);
        self.uv.iter_mut().for_each(|uv| uv.select(corners));
        self.numbers.iter_mut().for_each(|(_, numbers)| numbers.select(corners));
        self.select_polygons(polygons);
    }

    /// Gives the polygons the names and numbers of these.
    fn select_polygons(&mut self, polygons: &[usize]) {
        self.material_of.select(polygons);
        self.parts.select(polygons);
        let number = |&polygon: &usize| match &self.kept {
            Some(kept) => kept.get(polygon).copied().unwrap_or_default(),
            None => polygon as u32,
        };
        self.kept = Some(polygons.iter().map(number).collect());
    }

    /// The number in the file of a polygon.
    pub fn polygon_number(&self, polygon: crate::PolygonId) -> u32 {
        self.kept.as_ref().and_then(|kept| kept.get(polygon.index()).copied()).unwrap_or(polygon.0)
    }
}
