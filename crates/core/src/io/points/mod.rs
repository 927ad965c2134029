//! Points out and in, one file a format.

mod attribute;
mod field;
mod glb;
mod json;
mod npy;
mod npz;
mod ply;
mod stream;
mod text;

pub use attribute::{Attribute, AttributeError, Gatherer, gather};
pub use field::{Field, FieldData, Precision};
pub use stream::PointWriter;

use std::fmt;
use std::io;

use glam::DVec3;

use crate::io::read::brief;
use crate::mesh::SurfaceMesh;
use crate::sample::Sample;

/// A point file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum PointFormat {
    /// PLY, binary little-endian: `double` x y z, `float` nx ny nz, `int` face and
    /// strip, `uchar` origin, `double` for the other columns of [`COLUMNS`].
    Ply,
    /// PLY, ASCII, with the same properties.
    PlyAscii,
    /// A line `x y z` for each point.
    Xyz,
    /// Comma-separated values with [`COLUMNS`] as the first line.
    Csv,
    /// NumPy's format: float64, n x 3, C order; positions only.
    Npy,
    /// NumPy's archive: an array a field, named as in JSON; names as indices (-1: none) with an array `KEY_names`.
    Npz,
    /// A list with an object for each point: `position`, `normal`, `face`, `barycentric`, `strip`, `place`, `origin`.
    Json,
    /// Wavefront OBJ: `v` (with sRGB colours from 0 to 1), `vt` and `vn` lines, no elements.
    Obj,
    /// Binary glTF 2.0: one mesh of points in single precision, with `POSITION`, `NORMAL`, `TEXCOORD_0` (origin at the
    /// upper left), `COLOR_0` (linear), and the other fields as `_KEY` in capitals; names are listed in `extras`.
    Glb,
}

impl PointFormat {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Ply,
        Self::PlyAscii,
        Self::Xyz,
        Self::Csv,
        Self::Npy,
        Self::Npz,
        Self::Json,
        Self::Obj,
        Self::Glb,
    ];

    /// Its name: what [`from_name`](Self::from_name) takes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::PlyAscii => "ply-ascii",
            Self::Xyz => "xyz",
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Npz => "npz",
            Self::Json => "json",
            Self::Obj => "obj",
            Self::Glb => "glb",
        }
    }

    /// Whether its files can be written block by block ([`PointWriter`]): not NPZ, OBJ and GLB, which hold each field of all
    /// points in one piece.
    pub fn takes_blocks(self) -> bool {
        !matches!(self, Self::Npz | Self::Obj | Self::Glb)
    }

    /// The format of this name, or of a file of this name by what follows the last dot; in any case. `txt`, `pts` and
    /// `asc` are read as `xyz`.
    pub fn from_name(name: &str) -> Option<Self> {
        let extension = name.rsplit_once('.').map_or(name, |(_, extension)| extension).to_ascii_lowercase();
        match extension.as_str() {
            "txt" | "pts" | "asc" => Some(Self::Xyz),
            extension => Self::ALL.into_iter().find(|format| format.name() == extension),
        }
    }
}

impl fmt::Display for PointFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The columns of CSV and the properties of PLY: position, unit normal of the face, face (triangle of the checked mesh),
/// barycentric coordinates in it, strip, place in the planar domain, and origin: `wrapped`, `projected` or `equalized`
/// (in PLY 0, 1 or 2).
pub const COLUMNS: [&str; 14] =
    ["x", "y", "z", "nx", "ny", "nz", "face", "b0", "b1", "b2", "strip", "place_x", "place_y", "origin"];

/// A sample as files hold it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRow {
    /// The place in space, in units of the mesh.
    pub position: DVec3,
    /// The unit normal of the face.
    pub normal: DVec3,
    /// The sample itself.
    pub sample: Sample,
}

