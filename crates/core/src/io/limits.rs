//! How much a file may ask for.

use crate::io::detect::MeshFormat;
use crate::io::read::{Place, ReadError};

/// The most that reading a file may take. Heads of files are held against it before anything is allocated, and so is
/// what a few bytes can ask for many times over: compressed data, repeated meshes, pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Limits {
    /// Bytes of the file, unpacked. Default: 16 GiB (1 GiB where memory has 32-bit addresses).
    pub bytes: u64,
    /// Vertices. Default: 2^28 (2^24).
    pub vertices: usize,
    /// Corners of all polygons; of triangles there are a third as many. Default: 2^29 (2^25).
    pub corners: usize,
    /// Texels of all pictures. Default: 2^29 (2^26).
    pub texels: u64,
}

impl Default for Limits {
    fn default() -> Self {
        if usize::BITS < 64 {
            Self { bytes: 1 << 30, vertices: 1 << 24, corners: 1 << 25, texels: 1 << 26 }
        } else {
            Self { bytes: 1 << 34, vertices: 1 << 28, corners: 1 << 29, texels: 1 << 29 }
        }
    }
}

impl Limits {
    /// What fits in so many bytes of memory, with room to check and to sample it: a sphere of a million triangles took 430
    /// bytes a triangle for all stages up to wrapping. Never above the default.
    pub fn for_memory(bytes: u64) -> Self {
        let most = Self::default();
        let count = |each: u64, most: usize| usize::try_from(bytes / each).unwrap_or(most).min(most);
        Self {
            bytes: (bytes / 4).min(most.bytes),
            vertices: count(150, most.vertices),
            corners: count(150, most.corners),
            texels: (bytes / 16).min(most.texels),
        }
    }

    /// Refuses more vertices.
    pub(super) fn vertices(&self, format: MeshFormat, place: Place, count: usize) -> Result<(), ReadError> {
        within(format, place, "vertices", count as u64, self.vertices as u64)
    }

    /// Refuses more corners.
    pub(super) fn corners(&self, format: MeshFormat, place: Place, count: usize) -> Result<(), ReadError> {
        within(format, place, "corners", count as u64, self.corners as u64)
    }
}

fn within(
    format: MeshFormat,
    place: Place,
    what: &'static str,
    count: u64,
    limit: u64,
) -> Result<(), ReadError> {
    if count > limit { Err(ReadError::TooLarge { format, place, what, limit }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Detail, ReadOptions, read_model_with};

    fn read(text: &str, limits: Limits) -> Result<usize, ReadError> {
        let options = ReadOptions { limits, detail: Detail::Textures, ..ReadOptions::default() };
        read_model_with(text.as_bytes(), &options, &|_| Err(String::new()))
            .map(|model| model.soup.polygon_count())
    }

    #[test]
    fn exactly_as_much_as_the_limits_allow() {
        let text = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        let enough = Limits { bytes: text.len() as u64, vertices: 3, corners: 3, texels: 0 };
        assert_eq!(read(text, enough), Ok(1));
        let what = |limits| match read(text, limits) {
            Err(ReadError::TooLarge { what, limit, .. }) => (what, limit),
            other => panic!("{other:?}"),
        };
        assert_eq!(what(Limits { vertices: 2, ..enough }), ("vertices", 2));
        assert_eq!(what(Limits { corners: 2, ..enough }), ("corners", 2));
        let bytes = enough.bytes - 1;
        assert_eq!(what(Limits { bytes, ..enough }), ("bytes", bytes));
    }

    #[test]
    fn memory_as_limits() {
        assert_eq!(Limits::for_memory(u64::MAX), Limits::default());
        let small = Limits::for_memory(3 << 20);
        assert_eq!((small.bytes, small.vertices), ((3 << 20) / 4, (3 << 20) / 150));
    }
}
