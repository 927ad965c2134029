//! Material libraries (MTL). Own code: `tobj` gives up a whole library at one statement that is not as it expects,
//! and does not take apart the options of pictures.

use glam::{DAffine2, DMat2, DVec2, DVec3};

use crate::attributes::{Filter, Material, MeshAttributes, Texture, Tint, Wrap, from_srgb};
use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::read::{self, Place, ReadError, Resolver, brief, text};

/// Reads the libraries that a file names and describes its materials: the last description of a name counts.
pub(super) fn load(
    libraries: &[String],
    attributes: &mut MeshAttributes,
    limits: &Limits,
    resolver: &Resolver<'_>,
) -> Result<(), ReadError> {
    attributes.materials = vec![None; attributes.material_of.names().len()];
    let mut pictures = Vec::new();
    for library in libraries {
        for (address, bytes) in fetch_library(library, resolver)? {
            for described in parse(&text(&bytes)) {
                let Some(index) = attributes.material_of.find(&described.name) else { continue };
                let texture = match described.picture {
                    Some(picture) => {
                        let image =
                            fetch_picture(&picture, &address, &mut pictures, attributes, limits, resolver)?;
                        Some(texture(&picture, image))
                    }
                    None => None,
                };
                let base_color = DVec3::from_array(described.kd.map(from_srgb)).extend(described.opacity);
                attributes.materials[index] = Some(Material { base_color, texture, tint: Tint::Replace });
            }
        }
    }
    Ok(())
}

/// A library, or several whose names stand on one line; names may hold blanks.
fn fetch_library(names: &str, resolver: &Resolver<'_>) -> Result<Vec<(String, Vec<u8>)>, ReadError> {
    let names = names.replace('\\', "/");
    let whole = resolver(&names);
    if let Ok(bytes) = whole {
        return Ok(vec![(names, bytes)]);
    }
    names
        .split_ascii_whitespace()
        .map(|name| match resolver(name) {
            Ok(bytes) => Ok((name.to_owned(), bytes)),
            Err(reason) => Err(missing(name, reason)),
        })
        .collect()
}

fn missing(name: &str, reason: String) -> ReadError {
    ReadError::Missing { format: MeshFormat::Obj, uri: brief(name), reason }
}

/// A material as the library describes it.
#[derive(Debug, PartialEq)]
struct Described {
    name: String,
    /// sRGB.
    kd: [f64; 3],
    opacity: f64,
    picture: Option<Picture>,
}

/// What stands behind `map_Kd`.
#[derive(Debug, PartialEq)]
struct Picture {
    address: String,
    offset: DVec2,
    scale: DVec2,
    wrap: Wrap,
}

fn parse(text: &str) -> Vec<Described> {
    let mut materials: Vec<Described> = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        let (keyword, rest) = line.split_once([' ', '\t']).unwrap_or((line, ""));
        let rest = rest.trim();
        let numbers: Vec<f64> = rest.split_ascii_whitespace().map_while(|word| word.parse().ok()).collect();
        if keyword == "newmtl" {
            materials.push(Described { name: rest.to_owned(), kd: [1.0; 3], opacity: 1.0, picture: None });
        }
        let Some(material) = materials.last_mut() else { continue };
        match (keyword, &numbers[..]) {
            ("Kd", &[r, g, b, ..]) => material.kd = [r, g, b].map(|value| value.clamp(0.0, 1.0)),
            // One number stands for all three.
            ("Kd", &[grey]) => material.kd = [grey.clamp(0.0, 1.0); 3],
            ("d", &[opacity, ..]) => material.opacity = opacity.clamp(0.0, 1.0),
            ("Tr", &[transparency, ..]) => material.opacity = 1.0 - transparency.clamp(0.0, 1.0),
            ("map_Kd" | "map_kd", _) => material.picture = picture(rest),
            _ => {}
        }
    }
    materials
}

