//! The tiles in the order of the balanced regions, in clumps and blocks: what lies together is judged together.

use std::ops::Range;

use glam::DVec3;

use super::balance::{Item, balance};
use super::tiles::{Tile, Tiles};
use crate::parallel;

/// A place in position and scaled normal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
}

impl Place {
    pub(super) fn minus(&self, other: &Self) -> Self {
        Self { position: self.position - other.position, normal: self.normal - other.normal }
    }

    pub(super) fn length(&self) -> f64 {
        libm::sqrt(self.position.length_squared() + self.normal.length_squared())
    }
}

/// A box of places.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) middle: Place,
    /// Half its extent in each coordinate.
    pub(super) half: Place,
    /// Half its diagonal.
    pub(super) radius: f64,
}

impl Bounds {
    fn around(places: impl Iterator<Item = (Place, Place)>) -> Self {
        let (mut low, mut high) = ([DVec3::INFINITY; 2], [DVec3::NEG_INFINITY; 2]);
        for (l, h) in places {
            low = [low[0].min(l.position), low[1].min(l.normal)];
            high = [high[0].max(h.position), high[1].max(h.normal)];
        }
        let place = |[position, normal]: [DVec3; 2]| Place { position, normal };
        let half = place([0, 1].map(|k| (high[k] - low[k]) * 0.5));
        Self { middle: place([0, 1].map(|k| (low[k] + high[k]) * 0.5)), half, radius: half.length() }
    }
}

/// Tiles that lie close together, with their sums.
#[derive(Clone, Debug)]
pub(super) struct Clump {
    pub(super) tiles: Range<u32>,
    pub(super) patch: u32,
    pub(super) bounds: Bounds,
    pub(super) mass: f64,
    pub(super) area: f64,
    /// Mass times mean place.
    pub(super) moment: Place,
}

/// A balanced region: clumps of one patch.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) clumps: Range<usize>,
    pub(super) bounds: Bounds,
    /// The mean place.
    pub(super) centre: Place,
    pub(super) patch: u32,
    /// How many points are due here: one, or more where it is a single clump.
    pub(super) points: u32,
    /// The distance of the points here: square root of the area for each.
    pub(super) distance: f64,
}

/// The surface, cut and put in order.
pub(super) struct Layout {
    pub(super) tiles: Vec<Tile>,
    pub(super) clumps: Vec<Clump>,
    pub(super) blocks: Vec<Block>,
}

/// A point that is due in a block.
pub(super) struct Due {
    /// Which point.
    pub(super) point: u32,
    /// Which block.
    pub(super) block: u32,
}

/// Balances clumps and points (in the order of their patches, `counts` for each); says in which block each point is
/// due, block by block.
pub(super) fn lay_out(tiles: Tiles, counts: &[usize], points: Vec<Item>) -> (Layout, Vec<Due>) {
    let Tiles { tiles, clump_ends: ends } = tiles;
    let unordered = parallel::map(ends.len(), |c| {
        let start = if c == 0 { 0 } else { ends[c - 1] };
        clump(&tiles, start..ends[c])
    });
    let mut items: Vec<Vec<Item>> = vec![Vec::new(); counts.len()];
    for (id, clump) in (0..).zip(&unordered) {
        let Place { position, normal } = clump.moment;
        let (position, normal) = (position / clump.mass, normal / clump.mass);
        items[clump.patch as usize].push(Item { position, normal, mass: clump.mass, id });
    }
    let mut next = points.into_iter();
    let mut clumps: Vec<u32> = Vec::with_capacity(unordered.len());
    let mut regions = Vec::new();
    let mut dues = Vec::new();
    for (mut items, &count) in items.into_iter().zip(counts) {
        let mut points: Vec<Item> = next.by_ref().take(count).collect();
        let start = clumps.len();
        for region in balance(&mut items, &mut points) {
            let block = regions.len() as u32;
            dues.extend(points[region.points.clone()].iter().map(|p| Due { point: p.id, block }));
            let members = start + region.clumps.start..start + region.clumps.end;
            regions.push((members, region.points.len() as u32));
        }
        clumps.extend(items.iter().map(|item| item.id));
    }
    let clumps = parallel::map(clumps.len(), |i| unordered[clumps[i] as usize].clone());
    let blocks = parallel::map(regions.len(), |b| block(&clumps, regions[b].0.clone(), regions[b].1));
    (Layout { tiles, clumps, blocks }, dues)
}

fn clump(all: &[Tile], tiles: Range<u32>) -> Clump {
    let members = &all[tiles.start as usize..tiles.end as usize];
    let (mut mass, mut area) = (0.0, 0.0);
    let mut moment = Place::default();
    for tile in members {
        mass += tile.mass;
        area += tile.area;
        moment.position += tile.centre() * tile.mass;
        moment.normal += tile.normal() * tile.mass;
    }
    let corners = members.iter().flat_map(|t| t.corners.into_iter().zip(t.normals));
    let bounds = Bounds::around(corners.map(|(position, normal)| {
        let place = Place { position, normal };
        (place, place)
    }));
    Clump { tiles, patch: members[0].patch, bounds, mass, area, moment }
}

fn block(all: &[Clump], clumps: Range<usize>, points: u32) -> Block {
    let members = &all[clumps.clone()];
    let mass: f64 = members.iter().map(|c| c.mass).sum();
    let area: f64 = members.iter().map(|c| c.area).sum();
    let position = members.iter().map(|c| c.moment.position).sum::<DVec3>() / mass;
    let normal = members.iter().map(|c| c.moment.normal).sum::<DVec3>() / mass;
    let bounds = Bounds::around(members.iter().map(|c| {
        let Bounds { middle: m, half: h, .. } = c.bounds;
        let place = |position, normal| Place { position, normal };
        (
            place(m.position - h.position, m.normal - h.normal),
            place(m.position + h.position, m.normal + h.normal),
        )
    }));
    Block {
        clumps,
        bounds,
        centre: Place { position, normal },
        patch: members[0].patch,
        points,
        distance: libm::sqrt(area / f64::from(points)),
    }
}
