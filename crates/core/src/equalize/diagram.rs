//! The power diagram of the sites on the surface, exact on every tile.
//!
//! On a tile the power of each site is a square plus a part that is affine, so cells are convex polygons: the tile
//! clipped by bisectors. Restricted power diagrams: Yan et al. 2009, DOI 10.1111/j.1467-8659.2009.01521.x; capacities
//! by weights: Aurenhammer, Hoffmann, Aronov 1998, DOI 10.1007/PL00009187.
//!
//! The powers are computed once for every corner of a block; a tile whose three corners have the same owner is owned as
//! a whole, and most of the others are cut by one line.

use super::clip::{self, Powers};
use super::layout::{Block, Bounds, Layout, Place};
use super::near::{Near, Site};
use super::tiles::Tile;
use crate::parallel;

/// Goes through all blocks and gives back what was heard, chunk by chunk.
pub(super) fn walk<O: Owners + Send>(
    layout: &Layout,
    near: &Near,
    sites: &[Site],
    new: impl Fn() -> O + Sync + Send,
) -> Vec<O> {
    go_through(layout, near, sites, layout.blocks.len(), |block| block, new)
}

/// As [`walk`], through some of the blocks.
pub(super) fn walk_some<O: Owners + Send>(
    layout: &Layout,
    near: &Near,
    sites: &[Site],
    blocks: &[u32],
    new: impl Fn() -> O + Sync + Send,
) -> Vec<O> {
    go_through(layout, near, sites, blocks.len(), |i| blocks[i] as usize, new)
}

