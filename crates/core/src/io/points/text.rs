//! Points as lines of text: XYZ, CSV, OBJ.

use std::borrow::Cow;
use std::io::{self, Write};
use std::ops::Range;

use glam::DVec3;

use crate::io::points::field::{self, origin_name};
use crate::io::points::{Field, FieldData, PointPlace, Points, PointsError};

pub(super) fn write_xyz_head(fields: &[Field], out: &mut dyn Write) -> io::Result<()> {
    let numbers = numbers(fields);
    if numbers.len() > 1 {
        let columns: Vec<&str> = numbers.iter().flat_map(|f| &f.columns).map(String::as_str).collect();
        writeln!(out, "# {}", columns.join(" "))?;
    }
    Ok(())
}

pub(super) fn write_xyz_rows(fields: &[Field], range: Range<usize>, bytes: &mut Vec<u8>) -> io::Result<()> {
    write_rows(&numbers(fields), range, [" ", "nan"], bytes)
}

/// The fields that a file of numbers can hold.
fn numbers(fields: &[Field]) -> Vec<&Field> {
    let is_number = |field: &&Field| !matches!(field.data, FieldData::Name { .. } | FieldData::Origin(_));
    fields.iter().filter(is_number).collect()
}

pub(super) fn write_csv_head(fields: &[Field], out: &mut dyn Write) -> io::Result<()> {
    let columns: Vec<_> = fields.iter().flat_map(|field| &field.columns).map(|name| quoted(name)).collect();
    writeln!(out, "{}", columns.join(","))
}

pub(super) fn write_csv_rows(fields: &[Field], range: Range<usize>, bytes: &mut Vec<u8>) -> io::Result<()> {
    write_rows(&fields.iter().collect::<Vec<_>>(), range, [",", ""], bytes)
}

/// A line for each point; `none` stands for a number that is none.
fn write_rows(
    fields: &[&Field],
    points: Range<usize>,
    [separator, none]: [&str; 2],
    out: &mut Vec<u8>,
) -> io::Result<()> {
    for point in points {
        let mut before = "";
        for field in fields {
            let width = field.columns.len();
            for index in point * width..(point + 1) * width {
                out.extend_from_slice(before.as_bytes());
                before = separator;
                match &field.data {
                    FieldData::Real(values, _) if values[index].is_nan() => {
                        out.extend_from_slice(none.as_bytes());
                    }
                    FieldData::Real(values, _) => write!(out, "{:?}", values[index])?,
                    FieldData::Id(values) => write!(out, "{}", values[index])?,
                    FieldData::Byte(values) => write!(out, "{}", values[index])?,
                    FieldData::Name { names, ids } => {
                        let name = ids[index].and_then(|id| names.get(id as usize));
                        let name = name.map_or(none.into(), |name| quoted(name));
                        out.extend_from_slice(name.as_bytes());
                    }
                    FieldData::Origin(origins) => {
                        out.extend_from_slice(origin_name(origins[index]).as_bytes());
                    }
                }
            }
        }
        out.push(b'\n');
    }
    Ok(())
}

/// A name as CSV wants it (RFC 4180).
fn quoted(name: &str) -> Cow<'_, str> {
    if name.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", name.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(name)
    }
}

pub(super) fn write_obj(fields: &[Field], out: &mut dyn Write) -> io::Result<()> {
    let colors = field::colors(fields);
    for (index, p) in field::reals(fields, "position", 3).unwrap_or_default().chunks_exact(3).enumerate() {
        write!(out, "v {:?} {:?} {:?}", p[0], p[1], p[2])?;
        if let Some(colors) = colors {
            let [r, g, b] = [0, 1, 2].map(|i| f64::from(colors[4 * index + i]) / 255.0);
            write!(out, " {r:?} {g:?} {b:?}")?;
        }
        writeln!(out)?;
    }
    for uv in field::reals(fields, "uv", 2).unwrap_or_default().chunks_exact(2) {
        // The format has no word for none.
        let [u, v] = [uv[0], uv[1]].map(|x| if x.is_nan() { 0.0 } else { x });
        writeln!(out, "vt {u:?} {v:?}")?;
    }
    for n in field::reals(fields, "normal", 3).unwrap_or_default().chunks_exact(3) {
        writeln!(out, "vn {:?} {:?} {:?}", n[0], n[1], n[2])?;
    }
    Ok(())
}

