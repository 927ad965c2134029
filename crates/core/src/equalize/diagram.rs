//! The power diagram of the sites on the surface, exact on every tile.
//!
//! On a tile the power of each site is a square plus a part that is affine, so cells are convex polygons: the tile
//! clipped by bisectors. Restricted power diagrams: Yan et al. 2009, DOI 10.1111/j.1467-8659.2009.01521.x; capacities
//! by weights: Aurenhammer, Hoffmann, Aronov 1998, DOI 10.1007/PL00009187.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::clip::{self, Powers};
use super::layout::{Bounds, Clump, Layout, Place};
use super::near::{Near, Site};
use super::tiles::Tile;
use crate::parallel;

/// What a site owns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cell {
    pub(super) mass: f64,
    /// Mass times mean place.
    pub(super) moment: Place,
}

impl Cell {
    fn add(&mut self, mass: f64, moment: Place) {
        self.mass += mass;
        self.moment.position += moment.position;
        self.moment.normal += moment.normal;
    }
}

/// Neighbouring cells and how fast mass passes from one to the other as a weight rises: shared border length times
/// density over the slope of the difference of their powers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) flow: f64,
}

/// All cells and their shared borders; a pair of cells may occur once for every block that it shares.
pub(super) struct Diagram {
    pub(super) cells: Vec<Cell>,
    pub(super) borders: Vec<Border>,
}

/// How many blocks are worked on together; fixed, so that sums come out the same with any number of threads.
const CHUNK: usize = 32;

/// Computes the cells. Linear in the blocks and tiles times the sites near them.
pub(super) fn diagram(layout: &Layout, near: &Near, sites: &[Site]) -> Diagram {
    let powers = powers(sites);
    let pieces = parallel::map_chunks(layout.blocks.len(), CHUNK, |range| {
        let mut walk = Walk::new(layout, &powers);
        let mut sums = Sums::default();
        for block in range {
            let near = near.of_block(block);
            sums.begin(near.len());
            walk.block(block, near, &mut sums);
            sums.end(near);
        }
        (sums.parts, sums.borders)
    });
    let mut cells = vec![Cell::default(); sites.len()];
    let mut borders = Vec::with_capacity(pieces.iter().map(|p| p.1.len()).sum());
    for (parts, piece) in pieces {
        for (site, part) in parts {
            cells[site as usize].add(part.mass, part.moment);
        }
        borders.extend(piece);
    }
    Diagram { cells, borders }
}

/// Which sites own a part of which tiles.
pub(super) fn owned_tiles(layout: &Layout, near: &Near, sites: &[Site]) -> Vec<(u32, u32)> {
    let powers = powers(sites);
    parallel::map_chunks(layout.blocks.len(), CHUNK, |range| {
        let mut walk = Walk::new(layout, &powers);
        let mut owned = Owned { near: &[], pairs: Vec::new() };
        for block in range {
            owned.near = near.of_block(block);
            walk.block(block, owned.near, &mut owned);
        }
        owned.pairs
    })
    .concat()
}

/// The part of a tile that a site owns.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) site: u32,
    pub(super) tile: u32,
    pub(super) mass: f64,
    /// Its corners, in coordinates along the tile's two sides.
    pub(super) polygon: Vec<DVec2>,
}

/// All pieces, in no order that matters. Sums over a site's pieces are its cell.
pub(super) fn pieces(layout: &Layout, near: &Near, sites: &[Site]) -> Vec<Piece> {
    let powers = powers(sites);
    parallel::map_chunks(layout.blocks.len(), CHUNK, |range| {
        let mut walk = Walk::new(layout, &powers);
        let mut cut = Cut { layout, near: &[], pieces: Vec::new() };
        for block in range {
            cut.near = near.of_block(block);
            walk.block(block, cut.near, &mut cut);
        }
        cut.pieces
    })
    .concat()
}

/// Hears which site, by its place among the near ones, owns what.
trait Owners {
    /// All of some tiles, with their sums.
    fn whole(&mut self, site: usize, tiles: Range<u32>, mass: f64, moment: Place);
    /// Part of a tile: a polygon.
    fn part(&mut self, site: usize, tile: u32, mass: f64, moment: Place, polygon: &[clip::Corner]);
    /// Two sites share a border.
    fn border(&mut self, sites: [usize; 2], flow: f64);
}

/// Sums over a block by sites near it.
#[derive(Default)]
struct Sums {
    cells: Vec<Cell>,
    parts: Vec<(u32, Cell)>,
    borders: Vec<Border>,
    first_border: usize,
}

impl Sums {
    fn begin(&mut self, near: usize) {
        self.cells.clear();
        self.cells.resize(near, Cell::default());
        self.first_border = self.borders.len();
    }

