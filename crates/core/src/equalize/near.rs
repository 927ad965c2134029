//! The points as sites of a power diagram, and which of them can own a part of which block.

use glam::DVec3;

use super::layout::{Block, Bounds, Layout, Place};
use crate::parallel;

/// A site of the power diagram: the power of a place is its squared distance, in position and scaled normal, less
/// the weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) place: Place,
    pub(super) weight: f64,
    pub(super) patch: u32,
    /// The distance of the points here.
    pub(super) distance: f64,
}

/// For each block the sites that may own a part of it, ascending.
pub(super) struct Near {
    ends: Vec<u32>,
    sites: Vec<u32>,
    /// Where each site was when it was listed.
    listed: Vec<DVec3>,
}

/// Sites are near a block when they are within this many distances of the points of its bounds: no cell reaches
/// farther once points are balanced.
const REACH: f64 = 1.2;

/// So many distances of the points may a site move before it could be missing somewhere.
const SLACK: f64 = 0.4;

/// If more than one of so many sites has moved farther, all are listed anew.
const STRAYS: usize = 4;

/// How far from the bounds of a block a site may be to be near it.
fn reach(block: &Block) -> f64 {
    (REACH + SLACK) * block.distance
}

/// The ball in which the sites near a block are sought.
fn ball(block: &Block) -> (DVec3, f64) {
    let Bounds { middle, half } = block.bounds;
    (middle.position, half.position.length() + reach(block))
}

/// The box outside of which no site is near any of some blocks.
fn around(blocks: &[Block]) -> Corners {
    blocks.iter().map(|block| block.bounds.widened(reach(block))).fold(NOTHING, join)
}

impl Near {
    pub(super) fn of_block(&self, block: usize) -> &[u32] {
        let start = if block == 0 { 0 } else { self.ends[block - 1] as usize };
        &self.sites[start..self.ends[block] as usize]
    }

    /// Finds the sites near each block. Whatever is missing, every block has a site, so no mass is lost.
    ///
    /// The sites lie in the order of the blocks, so runs of them have small bounds.
    pub(super) fn find(layout: &Layout, sites: &[Site]) -> Self {
        /// Blocks that follow each other lie together, so many look at the same runs.
        const CHUNK: usize = 16;
        let listed: Vec<DVec3> = sites.iter().map(|s| s.place.position).collect();
        let runs = Runs::new(&listed);
        let pieces = parallel::map_chunks(layout.blocks.len(), CHUNK, |range| {
            let blocks = &layout.blocks[range];
            let mut close = Vec::new();
            runs.leaves(around(blocks), &mut close);
            let mut ends = Vec::with_capacity(blocks.len());
            let mut found = Vec::with_capacity(32 * blocks.len());
            for block in blocks {
                let before = found.len();
                let mut ball = ball(block);
                let is_own = |i: usize| sites[i].patch == block.patch;
                close.iter().for_each(|&leaf| runs.in_leaf(leaf, ball, &is_own, &mut found));
                // Every patch with blocks has a site, so this ends.
                while found.len() == before {
                    ball.1 *= 2.0;
                    runs.within(ball.0, ball.1, is_own, &mut found);
                }
                ends.push(found.len() as u32);
            }
            (ends, found)
        });
        Self::joined(pieces, listed)
    }

    /// Puts lists of runs of blocks together; ends count from the start of the run.
    fn joined(pieces: Vec<(Vec<u32>, Vec<u32>)>, listed: Vec<DVec3>) -> Self {
        let (blocks, count) =
            pieces.iter().fold((0, 0), |(b, c), (ends, found)| (b + ends.len(), c + found.len()));
        let (mut ends, mut sites) = (Vec::with_capacity(blocks), Vec::with_capacity(count));
        for (piece, found) in pieces {
            let before = sites.len() as u32;
            ends.extend(piece.into_iter().map(|end| before + end));
            sites.extend(found);
        }
        Self { ends, sites, listed }
    }

