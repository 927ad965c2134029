//! What all mesh readers share: their errors, and the choice of the reader.

use std::borrow::Cow;
use std::fmt;

use crate::io::detect::{MeshFormat, detect};
use crate::mesh::PolygonSoup;

/// Fetches what a mesh file names beside itself (the buffers of a `.gltf`), by its relative address; an `Err` says
/// why it cannot be had. Keeping the address inside a folder is up to the resolver.
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

/// Reads a mesh in any format. `name` is looked at only if the content does not tell the format; `resolver` is
/// asked for the external buffers of glTF, by nothing else. Units and axes stay those of the file.
///
/// # Errors
/// [`ReadError`].
pub fn read_mesh(
    bytes: &[u8],
    name: Option<&str>,
    resolver: &Resolver<'_>,
) -> Result<PolygonSoup, ReadError> {
    match detect(bytes, name).ok_or(ReadError::UnknownFormat)? {
        #[cfg(feature = "obj")]
        MeshFormat::Obj => crate::io::obj::read(bytes),
        #[cfg(feature = "gltf")]
        MeshFormat::Gltf => crate::io::gltf::read(bytes, resolver),
        #[cfg(feature = "ply")]
        MeshFormat::Ply => crate::io::ply::read(bytes),
        #[cfg(feature = "stl")]
        MeshFormat::Stl => crate::io::stl::read(bytes),
        MeshFormat::Off => crate::io::off::read(bytes),
        #[allow(unreachable_patterns)]
        format => {
            let _ = resolver;
            Err(ReadError::Disabled { format })
        }
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
