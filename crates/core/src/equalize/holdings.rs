//! What each site owns, tile by tile, when the cells are settled.

use glam::DVec3;

use super::clip;
use super::diagram::{Owners, Power, walk};
use super::layout::{Layout, Place};
use super::near::{Near, Site};
use super::owners::Cell;

/// A tile of which a site owns some mass.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Holding {
    pub(super) tile: u32,
    /// Where the centroid of that mass lies along the tile's two sides, in shares of [`FINEST`].
    centroid: [u16; 2],
    pub(super) mass: f64,
}

/// As fine as small numbers are: there are as many holdings as tiles.
const FINEST: f64 = u16::MAX as f64;

impl Holding {
    /// Rounding can put the centroid of next to nothing outside the tile; it is taken back to its border.
    fn new(tile: usize, centroid: [f64; 2], mass: f64) -> Self {
        Self { tile: tile as u32, centroid: centroid.map(|x| (x * FINEST + 0.5) as u16), mass }
    }

    /// The centroid of what is owned.
    pub(super) fn centroid(&self, layout: &Layout) -> DVec3 {
        let [a, b, c] = layout.corners(&layout.tiles[self.tile as usize]);
        let [u, v] = self.centroid.map(|x| f64::from(x) / FINEST);
        a + (b - a) * u + (c - a) * v
    }
}

/// What all sites own.
pub(super) struct Holdings {
    ends: Vec<u32>,
    all: Vec<Holding>,
}

/// The cells of all sites and what they are made of. Linear in the tiles times the sites near them.
pub(super) fn holdings(layout: &Layout, near: &Near, sites: &[Site]) -> (Vec<Cell>, Holdings) {
    let pieces = walk(layout, near, sites, Lists::default);
    let mut cells = vec![Cell::default(); sites.len()];
    // Counting sort by site; the tiles of a site keep their order.
    let mut ends = vec![0u32; sites.len() + 1];
    for piece in &pieces {
        for (site, holding) in &piece.all {
            cells[*site as usize].mass += holding.mass;
            ends[*site as usize + 1] += 1;
        }
        piece.moments.iter().for_each(|(site, moment)| cells[*site as usize].add(*moment));
    }
    for site in 0..sites.len() {
        ends[site + 1] += ends[site];
    }
    let mut all = vec![Holding::default(); ends[sites.len()] as usize];
    // By value: what was put in order is given back.
    for (site, holding) in pieces.into_iter().flat_map(|piece| piece.all) {
        let slot = &mut ends[site as usize];
        all[*slot as usize] = holding;
        *slot += 1;
    }
    // Each start went up to the end.
    ends.pop();
    (cells, Holdings { ends, all })
}

impl Holdings {
    pub(super) fn of(&self, site: usize) -> &[Holding] {
        let start = if site == 0 { 0 } else { self.ends[site - 1] as usize };
        &self.all[start..self.ends[site] as usize]
    }
}

#[derive(Default)]
struct Lists {
    sites: Vec<u32>,
    all: Vec<(u32, Holding)>,
    /// Sums of the block.
    of_block: Vec<Place>,
    moments: Vec<(u32, Place)>,
}

impl Owners for Lists {
    const POLYGONS: bool = false;

    fn begin(&mut self, contenders: &[Power]) {
        self.sites.clear();
        self.sites.extend(contenders.iter().map(|power| power.site));
        self.of_block.clear();
        self.of_block.resize(contenders.len(), Place::default());
    }

    fn whole(&mut self, site: usize, tile: usize, mass: f64) {
        self.part(site, tile, mass, [1.0 / 3.0; 2], &[]);
    }

    fn part(&mut self, site: usize, tile: usize, mass: f64, centroid: [f64; 2], _: &[clip::Corner]) {
        self.all.push((self.sites[site], Holding::new(tile, centroid, mass)));
    }

    fn moment(&mut self, site: usize, moment: Place) {
        self.of_block[site].position += moment.position;
        self.of_block[site].normal += moment.normal;
    }

    fn border(&mut self, _: [usize; 2], _: f64) {}

    fn end(&mut self, _: &[Power]) {
        self.moments.extend(self.sites.iter().copied().zip(self.of_block.iter().copied()));
    }
}