fn go_through<O: Owners + Send>(
    layout: &Layout,
    near: &Near,
    sites: &[Site],
    count: usize,
    block: impl Fn(usize) -> usize + Sync + Send,
    new: impl Fn() -> O + Sync + Send,
) -> Vec<O> {
    let powers: Vec<Power> = parallel::map(sites.len(), |i| Power::new(i as u32, &sites[i]));
    // Enough pieces for many cores, and not so small that starting them shows.
    let chunk = (count / 64).clamp(8, 128);
    parallel::map_chunks(count, chunk, |range| {
        let mut walk = Walk::new(layout, &powers);
        let mut owners = new();
        for block in range.map(&block) {
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
    /// Part of a tile, with its centroid along the tile's two sides; a polygon if those are wanted.
    fn part(&mut self, site: usize, tile: usize, mass: f64, centroid: [f64; 2], polygon: &[clip::Corner]);
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
    contenders: Vec<Power>,
    /// The powers of all near sites in the middle of the block, then of the contenders at its corners, site by site.
    powers: Vec<f64>,
    /// For each corner the least power and whose that is.
    least: Vec<f64>,
    owner: Vec<u32>,
    /// For each corner how much mass of whole tiles it stands for.
    weights: Vec<f64>,
    /// Which contenders may own a part of a tile, and with what powers.
    left: Vec<usize>,
    of_tile: Vec<(Powers, usize)>,
    polygon: Vec<clip::Corner>,
    spare: Vec<clip::Corner>,
}

impl<'a> Walk<'a> {
    fn new(layout: &'a Layout, sites: &'a [Power]) -> Self {
        Self {
            layout,
            sites,
            contenders: Vec::new(),
            powers: Vec::new(),
            least: Vec::new(),
            owner: Vec::new(),
            weights: Vec::new(),
            left: Vec::new(),
            of_tile: Vec::new(),
            polygon: Vec::new(),
            spare: Vec::new(),
        }
    }

    fn block(&mut self, block: usize, near: &[u32], owners: &mut impl Owners) {
        let layout = self.layout;
        let block = &layout.blocks[block];
        contenders(self.sites, near, &block.bounds, &mut self.powers, &mut self.contenders);
        self.powers_at_corners(block);
        owners.begin(&self.contenders);
        for index in block.tiles.clone() {
            let tile = &layout.tiles[index];
            let at = tile.corners.map(|id| id as usize - block.places.start);
            let (a, b, c) = (self.owner[at[0]], self.owner[at[1]], self.owner[at[2]]);
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

    /// The powers of the contenders at the corners of a block, and who leads there. Drops contenders that the first one
    /// beats at all of them: tiles lie between corners, so those own nothing.
    fn powers_at_corners(&mut self, block: &Block) {
        let corners = self.layout.places.of(&block.places);
        let count = block.places.len();
        self.powers.clear();
        self.powers.resize(count * self.contenders.len(), 0.0);
        let (first, rows) = self.powers.split_at_mut(count);
        self.contenders[0].at_all(corners, first);
        self.least.clear();
        self.least.extend_from_slice(first);
        self.owner.clear();
        self.owner.resize(count, 0);
        let mut kept = 1;
        for k in 1..self.contenders.len() {
            let power = self.contenders[k];
            let row = &mut rows[(kept - 1) * count..kept * count];
            power.at_all(corners, row);
            let ahead = row.iter().zip(&*first).fold(false, |any, (value, first)| any | (value <= first));
            if !ahead {
                continue;
            }
            for ((value, least), owner) in row.iter().zip(&mut self.least).zip(&mut self.owner) {
                let less = value < least;
                *least = if less { *value } else { *least };
                *owner = if less { kept as u32 } else { *owner };
            }
            self.contenders[kept] = power;
            kept += 1;
        }
        self.contenders.truncate(kept);
        self.weights.clear();
        self.weights.resize(count, 0.0);
    }

    /// A tile with several owners; `at` says where its corners are in the block.
    fn tile<O: Owners>(&mut self, index: usize, tile: &Tile, at: [usize; 3], owners: &mut O) {
        let count = self.owner.len();
        let powers = &self.powers;
        let powers_of = |k: usize| {
            let row = &powers[k * count..(k + 1) * count];
            [row[at[0]], row[at[1]], row[at[2]]]
        };
        let leader_of = |c: usize| powers_of(self.owner[at[c]] as usize);
        let leaders = [leader_of(0), leader_of(1), leader_of(2)];
        // Most are beaten at all corners by an owner of one; no branches, as nobody can guess which.
        self.left.resize(self.contenders.len(), 0);
        let mut left = 0;
        for k in 0..self.contenders.len() {
            let powers = powers_of(k);
            let beats =
                |leader: &Powers| (leader[0] < powers[0]) & (leader[1] < powers[1]) & (leader[2] < powers[2]);
            self.left[left] = k;
            left += usize::from(!(beats(&leaders[0]) | beats(&leaders[1]) | beats(&leaders[2])));
        }
        self.of_tile.clear();
        self.of_tile.extend(self.left[..left].iter().map(|&k| (powers_of(k), k)));
        clip::prune(&mut self.of_tile);
        let [a, b, c] = tile.corners;
        let corners = [self.layout.places.at(a), self.layout.places.at(b), self.layout.places.at(c)];
        // What a site owns: its share, that times the mean barycentric coordinates, and its polygon.
        let give = |owners: &mut O, site, share: f64, weights: [f64; 3], polygon: &[clip::Corner]| {
            owners.part(site, index, tile.mass * share, [weights[1] / share, weights[2] / share], polygon);
            let [a, b, c] = [weights[0] * tile.mass, weights[1] * tile.mass, weights[2] * tile.mass];
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
        // The last one owns what the others leave.
        let last = self.of_tile.len() - 1;
        let others = if O::POLYGONS { last + 1 } else { last };
        let (mut rest, mut rest_weights) = (1.0, [1.0 / 3.0; 3]);
        for k in 0..others {
            if !clip::cell(&self.of_tile, k, &mut self.polygon, &mut self.spare) {
                continue;
            }
            let (share, u, v) = clip::measure(&self.polygon);
            if share <= 0.0 {
                continue;
            }
            let (own, site) = self.of_tile[k];
            let weights = [(1.0 - u - v) * share, u * share, v * share];
            rest -= share;
            (0..3).for_each(|c| rest_weights[c] -= weights[c]);
            give(owners, site, share, weights, &self.polygon);
            for e in 0..self.polygon.len() {
                let (p, q) = (self.polygon[e], self.polygon[(e + 1) % self.polygon.len()]);
                if let Some((theirs, other)) = p.behind.filter(|&o| o > k).map(|o| self.of_tile[o]) {
                    let length = clip::border_length(&own, &theirs, &p, &q);
                    owners.border([site, other], 2.0 * tile.mass * length);
                }
            }
        }
        if !O::POLYGONS && rest > NOTHING {
            give(owners, self.of_tile[last].1, rest, rest_weights, &[]);
        }
    }
}

/// Smaller shares of a tile are rounding errors.
const NOTHING: f64 = 1e-12;

fn times(place: &Place, factor: f64) -> Place {
    Place { position: place.position * factor, normal: place.normal * factor }
}

/// Of some sites those that may own a place within the bounds, the one that leads in the middle first. `powers` is
/// scratch.
fn contenders(sites: &[Power], near: &[u32], bounds: &Bounds, powers: &mut Vec<f64>, left: &mut Vec<Power>) {
    left.clear();
    powers.clear();
    let Bounds { middle, half } = bounds;
    powers.extend(near.iter().map(|&i| sites[i as usize].at(middle)));
    let best = (1..near.len()).fold(0, |best, k| if powers[k] < powers[best] { k } else { best });
    let first = sites[near[best] as usize];
    left.push(first);
    for (k, &i) in near.iter().enumerate().filter(|(k, _)| *k != best) {
        let power = &sites[i as usize];
        // So much the lead of the best changes at most within the bounds.
        let slope = power.slope.minus(&first.slope);
        let change = slope.position.abs().dot(half.position) + slope.normal.abs().dot(half.normal);
        if powers[k] - powers[best] <= change {
            left.push(*power);
        }
    }
}
