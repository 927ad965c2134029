//! Reads STL, both kinds, with `stl_io`.

use std::io::{Cursor, ErrorKind};

use glam::DVec3;

use crate::io::detect::{MeshFormat, binary_stl_count, binary_stl_size, is_binary_stl};
use crate::io::limits::Limits;
use crate::io::read::{Detail, Model, Place, ReadError, brief, push_polygon};
use crate::io::text::text;
use crate::mesh::PolygonSoup;

/// Reads an STL file with the names of its solids as parts, which binary files do not have.
///
/// # Errors
/// As [`read`].
pub fn read_model(bytes: &[u8], detail: Detail) -> Result<Model, ReadError> {
    read_within(bytes, detail, &Limits::default())
}

pub(super) fn read_within(bytes: &[u8], detail: Detail, limits: &Limits) -> Result<Model, ReadError> {
    let mut model = Model::from(read_shape(bytes, limits)?);
    if detail >= Detail::Attributes && is_ascii(bytes) {
        let (mut polygon, mut name) = (0, None);
        for line in text(bytes).lines() {
            let line = line.trim();
            let (keyword, rest) = line.split_once([' ', '\t']).unwrap_or((line, ""));
            match keyword.to_ascii_lowercase().as_str() {
                "solid" => {
                    let rest = rest.trim();
                    name = (!rest.is_empty()).then(|| model.attributes.parts.push(rest));
                }
                "facet" => {
                    model.attributes.parts.set(polygon..polygon + 1, name);
                    polygon += 1;
                }
                _ => {}
            }
        }
    }
    Ok(model)
}

/// Whether a file is text.
fn is_ascii(bytes: &[u8]) -> bool {
    !is_binary_stl(bytes)
        && text(&bytes[..bytes.len().min(512)]).trim_start().to_ascii_lowercase().starts_with("solid")
}

/// Reads an STL file. Every triangle gets its own three vertices: checking the soup welds them. Binary files that
/// start with `solid` are known by their length, ASCII files may hold several solids, in capitals too.
///
/// # Errors
/// [`ReadError`]: with the triangle.
pub fn read(bytes: &[u8]) -> Result<PolygonSoup, ReadError> {
    read_shape(bytes, &Limits::default())
}

fn read_shape(bytes: &[u8], limits: &Limits) -> Result<PolygonSoup, ReadError> {
    let size = binary_stl_count(bytes).map(binary_stl_size);
    let mut soup = PolygonSoup::default();
    if is_ascii(bytes) {
        for solid in solids(&text(bytes)) {
            append(&mut soup, solid.as_bytes(), limits)?;
        }
        return Ok(soup);
    }
    match size {
        Some(size) if size <= bytes.len() as u64 => {}
        Some(size) => {
            return Err(ReadError::Truncated {
                format: MeshFormat::Stl,
                place: Place::Byte(80),
                problem: format!("{size} bytes are needed for its triangles, but there are {}", bytes.len()),
            });
        }
        None => {
            return Err(ReadError::Truncated {
                format: MeshFormat::Stl,
                place: Place::Byte(bytes.len()),
                problem: "it neither starts with `solid` nor has the 84 bytes of a binary head".into(),
            });
        }
    }
    if bytes.starts_with(b"solid ") {
        // The library takes every file with this start for text.
        let mut copy = bytes.to_vec();
        copy[0] = b'b';
        append(&mut soup, &copy, limits)?;
    } else {
        append(&mut soup, bytes, limits)?;
    }
    Ok(soup)
}

/// The text cut into one string a solid, as the library expects it: small letters, a name, an end; normals that are
/// numbers, which nobody reads.
fn solids(text: &str) -> Vec<String> {
    let mut solids = Vec::new();
    let mut solid = String::new();
    for line in text.lines() {
        let line = line.trim().to_ascii_lowercase();
        let mut words = line.split_whitespace();
        match words.next() {
            Some("facet") if words.next() == Some("normal") => solid.push_str("facet normal 0 0 0\n"),
            Some("solid") => solid = "solid x\n".into(),
            Some("endsolid") => {
                solid.push_str("endsolid\n");
                solids.push(std::mem::take(&mut solid));
            }
            _ => {
                solid.push_str(&line);
                solid.push('\n');
            }
        }
    }
    if solid.starts_with("solid") {
        solids.push(solid); // without an end: the library says so
    }
    solids
}

