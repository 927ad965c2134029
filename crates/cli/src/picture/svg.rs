//! The strips picture: as the paper's figures 4e and 6b, but with the strips side by side instead of where they
//! lie in the planar domain.

use std::fmt::Write;

use glam::{DVec2, IVec2};
use ldwrap::domain::PlanarDomain;
use ldwrap::unfold::{Strip, Strips};
use ldwrap::{Origin, Sample};

use super::layout::{Layout, shelves};
use super::palette::{INK, MOVED, PAPER, Rgb, strip_colours};

/// Units across the strips. Coordinates are whole numbers, which keeps the file small.
const WIDTH: f64 = 20_000.0;
/// Blank around everything.
const MARGIN: f64 = 400.0;
/// Height of the head line.
const HEAD: f64 = 700.0;
/// How many units a pixel has at the picture's own size.
const PIXEL: f64 = 16.0;
/// With more triangles than this their outlines would only darken the picture and swell the file.
const OUTLINED: usize = 5_000;

/// The strips side by side as an SVG picture: each in its own colour, its open borders darker, its points as dots
/// and those that the correction moved in pink. `tolerance` is a length in units of the mesh: borders whose gap is
/// at most that wide count as closed. Triangles are outlined when there are fewer than 5,000.
pub(crate) fn strips_svg(
    strips: &Strips,
    domain: &PlanarDomain,
    samples: &[Sample],
    tolerance: f64,
) -> String {
    let extents: Vec<DVec2> = strips.strips.iter().map(|s| s.extent).collect();
    let layout = shelves(&extents, 0.015);
    let scale = if layout.size.x > 0.0 { WIDTH / layout.size.x } else { 1.0 };
    let size = IVec2::new(
        (WIDTH + 2.0 * MARGIN) as i32,
        (layout.size.y * scale + 2.0 * MARGIN + HEAD).ceil() as i32,
    );
    let triangles = strips.strips.iter().map(|s| s.faces.len()).sum::<usize>();
    let mut out = String::new();
    head(&mut out, size, strips.strips.len(), triangles, samples);

    let by_strip = samples_by_strip(samples, strips.strips.len());
    let radius = dot_radius(strips, samples.len(), scale);
    for (index, (strip, colour)) in strips.strips.iter().zip(strip_colours(strips)).enumerate() {
        let map = Map::new(strip, &layout, index, scale);
        let _ = writeln!(
            out,
            r#"<g class="strip" id="strip-{index}"><title>strip {index}: {} triangles</title>"#,
            grouped(strip.faces.len())
        );
        surface(&mut out, strip, &map, colour);
        if triangles < OUTLINED {
            outlines(&mut out, strip, &map, colour);
        }
        open_border(&mut out, strip, &map, colour, tolerance);
        let offset = domain.offsets.get(index).copied().unwrap_or_default();
        dots(&mut out, by_strip[index].iter().map(|&i| &samples[i]), &map, offset, radius);
        out.push_str("</g>\n");
    }
    out.push_str("</svg>\n");
    out
}

/// From a strip's plane to the picture.
struct Map {
    corner: DVec2,
    scale: f64,
}

impl Map {
    fn new(strip: &Strip, layout: &Layout, index: usize, scale: f64) -> Self {
        let corner =
            layout.corners[index] * scale + DVec2::new(MARGIN, MARGIN + HEAD + strip.extent.y * scale);
        Self { corner, scale }
    }

    /// The picture's y grows downwards; turned over, the strips would be mirrored.
    fn apply(&self, p: DVec2) -> IVec2 {
        (self.corner + DVec2::new(p.x, -p.y) * self.scale).round().as_ivec2()
    }

    fn vertex(&self, strip: &Strip, vertex: u32) -> IVec2 {
        self.apply(strip.vertices[vertex as usize])
    }
}

/// The start of the file with the line of counts, which is the legend too.
fn head(out: &mut String, size: IVec2, strips: usize, triangles: usize, samples: &[Sample]) {
    let moved = samples.iter().filter(|s| s.origin == Origin::Projected).count();
    let title =
        format!("{} of {}", counted(strips, "strip", "strips"), counted(triangles, "triangle", "triangles"));
    let _ = write!(
        out,
        concat!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" width="{pw}" height="{ph}">"#,
            "\n<title>{title}</title>\n",
            r#"<rect width="{w}" height="{h}" fill="{paper}"/>"#,
            "\n",
            r#"<text x="{x}" y="{y}" font-family="sans-serif" font-size="320" fill="{ink}">{title}"#,
        ),
        w = size.x,
        h = size.y,
        pw = (f64::from(size.x) / PIXEL).round(),
        ph = (f64::from(size.y) / PIXEL).round(),
        paper = PAPER,
        ink = INK,
        x = MARGIN,
        y = MARGIN + 0.4 * HEAD,
        title = title,
    );
    if !samples.is_empty() {
        let points = counted(samples.len(), "point", "points");
        let _ = write!(out, r#"<tspan dx="320">&#9679; {points}</tspan>"#);
    }
    if moved > 0 {
        let moved = grouped(moved);
        let _ = write!(
            out,
            r#"<tspan dx="320" fill="{MOVED}">&#9679;</tspan> {moved} of them moved by the correction"#
        );
    }
    let _ = writeln!(
        out,
        r#"<tspan dx="320" fill="{}" font-weight="bold">&#8212;</tspan> open border</text>"#,
        INK.mix(PAPER, 0.3)
    );
}

