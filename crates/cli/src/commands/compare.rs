//! `compare`: methods by measures.

use std::ops::RangeInclusive;
use std::path::Path;
use std::time::Instant;

use anyhow::Context;
use ldwrap::pipeline::Options;
use ldwrap::{SurfaceMesh, SurfacePoint};
use serde::Serialize;

use crate::args::{CompareArgs, PointsOf};
use crate::exit::{Failure, Outcome};
use crate::input::{self, Input};
use crate::job;
use crate::methods::Method;
use crate::output::{Destination, Outputs, Targets};
use crate::picture::{Line, Panel, error_plot};
use crate::points::{self, OffSurface};
use crate::progress::Stages;
use crate::quality::{Judge, Quality};
use crate::report::{self, MeshReport};
use crate::table::{self, MEASURES, Measure, Row, Summary};

/// One measured set of points.
#[derive(Serialize)]
struct Trial {
    method: String,
    count: usize,
    /// What the method was given; a file has none.
    seed: Option<u64>,
    /// How long the points took to make; not known of points from a file.
    seconds: Option<f64>,
    /// How far points from a file lie from the surface; others lie on it.
    off_surface: Option<OffSurface>,
    #[serde(flatten)]
    quality: Quality,
}

#[derive(Serialize)]
struct CompareReport<'a> {
    version: &'static str,
    mesh: MeshReport<'a>,
    table: &'a [Row],
    sets: &'a [Trial],
}

/// A set of points that waits to be measured.
struct Candidate {
    method: String,
    seed: Option<u64>,
    seconds: Option<f64>,
    off_surface: Option<OffSurface>,
    points: Vec<SurfacePoint>,
}

/// Runs the command.
pub(crate) fn run(args: &CompareArgs, quiet: bool) -> Outcome {
    let options = job::wrap_options(&args.segment, &args.sequence)?;
    let seeds = job::seeds(args.sequence.seed, args.seeds)?;
    check_names(args)?;
    let mut targets = Targets::default();
    let plot = args.plot.as_deref().map(|path| targets.add("--plot", path));
    targets.check(Some(&args.mesh.mesh))?;
    if plot == Some(Destination::Stdout) {
        return Err(Failure::wrong_use("--plot: stdout is for the table; name a file"));
    }
    let stages = Stages::new(quiet);
    let Input { name, mesh, repaired, .. } = input::read(&args.mesh, &stages)?;
    for note in input::notes(&repaired) {
        stages.say(&format!("note: {name}: {note}"));
    }
    let methods = methods(args, &mesh, &name)?;
    let mut candidates = from_files(args, &mesh, &stages)?;
    candidates.extend(placed(args, &methods, &seeds, &mesh, &options, &stages)?);
    let trials = measured(&mesh, candidates, &stages);
    stages.finish();
    tell_blunt_views(&trials, &stages);
    let rows = rows(&trials);
    let mut outputs = Outputs::default();
    let printed = if args.json {
        let mesh = MeshReport::new(&mesh, &repaired);
        report::json(&CompareReport {
            version: env!("CARGO_PKG_VERSION"),
            mesh,
            table: &rows,
            sets: &trials,
        })?
    } else {
        table::text(&rows).into_bytes()
    };
    outputs.stage(&Destination::Stdout, &printed)?;
    if let Some(destination) = &plot {
        outputs.stage(
            destination,
            error_plot(&format!("Root mean square errors on {}", file_name(&name)), &panels(&rows, &trials))
                .as_bytes(),
        )?;
    }
    for file in outputs.commit()? {
        stages.say(&format!("wrote {}", file.display()));
    }
    Ok(())
}

/// Every row of the table must be one set of points at one number: nothing is named twice.
fn check_names(args: &CompareArgs) -> Outcome {
    job::refuse_repeated("--count", &args.table.counts, u32::to_string)?;
    job::refuse_repeated("--methods", args.methods.as_deref().unwrap_or_default(), |m| m.name())?;
    let names: Vec<&str> = args.points.iter().map(|points| points.name.as_str()).collect();
    job::refuse_repeated("--points", &names, |name| format!("the name {name}"))?;
    match names.iter().find(|name| Method::ALL.iter().any(|method| method.name() == **name)) {
        Some(name) => Err(Failure::wrong_use(format!(
            "--points {name}=...: {name} is a method of this program: choose another name"
        ))),
        None => Ok(()),
    }
}

/// Says where the visible areas are known too roughly for what is measured.
fn tell_blunt_views(trials: &[Trial], stages: &Stages) {
    let blunt = |trial: &&Trial| !(trial.quality.view.is_sharp && trial.quality.view_occluded.is_sharp);
    if let Some(trial) = trials.iter().find(blunt) {
        stages.say(&format!(
            "note: views: for {} points of {} the error of the visible area is more than a tenth of what is measured \
             (reference_error in --json)",
            trial.count, trial.method
        ));
    }
}

/// The name without its folder.
fn file_name(name: &str) -> String {
    Path::new(name).file_name().map_or_else(|| name.to_owned(), |file| file.to_string_lossy().into_owned())
}

