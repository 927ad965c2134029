//! Reads PLY files in all three encodings, with `ply-rs-bw`.

mod attributes;

use std::io::ErrorKind;

use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    BeginList, ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};

use crate::attributes::MeshAttributes;
use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::read::{Detail, Model, Place, ReadError, Resolver, brief, push_polygon};
use crate::mesh::PolygonSoup;
use attributes::{Face, Faces, Record};

/// Reads a PLY file: `x`, `y`, `z` of the element `vertex` in any type of number, the list `vertex_indices` or
/// `vertex_index` of the element `face`, and triangle strips (`tristrips`); everything else is passed over.
///
/// # Errors
/// [`ReadError`]: with the line of text files. Counts are checked against the bytes that are there before anything
/// is read.
pub fn read(bytes: &[u8]) -> Result<PolygonSoup, ReadError> {
    read_model(bytes, Detail::Shape, &|_| Err("nothing is looked for".to_owned())).map(|model| model.soup)
}

/// Reads a PLY file with what other programs write at vertices: `nx ny nz`; `red green blue` and `alpha` (sRGB, integers
/// up to the largest of their type, or reals up to 1); texture coordinates `s t`, `u v` or `texture_u texture_v`; all
/// scalars under their names; and at faces: lists `texcoord`, as MeshLab writes them, `red green blue` where the
/// vertices have no colour, and `material_index`. For [`Detail::Textures`] also the picture that the first comment
/// `TextureFile` names.
///
/// # Errors
/// As [`read`]; a picture that the resolver does not have.
pub fn read_model(bytes: &[u8], detail: Detail, resolver: &Resolver<'_>) -> Result<Model, ReadError> {
    read_within(bytes, detail, &Limits::default(), resolver)
}

pub(super) fn read_within(
    bytes: &[u8],
    detail: Detail,
    limits: &Limits,
    resolver: &Resolver<'_>,
) -> Result<Model, ReadError> {
    let (header, start) = read_header(bytes)?;
    let mut reader = Reader::new(&bytes[start..]);
    let mut soup = PolygonSoup::default();
    let header_lines = bytes[..start].iter().filter(|&&byte| byte == b'\n').count();
    let (mut vertices, mut face_values) = (Vec::<Record>::new(), Faces::default());
    for element in header.elements.values() {
        check_count(element, &header, reader.get_ref().len())?;
        let error = |error| explain(error, &header, bytes, header_lines);
        match element.name.as_str() {
            "vertex" => {
                require(element, &["x", "y", "z"], |kind| matches!(kind, PropertyType::Scalar(_)))?;
                limits.vertices(MeshFormat::Ply, Place::File, element.count)?;
                if detail >= Detail::Attributes {
                    let parser = Parser::<Record>::new();
                    vertices =
                        parser.read_payload_for_element(&mut reader, element, &header).map_err(error)?;
                    soup.positions = attributes::positions(element, &vertices);
                    continue;
                }
                soup.positions.reserve(element.count);
                in_blocks(&mut reader, element, &header, |vertices: Vec<Vertex>| {
                    soup.positions.extend(vertices.into_iter().map(|v| v.0));
                    Ok(())
                })
                .map_err(|failure| failure.explained(error))?;
            }
            "face" => {
                require_corners(element)?;
                if detail >= Detail::Attributes {
                    let parser = Parser::<Face>::new();
                    let faces =
                        parser.read_payload_for_element(&mut reader, element, &header).map_err(error)?;
                    face_values.add(element, &faces, &mut soup, limits)?;
                    continue;
                }
                soup.ends.reserve(element.count);
                soup.corners.reserve(element.count.saturating_mul(3));
                let mut first = 0;
                in_blocks(&mut reader, element, &header, |faces: Vec<Corners>| {
                    add_faces(&mut soup, first, faces.iter().map(|face| &face.0[..]), limits)?;
                    first += faces.len();
                    Ok(())
                })
                .map_err(|failure| failure.explained(error))?;
            }
            "tristrips" => {
                require_corners(element)?;
                let parser = Parser::<Corners>::new();
                let strips = parser.read_payload_for_element(&mut reader, element, &header).map_err(error)?;
                for (index, strip) in strips.iter().enumerate() {
                    add_strip(&mut soup, index, &strip.0, limits)?;
                }
            }
            // Binary elements without properties take no bytes, however many there are.
            _ if element.properties.is_empty() && header.encoding != Encoding::Ascii => {}
            _ => {
                let parser = Parser::<Passed>::new();
                parser.read_payload_for_element(&mut reader, element, &header).map_err(error)?;
            }
        }
    }
    let mut found = MeshAttributes::default();
    if detail >= Detail::Attributes {
        attributes::collect(&header, &vertices, face_values, &soup, &mut found);
    }
    if detail >= Detail::Textures {
        attributes::texture(&header, &soup, &mut found, limits, resolver)?;
    }
    Ok(Model { soup, attributes: found })
}

