//! `strips`: segmentation and unfolding only.

use ldwrap::Progress;
use ldwrap::domain::PlanarDomain;
use ldwrap::segment::segment;
use ldwrap::unfold::unfold;

use crate::args::StripsArgs;
use crate::commands::counted;
use crate::exit::Outcome;
use crate::input::{self, Input};
use crate::job;
use crate::output::{Outputs, Targets};
use crate::picture::strips_svg;
use crate::progress::Stages;

/// Gaps up to this share of the mesh's size are rounding: the strip is closed there.
const CLOSED: f64 = 1e-9;

/// Runs the command.
pub(crate) fn run(args: &StripsArgs, quiet: bool) -> Outcome {
    let mut targets = Targets::default();
    let destination = targets.add("--output", &args.output);
    targets.check(Some(&args.mesh.mesh))?;
    let stages = Stages::new(quiet);
    let Input { name, mesh, repaired, .. } = input::read(&args.mesh, &stages)?;
    for note in input::notes(&repaired) {
        stages.say(&format!("note: {name}: {note}"));
    }
    stages.begin("segment", 0);
    let segmentation = segment(&mesh, &job::segment_options(&args.segment));
    stages.begin("unfold", 0);
    let strips = unfold(&mesh, &segmentation);
    stages.begin("draw", 0);
    let domain = PlanarDomain::lay_out(&strips);
    let closed = CLOSED * mesh.diagonal();
    let svg = strips_svg(&strips, &domain, &[], closed);
    let mut outputs = Outputs::default();
    outputs.stage(&destination, svg.as_bytes())?;
    stages.finish();
    let files = outputs.commit()?;
    let largest = strips.strips.iter().map(|strip| strip.faces.len()).max().unwrap_or(0);
    stages.say(&format!(
        "{name}: {} in {}, the largest with {largest}; open borders {:.1} sqrt(area)",
        counted(mesh.face_count(), "triangle"),
        counted(strips.strips.len(), "strip"),
        strips.open_border_length(closed) / mesh.area().sqrt(),
    ));
    for file in files {
        stages.say(&format!("wrote {}", file.display()));
    }
    Ok(())
}
