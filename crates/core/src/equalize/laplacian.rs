//! Graph Laplacians, solved by conjugate gradients with a multigrid cycle as preconditioner.
//!
//! Aggregation: a row and its neighbours become one row of the next coarser level (Vaněk, Mandel, Brezina 1996,
//! DOI 10.1007/BF02238511, without smoothing). So what has to travel far does so on coarse levels, and the number of
//! iterations hardly depends on the number of rows.

use std::ops::Range;

use crate::buckets::Buckets;
use crate::parallel;
use crate::sets::Sets;

/// Two rows and the entry that joins them, taken positive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) rows: [u32; 2],
    pub(super) flow: f64,
}

/// A symmetric matrix in rows; but for its screen they sum to zero.
pub(super) struct Laplacian {
    ends: Vec<u32>,
    /// Column and minus the entry. Singles: half the memory to go through, and far closer than the solution.
    entries: Vec<(u32, f32)>,
    diagonal: Vec<f64>,
    /// What of the diagonal does not stand for links.
    screen: Vec<f64>,
}

/// A row, a column and minus the entry there.
type Entry = (u32, u32, f32);

/// So many rows are put together by one thread.
const ROWS: usize = 1 << 10;

/// Some rows by themselves.
struct Rows {
    /// From the start of the first of them.
    ends: Vec<u32>,
    entries: Vec<(u32, f32)>,
    diagonal: Vec<f64>,
}

impl Rows {
    /// Entries of the same row and column are added up, in order.
    fn new<'a>(rows: Range<usize>, all: impl Iterator<Item = &'a Entry> + Clone) -> Self {
        // Counting sort by row, then equal columns are added up.
        let slot = |row: u32| row as usize - rows.start;
        let mut starts = vec![0u32; rows.len() + 1];
        all.clone().for_each(|&(row, ..)| starts[slot(row) + 1] += 1);
        for i in 0..rows.len() {
            starts[i + 1] += starts[i];
        }
        let mut cursor = starts.clone();
        let mut entries = vec![(0u32, 0.0f32); starts[rows.len()] as usize];
        for &(row, column, flow) in all {
            let cursor = &mut cursor[slot(row)];
            entries[*cursor as usize] = (column, flow);
            *cursor += 1;
        }
        let mut ends = Vec::with_capacity(rows.len());
        let mut diagonal = Vec::with_capacity(rows.len());
        let mut end = 0;
        for range in starts.windows(2) {
            let start = end;
            let mut sum = 0.0;
            for from in range[0] as usize..range[1] as usize {
                let (column, flow) = entries[from];
                sum += f64::from(flow);
                match entries[start..end].iter_mut().find(|entry| entry.0 == column) {
                    Some(entry) => entry.1 += flow,
                    None => {
                        entries[end] = (column, flow);
                        end += 1;
                    }
                }
            }
            ends.push(end as u32);
            diagonal.push(sum);
        }
        entries.truncate(end);
        Self { ends, entries, diagonal }
    }
}

impl Laplacian {
    /// Of links that come in pieces. Links of the same rows are added up. The diagonal is raised by the share `screen`.
    pub(super) fn new<L: Iterator<Item = Link>>(
        count: usize,
        pieces: usize,
        links: impl Fn(usize) -> L + Sync + Send,
        screen: f64,
    ) -> Self {
        let both = |Link { rows: [a, b], flow }: Link| [(a, b, flow as f32), (b, a, flow as f32)];
        let entries = |piece| links(piece).flat_map(both).collect::<Vec<Entry>>();
        let bucket = |&(row, ..): &Entry| row as usize / ROWS;
        let buckets = Buckets::new(pieces, entries, count.div_ceil(ROWS), bucket);
        let rows = parallel::map(buckets.count(), |b| {
            Rows::new(b * ROWS..count.min((b + 1) * ROWS), buckets.runs(b).flatten())
        });
        drop(buckets);
        let mut all = Self {
            ends: Vec::with_capacity(count),
            entries: Vec::with_capacity(rows.iter().map(|rows| rows.entries.len()).sum()),
            diagonal: Vec::with_capacity(count),
            screen: Vec::with_capacity(count),
        };
        for Rows { ends, entries, diagonal } in rows {
            let before = all.entries.len() as u32;
            all.ends.extend(ends.into_iter().map(|end| before + end));
            all.entries.extend(entries);
            all.screen.extend(diagonal.iter().map(|sum| sum * screen));
            all.diagonal.extend(diagonal.into_iter().map(|sum| sum + sum * screen));
        }
        all
    }

