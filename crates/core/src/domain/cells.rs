//! The cells of a square grid over the planar domain, as rows of runs: all of them, or those near the strips.

use std::ops::Range;

use glam::DVec2;

use super::PlanarDomain;
use super::bands::Bands;
use crate::ids::FaceId;
use crate::parallel;
use crate::unfold::Strips;

/// The most cells in a row: their squares fit in 64 bits and are exact as doubles.
const MOST_ROWS: u32 = if usize::BITS < 64 { 1 << 23 } else { 1 << 26 };

/// The most runs, and rows of triangles, that are listed.
const MOST_RUNS: u64 = if usize::BITS < 64 { 1 << 22 } else { 1 << 26 };

/// The most cells that are kept: a point each takes 24 bytes.
const MOST_CELLS: u64 = if usize::BITS < 64 { 1 << 25 } else { 1 << 30 };

/// The most points of a set without a list that are caught: their slots take 8 bytes each, what is made of them more.
pub(super) const MOST_CAUGHT: u64 = MOST_CELLS / 2;

/// More cells or rows would be needed than memory is spent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooManyCells;

/// Square cells over the domain, about one for each point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// How many cells a row has, and how many rows there are.
    pub(super) rows: u32,
    /// The side of a cell, in units of the mesh.
    pub(super) cell_side: f64,
}

impl Grid {
    pub(super) fn new(domain: &PlanarDomain, count: u64) -> Result<Self, TooManyCells> {
        let rows = libm::sqrt(count as f64).floor().max(1.0);
        if rows > f64::from(MOST_ROWS) {
            return Err(TooManyCells);
        }
        let rows = rows as u32;
        Ok(Self { rows, cell_side: domain.side / f64::from(rows) })
    }

    /// The row (or column) of cells that holds a coordinate; the nearest one outside the domain.
    #[inline]
    pub(super) fn row(&self, x: f64) -> u32 {
        // The cast saturates: below 0 and NaN give 0.
        ((x / self.cell_side) as u32).min(self.rows - 1)
    }

    /// The rows with the first and last column that places nearer to the triangle than `reach` may lie in.
    pub(super) fn near_triangle(
        &self,
        corners: [DVec2; 3],
        reach: f64,
    ) -> impl Iterator<Item = (u32, Range<u32>)> + use<> {
        let grid = *self;
        let bands = Bands::new(corners);
        let (first, last) = (grid.row(bands.low.y - reach), grid.row(bands.high.y + reach));
        // Rounding of the cuts is far below this margin.
        let margin = 1e-6 * grid.cell_side + reach;
        (first..=last).map(move |row| {
            let bottom = f64::from(row) * grid.cell_side - margin;
            let (left, right) = if first == last {
                (bands.low.x, bands.high.x)
            } else {
                let [[left], [right]] = bands.between(&[bottom], grid.cell_side + 2.0 * margin);
                (left, right)
            };
            let columns =
                if left <= right { grid.row(left - margin)..grid.row(right + margin) + 1 } else { 0..0 };
            (row, columns)
        })
    }
}

/// Whether the rows of all triangles are few enough to be gone through.
pub(super) fn count_rows(
    grid: Grid,
    domain: &PlanarDomain,
    strips: &Strips,
    reach: f64,
) -> Result<(), TooManyCells> {
    let rows: u64 = (0..strips.places.len())
        .map(|face| {
            let [a, b, c] = domain.triangle(strips, FaceId::new(face)).map(|v| v.y);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            u64::from(grid.row(high + reach) - grid.row(low - reach)) + 1
        })
        .sum();
    if rows > MOST_RUNS { Err(TooManyCells) } else { Ok(()) }
}

/// Cells side by side in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) row: u32,
    /// The first column.
    pub(super) left: u32,
    /// The column after the last.
    pub(super) end: u32,
    /// The number of its first cell among all that are kept.
    pub(super) first: u32,
}

/// Some cells of a grid, numbered row after row.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    pub(super) grid: Grid,
    /// In order; runs of a row neither meet nor overlap.
    pub(super) runs: Vec<Run>,
    first_row: u32,
    /// For each row from the first kept on, where its runs start.
    starts: Vec<u32>,
}

