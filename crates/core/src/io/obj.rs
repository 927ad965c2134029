//! Reads Wavefront OBJ files: the polygons with `tobj`, what belongs to them in `attributes` and `material`.

mod attributes;
mod material;

use std::io::{self, BufRead, Read};

use glam::DVec3;
use tobj::{LoadError, LoadOptions};

use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::read::{Detail, Model, Place, ReadError, Resolver, brief, push_polygon};
use crate::io::text::text;
use crate::mesh::PolygonSoup;

/// Reads an OBJ file: all its vertices and its faces with any number of corners; relative (negative) indices and
/// continued lines are understood. Lines and points are passed over.
///
/// # Errors
/// [`ReadError`]: with the line.
pub fn read(bytes: &[u8]) -> Result<PolygonSoup, ReadError> {
    read_text(&text(bytes), &Limits::default())
}

/// Reads an OBJ file with the normals (`vn`), texture coordinates (`vt`) and colours (three sRGB numbers behind
/// the position, from 0 to 1, or from 0 to 255 if any is 2 or more) of its corners, the parts (`o` and `g`, whichever came last) and names of materials; for
/// [`Detail::Textures`] also its material libraries (`mtllib`): `Kd` (sRGB), `d` or `Tr`, and `map_Kd` with its
/// options `-o`, `-s` and `-clamp`. Comments behind names, and quotation marks around them, are no part of them.
///
/// # Errors
/// [`ReadError`]: with the line; a material library or picture that the resolver does not have.
pub fn read_model(bytes: &[u8], detail: Detail, resolver: &Resolver<'_>) -> Result<Model, ReadError> {
    read_within(bytes, detail, &Limits::default(), resolver)
}

pub(super) fn read_within(
    bytes: &[u8],
    detail: Detail,
    limits: &Limits,
    resolver: &Resolver<'_>,
) -> Result<Model, ReadError> {
    let text = text(bytes);
    let mut model = Model::from(read_text(&text, limits)?);
    if detail >= Detail::Attributes {
        let libraries = attributes::read(&text, &mut model)?;
        if detail >= Detail::Textures {
            material::load(&libraries, &mut model.attributes, limits, resolver)?;
        }
    }
    Ok(model)
}

fn read_text(text: &str, limits: &Limits) -> Result<PolygonSoup, ReadError> {
    let (plain, vertices) = plain(text);
    limits.vertices(MeshFormat::Obj, Place::File, vertices)?;
    let plain = behind_all(vertices, plain);
    let mut lines = LineCounter { rest: plain.as_bytes(), line: 0 };
    let options = LoadOptions { triangulate: false, ..LoadOptions::default() };
    let (models, _) = tobj::load_obj_buf(&mut lines, &options, |_| Err(LoadError::GenericFailure))
        // The first line is not the file's.
        .map_err(|error| explain(error, &plain, lines.line - 1))?;

    let mut soup = PolygonSoup::default();
    // Without groups there is one model. No arities mean that all faces are triangles.
    for mesh in models.into_iter().map(|model| model.mesh) {
        soup.positions = mesh.positions.chunks_exact(3).map(DVec3::from_slice).collect();
        let triangles = if mesh.face_arities.is_empty() { mesh.indices.len() / 3 } else { 0 };
        let mut corners = mesh.indices.iter().copied();
        let mut arities = mesh.face_arities.iter().copied().chain(std::iter::repeat_n(3, triangles));
        let all_vertices = arities.next().unwrap_or_default();
        corners.by_ref().take(all_vertices as usize).for_each(drop);
        for arity in arities {
            push_polygon(&mut soup, corners.by_ref().take(arity as usize), MeshFormat::Obj, limits)?;
        }
    }
    Ok(soup)
}

/// The same lines with nothing but positions and corners, and how many vertices there are. The library stops at what
/// is none of our business: colours at some of the vertices, comments behind a face, materials without a name; and it
/// takes polylines for faces.
fn plain(text: &str) -> (String, usize) {
    let mut plain = String::with_capacity(2 * text.len());
    let mut vertices = 0;
    for_each_statement(text, |statement, line_breaks| {
        let mut words = statement.split('#').next().unwrap_or_default().split_whitespace();
        match words.next() {
            Some("v") => {
                vertices += 1;
                plain.push('v');
                for word in words.take(3) {
                    plain.push(' ');
                    plain.push_str(word);
                }
            }
            Some("f" | "fo") => {
                plain.push('f');
                for word in words {
                    plain.push(' ');
                    // Of `position/texture/normal` the first; kept whole if there is none, for the error.
                    plain.push_str(word.split('/').next().filter(|index| !index.is_empty()).unwrap_or(word));
                }
            }
            _ => {}
        }
        plain.extend(std::iter::repeat_n('\n', line_breaks));
    });
    (plain, vertices)
}

/// The lines behind a face of all vertices: the library renumbers the vertices as faces use them, which makes this the
/// order of the file.
fn behind_all(vertices: usize, plain: String) -> String {
    let all: String = (1..=vertices).fold("f".into(), |all, vertex: usize| all + " " + &vertex.to_string());
    all + "\n" + &plain
}

