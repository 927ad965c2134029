//! The work on one mesh: as `wrap` does it, with a record of it at the end.

use std::collections::BTreeMap;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

use anyhow::Context;
use ldwrap::io::ReadError;
use ldwrap::measure::{EnergyOptions, EnergyPlanes};
use ldwrap::pipeline::Options;
use ldwrap::{MeshError, Progress, Sample, SurfaceMesh, SurfacePoint};
use sha2::{Digest, Sha256};

use crate::args::{BatchArgs, BatchOutputArgs, MeshArgs};
use crate::batch::Task;
use crate::batch::record::{Ended, Kind, Made, Ratios, Record, Source, Trouble, now, number};
use crate::exit::Outcome;
use crate::input::{self, Input};
use crate::job::{self, Carried, Held};
use crate::output::Staged;
use crate::points::{self, PointFile, Taking};
use crate::progress::Stages;
use crate::weights;

/// What is to be done with every mesh.
pub(crate) struct Plan<'a> {
    args: &'a BatchArgs,
    options: Options,
    carried: Carried,
    fingerprint: String,
}

impl<'a> Plan<'a> {
    /// The arguments, checked.
    pub(crate) fn new(args: &'a BatchArgs) -> Outcome<Self> {
        let options = job::options(&args.placing)?;
        let carried = job::carried(&args.attributes.attributes, args.outputs.format)?;
        let fingerprint = fingerprint(args, &options, &carried)?;
        Ok(Self { args, options, carried, fingerprint })
    }

    /// The same for the same options, whatever the meshes, folders, jobs and threads.
    pub(crate) fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// Makes the points of one mesh. Where that cannot be done there are none afterwards, old ones neither.
    pub(crate) fn work(&self, task: &Task, temporaries: &Path) -> Record {
        let file = fs::metadata(&task.input).ok();
        let source = file.as_ref().map(Source::of);
        let stages = Stages::new(true);
        let made = task.output.clone().and_then(|output| {
            let target = self.target(&output);
            is_no_pipe(file.as_ref())
                .and_then(|()| self.make(&task.input, &target, temporaries, &stages))
                .map_err(|trouble| without_old(trouble, &target))
        });
        let seconds = stages.finish().stages().map(|(stage, seconds)| (stage.to_owned(), seconds)).collect();
        Record { source, seconds, ..self.record(task, made.map_or_else(Ended::Failed, Ended::Done)) }
    }

    /// The record of a mesh on which the work panicked.
    pub(crate) fn panicked(&self, task: &Task, words: &str) -> Record {
        let message = format!("{words}: this is a mistake in ldwrap; please report it with the mesh");
        let trouble = Trouble { kind: Kind::Panic, message };
        let trouble = match &task.output {
            Ok(output) => without_old(trouble, &self.target(output)),
            Err(_) => trouble,
        };
        self.record(task, Ended::Failed(trouble))
    }

    /// The record of something that there is no work on.
    pub(crate) fn refused(&self, task: &Task) -> Option<Record> {
        let trouble = task.output.clone().err()?;
        Some(self.record(task, Ended::Failed(trouble)))
    }

    fn target(&self, output: &str) -> PathBuf {
        self.args.outputs.output.join(output)
    }

