//! From cells to points: each stands on the surface, next to the centroid of its cell and on the side where it is due.

use glam::DVec3;

use super::holdings::Holding;
use super::layout::{Ground, Layout};
use super::places::Spot;
use super::relax::Relaxed;
use super::sides::Sides;
use crate::geometry::triangle;
use crate::parallel;

/// Cells whose points look for places in them.
pub(super) struct Cells<'a> {
    pub(super) layout: &'a Layout,
    pub(super) relaxed: &'a Relaxed,
    pub(super) sides: Option<&'a Sides>,
    /// Where the point of each is at home.
    pub(super) homes: Vec<DVec3>,
}

/// The place of each cell's tiles that lies nearest to its centroid, on the side where the cell's point is due; `None`
/// for an empty cell.
pub(super) fn settle(layout: &Layout, relaxed: &Relaxed, sides: Option<&Sides>) -> Vec<Option<Spot>> {
    let due = sides.map(|sides| sides.share_out(layout, &relaxed.holdings, relaxed.sites.len()));
    parallel::map(relaxed.sites.len(), |site| {
        let cell = &relaxed.cells[site];
        if cell.mass <= 0.0 {
            return None;
        }
        let centroid = cell.centroid();
        let may_stand = |holding: &&Holding| match (sides, &due) {
            (Some(sides), Some(due)) => due[site] == Some(sides.of(layout.tiles[holding.tile as usize].face)),
            _ => true,
        };
        let tiles = relaxed.holdings.of(site).iter().filter(may_stand);
        nearest(tiles.map(|holding| layout.ground(holding.tile as usize)), centroid)
    })
}

/// The place on some tiles that lies nearest to a wanted one.
pub(super) fn nearest(tiles: impl Iterator<Item = Ground>, wanted: DVec3) -> Option<Spot> {
    let mut best: Option<(f64, Spot)> = None;
    for Ground { face, corners: [a, b, c] } in tiles {
        let least = best.map_or(f64::INFINITY, |(least, _)| least);
        // A tile whose nearest corner is farther by more than its longest side has no nearer place.
        let (_, side) = triangle::longest_side([a, b, c]);
        if a.distance_squared(wanted) > 2.0 * (least + side) {
            continue;
        }
        let place = nearest_on([a, b, c], wanted);
        let distance = place.distance_squared(wanted);
        if distance < least {
            best = Some((distance, Spot { face, place }));
        }
    }
    best.map(|(_, spot)| spot)
}

/// The place of a triangle that lies nearest to a wanted one.
pub(super) fn nearest_on([a, b, c]: [DVec3; 3], wanted: DVec3) -> DVec3 {
    triangle::at(a, b, c, triangle::nearest(a, b, c, wanted))
}
