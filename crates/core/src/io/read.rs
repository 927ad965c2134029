//! What all mesh readers share: their errors, and the choice of the reader.

use std::borrow::Cow;
use std::fmt;

use crate::attributes::MeshAttributes;
use crate::io::detect::{MeshFormat, detect};
use crate::mesh::PolygonSoup;

/// Fetches what a mesh file names beside itself (buffers and pictures of a `.gltf`, materials and pictures of an `.obj`),
/// by its relative address; an `Err` says why it cannot be had. Keeping the address inside a folder is up to the resolver.
pub type Resolver<'a> = dyn Fn(&str) -> Result<Vec<u8>, String> + 'a;

/// Where in a file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// Nowhere in particular.
    File,
    /// A line of text, counted from 1.
    Line(usize),
    /// An offset in bytes from the start.
    Byte(usize),
    /// One of the things that the format counts, from 0.
    Item(&'static str, usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => f.write_str("file"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Item(item, index) => write!(f, "{item} {index}"),
        }
    }
}

/// Why bytes are not a mesh: the format, the place, what is wrong and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Neither content nor name tell a format.
    #[error("not a mesh in a known format: convert it to OBJ, glTF, GLB, PLY, STL or OFF")]
    UnknownFormat,
    /// The content is that of another kind of file.
    #[error("this is {what}, not a mesh in a known format: {advice}")]
    Foreign {
        /// What it is.
        what: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// The file is compressed with gzip and cannot be unpacked.
    #[error("gzip: {problem}")]
    Compressed {
        /// Why.
        problem: String,
    },
    /// The reader was left out of this build.
    #[error("this build reads no {format}: build ldwrap with the feature of that name")]
    Disabled {
        /// The format.
        format: MeshFormat,
    },
    /// The bytes break the rules of the format.
    #[error("{format}, {place}: {problem}; the file is damaged or was written wrong: export it again")]
    Malformed {
        /// The format.
        format: MeshFormat,
        /// Where.
        place: Place,
        /// What is wrong.
        problem: String,
    },
    /// There are fewer bytes than the file says itself.
    #[error("{format}, {place}: {problem}; the file was cut off: copy or export it again")]
    Truncated {
        /// The format.
        format: MeshFormat,
        /// Where.
        place: Place,
        /// What is missing.
        problem: String,
    },
    /// The format allows it, but it cannot be read here.
    #[error("{format}, {place}: {what} cannot be read; {advice}")]
    Unsupported {
        /// The format.
        format: MeshFormat,
        /// Where.
        place: Place,
        /// What it is.
        what: String,
        /// What to do.
        advice: &'static str,
    },
    /// The resolver does not have what the file names.
    #[error("{format}: {uri:?} is needed too, but {reason}; keep it beside the file")]
    Missing {
        /// The format.
        format: MeshFormat,
        /// The relative address in the file.
        uri: String,
        /// What the resolver said.
        reason: String,
    },
    /// More than can be counted or held.
    #[error("{format}, {place}: more than {limit} {what}; split the mesh")]
    TooLarge {
        /// The format.
        format: MeshFormat,
        /// Where.
        place: Place,
        /// Of what there is too much.
        what: &'static str,
        /// How many there may be.
        limit: usize,
    },
}

/// How much of a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Detail {
    /// Positions and polygons.
    #[default]
    Shape,
    /// And what belongs to them in the same file: normals, texture coordinates, colours, names of materials and parts.
    Attributes,
    /// And the materials with their pictures, for which the resolver is asked.
    Textures,
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Positions and polygons.
    pub soup: PolygonSoup,
    /// What belongs to them; empty as far as it was not asked for.
    pub attributes: MeshAttributes,
}

impl From<PolygonSoup> for Model {
    fn from(soup: PolygonSoup) -> Self {
        Self { soup, attributes: MeshAttributes::default() }
    }
}

/// Reads the shape of a mesh in any format; see [`read_model`].
///
/// # Errors
/// [`ReadError`].
pub fn read_mesh(
    bytes: &[u8],
    name: Option<&str>,
    resolver: &Resolver<'_>,
) -> Result<PolygonSoup, ReadError> {
    read_model(bytes, name, Detail::Shape, resolver).map(|model| model.soup)
}

/// Reads a mesh in any format, also compressed with gzip. `name` is looked at only if the content does not tell the
/// format; `resolver` is asked for the external buffers of glTF and, for [`Detail::Textures`], for materials and
/// pictures. Units and axes stay those of the file.
///
/// # Errors
/// [`ReadError`].
pub fn read_model(
    bytes: &[u8],
    name: Option<&str>,
    detail: Detail,
    resolver: &Resolver<'_>,
) -> Result<Model, ReadError> {
    let bytes = unpacked(bytes)?;
    let name = name.map(|name| name.strip_suffix(".gz").unwrap_or(name));
    match detect(&bytes, name) {
        Some(format) => read_model_as(format, &bytes, detail, resolver),
        None => Err(foreign(&bytes)),
    }
}

