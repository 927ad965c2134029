//! Poisson disk points with an exact count, by weighted sample elimination.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use glam::DVec3;

use super::purpose;
use super::random::draw;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::random::Random;
use crate::sample::SurfacePoint;

/// Random candidates for each point that is kept (the paper's advice).
const CANDIDATES: usize = 5;

/// `count` points with blue noise: of five times as many random candidates the one with the most and nearest
/// neighbours is taken away, again and again. Distances are straight lines in space. None on a mesh without faces.
///
/// Yuksel, "Sample Elimination for Generating Poisson Disk Sample Sets", Computer Graphics Forum 34(2), 2015, DOI
/// 10.1111/cgf.12538, with its alpha = 8, beta = 0.65, gamma = 1.5. O(count log count).
pub fn poisson(mesh: &SurfaceMesh, count: usize, seed: u64) -> Vec<SurfacePoint> {
    let candidates = draw(mesh, count * CANDIDATES, &mut Random::new(seed, purpose::POISSON));
    if candidates.len() <= count {
        return candidates;
    }
    let positions: Vec<DVec3> = candidates.iter().map(|p| mesh.locate(p)).collect();
    // The largest radius that `count` discs can have without covering more than the area: hexagonal packing.
    let radius = (mesh.area() / (2.0 * 3.0f64.sqrt() * count as f64)).sqrt();
    let kept = eliminate(&positions, count, radius);
    kept.into_iter().map(|i| candidates[i]).collect()
}

/// The weight function of the paper (eq. 3 and section 3.1).
struct Weight {
    reach: f64,
    /// Pairs nearer than this weigh as if they were this far apart.
    floor: f64,
}

impl Weight {
    fn new(radius: f64, kept: usize, candidates: usize) -> Self {
        let share = kept as f64 / candidates as f64;
        // share^1.5 without a call to pow.
        let floor = 2.0 * radius * 0.65 * (1.0 - share * share.sqrt());
        Self { reach: 2.0 * radius, floor }
    }

    fn of(&self, distance: f64) -> f64 {
        let base = 1.0 - distance.max(self.floor) / self.reach;
        let squared = base * base;
        let fourth = squared * squared;
        fourth * fourth
    }
}

/// A candidate in the heap under a weight it had at some time: the current weight is never larger.
struct Entry {
    weight: f64,
    index: Reverse<u32>,
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.weight.total_cmp(&other.weight).then(self.index.cmp(&other.index))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// Indices of the `count` positions that remain, ascending.
fn eliminate(positions: &[DVec3], count: usize, radius: f64) -> Vec<usize> {
    let weight = Weight::new(radius, count, positions.len());
    let grid = Grid::new(positions, weight.reach);
    let mut weights = parallel::map(positions.len(), |i| {
        let mut sum = 0.0;
        grid.near(positions, i, weight.reach, |_, distance| sum += weight.of(distance));
        sum
    });
    let mut heap: BinaryHeap<Entry> =
        weights.iter().enumerate().map(|(i, &weight)| Entry { weight, index: Reverse(i as u32) }).collect();
    let mut alive = vec![true; positions.len()];
    let mut left = positions.len();
    while left > count {
        let Some(top) = heap.pop() else { break };
        let i = top.index.0 as usize;
        // Weights only fall, so an outdated entry stands too high: put it back where it belongs.
        if top.weight > weights[i] {
            heap.push(Entry { weight: weights[i], index: top.index });
            continue;
        }
        alive[i] = false;
        left -= 1;
        grid.near(positions, i, weight.reach, |j, distance| {
            if alive[j] {
                weights[j] -= weight.of(distance);
            }
        });
    }
    (0..positions.len()).filter(|&i| alive[i]).collect()
}

/// Positions sorted by the cubic cell that holds them.
struct Grid {
    low: DVec3,
    cell: f64,
    /// Cell keys, ascending, each with the index of a position.
    sorted: Vec<(u64, u32)>,
}

/// Bits of one cell coordinate in a key.
const CELL_BITS: u32 = 21;

impl Grid {
    fn new(positions: &[DVec3], reach: f64) -> Self {
        let low = positions.iter().fold(DVec3::INFINITY, |low, &p| low.min(p));
        let high = positions.iter().fold(DVec3::NEG_INFINITY, |high, &p| high.max(p));
        // A long thin mesh may be wider than 2^21 reaches: then the cells are larger than they need be.
        let cell = reach.max((high - low).max_element() / f64::from(1u32 << (CELL_BITS - 1)));
        let mut grid = Self { low, cell, sorted: Vec::new() };
        grid.sorted = positions
            .iter()
            .enumerate()
            .map(|(i, &p)| {
                let [x, y, z] = grid.cell_of(p);
                (Self::key(x, y, z), i as u32)
            })
            .collect();
        grid.sorted.sort_unstable();
        grid
    }

    /// Cell coordinates, from 1, so that the cell before the first has a key too.
    fn cell_of(&self, p: DVec3) -> [u64; 3] {
        let q = (p - self.low) / self.cell;
        [q.x as u64 + 1, q.y as u64 + 1, q.z as u64 + 1]
    }

    fn key(x: u64, y: u64, z: u64) -> u64 {
        (x << CELL_BITS | y) << CELL_BITS | z
    }

    /// Calls `f` with each other position nearer than `reach` to position `i`, and its distance.
    fn near(&self, positions: &[DVec3], i: usize, reach: f64, mut f: impl FnMut(usize, f64)) {
        let p = positions[i];
        let [x, y, z] = self.cell_of(p);
        for x in x - 1..=x + 1 {
            for y in y - 1..=y + 1 {
                // The three cells along z have keys that follow each other.
                let (first, last) = (Self::key(x, y, z - 1), Self::key(x, y, z + 1));
                let start = self.sorted.partition_point(|entry| entry.0 < first);
                for &(key, j) in &self.sorted[start..] {
                    if key > last {
                        break;
                    }
                    let j = j as usize;
                    let distance = p.distance(positions[j]);
                    if j != i && distance < reach {
                        f(j, distance);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elimination_thins_the_crowd_first() {
        // Nine places of a 3 x 3 grid and a twin of the middle one: the twin or the middle goes.
        let mut positions: Vec<DVec3> =
            (0..9).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 3), 0.0)).collect();
        positions.push(DVec3::new(1.1, 1.0, 0.0));
        let kept = eliminate(&positions, 9, 0.6);
        assert_eq!(kept.len(), 9);
        assert!(kept.contains(&4) != kept.contains(&9));
        assert!((0..9).filter(|&i| i != 4).all(|i| kept.contains(&i)));
    }

    #[test]
    fn the_grid_finds_what_a_full_search_finds() {
        let mut random = Random::new(1, 2);
        let positions: Vec<DVec3> = (0..300)
            .map(|_| DVec3::new(random.unit() * 3.0 - 1.0, random.unit(), random.unit() * 0.2))
            .collect();
        let grid = Grid::new(&positions, 0.3);
        for i in 0..positions.len() {
            let mut found = Vec::new();
            grid.near(&positions, i, 0.3, |j, _| found.push(j));
            found.sort_unstable();
            let all: Vec<usize> =
                (0..300).filter(|&j| j != i && positions[i].distance(positions[j]) < 0.3).collect();
            assert_eq!(found, all);
        }
    }
}
