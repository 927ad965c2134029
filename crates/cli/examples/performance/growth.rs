//! Ten times the triangles, ten times the points.

use ldwrap::pipeline::Options;
use ldwrap::segment::segment;
use ldwrap::unfold::unfold;
use ldwrap::{CheckOptions, PolygonSoup, SurfaceMesh, shapes};

use crate::table::{Row, Target};
use crate::timing::{Times, interleaved, timed};
use crate::{Bench, Outcome, all_stages};

const TENFOLD: Target = Target::AtMost(11.0);

pub(crate) fn rows(bench: &mut Bench) -> Outcome<Vec<Row>> {
    let mut rows = of_points(bench)?;
    rows.extend(of_triangles(bench)?);
    Ok(rows)
}

/// A number, as it is shown.
type Size = (u32, &'static str);

const SIZES: [Size; 3] = [(100_000, "100,000"), (1_000_000, "1,000,000"), (10_000_000, "10,000,000")];

/// Each size with the one ten times as large.
fn tenfold(bench: &Bench) -> impl Iterator<Item = [Size; 2]> + use<> {
    let most = if bench.large { 2 } else { 1 };
    SIZES.windows(2).map(|pair| [pair[0], pair[1]]).take(most)
}

fn of_points(bench: &Bench) -> Outcome<Vec<Row>> {
    let mut rows = Vec::new();
    for [(fewer, fewer_shown), (more, more_shown)] in tenfold(bench) {
        let once = |count| {
            let (made, seconds) = timed(|| all_stages(&bench.mesh, count as usize, Options::default()));
            made.map(|_| seconds)
        };
        let [more, fewer] = interleaved(bench.rounds, [&mut || once(more), &mut || once(fewer)])?;
        rows.push(Row::ratio(
            &format!("10 times the points: wrap {more_shown} on the horse, all stages"),
            &more,
            &format!("wrap {fewer_shown}"),
            &fewer,
            TENFOLD,
        ));
    }
    Ok(rows)
}

/// Scans, whose triangles are as irregular at every size.
fn of_triangles(bench: &Bench) -> Outcome<Vec<Row>> {
    let mut rows = Vec::new();
    for [(fewer, fewer_shown), (more, more_shown)] in tenfold(bench) {
        let (small, large) = (shapes::scan_like(1, fewer), shapes::scan_like(1, more));
        let stages = |soup: &PolygonSoup| -> Outcome<[f64; 2]> {
            let (made, check) = timed(|| SurfaceMesh::from_soup(soup, &CheckOptions::default()));
            let (mesh, _) = made?;
            let (_, strips) = timed(|| unfold(&mesh, &segment(&mesh, &Default::default())));
            Ok([check, strips])
        };
        let mut times: [[Vec<f64>; 2]; 2] = Default::default();
        for _ in 0..bench.rounds.min(3) {
            for (soup, times) in [&large, &small].into_iter().zip(&mut times) {
                for (seconds, times) in stages(soup)?.into_iter().zip(times) {
                    times.push(seconds);
                }
            }
        }
        let [large, small] = times.map(|stages| stages.map(Times));
        for ((stage, more), fewer) in ["check", "segment and unfold"].iter().zip(&large).zip(&small) {
            rows.push(Row::ratio(
                &format!("10 times the triangles: {stage} a scan of {more_shown}"),
                more,
                &format!("of {fewer_shown}"),
                fewer,
                TENFOLD,
            ));
        }
    }
    Ok(rows)
}
