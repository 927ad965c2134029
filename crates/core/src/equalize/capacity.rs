//! Weights for which every cell has its wanted mass: a step of Newton's method.
//!
//! The derivative of the cells' masses by the weights is a graph Laplacian over neighbouring cells (Kitagawa, Mérigot,
//! Thibert 2019, DOI 10.4171/JEMS/889), solved by conjugate gradients.

use glam::DVec3;

use super::diagram::{Border, Diagram};
use super::near::Site;

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
    let mut parents: Vec<u32> = (0..missing.len() as u32).collect();
    for border in borders {
        let (a, b) = (root(&mut parents, border.a), root(&mut parents, border.b));
        parents[a.max(b) as usize] = a.min(b);
    }
    let mut sums = vec![(0.0, 0.0); missing.len()];
    for (i, &value) in (0..).zip(missing.iter()) {
        let part = &mut sums[root(&mut parents, i) as usize];
        *part = (part.0 + value, part.1 + 1.0);
    }
    for (i, value) in (0..).zip(missing.iter_mut()) {
        let (sum, count) = sums[root(&mut parents, i) as usize];
        *value -= sum / count;
    }
}

fn root(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        parents[i as usize] = parents[parents[i as usize] as usize];
        i = parents[i as usize];
    }
    i
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

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        let mut start = 0;
        for row in 0..x.len() {
            let end = self.ends[row] as usize;
            let mut sum = self.diagonal[row] * x[row];
            for &(column, flow) in &self.entries[start..end] {
                sum -= flow * x[column as usize];
            }
            y[row] = sum;
            start = end;
        }
    }

    /// Conjugate gradients, preconditioned by the diagonal. Rows without neighbours stay at zero.
    fn solve(&self, right: &[f64]) -> Vec<f64> {
        const MOST_ITERATIONS: usize = 60;
        const ACCURACY: f64 = 1e-2;
        let inverse: Vec<f64> =
            self.diagonal.iter().map(|d| if *d > 0.0 { d.recip() } else { 0.0 }).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let count = right.len();
        let mut x = vec![0.0; count];
        let mut r: Vec<f64> =
            right.iter().zip(&inverse).map(|(b, i)| if *i > 0.0 { *b } else { 0.0 }).collect();
        let mut z: Vec<f64> = r.iter().zip(&inverse).map(|(r, i)| r * i).collect();
        let mut p = z.clone();
        let mut q = vec![0.0; count];
        let mut rz = dot(&r, &z);
        let goal = rz * ACCURACY * ACCURACY;
        for _ in 0..MOST_ITERATIONS {
            if rz <= goal {
                break;
            }
            self.apply(&p, &mut q);
            let pq = dot(&p, &q);
            if pq <= 0.0 {
                break;
            }
            let alpha = rz / pq;
            for i in 0..count {
                x[i] += alpha * p[i];
                r[i] -= alpha * q[i];
                z[i] = r[i] * inverse[i];
            }
            let next = dot(&r, &z);
            let beta = next / rz;
            rz = next;
            for i in 0..count {
                p[i] = z[i] + beta * p[i];
            }
        }
        x
    }
}
