//! The data of PLY files of text. Own code: the library refuses what programs write there, `nan`, `inf`, `0.`, `.5`,
//! empty lines and lines that end in carriage returns.

use std::str::FromStr;

use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use super::malformed;
use crate::io::detect::MeshFormat;
use crate::io::read::{Place, ReadError, brief};
use crate::io::text::real;

/// For so many records at most is memory reserved before they are read.
const MOST_RESERVED: usize = 1 << 16;

/// The lines behind the header.
pub(super) struct Lines<'a> {
    rest: &'a str,
    /// How many were taken, with those of the header.
    line: usize,
}

impl<'a> Lines<'a> {
    /// The lines of `text`, which follow so many of the header.
    pub(super) fn new(text: &'a str, header_lines: usize) -> Self {
        Self { rest: text, line: header_lines }
    }

    /// How many bytes are left.
    pub(super) fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The next line that has something in it.
    fn next(&mut self) -> Option<&'a str> {
        while !self.rest.is_empty() {
            let end = self.rest.find(['\n', '\r']).unwrap_or(self.rest.len());
            let (line, rest) = self.rest.split_at(end);
            let rest = rest.strip_prefix("\r\n").or_else(|| rest.get(1..)).unwrap_or_default();
            (self.rest, self.line) = (rest, self.line + 1);
            if !line.trim_ascii().is_empty() {
                return Some(line);
            }
        }
        None
    }

    /// All records of an element, one a line. Those without properties take none.
    pub(super) fn records<E: PropertyAccess>(&mut self, element: &ElementDef) -> Result<Vec<E>, ReadError> {
        if element.properties.is_empty() {
            return Ok(Vec::new());
        }
        // A record may take more memory than the two bytes that are known to be there for each.
        let mut records = Vec::with_capacity(element.count.min(MOST_RESERVED));
        for index in 0..element.count {
            let Some(line) = self.next() else {
                return Err(ReadError::Truncated {
                    format: MeshFormat::Ply,
                    place: Place::Line(self.line),
                    problem: format!(
                        "it ends behind {index} of {} elements `{}`",
                        element.count,
                        brief(&element.name)
                    ),
                });
            };
            records
                .push(record(line, element).map_err(|problem| malformed(Place::Line(self.line), problem))?);
        }
        Ok(records)
    }
}

fn record<E: PropertyAccess>(line: &str, element: &ElementDef) -> Result<E, String> {
    let mut record = E::new();
    let mut words = line.split_ascii_whitespace();
    for (name, property) in &element.properties {
        let value = match &property.data_type {
            PropertyType::Scalar(kind) => scalar(kind, &mut words),
            PropertyType::List(_, kind) => list(kind, &mut words),
        };
        let value = value.map_err(|problem| format!("property `{}`: {problem}", brief(name)))?;
        if let PropertyAccessResult::UnsupportedType = record.set_property(name, value) {
            return Err(format!("property `{}`: numbers of this type are unsupported", brief(name)));
        }
    }
    Ok(record)
}

fn scalar<'a>(kind: &ScalarType, words: &mut impl Iterator<Item = &'a str>) -> Result<Property, String> {
    Ok(match kind {
        ScalarType::Char => Property::Char(next(words, parsed)?),
        ScalarType::UChar => Property::UChar(next(words, parsed)?),
        ScalarType::Short => Property::Short(next(words, parsed)?),
        ScalarType::UShort => Property::UShort(next(words, parsed)?),
        ScalarType::Int => Property::Int(next(words, parsed)?),
        ScalarType::UInt => Property::UInt(next(words, parsed)?),
        ScalarType::Float => Property::Float(next(words, single)?),
        ScalarType::Double => Property::Double(next(words, real)?),
    })
}

fn list<'a>(kind: &ScalarType, words: &mut impl Iterator<Item = &'a str>) -> Result<Property, String> {
    let count: usize = next(words, parsed)?;
    Ok(match kind {
        ScalarType::Char => Property::ListChar(several(count, words, parsed)?),
        ScalarType::UChar => Property::ListUChar(several(count, words, parsed)?),
        ScalarType::Short => Property::ListShort(several(count, words, parsed)?),
        ScalarType::UShort => Property::ListUShort(several(count, words, parsed)?),
        ScalarType::Int => Property::ListInt(several(count, words, parsed)?),
        ScalarType::UInt => Property::ListUInt(several(count, words, parsed)?),
        ScalarType::Float => Property::ListFloat(several(count, words, single)?),
        ScalarType::Double => Property::ListDouble(several(count, words, real)?),
    })
}

fn next<'a, T>(
    words: &mut impl Iterator<Item = &'a str>,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<T, String> {
    let word = words.next().ok_or("a number is missing")?;
    parse(word).ok_or_else(|| format!("{:?} stands where a number of its type must be", brief(word)))
}

/// Reserves nothing: the count may lie.
fn several<'a, T>(
    count: usize,
    words: &mut impl Iterator<Item = &'a str>,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, String> {
    let mut numbers = Vec::new();
    for index in 0..count {
        let number = next(words, &parse);
        numbers.push(number.map_err(|problem| format!("{problem} ({index} of {count} were read)"))?);
    }
    Ok(numbers)
}

fn parsed<T: FromStr>(word: &str) -> Option<T> {
    word.parse().ok()
}

fn single(word: &str) -> Option<f32> {
    // Rounded once.
    word.parse().ok().or_else(|| real(word).map(|number| number as f32))
}
