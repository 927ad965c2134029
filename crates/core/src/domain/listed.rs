//! Points of any sequence in a list, cell after cell of a grid.

use std::ops::Range;

use glam::DVec2;

use super::PlanarDomain;
use super::cells::{Cells, Grid, Run};
use crate::lanes::{LANES, Lanes};
use crate::parallel;
use crate::sequence::{self, Finder, Sequence};

/// Points in a grid of about one a cell.
#[derive(Clone, Debug)]
pub(super) struct Listed {
    places: Vec<DVec2>,
    indices: Vec<u64>,
    /// For each kept cell where its points start.
    starts: Vec<u32>,
    cells: Cells,
    /// How many points the sequence has.
    end: u64,
}

/// A point and the number of its cell.
struct Celled {
    cell: u32,
    index: u64,
    place: DVec2,
}

impl Listed {
    /// Looks at all points and keeps those of the cells.
    pub(super) fn scan(
        domain: &PlanarDomain,
        sequence: &Sequence,
        count: u64,
        shift: DVec2,
        cells: Cells,
    ) -> Self {
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
        Self::sorted(cells, &celled, count)
    }

    /// Looks for the points of the cells only.
    pub(super) fn find(
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
        Self::sorted(cells, &celled, count)
    }

    /// Sorts points by cell, keeping their order within one.
    fn sorted(cells: Cells, celled: &[Vec<Celled>], end: u64) -> Self {
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
        Self { places, indices, starts, cells, end }
    }

    pub(super) fn count(&self) -> usize {
        self.places.len()
    }

    pub(super) fn end(&self) -> u64 {
        self.end
    }

    /// Where a slot's point lies, and which of the sequence it is.
    #[inline]
    pub(super) fn at(&self, slot: usize) -> (DVec2, u64) {
        (self.places[slot], self.indices[slot])
    }

    #[inline]
    fn visit(&self, cells: Range<u32>, visit: &mut impl FnMut(&[u64], &[Lanes; 2])) {
        let slots = self.starts[cells.start as usize] as usize..self.starts[cells.end as usize] as usize;
        for (some, first) in self.places[slots.clone()].chunks(LANES).zip(slots.step_by(LANES)) {
            let slots: [u64; LANES] = std::array::from_fn(|lane| (first + lane) as u64);
            let (mut x, mut y) = ([some[0].x; LANES], [some[0].y; LANES]);
            for (lane, place) in some.iter().enumerate() {
                (x[lane], y[lane]) = (place.x, place.y);
            }
            visit(&slots[..some.len()], &[x, y]);
        }
    }

    /// The points that may lie in the box.
    pub(super) fn in_box(&self, low: DVec2, high: DVec2, visit: &mut impl FnMut(&[u64], &[Lanes; 2])) {
        let grid = self.cells.grid;
        let columns = grid.row(low.x)..grid.row(high.x) + 1;
        for row in grid.row(low.y)..=grid.row(high.y) {
            for cells in self.cells.in_row(row, columns.clone()) {
                self.visit(cells, visit);
            }
        }
    }

    /// The points that may lie in the triangle.
    pub(super) fn in_triangle(&self, corners: [DVec2; 3], visit: &mut impl FnMut(&[u64], &[Lanes; 2])) {
        for (row, columns) in self.cells.grid.near_triangle(corners, 0.0) {
            for cells in self.cells.in_row(row, columns) {
                self.visit(cells, visit);
            }
        }
    }
}

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
