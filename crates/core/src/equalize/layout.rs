//! The tiles in the order of the balanced regions, in blocks with their own copies of the tiles' corners: what lies
//! together is judged together.

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

    pub(super) fn length_squared(&self) -> f64 {
        self.position.length_squared() + self.normal.length_squared()
    }
}

/// A box of places.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) middle: Place,
    /// Half its extent in each coordinate.
    pub(super) half: Place,
}

impl Bounds {
    fn between(low: [DVec3; 2], high: [DVec3; 2]) -> Self {
        let place = |[position, normal]: [DVec3; 2]| Place { position, normal };
        Self {
            middle: place([0, 1].map(|k| (low[k] + high[k]) * 0.5)),
            half: place([0, 1].map(|k| (high[k] - low[k]) * 0.5)),
        }
    }
}

/// Many places, coordinate by coordinate: three of the position, three of the normal.
#[derive(Default)]
pub(super) struct Places([Vec<f64>; 6]);

impl Places {
    pub(super) fn at(&self, i: u32) -> Place {
        let [x, y, z, u, v, w] = [0, 1, 2, 3, 4, 5].map(|axis| self.0[axis][i as usize]);
        Place { position: DVec3::new(x, y, z), normal: DVec3::new(u, v, w) }
    }

    /// The coordinates of some of the places.
    pub(super) fn of(&self, range: &Range<usize>) -> [&[f64]; 6] {
        [0, 1, 2, 3, 4, 5].map(|axis| &self.0[axis][range.clone()])
    }

    fn push(&mut self, place: &Place) {
        let coordinates = [place.position.to_array(), place.normal.to_array()];
        for (all, x) in self.0.iter_mut().zip(coordinates.as_flattened()) {
            all.push(*x);
        }
    }

    fn append(&mut self, other: &mut Self) {
        for (all, more) in self.0.iter_mut().zip(&mut other.0) {
            all.append(more);
        }
    }

    fn len(&self) -> usize {
        self.0[0].len()
    }
}

/// A balanced region: tiles of one patch that lie together.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) tiles: Range<usize>,
    /// The corners of its tiles, each once; no other block has them.
    pub(super) places: Range<usize>,
    pub(super) bounds: Bounds,
    /// The mean place; where the tiles lie apart and it is far from all of them, the middle of the nearest tile.
    pub(super) centre: Place,
    pub(super) patch: u32,
    /// How many points are due here: one, or more where it is a single clump.
    pub(super) points: u32,
    /// The distance of the points here: square root of the area for each.
    pub(super) distance: f64,
}

/// The surface, cut and put in order.
#[derive(Default)]
pub(super) struct Layout {
    /// Their corners are among `places`.
    pub(super) tiles: Vec<Tile>,
    pub(super) places: Places,
    pub(super) blocks: Vec<Block>,
}

impl Layout {
    /// The positions of a tile's corners.
    pub(super) fn corners(&self, tile: &Tile) -> [DVec3; 3] {
        tile.corners.map(|id| self.places.at(id).position)
    }

    /// Adds what was laid out by itself.
    fn append(&mut self, mut other: Self) {
        let (tiles, places) = (self.tiles.len(), self.places.len());
        self.tiles.extend(other.tiles.into_iter().map(|tile| {
            let corners = tile.corners.map(|id| id + places as u32);
            Tile { corners, ..tile }
        }));
        self.places.append(&mut other.places);
        let moved = |range: Range<usize>, by: usize| range.start + by..range.end + by;
        self.blocks.extend(other.blocks.into_iter().map(|block| Block {
            tiles: moved(block.tiles, tiles),
            places: moved(block.places, places),
            ..block
        }));
    }
}

/// A point that is due in a block.
pub(super) struct Due {
    /// Which point.
    pub(super) point: u32,
    /// Which block.
    pub(super) block: u32,
}

/// Tiles that lie close together, and their mean place.
#[derive(Clone, Debug)]
struct Clump {
    tiles: Range<u32>,
    patch: u32,
    mass: f64,
    centre: Place,
}

