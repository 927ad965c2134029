//! The planar domain (paper, 4.2 steps 1 to 3): where each strip lies, and the points scattered on it.

mod bands;
mod cells;
mod lattice;
mod listed;
mod occupied;

use glam::DVec2;

use crate::ids::FaceId;
use crate::lanes::{LANES, Lanes};
use crate::sequence::{Finder, Sequence};
use crate::unfold::Strips;
pub(crate) use cells::TooManyCells;
use cells::{Cells, Grid};
use lattice::Lattice;
use listed::Listed;

/// The square that holds the strips and the points.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarDomain {
    /// The length of its sides, in units of the mesh: that of the largest strip.
    pub side: f64,
    /// Where the origin of each strip lies in it.
    pub offsets: Vec<DVec2>,
}

impl PlanarDomain {
    /// Places the strips by a low-discrepancy set with as many points as there are strips (4.2 step 3): strip k
    /// lies where the k-th point of the Halton set lies in the room that the strip leaves. Strips may cover each
    /// other: each catches points for itself.
    pub fn lay_out(strips: &Strips) -> Self {
        const PLACES: Sequence = Sequence::Halton { bases: [2, 3] };
        let side = strips.strips.iter().fold(0.0_f64, |m, s| m.max(s.extent.max_element()));
        let count = strips.strips.len() as u64;
        let offsets =
            (0..).zip(&strips.strips).map(|(k, s)| PLACES.point(k, count) * (DVec2::splat(side) - s.extent));
        Self { side, offsets: offsets.collect() }
    }

    /// Where the corners of a face lie in it.
    #[inline]
    pub(crate) fn triangle(&self, strips: &Strips, face: FaceId) -> [DVec2; 3] {
        let place = strips.places[face.index()];
        let offset = self.offsets[place.strip.index()];
        strips.strips[place.strip.index()].triangle(place.index as usize).map(|v| v + offset)
    }

    /// The area of the square over that of the strips: how many points to scatter for each one wanted.
    pub fn room(&self, area: f64) -> f64 {
        self.side * self.side / area
    }
}

/// The points of a sequence scattered on the domain (4.2 step 2). Each has a slot, by which it is asked for again.
#[derive(Clone, Debug)]
pub struct DomainPoints {
    points: Points,
}

#[derive(Clone, Debug)]
enum Points {
    /// Any sequence: a list in a grid of about one point a cell, of which a slot is a place.
    Listed(Listed),
    /// Hammersley points, which are computed where they are needed; a slot is a number.
    Lattice(Lattice),
}

impl DomainPoints {
    /// The first `count` points of the sequence, moved by `shift` on the torus and scaled to the domain. Linear time; no
    /// time for Hammersley points, which are made where they are caught.
    ///
    /// # Panics
    /// If `count` is above 2^30 (2^25 where memory has 32-bit addresses).
    pub fn scatter(domain: &PlanarDomain, sequence: &Sequence, count: u32, shift: DVec2) -> Self {
        match *sequence {
            Sequence::Hammersley { base } => Self::lattice(domain, base, u64::from(count), shift),
            _ => Self::list(domain, sequence, count, shift),
        }
    }

    fn lattice(domain: &PlanarDomain, base: u32, count: u64, shift: DVec2) -> Self {
        Self { points: Points::Lattice(Lattice::new(domain, base, count, shift)) }
    }

    /// A list whatever the sequence.
    fn list(domain: &PlanarDomain, sequence: &Sequence, count: u32, shift: DVec2) -> Self {
        let grid = Grid::new(domain, u64::from(count));
        let cells = grid.and_then(Cells::all).expect("as many points as memory is spent on");
        Self { points: Points::Listed(Listed::scan(domain, sequence, u64::from(count), shift, cells)) }
    }

