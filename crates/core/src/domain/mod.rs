//! The planar domain (paper, 4.2 steps 1 to 3): where each strip lies, and the points scattered on it.

mod cells;

use std::ops::Range;

use glam::DVec2;

use crate::parallel;
use crate::sequence::{self, Finder, Sequence};
use crate::unfold::Strips;
pub(crate) use cells::TooManyCells;
use cells::{Cells, Grid, Run};

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

    /// The area of the square over that of the strips: how many points to scatter for each one wanted.
    pub fn room(&self, area: f64) -> f64 {
        self.side * self.side / area
    }
}

/// The points of a sequence scattered on the domain (4.2 step 2), in a grid of about one point a cell.
#[derive(Clone, Debug)]
pub struct DomainPoints {
    places: Vec<DVec2>,
    indices: Vec<u64>,
    /// For each kept cell where its points start.
    starts: Vec<u32>,
    cells: Cells,
}

/// A point and the number of its cell.
struct Celled {
    cell: u32,
    index: u64,
    place: DVec2,
}

impl DomainPoints {
    /// The first `count` points of the sequence, moved by `shift` on the torus and scaled to the domain. Linear time.
    ///
    /// # Panics
    /// If `count` is above 2^30 (2^25 where memory has 32-bit addresses).
    pub fn scatter(domain: &PlanarDomain, sequence: &Sequence, count: u32, shift: DVec2) -> Self {
        let grid = Grid::new(domain, u64::from(count));
        let cells = grid.and_then(Cells::all).expect("as many points as memory is spent on");
        Self::scan(domain, sequence, u64::from(count), shift, cells)
    }

