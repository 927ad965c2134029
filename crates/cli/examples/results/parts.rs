//! Figure 2: sample figures on the sphere and the parts into which they fall when unfolded.

use std::fmt::Write;

use glam::DVec2;
use ldwrap::measure::decomposition::Joints;
use ldwrap::pipeline::{Options, Run};
use ldwrap::shapes::Shape;
use ldwrap::{FaceId, HalfedgeId, Silent, SurfaceMesh};

use crate::bound::{self, Bounds};
use crate::object::{self, Way, checked};
use crate::picture::axes;
use crate::report::Report;

const COUNT: usize = 192;
const COLOURS: [&str; 8] =
    ["#ee8866", "#44bb99", "#ffaabb", "#bbcc33", "#77aadd", "#aaaa00", "#cc79a7", "#e69f00"];

/// A set of faces grown from a seed, and the part of each face once unfolded.
struct Figure {
    faces: Vec<FaceId>,
    part: Vec<usize>,
    parts: usize,
    share: f64,
}

/// The parts of a set of faces: joined across edges in the plane.
fn figure(mesh: &SurfaceMesh, joints: &Joints, faces: &[FaceId]) -> Figure {
    let mut place = vec![None; mesh.face_count()];
    for (i, face) in faces.iter().enumerate() {
        place[face.index()] = Some(i);
    }
    let mut part = vec![usize::MAX; faces.len()];
    let mut parts = 0;
    for start in 0..faces.len() {
        let mut stack = vec![start];
        let fresh = part[start] == usize::MAX;
        while let Some(i) = stack.pop() {
            if part[i] != usize::MAX {
                continue;
            }
            part[i] = parts;
            for corner in 0..3 {
                let side = HalfedgeId::of(faces[i], corner);
                if joints.is_joined(side) {
                    let beside = mesh.topology().twin(side).and_then(|twin| place[twin.face().index()]);
                    stack.extend(beside);
                }
            }
        }
        parts += usize::from(fresh);
    }
    let share = faces.iter().map(|&f| mesh.face_area(f)).sum::<f64>() / mesh.area();
    Figure { faces: faces.to_vec(), part, parts, share }
}

/// All figures of up to half the area: a seed with any number of rings.
fn figures(mesh: &SurfaceMesh, joints: &Joints) -> Vec<Figure> {
    let mut all = Vec::new();
    for seed in mesh.topology().face_ids() {
        let mut seen = vec![false; mesh.face_count()];
        seen[seed.index()] = true;
        let mut faces = vec![seed];
        let mut ring = 0..1;
        while !ring.is_empty() {
            let grown = figure(mesh, joints, &faces);
            if grown.share > 0.5 {
                break;
            }
            all.push(grown);
            let end = faces.len();
            for i in ring {
                for corner in 0..3 {
                    if let Some(twin) = mesh.topology().twin(HalfedgeId::of(faces[i], corner))
                        && !std::mem::replace(&mut seen[twin.face().index()], true)
                    {
                        faces.push(twin.face());
                    }
                }
            }
            ring = end..faces.len();
        }
    }
    all
}

/// A row: the figure on the sphere, and unfolded, each part in a colour.
fn row(svg: &mut String, mesh: &SurfaceMesh, run: &Run, name: &str, shown: &Figure, top: f64) {
    let mut colour = vec!["#e8edf3"; mesh.face_count()];
    for (face, part) in shown.faces.iter().zip(&shown.part) {
        colour[face.index()] = COLOURS[part % COLOURS.len()];
    }
    let (low, high) = mesh.bounds();
    let middle = (low + high) * 0.5;
    let centre = shown.faces.iter().map(|&f| mesh.triangle(f).iter().sum::<glam::DVec3>() / 3.0 - middle);
    let toward = centre.zip(&shown.faces).map(|(c, &f)| c * mesh.face_area(f)).sum::<glam::DVec3>();
    let [right, up, toward] = axes(toward.normalize_or(glam::DVec3::Z));
    let scale = 260.0 / (high - low).max_element();
    let mut polygon = |corners: [DVec2; 3], fill: &str| {
        let at = corners.map(|p| format!("{:.1},{:.1}", p.x, p.y)).join(" ");
        let _ = writeln!(svg, "<polygon points=\"{at}\" fill=\"{fill}\"/>");
    };
    for face in mesh.topology().face_ids() {
        if mesh.face_normal(face).dot(toward) > 0.0 {
            let flat = mesh.triangle(face).map(|p| {
                let p = (p - middle) * scale;
                DVec2::new(160.0 + p.dot(right), top + 140.0 - p.dot(up))
            });
            polygon(flat, colour[face.index()]);
        }
    }
    let size = run.strips.strips[0].extent;
    let scale = (310.0 / size.x).min(270.0 / size.y);
    if let Some(strip) = run.strips.strips.first() {
        for (i, face) in strip.faces.iter().enumerate() {
            let flat = strip
                .triangle(i)
                .map(|p| DVec2::new(330.0 + p.x * scale, top + 5.0 + (size.y - p.y) * scale));
            polygon(flat, colour[face.index()]);
        }
    }
    let _ = writeln!(
        svg,
        "<text x=\"20\" y=\"{}\" stroke=\"none\" fill=\"#1b1b1b\">{name}: {} triangles, {} {} when unfolded</text>",
        top + 292.0,
        shown.faces.len(),
        shown.parts,
        if shown.parts == 1 { "part" } else { "parts" }
    );
}

