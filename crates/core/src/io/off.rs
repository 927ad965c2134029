//! Reads the object file format of Geomview (<http://www.geomview.org/docs/html/OFF.html>). Own code: no kept
//! library reads it.

use glam::{DVec2, DVec3, DVec4};

use crate::attributes::{CornerValues, MeshAttributes, from_srgb};
use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::read::{Detail, Model, Place, ReadError, brief, push_polygon};
use crate::io::text::text;
use crate::mesh::PolygonSoup;

/// Reads `OFF`, also with texture coordinates, colours, normals (`ST`, `C`, `N` before the word). Polygons may have any number of corners; comments, empty lines, counts in the first line and a missing
/// first word are allowed; what follows the last face is ignored.
///
/// # Errors
/// [`ReadError`]: with the line.
pub fn read(bytes: &[u8]) -> Result<PolygonSoup, ReadError> {
    read_model(bytes, Detail::Shape).map(|model| model.soup)
}

/// Reads `OFF` with what the letters before the word announce at vertices, in Geomview's order: position, normal (`N`),
/// colour (`C`: sRGB, 0 to 1, or 0 to 255 if one is larger than 1), texture coordinates (`ST`).
///
/// # Errors
/// As [`read`].
pub fn read_model(bytes: &[u8], detail: Detail) -> Result<Model, ReadError> {
    read_within(bytes, detail, &Limits::default())
}

pub(super) fn read_within(bytes: &[u8], detail: Detail, limits: &Limits) -> Result<Model, ReadError> {
    let text = text(bytes);
    let mut lines = Lines { lines: text.lines().enumerate(), last: 0 };
    let (mut place, mut line) = lines.next("the head")?;
    let word_end = line.find(|c: char| !c.is_ascii_alphabetic() && c != '4').unwrap_or(line.len());
    let (word, rest) = line.split_at(word_end);
    let mut columns = Columns::announced(word);
    columns.values.resize(if detail >= Detail::Attributes { columns.letters.len() } else { 0 }, Vec::new());
    if word.to_ascii_uppercase().ends_with("OFF") {
        // Geomview writes `nOFF` for any number of dimensions, `NOFF` for normals.
        if word.contains('4') || word == "nOFF" {
            return Err(unsupported(
                place,
                "points of other than three dimensions",
                "write it with three coordinates",
            ));
        }
        let rest = rest.trim();
        if rest.eq_ignore_ascii_case("binary") {
            return Err(unsupported(place, "binary OFF", "export it as text, or as binary PLY"));
        }
        (place, line) = if rest.is_empty() { lines.next("the counts")? } else { (place, rest) };
    }
    let mut numbers = line.split_whitespace();
    let vertex_count: usize = number(&mut numbers, place, "the number of vertices")?;
    let face_count: usize = number(&mut numbers, place, "the number of faces")?;

    limits.vertices(MeshFormat::Off, place, vertex_count)?;

    let mut soup = PolygonSoup::default();
    // The counts are only believed as far as there are bytes: a line is at least as long as `0 0 0`.
    soup.positions.reserve(vertex_count.min(bytes.len() / 6));
    for _ in 0..vertex_count {
        let (place, line) = lines.next("the vertices")?;
        let mut numbers = line.split_whitespace();
        let mut next = || number(&mut numbers, place, "a coordinate");
        soup.positions.push(DVec3::new(next()?, next()?, next()?));
        if !columns.values.is_empty() {
            columns.read(&mut numbers, place)?;
        }
    }
    let mut corners = Vec::new();
    for _ in 0..face_count {
        let (place, line) = lines.next("the faces")?;
        let mut numbers = line.split_whitespace();
        let count: usize = number(&mut numbers, place, "the number of corners")?;
        corners.clear();
        for _ in 0..count {
            corners.push(number(&mut numbers, place, "a corner")?);
        }
        push_polygon(&mut soup, corners.iter().copied(), MeshFormat::Off, limits)?;
    }
    let attributes = columns.finish(&soup.corners);
    Ok(Model { soup, attributes })
}

/// What stands at a vertex behind the position, in the order of the file.
struct Columns {
    letters: Vec<Letter>,
    /// For each of the letters the numbers of all vertices, if they are wanted.
    values: Vec<Vec<f64>>,
}

#[derive(Clone, Copy, PartialEq)]
enum Letter {
    Normal,
    Color,
    Texture,
}

impl Columns {
    fn announced(word: &str) -> Self {
        let prefix = word.to_ascii_uppercase();
        let prefix = prefix.strip_suffix("OFF").unwrap_or_default();
        let known = [("N", Letter::Normal), ("C", Letter::Color), ("ST", Letter::Texture)];
        let letters =
            known.into_iter().filter(|(letter, _)| prefix.contains(letter)).map(|(_, l)| l).collect();
        Self { letters, values: Vec::new() }
    }