pub(super) fn read_xyz(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    let mut seen = false;
    for (place, line) in lines(bytes) {
        let line = without_comment(&line);
        let words: Vec<_> = line.split([' ', '\t', ',', ';']).filter(|w| !w.is_empty()).take(4).collect();
        if words.is_empty() {
            continue;
        }
        let first = !seen;
        seen = true;
        if first && (is_count(&words) || is_head(&words)) {
            continue;
        }
        let position = position(&words, place, points)?;
        points.push(position, place)?;
    }
    Ok(())
}

pub(super) fn read_obj(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    for (place, line) in lines(bytes) {
        let mut words = line.split_whitespace();
        if words.next() == Some("v") {
            let words: Vec<_> = words.take(3).collect();
            let position = position(&words, place, points)?;
            points.push(position, place)?;
        }
    }
    Ok(())
}

pub(super) fn read_csv(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter(bytes))
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let mut columns = [0, 1, 2];
    let mut record = csv::ByteRecord::new();
    let mut first = true;
    loop {
        let start = reader.position().line();
        let more = reader
            .read_byte_record(&mut record)
            .map_err(|error| points.malformed(PointPlace::Line(start), error.to_string()))?;
        if !more {
            return Ok(());
        }
        let place = PointPlace::Line(record.position().map_or(start, csv::Position::line));
        let words: Vec<_> = record.iter().map(String::from_utf8_lossy).collect();
        if std::mem::take(&mut first) && is_head(&words.iter().map(AsRef::as_ref).collect::<Vec<_>>()) {
            let column = |axis: &str| {
                words.iter().position(|w| w.trim_start_matches(['#', '/', ' ']).eq_ignore_ascii_case(axis))
            };
            if let (Some(x), Some(y), Some(z)) = (column("x"), column("y"), column("z")) {
                columns = [x, y, z];
            }
            continue;
        }
        let words: Vec<_> = columns.iter().map_while(|&c| words.get(c)).map(AsRef::as_ref).collect();
        let position = position(&words, place, points)?;
        points.push(position, place)?;
    }
}

/// The lines with their places; bytes that are not UTF-8 become replacement characters.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (PointPlace, Cow<'_, str>)> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    bytes
        .split(|&b| b == b'\n')
        .enumerate()
        .map(|(index, line)| (PointPlace::Line(index as u64 + 1), String::from_utf8_lossy(line.trim_ascii())))
}

fn without_comment(line: &str) -> &str {
    let end = line.find('#').into_iter().chain(line.find("//")).min();
    &line[..end.unwrap_or(line.len())]
}

/// The count that PTS files start with.
fn is_count(words: &[&str]) -> bool {
    words.len() == 1 && words[0].parse::<u64>().is_ok()
}

/// A line of names: none of the first three words is a number.
fn is_head(words: &[&str]) -> bool {
    words.iter().take(3).all(|word| word.parse::<f64>().is_err())
}

/// What separates the columns of the first line that is not empty.
fn delimiter(bytes: &[u8]) -> u8 {
    let line = bytes.split(|&b| b == b'\n').find(|line| !line.trim_ascii().is_empty()).unwrap_or_default();
    [b',', b';', b'\t', b' '].into_iter().find(|d| line.trim_ascii().contains(d)).unwrap_or(b',')
}

fn position(words: &[&str], place: PointPlace, points: &Points) -> Result<DVec3, PointsError> {
    let &[x, y, z, ..] = words else {
        let problem = format!("{} of the 3 coordinates of a point", words.len());
        return Err(points.malformed(place, problem));
    };
    let number = |word: &str| {
        word.parse::<f64>().map_err(|_| points.malformed(place, format!("{word:?} is not a number")))
    };
    Ok(DVec3::new(number(x)?, number(y)?, number(z)?))
}