    /// A record without what only the work can tell.
    fn record(&self, task: &Task, result: Ended) -> Record {
        Record {
            input: task.input.display().to_string(),
            output: task.output.clone().ok(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            options: self.fingerprint.clone(),
            source: None,
            result,
            seconds: BTreeMap::new(),
            at: now(),
        }
    }

    fn make(&self, path: &Path, target: &Path, temporaries: &Path, stages: &Stages) -> Result<Made, Trouble> {
        let BatchArgs { placing, reading, .. } = self.args;
        let name = path.display().to_string();
        let trouble = |kind: Kind| {
            let name = &name;
            move |error: anyhow::Error| Trouble { kind, message: message(&error, name) }
        };
        let mesh = MeshArgs { mesh: path.to_path_buf(), reading: *reading };
        let input = input::read_detail(&mesh, job::detail(placing, &self.carried), &placing.only, stages)
            .map_err(|error| trouble(kind_of(&error, path))(error))?;
        let BatchOutputArgs { format, eta, .. } = self.args.outputs;
        let in_blocks = points::in_blocks(&input, format, &self.carried);
        let held = if in_blocks && !eta { Held::Block } else { Held::All };
        let fit = |options, input: &Input| job::points_fit(options, held, input.mesh.area(), reading);
        fit(&self.options, &input).map_err(trouble(Kind::Options))?;
        let ground = weights::prepare(placing, input, self.options).map_err(trouble(Kind::Options))?;
        // Quotas have other numbers.
        fit(&ground.options, &ground.input).map_err(trouble(Kind::Options))?;
        let begin = || Staged::begin_in(temporaries, target);
        let file = PointFile::new(&ground.input, format, &self.carried, &begin);
        let mut taking = Taking::new(&ground, Some(file.map_err(trouble(Kind::Options))?), held);
        let made = ground.run_into(stages, |block| taking.take(block, stages));
        let run = made.map_err(|error| trouble(kind_of_making(&error))(error))?;
        let taken = taking.finish(stages).map_err(|error| trouble(kind_of_making(&error))(error))?;
        let input = &ground.input;
        let samples = ground.lifted(taken.samples.as_deref().unwrap_or_default());
        let eta = eta.then(|| energy_eta(&input.mesh, &samples, stages));
        stages.begin("write", 0);
        let bytes = match taken.file {
            Some(file) => put(file, target).map_err(trouble(Kind::Write))?,
            None => 0,
        };
        let topology = input.mesh.topology();
        Ok(Made {
            bytes,
            vertices: input.mesh.vertex_count(),
            triangles: input.mesh.face_count(),
            components: topology.components().count,
            area: number(input.mesh.area()),
            strips: run.strips.strips.len(),
            points: run.samples,
            d_m: number(run.d_m),
            irregularity: Ratios::of(&run.irregularity()),
            eta: eta.and_then(number),
            repairs: repairs(&input.repaired).map_err(trouble(Kind::Write))?,
        })
    }
}

/// Refuses what may never end, or never begin. A folder and what is not there have errors of their own.
fn is_no_pipe(file: Option<&Metadata>) -> Result<(), Trouble> {
    match file {
        Some(file) if !file.is_file() && !file.is_dir() => {
            let message = "is no regular file but a pipe or a device: name files of meshes".to_owned();
            Err(Trouble { kind: Kind::Read, message })
        }
        _ => Ok(()),
    }
}

fn put(file: Staged, target: &Path) -> anyhow::Result<u64> {
    if let Some(folder) = target.parent() {
        fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
    }
    file.name_safely()
}

/// What kept points from being made and written.
fn kind_of_making(error: &anyhow::Error) -> Kind {
    if error.chain().any(|cause| cause.is::<std::io::Error>()) { Kind::Write } else { Kind::Options }
}

/// The points of an earlier run go, so that nothing there contradicts the summary.
fn without_old(trouble: Trouble, target: &Path) -> Trouble {
    match fs::remove_file(target) {
        Err(error) if target.exists() => {
            let Trouble { kind, message } = trouble;
            Trouble { kind, message: format!("{message}; {} cannot be removed: {error}", target.display()) }
        }
        _ => trouble,
    }
}

/// Tells runs with different options apart. Everything that decides the bytes of an output or what the summary says of it
/// is in it, and what stands in the file of weights.
fn fingerprint(args: &BatchArgs, options: &Options, carried: &Carried) -> anyhow::Result<String> {
    let placing = &args.placing;
    let weights = placing.weights.weights.as_deref().map(|path| {
        fs::read(path).map(Sha256::digest).with_context(|| format!("{}: cannot be read", path.display()))
    });
    let weights = (weights.transpose()?, placing.weights.weights_of, &placing.weights.weights_by);
    let outputs = (args.outputs.format, carried, args.outputs.eta);
    let all = format!(
        "{:?}",
        (options, job::quota(placing), placing.inside, &args.reading, &placing.only, weights, outputs)
    );
    // 64 bits: nobody wants to make two sets of options look alike.
    const BYTES: usize = 8;
    Ok(Sha256::digest(all).iter().take(BYTES).map(|byte| format!("{byte:02x}")).collect())
}

fn kind_of(error: &anyhow::Error, path: &Path) -> Kind {
    let is_empty = || fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() == 0);
    if error.chain().any(|cause| cause.is::<MeshError>()) {
        Kind::Surface
    } else if error.chain().any(|cause| cause.is::<ReadError>()) || is_empty() {
        Kind::Format
    } else if error.chain().any(|cause| cause.is::<std::io::Error>()) {
        Kind::Read
    } else {
        Kind::Options
    }
}

/// What an error says and why, without the name of the mesh, which the record has.
fn message(error: &anyhow::Error, name: &str) -> String {
    let text = format!("{error:#}");
    text.strip_prefix(name).and_then(|rest| rest.strip_prefix(": ")).map_or(text.clone(), str::to_owned)
}

fn energy_eta(mesh: &SurfaceMesh, samples: &[Sample], progress: &dyn Progress) -> f64 {
    let points: Vec<SurfacePoint> = samples.iter().map(|sample| sample.point).collect();
    let planes = EnergyPlanes::new(mesh, points.len(), &EnergyOptions::default(), progress);
    planes.measure(mesh, &points, progress).eta
}

/// What the check changed, by the names of the report of `wrap`.
fn repairs(repaired: &ldwrap::RepairReport) -> anyhow::Result<BTreeMap<String, u64>> {
    let all: BTreeMap<String, u64> = serde_json::from_value(serde_json::to_value(repaired)?)?;
    Ok(all.into_iter().filter(|(_, count)| *count > 0).collect())
}
