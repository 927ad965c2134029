//! Reads PLY files in all three encodings: headers and binary data with `ply-rs-bw`, but for the commonest in `plain`, text in
//! `ascii`.

mod ascii;
mod attributes;
mod plain;

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
use ascii::Lines;
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
    let text =
        String::from_utf8_lossy(if header.encoding == Encoding::Ascii { &bytes[start..] } else { &[] });
    let mut data = match header.encoding {
        Encoding::Ascii => Data::Text(Lines::new(&text, header_lines(&bytes[..start]))),
        _ => Data::Binary(Reader::new(&bytes[start..]), &header),
    };
    let mut soup = PolygonSoup::default();
    let (mut vertices, mut face_values) = (Vec::<Record>::new(), Faces::default());
    for element in header.elements.values() {
        check_count(element, &header, data.remaining())?;
        match element.name.as_str() {
            "vertex" => {
                require(element, &["x", "y", "z"], |kind| matches!(kind, PropertyType::Scalar(_)))?;
                limits.vertices(MeshFormat::Ply, Place::File, element.count)?;
                if detail >= Detail::Attributes {
                    vertices = data.records::<Record>(element)?;
                    soup.positions = attributes::positions(element, &vertices);
                    continue;
                }
                if let Some(positions) =
                    data.plain(|bytes, encoding| plain::positions(bytes, element, encoding))
                {
                    soup.positions.extend(positions);
                    continue;
                }
                soup.positions.reserve(data.likely(element));
                data.in_blocks(element, |vertices: Vec<Vertex>| {
                    soup.positions.extend(vertices.into_iter().map(|v| v.0));
                    Ok(())
                })?;
            }
            "face" => {
                require_corners(element)?;
                if detail >= Detail::Attributes {
                    let faces = data.records::<Face>(element)?;
                    face_values.add(element, &faces, &mut soup, limits)?;
                    continue;
                }
                soup.ends.reserve(data.likely(element));
                soup.corners.reserve(3 * data.likely(element));
                let added = data.plain(|bytes, encoding| {
                    match plain::add_polygons(&mut soup, bytes, element, encoding, limits)? {
                        Ok(length) => Some((Ok(()), length)),
                        // Nothing is read any more.
                        Err(error) => Some((Err(error), 0)),
                    }
                });
                if let Some(added) = added {
                    added?;
                    continue;
                }
                let mut first = 0;
                data.in_blocks(element, |faces: Vec<Corners>| {
                    add_faces(&mut soup, first, faces.iter().map(|face| &face.0[..]), limits)?;
                    first += faces.len();
                    Ok(())
                })?;
            }
            "tristrips" => {
                require_corners(element)?;
                for (index, strip) in data.records::<Corners>(element)?.iter().enumerate() {
                    add_strip(&mut soup, index, &strip.0, limits)?;
                }
            }
            // Elements without properties take no bytes, however many there are.
            _ if element.properties.is_empty() => {}
            _ => drop(data.records::<Passed>(element)?),
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

/// What follows the header.
enum Data<'a> {
    Text(Lines<'a>),
    Binary(Reader<&'a [u8]>, &'a Header),
}

impl Data<'_> {
    fn remaining(&self) -> usize {
        match self {
            Self::Text(lines) => lines.remaining(),
            Self::Binary(reader, _) => reader.get_ref().len(),
        }
    }

    fn records<E: PropertyAccess>(&mut self, element: &ElementDef) -> Result<Vec<E>, ReadError> {
        match self {
            Self::Text(lines) => lines.records(element),
            Self::Binary(reader, header) => {
                Parser::<E>::new().read_payload_for_element(reader, element, header).map_err(|e| explain(&e))
            }
        }
    }

    /// What `read` makes of binary data, which says how many bytes it took; `None` if nothing.
    fn plain<T>(&mut self, read: impl FnOnce(&[u8], Encoding) -> Option<(T, usize)>) -> Option<T> {
        let Self::Binary(reader, header) = self else { return None };
        let (made, length) = read(reader.get_ref(), header.encoding)?;
        let bytes = reader.get_mut();
        *bytes = &bytes[length..];
        Some(made)
    }

    /// How many of the elements are sure to be there if each is three singles, or three corners.
    fn likely(&self, element: &ElementDef) -> usize {
        element.count.min(self.remaining() / 12)
    }

    /// As [`records`](Self::records); binary ones block by block, so that not all are there twice.
    fn in_blocks<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(Vec<E>) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        const BLOCK: usize = 1 << 12;
        if let Self::Text(lines) = self {
            return take(lines.records(element)?);
        }
        let mut block = element.clone();
        for start in (0..element.count).step_by(BLOCK) {
            block.count = BLOCK.min(element.count - start);
            take(self.records(&block)?)?;
        }
        Ok(())
    }
}

/// The end of its lines: some files have carriage returns alone.
fn line_end(bytes: &[u8]) -> u8 {
    if bytes.starts_with(b"ply\r") && bytes.get(4) != Some(&b'\n') { b'\r' } else { b'\n' }
}

fn header_lines(header: &[u8]) -> usize {
    let end = line_end(header);
    header.iter().filter(|&&byte| byte == end).count()
}

/// The header, and where the data starts.
fn read_header(bytes: &[u8]) -> Result<(Header, usize), ReadError> {
    const END: &[u8] = b"end_header";
    let new_line = line_end(bytes);
    let is_end = |window: &[u8]| window[0] == new_line && &window[1..] == END;
    let end = bytes.windows(1 + END.len()).position(is_end);
    let line_break =
        end.and_then(|end| Some(end + 1 + bytes[end + 1..].iter().position(|&b| b == new_line)?));
    let Some(line_break) = line_break else {
        return Err(ReadError::Truncated {
            format: MeshFormat::Ply,
            place: Place::Byte(bytes.len()),
            problem: "the header has no line `end_header`".into(),
        });
    };
    // Comments in old encodings: the library takes ASCII only.
    let plain = |&byte: &u8| match byte {
        byte if byte == new_line => b'\n',
        byte if byte.is_ascii() => byte,
        _ => b'?',
    };
    let text: Vec<u8> = bytes[..=line_break].iter().map(plain).collect();
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

/// How many bytes a number takes.
fn scalar_size(scalar: &ScalarType) -> usize {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Refuses counts for which there are not enough bytes: each number takes at least two in text, its size in binary.
fn check_count(element: &ElementDef, header: &Header, remaining: usize) -> Result<(), ReadError> {
    let smallest: usize = match header.encoding {
        Encoding::Ascii => 2 * element.properties.len(),
        _ => element
            .properties
            .values()
            .map(|p| match &p.data_type {
                PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => scalar_size(scalar),
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

fn explain(error: &ParseError) -> ReadError {
    let (format, place, problem) = (MeshFormat::Ply, Place::File, first_line(error));
    match error.kind() {
        ErrorKind::UnexpectedEof => ReadError::Truncated { format, place, problem },
        _ => ReadError::Malformed { format, place, problem },
    }
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