    /// Of the same points those on the strips, those nearer to them than `reach`, and some beside them: all that
    /// wrapping and a correction with the tolerance `reach` look at.
    ///
    /// A narrow strip leaves most of the square empty; then the points of its cells are found by the structure of the
    /// sequence. Cost: O(points found + rows of cells over all triangles) then, O(`count`) if the strips fill the square or
    /// the sequence can only be scanned (see [`Finder`]).
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
        let grid = Grid::new(domain, count)?;
        let cells = if domain.room(area) <= FILLED {
            Cells::all(grid)
        } else {
            Cells::near(grid, domain, strips, reach)
        }?;
        match Finder::new(sequence, count) {
            Some(finder) if (cells.count() as u64) < count / 4 => {
                Ok(Self::find(domain, sequence, count, shift, cells, &finder))
            }
            _ if count > MOST_SCANNED => Err(TooManyCells),
            _ => Ok(Self::scan(domain, sequence, count, shift, cells)),
        }
    }

    /// Looks at all points and keeps those of the cells.
    fn scan(domain: &PlanarDomain, sequence: &Sequence, count: u64, shift: DVec2, cells: Cells) -> Self {
        const CHUNK: usize = 1 << 14;
        let chunks = count.div_ceil(CHUNK as u64) as usize;
        let celled = parallel::map(chunks, |chunk| {
            let first = chunk as u64 * CHUNK as u64;
            (first..count.min(first + CHUNK as u64))
                .filter_map(|index| {
                    let place = sequence::shift(sequence.point(index, count), shift) * domain.side;
                    Some(Celled { cell: cells.cell_of(place)?, index, place })
                })
                .collect::<Vec<_>>()
        });
        Self::sorted(cells, &celled)
    }

    /// Looks for the points of the cells only.
    fn find(
        domain: &PlanarDomain,
        sequence: &Sequence,
        count: u64,
        shift: DVec2,
        cells: Cells,
        finder: &Finder,
    ) -> Self {
        const CHUNK: usize = 1 << 8;
        let celled = parallel::map_chunks(cells.runs.len(), CHUNK, |range| {
            let mut found = Vec::new();
            let mut indices = Vec::new();
            for run in &cells.runs[range] {
                indices.clear();
                for (x, y) in boxes(run, &cells.grid, shift) {
                    finder.candidates(x, y, &mut indices);
                }
                indices.sort_unstable();
                indices.dedup();
                for &index in &indices {
                    let place = sequence::shift(sequence.point(index, count), shift) * domain.side;
                    let column = cells.grid.row(place.x);
                    if cells.grid.row(place.y) == run.row && (run.left..run.end).contains(&column) {
                        found.push(Celled { cell: run.first + (column - run.left), index, place });
                    }
                }
            }
            found
        });
        Self::sorted(cells, &celled)
    }

    /// Sorts points by cell, keeping their order within one.
    fn sorted(cells: Cells, celled: &[Vec<Celled>]) -> Self {
        let mut starts = vec![0u32; cells.count() + 1];
        for point in celled.iter().flatten() {
            starts[point.cell as usize + 1] += 1;
        }
        for cell in 0..cells.count() {
            starts[cell + 1] += starts[cell];
        }
        let total = starts[cells.count()] as usize;
        let mut cursor = starts.clone();
        let mut places = vec![DVec2::ZERO; total];
        let mut indices = vec![0; total];
        for point in celled.iter().flatten() {
            let slot = &mut cursor[point.cell as usize];
            places[*slot as usize] = point.place;
            indices[*slot as usize] = point.index;
            *slot += 1;
        }
        Self { places, indices, starts, cells }
    }

    /// How many points are kept.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Where a slot's point lies, and which of the sequence it is.
    #[inline]
    pub fn at(&self, slot: usize) -> (DVec2, u64) {
        (self.places[slot], self.indices[slot])
    }

    #[inline]
    fn slots(&self, cells: Range<u32>) -> Range<usize> {
        self.starts[cells.start as usize] as usize..self.starts[cells.end as usize] as usize
    }

    /// The slots of the points that may lie in the box: a run or more for each row of cells.
    pub fn in_box(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = Range<usize>> + use<'_> {
        let grid = self.cells.grid;
        let columns = grid.row(low.x)..grid.row(high.x) + 1;
        (grid.row(low.y)..=grid.row(high.y))
            .flat_map(move |row| self.cells.in_row(row, columns.clone()))
            .map(|cells| self.slots(cells))
    }

    /// The slots of the points that may lie in the triangle: a run or more for each row of cells, cut to the triangle.
    pub fn in_triangle(&self, corners: [DVec2; 3]) -> impl Iterator<Item = Range<usize>> + use<'_> {
        self.cells
            .grid
            .near_triangle(corners, 0.0)
            .flat_map(|(row, columns)| self.cells.in_row(row, columns))
            .map(|cells| self.slots(cells))
    }
}

/// The most points of a sequence that are looked at one by one.
const MOST_SCANNED: u64 = 1 << 32;

/// Where the unshifted points of a run's cells lie in the unit square: ranges of x and y, cut where the shift carries
/// them around the torus; a little too large, for rounding.
fn boxes(run: &Run, grid: &Grid, shift: DVec2) -> Vec<(Range<f64>, Range<f64>)> {
    let rows = f64::from(grid.rows);
    let pieces = |first: u32, end: u32, by: f64| {
        let margin = 1e-6 / rows + 1e-14;
        let low = f64::from(first) / rows - by - margin;
        let high = f64::from(end) / rows - by + margin;
        // Whole turns that bring a piece of it into [0, 1).
        [-1.0, 0.0, 1.0, 2.0].map(|turn| (low + turn).max(0.0)..(high + turn).min(1.0))
    };
    let xs = pieces(run.left, run.end, shift.x - shift.x.floor());
    let ys = pieces(run.row, run.row + 1, shift.y - shift.y.floor());
    xs.iter()
        .filter(|x| x.start < x.end)
        .flat_map(|x| ys.iter().filter(|y| y.start < y.end).map(move |y| (x.clone(), y.clone())))
        .collect()
}

#[cfg(test)]
mod tests;
