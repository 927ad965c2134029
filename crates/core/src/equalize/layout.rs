//! The tiles in the order of the balanced regions, in blocks with their own copies of the tiles' corners: what lies
//! together is judged together.

use std::ops::Range;

use glam::DVec3;

use super::balance::{Balanced, Item};
use super::tiles::{Tile, Tiles};
use crate::geometry::triangle;
use crate::ids::FaceId;
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
    /// The box of the positions, so much larger on all sides.
    pub(super) fn widened(&self, by: f64) -> (DVec3, DVec3) {
        let (middle, half) = (self.middle.position, self.half.position + by);
        (middle - half, middle + half)
    }

    fn between(low: [DVec3; 2], high: [DVec3; 2]) -> Self {
        let place = |[position, normal]: [DVec3; 2]| Place { position, normal };
        Self {
            middle: place([0, 1].map(|k| (low[k] + high[k]) * 0.5)),
            half: place([0, 1].map(|k| (high[k] - low[k]) * 0.5)),
        }
    }
}

/// Many places, coordinate by coordinate: three of the position, three of the normal.
pub(super) struct Places([Vec<f64>; 6]);

impl Places {
    /// The position alone.
    #[inline]
    pub(super) fn position(&self, i: u32) -> DVec3 {
        let [x, y, z, ..] = &self.0;
        let i = i as usize;
        DVec3::new(x[i], y[i], z[i])
    }

    #[inline]
    pub(super) fn at(&self, i: u32) -> Place {
        let [x, y, z, u, v, w] = &self.0;
        let i = i as usize;
        Place { position: DVec3::new(x[i], y[i], z[i]), normal: DVec3::new(u[i], v[i], w[i]) }
    }

    /// The coordinates of some of the places.
    pub(super) fn of(&self, range: &Range<usize>) -> [&[f64]; 6] {
        [0, 1, 2, 3, 4, 5].map(|axis| &self.0[axis][range.clone()])
    }

    fn with_room(count: usize) -> Self {
        Self([(); 6].map(|()| Vec::with_capacity(count)))
    }