    fn count(&self) -> usize {
        self.ends.len()
    }

    /// The entries of a row beside its diagonal.
    fn row(&self, row: usize) -> &[(u32, f32)] {
        let start = if row == 0 { 0 } else { self.ends[row - 1] as usize };
        &self.entries[start..self.ends[row] as usize]
    }

    /// The product of a row with a vector.
    #[inline]
    fn times(&self, row: usize, vector: &[f64]) -> f64 {
        let beside = self.row(row).iter().map(|&(column, flow)| f64::from(flow) * vector[column as usize]);
        self.diagonal[row] * vector[row] - beside.sum::<f64>()
    }

    /// The mean of a vector over the rows beside a row.
    fn beside(&self, row: usize, vector: &[f64]) -> f64 {
        let sum: f64 =
            self.row(row).iter().map(|&(column, flow)| f64::from(flow) * vector[column as usize]).sum();
        divided(sum, self.diagonal[row] - self.screen[row])
    }

    /// Which row of the next coarser matrix each row belongs to, and how many of those there are.
    fn aggregates(&self) -> (Vec<u32>, usize) {
        const NONE: u32 = u32::MAX;
        let mut of_row = vec![NONE; self.count()];
        let mut count = 0;
        // A row whose neighbours are all free takes them.
        for row in 0..self.count() {
            let free = |row: usize| of_row[row] == NONE;
            if free(row) && self.row(row).iter().all(|&(column, _)| free(column as usize)) {
                of_row[row] = count;
                self.row(row).iter().for_each(|&(column, _)| of_row[column as usize] = count);
                count += 1;
            }
        }
        // What is left over goes with its strongest neighbour among those that were taken.
        let taken = of_row.clone();
        for row in (0..self.count()).filter(|&row| taken[row] == NONE) {
            let beside = self.row(row).iter().filter(|(column, _)| taken[*column as usize] != NONE);
            let strongest =
                beside.max_by(|a, b| a.1.total_cmp(&b.1)).map(|&(column, _)| taken[column as usize]);
            of_row[row] = strongest.unwrap_or(count);
            count += u32::from(strongest.is_none());
        }
        (of_row, count as usize)
    }

    /// The matrix of the sums over aggregates.
    fn coarser(&self, aggregate: &[u32], count: usize) -> Self {
        let links = |piece: usize| {
            (piece * ROWS..self.count().min((piece + 1) * ROWS)).flat_map(|row| {
                let beside = self.row(row).iter().filter(move |(column, _)| row < *column as usize);
                beside.filter_map(move |&(column, flow)| {
                    let rows = [aggregate[row], aggregate[column as usize]];
                    (rows[0] != rows[1]).then_some(Link { rows, flow: flow.into() })
                })
            })
        };
        let mut coarser = Self::new(count, self.count().div_ceil(ROWS), links, 0.0);
        for (screen, &into) in self.screen.iter().zip(aggregate) {
            coarser.screen[into as usize] += screen;
            coarser.diagonal[into as usize] += screen;
        }
        coarser
    }
}

/// What conjugate gradients know of a row.
#[derive(Clone, Copy)]
struct Unknown {
    value: f64,
    residual: f64,
    /// The matrix times the direction.
    image: f64,
}

/// What was found for a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    pub(super) value: f64,
    /// The mean value of the rows that it is linked to.
    pub(super) beside: f64,
}

