//! Points as NumPy's NPY (format version 1.0 and later, numpy.lib.format). Own code: the head is one line, and the
//! readers at hand allocate what it claims.

use std::io;
use std::ops::Range;

use glam::DVec3;

use crate::io::points::stream::invalid;
use crate::io::points::{Field, PointPlace, Points, PointsError, field};

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

pub(super) fn write_rows(fields: &[Field], points: Range<usize>, bytes: &mut Vec<u8>) -> io::Result<()> {
    let positions = field::reals(fields, "position", 3)
        .ok_or_else(|| invalid("NPY holds positions, of which there are none".to_owned()))?;
    bytes.extend(positions[3 * points.start..3 * points.end].iter().flat_map(|x| x.to_le_bytes()));
    Ok(())
}

/// What stands before the numbers of an array.
pub(super) fn write_head(descr: &str, shape: &[usize], out: &mut dyn io::Write) -> io::Result<()> {
    let mut sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
    if let [_] = shape {
        sizes.push(String::new());
    }
    let sizes = sizes.join(", ");
    let head = format!(
        "{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}",
        sizes.trim_end_matches(' ')
    );
    // Magic, version, length of the head and head together fill a multiple of 64 bytes and end with a new line.
    let length = (10 + head.len() + 1).next_multiple_of(64) - 10;
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&(length as u16).to_le_bytes())?;
    writeln!(out, "{head:width$}", width = length - 1)
}

pub(super) fn read(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    let broken = |problem: &str| points.malformed(PointPlace::File, problem);
    let (head, data) = split(bytes).ok_or_else(|| broken("the head is cut off"))?;
    let number = Number::from_name(value(head, "descr").unwrap_or_default()).ok_or_else(|| {
        broken("the numbers are neither float32 or float64 nor integers: save them as float64")
    })?;
    let fortran = match value(head, "fortran_order") {
        Some(order) if order.starts_with("True") => true,
        Some(order) if order.starts_with("False") => false,
        _ => return Err(broken("the head does not tell the order")),
    };
    let shape =
        value(head, "shape").and_then(shape).ok_or_else(|| broken("the head does not tell the shape"))?;
    let [count, columns] = shape[..] else {
        return Err(broken(&format!("the shape {shape:?} is not that of rows and columns")));
    };
    if columns < 3 {
        return Err(broken(&format!("a point has {columns} coordinates instead of 3")));
    }
    let needed = count.checked_mul(columns).and_then(|n| n.checked_mul(number.size as u64));
    if needed.is_none_or(|needed| needed > data.len() as u64) {
        return Err(broken(&format!(
            "{count} x {columns} numbers are announced, but the file ends after {} bytes of them",
            data.len()
        )));
    }
    // Both fit in the bytes at hand, so in memory.
    let (count, columns) = (count as usize, columns as usize);
    points.positions.reserve_exact(count);
    for row in 0..count {
        let at = |column: usize| {
            let index = if fortran { column * count + row } else { row * columns + column };
            number.read(&data[index * number.size..])
        };
        points.push(DVec3::new(at(0), at(1), at(2)), PointPlace::Point(row))?;
    }
    Ok(())
}

/// The head without what comes before it, and the numbers after it.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let (length, start) = match bytes.get(MAGIC.len())? {
        1 => (usize::from(u16::from_le_bytes(bytes.get(8..10)?.try_into().ok()?)), 10),
        _ => (usize::try_from(u32::from_le_bytes(bytes.get(8..12)?.try_into().ok()?)).ok()?, 12),
    };
    let (head, data) = bytes[start..].split_at_checked(length)?;
    Some((std::str::from_utf8(head).ok()?, data))
}

/// What follows a key of the dictionary.
fn value<'a>(head: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = head.split_once(&format!("'{key}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// A tuple of numbers.
fn shape(value: &str) -> Option<Vec<u64>> {
    let (tuple, _) = value.strip_prefix('(')?.split_once(')')?;
    tuple.split(',').map(str::trim).filter(|n| !n.is_empty()).map(|n| n.parse().ok()).collect()
}

/// How a number is stored, as the head describes it: byte order, kind and size, such as `<f4`.
#[derive(Clone, Copy)]
struct Number {
    big_endian: bool,
    kind: Kind,
    size: usize,
}

#[derive(Clone, Copy)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

impl Number {
    fn from_name(value: &str) -> Option<Self> {
        let mut parts = value.strip_prefix('\'')?.split('\'').next()?.chars();
        let big_endian = match parts.next()? {
            '<' | '|' => false,
            '>' => true,
            _ => return None,
        };
        let (kind, sizes): (Kind, &[usize]) = match parts.next()? {
            'f' => (Kind::Float, &[4, 8]),
            'i' => (Kind::Signed, &[1, 2, 4, 8]),
            'u' => (Kind::Unsigned, &[1, 2, 4, 8]),
            _ => return None,
        };
        let size = parts.as_str().parse().ok().filter(|size| sizes.contains(size))?;
        Some(Self { big_endian, kind, size })
    }

    /// The number at the start of `bytes`, which are enough.
    fn read(self, bytes: &[u8]) -> f64 {
        let join = |bits: u64, byte: &u8| (bits << 8) | u64::from(*byte);
        let own = &bytes[..self.size];
        let bits = if self.big_endian { own.iter().fold(0, join) } else { own.iter().rev().fold(0, join) };
        match (self.kind, self.size) {
            (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Kind::Float, _) => f64::from_bits(bits),
            // Its sign is the highest bit of its own size.
            (Kind::Signed, size) => ((bits << (64 - 8 * size)) as i64 >> (64 - 8 * size)) as f64,
            (Kind::Unsigned, _) => bits as f64,
        }
    }
}