/// The strip without holes for overlaps. Every triangle is counterclockwise, so the border winds around a point
/// as often as triangles cover it, and filling what is wound around at all fills exactly the strip.
fn surface(out: &mut String, strip: &Strip, map: &Map, colour: Rgb) {
    let _ = write!(out, r#"<path fill="{colour}" d=""#);
    for range in &strip.loops {
        let edges = &strip.border[range.clone()];
        polyline(out, edges.iter().map(|edge| map.vertex(strip, edge.from)), true);
    }
    out.push_str("\"/>\n");
}

/// The sides of all triangles, each once.
fn outlines(out: &mut String, strip: &Strip, map: &Map, colour: Rgb) {
    let mut sides: Vec<[u32; 2]> = strip
        .corners
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    sides.sort_unstable();
    sides.dedup();
    let stroke = colour.mix(INK, 0.3);
    let _ = write!(out, r#"<path fill="none" stroke="{stroke}" stroke-width="8" d=""#);
    for side in sides {
        polyline(out, side.iter().map(|&v| map.vertex(strip, v)), false);
    }
    out.push_str("\"/>\n");
}

/// The border edges whose gap is wider than the tolerance.
fn open_border(out: &mut String, strip: &Strip, map: &Map, colour: Rgb, tolerance: f64) {
    let stroke = colour.mix(INK, 0.7);
    let _ = write!(
        out,
        r#"<path fill="none" stroke="{stroke}" stroke-width="14" stroke-linejoin="round" stroke-linecap="round" d=""#
    );
    for range in &strip.loops {
        let edges = &strip.border[range.clone()];
        for run in edges.split(|edge| !strip.is_open(edge, tolerance)).filter(|run| !run.is_empty()) {
            let ends = run.iter().map(|edge| edge.to);
            let corners = std::iter::once(run[0].from).chain(ends);
            polyline(out, corners.map(|v| map.vertex(strip, v)), false);
        }
    }
    out.push_str("\"/>\n");
}

fn dots<'a>(
    out: &mut String,
    samples: impl Iterator<Item = &'a Sample> + Clone,
    map: &Map,
    offset: DVec2,
    radius: i32,
) {
    let mut group = |moved: bool, class: &str, colour: Rgb| {
        let mut chosen = samples.clone().filter(|s| (s.origin == Origin::Projected) == moved).peekable();
        if chosen.peek().is_none() {
            return;
        }
        let _ = write!(out, r#"<g class="{class}" fill="{colour}" stroke="{PAPER}" stroke-width="6">"#);
        for sample in chosen {
            let at = map.apply(sample.place - offset);
            let _ = write!(out, r#"<circle cx="{}" cy="{}" r="{radius}"/>"#, at.x, at.y);
        }
        out.push_str("</g>\n");
    };
    group(false, "points", INK);
    // Last, so that none of them is hidden.
    group(true, "moved points", MOVED);
}

/// Adds a line through whole points to a path's data, in relative steps; steps of no length are left out.
fn polyline(out: &mut String, mut points: impl Iterator<Item = IVec2>, close: bool) {
    let Some(first) = points.next() else { return };
    let _ = write!(out, "M{} {}", first.x, first.y);
    let mut last = first;
    let mut separator = "l";
    for point in points {
        let step = point - last;
        if step == IVec2::ZERO {
            continue;
        }
        // A minus sign separates by itself.
        let before_x = if separator == " " && step.x < 0 { "" } else { separator };
        let before_y = if step.y < 0 { "" } else { " " };
        let _ = write!(out, "{before_x}{}{before_y}{}", step.x, step.y);
        separator = " ";
        last = point;
    }
    if close {
        out.push('z');
    }
}

/// The places in `samples` of each strip's samples.
fn samples_by_strip(samples: &[Sample], strips: usize) -> Vec<Vec<usize>> {
    let mut by_strip = vec![Vec::new(); strips];
    for (i, sample) in samples.iter().enumerate() {
        if let Some(list) = by_strip.get_mut(sample.strip.index()) {
            list.push(i);
        }
    }
    by_strip
}

/// A sixth of the mean distance between neighbours, but neither invisible nor a blot.
fn dot_radius(strips: &Strips, samples: usize, scale: f64) -> i32 {
    let area: f64 = strips.strips.iter().map(|s| s.area).sum();
    let d_m = (area / samples.max(1) as f64).sqrt();
    (d_m * scale / 6.0).clamp(14.0, 80.0).round() as i32
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { many })
}

/// A number with commas between thousands.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut out = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}