/// How many rows are worked on together.
const CHUNK: usize = 1 << 12;

/// Solves with a residual of at most `accuracy` of what it is at first, in the norm of the preconditioner. From each part of the rows
/// that no link joins to another part the mean of `right` is taken: its sum cannot be met. Linear in rows and links.
pub(super) fn solve(matrix: Laplacian, mut right: Vec<f64>, accuracy: f64) -> Vec<Solved> {
    const MOST_ITERATIONS: usize = 60;
    let mut cycle = Cycle::new(matrix);
    cycle.level_parts(&mut right);
    let mut direction = vec![0.0; right.len()];
    let mut state: Vec<Unknown> =
        right.into_iter().map(|residual| Unknown { value: 0.0, residual, image: 0.0 }).collect();
    let mut size = 0.0;
    let mut first = None;
    for _ in 0..MOST_ITERATIONS {
        let next = cycle.precondition(&state);
        if next <= *first.get_or_insert(next) * accuracy * accuracy {
            break;
        }
        let turn = if size > 0.0 { next / size } else { 0.0 };
        size = next;
        let Level { matrix, value, .. } = &cycle.levels[0];
        parallel::change_chunks(&mut direction, CHUNK, |first, chunk| {
            for (direction, value) in chunk.iter_mut().zip(&value[first..]) {
                *direction = value + turn * *direction;
            }
        });
        let curvature = update(&mut state, |row, unknown| {
            unknown.image = matrix.times(row, &direction);
            unknown.image * direction[row]
        });
        if curvature <= 0.0 {
            break;
        }
        let step = size / curvature;
        update(&mut state, |row, unknown| {
            unknown.value += step * direction[row];
            unknown.residual -= step * unknown.image;
            0.0
        });
    }
    let values: Vec<f64> = state.into_iter().map(|unknown| unknown.value).collect();
    let matrix = &cycle.levels[0].matrix;
    let solved = |row| Solved { value: values[row], beside: matrix.beside(row, &values) };
    parallel::map(values.len(), solved)
}

/// Changes every row and adds up what that gives, chunk by chunk.
fn update(state: &mut [Unknown], change: impl Fn(usize, &mut Unknown) -> f64 + Sync + Send) -> f64 {
    let mut sums: Vec<(&mut [Unknown], f64)> = state.chunks_mut(CHUNK).map(|chunk| (chunk, 0.0)).collect();
    parallel::change_chunks(&mut sums, 1, |number, chunks| {
        for (chunk, sum) in chunks {
            *sum = (number * CHUNK..).zip(chunk.iter_mut()).map(|(row, unknown)| change(row, unknown)).sum();
        }
    });
    sums.iter().map(|(_, sum)| sum).sum()
}

/// A matrix with what the cycle needs there.
struct Level {
    matrix: Laplacian,
    /// Which row of the next level each row belongs to; empty on the last.
    aggregate: Vec<u32>,
    right: Vec<f64>,
    value: Vec<f64>,
    residual: Vec<f64>,
}

impl Level {
    fn new(matrix: Laplacian, aggregate: Vec<u32>) -> Self {
        let zeros = vec![0.0; matrix.count()];
        Self { matrix, aggregate, right: zeros.clone(), value: zeros.clone(), residual: zeros }
    }

    fn find_residual(&mut self) {
        let Self { matrix, right, value, residual, .. } = self;
        parallel::change_chunks(residual, CHUNK, |first, chunk| {
            for (row, residual) in (first..).zip(chunk) {
                *residual = right[row] - matrix.times(row, value);
            }
        });
    }

    /// A step of Jacobi's method, damped.
    fn smooth(&mut self) {
        self.find_residual();
        let Self { matrix, value, residual, .. } = self;
        parallel::change_chunks(value, CHUNK, |first, chunk| {
            for (row, value) in (first..).zip(chunk) {
                *value += DAMPING * divided(residual[row], matrix.diagonal[row]);
            }
        });
    }
}

