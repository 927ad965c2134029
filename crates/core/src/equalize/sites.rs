//! The points as sites of a power diagram, and which of them can own a part of which tile.

use glam::DVec3;

use super::tiles::{Tile, Tiles};
use crate::parallel;

/// A site of the power diagram in position and scaled normal: the distance of a place x with normal N is
/// |x - position|^2 + |bend N - normal|^2 - weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) position: DVec3,
    /// The mean normal of its cell times the metric's length for normals.
    pub(super) normal: DVec3,
    pub(super) weight: f64,
    pub(super) patch: u32,
}

impl Site {
    /// The power of a place whose scaled normal is given.
    #[inline]
    pub(super) fn power(&self, place: DVec3, normal: DVec3) -> f64 {
        self.position.distance_squared(place) + self.normal.distance_squared(normal) - self.weight
    }
}

/// The sites sorted into cubes, found by hashing.
struct SiteGrid<'a> {
    sites: &'a [Site],
    low: DVec3,
    cell: f64,
    /// Site numbers, cube after cube.
    order: Vec<u32>,
    /// Open addressing: the cube's key and where its run starts and ends; an empty slot has an empty run.
    table: Vec<(u64, u32, u32)>,
}

impl<'a> SiteGrid<'a> {
    fn new(sites: &'a [Site], cell: f64) -> Self {
        let low = sites.iter().fold(DVec3::INFINITY, |m, s| m.min(s.position)) - cell;
        let mut keyed: Vec<(u64, u32)> =
            (0..).zip(sites).map(|(i, s)| (key(cube((s.position - low) / cell)), i)).collect();
        keyed.sort_unstable();
        let mut table = vec![(0, 0, 0); (sites.len() * 2).next_power_of_two().max(4)];
        let mut grid = Self { sites, low, cell, order: Vec::new(), table: Vec::new() };
        let mut start = 0;
        while start < keyed.len() {
            let end = start + keyed[start..].partition_point(|k| k.0 == keyed[start].0);
            let mut slot = slot_of(keyed[start].0, table.len());
            while table[slot].1 != table[slot].2 {
                slot = (slot + 1) & (table.len() - 1);
            }
            table[slot] = (keyed[start].0, start as u32, end as u32);
            start = end;
        }
        grid.order = keyed.into_iter().map(|(_, i)| i).collect();
        grid.table = table;
        grid
    }

    fn run(&self, key: u64) -> &[u32] {
        let mut slot = slot_of(key, self.table.len());
        loop {
            let (k, start, end) = self.table[slot];
            if start == end {
                return &[];
            }
            if k == key {
                return &self.order[start as usize..end as usize];
            }
            slot = (slot + 1) & (self.table.len() - 1);
        }
    }

    /// Puts the sites of the patch within `reach` of `centre` into `found`.
    fn within(&self, centre: DVec3, reach: f64, patch: u32, found: &mut Vec<u32>) {
        found.clear();
        let low = cube((centre - reach - self.low) / self.cell);
        let high = cube((centre + reach - self.low) / self.cell);
        let cubes = (0..3).map(|a| (high[a] - low[a] + 1) as f64).product::<f64>();
        let keep = |&i: &u32| {
            let site = &self.sites[i as usize];
            site.patch == patch && site.position.distance_squared(centre) <= reach * reach
        };
        if cubes > self.sites.len() as f64 {
            found.extend((0..self.sites.len() as u32).filter(keep));
            return;
        }
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    found.extend(self.run(key([x, y, z])).iter().copied().filter(keep));
                }
            }
        }
        found.sort_unstable();
    }
}

/// The cube that holds a place; places below the origin fall into cube 0, far away ones into the last.
fn cube(p: DVec3) -> [u32; 3] {
    const LAST: f64 = ((1 << 21) - 1) as f64;
    [p.x, p.y, p.z].map(|x| x.clamp(0.0, LAST) as u32)
}

fn key([x, y, z]: [u32; 3]) -> u64 {
    u64::from(x) | (u64::from(y) << 21) | (u64::from(z) << 42)
}

fn slot_of(key: u64, length: usize) -> usize {
    (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & (length - 1)
}

/// For each tile the sites that may own a part of it.
pub(super) struct Candidates {
    ends: Vec<u32>,
    sites: Vec<u32>,
}

impl Candidates {
    pub(super) fn of_tile(&self, tile: usize) -> &[u32] {
        let start = if tile == 0 { 0 } else { self.ends[tile - 1] as usize };
        &self.sites[start..self.ends[tile] as usize]
    }

    /// Finds the candidates of all tiles. `skin`, a squared length, says by how much powers may change before a site
    /// that is missing could matter.
    ///
    /// Whatever is missing, every tile has a candidate, so no mass is lost.
    pub(super) fn find(tiles: &Tiles, sites: &[Site], d_m: f64, skin: f64) -> Self {
        const GROUPS: usize = 64;
        let grid = SiteGrid::new(sites, d_m);
        let pieces = parallel::map_chunks(tiles.group_ends.len(), GROUPS, |groups| {
            let mut near = Vec::new();
            let mut counts = Vec::new();
            let mut found = Vec::new();
            let mut powers = Vec::new();
            for group in groups {
                let range = tiles.group(group);
                let members = &tiles.tiles[range];
                let middle = members.iter().map(Tile::centre).sum::<DVec3>() / members.len() as f64;
                let radius =
                    members.iter().fold(0.0_f64, |m, t| m.max(t.centre().distance(middle) + t.radius()));
                let mut reach = 1.5 * d_m + radius;
                grid.within(middle, reach, members[0].patch, &mut near);
                // Every patch with tiles has a site, so this ends.
                while near.is_empty() {
                    reach *= 2.0;
                    grid.within(middle, reach, members[0].patch, &mut near);
                }
                for tile in members {
                    let before = found.len();
                    let (centre, radius) = (tile.centre(), tile.radius());
                    let normal = tile.normal();
                    powers.clear();
                    powers.extend(near.iter().map(|&i| sites[i as usize].power(centre, normal)));
                    let best = (0..near.len()).min_by(|&a, &b| powers[a].total_cmp(&powers[b])).unwrap_or(0);
                    let owner = sites[near[best] as usize].position;
                    for (k, &i) in near.iter().enumerate() {
                        let lead = powers[k] - powers[best];
                        // Over the tile the difference of two powers changes by at most 2 radius |distance of sites|.
                        if lead <= 2.0 * radius * sites[i as usize].position.distance(owner) + skin {
                            found.push(i);
                        }
                    }
                    counts.push((found.len() - before) as u32);
                }
            }
            (counts, found)
        });
        let mut ends = Vec::with_capacity(tiles.tiles.len());
        let mut all = Vec::new();
        let mut end = 0;
        for (counts, found) in pieces {
            for count in counts {
                end += count;
                ends.push(end);
            }
            all.extend(found);
        }
        Self { ends, sites: all }
    }
}
