//! Binary elements as nearly all files have them, without a name looked up for each number: positions as singles or
//! doubles, polygons as lists of 32 bit integers with their lengths in a byte. All else is `ply-rs-bw`'s.

use glam::DVec3;
use ply_rs_bw::ply::{ElementDef, Encoding, PropertyType, ScalarType};

use super::{is_corners, scalar_size};
use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::read::{ReadError, push_polygon};
use crate::mesh::PolygonSoup;

/// The positions of vertices, and how many bytes they take; `None` if they are not plain or not all there.
pub(super) fn positions(
    bytes: &[u8],
    element: &ElementDef,
    encoding: Encoding,
) -> Option<(Vec<DVec3>, usize)> {
    let big = is_big(encoding)?;
    let single = |bytes| if big { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) };
    let double = |bytes| if big { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) };
    let mut places = [None; 3];
    let mut size = 0;
    let mut kind = None;
    for (name, property) in &element.properties {
        let PropertyType::Scalar(scalar) = &property.data_type else { return None };
        if let Some(axis) = ["x", "y", "z"].iter().position(|axis| axis == name) {
            // All three of one type, which is that of the first.
            if *kind.get_or_insert(scalar) != scalar {
                return None;
            }
            places[axis] = Some(size);
        }
        size += scalar_size(scalar);
    }
    let [Some(x), Some(y), Some(z)] = places else { return None };
    let length = size.checked_mul(element.count)?;
    let vertices = bytes.get(..length)?.chunks_exact(size);
    let singles =
        |vertex: &[u8], at: usize| vertex[at..].first_chunk().map(|bytes| f64::from(single(*bytes)));
    let doubles = |vertex: &[u8], at: usize| vertex[at..].first_chunk().map(|bytes| double(*bytes));
    let positions = match kind? {
        ScalarType::Float => vertices
            .map(|v| Some(DVec3::new(singles(v, x)?, singles(v, y)?, singles(v, z)?)))
            .collect::<Option<_>>()?,
        ScalarType::Double => vertices
            .map(|v| Some(DVec3::new(doubles(v, x)?, doubles(v, y)?, doubles(v, z)?)))
            .collect::<Option<_>>()?,
        _ => return None,
    };
    Some((positions, length))
}

/// Adds polygons, and gives how many bytes they take; `None` if they are not plain, not all there or a corner is negative,
/// and then none is added.
pub(super) fn add_polygons(
    soup: &mut PolygonSoup,
    bytes: &[u8],
    element: &ElementDef,
    encoding: Encoding,
    limits: &Limits,
) -> Option<Result<usize, ReadError>> {
    let mut properties = element.properties.iter();
    let (Some((name, property)), None) = (properties.next(), properties.next()) else { return None };
    let most = match property.data_type {
        PropertyType::List(ScalarType::UChar, ScalarType::Int) => i32::MAX as u32,
        PropertyType::List(ScalarType::UChar, ScalarType::UInt) => u32::MAX,
        _ => return None,
    };
    let big = is_big(encoding).filter(|_| is_corners(name))?;
    let read = |bytes| if big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) };
    let before = (soup.corners.len(), soup.ends.len());
    let mut rest = bytes;
    for _ in 0..element.count {
        let polygon =
            rest.split_first().and_then(|(&length, rest)| rest.split_at_checked(4 * usize::from(length)));
        let corners = polygon.map(|(corners, _)| corners.as_chunks().0.iter().map(|&corner| read(corner)));
        let corners = corners.filter(|corners| corners.clone().all(|corner| corner <= most));
        let (Some((_, after)), Some(corners)) = (polygon, corners) else {
            soup.corners.truncate(before.0);
            soup.ends.truncate(before.1);
            return None;
        };
        if let Err(error) = push_polygon(soup, corners, MeshFormat::Ply, limits) {
            return Some(Err(error));
        }
        rest = after;
    }
    Some(Ok(bytes.len() - rest.len()))
}

/// Whether the largest byte of a number comes first; `None` for text.
fn is_big(encoding: Encoding) -> Option<bool> {
    match encoding {
        Encoding::Ascii => None,
        Encoding::BinaryLittleEndian => Some(false),
        Encoding::BinaryBigEndian => Some(true),
    }
}
