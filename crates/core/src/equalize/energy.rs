//! Few points stand where all of them together have the least energy discrepancy, instead of at the centroids of their cells.
//!
//! Its square is, but for a constant, the sum over all points of how much farther the surface is from them in the mean than the
//! points are (`measure/energy.rs`). A cell and its point have the same mass, so together they are felt nearby only. Centroids
//! know the own cell alone; this knows also what stands behind a thin part and beside a crease, which is much of what few
//! points have around them.

use std::array;
use std::ops::RangeInclusive;

use glam::{DMat3, DVec3};

use super::layout::{Ground, Layout};
use super::owners;
use super::places::{Spot, spots};
use super::relax::Relaxed;
use super::settle::nearest;
use super::sides::Sides;
use crate::parallel;

/// For how many points. One or two stand best at the centroids. More than the most have cells so small that centroids are
/// nearly as good, and too many pairs.
const FEW: RangeInclusive<usize> = 3..=1_000;

/// So many times each point moves.
const SWEEPS: usize = 4;

/// How far against the slope, in distances of the points.
const STEP: f64 = 0.5;

/// At most so many distances of the points at a time.
const FARTHEST: f64 = 0.3;

/// So many places stand for a cell that is seen from nearby.
const SAMPLES: usize = 32;

/// Draws them.
const SEED: u64 = 99;

/// The middles of so many tiles can stand for a cell, though those at its border belong to it in part only.
const MANY: usize = 2 * SAMPLES;

/// At most so many tiles are laid side by side: 40 MB.
const TOGETHER: usize = 500_000;

/// Farther away than this many times its own width a cell is seen as its mean and its covariance.
const NEARBY: f64 = 6.0;

/// A place that stands for a cell is as wide as this share of the cell.
const GRAIN: f64 = 0.25;

/// A cell with the point that stands in it, as seen from far away.
struct Cell {
    centroid: DVec3,
    covariance: DMat3,
    /// The mean square of the distance from the centroid.
    square: f64,
    point: DVec3,
}

/// Places that stand for a cell, evenly.
type Samples = [DVec3; SAMPLES];

/// Where each point is at home: at the centroid of its cell, or where it went if there are few. Those go each to another
/// place of its cell on its side. O(n^2 + tiles) for few, else O(n).
pub(super) fn homes(
    layout: &Layout,
    relaxed: &Relaxed,
    sides: Option<&Sides>,
    own: &mut [Option<Spot>],
) -> Vec<DVec3> {
    let mut homes: Vec<DVec3> = relaxed.cells.iter().map(owners::Cell::centroid).collect();
    if !FEW.contains(&own.len()) {
        return homes;
    }
    // Sites without a place have no cell.
    let standing: Vec<(usize, Spot)> =
        own.iter().enumerate().filter_map(|(site, spot)| Some((site, (*spot)?))).collect();
    let samples = samples(layout, relaxed, &standing);
    let mut cells: Vec<Cell> = standing
        .iter()
        .zip(&samples)
        .map(|((site, spot), samples)| Cell::new(homes[*site], samples, spot.place))
        .collect();
    let grounds = |i: usize| {
        let (site, spot) = &standing[i];
        let tiles = relaxed.holdings.of(*site).iter().map(|holding| layout.ground(holding.tile as usize));
        tiles.filter(|ground| sides.is_none_or(|s| s.of(ground.face) == s.of(spot.face)))
    };
    // Where each may stand, together, because it is looked at again and again; unless that takes too much memory.
    let together = (layout.tiles.len() <= TOGETHER)
        .then(|| parallel::map(standing.len(), |i| grounds(i).collect::<Vec<Ground>>()));
    // One after the other: all at once would each mend the same long waves.
    for _ in 0..SWEEPS {
        for (i, (site, _)) in standing.iter().enumerate() {
            let distance = relaxed.sites[*site].distance;
            let by = slope(&cells, &samples, i) * (STEP * distance);
            let wanted = cells[i].point - by.clamp_length_max(FARTHEST * distance);
            let spot = match &together {
                Some(together) => nearest(together[i].iter().copied(), wanted),
                None => nearest(grounds(i), wanted),
            };
            if let Some(spot) = spot {
                own[*site] = Some(spot);
                cells[i].point = spot.place;
            }
        }
    }
    for (cell, (site, _)) in cells.iter().zip(standing) {
        homes[site] = cell.point;
    }
    homes
}

/// The slope of the energy where the point of a cell stands: of its mean distance to all cells, less that to all points.
fn slope(cells: &[Cell], samples: &[Samples], own: usize) -> DVec3 {
    let from = cells[own].point;
    let mut slope = DVec3::ZERO;
    for (i, cell) in cells.iter().enumerate() {
        let away = from - cell.centroid;
        let square = away.length_squared();
        slope += if square > NEARBY * NEARBY * cell.square {
            cell.slope(away, square)
        } else {
            slope_nearby(&samples[i], from, GRAIN * GRAIN * cell.square)
        };
        if i != own {
            slope -= (from - cell.point).normalize_or_zero();
        }
    }
    slope
}

