//! `bound`: the paper's bounds on the discrepancy of wrapped points, next to the measured value.

use anyhow::Context;
use ldwrap::pipeline::{self, Options, Request};
use serde::Serialize;

use crate::args::BoundArgs;
use crate::bound::{Bounds, HEAD, cells};
use crate::exit::Outcome;
use crate::input::{self, Input};
use crate::job;
use crate::output::write_stdout;
use crate::progress::Stages;
use crate::report::{self, MeshReport};
use crate::table::aligned;

#[derive(Serialize)]
struct BoundReport<'a> {
    version: &'static str,
    mesh: MeshReport<'a>,
    bounds: &'a [Bounds],
}

/// Runs the command.
pub(crate) fn run(args: &BoundArgs, quiet: bool) -> Outcome {
    let options = job::wrap_options(&args.segment, &args.sequence)?;
    job::refuse_repeated("--count", &args.table.counts, u32::to_string)?;
    let stages = Stages::new(quiet);
    let Input { name, mesh, repaired, .. } = input::read(&args.mesh, &stages)?;
    for note in input::notes(&repaired) {
        stages.say(&format!("note: {name}: {note}"));
    }
    let mut bounds = Vec::new();
    for &count in &args.table.counts {
        stages.prefix(&format!("n={count}: "));
        let options = Options { request: Request::Count(count as usize), ..options };
        let run = pipeline::run(&mesh, &options, &stages).with_context(|| format!("{name}, n = {count}"))?;
        bounds.push(Bounds::of(&mesh, &options, &run, &stages));
    }
    stages.finish();
    let printed = if args.json {
        let mesh = MeshReport::new(&mesh, &repaired);
        report::json(&BoundReport { version: env!("CARGO_PKG_VERSION"), mesh, bounds: &bounds })?
    } else {
        let head = HEAD.map(str::to_owned).to_vec();
        let lines: Vec<Vec<String>> = std::iter::once(head).chain(bounds.iter().map(cells)).collect();
        aligned(&lines, None).into_bytes()
    };
    Ok(write_stdout(&printed)?)
}