    /// Lists the sites that have moved so far that they could be missing somewhere.
    pub(super) fn follow(&mut self, layout: &Layout, sites: &[Site]) {
        let moved = |i: usize| sites[i].place.position.distance(self.listed[i]);
        let strays: Vec<u32> = (0..)
            .zip(sites)
            .filter(|&(i, site)| moved(i as usize) > SLACK * site.distance)
            .map(|(i, _)| i)
            .collect();
        if strays.is_empty() {
            return;
        }
        if strays.len() * STRAYS > sites.len() {
            *self = Self::find(layout, sites);
            return;
        }
        let places: Vec<DVec3> = strays.iter().map(|&i| sites[i as usize].place.position).collect();
        let runs = Runs::new(&places);
        const CHUNK: usize = 64;
        let pieces = parallel::map_chunks(layout.blocks.len(), CHUNK, |range| {
            let mut close = Vec::new();
            runs.leaves(around(&layout.blocks[range.clone()]), &mut close);
            let (mut ends, mut all, mut found) = (Vec::with_capacity(range.len()), Vec::new(), Vec::new());
            for i in range {
                let block = &layout.blocks[i];
                let own = self.of_block(i);
                let is_new = |k: usize| {
                    sites[strays[k] as usize].patch == block.patch && own.binary_search(&strays[k]).is_err()
                };
                found.clear();
                close.iter().for_each(|&leaf| runs.in_leaf(leaf, ball(block), &is_new, &mut found));
                let start = all.len();
                all.extend_from_slice(own);
                all.extend(found.iter().map(|&k| strays[k as usize]));
                if !found.is_empty() {
                    all[start..].sort_unstable();
                }
                ends.push(all.len() as u32);
            }
            (ends, all)
        });
        let mut listed = std::mem::take(&mut self.listed);
        for (&i, place) in strays.iter().zip(places) {
            listed[i as usize] = place;
        }
        *self = Self::joined(pieces, listed);
    }
}

/// The bounds of runs of places, of runs of runs, and so on.
pub(super) struct Runs<'a> {
    places: &'a [DVec3],
    /// From single runs of places up to a level of at most `FAN`.
    levels: Vec<Vec<Corners>>,
}

/// How many make a run.
const FAN: usize = 8;

/// A box: its lowest and its highest corner.
type Corners = (DVec3, DVec3);

/// The box of nothing.
const NOTHING: Corners = (DVec3::INFINITY, DVec3::NEG_INFINITY);

fn join((low, high): Corners, (l, h): Corners) -> Corners {
    (low.min(l), high.max(h))
}

impl<'a> Runs<'a> {
    pub(super) fn new(places: &'a [DVec3]) -> Self {
        let mut levels: Vec<Vec<Corners>> = Vec::new();
        levels.push(places.chunks(FAN).map(|run| run.iter().map(|&p| (p, p)).fold(NOTHING, join)).collect());
        while let Some(last) = levels.last()
            && last.len() > FAN
        {
            levels.push(last.chunks(FAN).map(|run| run.iter().copied().fold(NOTHING, join)).collect());
        }
        Self { places, levels }
    }

    /// Adds the places within `reach` of `centre` that `keep` lets through, ascending.
    pub(super) fn within(
        &self,
        centre: DVec3,
        reach: f64,
        keep: impl Fn(usize) -> bool,
        found: &mut Vec<u32>,
    ) {
        let squared = reach * reach;
        let near = |(low, high): Corners| centre.distance_squared(centre.clamp(low, high)) <= squared;
        self.descend(&near, &mut |leaf| self.in_leaf(leaf, (centre, reach), &keep, found));
    }

    /// Adds the runs of places that may hold some of a box, ascending.
    fn leaves(&self, (low, high): Corners, found: &mut Vec<u32>) {
        let near = |(l, h): Corners| l.cmple(high).all() && h.cmpge(low).all();
        self.descend(&near, &mut |leaf| found.push(leaf));
    }

    /// As [`Self::within`], for a run of places.
    fn in_leaf(&self, leaf: u32, ball: (DVec3, f64), keep: &impl Fn(usize) -> bool, found: &mut Vec<u32>) {
        let (centre, squared) = (ball.0, ball.1 * ball.1);
        let (low, high) = self.levels[0][leaf as usize];
        if centre.distance_squared(centre.clamp(low, high)) > squared {
            return;
        }
        let first = leaf as usize * FAN;
        for (i, place) in (first..).zip(&self.places[first..(first + FAN).min(self.places.len())]) {
            if place.distance_squared(centre) <= squared && keep(i) {
                found.push(i as u32);
            }
        }
    }

    /// Visits the runs of places whose box, and those of the runs above, are `near`, ascending.
    fn descend(&self, near: &impl Fn(Corners) -> bool, visit: &mut impl FnMut(u32)) {
        let top = self.levels.len() - 1;
        for run in 0..self.levels[top].len() {
            self.below(top, run, near, visit);
        }
    }

    fn below(&self, level: usize, run: usize, near: &impl Fn(Corners) -> bool, visit: &mut impl FnMut(u32)) {
        if !near(self.levels[level][run]) {
            return;
        }
        if level == 0 {
            visit(run as u32);
            return;
        }
        let first = run * FAN;
        for child in first..(first + FAN).min(self.levels[level - 1].len()) {
            self.below(level - 1, child, near, visit);
        }
    }
}