/// Why a block was not taken.
enum Failure {
    Parse(ParseError),
    Read(ReadError),
}

impl Failure {
    fn explained(self, explain: impl FnOnce(ParseError) -> ReadError) -> ReadError {
        match self {
            Self::Parse(error) => explain(error),
            Self::Read(error) => error,
        }
    }
}

/// Reads an element block by block, so that not all of it is there twice.
fn in_blocks<E: PropertyAccess>(
    reader: &mut Reader<&[u8]>,
    element: &ElementDef,
    header: &Header,
    mut take: impl FnMut(Vec<E>) -> Result<(), ReadError>,
) -> Result<(), Failure> {
    const BLOCK: usize = 1 << 12;
    let parser = Parser::<E>::new();
    let mut block = element.clone();
    for start in (0..element.count).step_by(BLOCK) {
        block.count = BLOCK.min(element.count - start);
        let elements = parser.read_payload_for_element(reader, &block, header).map_err(Failure::Parse)?;
        take(elements).map_err(Failure::Read)?;
    }
    Ok(())
}

/// The header, and where the data starts.
fn read_header(bytes: &[u8]) -> Result<(Header, usize), ReadError> {
    const END: &[u8] = b"\nend_header";
    let end = bytes.windows(END.len()).position(|window| window == END);
    let line_break = end.and_then(|end| Some(end + 1 + bytes[end + 1..].iter().position(|&b| b == b'\n')?));
    let Some(line_break) = line_break else {
        return Err(ReadError::Truncated {
            format: MeshFormat::Ply,
            place: Place::Byte(bytes.len()),
            problem: "the header has no line `end_header`".into(),
        });
    };
    // Comments in old encodings: the library takes ASCII only.
    let text: Vec<u8> = bytes[..=line_break].iter().map(|&b| if b.is_ascii() { b } else { b'?' }).collect();
    let header = Parser::<Passed>::new()
        .read_header(&mut Reader::new(&text[..]))
        .map_err(|e| malformed(e.line().map_or(Place::File, Place::Line), first_line(&e)))?;
    // The library keeps one of two things with the same name, and would then read the data wrong.
    let starts = |word: &str| text.split(|&b| b == b'\n').filter(|l| l.starts_with(word.as_bytes())).count();
    let properties: usize = header.elements.values().map(|e| e.properties.len()).sum();
    if starts("element ") != header.elements.len() || starts("property ") != properties {
        return Err(malformed(Place::File, "an element or a property is declared twice".into()));
    }
    Ok((header, line_break + 1))
}

/// Refuses counts for which there are not enough bytes: each number takes at least two in text, its size in binary.
fn check_count(element: &ElementDef, header: &Header, remaining: usize) -> Result<(), ReadError> {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let smallest: usize = match header.encoding {
        Encoding::Ascii => (2 * element.properties.len()).max(1),
        _ => element
            .properties
            .values()
            .map(|p| match &p.data_type {
                PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
            })
            .sum(),
    };
    // The last line may have no line break.
    let available = remaining as u64 + u64::from(header.encoding == Encoding::Ascii);
    if (smallest as u64).checked_mul(element.count as u64).is_none_or(|needed| needed > available) {
        return Err(ReadError::Truncated {
            format: MeshFormat::Ply,
            place: Place::File,
            problem: format!(
                "{} elements `{}` are announced, but only {remaining} bytes are left for them",
                element.count,
                brief(&element.name)
            ),
        });
    }
    Ok(())
}

fn require(element: &ElementDef, names: &[&str], fits: fn(&PropertyType) -> bool) -> Result<(), ReadError> {
    for name in names {
        if !element.properties.get(*name).is_some_and(|property| fits(&property.data_type)) {
            let problem = format!("element `{}` has no fitting property `{name}`", brief(&element.name));
            return Err(malformed(Place::File, problem));
        }
    }
    Ok(())
}

fn require_corners(element: &ElementDef) -> Result<(), ReadError> {
    let name =
        if element.properties.contains_key("vertex_index") { "vertex_index" } else { "vertex_indices" };
    require(element, &[name], |kind| matches!(kind, PropertyType::List(..)))
}

/// Adds faces, of which `first` lie before these.
fn add_faces<'a>(
    soup: &mut PolygonSoup,
    first: usize,
    faces: impl Iterator<Item = &'a [i64]>,
    limits: &Limits,
) -> Result<(), ReadError> {
    for (index, face) in (first..).zip(faces) {
        if let Some(&corner) = face.iter().find(|&&corner| u32::try_from(corner).is_err()) {
            return Err(malformed(Place::Item("face", index), format!("a corner is vertex {corner}")));
        }
        push_polygon(soup, face.iter().map(|&corner| corner as u32), MeshFormat::Ply, limits)?;
    }
    Ok(())
}

