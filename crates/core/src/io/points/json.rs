//! Points as JSON.

use std::io;
use std::ops::Range;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::io::points::{Field, FieldData, PointPlace, Points, PointsError};

/// A line for each point, so that people and `diff` can read the file; `before` points have theirs.
pub(super) fn write_rows(
    fields: &[Field],
    points: Range<usize>,
    before: usize,
    out: &mut Vec<u8>,
) -> io::Result<()> {
    for point in points {
        out.extend_from_slice(if before + point == 0 { b"[\n" } else { b",\n" });
        for (index, field) in fields.iter().enumerate() {
            out.push(if index == 0 { b'{' } else { b',' });
            serde_json::to_writer(&mut *out, &field.key)?;
            out.push(b':');
            let width = field.columns.len();
            let place = point * width..(point + 1) * width;
            match &field.data {
                FieldData::Real(values, _) => write_list(&values[place], out)?,
                FieldData::Id(values) => write_list(&values[place], out)?,
                FieldData::Byte(values) => write_list(&values[place], out)?,
                FieldData::Name { names, ids } => {
                    let name = ids[point].and_then(|id| names.get(id as usize));
                    serde_json::to_writer(&mut *out, &name)?;
                }
                FieldData::Origin(origins) => serde_json::to_writer(&mut *out, &origins[point])?,
            }
        }
        out.push(b'}');
    }
    Ok(())
}

/// What stands behind so many points.
pub(super) fn write_end(count: usize, out: &mut dyn io::Write) -> io::Result<()> {
    out.write_all(if count == 0 { b"[]\n" } else { b"\n]\n" })
}

/// One value as it is, several as a list; numbers that are none are null.
fn write_list<T: Serialize>(values: &[T], out: &mut Vec<u8>) -> io::Result<()> {
    match values {
        [value] => serde_json::to_writer(out, value)?,
        values => serde_json::to_writer(out, values)?,
    }
    Ok(())
}

/// A point as it may be read.
#[derive(Deserialize)]
#[serde(untagged)]
enum Point {
    List([f64; 3]),
    Position { position: [f64; 3] },
    Axes { x: f64, y: f64, z: f64 },
}

pub(super) fn read(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    let read: Vec<Point> = serde_json::from_slice(bytes)
        .map_err(|error| points.malformed(PointPlace::Line(error.line() as u64), error.to_string()))?;
    for (index, point) in read.into_iter().enumerate() {
        let position = match point {
            Point::List(position) | Point::Position { position } => DVec3::from_array(position),
            Point::Axes { x, y, z } => DVec3::new(x, y, z),
        };
        points.push(position, PointPlace::Point(index))?;
    }
    Ok(())
}