/// The slope of the mean distance to places that are as wide as the root of `grain`.
fn slope_nearby(samples: &Samples, from: DVec3, grain: f64) -> DVec3 {
    let direction = |sample: &DVec3| {
        let away = from - *sample;
        away / (away.length_squared() + grain).sqrt().max(f64::MIN_POSITIVE)
    };
    samples.iter().map(direction).sum::<DVec3>() / SAMPLES as f64
}

impl Cell {
    fn new(centroid: DVec3, samples: &Samples, point: DVec3) -> Self {
        let mut covariance = DMat3::ZERO;
        for sample in samples {
            let away = sample - centroid;
            covariance += DMat3::from_cols(away * away.x, away * away.y, away * away.z);
        }
        covariance *= 1.0 / SAMPLES as f64;
        let square = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
        Self { centroid, covariance, square, point }
    }

    /// The slope of the mean distance to the cell at a place farther away than nearby.
    fn slope(&self, away: DVec3, square: f64) -> DVec3 {
        // To second order the mean distance is r + (tr C - u.Cu) / (2 r), with u the direction and C the covariance.
        let direction = away / square.sqrt();
        let turned = self.covariance * direction;
        direction + ((3.0 * turned.dot(direction) - self.square) * direction - 2.0 * turned) / (2.0 * square)
    }
}

/// Places that stand for each cell.
fn samples(layout: &Layout, relaxed: &Relaxed, standing: &[(usize, Spot)]) -> Vec<Samples> {
    let mut few = vec![false; relaxed.sites.len()];
    for (site, _) in standing {
        few[*site] = relaxed.holdings.of(*site).len() < MANY;
    }
    let spots = spots(layout, relaxed, |site| few[site], SAMPLES as u32, SEED);
    parallel::map(standing.len(), |i| {
        let (site, now) = &standing[i];
        let spots = &spots[*site];
        let mut samples = match spots.last() {
            // Rounding can leave one too few.
            Some(last) => array::from_fn(|k| spots.get(k).unwrap_or(last).place),
            None => middles(layout, relaxed, *site, now.place),
        };
        // Places are random and tiles at the border in part outside; the centroid is neither.
        let off = relaxed.cells[*site].centroid() - samples.iter().sum::<DVec3>() / SAMPLES as f64;
        samples.iter_mut().for_each(|sample| *sample += off);
        samples
    })
}

/// The middles of tiles of a cell, evenly by mass.
fn middles(layout: &Layout, relaxed: &Relaxed, site: usize, start: DVec3) -> Samples {
    let holdings = relaxed.holdings.of(site);
    let each = holdings.iter().map(|holding| holding.mass).sum::<f64>() / SAMPLES as f64;
    let (mut rest, mut passed, mut middle) = (holdings.iter(), 0.0, start);
    array::from_fn(|k| {
        while passed <= (k as f64 + 0.5) * each {
            let Some(holding) = rest.next() else { break };
            passed += holding.mass;
            middle = layout.corners(&layout.tiles[holding.tile as usize]).iter().sum::<DVec3>() / 3.0;
        }
        middle
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From farther away than nearby the slope is that of the mean distance, by differences, to third order.
    #[test]
    fn from_far_away_mean_and_covariance_tell_the_slope() {
        let ring: Samples = array::from_fn(|k| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / SAMPLES as f64);
            DVec3::new(cos, 0.3 * sin, 0.1 * cos)
        });
        let cell = Cell::new(DVec3::ZERO, &ring, DVec3::ZERO);
        let distance = |from: DVec3| ring.iter().map(|p| p.distance(from)).sum::<f64>() / SAMPLES as f64;
        for direction in [DVec3::X, DVec3::Y, DVec3::new(0.3, 0.5, -0.8).normalize()] {
            let from = direction * 1.01 * NEARBY * cell.square.sqrt();
            let step = 1e-5;
            let expected = DVec3::from_array(array::from_fn(|k| {
                let by = DVec3::AXES[k] * step;
                (distance(from + by) - distance(from - by)) / (2.0 * step)
            }));
            let known = cell.slope(from, from.length_squared());
            // What is left out is of the fourth order of width over distance.
            assert!(
                known.distance(expected) < 1.0 / (NEARBY * NEARBY * NEARBY * NEARBY),
                "{known} {expected}"
            );
            assert!(slope_nearby(&ring, from, 0.0).distance(expected) < 1e-8);
            // The mean alone does not.
            assert!(direction.distance(expected) > 2e-3, "{direction} {expected}");
        }
    }
}
