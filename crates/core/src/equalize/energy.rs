//! Points stand where all of them together have the least energy discrepancy, instead of at the centroids of their cells.
//!
//! Its square is, but for a constant, the sum over all points of how much farther the surface is from them in the mean than the
//! points are (`measure/energy.rs`). Centroids know the own cell alone; this knows also what stands behind a thin part and
//! beside a crease, which is much of what points have around them where cells are as large as limbs.

use std::ops::RangeInclusive;

use glam::DVec3;

use super::field::{Field, Sight};
use super::layout::{Ground, Layout};
use super::owners::Cell;
use super::places::Spot;
use super::quadrature::quadratures;
use super::relax::Relaxed;
use super::settle::nearest;
use super::sides::Sides;
use crate::parallel;

/// For how many points. One or two stand best at the centroids. More than the most have cells so small that centroids are
/// nearly as good for what it costs.
const COUNTS: RangeInclusive<usize> = 3..=10_000;

/// Up to so many points are moved with care.
const FEW: usize = 3_000;

/// How far against the slope, in distances of the points.
const STEP: f64 = 0.5;

/// At most so many distances of the points at a time.
const FARTHEST: f64 = 0.3;

/// Leaves whose points move side by side: their number over the root of all leaves. With many, all mend the same long
/// waves, and these grow.
const TOGETHER: f64 = 0.25;

/// Where layouts have more tiles than this, those that a point may stand on are looked up each time: laid ready, a tile takes some
/// hundred bytes.
const READY: usize = 500_000;

/// How well the points are moved. Many gain less from it and cost more: at 10,000 points on the horse, bunny and suzanne a second
/// sweep gives 0.001 to 0.003 of eta, for half as much time again.
struct Care {
    /// So many times each point moves.
    sweeps: usize,
    sight: Sight,
}

impl Care {
    fn of(count: usize) -> Self {
        if count <= FEW {
            Self { sweeps: 4, sight: Sight { far: 2.0, near: 6.0 } }
        } else {
            Self { sweeps: 1, sight: Sight { far: 0.5, near: 3.0 } }
        }
    }
}

/// Where each point is at home: at the centroid of its cell, or for these counts where it has gone, in its cell and on its
/// side; `own` goes with it. O(n log n + tiles).
pub(super) fn homes(
    layout: &Layout,
    relaxed: &Relaxed,
    sides: Option<&Sides>,
    own: &mut [Option<Spot>],
) -> Vec<DVec3> {
    let mut homes: Vec<DVec3> = relaxed.cells.iter().map(Cell::centroid).collect();
    if !COUNTS.contains(&own.len()) {
        return homes;
    }
    // Sites without a place have no cell.
    let standing: Vec<(usize, Spot)> =
        own.iter().enumerate().filter_map(|(site, spot)| Some((site, (*spot)?))).collect();
    let distance = |i: usize| relaxed.sites[standing[i].0].distance;
    let unit = standing.len() as f64 / (0..standing.len()).map(distance).sum::<f64>();
    let care = Care::of(standing.len());
    let mut field = field_of(layout, relaxed, &standing, unit, care.sight);
    let grounds = |i: usize| {
        let (site, spot) = &standing[i];
        let tiles = relaxed.holdings.of(*site).iter().map(|holding| layout.ground(holding.tile as usize));
        tiles.filter(|ground| sides.is_none_or(|s| s.of(ground.face) == s.of(spot.face)))
    };
    // Where each may stand, because it is looked at again and again; unless that takes too much memory.
    let ready = (layout.tiles.len() <= READY)
        .then(|| parallel::map(standing.len(), |i| Standings::new(grounds(i).collect())));
    let step = |i: usize, from: DVec3, slope: DVec3| {
        let by = (slope * (STEP * distance(i))).clamp_length_max(FARTHEST * distance(i));
        let wanted = from / unit - by;
        let spot = match &ready {
            Some(ready) => ready[i].nearest(wanted),
            None => nearest(grounds(i), wanted),
        }?;
        Some((spot.place * unit, spot))
    };
    let leaves = field.leaves();
    let together = (((leaves as f64).sqrt() * TOGETHER).ceil() as usize).max(1);
    let turns = leaves.div_ceil(together);
    for _ in 0..care.sweeps {
        for turn in 0..turns {
            // Far from each other.
            let of_turn: Vec<usize> = (turn..leaves).step_by(turns).collect();
            let moves = parallel::map(of_turn.len(), |k| field.moves(of_turn[k], step));
            for (i, to, spot) in moves.into_iter().flatten() {
                own[standing[i].0] = Some(spot);
                field.put(i, to);
            }
        }
    }
    for (i, (site, _)) in standing.iter().enumerate() {
        homes[*site] = field.point(i) / unit;
    }
    homes
}

