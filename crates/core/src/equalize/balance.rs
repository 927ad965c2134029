//! Hierarchical balancing: surface and points are split together, again and again across the widest extent, so that
//! mass and number of points agree on both sides; at the end every point owns a region of equal mass.

use glam::DVec3;

/// A tile or a point in the space of positions and scaled normals.
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

/// A point's region.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    /// The point.
    pub(super) point: u32,
    /// The centroid of its region.
    pub(super) position: DVec3,
    /// The mean scaled normal of its region.
    pub(super) normal: DVec3,
}

/// Below this many tiles a piece is not worth another thread.
#[cfg(feature = "parallel")]
const ALONE: usize = 1 << 12;

/// Shares out the tiles over the points; one region for each point. O(tiles log points).
pub(super) fn balance(tiles: &mut [Item], points: &mut [Item], regions: &mut [Region]) {
    debug_assert_eq!(points.len(), regions.len());
    match points {
        [] => return,
        [point] => {
            regions[0] = region(tiles, point);
            return;
        }
        _ => {}
    }
    if tiles.len() < 2 {
        // Fewer tiles than points: the points keep their places.
        for (region, point) in regions.iter_mut().zip(points.iter()) {
            *region = Region { point: point.id, position: point.position, normal: point.normal };
        }
        return;
    }
    let axis = widest_axis(tiles);
    let lower = points.len() / 2;
    let total: f64 = tiles.iter().map(|t| t.mass).sum();
    let cut = split_by_mass(tiles, axis, total * lower as f64 / points.len() as f64);
    points.select_nth_unstable_by(lower, |a, b| {
        a.coordinate(axis).total_cmp(&b.coordinate(axis)).then(a.id.cmp(&b.id))
    });
    let (tiles_below, tiles_above) = tiles.split_at_mut(cut);
    let (points_below, points_above) = points.split_at_mut(lower);
    let (regions_below, regions_above) = regions.split_at_mut(lower);
    #[cfg(feature = "parallel")]
    if tiles_below.len() > ALONE {
        rayon::join(
            || balance(tiles_below, points_below, regions_below),
            || balance(tiles_above, points_above, regions_above),
        );
        return;
    }
    balance(tiles_below, points_below, regions_below);
    balance(tiles_above, points_above, regions_above);
}

fn region(tiles: &[Item], point: &Item) -> Region {
    let mass: f64 = tiles.iter().map(|t| t.mass).sum();
    if mass <= 0.0 {
        return Region { point: point.id, position: point.position, normal: point.normal };
    }
    let position = tiles.iter().map(|t| t.position * t.mass).sum::<DVec3>() / mass;
    let normal = tiles.iter().map(|t| t.normal * t.mass).sum::<DVec3>() / mass;
    Region { point: point.id, position, normal }
}

fn widest_axis(items: &[Item]) -> usize {
    let mut low = [DVec3::INFINITY; 2];
    let mut high = [DVec3::NEG_INFINITY; 2];
    for item in items {
        for (k, v) in [item.position, item.normal].into_iter().enumerate() {
            low[k] = low[k].min(v);
            high[k] = high[k].max(v);
        }
    }
    let extent = |axis: usize| (high[axis / 3] - low[axis / 3])[axis % 3];
    (0..6).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best })
}

/// Reorders the items so that those before the returned place are the ones lowest along the axis and their mass is
/// as near to `wanted` as whole items allow. Neither side is empty.
fn split_by_mass(items: &mut [Item], axis: usize, wanted: f64) -> usize {
    let order = |a: &Item, b: &Item| a.coordinate(axis).total_cmp(&b.coordinate(axis)).then(a.id.cmp(&b.id));
    let (mut low, mut high) = (0, items.len());
    let mut below = 0.0;
    // Items before `low` are lower, items from `high` on are higher; `below` is the mass before `low`.
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        items[low..high].select_nth_unstable_by(middle - low, order);
        let mass: f64 = items[low..middle].iter().map(|t| t.mass).sum();
        if below + mass <= wanted {
            below += mass;
            low = middle;
        } else {
            high = middle;
        }
    }
    // The cut falls before or behind the item at `low`.
    let behind = wanted - below > 0.5 * items[low].mass;
    (low + usize::from(behind)).clamp(1, items.len() - 1)
}
