//! `measure`: how good points are, whoever made them.

use std::fmt::Write;

use ldwrap::measure::Norms;
use serde::Serialize;

use crate::args::MeasureArgs;
use crate::commands::counted;
use crate::exit::{Failure, Outcome};
use crate::input::{self, Input};
use crate::output::write_stdout;
use crate::points::{self, OffSurface};
use crate::progress::{Seconds, Stages};
use crate::quality::{Judge, Quality};
use crate::report::{self, MeshReport};

#[derive(Serialize)]
struct MeasureReport<'a> {
    version: &'static str,
    mesh: MeshReport<'a>,
    points: PointsReport,
    #[serde(flatten)]
    quality: Quality,
    seconds: Seconds,
}

#[derive(Serialize)]
struct PointsReport {
    count: usize,
    off_surface: OffSurface,
}

/// Runs the command.
pub(crate) fn run(args: &MeasureArgs, quiet: bool) -> Outcome {
    if args.mesh.mesh.as_os_str() == "-" && args.points.as_os_str() == "-" {
        return Err(Failure::wrong_use("mesh and points cannot both come from stdin: name a file for one"));
    }
    let format = args.points_format;
    let stages = Stages::new(quiet);
    let Input { name, mesh, repaired } = input::read(&args.mesh, &stages)?;
    for note in input::notes(&repaired) {
        stages.say(&format!("note: {name}: {note}"));
    }
    let placed = points::read(&mesh, &args.points, format, &stages)?;
    if let Some(note) = placed.note() {
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
        seconds,
    };
    if args.json {
        write_stdout(&report::json(&report)?)?;
    } else {
        let heading = format!("{}: {} on {name}\n", placed.name, counted(placed.points.len(), "point"));
        write_stdout((heading + &text(&report.quality)).as_bytes())?;
    }
    Ok(())
}

/// The measures as a table for people.
fn text(quality: &Quality) -> String {
    let Quality { energy, ball, half_space, patch, view, view_occluded, integration, spacing, components } =
        quality;
    let mut text = String::new();
    let mut line = |what: &str, value: String| {
        let _ = writeln!(text, "  {what:<16} {value}");
    };
    line("", "against random points (1 is random, less is better), then the error itself".into());
    line("energy", format!("{:<8.3} eta {:.3} (1 is the best possible)", energy.mc, energy.eta));
    let norms = |n: &Norms| {
        format!("{:<8.3} mean {:.2e}, root mean square {:.2e}, largest {:.2e}", n.mc, n.l1, n.l2, n.linf)
    };
    line("balls", norms(ball));
    line("half-spaces", norms(half_space));
    line("patches", norms(patch));
    line("views", norms(view));
    line("views, occluded", norms(view_occluded));
    line("integration", format!("{:<8.3} root mean square {:.2e}", integration.mc, integration.rms));
    line(
        "spacing",
        format!(
            "smallest {:.3}, mean {:.3}, covering radius {:.3} (in distances of the hexagonal lattice)",
            spacing.min, spacing.mean, spacing.cover
        ),
    );
    line(
        "components",
        format!("{}, the worst share is off by {:.2} points", components.count, components.worst),
    );
    text
}
