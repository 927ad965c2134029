//! What is asked of the power diagram: cells and borders, pieces.

use glam::{DVec2, DVec3};

use super::clip;
use super::diagram::{Owners, Power, walk, walk_some};
use super::layout::{Layout, Place};
use super::near::{Near, Site};

/// What a site owns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cell {
    pub(super) mass: f64,
    /// Mass times mean place.
    pub(super) moment: Place,
}

impl Cell {
    /// The mean position; of cells that are not empty.
    pub(super) fn centroid(&self) -> DVec3 {
        self.moment.position / self.mass
    }

    pub(super) fn add(&mut self, moment: Place) {
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
    /// In pieces.
    pub(super) borders: Vec<Vec<Border>>,
}

/// Computes the cells. Linear in the tiles times the sites near them.
pub(super) fn diagram(layout: &Layout, near: &Near, sites: &[Site]) -> Diagram {
    let pieces = walk(layout, near, sites, Sums::default);
    let mut cells = vec![Cell::default(); sites.len()];
    let mut borders = Vec::with_capacity(pieces.len());
    for piece in pieces {
        for (site, part) in piece.parts {
            let cell = &mut cells[site as usize];
            cell.mass += part.mass;
            cell.add(part.moment);
        }
        borders.push(piece.borders);
    }
    Diagram { cells, borders }
}

/// Sums over a block.
#[derive(Default)]
struct Sums {
    cells: Vec<Cell>,
    parts: Vec<(u32, Cell)>,
    borders: Vec<Border>,
    /// Where the borders of the block begin.
    first: usize,
    /// Which border grew last: tiles that follow each other often lie across the same one.
    last: usize,
}

impl Owners for Sums {
    const POLYGONS: bool = false;

    fn begin(&mut self, contenders: &[Power]) {
        self.cells.clear();
        self.cells.resize(contenders.len(), Cell::default());
        self.first = self.borders.len();
        self.last = self.first;
    }

    fn whole(&mut self, site: usize, _: usize, mass: f64) {
        self.cells[site].mass += mass;
    }

    fn part(&mut self, site: usize, _: usize, mass: f64, _: [f64; 2], _: &[clip::Corner]) {
        self.cells[site].mass += mass;
    }

    fn moment(&mut self, site: usize, moment: Place) {
        self.cells[site].add(moment);
    }

    fn border(&mut self, [a, b]: [usize; 2], flow: f64) {
        let (a, b) = (a.min(b) as u32, a.max(b) as u32);
        let is_it = |border: &Border| border.a == a && border.b == b;
        if !self.borders.get(self.last).is_some_and(is_it) {
            let found = self.borders[self.first..].iter().position(is_it);
            self.last = found.map_or(self.borders.len(), |found| self.first + found);
            if found.is_none() {
                self.borders.push(Border { a, b, flow: 0.0 });
            }
        }
        self.borders[self.last].flow += flow;
    }

    /// Until here borders name sites by their place among the contenders.
    fn end(&mut self, contenders: &[Power]) {
        let owners = self.cells.iter().zip(contenders).filter(|(cell, _)| cell.mass > 0.0);
        self.parts.extend(owners.map(|(cell, power)| (power.site, *cell)));
        for border in &mut self.borders[self.first..] {
            (border.a, border.b) = (contenders[border.a as usize].site, contenders[border.b as usize].site);
        }
    }
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

/// All pieces of some blocks, in no order that matters. Sums over a site's pieces are what it owns there.
pub(super) fn pieces(layout: &Layout, near: &Near, sites: &[Site], blocks: &[u32]) -> Vec<Piece> {
    walk_some(layout, near, sites, blocks, Cut::default).into_iter().flat_map(|cut| cut.pieces).collect()
}

#[derive(Default)]
struct Cut {
    sites: Vec<u32>,
    pieces: Vec<Piece>,
}

impl Owners for Cut {
    const POLYGONS: bool = true;

    fn begin(&mut self, contenders: &[Power]) {
        self.sites.clear();
        self.sites.extend(contenders.iter().map(|power| power.site));
    }

    fn whole(&mut self, site: usize, tile: usize, mass: f64) {
        let polygon = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
        self.pieces.push(Piece { site: self.sites[site], tile: tile as u32, mass, polygon });
    }

    fn part(&mut self, site: usize, tile: usize, mass: f64, _: [f64; 2], polygon: &[clip::Corner]) {
        let polygon = polygon.iter().map(|c| DVec2::new(c.u, c.v)).collect();
        self.pieces.push(Piece { site: self.sites[site], tile: tile as u32, mass, polygon });
    }

    fn moment(&mut self, _: usize, _: Place) {}

    fn border(&mut self, _: [usize; 2], _: f64) {}

    fn end(&mut self, _: &[Power]) {}
}
