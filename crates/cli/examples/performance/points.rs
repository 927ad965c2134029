//! A million points: against random sampling, on one core and on two, and against the speed of copying.

use std::hint::black_box;

use glam::DVec2;
use ldwrap::StripId;
use ldwrap::domain::{DomainPoints, PlanarDomain};
use ldwrap::equalize::EqualizeOptions;
use ldwrap::pipeline::{Options, Run};
use ldwrap::segment::segment;
use ldwrap::sequence::Sequence;
use ldwrap::unfold::unfold;
use ldwrap::wrap::{WrappedPoint, wrap};

use crate::table::{Row, Target};
use crate::timing::{Times, interleaved, timed};
use crate::{Bench, Outcome, all_stages};

const MILLION: usize = 1_000_000;

pub(crate) fn rows(bench: &mut Bench) -> Outcome<Vec<Row>> {
    let mut rows = against_random(bench)?;
    rows.push(against_copying(bench)?);
    rows.push(on_two_cores(bench, "wrap 1,000,000 points, all stages", Options::default(), bench.rounds)?);
    if bench.large {
        let equalize = Some(EqualizeOptions::default());
        let options = Options { equalize, ..Options::default() };
        rows.push(on_two_cores(bench, "wrap and equalize 1,000,000 points", options, 1)?);
    }
    Ok(rows)
}

fn against_random(bench: &mut Bench) -> Outcome<Vec<Row>> {
    let Some(peers) = &mut bench.peers else { return Ok(Vec::new()) };
    let mesh = &bench.mesh;
    let mut ours = || {
        let (made, seconds) = timed(|| all_stages(mesh, MILLION, Options::default()));
        made.map(|_| seconds)
    };
    let (ours, theirs) = if peers.has_point_cloud_utils() {
        let peers = std::cell::RefCell::new(peers);
        let mut uniform = || peers.borrow_mut().time("open3d-uniform", MILLION);
        let mut random = || peers.borrow_mut().time("pcu-random", MILLION);
        let [ours, uniform, random] = interleaved(bench.rounds, [&mut ours, &mut uniform, &mut random])?;
        (ours, vec![("Open3D, uniform random", uniform), ("point-cloud-utils, random", random)])
    } else {
        let mut uniform = || peers.time("open3d-uniform", MILLION);
        let [ours, uniform] = interleaved(bench.rounds, [&mut ours, &mut uniform])?;
        (ours, vec![("Open3D, uniform random", uniform)])
    };
    // The target is against the faster; the other is stated.
    let fastest = theirs.iter().map(|(_, times)| times.median()).fold(f64::INFINITY, f64::min);
    let rows = theirs.iter().map(|(name, times)| {
        let target = if times.median() == fastest { Target::AtMost(0.5) } else { Target::None };
        Row::ratio("wrap 1,000,000 points on the horse, all stages", &ours, name, times, target)
    });
    Ok(rows.collect())
}

/// One core copies memory, one core wraps: how many times as long the same bytes take.
fn against_copying(bench: &Bench) -> Outcome<Row> {
    let mesh = &bench.mesh;
    let strips = unfold(mesh, &segment(mesh, &Default::default()));
    let domain = PlanarDomain::lay_out(&strips);
    let scattered = (MILLION as f64 * domain.room(mesh.area())) as u32;
    let points = DomainPoints::scatter(&domain, &Sequence::default(), scattered, DVec2::ZERO);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let wrapped = || -> Vec<WrappedPoint> {
        let wrapping = wrap(&strips, &domain, &points);
        let mut wrapped = Vec::with_capacity(wrapping.count());
        for strip in (0..strips.strips.len()).map(StripId::new) {
            wrapping.points_of(&strips, &domain, &points, strip).for_each(|point| wrapped.push(point));
        }
        wrapped
    };
    let bytes = size_of_val(wrapped().as_slice());
    let from = vec![1_u8; bytes];
    let mut to = vec![0_u8; bytes];
    let mut copying = || Ok(timed(|| to.copy_from_slice(black_box(&from))).1);
    let mut wrapping = || Ok(timed(|| one.install(wrapped)).1);
    let [wrapping, copying] = interleaved(bench.rounds, [&mut wrapping, &mut copying])?;
    let speed = |times: &Times| format!("{:.2} GB/s", bytes as f64 / times.median() / 1e9);
    let mut row = Row::ratio(
        "scattering and wrapping alone, 1,000,000 points, strips known, one core",
        &wrapping,
        "copying as many bytes, one core",
        &copying,
        Target::AtMost(10.0),
    );
    row.ours = format!("{}, {} written", row.ours, speed(&wrapping));
    row.theirs = format!("{}, {}", row.theirs, speed(&copying));
    Ok(row)
}

fn on_two_cores(bench: &Bench, work: &str, options: Options, rounds: usize) -> Outcome<Row> {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (one, two) = (pool(1)?, pool(2)?);
    let mesh = &bench.mesh;
    let on = |pool: &rayon::ThreadPool| -> Outcome<(Run, f64)> {
        let (made, seconds) =
            timed(|| pool.install(|| all_stages(mesh, MILLION, options).map_err(|e| e.to_string())));
        Ok((made?, seconds))
    };
    let mut single = || on(&one).map(|(_, seconds)| seconds);
    let mut double = || on(&two).map(|(_, seconds)| seconds);
    let [single, double] = interleaved(rounds, [&mut single, &mut double])?;
    let same = on(&one)?.0.samples == on(&two)?.0.samples;
    if !same {
        return Err(format!("{work}: one and two threads give different bits").into());
    }
    Ok(Row {
        work: format!("{work}: the second core (same bits)"),
        ours: format!("on two {}", double.shown()),
        against: "one core".into(),
        theirs: single.shown(),
        figure: single.over(&double),
        unit: "times faster",
        target: Target::AtLeast(1.7),
    })
}
