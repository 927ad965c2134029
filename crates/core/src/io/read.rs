//! What all mesh readers share: their errors, and the choice of the reader.

use std::borrow::Cow;
use std::fmt;

use crate::attributes::MeshAttributes;
#[cfg(any(feature = "obj", feature = "gltf", feature = "ply"))]
use crate::attributes::{Image, ImageError};
use crate::io::detect::{MeshFormat, detect};
use crate::io::limits::Limits;
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
    /// More than the [`Limits`] allow.
    #[error(
        "{format}, {place}: more than {limit} {what}, which is the limit; split the mesh, or raise the limit \
         (`--max-memory` of the program, `Limits` of the library)"
    )]
    TooLarge {
        /// The format.
        format: MeshFormat,
        /// Where.
        place: Place,
        /// Of what there is too much.
        what: &'static str,
        /// How many there may be.
        limit: u64,
    },
    /// More than can be numbered.
    #[error("{format}, {place}: more than {most} {what} cannot be numbered; split the mesh")]
    TooMany {
        /// The format.
        format: MeshFormat,
        /// Where.
        place: Place,
        /// Of what there is too much.
        what: &'static str,
        /// How many there may be.
        most: u32,
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
    read_model_with(bytes, &ReadOptions { name, detail, ..ReadOptions::default() }, resolver)
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
    read_model_with(bytes, &ReadOptions { format: Some(format), detail, ..ReadOptions::default() }, resolver)
}

/// How a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions<'a> {
    /// The format. Default: `None`; the content tells it, and the name where the content does not.
    pub format: Option<MeshFormat>,
    /// The name of the file. Default: `None`.
    pub name: Option<&'a str>,
    /// How much is read. Default: the shape.
    pub detail: Detail,
    /// The most that reading may take.
    pub limits: Limits,
}

/// Reads a mesh, also compressed with gzip; see [`read_model`].
///
/// # Errors
/// [`ReadError`].
pub fn read_model_with(
    bytes: &[u8],
    options: &ReadOptions<'_>,
    resolver: &Resolver<'_>,
) -> Result<Model, ReadError> {
    let ReadOptions { format, name, detail, limits } = *options;
    let bytes = unpacked(bytes, limits.bytes)?;
    let name = name.map(|name| name.strip_suffix(".gz").unwrap_or(name));
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        // A binary STL file may start with these bytes too.
        if format != Some(MeshFormat::Stl) && detect(&bytes, None).is_none() {
            return Err(foreign(&bytes));
        }
    }
    let Some(format) = format.or_else(|| detect(&bytes, name)) else { return Err(foreign(&bytes)) };
    if bytes.len() as u64 > limits.bytes {
        let (place, what) = (Place::File, "bytes");
        return Err(ReadError::TooLarge { format, place, what, limit: limits.bytes });
    }
    let limits = &limits;
    match format {
        #[cfg(feature = "obj")]
        MeshFormat::Obj => crate::io::obj::read_within(&bytes, detail, limits, resolver),
        #[cfg(feature = "gltf")]
        MeshFormat::Gltf => crate::io::gltf::read_within(&bytes, detail, limits, resolver),
        #[cfg(feature = "ply")]
        MeshFormat::Ply => crate::io::ply::read_within(&bytes, detail, limits, resolver),
        #[cfg(feature = "stl")]
        MeshFormat::Stl => crate::io::stl::read_within(&bytes, detail, limits),
        MeshFormat::Off => crate::io::off::read_within(&bytes, detail, limits),
        #[allow(unreachable_patterns)]
        format => {
            let _ = (resolver, detail, limits);
            Err(ReadError::Disabled { format })
        }
    }
}

