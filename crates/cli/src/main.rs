//! The program `ldwrap-cli`: meshes in, points, pictures and reports out.

mod args;
mod batch;
mod bound;
mod commands;
mod exit;
mod input;
mod job;
mod memory;
mod methods;
mod output;
mod picture;
mod points;
mod progress;
mod quality;
mod report;
mod stop;
mod table;
mod weights;

use std::process::ExitCode;

use anyhow::Context;
use clap::Parser;

use crate::args::{Command, CommandLine};
use crate::exit::Outcome;

fn main() -> ExitCode {
    match run(&CommandLine::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.tell(),
    }
}

fn run(line: &CommandLine) -> Outcome {
    if let Some(threads) = line.threads {
        limit_threads(threads)?;
    }
    match &line.command {
        Command::Wrap(args) => commands::wrap::run(args, line.quiet),
        Command::Batch(args) => commands::batch::run(args, line.threads, line.quiet),
        Command::Strips(args) => commands::strips::run(args, line.quiet),
        Command::Info(args) => commands::info::run(args, line.quiet),
        Command::Shape(args) => commands::shape::run(args, line.quiet),
        Command::Measure(args) => commands::measure::run(args, line.quiet),
        Command::Compare(args) => commands::compare::run(args, line.quiet),
        Command::Plane(args) => commands::plane::run(args),
        Command::Bound(args) => commands::bound::run(args, line.quiet),
        Command::View(args) => commands::view::run(args, line.quiet),
        Command::Completions { shell } => commands::help::completions(*shell),
        Command::Man { command } => commands::help::man(command.as_deref()),
    }
}

fn limit_threads(threads: u16) -> anyhow::Result<()> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build_global()
        .with_context(|| format!("--threads {threads}"))
}
