//! `batch`: points on many meshes.

use std::fs;
use std::num::NonZero;
use std::path::Path;
use std::thread::available_parallelism;

use anyhow::{Context, anyhow};

use crate::args::BatchArgs;
use crate::batch::begun::Begun;
use crate::batch::journal::{self, Journal};
use crate::batch::names::{self, Naming};
use crate::batch::past::{Past, State};
use crate::batch::record::{Ended, Record};
use crate::batch::work::Plan;
use crate::batch::workers::Workers;
use crate::batch::{Task, inputs, summary};
use crate::exit::{Failure, Outcome};
use crate::output::write_safely;
use crate::progress::Files;

/// Runs the command with so many threads in all, or one for each core.
pub(crate) fn run(args: &BatchArgs, threads: Option<u16>, quiet: bool) -> Outcome {
    let out = &*args.outputs.output;
    let plan = Plan::new(args)?;
    let mut tasks = inputs::find(args, &Naming::new(&args.outputs)?)?;
    names::check(&tasks, out)?;
    if let Some(shard) = args.running.shard {
        let mut place = 0..;
        tasks.retain(|_| place.next().is_some_and(|place: usize| shard.has(place)));
    }
    fs::create_dir_all(out).with_context(|| format!("{}: cannot be made", out.display()))?;
    let mut journal = Journal::open(out, args.running.shard)?;
    let past = Past::new(journal::read_all(out)?);
    let mut table = Table::new(tasks, &past, args, &plan)?;
    let files = Files::new(quiet, table.open.len());
    let before = table.done();
    if !args.running.summary_only {
        let cores = available_parallelism().map_or(1, NonZero::get);
        let workers = Workers::new(args.running.jobs.map(usize::from), threads.map_or(cores, usize::from));
        table.work(&plan, workers, &mut journal, &files)?;
    }
    files.finish();
    let rows = table.tasks.iter().zip(table.records.iter().map(Option::as_ref));
    let path = out.join(summary::name(args.running.shard));
    write_safely(journal.temporaries(), &path, &summary::csv(rows)?)?;
    table.conclude(&path, before, &files)
}

/// The meshes with what became of them.
struct Table {
    tasks: Vec<Task>,
    /// A place for each task.
    records: Vec<Option<Record>>,
    /// The places of the tasks that are to be worked on.
    open: Vec<usize>,
}

impl Table {
    /// Sees what earlier runs left to do.
    fn new(tasks: Vec<Task>, past: &Past, args: &BatchArgs, plan: &Plan<'_>) -> Outcome<Self> {
        let out = &*args.outputs.output;
        let mut records = vec![None; tasks.len()];
        let mut open = Vec::new();
        for (place, task) in tasks.iter().enumerate() {
            match past.state(task, out, plan.fingerprint()) {
                State::Finished(record) => records[place] = Some(record),
                State::Foreign(_) if args.running.redo => open.push(place),
                State::Foreign(record) => return Err(foreign(&record, task, out, plan)),
                State::Open(tried) => {
                    open.push(place);
                    // A run that works tries again. Where there is nothing to work on, that is known without work.
                    let known = || tried.or_else(|| plan.refused(task));
                    records[place] = if args.running.summary_only { known() } else { None };
                }
            }
        }
        Ok(Self { tasks, records, open })
    }

    fn work(
        &mut self,
        plan: &Plan<'_>,
        workers: Workers,
        journal: &mut Journal,
        files: &Files,
    ) -> anyhow::Result<()> {
        let Self { tasks, records, open } = self;
        let temporaries = journal.temporaries().to_path_buf();
        let begun = Begun::open(&temporaries)?;
        open.sort_by_key(|&place| tasks[place].output.as_ref().is_ok_and(|output| begun.has(output)));
        workers.run(
            open,
            |&place| {
                let task = &tasks[place];
                if let Ok(output) = &task.output {
                    begun.note(output);
                }
                plan.work(task, &temporaries)
            },
            |index, done| {
                let place = open[index];
                let record = done.unwrap_or_else(|words| plan.panicked(&tasks[place], &words));
                journal.append(&record)?;
                if let Ended::Failed(trouble) = &record.result {
                    files.say(&format!("failed: {}: {}", record.input, trouble.message));
                }
                files.advance();
                records[place] = Some(record);
                Ok(())
            },
        )?;
        begun.finish();
        Ok(())
    }

    /// How many meshes have points.
    fn done(&self) -> usize {
        self.records.iter().flatten().filter(|record| record.made().is_some()).count()
    }

    /// Says how the run went; fails if any mesh did.
    fn conclude(&self, summary: &Path, before: usize, files: &Files) -> Outcome {
        let done = self.done();
        let pending = self.records.iter().filter(|record| record.is_none()).count();
        let failed = self.records.len() - done - pending;
        let all = match self.records.len() {
            1 => "1 mesh".to_owned(),
            count => format!("{count} meshes"),
        };
        files
            .say(&format!("{all}: {done} done, {before} of them before; {failed} failed, {pending} pending"));
        files.say(&format!("wrote {}", summary.display()));
        if failed + pending > 0 {
            let pending = if pending > 0 { format!(" and {pending} not done") } else { String::new() };
            return Err(anyhow!("{failed} of {all} failed{pending}: see {}", summary.display()).into());
        }
        Ok(())
    }
}

fn foreign(record: &Record, task: &Task, out: &Path, plan: &Plan<'_>) -> Failure {
    let points = out.join(record.output.as_deref().unwrap_or_default());
    let version = env!("CARGO_PKG_VERSION");
    let why = if record.version != version {
        format!("by version {}, and this is {version}", record.version)
    } else if record.options != plan.fingerprint() {
        "with other options".to_owned()
    } else {
        format!("of another mesh, {}, not of {}", record.input, task.input.display())
    };
    Failure::wrong_use(format!(
        "{} was made {why}: choose another --output, or add --redo to make such points anew",
        points.display()
    ))
}