/// A name without the comment behind it, and without the quotation marks around it. A `#` that stands right before a
/// letter or digit belongs to the name, as in `Material #25`.
fn without_comment(name: &str) -> &str {
    let is_comment = |&at: &usize| {
        let (before, after) = (&name[..at], &name[at + 1..]);
        (before.is_empty() || before.ends_with(char::is_whitespace))
            && (after.is_empty() || after.starts_with(char::is_whitespace))
    };
    let comment = name.match_indices('#').map(|(at, _)| at).find(is_comment);
    let name = name[..comment.unwrap_or(name.len())].trim();
    name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name)
}

/// Calls `f` with every line, and how many lines of the file it takes: those that end in `\` go on in the next.
fn for_each_statement(text: &str, mut f: impl FnMut(&str, usize)) {
    let mut lines = text.lines();
    let mut joined = String::new();
    while let Some(line) = lines.next() {
        if !line.trim_end().ends_with('\\') {
            f(line, 1);
            continue;
        }
        joined.clear();
        let mut line_breaks = 1;
        let mut next = Some(line);
        while let Some(part) = next {
            let part = part.trim_end();
            joined.push_str(part.trim_end_matches('\\'));
            joined.push(' ');
            next = if part.ends_with('\\') { lines.next() } else { None };
            line_breaks += usize::from(next.is_some());
        }
        f(&joined, line_breaks);
    }
}

/// Bytes that know the line they are at, because the library does not.
struct LineCounter<'a> {
    rest: &'a [u8],
    line: usize,
}

impl Read for LineCounter<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.rest[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for LineCounter<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, count: usize) {
        let (done, rest) = self.rest.split_at(count);
        self.line += done.iter().filter(|&&byte| byte == b'\n').count();
        self.rest = rest;
    }
}

fn explain(error: LoadError, plain: &str, line: usize) -> ReadError {
    let (place, problem) = match error {
        LoadError::FaceVertexOutOfBounds => out_of_bounds(plain),
        LoadError::PositionParseError => {
            (Place::Line(line), "`v` must be followed by three numbers".to_string())
        }
        LoadError::FaceParseError => {
            (Place::Line(line), "`f` must be followed by numbers of vertices".to_string())
        }
        error => (Place::Line(line), brief(&error.to_string())),
    };
    ReadError::Malformed { format: MeshFormat::Obj, place, problem }
}

