//! Points as lines of text: XYZ, CSV, OBJ.

use std::io;

use glam::DVec3;

use crate::io::points::{COLUMNS, PointPlace, PointRow, Points, PointsError};
use crate::sample::Origin;

pub(super) fn write_xyz(rows: &[PointRow], out: &mut dyn io::Write) -> io::Result<()> {
    for PointRow { position: p, .. } in rows {
        writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    Ok(())
}

pub(super) fn write_obj(rows: &[PointRow], out: &mut dyn io::Write) -> io::Result<()> {
    for PointRow { position: p, .. } in rows {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for PointRow { normal: n, .. } in rows {
        writeln!(out, "vn {:?} {:?} {:?}", n.x, n.y, n.z)?;
    }
    Ok(())
}

pub(super) fn write_csv(rows: &[PointRow], out: &mut dyn io::Write) -> io::Result<()> {
    writeln!(out, "{}", COLUMNS.join(","))?;
    for PointRow { position: p, normal: n, sample } in rows {
        let [b0, b1, b2] = sample.point.barycentric;
        let origin = match sample.origin {
            Origin::Wrapped => "wrapped",
            Origin::Projected => "projected",
            Origin::Equalized => "equalized",
        };
        write!(out, "{:?},{:?},{:?},{:?},{:?},{:?},", p.x, p.y, p.z, n.x, n.y, n.z)?;
        write!(out, "{},{b0:?},{b1:?},{b2:?},{},", sample.point.face.0, sample.strip.0)?;
        writeln!(out, "{:?},{:?},{origin}", sample.place.x, sample.place.y)?;
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
fn lines(bytes: &[u8]) -> impl Iterator<Item = (PointPlace, std::borrow::Cow<'_, str>)> {
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