impl PointRow {
    /// The row of a sample on `mesh`.
    pub fn new(mesh: &SurfaceMesh, sample: &Sample) -> Self {
        let point = &sample.point;
        Self { position: mesh.locate(point), normal: mesh.face_normal(point.face), sample: *sample }
    }
}

/// Writes points with what [`COLUMNS`] name, as far as the format holds it (XYZ and NPY positions, OBJ positions and
/// normals). Numbers in text are the shortest that read back as the same doubles.
///
/// # Errors
/// Those of `out`, and [`io::ErrorKind::InvalidInput`] for what the format cannot hold: in GLB positions beyond single
/// precision, in PLY indices beyond 2^31.
pub fn write_points(format: PointFormat, rows: &[PointRow], out: &mut dyn io::Write) -> io::Result<()> {
    /// Rows whose fields are there at once.
    const ROWS: usize = 1 << 16;
    let fields = |rows: &[PointRow]| {
        let mut fields = default_fields(rows);
        if format == PointFormat::Xyz {
            fields.truncate(1);
        }
        fields
    };
    if !format.takes_blocks() {
        return write_fields(format, &fields(rows), out);
    }
    let mut writer = PointWriter::new(format, &fields(&[]), rows.len(), out)?;
    for rows in rows.chunks(ROWS) {
        writer.write(&fields(rows))?;
    }
    writer.finish().map(drop)
}

/// Writes fields, the first of which is the position, as far as the format holds them: NPY positions, OBJ positions,
/// normals, texture coordinates and colours, XYZ numbers (with a first line of names, after `#`, if there are more than
/// positions), the others all.
///
/// # Errors
/// As [`write_points`], and where fields have different numbers of points.
pub fn write_fields(format: PointFormat, fields: &[Field], out: &mut dyn io::Write) -> io::Result<()> {
    match format {
        PointFormat::Npz => npz::write(fields, out),
        PointFormat::Obj => text::write_obj(fields, out),
        PointFormat::Glb => glb::write(fields, out),
        _ => {
            let count = fields.first().map_or(0, Field::point_count);
            let mut writer = PointWriter::new(format, fields, count, out)?;
            writer.write(fields)?;
            writer.finish().map(drop)
        }
    }
}

/// The fields of [`COLUMNS`].
fn default_fields(rows: &[PointRow]) -> Vec<Field> {
    let reals = |key, columns: &[&str], precision, values: Vec<f64>| {
        Field::new(key, columns, FieldData::Real(values, precision))
    };
    let each = |values: fn(&PointRow) -> [f64; 3]| rows.iter().flat_map(values).collect();
    let ids =
        |key, id: fn(&PointRow) -> u32| Field::new(key, &[key], FieldData::Id(rows.iter().map(id).collect()));
    let double = Precision::Double;
    vec![
        reals("position", &COLUMNS[..3], double, each(|r| r.position.to_array())),
        reals("normal", &COLUMNS[3..6], Precision::Single, each(|r| r.normal.to_array())),
        ids("face", |r| r.sample.point.face.0),
        reals("barycentric", &COLUMNS[7..10], double, each(|r| r.sample.point.barycentric)),
        ids("strip", |r| r.sample.strip.0),
        reals(
            "place",
            &COLUMNS[11..13],
            double,
            rows.iter().flat_map(|r| r.sample.place.to_array()).collect(),
        ),
        Field::new(
            "origin",
            &COLUMNS[13..],
            FieldData::Origin(rows.iter().map(|r| r.sample.origin).collect()),
        ),
    ]
}

/// Where in a point file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PointPlace {
    /// Nowhere in particular.
    File,
    /// A line, counted from 1.
    Line(u64),
    /// A point, counted from 0.
    Point(usize),
}

impl fmt::Display for PointPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => f.write_str("file"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Point(point) => write!(f, "point {point}"),
        }
    }
}

