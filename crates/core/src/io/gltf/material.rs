//! Base colours of materials: factor, texture, sampler.

use std::collections::BTreeMap;

use glam::{DAffine2, DVec2, DVec4};
use gltf::Document;
use gltf::texture::{Info, MagFilter, WrappingMode};

use super::buffers::{Buffers, embedded, percent_decoded};
use super::malformed;
use crate::attributes::{Filter, Image, Material, MeshAttributes, Texture, Tint, Wrap};
use crate::io::detect::MeshFormat;
use crate::io::read::{Place, ReadError, Resolver, brief};

/// Describes the materials that are used; `used` leads from those of the document to the names of the attributes.
pub(super) fn load(
    document: &Document,
    used: &BTreeMap<usize, usize>,
    attributes: &mut MeshAttributes,
    buffers: &Buffers,
    resolver: &Resolver<'_>,
) -> Result<(), ReadError> {
    attributes.materials = vec![None; attributes.material_of.names().len()];
    let mut images = BTreeMap::new();
    for material in document.materials() {
        let Some(&index) = material.index().and_then(|index| used.get(&index)) else { continue };
        let base = material.pbr_metallic_roughness();
        let texture = match base.base_color_texture() {
            Some(info) => texture(&info, document, &mut images, attributes, buffers, resolver)?,
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

fn texture(
    info: &Info<'_>,
    document: &Document,
    images: &mut BTreeMap<usize, usize>,
    attributes: &mut MeshAttributes,
    buffers: &Buffers,
    resolver: &Resolver<'_>,
) -> Result<Option<Texture>, ReadError> {
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
    let image = match images.get(&source.index()) {
        Some(&image) => image,
        None => {
            let bytes = image_bytes(document, source.index(), buffers, resolver)?;
            let image = Image::decode(&bytes).map_err(|error| ReadError::Unsupported {
                format: MeshFormat::Gltf,
                place: Place::Item("image", source.index()),
                what: format!("the picture ({})", brief(&error.to_string())),
                advice: "export it with PNG or JPEG textures",
            })?;
            attributes.images.push(image);
            images.insert(source.index(), attributes.images.len() - 1);
            attributes.images.len() - 1
        }
    };
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
    Ok(Some(Texture {
        image,
        uv_set: uv_set as usize,
        transform,
        wrap: [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())],
        filter: if sampler.mag_filter() == Some(MagFilter::Nearest) {
            Filter::Nearest
        } else {
            Filter::Linear
        },
    }))
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
