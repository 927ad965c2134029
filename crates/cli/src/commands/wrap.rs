//! `wrap`: points on a mesh.

use anyhow::Context;
use ldwrap::pipeline::{self, Options, Run};
use ldwrap::{Progress, SurfaceMesh};

use crate::args::WrapArgs;
use crate::exit::Outcome;
use crate::input::{self, Input};
use crate::job::{self, WrapOutputs};
use crate::output::Outputs;
use crate::picture::{PreviewOptions, preview_png, strips_svg};
use crate::points;
use crate::progress::Stages;
use crate::report::{self, MeshReport, Report};

/// Runs the command.
pub(crate) fn run(args: &WrapArgs, quiet: bool) -> Outcome {
    let options = job::options(args)?;
    let outputs = WrapOutputs::new(&args.outputs, &args.mesh.mesh)?;
    let stages = Stages::new(quiet);
    let input = input::read(&args.mesh, &stages)?;
    for note in input::notes(&input.repaired) {
        stages.say(&format!("note: {}: {note}", input.name));
    }
    let run = pipeline::run(&input.mesh, &options, &stages).with_context(|| input.name.clone())?;
    let files = write(&input, &options, &run, &outputs, &stages)?;
    for line in summary(&input, &run) {
        stages.say(&line);
    }
    for file in files {
        stages.say(&format!("wrote {}", file.display()));
    }
    Ok(())
}

fn write(
    input: &Input,
    options: &Options,
    run: &Run,
    wanted: &WrapOutputs,
    stages: &Stages,
) -> anyhow::Result<Vec<std::path::PathBuf>> {
    let Input { mesh, repaired, .. } = input;
    let mut outputs = Outputs::default();
    if wanted.strips.is_some() || wanted.preview.is_some() {
        stages.begin("draw", 0);
    }
    if let Some(destination) = &wanted.strips {
        let svg = strips_svg(&run.strips, &run.domain, &run.samples, options.tolerance * run.d_m);
        outputs.stage(destination, svg.into_bytes())?;
    }
    if let Some(destination) = &wanted.preview {
        outputs.stage(destination, preview_png(mesh, &run.strips, &run.samples, &PreviewOptions::default()))?;
    }
    if let Some(wanted) = &wanted.points {
        stages.begin("write", 0);
        outputs.stage(&wanted.destination, points::bytes(mesh, &run.samples, wanted.format)?)?;
    }
    let seconds = stages.finish();
    if let Some(destination) = &wanted.report {
        let report = Report::new(MeshReport::new(mesh, repaired), options, run, seconds);
        outputs.stage(destination, report::json(&report)?)?;
    }
    outputs.commit()
}

fn summary(input: &Input, run: &Run) -> Vec<String> {
    let Input { name, mesh, .. } = input;
    let R { bound, refined, exact } = run.irregularity;
    let mut lines = vec![
        format!("{name}: {} triangles, area {}", mesh.face_count(), rounded(mesh.area())),
    ];
    lines
}