/// Tiles on which one point may stand, with balls that hold them.
struct Standings {
    grounds: Vec<Ground>,
    balls: Vec<(DVec3, f64)>,
}

impl Standings {
    fn new(grounds: Vec<Ground>) -> Self {
        let ball = |&Ground { corners, .. }: &Ground| {
            let middle = corners.iter().sum::<DVec3>() / 3.0;
            let far = corners.iter().map(|corner| corner.distance_squared(middle)).fold(0.0, f64::max);
            (middle, far.sqrt())
        };
        let balls = grounds.iter().map(ball).collect();
        Self { grounds, balls }
    }

    /// As [`nearest`], of these tiles.
    fn nearest(&self, wanted: DVec3) -> Option<Spot> {
        // Some place of a tile is no farther than its middle, so what lies beyond that need not be looked at. Rounding is far
        // below this margin.
        const MARGIN: f64 = 1.0 + 1e-9;
        let squares = || self.balls.iter().map(|(middle, _)| middle.distance_squared(wanted));
        let reach = squares().fold(f64::INFINITY, f64::min).sqrt();
        let may_be = |(square, (_, radius)): &(f64, &(DVec3, f64))| {
            let reach = (reach + radius) * MARGIN;
            *square <= reach * reach
        };
        let near = squares().zip(&self.balls).enumerate().filter(|(_, ball)| may_be(ball));
        nearest(near.map(|(k, _)| self.grounds[k]), wanted)
    }
}

/// Of the cells of those that stand.
fn field_of(
    layout: &Layout,
    relaxed: &Relaxed,
    standing: &[(usize, Spot)],
    unit: f64,
    sight: Sight,
) -> Field {
    let sites: Vec<u32> = standing.iter().map(|(site, _)| *site as u32).collect();
    let points: Vec<DVec3> = standing.iter().map(|(_, spot)| spot.place * unit).collect();
    Field::new(quadratures(layout, relaxed, &sites, unit), &points, sight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::FaceId;
    use crate::random::Random;

    /// The same face and the same bits as when every tile is looked at, also where tiles share corners and sides.
    #[test]
    fn balls_pass_over_no_nearer_tile() {
        let mut random = Random::new(6, 1);
        let mut place = |width: f64| {
            DVec3::from_array(
                [(); 3].map(|()| (random.unit() - 0.5) * width).map(|x| (x * 8.0).round() / 8.0),
            )
        };
        let grounds: Vec<Ground> = (0..60)
            .map(|face| {
                let at = place(4.0);
                Ground { face: FaceId::new(face), corners: [at, at + place(2.0), at + place(1.0)] }
            })
            .collect();
        let standings = Standings::new(grounds.clone());
        for _ in 0..500 {
            let wanted = place(8.0);
            let found = [nearest(grounds.iter().copied(), wanted), standings.nearest(wanted)]
                .map(|spot| spot.map(|spot| (spot.face, spot.place)));
            assert_eq!(found[0], found[1], "{wanted}");
        }
        assert!(Standings::new(Vec::new()).nearest(DVec3::ZERO).is_none());
    }
}