/// Why bytes are not points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointsError {
    /// Neither content nor name tell a format.
    #[error(
        "{name:?} is not in a known point format: the formats are ply, xyz, csv, npy, npz, json, obj and glb"
    )]
    UnknownFormat {
        /// The name.
        name: String,
    },
    /// The bytes break the rules of the format.
    #[error("{format}, {place}: {problem}")]
    Malformed {
        /// The format.
        format: PointFormat,
        /// Where.
        place: PointPlace,
        /// What is wrong.
        problem: String,
    },
    /// A coordinate is infinite or not a number.
    #[error("{format}, {place}: the position ({:?}, {:?}, {:?}) is not finite", .position.x, .position.y, .position.z)]
    NotFinite {
        /// The format.
        format: PointFormat,
        /// Where.
        place: PointPlace,
        /// The position.
        position: DVec3,
    },
    /// There is no point.
    #[error("{format}: there is no point in the file")]
    Empty {
        /// The format.
        format: PointFormat,
    },
}

/// Reads the positions of points; other columns are skipped. PLY, NPY, NPZ and GLB are told by their content, the others by `name`:
/// - PLY: x, y, z of the element `vertex`, any scalar type, all three encodings;
/// - XYZ: the first three numbers of each line, between spaces, commas or semicolons; `#` and `//` start comments; a first
///   line with the count alone, as in PTS files, is skipped;
/// - CSV: the columns x, y, z of the first line, or the first three columns;
/// - NPY: float32, float64 or integers, n rows of at least 3, either byte order, C or Fortran order;
/// - JSON: a list of points: `[x, y, z]`, `{"position": [x, y, z]}` or `{"x": x, "y": y, "z": z}`;
/// - NPZ: the array `position`, `positions`, `points`, `xyz` or `vertices`, as NPY;
/// - OBJ: the `v` lines;
/// - GLB: the positions of all meshes, whatever they are made of, placed by their nodes.
///
/// # Errors
/// [`PointsError`]. What a head claims is never allocated before the bytes are there.
pub fn read_points(bytes: &[u8], name: &str) -> Result<Vec<DVec3>, PointsError> {
    let format = if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        PointFormat::Ply
    } else if bytes.starts_with(npy::MAGIC) {
        PointFormat::Npy
    } else if bytes.starts_with(b"PK\x03\x04") {
        PointFormat::Npz
    } else if bytes.starts_with(b"glTF") {
        PointFormat::Glb
    } else {
        PointFormat::from_name(name).ok_or_else(|| PointsError::UnknownFormat { name: name.to_owned() })?
    };
    let mut points = Points { format, positions: Vec::new() };
    match format {
        PointFormat::Ply | PointFormat::PlyAscii => ply::read(bytes, &mut points),
        PointFormat::Xyz => text::read_xyz(bytes, &mut points),
        PointFormat::Csv => text::read_csv(bytes, &mut points),
        PointFormat::Npy => npy::read(bytes, &mut points),
        PointFormat::Npz => npz::read(bytes, &mut points),
        PointFormat::Json => json::read(bytes, &mut points),
        PointFormat::Obj => text::read_obj(bytes, &mut points),
        PointFormat::Glb => glb::read(bytes, &mut points),
    }?;
    if points.positions.is_empty() { Err(PointsError::Empty { format }) } else { Ok(points.positions) }
}

/// The points read so far.
struct Points {
    format: PointFormat,
    positions: Vec<DVec3>,
}

impl Points {
    fn push(&mut self, position: DVec3, place: PointPlace) -> Result<(), PointsError> {
        if !position.is_finite() {
            return Err(PointsError::NotFinite { format: self.format, place, position });
        }
        self.positions.push(position);
        Ok(())
    }

    fn malformed(&self, place: PointPlace, problem: impl Into<String>) -> PointsError {
        // What a library says may quote the file.
        PointsError::Malformed { format: self.format, place, problem: brief(&problem.into()) }
    }
}

#[cfg(test)]
mod stream_tests;
#[cfg(test)]
mod tests;
