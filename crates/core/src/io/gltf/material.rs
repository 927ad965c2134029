//! Base colours of materials: factor, texture, sampler.

use std::collections::BTreeMap;

use glam::{DAffine2, DVec2, DVec4};
use gltf::Document;
use gltf::texture::{Info, MagFilter, WrappingMode};

use super::buffers::{Buffers, embedded, percent_decoded};
use super::malformed;
use crate::attributes::{Filter, Material, MeshAttributes, Texture, Tint, Wrap};
use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::read::{Picture, Place, ReadError, Resolver, brief};

/// Describes the materials that are used; `used` leads from those of the document to the names of the attributes.
pub(super) fn load(
    document: &Document,
    used: &BTreeMap<usize, usize>,
    attributes: &mut MeshAttributes,
    buffers: &Buffers,
    limits: &Limits,
    resolver: &Resolver<'_>,
) -> Result<(), ReadError> {
    attributes.materials = vec![None; attributes.material_of.names().len()];
    let mut images = Images { document, buffers, limits, resolver, known: BTreeMap::new() };
    for material in document.materials() {
        let Some(&index) = material.index().and_then(|index| used.get(&index)) else { continue };
        let base = material.pbr_metallic_roughness();
        let texture = match base.base_color_texture() {
            Some(info) => Some(texture(&info, &mut images, attributes)?),
            None => None,
        };
        attributes.materials[index] = Some(Material {
            base_color: DVec4::from_array(base.base_color_factor().map(f64::from)),
            texture,
            tint: Tint::Multiply,
        });
    }
    Ok(())
}

/// Where pictures come from, and which were read.
struct Images<'a> {
    document: &'a Document,
    buffers: &'a Buffers,
    limits: &'a Limits,
    resolver: &'a Resolver<'a>,
    /// Leads from the images of the document to those of the attributes.
    known: BTreeMap<usize, usize>,
}

impl Images<'_> {
    /// The index in the attributes of an image of the document.
    fn index(&mut self, source: usize, attributes: &mut MeshAttributes) -> Result<usize, ReadError> {
        if let Some(&index) = self.known.get(&source) {
            return Ok(index);
        }
        let bytes = image_bytes(self.document, source, self.buffers, self.resolver)?;
        let picture = Picture {
            bytes: &bytes,
            format: MeshFormat::Gltf,
            place: Place::Item("image", source),
            called: "the picture".to_owned(),
            advice: "export it with PNG or JPEG textures",
        };
        let index = picture.decode(attributes, self.limits)?;
        self.known.insert(source, index);
        Ok(index)
    }
}

fn texture(
    info: &Info<'_>,
    images: &mut Images<'_>,
    attributes: &mut MeshAttributes,
) -> Result<Texture, ReadError> {
    let texture = info.texture();
    let place = Place::Item("texture", texture.index());
    let Some(source) = texture.source() else {
        return Err(ReadError::Unsupported {
            format: MeshFormat::Gltf,
            place,
            what: "a texture without a PNG or JPEG picture".to_owned(),
            advice: "export it with PNG or JPEG textures",
        });
    };
    let image = images.index(source.index(), attributes)?;
    let sampler = texture.sampler();
    let wrap = |mode| match mode {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    };
    let moved = info.texture_transform();
    let uv_set = moved.as_ref().and_then(|m| m.tex_coord()).unwrap_or_else(|| info.tex_coord());
    let transform = moved.map_or(DAffine2::IDENTITY, |moved| {
        let vector = |xy: [f32; 2]| DVec2::from_array(xy.map(f64::from));
        // The extension's matrix turns by minus the angle.
        let (sin, cos) = libm::sincos(-f64::from(moved.rotation()));
        let [scale, offset] = [moved.scale(), moved.offset()].map(vector);
        DAffine2::from_cols(DVec2::new(cos, sin) * scale.x, DVec2::new(-sin, cos) * scale.y, offset)
    });
    Ok(Texture {
        image,
        uv_set: uv_set as usize,
        transform,
        wrap: [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())],
        filter: if sampler.mag_filter() == Some(MagFilter::Nearest) {
            Filter::Nearest
        } else {
            Filter::Linear
        },
    })
}

/// The bytes of a picture: in a buffer, in the document, or beside it.
fn image_bytes(
    document: &Document,
    index: usize,
    buffers: &Buffers,
    resolver: &Resolver<'_>,
) -> Result<Vec<u8>, ReadError> {
    let place = Place::Item("image", index);
    // The library's own accessor panics where neither is there.
    let root = document.as_json();
    let image = root.images.get(index).ok_or_else(|| malformed(place, "it does not exist".into()))?;
    if let Some(view) = &image.buffer_view {
        let bytes = root.buffer_views.get(view.value()).and_then(|view| {
            let offset = view.byte_offset.map_or(0, |offset| offset.0);
            buffers.bytes(view.buffer.value(), offset, view.byte_length.0)
        });
        return bytes
            .map(<[u8]>::to_vec)
            .ok_or_else(|| malformed(place, "it reaches beyond its buffer".into()));
    }
    let uri = image.uri.as_deref().ok_or_else(|| malformed(place, "it has no data".into()))?;
    match uri.strip_prefix("data:") {
        Some(data) => embedded(data).ok_or_else(|| malformed(place, "its data is not base64".into())),
        None => resolver(&percent_decoded(uri)).map_err(|reason| ReadError::Missing {
            format: MeshFormat::Gltf,
            uri: brief(uri),
            reason,
        }),
    }
}
