//! Points as JSON.

use std::io;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::io::points::{PointPlace, PointRow, Points, PointsError};
use crate::sample::Origin;

/// A point as it is written.
#[derive(Serialize)]
struct Row {
    position: [f64; 3],
    normal: [f64; 3],
    face: u32,
    barycentric: [f64; 3],
    strip: u32,
    place: [f64; 2],
    origin: Origin,
}

pub(super) fn write(rows: &[PointRow], out: &mut dyn io::Write) -> io::Result<()> {
    // A line for each point, so that people and `diff` can read the file.
    let mut before = "[\n";
    for row in rows {
        out.write_all(before.as_bytes())?;
        before = ",\n";
        let sample = &row.sample;
        let row = Row {
            position: row.position.to_array(),
            normal: row.normal.to_array(),
            face: sample.point.face.0,
            barycentric: sample.point.barycentric,
            strip: sample.strip.0,
            place: sample.place.to_array(),
            origin: sample.origin,
        };
        serde_json::to_writer(&mut *out, &row)?;
    }
    out.write_all(if rows.is_empty() { b"[]\n" } else { b"\n]\n" })
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