/// Those that were asked for; else all that work on the mesh.
fn methods(args: &CompareArgs, mesh: &SurfaceMesh, name: &str) -> Outcome<Vec<Method>> {
    let Some(asked) = &args.methods else {
        // Placing for views takes longer than all others together.
        let quick = |method: &Method| *method != Method::ForViews && method.suits(mesh);
        return Ok(Method::ALL.into_iter().filter(quick).collect());
    };
    match asked.iter().find(|method| !method.suits(mesh)) {
        Some(method) => Err(Failure::wrong_use(format!(
            "--methods {}: {name} is not a sphere: leave it out",
            method.name()
        ))),
        None => Ok(asked.clone()),
    }
}

fn from_files(args: &CompareArgs, mesh: &SurfaceMesh, stages: &Stages) -> anyhow::Result<Vec<Candidate>> {
    let read = |PointsOf { name, path }: &PointsOf| {
        let placed = points::read(mesh, path, None, stages)?;
        if let Some(note) = placed.note() {
            stages.say(&note);
        }
        Ok(Candidate {
            method: name.clone(),
            seed: None,
            seconds: None,
            off_surface: Some(placed.off_surface),
            points: placed.points,
        })
    };
    args.points.iter().map(read).collect()
}

fn placed(
    args: &CompareArgs,
    methods: &[Method],
    seeds: &RangeInclusive<u64>,
    mesh: &SurfaceMesh,
    options: &Options,
    stages: &Stages,
) -> anyhow::Result<Vec<Candidate>> {
    let mut candidates = Vec::new();
    for &count in &args.table.counts {
        for &method in methods {
            for seed in seeds.clone() {
                let method_name = method.name();
                stages.prefix(&format!("{method_name} n={count} seed {seed}: "));
                let begin = Instant::now();
                let points = method
                    .place(mesh, count as usize, seed, options, stages)
                    .with_context(|| format!("{method_name}, n = {count}, seed {seed}"))?;
                let seconds = Some(begin.elapsed().as_secs_f64());
                candidates.push(Candidate {
                    method: method_name,
                    seed: Some(seed),
                    seconds,
                    off_surface: None,
                    points,
                });
            }
        }
    }
    Ok(candidates)
}

fn measured(mesh: &SurfaceMesh, candidates: Vec<Candidate>, stages: &Stages) -> Vec<Trial> {
    let most = candidates.iter().map(|candidate| candidate.points.len()).max().unwrap_or(0);
    stages.prefix("");
    let judge = Judge::new(mesh, most, stages);
    let all = candidates.len();
    let trial = |(i, candidate): (usize, Candidate)| {
        let Candidate { method, seed, seconds, off_surface, points } = candidate;
        stages.prefix(&format!("{}/{all} {method} n={}: ", i + 1, points.len()));
        let quality = judge.quality(&points, stages);
        Trial { method, count: points.len(), seed, seconds, off_surface, quality }
    };
    let mut trials: Vec<Trial> = candidates.into_iter().enumerate().map(trial).collect();
    // Stable: methods and seeds keep their order.
    trials.sort_by_key(|trial| trial.count);
    trials
}

/// One row for each method and number of points.
fn rows(trials: &[Trial]) -> Vec<Row> {
    let same = |a: &Trial, b: &Trial| a.count == b.count && a.method == b.method;
    trials
        .chunk_by(same)
        .map(|sets| {
            let seconds: Option<Vec<f64>> = sets.iter().map(|trial| trial.seconds).collect();
            let over = |value: fn(&Quality) -> f64| {
                Summary::of(&sets.iter().map(|trial| value(&trial.quality)).collect::<Vec<f64>>())
            };
            Row {
                method: sets[0].method.clone(),
                count: sets[0].count,
                sets: sets.len(),
                seconds: seconds.map(|seconds| Summary::of(&seconds)),
                measures: MEASURES.iter().map(|measure| over(measure.value)).collect(),
            }
        })
        .collect()
}

/// A panel for each measure that has an error.
fn panels(rows: &[Row], trials: &[Trial]) -> Vec<Panel> {
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.method.as_str()) {
            names.push(&row.method);
        }
    }
    let panel = |measure: &Measure, error: fn(&Quality) -> f64| {
        let mean = |method: &str, count: usize| {
            let of = trials.iter().filter(|trial| trial.method == method && trial.count == count);
            Summary::of(&of.map(|trial| error(&trial.quality)).collect::<Vec<f64>>()).mean
        };
        let line = |&name: &&str| {
            let counts = rows.iter().filter(|row| row.method == name).map(|row| row.count);
            Line {
                name: name.to_owned(),
                points: counts.map(|count| (count as f64, mean(name, count))).collect(),
            }
        };
        // The error over its ratio to that of random points is the error of random points.
        let random =
            |trial: &Trial| (trial.count as f64, error(&trial.quality) / (measure.value)(&trial.quality));
        Panel {
            title: measure.name.replace('_', " "),
            lines: names.iter().map(line).collect(),
            anchor: trials.first().map(random),
        }
    };
    MEASURES.iter().filter_map(|measure| Some(panel(measure, measure.error?))).collect()
}