/// Jacobi's method smooths best with about two thirds of its step.
const DAMPING: f64 = 0.7;

/// By so much corrections from coarser levels are raised: aggregates are stiffer than what they stand for.
const RAISE: f64 = 1.6;

/// No coarser level than one of this many rows.
const FEW: usize = 24;

fn divided(value: f64, by: f64) -> f64 {
    if by > 0.0 { value / by } else { 0.0 }
}

/// A matrix and ever coarser ones.
struct Cycle {
    levels: Vec<Level>,
}

impl Cycle {
    fn new(matrix: Laplacian) -> Self {
        let mut levels = Vec::new();
        let mut matrix = matrix;
        loop {
            let (aggregate, count) = matrix.aggregates();
            if matrix.count() <= FEW || 4 * count > 3 * matrix.count() {
                levels.push(Level::new(matrix, Vec::new()));
                return Self { levels };
            }
            let coarser = matrix.coarser(&aggregate, count);
            levels.push(Level::new(matrix, aggregate));
            matrix = coarser;
        }
    }

    /// Takes its mean from each part of the rows that no link joins to another part. On the last level parts are seen
    /// at once.
    fn level_parts(&self, right: &mut [f64]) {
        let Some(last) = self.levels.last() else { return };
        let count = last.matrix.count();
        let mut parts = Sets::new(count);
        for row in 0..count {
            last.matrix.row(row).iter().for_each(|&(column, _)| {
                parts.join(row as u32, column);
            });
        }
        let part_of_last: Vec<u32> = (0..count as u32).map(|row| parts.root(row)).collect();
        let part_of = |row: usize| {
            let to_last = self.levels[..self.levels.len() - 1].iter();
            part_of_last[to_last.fold(row, |row, level| level.aggregate[row] as usize)] as usize
        };
        let mut sums = vec![(0.0, 0.0); count];
        for (row, value) in right.iter().enumerate() {
            let sum: &mut (f64, f64) = &mut sums[part_of(row)];
            *sum = (sum.0 + value, sum.1 + 1.0);
        }
        for (row, value) in right.iter_mut().enumerate() {
            let (sum, count) = sums[part_of(row)];
            *value -= sum / count;
        }
    }

    /// Puts the preconditioned residual into the values of the first level; gives their product.
    fn precondition(&mut self, state: &[Unknown]) -> f64 {
        parallel::change_chunks(&mut self.levels[0].right, CHUNK, |first, chunk| {
            for (right, unknown) in chunk.iter_mut().zip(&state[first..]) {
                *right = unknown.residual;
            }
        });
        cycle(&mut self.levels);
        let Level { right, value, .. } = &self.levels[0];
        let sums = parallel::map_chunks(right.len(), CHUNK, |rows| {
            right[rows.clone()].iter().zip(&value[rows]).map(|(r, v)| r * v).sum::<f64>()
        });
        sums.into_iter().sum()
    }
}

/// From `right` to about `value`; symmetric, so that conjugate gradients can use it.
fn cycle(levels: &mut [Level]) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    let Level { matrix, right, value, .. } = level;
    parallel::change_chunks(value, CHUNK, |first, chunk| {
        for (row, value) in (first..).zip(chunk) {
            *value = DAMPING * divided(right[row], matrix.diagonal[row]);
        }
    });
    let Some(next) = coarser.first_mut() else {
        // Hardly more rows than a few steps reach across.
        for _ in 0..8 {
            level.smooth();
        }
        return;
    };
    level.find_residual();
    let Level { aggregate, value, residual, .. } = level;
    next.right.fill(0.0);
    for (residual, &into) in residual.iter().zip(&*aggregate) {
        next.right[into as usize] += residual;
    }
    cycle(coarser);
    let next = &coarser[0];
    parallel::change_chunks(value, CHUNK, |first, chunk| {
        for (value, &from) in chunk.iter_mut().zip(&aggregate[first..]) {
            *value += RAISE * next.value[from as usize];
        }
    });
    level.smooth();
}
