//! Points as PLY.

use std::io;

use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType,
};
use ply_rs_bw::writer::Writer;

use crate::io::points::{COLUMNS, PointPlace, PointRow, Points, PointsError};
use crate::sample::Origin;

pub(super) const BINARY: Encoding = Encoding::BinaryLittleEndian;
pub(super) const ASCII: Encoding = Encoding::Ascii;

pub(super) fn write(rows: &[PointRow], encoding: Encoding, mut out: &mut dyn io::Write) -> io::Result<()> {
    let mut vertex = ElementDef::new("vertex".to_owned());
    vertex.count = rows.len();
    for name in COLUMNS {
        let scalar = match name {
            "nx" | "ny" | "nz" => ScalarType::Float,
            // Some readers know no unsigned 32-bit numbers; faces and strips are below 2^31.
            "face" | "strip" => ScalarType::Int,
            "origin" => ScalarType::UChar,
            _ => ScalarType::Double,
        };
        let property = PropertyDef::new(name.to_owned(), PropertyType::Scalar(scalar));
        vertex.properties.insert(name.to_owned(), property);
    }
    let mut header = Header::new();
    header.encoding = encoding;
    header.comments.push("origin: 0 wrapped, 1 projected, 2 equalized".to_owned());
    header.elements.insert(vertex.name.clone(), vertex.clone());
    let writer = Writer::<Row<'_>>::new();
    writer.write_header(&mut out, &header)?;
    for row in rows {
        let row = Row(Some(row));
        if encoding == ASCII {
            writer.write_ascii_element(&mut out, &row, &vertex)?;
        } else {
            writer.write_little_endian_element(&mut out, &row, &vertex)?;
        }
    }
    Ok(())
}

/// A row to be written; the library's trait asks for an empty one too.
struct Row<'a>(Option<&'a PointRow>);

impl PropertyAccess for Row<'_> {
    fn new() -> Self {
        Self(None)
    }

    fn get_double(&self, name: &str) -> Option<f64> {
        let row = self.0?;
        let [b0, b1, b2] = row.sample.point.barycentric;
        Some(match name {
            "x" => row.position.x,
            "y" => row.position.y,
            "z" => row.position.z,
            "b0" => b0,
            "b1" => b1,
            "b2" => b2,
            "place_x" => row.sample.place.x,
            "place_y" => row.sample.place.y,
            _ => return None,
        })
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        let normal = self.0?.normal.as_vec3();
        Some(match name {
            "nx" => normal.x,
            "ny" => normal.y,
            "nz" => normal.z,
            _ => return None,
        })
    }

    fn get_int(&self, name: &str) -> Option<i32> {
        let sample = &self.0?.sample;
        let id = match name {
            "face" => sample.point.face.0,
            "strip" => sample.strip.0,
            _ => return None,
        };
        i32::try_from(id).ok()
    }

    fn get_uchar(&self, _: &str) -> Option<u8> {
        Some(match self.0?.sample.origin {
            Origin::Wrapped => 0,
            Origin::Projected => 1,
            Origin::Equalized => 2,
        })
    }
}

pub(super) fn read(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    let parser = Parser::<Position>::new();
    let mut reader = Reader::new(bytes);
    let header = parser.read_header(&mut reader).map_err(|error| located(points, &error))?;
    for (name, element) in &header.elements {
        // An element without properties takes no bytes, so no end of the file would ever stop it.
        if element.properties.is_empty() && element.count > 0 {
            return Err(points.malformed(PointPlace::File, format!("the element {name} has no properties")));
        }
        let elements = parser
            .read_payload_for_element(&mut reader, element, &header)
            .map_err(|error| located(points, &error))?;
        if name == "vertex" {
            for axis in ["x", "y", "z"] {
                if !element
                    .properties
                    .get(axis)
                    .is_some_and(|p| matches!(p.data_type, PropertyType::Scalar(_)))
                {
                    return Err(points.malformed(PointPlace::File, format!("a vertex has no number {axis}")));
                }
            }
            for (index, position) in elements.into_iter().enumerate() {
                points.push(position.0, PointPlace::Point(index))?;
            }
            return Ok(());
        }
    }
    Err(points.malformed(PointPlace::File, "there is no element called vertex"))
}

fn located(points: &Points, error: &ply_rs_bw::parser::ParseError) -> PointsError {
    let place = error.line().map_or(PointPlace::File, |line| PointPlace::Line(line as u64));
    points.malformed(place, error.to_string())
}

struct Position(DVec3);

impl PropertyAccess for Position {
    fn new() -> Self {
        Self(DVec3::ZERO)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => &mut self.0.x,
            "y" => &mut self.0.y,
            "z" => &mut self.0.z,
            _ => return PropertyAccessResult::Ignored,
        };
        *slot = match property {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}
