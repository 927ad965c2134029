//! Material libraries (MTL). Own code: `tobj` gives up a whole library at one statement that is not as it expects,
//! and does not take apart the options of pictures.

use glam::{DAffine2, DMat2, DVec2, DVec3};

use crate::attributes::{Filter, Material, MeshAttributes, Texture, Tint, Wrap, from_srgb};
use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::obj::without_comment;
use crate::io::read::{self, Place, ReadError, Resolver, brief};
use crate::io::text::text;

/// Reads the libraries that a file names and describes its materials: the last description of a name counts.
pub(super) fn load(
    libraries: &[String],
    attributes: &mut MeshAttributes,
    limits: &Limits,
    resolver: &Resolver<'_>,
) -> Result<(), ReadError> {
    let mut described = Vec::new();
    for library in libraries {
        for (address, bytes) in fetch_library(library, resolver)? {
            described.extend(parse(&text(&bytes)).into_iter().map(|material| (address.clone(), material)));
        }
    }
    let mut pictures = Vec::new();
    let mut materials = Vec::new();
    for name in attributes.material_of.names().to_vec() {
        let exactly = described.iter().rfind(|(_, known)| known.name == name);
        let nearly = || described.iter().rfind(|(_, known)| before_hash(&known.name) == before_hash(&name));
        let Some((address, known)) = exactly.or_else(nearly) else {
            materials.push(None);
            continue;
        };
        let texture = match &known.picture {
            Some(picture) => {
                let image = fetch_picture(picture, address, &mut pictures, attributes, limits, resolver)?;
                Some(texture(picture, image))
            }
            None => None,
        };
        let base_color = DVec3::from_array(known.kd.map(from_srgb)).extend(known.opacity);
        materials.push(Some(Material { base_color, texture, tint: Tint::Replace }));
    }
    attributes.materials = materials;
    Ok(())
}

/// A name up to a `#` behind a blank, which may begin a comment in one of the files and not in the other.
fn before_hash(name: &str) -> &str {
    name.split_once(" #").map_or(name, |(name, _)| name).trim_end()
}

/// A library, or several whose names stand on one line; names may hold blanks, and what looks like a comment.
fn fetch_library(names: &str, resolver: &Resolver<'_>) -> Result<Vec<(String, Vec<u8>)>, ReadError> {
    let names = names.replace('\\', "/");
    let bare = without_comment(&names);
    for name in [&*names, bare] {
        if let Ok(bytes) = resolver(name) {
            return Ok(vec![(name.to_owned(), bytes)]);
        }
    }
    bare.split_ascii_whitespace()
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
            materials.push(Described {
                name: without_comment(rest).to_owned(),
                kd: [1.0; 3],
                opacity: 1.0,
                picture: None,
            });
        }
        let Some(material) = materials.last_mut() else { continue };
        match (keyword, &numbers[..]) {
            ("Kd", &[r, g, b, ..]) => material.kd = [r, g, b].map(|value| value.clamp(0.0, 1.0)),
            // One number stands for all three.
            ("Kd", &[grey]) => material.kd = [grey.clamp(0.0, 1.0); 3],
            ("d", &[opacity, ..]) => material.opacity = opacity.clamp(0.0, 1.0),
            ("Tr", &[transparency, ..]) => material.opacity = 1.0 - transparency.clamp(0.0, 1.0),
            _ if keyword.eq_ignore_ascii_case("map_Kd") => material.picture = picture(rest),
            _ => {}
        }
    }
    materials
}

