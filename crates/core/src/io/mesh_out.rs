//! Meshes out: OBJ, OFF, binary PLY and binary STL.

use std::io::Write;

use glam::DVec3;
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess, PropertyDef, PropertyType, ScalarType};
use ply_rs_bw::writer::Writer;

use crate::geometry::triangle;
use crate::mesh::PolygonSoup;

/// Why a soup cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshWriteError {
    /// The name does not end in a format that can be written.
    #[error("{0:?} names no mesh format that can be written: end it in .obj, .ply, .stl or .off")]
    UnknownFormat(String),
    /// A polygon has a corner that is not a vertex.
    #[error("polygon {polygon} has the corner {corner}, but there are only {vertices} vertices")]
    CornerOutOfRange {
        /// The polygon.
        polygon: usize,
        /// Its corner.
        corner: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// STL holds triangles only.
    #[error("polygon {polygon} has {corners} corners, but STL holds triangles only: write OBJ, PLY or OFF")]
    NotATriangle {
        /// The polygon.
        polygon: usize,
        /// How many corners it has.
        corners: usize,
    },
}

/// The bytes of a mesh file in the format that `name` ends in: `.obj`, `.ply`, `.stl` or `.off`, in any case. Linear.
///
/// # Errors
/// [`MeshWriteError`].
pub fn write_mesh(soup: &PolygonSoup, name: &str) -> Result<Vec<u8>, MeshWriteError> {
    let extension = name.rsplit_once('.').map_or(name, |(_, extension)| extension).to_ascii_lowercase();
    match extension.as_str() {
        "obj" => write_obj(soup),
        "ply" => write_ply(soup),
        "stl" => write_stl(soup),
        "off" => write_off(soup),
        _ => Err(MeshWriteError::UnknownFormat(name.to_owned())),
    }
}

/// Wavefront OBJ: `v` and `f` lines. Numbers are the shortest that read back as the same doubles.
///
/// # Errors
/// [`MeshWriteError::CornerOutOfRange`].
pub fn write_obj(soup: &PolygonSoup) -> Result<Vec<u8>, MeshWriteError> {
    let mut out = Vec::new();
    for p in &soup.positions {
        line(&mut out, format_args!("v {:?} {:?} {:?}", p.x, p.y, p.z));
    }
    for polygon in polygons(soup)? {
        out.push(b'f');
        for &corner in polygon {
            text(&mut out, format_args!(" {}", u64::from(corner) + 1));
        }
        out.push(b'\n');
    }
    Ok(out)
}

/// Object file format (Geomview), ASCII. Numbers are the shortest that read back as the same doubles.
///
/// # Errors
/// [`MeshWriteError::CornerOutOfRange`].
pub fn write_off(soup: &PolygonSoup) -> Result<Vec<u8>, MeshWriteError> {
    let mut out = Vec::new();
    line(&mut out, format_args!("OFF\n{} {} 0", soup.positions.len(), soup.polygon_count()));
    for p in &soup.positions {
        line(&mut out, format_args!("{:?} {:?} {:?}", p.x, p.y, p.z));
    }
    for polygon in polygons(soup)? {
        text(&mut out, format_args!("{}", polygon.len()));
        for corner in polygon {
            text(&mut out, format_args!(" {corner}"));
        }
        out.push(b'\n');
    }
    Ok(out)
}

/// STL, binary: coordinates and normals in single precision.
///
/// # Errors
/// [`MeshWriteError`].
pub fn write_stl(soup: &PolygonSoup) -> Result<Vec<u8>, MeshWriteError> {
    let mut out = Vec::with_capacity(84 + 50 * soup.polygon_count());
    // A head that starts with `solid` would pass for ASCII.
    out.extend_from_slice(&[b' '; 80]);
    out.extend_from_slice(&(soup.polygon_count() as u32).to_le_bytes());
    for (index, polygon) in polygons(soup)?.enumerate() {
        let &[a, b, c] = polygon else {
            return Err(MeshWriteError::NotATriangle { polygon: index, corners: polygon.len() });
        };
        let corners = [a, b, c].map(|v| soup.positions[v as usize]);
        let normal = triangle::area_vector(corners[0], corners[1], corners[2]).normalize_or_zero();
        for vector in [normal, corners[0], corners[1], corners[2]] {
            vector.as_vec3().to_array().iter().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
        }
        out.extend_from_slice(&[0, 0]);
    }
    Ok(out)
}

/// PLY, binary little-endian: `double` x, y, z and lists of `uint` in `vertex_indices`.
///
/// # Errors
/// [`MeshWriteError::CornerOutOfRange`].
pub fn write_ply(soup: &PolygonSoup) -> Result<Vec<u8>, MeshWriteError> {
    let mut vertex = ElementDef::new("vertex".to_owned());
    vertex.count = soup.positions.len();
    for name in ["x", "y", "z"] {
        let property = PropertyDef::new(name.to_owned(), PropertyType::Scalar(ScalarType::Double));
        vertex.properties.insert(name.to_owned(), property);
    }
    let mut face = ElementDef::new("face".to_owned());
    face.count = soup.polygon_count();
    // Most readers expect a single byte for the number of corners.
    let most = polygons(soup)?.map(<[u32]>::len).max().unwrap_or(0);
    let length = if most <= usize::from(u8::MAX) { ScalarType::UChar } else { ScalarType::UInt };
    let indices = PropertyDef::new("vertex_indices".to_owned(), PropertyType::List(length, ScalarType::UInt));
    face.properties.insert(indices.name.clone(), indices);
    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    for element in [&vertex, &face] {
        header.elements.insert(element.name.clone(), element.clone());
    }

    let mut out = Vec::new();
    let (points, lists) = (Writer::<Vertex>::new(), Writer::<Corners<'_>>::new());
    let written = points.write_header(&mut out, &header).and_then(|_| {
        for &p in &soup.positions {
            points.write_little_endian_element(&mut out, &Vertex(p), &vertex)?;
        }
        for polygon in polygons(soup).into_iter().flatten() {
            lists.write_little_endian_element(&mut out, &Corners(polygon), &face)?;
        }
        Ok(())
    });
    debug_assert!(written.is_ok(), "memory takes every byte, and every property has a value");
    Ok(out)
}

struct Vertex(DVec3);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self(DVec3::ZERO)
    }

    fn get_double(&self, name: &str) -> Option<f64> {
        match name {
            "x" => Some(self.0.x),
            "y" => Some(self.0.y),
            "z" => Some(self.0.z),
            _ => None,
        }
    }
}

