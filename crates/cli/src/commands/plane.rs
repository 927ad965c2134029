//! `plane`: how even point sets are in the unit square, before they meet any surface.

use glam::DVec2;
use ldwrap::baseline::{square_lattice, square_random};
use ldwrap::measure::plane::{SquareDiscrepancy, StarDiscrepancy, square_discrepancy, star_discrepancy};
use ldwrap::sequence::{shift, shift_of_seed};
use serde::Serialize;

use crate::args::{PlanarSet, PlaneArgs, SequenceArgs};
use crate::exit::{Failure, Outcome};
use crate::job;
use crate::output::write_stdout;
use crate::report;
use crate::table::{Summary, aligned, cell};

#[derive(Serialize)]
struct PlaneReport {
    version: &'static str,
    sets: Vec<PlaneSet>,
}

/// One measured set.
#[derive(Serialize)]
struct PlaneSet {
    sequence: PlanarSet,
    count: u32,
    seed: u64,
    star: StarDiscrepancy,
    l2: SquareDiscrepancy,
}

/// Runs the command.
pub(crate) fn run(args: &PlaneArgs) -> Outcome {
    let asked = args.sequences.is_some();
    let wanted = args.sequences.clone().unwrap_or_else(|| PlanarSet::ALL.to_vec());
    job::refuse_repeated("--count", &args.counts, u32::to_string)?;
    job::refuse_repeated("--sequence", &wanted, |set| set.name())?;
    let seeds = job::seeds(args.seed, args.seeds)?;
    let mut sets = Vec::new();
    for &count in &args.counts {
        for &sequence in &wanted {
            for seed in seeds.clone() {
                match points(sequence, count, seed, args) {
                    Ok(places) => sets.push(PlaneSet {
                        sequence,
                        count,
                        seed,
                        star: star_discrepancy(&places),
                        l2: square_discrepancy(&places),
                    }),
                    // What was not asked for by name is left out where there is no such set.
                    Err(failure) if asked => return Err(failure),
                    Err(_) => {}
                }
            }
        }
    }
    let printed = if args.json {
        report::json(&PlaneReport { version: env!("CARGO_PKG_VERSION"), sets })?
    } else {
        text(&sets).into_bytes()
    };
    Ok(write_stdout(&printed)?)
}

/// The points of a set in [0, 1)^2.
fn points(set: PlanarSet, count: u32, seed: u64, args: &PlaneArgs) -> Outcome<Vec<DVec2>> {
    let sequence = match (set.sequence(), &args.bases) {
        (None, Some(_)) => return Err(Failure::wrong_use("--bases: only hammersley and halton have bases")),
        (sequence, _) => sequence,
    };
    let Some(sequence) = sequence else {
        return match set {
            PlanarSet::Random => Ok(square_random(count as usize, seed)),
            _ => lattice(count),
        };
    };
    let asked = SequenceArgs { sequence, bases: args.bases.clone(), seed, tolerance: 0.0 };
    let (sequence, seed) = job::sequence(&asked)?;
    let moved = shift_of_seed(seed);
    Ok((0..u64::from(count)).map(|i| shift(sequence.point(i, u64::from(count)), moved)).collect())
}

fn lattice(count: u32) -> Outcome<Vec<DVec2>> {
    let side = count.isqrt();
    if side * side == count {
        Ok(square_lattice(side))
    } else {
        let (below, above) = (side * side, u64::from(side + 1) * u64::from(side + 1));
        Err(Failure::wrong_use(format!(
            "--sequence lattice: {count} is not a square number: take {below} or {above}"
        )))
    }
}

/// One row for each set at each number of points: means over the seeds, with their spread.
fn text(sets: &[PlaneSet]) -> String {
    let head = ["n", "sequence", "star", "L2 star", "L2 average", "L2 star / random", "L2 average / random"];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    for seeds in sets.chunk_by(|a, b| a.count == b.count && a.sequence == b.sequence) {
        let over = |value: fn(&PlaneSet) -> f64| {
            let Summary { mean, spread } = Summary::of(&seeds.iter().map(value).collect::<Vec<f64>>());
            let spread = spread.map_or_else(String::new, |spread| format!(" ±{spread:.4}"));
            format!("{mean:.4}{spread}")
        };
        let ratio =
            |value: fn(&PlaneSet) -> f64| cell(Summary::of(&seeds.iter().map(value).collect::<Vec<f64>>()));
        let exact = seeds.iter().all(|set| set.star.is_exact());
        lines.push(vec![
            seeds[0].count.to_string(),
            seeds[0].sequence.name(),
            (if exact { String::new() } else { "at most ".to_owned() }) + &over(|set| set.star.upper),
            over(|set| set.l2.star),
            over(|set| set.l2.average),
            ratio(|set| set.l2.star / set.l2.random),
            ratio(|set| set.l2.average / set.l2.random),
        ]);
    }
    aligned(&lines, Some(1))
}
