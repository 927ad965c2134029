//! Hierarchical balancing: surface and points are split together, again and again across the widest extent, so that
//! mass and number of points agree on both sides; at the end every point owns a region of equal mass.

use std::ops::Range;

use glam::DVec3;

use crate::halves::split_by_mass;

/// A clump of clumps or a point in the space of positions and scaled normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    /// 0 for a point.
    pub(super) mass: f64,
    pub(super) id: u32,
}

impl Item {
    fn coordinate(&self, axis: usize) -> f64 {
        if axis < 3 { self.position[axis] } else { self.normal[axis - 3] }
    }
}

/// A piece of the surface with the points that are due there: one, or more where it is a single clump.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// Which clumps, in their new order.
    pub(super) clumps: Range<usize>,
    /// Which points, in their new order.
    pub(super) points: Range<usize>,
}

/// Below this many clumps a piece is not worth another thread.
#[cfg(feature = "parallel")]
const ALONE: usize = 1 << 11;

/// Shares out the clumps over the points: reorders both so that each region's stand together.
///
/// O(clumps log points).
pub(super) fn balance(clumps: &mut [Item], points: &mut [Item]) -> Vec<Region> {
    let mut regions = Vec::with_capacity(points.len());
    share(clumps, points, [0, 0], &mut regions);
    regions
}

/// `starts` says where the two slices stand in the whole.
fn share(clumps: &mut [Item], points: &mut [Item], starts: [usize; 2], regions: &mut Vec<Region>) {
    if points.is_empty() {
        return;
    }
    if points.len() < 2 || clumps.len() < 2 {
        let [clump, point] = starts;
        regions.push(Region { clumps: clump..clump + clumps.len(), points: point..point + points.len() });
        return;
    }
    let axis = widest_axis(clumps);
    let lower = points.len() / 2;
    let total: f64 = clumps.iter().map(|t| t.mass).sum();
    let order = |a: &Item, b: &Item| a.coordinate(axis).total_cmp(&b.coordinate(axis)).then(a.id.cmp(&b.id));
    let wanted = total * lower as f64 / points.len() as f64;
    let cut = split_by_mass(clumps, order, |clump| clump.mass, wanted);
    points.select_nth_unstable_by(lower, order);
    let (clumps_below, clumps_above) = clumps.split_at_mut(cut);
    let (points_below, points_above) = points.split_at_mut(lower);
    let behind = [starts[0] + cut, starts[1] + lower];
    #[cfg(feature = "parallel")]
    if clumps_below.len() > ALONE {
        let mut above = Vec::with_capacity(points_above.len());
        rayon::join(
            || share(clumps_below, points_below, starts, regions),
            || share(clumps_above, points_above, behind, &mut above),
        );
        regions.append(&mut above);
        return;
    }
    share(clumps_below, points_below, starts, regions);
    share(clumps_above, points_above, behind, regions);
}

fn widest_axis(items: &[Item]) -> usize {
    let mut low = [DVec3::INFINITY; 2];
    let mut high = [DVec3::NEG_INFINITY; 2];
    for item in items {
        low = [low[0].min(item.position), low[1].min(item.normal)];
        high = [high[0].max(item.position), high[1].max(item.normal)];
    }
    let extent = |axis: usize| (high[axis / 3] - low[axis / 3])[axis % 3];
    (0..6).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best })
}