struct Corners<'a>(&'a [u32]);

impl PropertyAccess for Corners<'_> {
    fn new() -> Self {
        Self(&[])
    }

    fn get_list_uint(&self, _: &str) -> Option<&[u32]> {
        Some(self.0)
    }
}

/// All polygons, their corners checked.
fn polygons(soup: &PolygonSoup) -> Result<impl Iterator<Item = &[u32]>, MeshWriteError> {
    let vertices = soup.positions.len();
    for polygon in 0..soup.polygon_count() {
        if let Some(&corner) = soup.polygon(polygon).iter().find(|&&c| c as usize >= vertices) {
            return Err(MeshWriteError::CornerOutOfRange { polygon, corner, vertices });
        }
    }
    Ok((0..soup.polygon_count()).map(|polygon| soup.polygon(polygon)))
}

fn line(out: &mut Vec<u8>, words: std::fmt::Arguments<'_>) {
    text(out, words);
    out.push(b'\n');
}

fn text(out: &mut Vec<u8>, words: std::fmt::Arguments<'_>) {
    out.write_fmt(words).expect("memory takes every byte");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle and a square, with coordinates that need all their digits.
    fn house() -> PolygonSoup {
        let positions = [(0.0, 0.0), (0.1, 0.0), (0.1, 1.0 / 3.0), (0.0, 1.0 / 3.0), (0.05, 1e-20)]
            .map(|(x, y)| DVec3::new(x, y, -2.5));
        let mut soup = PolygonSoup { positions: positions.to_vec(), ..PolygonSoup::default() };
        soup.push_polygon(&[0, 1, 2, 3]);
        soup.push_polygon(&[3, 2, 4]);
        soup
    }

    fn triangles() -> PolygonSoup {
        crate::shapes::tetrahedron()
    }

    #[test]
    fn obj_by_hand() {
        let expected = "v 0.0 0.0 -2.5\nv 0.1 0.0 -2.5\nv 0.1 0.3333333333333333 -2.5\nv 0.0 0.3333333333333333 -2.5\n\
                        v 0.05 1e-20 -2.5\nf 1 2 3 4\nf 4 3 5\n";
        assert_eq!(String::from_utf8(write_mesh(&house(), "a.b/house.OBJ").unwrap()).unwrap(), expected);
    }

    #[test]
    fn off_by_hand() {
        let bytes = write_mesh(&house(), "house.off").unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.starts_with("OFF\n5 2 0\n0.0 0.0 -2.5\n"), "{text}");
        assert!(text.ends_with("0.05 1e-20 -2.5\n4 0 1 2 3\n3 3 2 4\n"), "{text}");
    }

    #[test]
    fn stl_by_hand() {
        let bytes = write_mesh(&triangles(), "t.stl").unwrap();
        assert_eq!(bytes.len(), 84 + 4 * 50);
        assert_eq!(bytes[80..84], [4, 0, 0, 0]);
        let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        // The first corner of the first triangle, after its normal.
        assert_eq!([number(96), number(100), number(104)], [1.0, 1.0, 1.0]);
        let normal = DVec3::new(1.0, 1.0, -1.0) / 3.0_f64.sqrt();
        assert!((f64::from(number(84)) - normal.x).abs() < 1e-7 && f64::from(number(92)) < 0.0);
        assert_eq!(
            write_stl(&house()),
            Err(MeshWriteError::NotATriangle { polygon: 0, corners: 4 }),
            "a square is not split in silence"
        );
    }

    #[test]
    fn ply_by_hand() {
        let bytes = write_mesh(&house(), "house.ply").unwrap();
        let head = "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty double x\nproperty double y\n\
                    property double z\nelement face 2\nproperty list uchar uint vertex_indices\nend_header\n";
        let (start, data) = bytes.split_at(head.len());
        assert_eq!(String::from_utf8_lossy(start), head);
        assert_eq!(data.len(), 5 * 24 + (1 + 16) + (1 + 12));
        assert_eq!(data[24..32], 0.1_f64.to_le_bytes());
        assert_eq!(data[120..125], [4, 0, 0, 0, 0]);
        assert_eq!(data[137..142], [3, 3, 0, 0, 0]);
    }

    #[test]
    fn what_cannot_be_written() {
        let mut soup = house();
        soup.push_polygon(&[0, 1, 5]);
        for name in ["a.obj", "a.off", "a.ply", "a.stl"] {
            let error = write_mesh(&soup, name).unwrap_err();
            assert_eq!(
                error,
                MeshWriteError::CornerOutOfRange { polygon: 2, corner: 5, vertices: 5 },
                "{name}"
            );
        }
        let error = write_mesh(&house(), "house.gltf").unwrap_err();
        assert_eq!(
            error.to_string(),
            "\"house.gltf\" names no mesh format that can be written: end it in .obj, .ply, .stl or .off"
        );
    }
}
