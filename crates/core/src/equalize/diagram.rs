//! The power diagram of the sites on the surface, exact on every tile.
//!
//! On a tile the power of each site is a square plus a part that is affine, so cells are convex polygons: the tile
//! clipped by bisectors. Restricted power diagrams: Yan et al. 2009, DOI 10.1111/j.1467-8659.2009.01521.x; capacities
//! by weights: Aurenhammer, Hoffmann, Aronov 1998, DOI 10.1007/PL00009187.
//!
//! The powers are computed once for every corner of a block; a tile whose three corners have the same owner is owned as
//! a whole, and most of the others are cut by one line.

use super::clip::{self, Powers};
use super::layout::{Bounds, Layout, Place};
use super::near::{Near, Site};
use super::tiles::Tile;
use crate::parallel;

/// How many blocks are worked on together; fixed, so that sums come out the same with any number of threads.
const CHUNK: usize = 32;

/// Goes through all blocks and gives back what was heard, chunk by chunk.
pub(super) fn walk<O: Owners + Send>(
    layout: &Layout,
    near: &Near,
    sites: &[Site],
    new: impl Fn() -> O + Sync + Send,
) -> Vec<O> {
    let powers: Vec<Power> = parallel::map(sites.len(), |i| Power::new(i as u32, &sites[i]));
    parallel::map_chunks(layout.blocks.len(), CHUNK, |range| {
        let mut walk = Walk::new(layout, &powers);
        let mut owners = new();
        for block in range {
            walk.block(block, near.of_block(block), &mut owners);
        }
        owners
    })
}

/// Hears which site owns what. Sites are named by their place among the contenders of a block.
pub(super) trait Owners {
    /// Whether parts are wanted as polygons; without them cuts by one line are faster.
    const POLYGONS: bool;

    /// A block begins.
    fn begin(&mut self, contenders: &[Power]);
    /// A tile has one owner.
    fn whole(&mut self, site: usize, tile: usize, mass: f64);
    /// Part of a tile; a polygon if those are wanted.
    fn part(&mut self, site: usize, tile: usize, mass: f64, polygon: &[clip::Corner]);
    /// Mass times mean place of something that a site owns.
    fn moment(&mut self, site: usize, moment: Place);
    /// Two sites share a border.
    fn border(&mut self, sites: [usize; 2], flow: f64);
    /// The block ends.
    fn end(&mut self, contenders: &[Power]);
}

/// A site as an affine function: its power less the square of the place, which is the same for all sites.
#[derive(Clone, Copy)]
pub(super) struct Power {
    pub(super) site: u32,
    constant: f64,
    /// Minus twice its place.
    slope: Place,
}

impl Power {
    fn new(id: u32, site: &Site) -> Self {
        let Place { position, normal } = site.place;
        let constant = position.length_squared() + normal.length_squared() - site.weight;
        Self { site: id, constant, slope: Place { position: position * -2.0, normal: normal * -2.0 } }
    }

    #[inline]
    fn at(&self, place: &Place) -> f64 {
        self.constant + self.slope.position.dot(place.position) + self.slope.normal.dot(place.normal)
    }

    /// Its values at many places.
    #[inline]
    fn at_all(&self, [x, y, z, u, v, w]: [&[f64]; 6], powers: &mut [f64]) {
        let count = powers.len();
        let (x, y, z, u, v, w) =
            (&x[..count], &y[..count], &z[..count], &u[..count], &v[..count], &w[..count]);
        let Place { position: p, normal: n } = self.slope;
        for i in 0..count {
            powers[i] = (self.constant + p.x * x[i] + p.y * y[i])
                + (p.z * z[i] + n.x * u[i])
                + (n.y * v[i] + n.z * w[i]);
        }
    }
}

