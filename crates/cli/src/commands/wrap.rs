//! `wrap`: points on a mesh.

use std::path::PathBuf;

use anyhow::anyhow;
use ldwrap::correct::Correction;
use ldwrap::irregularity::Irregularity;
use ldwrap::pipeline::Streamed;
use ldwrap::{Progress, SurfacePoint};

use crate::args::WrapArgs;
use crate::commands::counted;
use crate::exit::Outcome;
use crate::input::{self, Input};
use crate::job::{self, Carried, WrapOutputs};
use crate::output::{Outputs, Staged};
use crate::picture::{PreviewOptions, preview_png, strips_svg};
use crate::points::{PointFile, Taken, Taking};
use crate::progress::Stages;
use crate::quality::Judge;
use crate::report::{self, MeshReport, Report};
use crate::stop;
use crate::weights::{self, Ground};

/// Runs the command.
pub(crate) fn run(args: &WrapArgs, quiet: bool) -> Outcome {
    let WrapArgs { mesh, placing, outputs } = args;
    let mut options = job::options(placing)?;
    let outputs = WrapOutputs::new(outputs, &mesh.mesh)?;
    // What takes time is computed only where somebody reads it.
    let is_read = !quiet || outputs.report.is_some();
    if let Some(equalize) = &mut options.equalize {
        equalize.spread_before = is_read;
    }
    let stages = Stages::new(quiet);
    let carried = outputs.points.as_ref().map_or(&Carried::Usual, |points| &points.carried);
    let input = input::read_detail(mesh, job::detail(placing, carried), &placing.only, &stages)?;
    for note in input::notes(&input.repaired) {
        stages.say(&format!("note: {}: {note}", input.name));
    }
    let held = outputs.held(&input);
    job::points_fit(&options, held, input.mesh.area(), &args.mesh.reading)?;
    let ground = weights::prepare(placing, input, options)?;
    // Quotas have other numbers.
    job::points_fit(&ground.options, held, ground.input.mesh.area(), &args.mesh.reading)?;
    stop::listen();
    let begin = || match &outputs.points {
        Some(points) => Staged::begin(&points.destination),
        None => Err(anyhow!("no file of points is wanted")),
    };
    let file = outputs.points.as_ref();
    let file = file.map(|points| PointFile::new(&ground.input, points.format, &points.carried, &begin));
    let mut taking = Taking::new(&ground, file.transpose()?, held);
    let run = ground.run_into(&stages, |block| taking.take(block, &stages))?;
    let taken = taking.finish(&stages)?;
    let irregularity = is_read.then(|| {
        stages.begin("irregularity", 0);
        run.irregularity()
    });
    let job = Job { ground: &ground, run: &run, irregularity };
    let files = write(job, taken, &outputs, &stages)?;
    if let Some(irregularity) = irregularity {
        for line in summary(job, irregularity) {
            stages.say(&line);
        }
    }
    for file in files {
        stages.say(&format!("wrote {}", file.display()));
    }
    Ok(())
}

/// What was done.
#[derive(Clone, Copy)]
struct Job<'a> {
    ground: &'a Ground,
    run: &'a Streamed,
    /// Where it is wanted.
    irregularity: Option<Irregularity>,
}

fn write(job: Job<'_>, taken: Taken, wanted: &WrapOutputs, stages: &Stages) -> anyhow::Result<Vec<PathBuf>> {
    let Job { ground, run, irregularity } = job;
    let Ground { input, density, options, .. } = ground;
    let Input { mesh, repaired, .. } = input;
    let samples = taken.samples.unwrap_or_default();
    let mut outputs = Outputs::default();
    if let Some(points) = taken.file {
        outputs.add(points)?;
    }
    if wanted.strips.is_some() || wanted.preview.is_some() {
        stages.begin("draw", 0);
    }
    if let Some(destination) = &wanted.strips {
        let svg = strips_svg(&run.strips, &run.domain, &samples, run.tolerance);
        outputs.stage(destination, svg.as_bytes())?;
    }
    if let Some(destination) = &wanted.preview {
        let preview = preview_png(ground.mesh(), &run.strips, &samples, &PreviewOptions::default());
        outputs.stage(destination, &preview)?;
    }
    let quality = wanted.quality.then(|| {
        let points: Vec<SurfacePoint> = ground.lifted(&samples).iter().map(|sample| sample.point).collect();
        Judge::new(mesh, points.len(), stages).quality(&points, stages)
    });
    let seconds = stages.finish();
    if let (Some(destination), Some(irregularity)) = (&wanted.report, irregularity) {
        let report = Report::new(
            MeshReport::new(mesh, repaired),
            options,
            density,
            run,
            irregularity,
            quality,
            seconds,
        );
        outputs.stage(destination, &report::json(&report)?)?;
    }
    outputs.commit()
}

fn summary(job: Job<'_>, irregularity: Irregularity) -> Vec<String> {
    let Job { ground: Ground { input: Input { name, mesh, .. }, .. }, run, .. } = job;
    let Irregularity { bound, refined, exact, undecided } = irregularity;
    let Correction { projected, removed } = run.correction;
    let count = run.samples;
    let mut lines = vec![
        format!(
            "{name}: {} on {} in {}, mean distance {:.4e}",
            counted(count, "point"),
            counted(mesh.face_count(), "triangle"),
            counted(run.strips.strips.len(), "strip"),
            run.d_m
        ),
        if undecided > 1e-3 {
            format!(
                "irregularity R {bound:.3} by eq. 8, {refined:.3} refined, {exact:.3} +- {:.3} exact",
                0.5 * undecided
            )
        } else {
            format!("irregularity R {bound:.3} by eq. 8, {refined:.3} refined, {exact:.3} exact")
        },
        format!("open border {:.2} sqrt(area)", report::open_border(mesh.area(), run)),
        format!("corrected: {projected} projected, {removed} removed"),
    ];
    if let Some(equalize) = &run.equalize {
        let before = equalize.spread_before.map_or(String::new(), |spread| format!("{spread:.3} before, "));
        lines.push(format!(
            "equalized: spread of areas {before}{:.3} after; moved {:.3} mean distances",
            equalize.spread_after, equalize.moved
        ));
    }
    lines
}