fn append(soup: &mut PolygonSoup, bytes: &[u8], limits: &Limits) -> Result<(), ReadError> {
    let error = |soup: &PolygonSoup, error: std::io::Error| {
        let (format, place) = (MeshFormat::Stl, Place::Item("triangle", soup.polygon_count()));
        let problem = brief(&error.to_string());
        match error.kind() {
            ErrorKind::UnexpectedEof => ReadError::Truncated { format, place, problem },
            _ => ReadError::Malformed { format, place, problem },
        }
    };
    let mut reader = Cursor::new(bytes);
    for triangle in stl_io::create_stl_reader(&mut reader).map_err(|e| error(soup, e))? {
        let triangle = triangle.map_err(|e| error(soup, e))?;
        // There cannot be more vertices than corners, which are counted here.
        let first = soup.positions.len() as u32;
        push_polygon(soup, [first, first.wrapping_add(1), first.wrapping_add(2)], MeshFormat::Stl, limits)?;
        let place = Place::Item("triangle", soup.polygon_count() - 1);
        limits.vertices(MeshFormat::Stl, place, soup.positions.len() + 3)?;
        soup.positions.extend(triangle.vertices.map(|v| DVec3::from_array(v.0.map(f64::from))));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid name
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1 0 0
      vertex 0 1.5e0 0
    endloop
  endfacet
endsolid name
";

    fn binary(head: &[u8], triangles: u32) -> Vec<u8> {
        let mut bytes = head.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(triangles.to_le_bytes());
        for t in 0..triangles {
            let corners = [[0., 0., 1.], [0., 0., t as f32], [1., 0., 0.], [0., 1., 0.]];
            bytes.extend(corners.as_flattened().iter().flat_map(|x: &f32| x.to_le_bytes()));
            bytes.extend([0, 0]);
        }
        bytes
    }

    #[test]
    fn text_in_all_manners() {
        let soup = read(TEXT.as_bytes()).unwrap();
        assert_eq!(soup.positions[2], DVec3::new(0.0, 1.5, 0.0));
        assert_eq!(
            (soup.positions.len(), soup.corners.clone(), soup.ends.clone()),
            (3, vec![0, 1, 2], vec![3])
        );
        for same in [
            TEXT.to_uppercase(),
            TEXT.replace(" name", ""),
            TEXT.replace('\n', "\r\n"),
            TEXT.replace('\n', "\r"),
            TEXT.replace("normal 0 0 1", "normal nan inf -1.#IND"),
            format!("\u{feff}  {TEXT}\n\n"),
        ] {
            assert_eq!(read(same.as_bytes()).unwrap(), soup, "{same}");
        }
        assert_eq!(read(TEXT.repeat(3).as_bytes()).unwrap().corners, [0, 1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(read(b"solid empty\nendsolid\n").unwrap(), PolygonSoup::default());
    }

    #[test]
    fn binary_also_when_it_starts_with_solid() {
        for head in [&b"made by hand"[..], b"solid", b"solid really not"] {
            let soup = read(&binary(head, 2)).unwrap();
            assert_eq!((soup.positions.len(), soup.polygon_count()), (6, 2));
            assert_eq!(soup.positions[3], DVec3::Z);
        }
        for head in [&b"x"[..], b"solid x"] {
            let mut longer = binary(head, 1);
            longer.extend(b"trailing");
            assert_eq!(read(&longer).unwrap().polygon_count(), 1);
        }
    }

    #[test]
    fn bad_files_are_named() {
        let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert!(message(b"").contains("84 bytes"));
        let whole = binary(b"x", 2);
        for length in [84, 100, 183] {
            assert!(message(&whole[..length]).contains("184 bytes are needed"), "{length}");
        }
        let mut lying = whole.clone();
        lying[80..84].fill(0xff);
        assert!(message(&lying).contains("cut off"));
        assert!(message(&TEXT.as_bytes()[..60]).starts_with("STL, triangle 0"));
        assert!(message(TEXT.replace("endsolid name", "").as_bytes()).contains("triangle 1: EOF"));
        assert!(message(TEXT.replace("1.5e0", "one").as_bytes()).contains("triangle 0: invalid float"));
        assert!(message(TEXT.replace("1.5e0", "nan").as_bytes()).contains("finite"));
    }
}
