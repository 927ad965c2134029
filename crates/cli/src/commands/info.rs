//! `info`: what a mesh is.

use std::fmt::Write;

use ldwrap::io::MeshFormat;
use serde::Serialize;

use crate::args::InfoArgs;
use crate::exit::Outcome;
use crate::input::{self, Input};
use crate::output::write_stdout;
use crate::progress::Stages;
use crate::report::{self, MeshReport};

#[derive(Serialize)]
struct InfoReport<'a> {
    version: &'static str,
    #[serde(flatten)]
    mesh: MeshReport<'a>,
    edges: usize,
    euler_characteristic: i64,
    bounds: [[f64; 3]; 2],
    format: Option<MeshFormat>,
    unit: Option<&'static str>,
    up: Option<&'static str>,
}

/// Runs the command.
pub(crate) fn run(args: &InfoArgs, quiet: bool) -> Outcome {
    let stages = Stages::new(quiet);
    let Input { name, format, mesh, repaired, .. } = input::read(&args.mesh, &stages)?;
    stages.finish();
    let edges = mesh.topology().edge_count();
    let (low, high) = mesh.bounds();
    let report = InfoReport {
        version: env!("CARGO_PKG_VERSION"),
        mesh: MeshReport::new(&mesh, &repaired),
        edges,
        euler_characteristic: mesh.vertex_count() as i64 - edges as i64 + mesh.face_count() as i64,
        bounds: [low.to_array(), high.to_array()],
        format,
        unit: format.and_then(MeshFormat::unit),
        up: format.and_then(MeshFormat::up_axis),
    };
    if args.json {
        write_stdout(&report::json(&report)?)?;
    } else {
        write_stdout(text(&name, &report, &input::notes(&repaired)).as_bytes())?;
    }
    Ok(())
}

fn text(name: &str, report: &InfoReport<'_>, notes: &[String]) -> String {
    let InfoReport { mesh, edges, euler_characteristic, bounds: [low, high], format, unit, up, .. } = report;
    let mut text = format!("{name}\n");
    let mut line = |what: &str, value: String| {
        let _ = writeln!(text, "  {what:<12} {value}");
    };
    line("vertices", mesh.vertices.to_string());
    line("edges", edges.to_string());
    line("faces", mesh.faces.to_string());
    line("components", mesh.components.to_string());
    line(
        "border edges",
        if mesh.border_edges == 0 { "0 (closed)".into() } else { mesh.border_edges.to_string() },
    );
    line("Euler char.", euler_characteristic.to_string());
    line("area", mesh.area.to_string());
    line("from", format!("{} {} {}", low[0], low[1], low[2]));
    line("to", format!("{} {} {}", high[0], high[1], high[2]));
    line("units", units(*format, *unit, *up));
    for (i, note) in notes.iter().enumerate() {
        line(if i == 0 { "repaired" } else { "" }, note.clone());
    }
    text
}

/// What the coordinates mean, as far as the format says.
fn units(format: Option<MeshFormat>, unit: Option<&str>, up: Option<&str>) -> String {
    let what = match (format, unit, up) {
        (Some(format), Some(unit), Some(up)) => format!("{unit}s, {up} up, as {format} prescribes"),
        (Some(format), ..) => format!("{format} does not say, nor which axis is up"),
        (None, ..) => "not known, nor which axis is up".to_owned(),
    };
    format!("{what}; coordinates are left as they are")
}
