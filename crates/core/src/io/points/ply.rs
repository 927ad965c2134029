//! Points as PLY.

use std::collections::BTreeMap;
use std::io;

use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType,
};
use ply_rs_bw::writer::Writer;

use crate::io::ply::first_line;
use crate::io::points::field::{origin_number, unique};
use crate::io::points::{Field, FieldData, PointPlace, Points, PointsError, Precision};

pub(super) const BINARY: Encoding = Encoding::BinaryLittleEndian;
pub(super) const ASCII: Encoding = Encoding::Ascii;

pub(super) fn write(fields: &[Field], encoding: Encoding, mut out: &mut dyn io::Write) -> io::Result<()> {
    let mut vertex = ElementDef::new("vertex".to_owned());
    vertex.count = fields.first().map_or(0, Field::point_count);
    let mut header = Header::new();
    header.encoding = encoding;
    let mut columns = BTreeMap::new();
    for field in fields {
        let scalar = match &field.data {
            FieldData::Real(_, Precision::Double) => ScalarType::Double,
            FieldData::Real(_, Precision::Single) => ScalarType::Float,
            // Some readers know no unsigned 32-bit numbers; faces and strips are below 2^31.
            FieldData::Id(_) | FieldData::Name { .. } => ScalarType::Int,
            FieldData::Byte(_) | FieldData::Origin(_) => ScalarType::UChar,
        };
        if let FieldData::Origin(_) = field.data {
            header.comments.push("origin: 0 wrapped, 1 projected, 2 equalized".to_owned());
        }
        if let FieldData::Name { names, .. } = &field.data {
            for (index, name) in names.iter().enumerate() {
                header.comments.push(format!("{} {index} {}", field.key, one_line(name)));
            }
        }
        for (column, name) in field.columns.iter().enumerate() {
            // What other programs look for.
            let name = match (&*field.key, &**name) {
                ("uv", "u") => "s".to_owned(),
                ("uv", "v") => "t".to_owned(),
                _ => property_name(name),
            };
            // Such as `s` beside texture coordinates.
            let name = unique(name, |name| columns.contains_key(name));
            let property = PropertyDef::new(name.clone(), PropertyType::Scalar(scalar.clone()));
            vertex.properties.insert(name.clone(), property);
            columns.insert(name, (field, column));
        }
    }
    header.elements.insert(vertex.name.clone(), vertex.clone());
    let writer = Writer::<Row<'_>>::new();
    writer.write_header(&mut out, &header)?;
    for point in 0..vertex.count {
        let row = Row { columns: Some(&columns), point };
        if encoding == ASCII {
            writer.write_ascii_element(&mut out, &row, &vertex)?;
        } else {
            writer.write_little_endian_element(&mut out, &row, &vertex)?;
        }
    }
    Ok(())
}

/// A name that a comment of one line can hold, in UTF-8: readers pass over comments.
fn one_line(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// A name that every reader takes for one of a property.
fn property_name(name: &str) -> String {
    name.chars()
        .map(|c| {
            if c.is_ascii_graphic() {
                c
            } else if c == ' ' {
                '_'
            } else {
                '?'
            }
        })
        .collect()
}

/// A point to be written; the library's trait asks for an empty one too.
struct Row<'a> {
    columns: Option<&'a BTreeMap<String, (&'a Field, usize)>>,
    point: usize,
}

impl<'a> Row<'a> {
    /// The values of a property, and the place of this point's among them.
    fn find(&self, name: &str) -> Option<(&'a FieldData, usize)> {
        let (field, column) = self.columns?.get(name)?;
        Some((&field.data, self.point * field.columns.len() + column))
    }
}

impl PropertyAccess for Row<'_> {
    fn new() -> Self {
        Self { columns: None, point: 0 }
    }

    fn get_double(&self, name: &str) -> Option<f64> {
        match self.find(name)? {
            (FieldData::Real(values, _), place) => values.get(place).copied(),
            _ => None,
        }
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        self.get_double(name).map(|value| value as f32)
    }

    fn get_int(&self, name: &str) -> Option<i32> {
        match self.find(name)? {
            (FieldData::Id(ids), place) => i32::try_from(*ids.get(place)?).ok(),
            // -1 for none, as is the habit.
            (FieldData::Name { ids, .. }, place) => {
                ids.get(place)?.map_or(Some(-1), |id| i32::try_from(id).ok())
            }
            _ => None,
        }
    }

    fn get_uchar(&self, name: &str) -> Option<u8> {
        match self.find(name)? {
            (FieldData::Byte(values), place) => values.get(place).copied(),
            (FieldData::Origin(origins), place) => origins.get(place).copied().map(origin_number),
            _ => None,
        }
    }
}

pub(super) fn read(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    let parser = Parser::<Position>::new();
    let mut reader = Reader::new(bytes);
    let header = parser.read_header(&mut reader).map_err(|error| located(points, ASCII, &error))?;
    for (name, element) in &header.elements {
        // An element without properties takes no bytes, so no end of the file would ever stop it.
        if element.properties.is_empty() && element.count > 0 {
            return Err(points.malformed(PointPlace::File, format!("the element {name} has no properties")));
        }
        let elements = parser
            .read_payload_for_element(&mut reader, element, &header)
            .map_err(|error| located(points, header.encoding, &error))?;
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

/// Only text has lines.
fn located(points: &Points, encoding: Encoding, error: &ply_rs_bw::parser::ParseError) -> PointsError {
    let line = error.line().filter(|_| encoding == ASCII);
    let place = line.map_or(PointPlace::File, |line| PointPlace::Line(line as u64));
    points.malformed(place, first_line(error))
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
