//! Points that stand too close to each other make way inside their cells. On sheets and rods thinner than the distance
//! of the points, cells of two sides have their centroids close together in space; points that stand a little aside
//! from them keep their distance and cost little evenness.

use glam::DVec3;

use super::layout::Layout;
use super::near::Runs;
use super::places::{Spot, spots};
use super::relax::Relaxed;
use super::sides::Sides;
use crate::parallel;

/// The distance that points keep, in distances of the points: a little more than half of the hexagonal ideal, which is
/// sqrt(2 / sqrt(3)) = 1.0746.
const KEPT: f64 = 0.57;

/// From how many places of its cell a point chooses.
const CHOICES: u32 = 48;

/// Points farther away than this many distances of the points do not come too close.
const SIGHT: f64 = 2.5;

/// At most so many times each point chooses.
const SWEEPS: usize = 12;

/// Of a shortage of distance, squared, so much counts against a way from the centroid, squared.
const WEIGHT: f64 = 30.0;

/// Moves the points of `own`, one for each site, that stand closer than half of the hexagonal ideal to another. Each
/// stays on its side.
pub(super) fn make_way(layout: &Layout, relaxed: &Relaxed, sides: Option<&Sides>, own: &mut [Option<Spot>]) {
    let mut at: Vec<DVec3> =
        relaxed.sites.iter().zip(&*own).map(|(s, o)| o.map_or(s.place.position, |o| o.place)).collect();
    let kept = |i: usize, j: usize| KEPT * relaxed.sites[i].distance.min(relaxed.sites[j].distance);
    let runs = Runs::new(&at);
    let within = |i: usize, sight: f64| {
        let mut near = Vec::new();
        runs.within(at[i], sight * relaxed.sites[i].distance, |j| j != i, &mut near);
        near
    };
    let is_crowded =
        |i: usize| within(i, KEPT).iter().any(|&j| at[i].distance(at[j as usize]) < kept(i, j as usize));
    let crowded: Vec<usize> = (0..)
        .zip(parallel::map(at.len(), is_crowded))
        .filter(|(_, crowded)| *crowded)
        .map(|(i, _)| i)
        .collect();
    if crowded.is_empty() {
        return;
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
    let spots = spots(layout, relaxed, |i| wants[i], CHOICES, 0);
    for _ in 0..SWEEPS {
        let mut changed = false;
        for i in (0..at.len()).filter(|&i| wants[i]) {
            let Some(now) = own[i] else { continue };
            let short = |place: DVec3| {
                let shortage = |&j: &u32| {
                    let short = (kept(i, j as usize) - place.distance(at[j as usize])).max(0.0);
                    short * short
                };
                seen[i].iter().map(shortage).sum::<f64>()
            };
            if short(now.place) == 0.0 {
                continue;
            }
            let cell = &relaxed.cells[i];
            let centroid = cell.moment.position / cell.mass;
            let cost = |spot: &Spot| WEIGHT * short(spot.place) + spot.place.distance_squared(centroid);
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
}
