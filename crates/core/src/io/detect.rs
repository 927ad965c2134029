//! Tells mesh formats apart by their content, then by their name.

use std::fmt;

use crate::io::text::text;

/// How many bytes are looked at for the words of an OBJ or STL file.
const LOOK: usize = 64 * 1024;

/// A mesh file format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// glTF 2.0, as JSON or binary (GLB).
    Gltf,
    /// Polygon file format, ASCII or binary of either byte order.
    Ply,
    /// Stereolithography, ASCII or binary.
    Stl,
    /// Object file format, with or without colours and normals.
    Off,
}

impl MeshFormat {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Obj, Self::Gltf, Self::Ply, Self::Stl, Self::Off];

    /// The format that files with this name have: decided by what follows the last dot, in any case.
    pub fn from_name(name: &str) -> Option<Self> {
        let (_, extension) = name.rsplit_once('.')?;
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "gltf" | "glb" | "vrm" => Some(Self::Gltf),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "off" | "coff" | "noff" => Some(Self::Off),
            _ => None,
        }
    }

    /// The unit of length that the format prescribes: metres in glTF (section 3.4 of its specification). The others say
    /// nothing. Readers leave coordinates alone.
    pub fn unit(self) -> Option<&'static str> {
        (self == Self::Gltf).then_some("metre")
    }

    /// The axis that points up by the rules of the format: +Y in glTF (section 3.4). The others say nothing. Readers leave
    /// coordinates alone.
    pub fn up_axis(self) -> Option<&'static str> {
        (self == Self::Gltf).then_some("+Y")
    }
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Gltf => "glTF",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Off => "OFF",
        })
    }
}

/// The format of a file, by its content; by its name where the content does not tell; `None` if neither does.
pub fn detect(bytes: &[u8], name: Option<&str>) -> Option<MeshFormat> {
    by_content(bytes).or_else(|| name.and_then(MeshFormat::from_name).filter(|_| !bytes.is_empty()))
}

fn by_content(bytes: &[u8]) -> Option<MeshFormat> {
    if bytes.starts_with(b"glTF") {
        return Some(MeshFormat::Gltf);
    }
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        return Some(MeshFormat::Ply);
    }
    // Before any look at words: a binary STL may start with every text.
    if binary_stl_count(bytes).is_some_and(|count| bytes.len() as u64 == binary_stl_size(count)) {
        return Some(MeshFormat::Stl);
    }
    let start = text(&bytes[..bytes.len().min(LOOK)]);
    let start = start.trim_start();
    if start.starts_with('{') && start.contains("\"asset\"") {
        return Some(MeshFormat::Gltf);
    }
    let mut words = start.split_whitespace();
    if let Some(first) = words.next() {
        let first = first.to_ascii_lowercase();
        // Some files have the counts directly behind the word: `OFF490 518 0`.
        let word = first.trim_end_matches(|c: char| c.is_ascii_digit());
        if word.ends_with("off") && word.trim_start_matches(['s', 't', 'c', 'n', '4']) == "off" {
            return Some(MeshFormat::Off);
        }
        let is_stl = |word: &str| word.eq_ignore_ascii_case("facet") || word.eq_ignore_ascii_case("endsolid");
        if first == "solid" && (is_binary_stl(bytes) || words.any(is_stl)) {
            return Some(MeshFormat::Stl);
        }
    }
    let numbers_after = |line: &str, keyword: &str| {
        let mut words = line.split_whitespace();
        words.next() == Some(keyword) && words.take(3).filter(|w| starts_number(w)).count() == 3
    };
    let is_obj = |line: &str| numbers_after(line, "v") || numbers_after(line, "f");
    start.lines().any(is_obj).then_some(MeshFormat::Obj)
}

fn starts_number(word: &str) -> bool {
    word.trim_start_matches(['-', '+', '.']).starts_with(|c: char| c.is_ascii_digit())
}

/// The number of triangles that a binary STL file claims, if there is room for its head.
pub(super) fn binary_stl_count(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(80..84)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]))
}

/// Whether a file that may be binary STL has all the triangles that it claims, and perhaps more bytes. As a number of
/// triangles, four letters are more than any text has room for.
pub(super) fn is_binary_stl(bytes: &[u8]) -> bool {
    binary_stl_count(bytes).is_some_and(|count| binary_stl_size(count) <= bytes.len() as u64)
}

/// How long a binary STL file of this many triangles is.
pub(super) fn binary_stl_size(count: u32) -> u64 {
    84 + 50 * u64::from(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_comes_before_the_name() {
        let detected = |bytes: &[u8]| detect(bytes, Some("wrong.off"));
        assert_eq!(detected(b"ply\nformat ascii 1.0\n"), Some(MeshFormat::Ply));
        assert_eq!(detected(b"glTF\x02\0\0\0"), Some(MeshFormat::Gltf));
        assert_eq!(detected(b"\xef\xbb\xbf { \"asset\": {\"version\": \"2.0\"} }"), Some(MeshFormat::Gltf));
        assert_eq!(detected(b"solid\nfacet normal 0 0 1\n"), Some(MeshFormat::Stl));
        assert_eq!(detected(b"SOLID x\nFACET NORMAL 0 0 1\n"), Some(MeshFormat::Stl));
        assert_eq!(detected(b"# made by\nmtllib a.mtl\nv 0 0 -.5\n"), Some(MeshFormat::Obj));
        for off in ["OFF\n8 6 12\n", "COFF\n1 1 1\n", "STCNOFF\n", "OFF490 518 0\n", "# c\nOFF\n"] {
            let expected = if off.starts_with('#') { None } else { Some(MeshFormat::Off) };
            assert_eq!(detect(off.as_bytes(), None), expected, "{off}");
        }
        let mut binary = b"solid that is binary".to_vec();
        binary.resize(84 + 100, 0);
        binary[80] = 2;
        assert_eq!(detected(&binary), Some(MeshFormat::Stl));
        assert_eq!(detected(&[&binary[..], b"and more"].concat()), Some(MeshFormat::Stl));
        assert_eq!(detected(b"# made by\rv 0 0 0\rv 1 0 0\r"), Some(MeshFormat::Obj));
    }

    #[test]
    fn the_name_decides_the_rest() {
        assert_eq!(detect(b"# nothing yet\n", Some("dir.ply/a.b.OBJ")), Some(MeshFormat::Obj));
        assert_eq!(detect(b"hello", Some("hello.txt")), None);
        assert_eq!(detect(b"hello", None), None);
        assert_eq!(detect(b"", Some("a.obj")), None);
    }
}