/// Looks for the corner that the library complained about without saying where.
fn out_of_bounds(plain: &str) -> (Place, String) {
    let total = plain.lines().filter(|line| line.starts_with('v')).count();
    let mut before = 0;
    for (line, text) in plain.lines().enumerate().skip(1) {
        before += usize::from(text.starts_with('v'));
        for word in text.split_whitespace().skip(1).filter(|_| text.starts_with('f')) {
            let index: i64 = word.parse().unwrap_or(0);
            let vertex = if index < 0 { before as i64 + index } else { index - 1 };
            if !(0..total as i64).contains(&vertex) {
                let problem =
                    format!("a corner is vertex {}, but there are {total} (they count from 1)", brief(word));
                return (Place::Line(line), problem);
            }
        }
    }
    (Place::File, "a face has a vertex that does not exist".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_groups_and_relative_indices() {
        let text = "# comment \u{e9}\nmtllib none.mtl\no first\nv 0 0 0\nv 1 0 0 1.0 0.5 0.25\nv 1 1 0\nv 0 1 0 1\n\
                    vt 0 0\nvn 0 0 1\nusemtl\nf 1/1/1 2/1/1 3//1 4 # a quad\ng second\nusemtl a\nf -4 \\\n -3 -2\n\
                    l 1 2 3\np 1\nf 3 4 5\nv 5 5 5\ns off\nvp 1 2\n";
        let soup = read(text.as_bytes()).unwrap();
        assert_eq!(soup.positions.len(), 5);
        assert_eq!(soup.positions[4], DVec3::splat(5.0));
        let polygons: Vec<&[u32]> = (0..soup.polygon_count()).map(|p| soup.polygon(p)).collect();
        assert_eq!(polygons, [&[0, 1, 2, 3][..], &[0, 1, 2], &[2, 3, 4]]);
        let latin = [&b"# \xe9\xff\n"[..], text.as_bytes()].concat();
        assert_eq!(read(&latin).unwrap(), soup);
        assert_eq!(read(text.replace('\n', "\r\n").as_bytes()).unwrap(), soup);
    }

    /// Found by fuzzing: polygons and what belongs to them were told apart by different white space.
    #[test]
    fn attributes_keep_pace_with_the_polygons() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf\u{c}1 \u{b} 2 3\nusemtl b\n\u{a0}f 1 2 3\n\u{b}f 1 2 3\nf 3 2 1\n\
                    f#1 2 3\nusemtl c\nf 2 1 3\n";
        let model = read_model(text.as_bytes(), Detail::Attributes, &|_| Err(String::new())).unwrap();
        let materials = &model.attributes.material_of;
        let of: Vec<_> = (0..model.soup.polygon_count())
            .map(|p| (model.soup.polygon(p).len(), materials.get(p).map(|m| &*materials.names()[m])))
            .collect();
        assert_eq!(
            of,
            [(3, Some("a")), (3, Some("b")), (3, Some("b")), (3, Some("b")), (0, Some("b")), (3, Some("c"))]
        );
    }

    #[test]
    fn names_end_before_comments() {
        for (name, bare) in [
            (" m # c", "m"),
            ("m #", "m"),
            ("m\t# a # b", "m"),
            ("Material #25", "Material #25"),
            ("a#b", "a#b"),
            ("\"oak wood\" # c", "oak wood"),
            ("\"", "\""),
            ("# c", ""),
        ] {
            assert_eq!(without_comment(name), bare, "{name}");
        }
    }

    fn attributes(text: &str) -> crate::attributes::MeshAttributes {
        let model = read_model(text.as_bytes(), Detail::Attributes, &|_| Err(String::new()));
        model.unwrap_or_else(|error| panic!("{text}: {error}")).attributes
    }

    #[test]
    fn colors_up_to_1_or_255() {
        for (white, grey, largest) in [("1", "0.5", 1.0), ("255", "128", 255.0), ("1.0000001", "0.5", 1.0)] {
            let text = format!("v 0 0 0 {white} {grey} 0\nv 1 0 0 0 0 0\nv 0 1 0 nan 0 0\nf 1 2 3\n");
            let colors = attributes(&text).colors;
            let grey = crate::attributes::from_srgb(grey.parse::<f64>().unwrap() / largest);
            assert_eq!(colors.get(0), Some(glam::DVec4::new(1.0, grey, 0.0, 1.0)), "{text}");
            assert_eq!(colors.get(1), Some(glam::DVec4::W));
            assert_eq!(colors.get(2), None);
        }
    }

    /// As in glTF: such normals are none, such coordinates stay as they are.
    #[test]
    fn attributes_that_are_not_finite() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan nan nan\nvn -1.#IND 0 1\nvn 0 0 2\nvt nan inf\nvt 0.5 0.25\n\
                    f 1/1/1 2/2/2 3/2/3\n";
        let found = attributes(text);
        assert_eq!(
            [0, 1, 2].map(|corner| found.normals.get(corner).unwrap()),
            [DVec3::ZERO, DVec3::ZERO, DVec3::Z]
        );
        let uv = found.uv[0].get(0).unwrap();
        assert!(uv.x.is_nan() && uv.y == f64::INFINITY);
        for wrong in ["vn 1 2\n", "vn 1 two 3\n", "vt\n"] {
            let text = text.to_owned() + wrong;
            let error = read_model(text.as_bytes(), Detail::Attributes, &|_| Err(String::new())).unwrap_err();
            assert!(error.to_string().starts_with("OBJ, line 10"), "{error}");
        }
    }

    #[test]
    fn double_precision_is_kept() {
        let soup = read(b"v 0.1 1e-30 123456789.125\nv 0 0 0\nv 1 0 0\nf 1 2 3").unwrap();
        assert_eq!(soup.positions[0], DVec3::new(0.1, 1e-30, 123_456_789.125));
    }

    #[test]
    fn errors_name_the_line() {
        let message = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
        assert!(message("v 0 0 0\n\nv 0 zero 0\n").starts_with("OBJ, line 3: `v` must be followed by"));
        assert!(message("v 0 0 0\nv 0 0\n").starts_with("OBJ, line 2"));
        assert!(
            message("v 0 0 0\nf 1 \\\n 1 1\nf 1 1 2\nf 1 1 7\n")
                .contains("line 4: a corner is vertex 2, but there are 1")
        );
        assert!(message("v 0 0 0\nf 1 1 -2\n").contains("line 2: a corner is vertex -2"));
        assert!(message("v 0 0 0\nf 1 1 0\n").contains("vertex 0"));
        assert!(message("v 0 0 0\nf 1 1 /1\n").contains("vertex /1"));
        assert!(message("v 0 0 0\nf 1 1 x\n").contains("line 2: `f` must be"));
        assert!(message("v 0 0 0\nf 1 1 9223372036854775807\n").contains("line 2"));
        assert!(message("v 0 0 0\nf 1 1 -9223372036854775808\n").contains("line 2"));
        assert!(message("v 0 0 0\nf 1 1 99999999999999999999\n").contains("line 2"));
        assert_eq!(read(b"").unwrap(), PolygonSoup::default());
    }

    #[test]
    fn vertices_keep_their_numbers_also_without_a_face() {
        for count in 0..6u32 {
            let vertices: String = (0..count).map(|i| format!("v {i} 0 0\n")).collect();
            let face = if count > 2 { format!("f -1 {} -3\n", count - 1) } else { String::new() };
            let soup = read((vertices + &face).as_bytes()).unwrap();
            assert_eq!(
                soup.positions,
                (0..count).map(|i| DVec3::new(i.into(), 0.0, 0.0)).collect::<Vec<_>>()
            );
            let corners = if count > 2 { vec![count - 1, count - 2, count - 3] } else { vec![] };
            assert_eq!((soup.corners, soup.ends.len()), (corners, usize::from(count > 2)));
        }
    }
}
