//! The points as sites of a power diagram, and which of them can own a part of which block.

use glam::DVec3;

use super::layout::{Bounds, Layout, Place};
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
}

/// Sites are near a block when they are within this many distances of the points of its bounds: no cell reaches
/// farther once points are balanced.
const REACH: f64 = 1.2;

/// So many distances of the points may a site move before it could be missing somewhere.
pub(super) const SLACK: f64 = 0.4;

impl Near {
    pub(super) fn of_block(&self, block: usize) -> &[u32] {
        let start = if block == 0 { 0 } else { self.ends[block - 1] as usize };
        &self.sites[start..self.ends[block] as usize]
    }

    /// Finds the sites near each block. Whatever is missing, every block has a site, so no mass is lost.
    ///
    /// The sites lie in the order of the blocks, so runs of them have small bounds.
    pub(super) fn find(layout: &Layout, sites: &[Site]) -> Self {
        const CHUNK: usize = 64;
        let places: Vec<DVec3> = sites.iter().map(|s| s.place.position).collect();
        let runs = Runs::new(&places);
        let pieces = parallel::map_chunks(layout.blocks.len(), CHUNK, |range| {
            let mut counts = Vec::with_capacity(range.len());
            let mut found = Vec::new();
            for block in &layout.blocks[range] {
                let before = found.len();
                let Bounds { middle, half } = block.bounds;
                let mut reach = half.position.length() + (REACH + SLACK) * block.distance;
                // Every patch with blocks has a site, so this ends.
                while found.len() == before {
                    runs.within(middle.position, reach, |i| sites[i].patch == block.patch, &mut found);
                    reach *= 2.0;
                }
                counts.push((found.len() - before) as u32);
            }
            (counts, found)
        });
        let mut ends = Vec::with_capacity(layout.blocks.len());
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

/// The bounds of runs of places, of runs of runs, and so on.
pub(super) struct Runs<'a> {
    places: &'a [DVec3],
    /// From single runs of places up to a level of at most `FAN`.
    levels: Vec<Vec<(DVec3, DVec3)>>,
}

/// How many make a run.
const FAN: usize = 8;

impl<'a> Runs<'a> {
    pub(super) fn new(places: &'a [DVec3]) -> Self {
        let join = |(low, high): (DVec3, DVec3), (l, h): (DVec3, DVec3)| (low.min(l), high.max(h));
        let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut levels: Vec<Vec<(DVec3, DVec3)>> = Vec::new();
        levels.push(places.chunks(FAN).map(|run| run.iter().map(|&p| (p, p)).fold(nothing, join)).collect());
        while let Some(last) = levels.last()
            && last.len() > FAN
        {
            levels.push(last.chunks(FAN).map(|run| run.iter().copied().fold(nothing, join)).collect());
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
        let top = self.levels.len() - 1;
        for run in 0..self.levels[top].len() {
            self.descend(top, run, (centre, reach * reach), &keep, found);
        }
    }

    fn descend(
        &self,
        level: usize,
        run: usize,
        ball: (DVec3, f64),
        keep: &impl Fn(usize) -> bool,
        found: &mut Vec<u32>,
    ) {
        let (low, high) = self.levels[level][run];
        let (centre, squared) = ball;
        if centre.distance_squared(centre.clamp(low, high)) > squared {
            return;
        }
        let first = run * FAN;
        if level > 0 {
            for child in first..(first + FAN).min(self.levels[level - 1].len()) {
                self.descend(level - 1, child, ball, keep, found);
            }
            return;
        }
        for i in first..(first + FAN).min(self.places.len()) {
            if keep(i) && self.places[i].distance_squared(centre) <= squared {
                found.push(i as u32);
            }
        }
    }
}
