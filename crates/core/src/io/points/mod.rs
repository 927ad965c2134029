//! Points out and in, one file a format.

mod json;
mod npy;
mod ply;
mod text;

use std::fmt;
use std::io;

use glam::DVec3;

use crate::mesh::SurfaceMesh;
use crate::sample::Sample;

/// A point file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
    /// A list with an object for each point: `position`, `normal`, `face`, `barycentric`, `strip`, `place`, `origin`.
    Json,
    /// Wavefront OBJ: `v` and `vn` lines, no elements.
    Obj,
}

impl PointFormat {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Ply, Self::PlyAscii, Self::Xyz, Self::Csv, Self::Npy, Self::Json, Self::Obj];

    /// Its name: what [`from_name`](Self::from_name) takes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::PlyAscii => "ply-ascii",
            Self::Xyz => "xyz",
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Json => "json",
            Self::Obj => "obj",
        }
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

/// Writes points. Numbers in text are the shortest that read back as the same doubles.
///
/// # Errors
/// Only those of `out`: a `Vec<u8>` has none.
pub fn write_points(format: PointFormat, rows: &[PointRow], out: &mut dyn io::Write) -> io::Result<()> {
    match format {
        PointFormat::Ply => ply::write(rows, ply::BINARY, out),
        PointFormat::PlyAscii => ply::write(rows, ply::ASCII, out),
        PointFormat::Xyz => text::write_xyz(rows, out),
        PointFormat::Csv => text::write_csv(rows, out),
        PointFormat::Npy => npy::write(rows, out),
        PointFormat::Json => json::write(rows, out),
        PointFormat::Obj => text::write_obj(rows, out),
    }
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
    #[error("{name:?} is not in a known point format: the formats are ply, xyz, csv, npy, json and obj")]
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
    #[error("{format}, {place}: the position {position} is not finite")]
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

/// Reads the positions of points; other columns are skipped. PLY and NPY are told by their content, the others by `name`:
/// - PLY: x, y, z of the element `vertex`, any scalar type, all three encodings;
/// - XYZ: the first three numbers of each line, between spaces, commas or semicolons; `#` and `//` start comments; a first
///   line with the count alone, as in PTS files, is skipped;
/// - CSV: the columns x, y, z of the first line, or the first three columns;
/// - NPY: float32 or float64, n rows of at least 3, either byte order, C or Fortran order;
/// - JSON: a list of points: `[x, y, z]`, `{"position": [x, y, z]}` or `{"x": x, "y": y, "z": z}`;
/// - OBJ: the `v` lines.
///
/// # Errors
/// [`PointsError`]. What a head claims is never allocated before the bytes are there.
pub fn read_points(bytes: &[u8], name: &str) -> Result<Vec<DVec3>, PointsError> {
    let format = if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        PointFormat::Ply
    } else if bytes.starts_with(npy::MAGIC) {
        PointFormat::Npy
    } else {
        PointFormat::from_name(name).ok_or_else(|| PointsError::UnknownFormat { name: name.to_owned() })?
    };
    let mut points = Points { format, positions: Vec::new() };
    match format {
        PointFormat::Ply | PointFormat::PlyAscii => ply::read(bytes, &mut points),
        PointFormat::Xyz => text::read_xyz(bytes, &mut points),
        PointFormat::Csv => text::read_csv(bytes, &mut points),
        PointFormat::Npy => npy::read(bytes, &mut points),
        PointFormat::Json => json::read(bytes, &mut points),
        PointFormat::Obj => text::read_obj(bytes, &mut points),
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
        PointsError::Malformed { format: self.format, place, problem: problem.into() }
    }
}

#[cfg(test)]
mod tests;
