//! Files to take away.

use std::fmt::Write as _;

use glam::Vec2;
use ldwrap::io::points::{PointFormat, PointRow, write_points};
use ldwrap::{Origin, SurfaceMesh};
use serde::{Deserialize, Serialize};

use crate::engine::Made;
use crate::scene::{Layout, RunScene, Side, sides_of};

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Export {
    /// Points with normals and faces as PLY.
    Ply,
    /// Points as a table.
    Csv,
    /// Positions as a NumPy array.
    Npy,
    /// The strips as a picture.
    Svg,
    /// The report.
    Json,
}

impl Export {
    /// All, in the order in which they are offered.
    pub const ALL: [Self; 5] = [Self::Ply, Self::Csv, Self::Npy, Self::Svg, Self::Json];

    /// What a person reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => "Points, PLY",
            Self::Csv => "Points, CSV",
            Self::Npy => "Points, NPY",
            Self::Svg => "Strips, SVG",
            Self::Json => "Report, JSON",
        }
    }

    fn ending(self) -> &'static str {
        match self {
            Self::Ply => "-points.ply",
            Self::Csv => "-points.csv",
            Self::Npy => "-points.npy",
            Self::Svg => "-strips.svg",
            Self::Json => "-report.json",
        }
    }
}

/// The name of the file for a mesh.
pub fn file_name(mesh: &str, what: Export) -> String {
    let stem = mesh.rsplit_once('.').map_or(mesh, |(stem, _)| stem);
    format!("{stem}{}", what.ending())
}

/// Makes a file.
///
/// # Errors
/// What went wrong, for a person.
pub(crate) fn export(mesh: &SurfaceMesh, made: &Made, what: Export) -> Result<Vec<u8>, String> {
    match what {
        Export::Ply => points(mesh, made, PointFormat::Ply),
        Export::Csv => points(mesh, made, PointFormat::Csv),
        Export::Npy => points(mesh, made, PointFormat::Npy),
        Export::Svg => Ok(strips(&made.scene).into_bytes()),
        Export::Json => Ok(made.scene.report.clone().into_bytes()),
    }
}

fn points(mesh: &SurfaceMesh, made: &Made, format: PointFormat) -> Result<Vec<u8>, String> {
    let rows: Vec<PointRow> = made.run.samples.iter().map(|sample| PointRow::new(mesh, sample)).collect();
    let mut bytes = Vec::new();
    write_points(format, &rows, &mut bytes).map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// The strips side by side, each in a colour of its own with its border and points; points that the correction moved
/// are pink, as in the paper.
fn strips(run: &RunScene) -> String {
    const WIDTH: f32 = 1200.0;
    let extent = run.extent(Layout::Apart);
    let margin = 0.02 * extent.max_element();
    let scale = WIDTH / (extent.x + 2.0 * margin).max(f32::MIN_POSITIVE);
    let height = scale * (extent.y + 2.0 * margin);
    // The picture's y axis points down.
    let at = |p: Vec2| (scale * (p.x + margin), height - scale * (p.y + margin));
    let mut fills = vec![String::new(); run.strips.len()];
    let mut cuts = vec![String::new(); run.strips.len()];
    for (face, &strip) in (0..).zip(&run.strip_of) {
        let corners = run.planar_triangle(Layout::Apart, face);
        let [(ax, ay), (bx, by), (cx, cy)] = corners.map(at);
        // Writing to a string cannot fail.
        let _ = write!(fills[strip as usize], "M{ax:.2} {ay:.2}L{bx:.2} {by:.2}L{cx:.2} {cy:.2}Z");
        for (k, side) in run.sides[sides_of(face)].iter().enumerate() {
            if *side == Side::Open {
                let ((ax, ay), (bx, by)) = (at(corners[k]), at(corners[(k + 1) % 3]));
                let _ = write!(cuts[strip as usize], "M{ax:.2} {ay:.2}L{bx:.2} {by:.2}");
            }
        }
    }
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH:.0} {height:.0}\">\n<rect width=\"100%\" \
         height=\"100%\" fill=\"white\"/>\n"
    );
    for (strip, (fill, cut)) in (0..).zip(fills.iter().zip(&cuts)) {
        let [r, g, b] = strip_colour(strip);
        let colour = format!("rgb({r},{g},{b})");
        let _ = write!(
            svg,
            "<path fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\".3\" d=\"{fill}\"/>\n\
             <path fill=\"none\" stroke=\"#222\" stroke-width=\".8\" d=\"{cut}\"/>\n"
        );
    }
    let radius = (0.25 * scale * run.d_m as f32).clamp(0.5, 4.0);
    for (point, of) in run.points.iter().enumerate() {
        let (x, y) = at(run.planar_point(Layout::Apart, point));
        let fill = if of.origin == Origin::Projected { "#eb32a0" } else { "#111" };
        let _ = writeln!(svg, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" fill=\"{fill}\"/>");
    }
    svg.push_str("</svg>\n");
    svg
}

/// Okabe and Ito's colours (2008) without the purple, which is too near to the pink of corrected points.
const STRIPS: [[u8; 3]; 7] = [
    [86, 180, 233],
    [230, 159, 0],
    [0, 158, 115],
    [240, 228, 66],
    [70, 130, 200],
    [213, 110, 50],
    [165, 165, 165],
];

/// The colour of a strip: neighbours in number differ; each round of the list is a little darker.
pub fn strip_colour(strip: u32) -> [u8; 3] {
    let round = (strip as usize / STRIPS.len()) % 3;
    let shade = [1.0, 0.82, 0.66][round];
    STRIPS[strip as usize % STRIPS.len()].map(|c| (f32::from(c) * shade) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{Answer, Engine, Job, Slot};
    use crate::settings::Settings;
    use crate::source::Source;
    use ldwrap::Silent;
    use ldwrap::shapes::Shape;

    #[test]
    fn every_kind_of_file_holds_all_points() {
        let mut engine = Engine::default();
        let mut answer = |job| engine.handle(job, &Silent, &|| 0.0);
        answer(Job::Load(Source::Shape(Shape::Cube)));
        answer(Job::Wrap(
            Slot::A,
            Settings { request: ldwrap::pipeline::Request::Count(50), ..Settings::default() },
        ));
        for what in Export::ALL {
            let Answer::Exported(name, bytes) = answer(Job::Export(Slot::A, what)) else {
                panic!("{}", what.name())
            };
            assert!(name.starts_with("cube-"), "{name}");
            let text = String::from_utf8_lossy(&bytes);
            match what {
                Export::Ply => assert!(text.contains("element vertex 50"), "{text}"),
                Export::Csv => assert_eq!(text.lines().count(), 51),
                Export::Npy => assert!(text.contains("(50, 3)"), "{text}"),
                Export::Svg => assert_eq!(text.matches("<circle").count(), 50),
                Export::Json => assert!(text.contains("\"count\": 50"), "{text}"),
            }
        }
    }
}
