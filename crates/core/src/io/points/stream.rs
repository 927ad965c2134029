//! Point files written block by block, so that never all points are there at once.

use std::io;
use std::ops::Range;

use crate::io::points::{Field, PointFormat, json, npy, ply, text};
use crate::parallel;

/// Writes a point file whose points come in blocks; [`PointFormat::takes_blocks`] says which formats can be written so.
/// The bytes are those of [`write_fields`](crate::io::points::write_fields) for all points at once, whatever the blocks.
///
/// ```
/// use ldwrap::io::points::{Field, FieldData, PointFormat, PointWriter, Precision};
///
/// let position = |values: Vec<f64>| Field {
///     key: "position".into(),
///     columns: ["x", "y", "z"].map(String::from).into(),
///     data: FieldData::Real(values, Precision::Double),
/// };
/// let mut writer = PointWriter::new(PointFormat::Xyz, &[position(Vec::new())], 2, Vec::new())?;
/// writer.write(&[position(vec![0.0, 0.5, 1.0])])?;
/// writer.write(&[position(vec![2.0, 3.0, 4.0])])?;
/// assert_eq!(writer.finish()?, b"0.0 0.5 1.0\n2.0 3.0 4.0\n");
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct PointWriter<W> {
    format: PointFormat,
    /// As every block must have them, without values.
    fields: Vec<Field>,
    count: usize,
    written: usize,
    out: W,
}

impl<W: io::Write> PointWriter<W> {
    /// Begins a file of `count` points with `fields`, of which the first is the position and only names and kinds are
    /// looked at.
    ///
    /// # Errors
    /// Those of `out`, and [`io::ErrorKind::InvalidInput`] for a format that does not take blocks.
    pub fn new(format: PointFormat, fields: &[Field], count: usize, mut out: W) -> io::Result<Self> {
        let fields: Vec<Field> = fields.iter().map(Field::without_values).collect();
        match format {
            PointFormat::Ply => ply::write_head(&fields, count, ply::BINARY, &mut out)?,
            PointFormat::PlyAscii => ply::write_head(&fields, count, ply::ASCII, &mut out)?,
            PointFormat::Xyz => text::write_xyz_head(&fields, &mut out)?,
            PointFormat::Csv => text::write_csv_head(&fields, &mut out)?,
            PointFormat::Npy => npy::write_head("<f8", &[count, 3], &mut out)?,
            PointFormat::Json => {}
            PointFormat::Npz | PointFormat::Obj | PointFormat::Glb => {
                return Err(invalid(format!("{format} cannot be written in blocks")));
            }
        }
        Ok(Self { format, fields, count, written: 0, out })
    }

    /// Writes more points. Memory for the bytes of some 10,000 of them.
    ///
    /// # Errors
    /// Those of `out`, and [`io::ErrorKind::InvalidInput`] where fields are not those of [`new`](Self::new), have
    /// different numbers of points, or hold more than were announced.
    pub fn write(&mut self, fields: &[Field]) -> io::Result<()> {
        /// Rows that are made before they are written, and those of a piece of work.
        const TOGETHER: usize = 1 << 16;
        const ROWS: usize = 1 << 12;
        let points = fields.first().map_or(0, Field::point_count);
        if !fields.iter().map(Field::without_values).eq(self.fields.iter().cloned()) {
            return Err(invalid("a block of points has other fields than the file".to_owned()));
        }
        if fields.iter().any(|field| field.point_count() != points) {
            return Err(invalid("the fields of a block have different numbers of points".to_owned()));
        }
        if points > self.count - self.written {
            return Err(invalid(format!("more than the {} points that were announced", self.count)));
        }
        for start in (0..points).step_by(TOGETHER) {
            let count = (points - start).min(TOGETHER);
            let (format, before) = (self.format, self.written);
            let pieces = parallel::map_chunks(count, ROWS, |range| {
                rows(format, fields, start + range.start..start + range.end, before)
            });
            for piece in pieces {
                self.out.write_all(&piece?)?;
            }
        }
        self.written += points;
        Ok(())
    }

    /// Where it writes to.
    pub fn get_ref(&self) -> &W {
        &self.out
    }

    /// Ends the file and gives the writer back, flushed.
    ///
    /// # Errors
    /// Those of the writer, and [`io::ErrorKind::InvalidInput`] if there were fewer points than announced.
    pub fn finish(mut self) -> io::Result<W> {
        if self.written < self.count {
            return Err(invalid(format!(
                "{} of the {} points are missing",
                self.count - self.written,
                self.count
            )));
        }
        if self.format == PointFormat::Json {
            json::write_end(self.count, &mut self.out)?;
        }
        self.out.flush()?;
        Ok(self.out)
    }
}

/// Some rows of a block that so many points come `before`.
fn rows(format: PointFormat, fields: &[Field], range: Range<usize>, before: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    match format {
        PointFormat::Ply => ply::write_binary_rows(fields, range, &mut bytes)?,
        PointFormat::PlyAscii => ply::write_ascii_rows(fields, range, &mut bytes)?,
        PointFormat::Xyz => text::write_xyz_rows(fields, range, &mut bytes)?,
        PointFormat::Csv => text::write_csv_rows(fields, range, &mut bytes)?,
        PointFormat::Npy => npy::write_rows(fields, range, &mut bytes)?,
        PointFormat::Json => json::write_rows(fields, range, before, &mut bytes)?,
        PointFormat::Npz | PointFormat::Obj | PointFormat::Glb => {}
    }
    Ok(bytes)
}

pub(super) fn invalid(problem: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, problem)
}