pub(crate) fn write(report: &mut Report) -> object::Outcome {
    let mesh = checked(&Shape::Sphere.generate())?;
    report.heading("Figure 2: sample figures and their unfolded parts");
    let run = object::wrapped(&mesh, Way::Walk, COUNT, 0)?;
    let joints = Joints::of(&mesh, &run.strips, 0.1 * run.d_m);
    let all = figures(&mesh, &joints);
    // Small enough to be seen whole on the sphere, and with parts as even as possible.
    let seen_whole = |parts: usize| {
        let evenness = |f: &&Figure| (0..parts).map(|p| f.part.iter().filter(|&&q| q == p).count()).min();
        all.iter().filter(|f| f.parts == parts && f.share < 0.15).max_by_key(evenness)
    };
    let most = all.iter().max_by_key(|f| f.parts);
    let chosen = [("R1", seen_whole(1)), ("R2", seen_whole(2)), ("R3", most)];
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 660 920\" width=\"660\" height=\"920\" \
         font-family=\"sans-serif\" font-size=\"15\" stroke=\"#8794a4\" stroke-width=\"0.4\">\n\
         <rect width=\"660\" height=\"920\" fill=\"white\" stroke=\"none\"/>\n",
    );
    for (k, (name, shown)) in chosen.into_iter().enumerate() {
        if let Some(shown) = shown {
            row(&mut svg, &mesh, &run, name, shown, 10.0 + 305.0 * k as f64);
        }
    }
    svg.push_str("</svg>\n");
    let picture = report.image("figure2-parts.svg", svg.as_bytes())?;
    report.say(&format!("![Three sample figures on the sphere and in the plane]({picture})"));
    let mut rows = Vec::new();
    for way in [Way::Walk, Way::Wrap] {
        for count in [192, 770, 10_000] {
            let run = object::wrapped(&mesh, way, count, 0)?;
            let mut row = vec![way.name().to_owned()];
            row.extend(bound::cells(&Bounds::of(&mesh, &Options::default(), &run, &Silent)));
            rows.push(row);
        }
    }
    let mut head = vec!["sphere, wrapped"];
    head.extend(bound::HEAD);
    report.table(&head, &rows);
    report.say("`ldwrap-cli bound sphere.obj -n 192,770,10000 --growth boundary-walk` (or without it).");
    report.say(
        "R1 and R2 fall into one and two parts, R3 is the figure of at most half the sphere that falls into most; \
         cuts narrower than 0.1 d_m at n = 192 count as joined. The paper's own figure has f_d = 39 parts \
         (convex ones; ours are counted once whatever their shape). f_d grows with n because fewer cuts stay below 0.1 d_m. \
         The figures are those of `measure`'s patches (256 random seeds, every number of rings).",
    );
    report.say(
        "**Eq. 6** is f_d times the largest |share of points - share of area| that was measured on a part of a figure. It \
         holds for any points, because the difference of a figure is the sum of those of its parts. **Eq. 7** puts the \
         discrepancy of the plane in place of the measured parts: four times the star discrepancy, which bounds boxes of any \
         place but not parts of any shape, so here it is a guide rather than a proof. Both lie far above what is measured: \
         they add the errors of all parts as if they had one sign and were as large as that of the worst. (Star \
         discrepancies of more than 20,000 points are upper bounds.)",
    );
    Ok(())
}
