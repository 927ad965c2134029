//! Points that stand too close to each other make way inside their cells. On sheets and rods thinner than the distance
//! of the points, cells of two sides have their centroids close together in space; points that stand a little aside
//! from them keep their distance and cost little evenness.

use glam::DVec3;

use super::holdings::Holding;
use super::near::Runs;
use super::places::{Spot, spots};
use super::settle::Cells;
use crate::parallel;

/// The distance that points keep, in distances of the points: a little more than half of the hexagonal ideal.
const KEPT: f64 = 0.57;

/// Half of the hexagonal ideal: sqrt(2 / sqrt(3)) / 2.
const HALF: f64 = 0.537_284_965_911_770_9;

/// Points farther away than this many distances of the points do not come too close.
const SIGHT: f64 = 2.5;

/// At most so many times each point chooses.
const SWEEPS: usize = 12;

/// What is tried until no point stands too close to another.
struct Attempt {
    /// Points closer than this, in distances of the points, start it.
    least: f64,
    /// From how many places of its cell a point chooses.
    choices: u32,
    /// Of a shortage of distance, squared, so much counts against a way from home, squared.
    weight: f64,
}

const ATTEMPTS: [Attempt; 3] = [
    Attempt { least: KEPT, choices: 48, weight: 30.0 },
    Attempt { least: HALF, choices: 128, weight: 100.0 },
    Attempt { least: HALF, choices: 256, weight: 300.0 },
];

/// Moves the points of `own`, one for each site, that stand closer than half of the hexagonal ideal to another. Each
/// stays on its side.
pub(super) fn make_way(cells: &Cells<'_>, own: &mut [Option<Spot>]) {
    let widths = parallel::map(own.len(), |site| width(cells, site));
    for (seed, attempt) in (0..).zip(&ATTEMPTS) {
        if !move_aside(cells, &widths, own, attempt, seed) {
            break;
        }
    }
}

/// The root of a cell's area: the distance of the points, were all cells alike.
fn width(cells: &Cells<'_>, site: usize) -> f64 {
    let Cells { layout, relaxed, .. } = cells;
    let area = |holding: &Holding| {
        let tile = &layout.tiles[holding.tile as usize];
        holding.mass / tile.mass * layout.area(tile)
    };
    let area: f64 = relaxed.holdings.of(site).iter().filter(|holding| holding.mass > 0.0).map(area).sum();
    libm::sqrt(area)
}

/// Whether any point stood too close.
fn move_aside(
    cells: &Cells<'_>,
    widths: &[f64],
    own: &mut [Option<Spot>],
    attempt: &Attempt,
    seed: u64,
) -> bool {
    let Cells { layout, relaxed, sides, ref homes } = *cells;
    let mut at: Vec<DVec3> =
        relaxed.sites.iter().zip(&*own).map(|(s, o)| o.map_or(s.place.position, |o| o.place)).collect();
    let between = |i: usize, j: usize| (widths[i] + widths[j]) * 0.5;
    let runs = Runs::new(&at);
    let within = |i: usize, sight: f64| {
        let mut near = Vec::new();
        runs.within(at[i], sight * widths[i], |j| j != i, &mut near);
        near
    };
    let is_crowded = |i: usize| {
        let too_close = |&j: &u32| at[i].distance(at[j as usize]) < attempt.least * between(i, j as usize);
        within(i, attempt.least).iter().any(too_close)
    };
    let crowded: Vec<usize> = (0..)
        .zip(parallel::map(at.len(), is_crowded))
        .filter(|(_, crowded)| *crowded)
        .map(|(i, _)| i)
        .collect();
    if crowded.is_empty() {
        return false;
    }
    let mut wants = vec![false; at.len()];
    for &i in &crowded {
        wants[i] = true;
        for j in within(i, SIGHT) {
            wants[j as usize] = true;
        }
    }
    let seen: Vec<Vec<u32>> =
        parallel::map(at.len(), |i| if wants[i] { within(i, SIGHT) } else { Vec::new() });
    let spots = spots(layout, relaxed, |i| wants[i], attempt.choices, seed);
    for _ in 0..SWEEPS {
        let mut changed = false;
        for i in (0..at.len()).filter(|&i| wants[i]) {
            let Some(now) = own[i] else { continue };
            let short = |place: DVec3| {
                let shortage = |&j: &u32| {
                    let short = (KEPT * between(i, j as usize) - place.distance(at[j as usize])).max(0.0);
                    short * short
                };
                seen[i].iter().map(shortage).sum::<f64>()
            };
            if short(now.place) == 0.0 {
                continue;
            }
            let cost =
                |spot: &Spot| attempt.weight * short(spot.place) + spot.place.distance_squared(homes[i]);
            let mut best = (cost(&now), now);
            let stays = |spot: &&Spot| sides.is_none_or(|sides| sides.of(spot.face) == sides.of(now.face));
            for spot in spots[i].iter().filter(stays) {
                let cost = cost(spot);
                if cost < best.0 {
                    best = (cost, *spot);
                    changed = true;
                }
            }
            own[i] = Some(best.1);
            at[i] = best.1.place;
        }
        if !changed {
            break;
        }
    }
    true
}
