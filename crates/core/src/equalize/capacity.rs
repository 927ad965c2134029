//! Weights for which every cell has its wanted mass: a step of Newton's method.
//!
//! The derivative of the cells' masses by the weights is a graph Laplacian over neighbouring cells (Kitagawa, Mérigot,
//! Thibert 2019, DOI 10.4171/JEMS/889), solved by conjugate gradients.

use glam::DVec3;

use super::near::Site;
use super::owners::{Border, Diagram};
use crate::parallel;
use crate::sets::Sets;

/// Changes of the weights that bring the cells' masses to `wanted`, to first order, when the sites move by `moves` at
/// the same time.
///
/// A border between two sites moves by the mean of their moves, so what the moves do to the masses is known before
/// they are made. Without this term large waves of moves and weights answer each other and do not die away.
pub(super) fn weight_steps(diagram: &Diagram, sites: &[Site], moves: &[DVec3], wanted: &[f64]) -> Vec<f64> {
    let mut missing: Vec<f64> = wanted.iter().zip(&diagram.cells).map(|(w, c)| w - c.mass).collect();
    for border in &diagram.borders {
        let (a, b) = (border.a as usize, border.b as usize);
        let passed =
            border.flow * (moves[a] + moves[b]).dot(sites[b].place.position - sites[a].place.position);
        missing[a] -= passed;
        missing[b] += passed;
    }
    level_parts(&mut missing, &diagram.borders);
    Laplacian::new(diagram.cells.len(), &diagram.borders).solve(&missing)
}

/// Takes its mean from each part of the cells that no border joins to another part. A patch may fall into parts whose
/// masses are no whole numbers of cells; no weights mend that, and conjugate gradients would run away from it.
fn level_parts(missing: &mut [f64], borders: &[Border]) {
    let mut parts = Sets::new(missing.len());
    for border in borders {
        parts.join(border.a, border.b);
    }
    let mut sums = vec![(0.0, 0.0); missing.len()];
    for (i, &value) in (0..).zip(missing.iter()) {
        let part = &mut sums[parts.root(i) as usize];
        *part = (part.0 + value, part.1 + 1.0);
    }
    for (i, value) in (0..).zip(missing.iter_mut()) {
        let (sum, count) = sums[parts.root(i) as usize];
        *value -= sum / count;
    }
}

/// A symmetric matrix with rows that sum to zero, in rows.
struct Laplacian {
    ends: Vec<u32>,
    entries: Vec<(u32, f64)>,
    diagonal: Vec<f64>,
}

impl Laplacian {
    fn new(count: usize, borders: &[Border]) -> Self {
        // Counting sort of both directions by row, then equal columns are added up.
        let mut starts = vec![0u32; count + 1];
        for border in borders {
            starts[border.a as usize + 1] += 1;
            starts[border.b as usize + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut cursor = starts.clone();
        let mut sorted = vec![(0u32, 0.0); borders.len() * 2];
        for border in borders {
            for (row, column) in [(border.a, border.b), (border.b, border.a)] {
                let slot = &mut cursor[row as usize];
                sorted[*slot as usize] = (column, border.flow);
                *slot += 1;
            }
        }
        let mut entries: Vec<(u32, f64)> = Vec::with_capacity(count * 6);
        let mut ends = Vec::with_capacity(count);
        let mut diagonal = Vec::with_capacity(count);
        for row in 0..count {
            let start = entries.len();
            let mut sum = 0.0;
            for &(column, flow) in &sorted[starts[row] as usize..starts[row + 1] as usize] {
                sum += flow;
                match entries[start..].iter_mut().find(|e| e.0 == column) {
                    Some(entry) => entry.1 += flow,
                    None => entries.push((column, flow)),
                }
            }
            ends.push(entries.len() as u32);
            diagonal.push(sum);
        }
        Self { ends, entries, diagonal }
    }

    /// The entries of a row beside its diagonal.
    fn row(&self, row: usize) -> &[(u32, f64)] {
        let start = if row == 0 { 0 } else { self.ends[row - 1] as usize };
        &self.entries[start..self.ends[row] as usize]
    }

    /// Conjugate gradients, preconditioned by the diagonal. Rows without neighbours stay at zero.
    fn solve(&self, right: &[f64]) -> Vec<f64> {
        const MOST_ITERATIONS: usize = 60;
        const ACCURACY: f64 = 1e-2;
        let inverse = |row: usize| if self.diagonal[row] > 0.0 { self.diagonal[row].recip() } else { 0.0 };
        let mut state: Vec<Unknown> = (0..right.len())
            .map(|row| {
                let residual = if self.diagonal[row] > 0.0 { right[row] } else { 0.0 };
                Unknown { value: 0.0, residual, image: 0.0 }
            })
            .collect();
        let mut direction: Vec<f64> =
            state.iter().enumerate().map(|(row, s)| s.residual * inverse(row)).collect();
        let mut size: f64 = state.iter().zip(&direction).map(|(s, d)| s.residual * d).sum();
        let goal = size * ACCURACY * ACCURACY;
        for _ in 0..MOST_ITERATIONS {
            if size <= goal {
                break;
            }
            let curvature = update(&mut state, |row, unknown| {
                let beside = self.row(row).iter().map(|&(column, flow)| flow * direction[column as usize]);
                unknown.image = self.diagonal[row] * direction[row] - beside.sum::<f64>();
                unknown.image * direction[row]
            });
            if curvature <= 0.0 {
                break;
            }
            let step = size / curvature;
            let next = update(&mut state, |row, unknown| {
                unknown.value += step * direction[row];
                unknown.residual -= step * unknown.image;
                unknown.residual * unknown.residual * inverse(row)
            });
            let turn = next / size;
            size = next;
            parallel::change_chunks(&mut direction, CHUNK, |first, chunk| {
                for ((row, direction), unknown) in (first..).zip(chunk).zip(&state[first..]) {
                    *direction = unknown.residual * inverse(row) + turn * *direction;
                }
            });
        }
        state.into_iter().map(|unknown| unknown.value).collect()
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

/// How many rows are worked on together.
const CHUNK: usize = 1 << 13;

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