/// What a file is, told by its first bytes, that is no mesh to be read here.
fn foreign(bytes: &[u8]) -> ReadError {
    const CONVERT: &str = "convert it to OBJ, glTF, GLB, PLY, STL or OFF";
    const ENCODE: &str = "save it as UTF-8 or ASCII";
    let kinds: [(&[u8], &str, &str); 12] = [
        (b"\xff\xfe", "text in UTF-16", ENCODE),
        (b"\xfe\xff", "text in UTF-16", ENCODE),
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

/// How files start that are compressed with gzip.
const GZIP: &[u8] = &[0x1f, 0x8b, 8];

/// The bytes without the compression of gzip, if they have it. A few bytes can unpack to a thousand times as many, so
/// unpacking ends behind `most`.
fn unpacked(bytes: &[u8], most: u64) -> Result<Cow<'_, [u8]>, ReadError> {
    if !bytes.starts_with(GZIP) {
        return Ok(Cow::Borrowed(bytes));
    }
    #[cfg(feature = "gz")]
    {
        use std::io::Read;
        let mut unpacked = Vec::new();
        flate2::read::MultiGzDecoder::new(bytes)
            .take(most.saturating_add(1))
            .read_to_end(&mut unpacked)
            .map_err(|error| ReadError::Compressed {
                problem: format!(
                    "{}; the file is damaged or was cut off: copy it again",
                    brief(&error.to_string())
                ),
            })?;
        if unpacked.len() as u64 > most {
            let problem = format!(
                "it holds more than {most} bytes, which is the limit; split the mesh, or raise the limit \
                 (`--max-memory` of the program, `Limits` of the library)"
            );
            return Err(ReadError::Compressed { problem });
        }
        if unpacked.starts_with(GZIP) {
            let problem = "it is compressed twice; unpack it once".to_owned();
            return Err(ReadError::Compressed { problem });
        }
        Ok(Cow::Owned(unpacked))
    }
    #[cfg(not(feature = "gz"))]
    {
        let _ = most;
        let problem =
            "this build unpacks nothing; build ldwrap with the feature gz, or unpack the file first";
        Err(ReadError::Compressed { problem: problem.to_owned() })
    }
}

/// The start of what a file or a library says, on one line, for messages.
pub(super) fn brief(text: &str) -> String {
    const LONGEST: usize = 160;
    let mut brief: String = text
        .chars()
        .take(LONGEST)
        .map(|c| if c.is_alphanumeric() || c.is_ascii_graphic() { c } else { ' ' })
        .collect();
    if brief.len() < text.len() {
        brief.push_str("...");
    }
    brief
}

/// Appends a polygon as long as the limits allow the corners, and 32 bits can count them.
pub(super) fn push_polygon(
    soup: &mut PolygonSoup,
    corners: impl IntoIterator<Item = u32>,
    format: MeshFormat,
    limits: &Limits,
) -> Result<(), ReadError> {
    soup.corners.extend(corners);
    let place = Place::Item("face", soup.ends.len());
    limits.corners(format, place, soup.corners.len())?;
    let end = u32::try_from(soup.corners.len()).map_err(|_| ReadError::TooMany {
        format,
        place,
        what: "corners",
        most: u32::MAX,
    })?;
    soup.ends.push(end);
    Ok(())
}

/// A picture that a mesh file names.
#[cfg(any(feature = "obj", feature = "gltf", feature = "ply"))]
pub(super) struct Picture<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) format: MeshFormat,
    /// Where the file names it.
    pub(super) place: Place,
    /// What messages call it.
    pub(super) called: String,
    /// What to do if it cannot be read.
    pub(super) advice: &'static str,
}

#[cfg(any(feature = "obj", feature = "gltf", feature = "ply"))]
impl Picture<'_> {
    /// Adds it to the others; gives its index.
    pub(super) fn decode(self, attributes: &mut MeshAttributes, limits: &Limits) -> Result<usize, ReadError> {
        let Self { bytes, format, place, called, advice } = self;
        let texels = |image: &Image| u64::from(image.size().0) * u64::from(image.size().1);
        let taken: u64 = attributes.images.iter().map(texels).sum();
        let image =
            Image::decode_within(bytes, limits.texels.saturating_sub(taken)).map_err(
                |error| match error {
                    ImageError::TooLarge => {
                        ReadError::TooLarge { format, place, what: "texels", limit: limits.texels }
                    }
                    error => {
                        let what = format!("{called} ({})", brief(&error.to_string()));
                        ReadError::Unsupported { format, place, what, advice }
                    }
                },
            )?;
        attributes.images.push(image);
        Ok(attributes.images.len() - 1)
    }
}