impl Cells {
    /// All cells of the grid.
    pub(super) fn all(grid: Grid) -> Result<Self, TooManyCells> {
        if u64::from(grid.rows) * u64::from(grid.rows) > MOST_CELLS {
            return Err(TooManyCells);
        }
        Self::of_spans(grid, (0..grid.rows).map(|row| (row, 0, grid.rows)).collect())
    }

    /// The cells that places on the strips, or nearer to them than `reach`, may lie in. O(rows of all triangles),
    /// sorted.
    pub(super) fn near(
        grid: Grid,
        domain: &PlanarDomain,
        strips: &Strips,
        reach: f64,
    ) -> Result<Self, TooManyCells> {
        const CHUNK: usize = 1 << 12;
        let faces: usize = strips.places.len();
        let triangle = |face: usize| domain.triangle(strips, FaceId::new(face));
        count_rows(grid, domain, strips, reach)?;
        let chunks = parallel::map_chunks(faces, CHUNK, |range| {
            let mut spans: Vec<(u32, u32, u32)> = Vec::new();
            for face in range {
                for (row, columns) in grid.near_triangle(triangle(face), reach) {
                    // Faces that follow each other often lie side by side.
                    match spans.last_mut() {
                        Some(last) if last.0 == row && columns.start <= last.2 && columns.end >= last.1 => {
                            last.1 = last.1.min(columns.start);
                            last.2 = last.2.max(columns.end);
                        }
                        _ if columns.is_empty() => {}
                        _ => spans.push((row, columns.start, columns.end)),
                    }
                }
            }
            spans
        });
        let mut spans = chunks.concat();
        spans.sort_unstable();
        spans.dedup_by(|next, kept| {
            let joins = next.0 == kept.0 && next.1 <= kept.2;
            if joins {
                kept.2 = kept.2.max(next.2);
            }
            joins
        });
        Self::of_spans(grid, spans)
    }

    /// From row, first column and column after the last, in order.
    fn of_spans(grid: Grid, spans: Vec<(u32, u32, u32)>) -> Result<Self, TooManyCells> {
        let count: u64 = spans.iter().map(|&(_, left, end)| u64::from(end - left)).sum();
        if count > MOST_CELLS {
            return Err(TooManyCells);
        }
        let first_row = spans.first().map_or(0, |s| s.0);
        let rows = spans.last().map_or(0, |s| (s.0 - first_row) as usize + 1);
        let mut starts = vec![0u32; rows + 1];
        let mut runs = Vec::with_capacity(spans.len());
        let mut first = 0;
        for (row, left, end) in spans {
            runs.push(Run { row, left, end, first });
            first += end - left;
            starts[(row - first_row) as usize + 1] = runs.len() as u32;
        }
        for row in 0..rows {
            starts[row + 1] = starts[row + 1].max(starts[row]);
        }
        Ok(Self { grid, runs, first_row, starts })
    }

    /// How many cells are kept.
    pub(super) fn count(&self) -> usize {
        self.runs.last().map_or(0, |r| (r.first + (r.end - r.left)) as usize)
    }

    /// The numbers of the kept cells of a row between these columns: one range for each run.
    #[inline]
    pub(super) fn in_row(&self, row: u32, columns: Range<u32>) -> impl Iterator<Item = Range<u32>> + use<'_> {
        let runs = row
            .checked_sub(self.first_row)
            .map(|row| row as usize)
            .filter(|&row| row + 1 < self.starts.len())
            .map_or(&[][..], |row| &self.runs[self.starts[row] as usize..self.starts[row + 1] as usize]);
        let skipped = if runs.len() > 1 { runs.partition_point(|r| r.end <= columns.start) } else { 0 };
        runs[skipped..].iter().take_while(move |r| r.left < columns.end).filter_map(move |r| {
            let (left, end) = (columns.start.max(r.left), columns.end.min(r.end));
            (left < end).then(|| r.first + (left - r.left)..r.first + (end - r.left))
        })
    }

    /// The number of the cell that holds a place, if it is kept.
    pub(super) fn cell_of(&self, place: DVec2) -> Option<u32> {
        let column = self.grid.row(place.x);
        self.in_row(self.grid.row(place.y), column..column + 1).next().map(|cells| cells.start)
    }
}