    /// Until here borders name sites by their place among the near ones.
    fn end(&mut self, near: &[u32]) {
        let owners = self.cells.iter().zip(near).filter(|(cell, _)| cell.mass > 0.0);
        self.parts.extend(owners.map(|(cell, &site)| (site, *cell)));
        for border in &mut self.borders[self.first_border..] {
            (border.a, border.b) = (near[border.a as usize], near[border.b as usize]);
        }
    }
}

impl Owners for Sums {
    fn whole(&mut self, site: usize, _: Range<u32>, mass: f64, moment: Place) {
        self.cells[site].add(mass, moment);
    }

    fn part(&mut self, site: usize, _: u32, mass: f64, moment: Place, _: &[clip::Corner]) {
        self.cells[site].add(mass, moment);
    }

    fn border(&mut self, [a, b]: [usize; 2], flow: f64) {
        let (a, b) = (a.min(b) as u32, a.max(b) as u32);
        match self.borders[self.first_border..].iter_mut().find(|border| border.a == a && border.b == b) {
            Some(border) => border.flow += flow,
            None => self.borders.push(Border { a, b, flow }),
        }
    }
}

struct Owned<'a> {
    near: &'a [u32],
    pairs: Vec<(u32, u32)>,
}

impl Owners for Owned<'_> {
    fn whole(&mut self, site: usize, tiles: Range<u32>, _: f64, _: Place) {
        self.pairs.extend(tiles.map(|tile| (self.near[site], tile)));
    }

    fn part(&mut self, site: usize, tile: u32, _: f64, _: Place, _: &[clip::Corner]) {
        self.pairs.push((self.near[site], tile));
    }

    fn border(&mut self, _: [usize; 2], _: f64) {}
}

struct Cut<'a> {
    layout: &'a Layout,
    near: &'a [u32],
    pieces: Vec<Piece>,
}

impl Owners for Cut<'_> {
    fn whole(&mut self, site: usize, tiles: Range<u32>, _: f64, _: Place) {
        let site = self.near[site];
        self.pieces.extend(tiles.map(|tile| {
            let mass = self.layout.tiles[tile as usize].mass;
            Piece { site, tile, mass, polygon: vec![DVec2::ZERO, DVec2::X, DVec2::Y] }
        }));
    }

    fn part(&mut self, site: usize, tile: u32, mass: f64, _: Place, polygon: &[clip::Corner]) {
        let polygon = polygon.iter().map(|c| DVec2::new(c.u, c.v)).collect();
        self.pieces.push(Piece { site: self.near[site], tile, mass, polygon });
    }

    fn border(&mut self, _: [usize; 2], _: f64) {}
}

/// A site as an affine function: its power less the square of the place, which is the same for all sites.
#[derive(Clone, Copy)]
struct Power {
    /// Which of the near sites.
    site: usize,
    constant: f64,
    /// Minus twice its place.
    slope: Place,
}

impl Power {
    fn new(site: &Site) -> Self {
        let Place { position, normal } = site.place;
        let constant = position.length_squared() + normal.length_squared() - site.weight;
        Self { site: 0, constant, slope: Place { position: position * -2.0, normal: normal * -2.0 } }
    }

    #[inline]
    fn at(&self, position: DVec3, normal: DVec3) -> f64 {
        self.constant + self.slope.position.dot(position) + self.slope.normal.dot(normal)
    }
}

fn powers(sites: &[Site]) -> Vec<Power> {
    parallel::map(sites.len(), |i| Power::new(&sites[i]))
}

/// Goes through blocks, clumps and tiles and drops on the way the sites that own nothing there.
struct Walk<'a> {
    layout: &'a Layout,
    sites: &'a [Power],
    near: Vec<Power>,
    of_block: Vec<Power>,
    /// No two slopes of those differ by more.
    variety: f64,
    of_clump: Vec<Power>,
    powers: Vec<f64>,
    of_tile: Vec<(Powers, usize)>,
    polygon: Vec<clip::Corner>,
    spare: Vec<clip::Corner>,
}

impl<'a> Walk<'a> {
    fn new(layout: &'a Layout, sites: &'a [Power]) -> Self {
        Self {
            layout,
            sites,
            near: Vec::new(),
            of_block: Vec::new(),
            variety: 0.0,
            of_clump: Vec::new(),
            powers: Vec::new(),
            of_tile: Vec::new(),
            polygon: Vec::new(),
            spare: Vec::new(),
        }
    }

    fn block(&mut self, block: usize, near: &[u32], owners: &mut impl Owners) {
        let layout = self.layout;
        let block = &layout.blocks[block];
        self.near.clear();
        self.near.extend((0..).zip(near).map(|(site, &i)| Power { site, ..self.sites[i as usize] }));
        contenders(&self.near, &block.bounds, f64::INFINITY, &mut self.powers, &mut self.of_block);
        self.variety = variety(&self.of_block);
        for clump in &layout.clumps[block.clumps.clone()] {
            self.clump(clump, owners);
        }
    }