    fn push(&mut self, place: &Place) {
        let coordinates = [place.position.to_array(), place.normal.to_array()];
        for (all, x) in self.0.iter_mut().zip(coordinates.as_flattened()) {
            all.push(*x);
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
pub(super) struct Layout {
    /// Their corners are among `places`.
    pub(super) tiles: Vec<Tile>,
    pub(super) places: Places,
    pub(super) blocks: Vec<Block>,
}

/// The face of a tile and the positions of its corners.
#[derive(Clone, Copy)]
pub(super) struct Ground {
    pub(super) face: FaceId,
    pub(super) corners: [DVec3; 3],
}

impl Layout {
    /// The area of a tile.
    pub(super) fn area(&self, tile: &Tile) -> f64 {
        let [a, b, c] = self.corners(tile);
        triangle::area(a, b, c)
    }

    /// The positions of a tile's corners.
    #[inline]
    pub(super) fn corners(&self, tile: &Tile) -> [DVec3; 3] {
        let [a, b, c] = tile.corners;
        [self.places.position(a), self.places.position(b), self.places.position(c)]
    }

    /// A tile to stand on.
    #[inline]
    pub(super) fn ground(&self, tile: usize) -> Ground {
        let tile = &self.tiles[tile];
        Ground { face: tile.face, corners: self.corners(tile) }
    }

    /// The block that holds a tile.
    pub(super) fn block_of(&self, tile: u32) -> usize {
        self.blocks.partition_point(|block| block.tiles.end <= tile as usize)
    }

    /// Nothing yet, with room for blocks of so many tiles; `places` says about how many corners those have.
    fn with_room(blocks: impl Iterator<Item = usize> + Clone, places: impl Fn(usize) -> usize) -> Self {
        Self {
            tiles: Vec::with_capacity(blocks.clone().sum()),
            places: Places::with_room(blocks.clone().map(places).sum()),
            blocks: Vec::with_capacity(blocks.count()),
        }
    }

    /// What was laid out by itself, piece after piece.
    fn of_pieces(pieces: Vec<Self>) -> Self {
        let before = |of: fn(&Self) -> usize| -> Vec<usize> {
            let start = |sum: &mut usize, piece: &Self| Some(std::mem::replace(sum, *sum + of(piece)));
            pieces.iter().scan(0, start).collect()
        };
        let first_tiles = before(|piece| piece.tiles.len());
        let first_places = before(|piece| piece.places.len());
        let (mut tiles, mut blocks) = (Vec::new(), Vec::new());
        let mut axes: [(Vec<Vec<f64>>, Vec<f64>); 6] = [(); 6].map(|()| (Vec::new(), Vec::new()));
        for piece in pieces {
            tiles.push(piece.tiles);
            blocks.push(piece.blocks);
            axes.iter_mut().zip(piece.places.0).for_each(|(axis, of_piece)| axis.0.push(of_piece));
        }
        // By value, so that what has been put there is given back.
        let all_tiles = || {
            let mut all = Vec::with_capacity(tiles.iter().map(Vec::len).sum());
            for (tiles, &by) in tiles.into_iter().zip(&first_places) {
                let moved = |tile: Tile| Tile { corners: tile.corners.map(|id| id + by as u32), ..tile };
                all.extend(tiles.into_iter().map(moved));
            }
            all
        };
        let all_places = || {
            parallel::change_chunks(&mut axes, 1, |_, axes| {
                for (pieces, all) in axes {
                    all.reserve_exact(pieces.iter().map(Vec::len).sum());
                    std::mem::take(pieces).into_iter().for_each(|piece| all.extend_from_slice(&piece));
                }
            });
            Places(axes.map(|(_, all)| all))
        };
        let (tiles, places) = parallel::join(all_tiles, all_places);
        let moved = |range: Range<usize>, by: usize| range.start + by..range.end + by;
        let starts = first_tiles.iter().zip(&first_places);
        let blocks = blocks.into_iter().zip(starts).flat_map(|(blocks, (&first_tile, &first_place))| {
            blocks.into_iter().map(move |block: Block| Block {
                tiles: moved(block.tiles, first_tile),
                places: moved(block.places, first_place),
                ..block
            })
        });
        Self { tiles, places, blocks: blocks.collect() }
    }
}

/// A point that is due in a block.
pub(super) struct Due {
    /// Which point.
    pub(super) point: u32,
    /// Which block.
    pub(super) block: u32,
}

/// The surface of each patch, balanced.
pub(super) struct Splits(Vec<Balanced>);

impl Splits {
    /// Says in which block each point is due, block by block. There are as many points as the surface was laid out for, in
    /// the order of their patches.
    pub(super) fn dues(&self, mut points: Vec<Item>, blocks: &[Block]) -> Vec<Due> {
        let mut rest = &mut points[..];
        for balanced in &self.0 {
            let count = balanced.regions.iter().map(|region| region.points as usize).sum();
            let (of_patch, others) = rest.split_at_mut(count);
            balanced.deal(of_patch);
            rest = others;
        }
        let blocks = (0..).zip(blocks).flat_map(|(i, block)| std::iter::repeat_n(i, block.points as usize));
        points.iter().zip(blocks).map(|(point, block)| Due { point: point.id, block }).collect()
    }
}

/// Balances clumps for so many points in each patch. Which points these are does not matter yet.
pub(super) fn lay_out(tiles: Tiles<'_>, counts: &[usize]) -> (Layout, Splits) {
    let mut clumps = parallel::map(tiles.clump_count(), |id| clump(&tiles, id as u32));
    // Clumps are in the order of their patches, of which one without mass has none.
    let patch_of = |clump: &Item| tiles.patch_of(clump.id as usize);
    let mut regions = Vec::new();
    let mut splits = Vec::with_capacity(counts.len());
    let (mut rest, mut start) = (&mut clumps[..], 0);
    for (patch, &count) in (0..).zip(counts) {
        let own = rest.partition_point(|clump| patch_of(clump) == patch);
        let (of_patch, others) = rest.split_at_mut(own);
        let balanced = Balanced::new(of_patch, count);
        let members = |clumps: &Range<usize>| start + clumps.start..start + clumps.end;
        regions.extend(balanced.regions.iter().map(|region| (members(&region.clumps), region.points)));
        splits.push(balanced);
        start += own;
        rest = others;
    }
    let order: Vec<u32> = clumps.into_iter().map(|clump| clump.id).collect();
    // Each piece has a table of all places, so there are few.
    let chunk = regions.len().div_ceil(16);
    let pieces = parallel::map_chunks(regions.len(), chunk, |range| {
        let mut numbers = Numbers { of_place: vec![0; tiles.place_count()], given: 0 };
        let count = |(members, _): &(Range<usize>, u32)| -> usize {
            order[members.clone()].iter().map(|&clump| tiles.clump(clump as usize).len()).sum()
        };
        let places = |tiles_of_block| tiles.places_of(tiles_of_block);
        let mut layout = Layout::with_room(regions[range.clone()].iter().map(count), places);
        for (members, points) in &regions[range] {
            block(&tiles, &order[members.clone()], *points, &mut numbers, &mut layout);
        }
        layout
    });
    drop(tiles);
    (Layout::of_pieces(pieces), Splits(splits))
}

/// The mean place of a tile.
fn centre(all: &Tiles<'_>, tile: &Tile) -> Place {
    let [a, b, c] = tile.corners.map(|id| all.place(id));
    Place {
        position: (a.position + b.position + c.position) / 3.0,
        normal: (a.normal + b.normal + c.normal) / 3.0,
    }
}

/// A clump as a mass at its mean place.
fn clump(all: &Tiles<'_>, id: u32) -> Item {
    let mut mass = 0.0;
    let mut moment = Place::default();
    for tile in all.clump(id as usize) {
        let centre = centre(all, tile);
        mass += tile.mass;
        moment.position += centre.position * tile.mass;
        moment.normal += centre.normal * tile.mass;
    }
    Item { position: moment.position / mass, normal: moment.normal / mass, mass, id }
}

/// Numbers the places of one block after the other.
struct Numbers {
    /// The last number of each place, plus one.
    of_place: Vec<u32>,
    given: u32,
}

impl Numbers {
    /// The number of a place, if it got one since so many were given.
    fn known(&self, place: u32, since: u32) -> Option<u32> {
        let number = self.of_place[place as usize];
        (number > since).then(|| number - 1)
    }

    fn give(&mut self, place: u32) -> u32 {
        self.of_place[place as usize] = self.given + 1;
        self.given += 1;
        self.given - 1
    }
}

/// Adds a block with the tiles of these clumps.
fn block(all: &Tiles<'_>, clumps: &[u32], points: u32, numbers: &mut Numbers, layout: &mut Layout) {
    let (first_tile, first_place) = (layout.tiles.len(), layout.places.len());
    clumps.iter().for_each(|&clump| layout.tiles.extend_from_slice(all.clump(clump as usize)));
    let tiles = &mut layout.tiles[first_tile..];
    let (mut low, mut high) = ([DVec3::INFINITY; 2], [DVec3::NEG_INFINITY; 2]);
    let (mut mass, mut area) = (0.0, 0.0);
    let mut moment = Place::default();
    let mut centres = Vec::with_capacity(tiles.len());
    for tile in &mut *tiles {
        let centre = centre(all, tile);
        centres.push(centre);
        mass += tile.mass;
        let [a, b, c] = tile.corners.map(|id| all.place(id).position);
        area += triangle::area(a, b, c);
        moment.position += centre.position * tile.mass;
        moment.normal += centre.normal * tile.mass;
        for corner in &mut tile.corners {
            let id = *corner;
            *corner = numbers.known(id, first_place as u32).unwrap_or_else(|| {
                let place = all.place(id);
                layout.places.push(&place);
                low = [low[0].min(place.position), low[1].min(place.normal)];
                high = [high[0].max(place.position), high[1].max(place.normal)];
                numbers.give(id)
            });
        }
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
        patch: all.patch_of(clumps[0] as usize),
        points,
        distance,
    };
    layout.blocks.push(block);
}
