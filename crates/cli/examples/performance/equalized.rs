//! Equalized points against Poisson disk samples.

use ldwrap::equalize::EqualizeOptions;
use ldwrap::pipeline::Options;

use crate::table::{Row, Target};
use crate::timing::{Times, interleaved, timed};
use crate::{Bench, Outcome, all_stages};

/// How many rounds of works that take seconds.
const FEW: usize = 3;

pub(crate) fn rows(bench: &mut Bench) -> Outcome<Vec<Row>> {
    let Some(peers) = &mut bench.peers else { return Ok(Vec::new()) };
    let mesh = &bench.mesh;
    let options = Options { equalize: Some(EqualizeOptions::default()), ..Options::default() };
    let mut rows = Vec::new();
    let mut times: Vec<Times> = Vec::new();
    for (count, shown, target) in [
        (335, "335", Target::None),
        (1_000, "1,000", Target::None),
        (10_000, "10,000", Target::AtMost(1.0)),
        (100_000, "100,000", Target::AtMost(0.4)),
    ] {
        let mut ours = || {
            let (made, seconds) = timed(|| all_stages(mesh, count, options));
            made.map(|_| seconds)
        };
        let mut theirs = || peers.time("open3d-poisson", count);
        let rounds = if count > 10_000 { bench.rounds.min(FEW) } else { bench.rounds };
        let [ours, theirs] = interleaved(rounds, [&mut ours, &mut theirs])?;
        rows.push(Row::ratio(
            &format!("equalize {shown} points on the horse, all stages"),
            &ours,
            &format!("Open3D, Poisson disk, {shown}"),
            &theirs,
            target,
        ));
        times.push(ours);
    }
    if let [.., fewer, more] = &times[..] {
        rows.push(Row::ratio(
            "10 times the points: equalize 100,000",
            more,
            "equalize 10,000",
            fewer,
            Target::AtMost(11.0),
        ));
    }
    Ok(rows)
}