    /// Reads a vertex; colours may have three or four numbers.
    fn read<'a>(
        &mut self,
        numbers: &mut impl Iterator<Item = &'a str>,
        place: Place,
    ) -> Result<(), ReadError> {
        let mut rest: Vec<f64> = Vec::new();
        for word in numbers {
            rest.push(number(&mut std::iter::once(word), place, "a number of the vertex")?);
        }
        let texture = if self.letters.contains(&Letter::Texture) { 2 } else { 0 };
        let mut rest = &rest[..];
        for (letter, values) in self.letters.iter().zip(&mut self.values) {
            let count = match letter {
                Letter::Normal => 3,
                Letter::Color if rest.len() == 3 + texture => 3,
                Letter::Color => 4,
                Letter::Texture => 2,
            };
            let Some((own, others)) = rest.split_at_checked(count) else {
                let problem = format!("{} numbers are missing at the vertex", count - rest.len());
                return Err(ReadError::Malformed { format: MeshFormat::Off, place, problem });
            };
            values.extend_from_slice(own);
            if count == 3 && *letter == Letter::Color {
                // Without alpha: as bright as the largest there may be.
                values.push(f64::INFINITY);
            }
            rest = others;
        }
        Ok(())
    }

    fn finish(self, corners: &[u32]) -> MeshAttributes {
        let mut found = MeshAttributes::default();
        for (letter, values) in self.letters.iter().zip(self.values) {
            match letter {
                Letter::Normal => {
                    let normals = values.chunks_exact(3).map(|n| DVec3::from_slice(n).normalize_or_zero());
                    found.normals = CornerValues::by_vertex(normals.collect(), corners);
                }
                Letter::Color => {
                    let bytes = values.iter().any(|&value| value > 1.0 && value.is_finite());
                    let largest = if bytes { 255.0 } else { 1.0 };
                    let colors = values.chunks_exact(4).map(|rgba| {
                        let [r, g, b, a] = [0, 1, 2, 3].map(|i| (rgba[i] / largest).clamp(0.0, 1.0));
                        DVec4::new(from_srgb(r), from_srgb(g), from_srgb(b), a)
                    });
                    found.colors = CornerValues::by_vertex(colors.collect(), corners);
                }
                Letter::Texture => {
                    let uv = values.chunks_exact(2).map(DVec2::from_slice).collect();
                    found.uv = vec![CornerValues::by_vertex(uv, corners)];
                }
            }
        }
        found
    }
}

/// Lines that are not empty, without comments.
struct Lines<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    last: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self, wanted: &str) -> Result<(Place, &'a str), ReadError> {
        for (index, line) in self.lines.by_ref() {
            self.last = index + 1;
            let line = line.split('#').next().unwrap_or_default().trim();
            if !line.is_empty() {
                return Ok((Place::Line(self.last), line));
            }
        }
        Err(ReadError::Truncated {
            format: MeshFormat::Off,
            place: Place::Line(self.last),
            problem: format!("it ends before the end of {wanted}"),
        })
    }
}

fn number<'a, T: std::str::FromStr>(
    words: &mut impl Iterator<Item = &'a str>,
    place: Place,
    wanted: &str,
) -> Result<T, ReadError> {
    let word = words.next();
    word.and_then(|word| word.parse().ok()).ok_or_else(|| ReadError::Malformed {
        format: MeshFormat::Off,
        place,
        problem: match word {
            Some(word) => format!("{wanted} is expected, but there is {:?}", brief(word)),
            None => format!("{wanted} is missing"),
        },
    })
}

fn unsupported(place: Place, what: &str, advice: &'static str) -> ReadError {
    ReadError::Unsupported { format: MeshFormat::Off, place, what: what.into(), advice }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain() {
        let soup = read(b"OFF\n# a comment\n4 2 5\n\n0 0 0\n1 0 0 # corner\n1 1 0\n0 1e0 0.5\n3 0 1 2\n4 0 1 2 3 255 0 0\nmore").unwrap();
        assert_eq!(soup.positions.len(), 4);
        assert_eq!(soup.positions[3], DVec3::new(0.0, 1.0, 0.5));
        assert_eq!((soup.polygon(0), soup.polygon(1)), (&[0, 1, 2][..], &[0, 1, 2, 3][..]));
    }

    #[test]
    fn variants() {
        let body = "3 1 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n0 1 0 0 0 1 1\n3 0 1 2\n";
        for head in ["COFF\n", "off ", "NOFF\r\n", "STCNOFF\n\n", "OFF", "\u{feff}OFF\n", ""] {
            let soup = read(format!("{head}{body}").as_bytes()).unwrap();
            assert_eq!((soup.positions.len(), soup.polygon(0)), (3, &[0, 1, 2][..]), "{head}");
        }
    }

    #[test]
    fn errors_name_the_line() {
        let message = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
        assert!(message("").starts_with("OFF, line 0: it ends before the end of the head"));
        assert!(
            message("OFF\n3 1 0\n0 0 0\n0 x 0\n")
                .contains("line 4: a coordinate is expected, but there is \"x\"")
        );
        assert!(message("OFF\n3 1 0\n0 0 0\n0 0\n").contains("line 4: a coordinate is missing"));
        assert!(message("OFF\n3 1 0\n0 0 0\n").contains("line 3: it ends before the end of the vertices"));
        assert!(message("OFF\n1 1 0\n0 0 0\n3 0 1 -2\n").contains("\"-2\""));
        assert!(message("OFF\n1000000 1 0\n0 0 0\n").contains("cut off"));
        assert!(message("OFF\n1000000000000 1 0\n0 0 0\n").contains("which is the limit"));
        assert!(message("OFF\n1 1 0\n0 0 0\n99999999999 0 0\n").contains("line 4: a corner is missing"));
        assert!(message("OFF BINARY\n\0\0\0").contains("binary OFF cannot be read"));
        assert!(message("nOFF\n4\n1 1 1\n0 0 0 0\n").contains("other than three"));
        assert!(message("4OFF\n1 1 1\n0 0 0 0\n").contains("dimensions cannot be read"));
    }
}