/// Balances clumps and points (in the order of their patches, `counts` for each); says in which block each point is
/// due, block by block.
pub(super) fn lay_out(tiles: &Tiles, counts: &[usize], points: Vec<Item>) -> (Layout, Vec<Due>) {
    const CHUNK: usize = 1 << 8;
    let ends = &tiles.clump_ends;
    let clumps = parallel::map(ends.len(), |c| {
        let start = if c == 0 { 0 } else { ends[c - 1] };
        clump(tiles, start..ends[c])
    });
    let mut items: Vec<Vec<Item>> = vec![Vec::new(); counts.len()];
    for (id, clump) in (0..).zip(&clumps) {
        let Place { position, normal } = clump.centre;
        items[clump.patch as usize].push(Item { position, normal, mass: clump.mass, id });
    }
    let mut next = points.into_iter();
    let mut order: Vec<u32> = Vec::with_capacity(clumps.len());
    let mut regions = Vec::new();
    let mut dues = Vec::new();
    for (mut items, &count) in items.into_iter().zip(counts) {
        let mut points: Vec<Item> = next.by_ref().take(count).collect();
        let start = order.len();
        for region in balance(&mut items, &mut points) {
            let block = regions.len() as u32;
            dues.extend(points[region.points.clone()].iter().map(|p| Due { point: p.id, block }));
            let members = start + region.clumps.start..start + region.clumps.end;
            regions.push((members, region.points.len() as u32));
        }
        order.extend(items.iter().map(|item| item.id));
    }
    let pieces = parallel::map_chunks(regions.len(), CHUNK, |range| {
        let mut layout = Layout::default();
        let mut ids = Vec::new();
        for (members, points) in &regions[range] {
            let ranges = order[members.clone()].iter().map(|&c| clumps[c as usize].tiles.clone());
            block(tiles, ranges, *points, &mut ids, &mut layout);
        }
        layout
    });
    let mut layout = Layout::default();
    for piece in pieces {
        layout.append(piece);
    }
    (layout, dues)
}

/// The mean place of a tile.
fn centre(places: &[Place], tile: &Tile) -> Place {
    let [a, b, c] = tile.corners.map(|id| places[id as usize]);
    Place {
        position: (a.position + b.position + c.position) / 3.0,
        normal: (a.normal + b.normal + c.normal) / 3.0,
    }
}

fn clump(all: &Tiles, tiles: Range<u32>) -> Clump {
    let members = &all.tiles[tiles.start as usize..tiles.end as usize];
    let mut mass = 0.0;
    let mut moment = Place::default();
    for tile in members {
        let centre = centre(&all.places, tile);
        mass += tile.mass;
        moment.position += centre.position * tile.mass;
        moment.normal += centre.normal * tile.mass;
    }
    let centre = Place { position: moment.position / mass, normal: moment.normal / mass };
    Clump { tiles, patch: members[0].patch, mass, centre }
}

/// Adds a block with the tiles of these ranges. `ids` is scratch.
fn block(
    all: &Tiles,
    ranges: impl Iterator<Item = Range<u32>>,
    points: u32,
    ids: &mut Vec<u32>,
    layout: &mut Layout,
) {
    let (first_tile, first_place) = (layout.tiles.len(), layout.places.len());
    for range in ranges {
        layout.tiles.extend(&all.tiles[range.start as usize..range.end as usize]);
    }
    let tiles = &mut layout.tiles[first_tile..];
    ids.clear();
    ids.extend(tiles.iter().flat_map(|tile| tile.corners));
    ids.sort_unstable();
    ids.dedup();
    let (mut low, mut high) = ([DVec3::INFINITY; 2], [DVec3::NEG_INFINITY; 2]);
    for &id in &*ids {
        let place = &all.places[id as usize];
        layout.places.push(place);
        low = [low[0].min(place.position), low[1].min(place.normal)];
        high = [high[0].max(place.position), high[1].max(place.normal)];
    }
    let (mut mass, mut area) = (0.0, 0.0);
    let mut moment = Place::default();
    let mut centres = Vec::with_capacity(tiles.len());
    for tile in &mut *tiles {
        let centre = centre(&all.places, tile);
        centres.push(centre);
        mass += tile.mass;
        area += tile.area;
        moment.position += centre.position * tile.mass;
        moment.normal += centre.normal * tile.mass;
        // Every corner is in the list.
        tile.corners = tile.corners.map(|id| (first_place + ids.partition_point(|&i| i < id)) as u32);
    }
    let distance = libm::sqrt(area / f64::from(points));
    let mean = Place { position: moment.position / mass, normal: moment.normal / mass };
    let aside = |place: &Place| place.position.distance_squared(mean.position);
    let nearest = centres.into_iter().min_by(|a, b| aside(a).total_cmp(&aside(b)));
    let block = Block {
        tiles: first_tile..first_tile + tiles.len(),
        places: first_place..layout.places.len(),
        bounds: Bounds::between(low, high),
        centre: nearest.filter(|place| aside(place) > distance * distance).unwrap_or(mean),
        patch: tiles[0].patch,
        points,
        distance,
    };
    layout.blocks.push(block);
}
