//! `measure`: how good points are, whoever made them.

use std::fmt::Write;

use ldwrap::measure::{ComponentShare, Norms, components};
use serde::Serialize;

use crate::args::MeasureArgs;
use crate::commands::counted;
use crate::exit::{Failure, Outcome};
use crate::input::{self, Input};
use crate::output::write_stdout;
use crate::points::{self, OffSurface};
use crate::progress::{Seconds, Stages};
use crate::quality::{Judge, Quality, ViewQuality};
use crate::report::{self, MeshReport};

#[derive(Serialize)]
struct MeasureReport<'a> {
    version: &'static str,
    mesh: MeshReport<'a>,
    points: PointsReport,
    #[serde(flatten)]
    quality: Quality,
    /// Of each connected part of the mesh.
    component_shares: Vec<ComponentShare>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct PointsReport {
    count: usize,
    off_surface: OffSurface,
}

/// How far the ratio of a single set of random points lies from 1: standard deviations over 32 or 64 sets of 200 and of
/// 5,000 points on the built-in sphere and cup and the paper's horse (`compare --methods random --seeds 64`). They depend
/// on the measure and the mesh, hardly on the number of points.
const SCATTER: &str =
    "a single set of random points has ratios of 1 ± 0.25 (0.17 to 0.32, by measure and mesh)";

/// Runs the command.
pub(crate) fn run(args: &MeasureArgs, quiet: bool) -> Outcome {
    if args.mesh.mesh.as_os_str() == "-" && args.points.as_os_str() == "-" {
        return Err(Failure::wrong_use("mesh and points cannot both come from stdin: name a file for one"));
    }
    let format = args.points_format;
    let stages = Stages::new(quiet);
    let Input { name, mesh, repaired, .. } = input::read(&args.mesh, &stages)?;
    for note in input::notes(&repaired) {
        stages.say(&format!("note: {name}: {note}"));
    }
    let placed = points::read(&mesh, &args.points, format, &stages)?;
    // Without --json the text says it.
    if let Some(note) = placed.note().filter(|_| args.json) {
        stages.say(&note);
    }
    let judge = Judge::new(&mesh, placed.points.len(), &stages);
    let quality = judge.quality(&placed.points, &stages);
    let seconds = stages.finish();
    let report = MeasureReport {
        version: env!("CARGO_PKG_VERSION"),
        mesh: MeshReport::new(&mesh, &repaired),
        points: PointsReport { count: placed.points.len(), off_surface: placed.off_surface },
        quality,
        component_shares: components(&mesh, &placed.points).components,
        seconds,
    };
    if args.json {
        write_stdout(&report::json(&report)?)?;
    } else {
        let heading = format!("{}: {} on {name}\n", placed.name, counted(placed.points.len(), "point"));
        write_stdout((heading + &text(&report.points, &report.quality)).as_bytes())?;
    }
    Ok(())
}

/// The measures as a table for people.
fn text(points: &PointsReport, quality: &Quality) -> String {
    let q = quality;
    let mut text = String::new();
    let mut line = |what: &str, ratio: &str, more: String| {
        let _ = writeln!(text, "  {what:<16} {ratio:<8} {more}");
    };
    line("off the surface", "", points.off_surface.text(points.count));
    line("", "ratio", "the error over that of as many random points; less is better".into());
    line(
        "energy",
        &digits(q.energy.mc),
        format!(
            "eta {} (1 is the best possible), known to {:.1} %",
            digits(q.energy.eta),
            100.0 * q.energy.relative_error
        ),
    );
    let errors = |Norms { linf, l1, l2, .. }: &Norms| {
        format!("root mean square {l2:.2e}, mean {l1:.2e}, largest {linf:.2e}")
    };
    for (what, norms) in [("balls", &q.ball), ("half-spaces", &q.half_space), ("patches", &q.patch)] {
        line(what, &digits(norms.mc), errors(norms));
    }
    for (what, view) in [("views", &q.view), ("views, occluded", &q.view_occluded)] {
        line(what, &digits(view.norms.mc), errors(&view.norms) + &reference(view));
    }
    line("integration", &digits(q.integration.mc), format!("root mean square {:.2e}", q.integration.rms));
    let [min, mean, cover] = [q.spacing.min, q.spacing.mean, q.spacing.cover].map(digits);
    line(
        "spacing",
        "",
        format!("smallest {min}, mean {mean}, covering radius {cover}, in hexagonal distances"),
    );
    let worst = digits(q.components.worst);
    line("components", "", format!("{}, a share is off by {worst} points at most", q.components.count));
    line("", "", SCATTER.to_owned());
    text
}

/// How well the visible area is known, and a warning where that is not enough.
fn reference(view: &ViewQuality) -> String {
    let warning = if view.is_sharp { "" } else { ", more than a tenth of that" };
    format!("; visible area known to {:.1e}{warning}", view.reference_error)
}

/// Three digits behind the point; a dash for what does not exist, such as the spacing of one point.
fn digits(value: f64) -> String {
    if value.is_finite() { format!("{value:.3}") } else { "-".to_owned() }
}