/// Options, then the name, which may hold blanks. The last word always belongs to the name, so that none is lost.
fn picture(mut rest: &str) -> Option<Picture> {
    let mut picture =
        Picture { address: String::new(), offset: DVec2::ZERO, scale: DVec2::ONE, wrap: Wrap::Repeat };
    while let Some((option, after)) = first_word(rest) {
        // Those that take up to three numbers, and those that take so many words.
        let (most, numbers) = match option {
            "-o" | "-s" | "-t" => (3, true),
            "-mm" => (2, true),
            "-blendu" | "-blendv" | "-bm" | "-boost" | "-cc" | "-clamp" | "-colorspace" | "-imfchan"
            | "-texres" | "-type" => (1, false),
            _ => break,
        };
        rest = after;
        let mut arguments = Vec::new();
        while let Some((word, after)) = first_word(rest).filter(|_| arguments.len() < most) {
            if numbers && word.parse::<f64>().is_err() {
                break;
            }
            arguments.push(word);
            rest = after;
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

/// The first word and what follows it, if something does that is no comment.
fn first_word(rest: &str) -> Option<(&str, &str)> {
    let (word, after) = rest.split_once([' ', '\t'])?;
    let after = after.trim_start();
    (!without_comment(after).is_empty()).then_some((word, after))
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
    let beside = |name: &str| if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") };
    let address = beside(&picture.address);
    if let Some(&(_, index)) = pictures.iter().find(|(known, _)| *known == address) {
        return Ok(index);
    }
    // What looks like a comment may be a part of the name.
    let bare = beside(without_comment(&picture.address));
    let bytes = resolver(&address).or_else(|_| resolver(&bare)).map_err(|reason| missing(&bare, reason))?;
    let picture = read::Picture {
        bytes: &bytes,
        format: MeshFormat::Obj,
        place: Place::File,
        called: format!("the picture {:?}", brief(&bare)),
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

    #[test]
    fn no_picture_is_lost() {
        let (one, zero) = (DVec2::ONE, DVec2::ZERO);
        for (text, address, scale, offset) in [
            ("t.png", "t.png", one, zero),
            ("-s 2 t.png", "t.png", DVec2::new(2.0, 1.0), zero),
            ("-s 2 2 t.png", "t.png", DVec2::splat(2.0), zero),
            ("-s 2 3 4 t.png", "t.png", DVec2::new(2.0, 3.0), zero),
            ("-o 0.25 0.5 t.png", "t.png", one, DVec2::new(0.25, 0.5)),
            ("-o 0.25 -s\t2 my t.png", "my t.png", DVec2::new(2.0, 1.0), DVec2::new(0.25, 0.0)),
            ("-mm 0.5 t.png", "t.png", one, zero),
            ("-blendu on -imfchan l -texres 512 t.png", "t.png", one, zero),
            ("-s 2 2 2 7", "7", DVec2::splat(2.0), zero),
            ("-s 2 7", "7", DVec2::new(2.0, 1.0), zero),
            ("-s 2 7 # c", "7 # c", DVec2::new(2.0, 1.0), zero),
            ("-odd.png", "-odd.png", one, zero),
            ("-clamp t.png", "t.png", one, zero),
        ] {
            let found = picture(text).unwrap_or_else(|| panic!("{text}"));
            assert_eq!((&*found.address, found.scale, found.offset), (address, scale, offset), "{text}");
        }
        assert_eq!(picture(""), None);
    }

    #[test]
    fn comments_and_quotation_marks() {
        let library = "newmtl m # c\nmap_Kd -s 2 2 \"my t.png\" # hi\nnewmtl \"b\"\nmap_Kd t.png # hi\n";
        let mut attributes = MeshAttributes::default();
        for name in ["m", "b"] {
            attributes.material_of.index_of(name);
        }
        let resolver = |name: &str| match name {
            "a/x.mtl" => Ok(library.into()),
            // A picture that is none: that it was asked for is enough here.
            "a/my t.png" | "a/t.png" => Ok(b"P".to_vec()),
            _ => Err("it is not there".to_owned()),
        };
        for names in ["a/x.mtl # c", "\"a/x.mtl\"", "a\\x.mtl"] {
            let error = load(&[names.to_owned()], &mut attributes.clone(), &Limits::default(), &resolver);
            let found =
                matches!(&error, Err(ReadError::Unsupported { what, .. }) if what.contains("a/my t.png"));
            assert!(found, "{error:?}");
        }
        let mut hashes = MeshAttributes::default();
        let names = ["m #25", "m #26", "x #y", "no"];
        for name in names {
            hashes.material_of.index_of(name);
        }
        let library = "newmtl m #25\nd 0.25\nnewmtl m #26\nd 0.5\nnewmtl x\nd 0.75\n";
        load(&["h".to_owned()], &mut hashes, &Limits::default(), &|_| Ok(library.into())).unwrap();
        let opacity: Vec<_> = hashes.materials.iter().map(|m| m.as_ref().map(|m| m.base_color.w)).collect();
        assert_eq!(opacity, [Some(0.25), Some(0.5), Some(0.75), None]);
        let error = load(&["b.mtl # c".to_owned()], &mut attributes, &Limits::default(), &resolver);
        assert!(matches!(&error, Err(ReadError::Missing { uri, .. }) if uri == "b.mtl"), "{error:?}");
    }
}
