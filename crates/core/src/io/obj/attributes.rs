//! What belongs to the corners and polygons of an OBJ file. Own code: `tobj` gives up at the first statement that is
//! not as it expects, and keeps no order of polygons across groups.

use std::str::FromStr;

use glam::{DVec2, DVec3};

use crate::attributes::{CornerValues, MeshAttributes, PolygonNames, from_srgb};
use crate::io::detect::MeshFormat;
use crate::io::obj::{for_each_statement, without_comment};
use crate::io::read::{Model, Place, ReadError, brief};
use crate::io::text::real;

/// Reads the attributes of a file whose polygons were read; gives the names of its material libraries.
pub(super) fn read(text: &str, model: &mut Model) -> Result<Vec<String>, ReadError> {
    let mut reader = Reader::default();
    let mut line = 1;
    let mut failed = None;
    for_each_statement(text, |statement, line_breaks| {
        if failed.is_none() {
            failed = reader.statement(statement).err().map(|problem| (line, problem));
        }
        line += line_breaks;
    });
    if let Some((line, problem)) = failed {
        return Err(ReadError::Malformed { format: MeshFormat::Obj, place: Place::Line(line), problem });
    }
    debug_assert_eq!(reader.corners, model.soup.corners.len());
    debug_assert_eq!(reader.polygons, model.soup.polygon_count());
    let Reader { mut attributes, uv, colors, color_of, libraries, .. } = reader;
    attributes.uv = vec![uv];
    let largest = if colors.iter().any(|color| color.max_element() >= BYTES_FROM) { 255.0 } else { 1.0 };
    attributes.colors.extend(colors.into_iter().map(|color| {
        let rgb = (color / largest).clamp(DVec3::ZERO, DVec3::ONE).to_array().map(from_srgb);
        DVec3::from_array(rgb).extend(1.0)
    }));
    for (corner, &vertex) in model.soup.corners.iter().enumerate() {
        if let Some(color) = color_of.get(vertex as usize).copied().flatten() {
            attributes.colors.set(corner, color);
        }
    }
    model.attributes = attributes;
    Ok(libraries)
}

/// If any number of a colour is this large, all are from 0 to 255, as MeshLab and others write them. Those from 0 to 1
/// may be a little larger than 1 by rounding.
const BYTES_FROM: f64 = 2.0;

/// What was read so far.
#[derive(Default)]
struct Reader {
    attributes: MeshAttributes,
    uv: CornerValues<DVec2>,
    /// sRGB, as they stand in the file.
    colors: Vec<DVec3>,
    /// For each vertex the index of its colour.
    color_of: Vec<Option<usize>>,
    corners: usize,
    polygons: usize,
    material: Option<usize>,
    part: Option<usize>,
    libraries: Vec<String>,
}

impl Reader {
    fn statement(&mut self, statement: &str) -> Result<(), String> {
        let (keyword, rest) = keyword(statement);
        match keyword {
            "v" => {
                let color = numbers(rest).map(|[_, _, _, r, g, b]| DVec3::new(r, g, b));
                let color = color.filter(|color| color.is_finite()).map(|color| {
                    self.colors.push(color);
                    self.colors.len() - 1
                });
                self.color_of.push(color);
            }
            "vn" => {
                let normal = numbers(rest).map(DVec3::from_array);
                let normal = normal.ok_or("`vn` must be followed by three numbers")?;
                self.attributes.normals.extend([normal.normalize_or_zero()]);
            }
            "vt" => {
                // One number is a place along a line.
                let uv = numbers(rest).map(DVec2::from_array);
                let uv = uv.or_else(|| numbers(rest).map(|[u]| DVec2::new(u, 0.0)));
                self.uv.extend([uv.ok_or("`vt` must be followed by numbers")?]);
            }
            "f" | "fo" => self.face(rest)?,
            "usemtl" => self.material = named(&mut self.attributes.material_of, without_comment(rest)),
            "o" | "g" => self.part = named(&mut self.attributes.parts, without_comment(rest)),
            "mtllib" if !rest.trim().is_empty() => self.libraries.push(rest.trim().to_owned()),
            _ => {}
        }
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), String> {
        for word in rest.split('#').next().unwrap_or_default().split_whitespace() {
            let mut indices = word.split('/');
            // The vertex itself is known already.
            indices.next();
            if let Some(uv) = place(indices.next(), self.uv.value_count(), word)? {
                self.uv.set(self.corners, uv);
            }
            if let Some(normal) = place(indices.next(), self.attributes.normals.value_count(), word)? {
                self.attributes.normals.set(self.corners, normal);
            }
            self.corners += 1;
        }
        let polygon = self.polygons..self.polygons + 1;
        self.attributes.material_of.set(polygon.clone(), self.material);
        self.attributes.parts.set(polygon, self.part);
        self.polygons += 1;
        Ok(())
    }
}

/// The keyword and what follows it, told apart exactly as where the polygons are read, by `tobj` too: by white space and
/// `#`.
fn keyword(statement: &str) -> (&str, &str) {
    let statement = statement.trim_start();
    let end = statement.find(|c: char| c.is_whitespace() || c == '#').unwrap_or(statement.len());
    statement.split_at(end)
}

/// The index of a name that is not empty.
fn named(names: &mut PolygonNames, name: &str) -> Option<usize> {
    let name = name.trim();
    (!name.is_empty()).then(|| names.index_of(name))
}

/// The first `N` numbers, which may be infinite or none; `None` unless there are as many before a comment.
fn numbers<const N: usize>(rest: &str) -> Option<[f64; N]> {
    let mut words = rest.split_whitespace();
    let mut numbers = [0.0; N];
    for (index, number) in numbers.iter_mut().enumerate() {
        let word = words.next()?;
        // `-1.#IND` is no comment; of `3#...` the rest is one.
        *number = match (real(word), word.split_once('#')) {
            (Some(number), _) => number,
            (None, Some((number, _))) if index + 1 == N => real(number)?,
            _ => return None,
        };
    }
    Some(numbers)
}

/// The place that an index stands for: counted from 1, or back from the last of `count` so far. `None` without an
/// index.
fn place(index: Option<&str>, count: usize, word: &str) -> Result<Option<usize>, String> {
    let Some(index) = index.filter(|index| !index.is_empty()) else { return Ok(None) };
    let wrong = || format!("the corner {:?} names what does not exist", brief(word));
    let index = i64::from_str(index).map_err(|_| wrong())?;
    let place = if index < 0 { count as i64 + index } else { index - 1 };
    match usize::try_from(place) {
        Ok(place) if place < count => Ok(Some(place)),
        _ => Err(wrong()),
    }
}