    /// Of the same points those on the strips, those nearer to them than `reach`, and some beside them: all that
    /// wrapping and a correction with the tolerance `reach` look at.
    ///
    /// A narrow strip leaves most of the square empty; then the points of its cells are found by the structure of the
    /// sequence. Cost: O(points found + rows of cells over all triangles) then, O(`count`) if the strips fill the square or
    /// the sequence can only be scanned (see [`Finder`]); of Hammersley points at most the rows are counted.
    pub(crate) fn scatter_near(
        domain: &PlanarDomain,
        strips: &Strips,
        sequence: &Sequence,
        count: u64,
        shift: DVec2,
        reach: f64,
    ) -> Result<Self, TooManyCells> {
        /// A square at most this many times as large as the strips is filled whole: that is simpler and faster.
        const FILLED: f64 = 16.0;
        let area: f64 = strips.strips.iter().map(|s| s.area).sum();
        let filled = domain.room(area) <= FILLED;
        let grid = Grid::new(domain, count)?;
        if let Sequence::Hammersley { base } = *sequence {
            if count as f64 / domain.room(area) > cells::MOST_CAUGHT as f64 {
                return Err(TooManyCells);
            }
            if !filled {
                cells::count_rows(grid, domain, strips, reach)?;
            }
            return Ok(Self::lattice(domain, base, count, shift));
        }
        let cells = if filled { Cells::all(grid) } else { Cells::near(grid, domain, strips, reach) }?;
        let listed = match Finder::new(sequence, count) {
            Some(finder) if (cells.count() as u64) < count / 4 => {
                Listed::find(domain, sequence, count, shift, cells, &finder)
            }
            _ if count > MOST_SCANNED => return Err(TooManyCells),
            _ => Listed::scan(domain, sequence, count, shift, cells),
        };
        Ok(Self { points: Points::Listed(listed) })
    }

    /// How many points may be caught: all, or those kept near the strips.
    pub fn count(&self) -> u64 {
        match &self.points {
            Points::Listed(listed) => listed.count() as u64,
            Points::Lattice(lattice) => lattice.count(),
        }
    }

    /// Above the number of every point.
    pub(crate) fn end(&self) -> u64 {
        match &self.points {
            Points::Listed(listed) => listed.end(),
            Points::Lattice(lattice) => lattice.count(),
        }
    }

    /// Where a slot's point lies, and which of the sequence it is.
    #[inline]
    pub fn at(&self, slot: u64) -> (DVec2, u64) {
        match &self.points {
            Points::Listed(listed) => listed.at(slot as usize),
            Points::Lattice(lattice) => (lattice.place(slot), slot),
        }
    }

    /// Where the points of some slots lie.
    #[inline]
    pub(crate) fn places(&self, slots: &[u64; LANES]) -> [Lanes; 2] {
        match &self.points {
            Points::Listed(listed) => {
                let places = slots.map(|slot| listed.at(slot as usize).0);
                [places.map(|place| place.x), places.map(|place| place.y)]
            }
            Points::Lattice(lattice) => lattice.places(slots),
        }
    }

    /// Which point of the sequence a slot's is.
    #[inline]
    pub(crate) fn index(&self, slot: u64) -> u64 {
        match &self.points {
            Points::Listed(listed) => listed.at(slot as usize).1,
            Points::Lattice(_) => slot,
        }
    }

    /// Calls `visit` with the slot and the place of each point at most `reach` from the segment, each once, and of some
    /// farther away.
    pub(crate) fn along(&self, [from, to]: [DVec2; 2], reach: f64, mut visit: impl FnMut(u64, DVec2)) {
        let mut visit = |slots: &[u64], [x, y]: &[Lanes; 2]| {
            for (lane, &slot) in slots.iter().enumerate() {
                visit(slot, DVec2::new(x[lane], y[lane]));
            }
        };
        match &self.points {
            Points::Listed(listed) => {
                listed.in_box(from.min(to) - reach, from.max(to) + reach, &mut visit);
            }
            Points::Lattice(lattice) => {
                let onward = (to - from).try_normalize().unwrap_or(DVec2::X) * reach;
                let aside = onward.perp();
                let (from, to) = (from - onward, to + onward);
                lattice.in_polygon([from - aside, to - aside, to + aside, from + aside], &mut visit);
            }
        }
    }

    /// Calls `visit` with the slots and the places of the points in the triangle, some at a time, each point once, and of
    /// some beside it. Lanes without a slot hold places of other points.
    #[inline]
    pub(crate) fn in_triangle(&self, corners: [DVec2; 3], mut visit: impl FnMut(&[u64], &[Lanes; 2])) {
        match &self.points {
            Points::Listed(listed) => listed.in_triangle(corners, &mut visit),
            Points::Lattice(lattice) => lattice.in_polygon(corners, &mut visit),
        }
    }
}

/// The most points of a sequence that are looked at one by one.
const MOST_SCANNED: u64 = 1 << 32;

#[cfg(test)]
mod tests;