/// Options, then the name, which may hold blanks.
fn picture(mut rest: &str) -> Option<Picture> {
    let mut picture =
        Picture { address: String::new(), offset: DVec2::ZERO, scale: DVec2::ONE, wrap: Wrap::Repeat };
    while rest.starts_with('-') {
        let (option, after) = rest.split_once([' ', '\t'])?;
        rest = after.trim_start();
        let mut arguments = Vec::new();
        let most = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        while arguments.len() < most {
            let (word, after) = rest.split_once([' ', '\t'])?;
            // The numbers of -o, -s and -t may be fewer than three.
            if most == 3 && word.parse::<f64>().is_err() {
                break;
            }
            arguments.push(word);
            rest = after.trim_start();
        }
        let number = |index: usize, otherwise: f64| {
            arguments.get(index).and_then(|word| word.parse().ok()).unwrap_or(otherwise)
        };
        match option {
            "-o" => picture.offset = DVec2::new(number(0, 0.0), number(1, 0.0)),
            "-s" => picture.scale = DVec2::new(number(0, 1.0), number(1, 1.0)),
            "-clamp" if arguments == ["on"] => picture.wrap = Wrap::Clamp,
            _ => {}
        }
    }
    picture.address = rest.trim().replace('\\', "/");
    (!picture.address.is_empty()).then_some(picture)
}

/// The index of a picture, which is read once.
fn fetch_picture(
    picture: &Picture,
    library: &str,
    pictures: &mut Vec<(String, usize)>,
    attributes: &mut MeshAttributes,
    limits: &Limits,
    resolver: &Resolver<'_>,
) -> Result<usize, ReadError> {
    // Pictures lie beside the library.
    let folder = library.rsplit_once('/').map_or("", |(folder, _)| folder);
    let address =
        if folder.is_empty() { picture.address.clone() } else { format!("{folder}/{}", picture.address) };
    if let Some(&(_, index)) = pictures.iter().find(|(known, _)| *known == address) {
        return Ok(index);
    }
    let bytes = resolver(&address).map_err(|reason| missing(&address, reason))?;
    let picture = read::Picture {
        bytes: &bytes,
        format: MeshFormat::Obj,
        place: Place::File,
        called: format!("the picture {:?}", brief(&address)),
        advice: "save it as PNG or JPEG",
    };
    let index = picture.decode(attributes, limits)?;
    pictures.push((address, index));
    Ok(index)
}

fn texture(picture: &Picture, image: usize) -> Texture {
    // The options are meant for coordinates with the origin at the lower left.
    let (scale, offset) = (picture.scale, picture.offset);
    Texture {
        image,
        uv_set: 0,
        transform: DAffine2::from_mat2_translation(
            DMat2::from_diagonal(scale),
            DVec2::new(offset.x, 1.0 - scale.y - offset.y),
        ),
        wrap: [picture.wrap; 2],
        filter: Filter::Linear,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_as_programs_write_them() {
        let text = "# made\n\nKd 1 1 1\nnewmtl red paint\n\tKd\t1.0 0.5 0\n d 0.25\nillum 2\nnewmtl b\nKd 2\nTr 0.25\n\
                    map_Kd -s 2 3 1 -o 0.5 -bm 1 -clamp on dir\\my wood.png\nnewmtl c\nKd spectral x.rfl\n";
        let [red, b, c] = &parse(text)[..] else { panic!("three materials") };
        assert_eq!((red.name.as_str(), red.kd, red.opacity), ("red paint", [1.0, 0.5, 0.0], 0.25));
        assert_eq!((b.kd, b.opacity), ([1.0; 3], 0.75));
        let picture = b.picture.as_ref().expect("a picture");
        assert_eq!(picture.address, "dir/my wood.png");
        assert_eq!((picture.scale, picture.offset), (DVec2::new(2.0, 3.0), DVec2::new(0.5, 0.0)));
        assert_eq!(picture.wrap, Wrap::Clamp);
        assert_eq!((c.kd, c.picture.is_none()), ([1.0; 3], true));
    }
}
