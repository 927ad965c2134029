//! Points as PLY.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::ops::Range;

use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType,
};
use ply_rs_bw::writer::Writer;

use crate::io::ply::first_line;
use crate::io::points::field::{origin_number, unique};
use crate::io::points::stream::invalid;
use crate::io::points::{Field, FieldData, PointPlace, Points, PointsError, Precision};

pub(super) const BINARY: Encoding = Encoding::BinaryLittleEndian;
pub(super) const ASCII: Encoding = Encoding::Ascii;

pub(super) fn write_head(
    fields: &[Field],
    count: usize,
    encoding: Encoding,
    mut out: &mut dyn Write,
) -> io::Result<()> {
    let mut vertex = ElementDef::new("vertex".to_owned());
    vertex.count = count;
    let mut header = Header::new();
    header.encoding = encoding;
    let mut taken = BTreeSet::new();
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
        for name in &field.columns {
            // What other programs look for.
            let name = match (&*field.key, &**name) {
                ("uv", "u") => "s".to_owned(),
                ("uv", "v") => "t".to_owned(),
                _ => property_name(name),
            };
            // Such as `s` beside texture coordinates.
            let name = unique(name, |name| taken.contains(name));
            let property = PropertyDef::new(name.clone(), PropertyType::Scalar(scalar.clone()));
            vertex.properties.insert(name.clone(), property);
            taken.insert(name);
        }
    }
    header.elements.insert(vertex.name.clone(), vertex.clone());
    Writer::<Position>::new().write_header(&mut out, &header).map(drop)
}

/// Rows as the library would write them, which looks each value up by the name of its property.
pub(super) fn write_binary_rows(
    fields: &[Field],
    range: Range<usize>,
    bytes: &mut Vec<u8>,
) -> io::Result<()> {
    for point in range {
        for field in fields {
            let values = values(field, point);
            match &field.data {
                FieldData::Real(all, Precision::Double) => {
                    bytes.extend(all[values].iter().flat_map(|x| x.to_le_bytes()));
                }
                FieldData::Real(all, Precision::Single) => {
                    bytes.extend(all[values].iter().flat_map(|&x| (x as f32).to_le_bytes()));
                }
                FieldData::Id(all) => {
                    for &id in &all[values] {
                        bytes.extend(int(id)?.to_le_bytes());
                    }
                }
                FieldData::Byte(all) => bytes.extend_from_slice(&all[values]),
                FieldData::Name { ids, .. } => {
                    for &id in &ids[values] {
                        bytes.extend(name_number(id)?.to_le_bytes());
                    }
                }
                FieldData::Origin(all) => bytes.extend(all[values].iter().map(|&o| origin_number(o))),
            }
        }
    }
    Ok(())
}

/// As [`write_binary_rows`], a line a point.
pub(super) fn write_ascii_rows(fields: &[Field], range: Range<usize>, bytes: &mut Vec<u8>) -> io::Result<()> {
    for point in range {
        let mut before = "";
        for field in fields {
            for value in values(field, point) {
                bytes.extend_from_slice(before.as_bytes());
                before = " ";
                match &field.data {
                    FieldData::Real(all, Precision::Double) => write!(bytes, "{}", all[value])?,
                    FieldData::Real(all, Precision::Single) => write!(bytes, "{}", all[value] as f32)?,
                    FieldData::Id(all) => write!(bytes, "{}", int(all[value])?)?,
                    FieldData::Byte(all) => write!(bytes, "{}", all[value])?,
                    FieldData::Name { ids, .. } => write!(bytes, "{}", name_number(ids[value])?)?,
                    FieldData::Origin(all) => write!(bytes, "{}", origin_number(all[value]))?,
                }
            }
        }
        bytes.push(b'\n');
    }
    Ok(())
}

/// Where the values of a point are.
fn values(field: &Field, point: usize) -> Range<usize> {
    let width = field.columns.len();
    point * width..(point + 1) * width
}

fn int(id: u32) -> io::Result<i32> {
    i32::try_from(id)
        .map_err(|_| invalid(format!("PLY cannot hold the index {id}: the largest is {}", i32::MAX)))
}

/// -1 for none, as is the habit.
fn name_number(id: Option<u32>) -> io::Result<i32> {
    id.map_or(Ok(-1), int)
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