/// Reads a mesh in a known format, also compressed with gzip; see [`read_model`].
///
/// # Errors
/// [`ReadError`].
pub fn read_model_as(
    format: MeshFormat,
    bytes: &[u8],
    detail: Detail,
    resolver: &Resolver<'_>,
) -> Result<Model, ReadError> {
    let bytes = unpacked(bytes)?;
    match format {
        #[cfg(feature = "obj")]
        MeshFormat::Obj => crate::io::obj::read_model(&bytes, detail, resolver),
        #[cfg(feature = "gltf")]
        MeshFormat::Gltf => crate::io::gltf::read_model(&bytes, detail, resolver),
        #[cfg(feature = "ply")]
        MeshFormat::Ply => crate::io::ply::read_model(&bytes, detail, resolver),
        #[cfg(feature = "stl")]
        MeshFormat::Stl => crate::io::stl::read_model(&bytes, detail),
        MeshFormat::Off => crate::io::off::read_model(&bytes, detail),
        #[allow(unreachable_patterns)]
        format => {
            let _ = (resolver, detail);
            Err(ReadError::Disabled { format })
        }
    }
}

/// What a file is, told by its first bytes, that is no mesh to be read here.
fn foreign(bytes: &[u8]) -> ReadError {
    const CONVERT: &str = "convert it to OBJ, glTF, GLB, PLY, STL or OFF";
    let kinds: [(&[u8], &str, &str); 10] = [
        (b"Kaydara FBX Binary", "FBX", CONVERT),
        (b"; FBX", "FBX", CONVERT),
        (b"BLENDER", "a Blender file", "export it to OBJ, glTF, GLB, PLY or STL"),
        (
            b"PK\x03\x04",
            "a ZIP archive (as 3MF and USDZ are)",
            "unpack it, or convert it to OBJ, glTF, GLB, PLY, STL or OFF",
        ),
        (b"ISO-10303-21", "STEP", CONVERT),
        (b"#usda", "USD", CONVERT),
        (b"PXR-USDC", "USD", CONVERT),
        (b"\x89PNG", "a PNG picture", "name the mesh"),
        (b"\xff\xd8\xff", "a JPEG picture", "name the mesh"),
        (b"# vtk DataFile", "VTK", CONVERT),
    ];
    match kinds.into_iter().find(|(start, ..)| bytes.starts_with(start)) {
        Some((_, what, advice)) => ReadError::Foreign { what, advice },
        None => ReadError::UnknownFormat,
    }
}

/// The most bytes that a compressed file may unpack to: a few bytes can unpack to a thousand times as many.
#[cfg(feature = "gz")]
const MOST_UNPACKED: u64 = if usize::BITS < 64 { 1 << 30 } else { 1 << 34 };

/// The bytes without the compression of gzip, if they have it.
fn unpacked(bytes: &[u8]) -> Result<Cow<'_, [u8]>, ReadError> {
    if !bytes.starts_with(&[0x1f, 0x8b, 8]) {
        return Ok(Cow::Borrowed(bytes));
    }
    #[cfg(feature = "gz")]
    {
        use std::io::Read;
        let mut unpacked = Vec::new();
        flate2::read::MultiGzDecoder::new(bytes).take(MOST_UNPACKED + 1).read_to_end(&mut unpacked).map_err(
            |error| ReadError::Compressed {
                problem: format!(
                    "{}; the file is damaged or was cut off: copy it again",
                    brief(&error.to_string())
                ),
            },
        )?;
        if unpacked.len() as u64 > MOST_UNPACKED {
            let problem = format!("it holds more than {MOST_UNPACKED} bytes; unpack it, and split the mesh");
            return Err(ReadError::Compressed { problem });
        }
        Ok(Cow::Owned(unpacked))
    }
    #[cfg(not(feature = "gz"))]
    {
        let problem =
            "this build unpacks nothing; build ldwrap with the feature gz, or unpack the file first";
        Err(ReadError::Compressed { problem: problem.to_owned() })
    }
}

/// Text of any encoding whose words and numbers are ASCII, without byte order mark; bytes that are not UTF-8 (old
/// comments) are replaced.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// The start of what a file or a library says, on one line, for messages.
pub(super) fn brief(text: &str) -> String {
    const LONGEST: usize = 100;
    let mut brief: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if brief.len() < text.len() {
        brief.push_str("...");
    }
    brief
}

/// Appends a polygon as long as 32 bits can count the corners.
pub(super) fn push_polygon(
    soup: &mut PolygonSoup,
    corners: impl IntoIterator<Item = u32>,
    format: MeshFormat,
) -> Result<(), ReadError> {
    soup.corners.extend(corners);
    let end = u32::try_from(soup.corners.len()).map_err(|_| ReadError::TooLarge {
        format,
        place: Place::Item("face", soup.ends.len()),
        what: "corners",
        limit: u32::MAX as usize,
    })?;
    soup.ends.push(end);
    Ok(())
}