/// Every corner of a strip makes a triangle with the two before it, turned every second time; -1 starts anew.
fn add_strip(soup: &mut PolygonSoup, index: usize, strip: &[i64], limits: &Limits) -> Result<(), ReadError> {
    for run in strip.split(|&corner| corner == -1) {
        for (i, triangle) in run.windows(3).enumerate() {
            let [a, b, c] =
                if i % 2 == 0 { [0, 1, 2] } else { [1, 0, 2] }.map(|k| u32::try_from(triangle[k]));
            let (Ok(a), Ok(b), Ok(c)) = (a, b, c) else {
                let problem = format!("one of the corners {triangle:?} is not a vertex");
                return Err(malformed(Place::Item("strip", index), problem));
            };
            // Strips are sewn together by triangles with a repeated corner.
            if a != b && b != c && c != a {
                push_polygon(soup, [a, b, c], MeshFormat::Ply, limits)?;
            }
        }
    }
    Ok(())
}

fn malformed(place: Place, problem: String) -> ReadError {
    ReadError::Malformed { format: MeshFormat::Ply, place, problem }
}

/// The library's message without the data that it quotes.
pub(super) fn first_line(error: &ParseError) -> String {
    let message = error.to_string();
    let start =
        message.split_once(": ").filter(|(head, _)| head.starts_with("Line ")).map_or(&*message, |m| m.1);
    let cause = message.rsplit("Error: ").next().filter(|_| message.contains('\n')).unwrap_or_default();
    let line = |text: &str| brief(text.lines().next().unwrap_or_default().trim());
    format!("{} {}", line(start), line(cause)).trim_end().to_string()
}

fn explain(error: ParseError, header: &Header, bytes: &[u8], header_lines: usize) -> ReadError {
    let (format, mut problem) = (MeshFormat::Ply, first_line(&error));
    let place = match (header.encoding, error.line()) {
        (Encoding::Ascii, Some(line)) => {
            // The library counts on from 1 behind the header.
            let line = header_lines + line;
            if let Some(word) = wrong_word(bytes, line) {
                problem = format!("{:?} stands where a finite number must be", brief(&word));
            }
            Place::Line(line)
        }
        _ => Place::File,
    };
    match error.kind() {
        ErrorKind::UnexpectedEof => ReadError::Truncated { format, place, problem },
        _ => ReadError::Malformed { format, place, problem },
    }
}

/// The first word of a line, counted from 1, that is no finite number: the library does not say which it is.
fn wrong_word(bytes: &[u8], line: usize) -> Option<String> {
    let text = String::from_utf8_lossy(bytes.split(|&byte| byte == b'\n').nth(line.checked_sub(1)?)?);
    let mut words = text.split_ascii_whitespace();
    words.find(|word| !word.parse::<f64>().is_ok_and(f64::is_finite)).map(str::to_owned)
}

/// An element that is passed over.
struct Passed;

impl PropertyAccess for Passed {
    fn new() -> Self {
        Self
    }
}

/// The position of a vertex.
struct Vertex(DVec3);

impl Vertex {
    fn set(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        match name {
            "x" => self.0.x = value,
            "y" => self.0.y = value,
            "z" => self.0.z = value,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self(DVec3::ZERO)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match property {
            Property::Char(value) => self.set(name, value.into()),
            Property::UChar(value) => self.set(name, value.into()),
            Property::Short(value) => self.set(name, value.into()),
            Property::UShort(value) => self.set(name, value.into()),
            Property::Int(value) => self.set(name, value.into()),
            Property::UInt(value) => self.set(name, value.into()),
            Property::Float(value) => self.set(name, value.into()),
            Property::Double(value) => self.set(name, value),
            _ => PropertyAccessResult::Ignored,
        }
    }
}

/// The corners of a polygon or strip.
struct Corners(Vec<i64>);

impl Corners {
    fn set<T: Into<i64> + Copy>(&mut self, name: &str, values: &[T]) -> PropertyAccessResult {
        if !is_corners(name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = values.iter().map(|&v| v.into()).collect();
        PropertyAccessResult::Set
    }
}

fn is_corners(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

impl PropertyAccess for Corners {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match property {
            Property::ListChar(values) => self.set(name, &values),
            Property::ListUChar(values) => self.set(name, &values),
            Property::ListShort(values) => self.set(name, &values),
            Property::ListUShort(values) => self.set(name, &values),
            Property::ListInt(values) => self.set(name, &values),
            Property::ListUInt(values) => self.set(name, &values),
            _ if is_corners(name) => PropertyAccessResult::UnsupportedType,
            _ => PropertyAccessResult::Ignored,
        }
    }

    fn begin_list_float(&mut self, name: &str, _: usize) -> BeginList<'_, f32> {
        if is_corners(name) { BeginList::UnsupportedType } else { BeginList::UseSetter }
    }

    fn begin_list_double(&mut self, name: &str, _: usize) -> BeginList<'_, f64> {
        if is_corners(name) { BeginList::UnsupportedType } else { BeginList::UseSetter }
    }
}

#[cfg(test)]
#[path = "ply_tests.rs"]
mod tests;