/// Goes through blocks and tiles and drops on the way the sites that own nothing there.
struct Walk<'a> {
    layout: &'a Layout,
    sites: &'a [Power],
    near: Vec<Power>,
    contenders: Vec<Power>,
    /// The powers of all near sites in the middle of the block, then of the contenders at its corners, site by site.
    powers: Vec<f64>,
    /// For each corner the least power and whose that is.
    least: Vec<f64>,
    owner: Vec<u32>,
    /// For each corner how much mass of whole tiles it stands for.
    weights: Vec<f64>,
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
            contenders: Vec::new(),
            powers: Vec::new(),
            least: Vec::new(),
            owner: Vec::new(),
            weights: Vec::new(),
            of_tile: Vec::new(),
            polygon: Vec::new(),
            spare: Vec::new(),
        }
    }

    fn block(&mut self, block: usize, near: &[u32], owners: &mut impl Owners) {
        let layout = self.layout;
        let block = &layout.blocks[block];
        self.near.clear();
        self.near.extend(near.iter().map(|&i| self.sites[i as usize]));
        contenders(&self.near, &block.bounds, &mut self.powers, &mut self.contenders);
        owners.begin(&self.contenders);
        let corners = layout.places.of(&block.places);
        let count = block.places.len();
        self.least.clear();
        self.least.resize(count, f64::INFINITY);
        self.owner.clear();
        self.owner.resize(count, 0);
        self.weights.clear();
        self.weights.resize(count, 0.0);
        self.powers.clear();
        self.powers.resize(count * self.contenders.len(), 0.0);
        for ((k, power), row) in (0..).zip(&self.contenders).zip(self.powers.chunks_exact_mut(count)) {
            power.at_all(corners, row);
            for ((value, least), owner) in row.iter().zip(&mut self.least).zip(&mut self.owner) {
                let less = value < least;
                *least = if less { *value } else { *least };
                *owner = if less { k } else { *owner };
            }
        }
        for index in block.tiles.clone() {
            let tile = &layout.tiles[index];
            let at = tile.corners.map(|id| id as usize - block.places.start);
            let [a, b, c] = at.map(|i| self.owner[i]);
            // A cell is convex, so a site that owns the three corners owns the tile.
            if a == b && b == c {
                owners.whole(a as usize, index, tile.mass);
                for i in at {
                    self.weights[i] += tile.mass / 3.0;
                }
            } else {
                self.tile(index, tile, at, owners);
            }
        }
        for (i, &weight) in self.weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let place = layout.places.at((block.places.start + i) as u32);
            owners.moment(self.owner[i] as usize, times(&place, weight));
        }
        owners.end(&self.contenders);
    }

    /// A tile with several owners; `at` says where its corners are in the block.
    fn tile<O: Owners>(&mut self, index: usize, tile: &Tile, at: [usize; 3], owners: &mut O) {
        let count = self.owner.len();
        let first = at.map(|i| self.owner[i] as usize);
        let powers_of = |k: usize| at.map(|i| self.powers[k * count + i]);
        let leaders = first.map(powers_of);
        self.of_tile.clear();
        for k in 0..self.contenders.len() {
            let powers = powers_of(k);
            // Most are beaten at all corners by an owner of one.
            let beaten = leaders.iter().any(|leader| (0..3).all(|c| leader[c] < powers[c]));
            if !beaten {
                self.of_tile.push((powers, k));
            }
        }
        clip::prune(&mut self.of_tile);
        let corners = tile.corners.map(|id| self.layout.places.at(id));
        // What a site owns: its share, that times the mean barycentric coordinates, and its polygon.
        let give = |owners: &mut O, site, share: f64, weights: [f64; 3], polygon: &[clip::Corner]| {
            owners.part(site, index, tile.mass * share, polygon);
            let [a, b, c] = weights.map(|weight| weight * tile.mass);
            owners.moment(
                site,
                Place {
                    position: corners[0].position * a + corners[1].position * b + corners[2].position * c,
                    normal: corners[0].normal * a + corners[1].normal * b + corners[2].normal * c,
                },
            );
        };
        if let [(own, k), (theirs, l)] = self.of_tile[..]
            && !O::POLYGONS
        {
            let halves = clip::halves(&own, &theirs);
            for (site, share, weights) in
                [(k, halves.share, halves.weights), (l, 1.0 - halves.share, halves.rest())]
            {
                if share > 0.0 {
                    give(owners, site, share, weights, &[]);
                }
            }
            owners.border([k, l], 2.0 * tile.mass * halves.length);
            return;
        }
        for k in 0..self.of_tile.len() {
            if !clip::cell(&self.of_tile, k, &mut self.polygon, &mut self.spare) {
                continue;
            }
            let (share, u, v) = clip::measure(&self.polygon);
            if share <= 0.0 {
                continue;
            }
            let (own, site) = self.of_tile[k];
            give(owners, site, share, [(1.0 - u - v) * share, u * share, v * share], &self.polygon);
            for e in 0..self.polygon.len() {
                let (p, q) = (self.polygon[e], self.polygon[(e + 1) % self.polygon.len()]);
                if let Some((theirs, other)) = p.behind.filter(|&o| o > k).map(|o| self.of_tile[o]) {
                    let length = clip::border_length(&own, &theirs, &p, &q);
                    owners.border([site, other], 2.0 * tile.mass * length);
                }
            }
        }
    }
}

fn times(place: &Place, factor: f64) -> Place {
    Place { position: place.position * factor, normal: place.normal * factor }
}

/// Of some sites those that may own a place within the bounds; never none.
fn contenders(all: &[Power], bounds: &Bounds, powers: &mut Vec<f64>, left: &mut Vec<Power>) {
    left.clear();
    powers.clear();
    let Bounds { middle, half } = bounds;
    let mut best = 0;
    for (k, power) in all.iter().enumerate() {
        powers.push(power.at(middle));
        if powers[k] < powers[best] {
            best = k;
        }
    }
    for (power, value) in all.iter().zip(&*powers) {
        // So much the lead of the best changes at most within the bounds.
        let slope = power.slope.minus(&all[best].slope);
        let change = slope.position.abs().dot(half.position) + slope.normal.abs().dot(half.normal);
        if value - powers[best] <= change {
            left.push(*power);
        }
    }
}