    fn clump(&mut self, clump: &Clump, owners: &mut impl Owners) {
        contenders(&self.of_block, &clump.bounds, self.variety, &mut self.powers, &mut self.of_clump);
        if let [only] = &self.of_clump[..] {
            owners.whole(only.site, clump.tiles.clone(), clump.mass, clump.moment);
            return;
        }
        let layout = self.layout;
        for index in clump.tiles.clone() {
            self.tile(index, &layout.tiles[index as usize], owners);
        }
    }

    fn tile(&mut self, index: u32, tile: &Tile, owners: &mut impl Owners) {
        let [corners, normals] = [tile.corners, tile.normals];
        self.of_tile.clear();
        let mut least = [f64::INFINITY; 3];
        let mut owner = [0; 3];
        for (k, power) in self.of_clump.iter().enumerate() {
            let powers = [0, 1, 2].map(|c| power.at(corners[c], normals[c]));
            for c in 0..3 {
                if powers[c] < least[c] {
                    least[c] = powers[c];
                    owner[c] = k;
                }
            }
            self.of_tile.push((powers, power.site));
        }
        // A cell is convex, so a site that owns the three corners owns the tile.
        if owner[0] == owner[1] && owner[1] == owner[2] {
            let moment = Place { position: tile.centre() * tile.mass, normal: tile.normal() * tile.mass };
            owners.whole(self.of_tile[owner[0]].1, index..index + 1, tile.mass, moment);
            return;
        }
        clip::prune(&mut self.of_tile);
        let (ab, ac) = (corners[1] - corners[0], corners[2] - corners[0]);
        let cross = ab.cross(ac);
        let doubled = cross.length();
        let normal = cross / doubled;
        // Gradients of the two coordinates along the sides.
        let (across_u, across_v) = (ac.cross(normal) / doubled, normal.cross(ab) / doubled);
        for k in 0..self.of_tile.len() {
            if !clip::cell(&self.of_tile, k, &mut self.polygon, &mut self.spare) {
                continue;
            }
            let (share, u, v) = clip::measure(&self.polygon);
            if share <= 0.0 {
                continue;
            }
            let mass = tile.mass * share;
            let [na, nb, nc] = normals;
            let moment = Place {
                position: (corners[0] + ab * u + ac * v) * mass,
                normal: (na + (nb - na) * u + (nc - na) * v) * mass,
            };
            let (own, site) = self.of_tile[k];
            owners.part(site, index, mass, moment, &self.polygon);
            for e in 0..self.polygon.len() {
                let (p, q) = (self.polygon[e], self.polygon[(e + 1) % self.polygon.len()]);
                let Some((theirs, other)) = p.behind.filter(|&o| o > k).map(|o| self.of_tile[o]) else {
                    continue;
                };
                let length = (ab * (q.u - p.u) + ac * (q.v - p.v)).length();
                // How fast the difference of the two powers changes along the surface, across the border.
                let lead = [0, 1, 2].map(|c| theirs[c] - own[c]);
                let slope = (across_u * (lead[1] - lead[0]) + across_v * (lead[2] - lead[0])).length();
                if slope > 0.0 {
                    owners.border([site, other], length / slope * (2.0 * tile.mass / doubled));
                }
            }
        }
    }
}

/// At least the largest difference of two slopes.
fn variety(powers: &[Power]) -> f64 {
    let first = powers[0].slope;
    let far = powers.iter().map(|p| p.slope.minus(&first).length()).fold(0.0, f64::max);
    2.0 * far
}

/// Of some sites those that may own a place within the bounds; never none. No two of their slopes differ by more
/// than `variety`.
fn contenders(all: &[Power], bounds: &Bounds, variety: f64, powers: &mut Vec<f64>, left: &mut Vec<Power>) {
    left.clear();
    powers.clear();
    let Bounds { middle, half, radius } = bounds;
    let mut best = 0;
    for (k, power) in all.iter().enumerate() {
        powers.push(power.at(middle.position, middle.normal));
        if powers[k] < powers[best] {
            best = k;
        }
    }
    let most = radius * variety;
    for (power, value) in all.iter().zip(&*powers) {
        let lead = value - powers[best];
        if lead > most {
            continue;
        }
        // So much the lead of the best changes at most within the bounds.
        let slope = power.slope.minus(&all[best].slope);
        if lead <= slope.position.abs().dot(half.position) + slope.normal.abs().dot(half.normal) {
            left.push(*power);
        }
    }
}
