//! The planar domain (paper, 4.2 steps 1 to 3): where each strip lies, and the points scattered on it.

use std::ops::Range;

use glam::DVec2;

use crate::parallel;
use crate::sequence::{self, Sequence};
use crate::unfold::Strips;

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
    indices: Vec<u32>,
    starts: Vec<u32>,
    cells: usize,
    cell_side: f64,
}

impl DomainPoints {
    /// The first `count` points of the sequence, moved by `shift` on the torus and scaled to the domain. Linear time.
    pub fn scatter(domain: &PlanarDomain, sequence: &Sequence, count: u32, shift: DVec2) -> Self {
        const CHUNK: usize = 1 << 14;
        let cells = (libm::sqrt(f64::from(count)) as usize).max(1);
        let cell_side = domain.side / cells as f64;
        let all: Vec<DVec2> = parallel::map_chunks(count as usize, CHUNK, |range| {
            range
                .map(|i| sequence::shift(sequence.point(i as u64, u64::from(count)), shift) * domain.side)
                .collect::<Vec<_>>()
        })
        .concat();
        let mut points = Self {
            places: Vec::new(),
            indices: Vec::new(),
            starts: vec![0; cells * cells + 1],
            cells,
            cell_side,
        };
        for &p in &all {
            let cell = points.row(p.y) * cells + points.row(p.x);
            points.starts[cell + 1] += 1;
        }
        for c in 0..cells * cells {
            points.starts[c + 1] += points.starts[c];
        }
        let mut cursor = points.starts.clone();
        points.places = vec![DVec2::ZERO; all.len()];
        points.indices = vec![0; all.len()];
        for (i, &p) in (0..).zip(&all) {
            let slot = &mut cursor[points.row(p.y) * cells + points.row(p.x)];
            points.places[*slot as usize] = p;
            points.indices[*slot as usize] = i;
            *slot += 1;
        }
        points
    }

    /// How many points there are.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Where a slot's point lies, and which of the sequence it is.
    #[inline]
    pub fn at(&self, slot: usize) -> (DVec2, u32) {
        (self.places[slot], self.indices[slot])
    }

    /// The row (or column) of cells that holds a coordinate; the nearest one outside the domain.
    #[inline]
    fn row(&self, x: f64) -> usize {
        // The cast saturates: below 0 and NaN give 0.
        ((x / self.cell_side) as usize).min(self.cells - 1)
    }

    /// The slots of the points that may lie in the box: one run for each row of cells.
    pub fn in_box(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = Range<usize>> + use<'_> {
        let (left, right) = (self.row(low.x), self.row(high.x));
        (self.row(low.y)..=self.row(high.y)).map(move |row| self.run(row, left, right))
    }

    fn run(&self, row: usize, left: usize, right: usize) -> Range<usize> {
        let base = row * self.cells;
        self.starts[base + left] as usize..self.starts[base + right + 1] as usize
    }

    /// The slots of the points that may lie in the triangle: one run for each row of cells, cut to the triangle.
    pub fn in_triangle(&self, corners: [DVec2; 3]) -> impl Iterator<Item = Range<usize>> + use<'_> {
        let [a, b, c] = corners;
        let low = a.min(b).min(c);
        let high = a.max(b).max(c);
        let (first, last) = (self.row(low.y), self.row(high.y));
        (first..=last).map(move |row| {
            if first == last || low.x == high.x {
                return self.run(row, self.row(low.x), self.row(high.x));
            }
            // Rounding of the cuts is far below this margin.
            let margin = 1e-6 * self.cell_side;
            let bottom = row as f64 * self.cell_side - margin;
            let top = bottom + self.cell_side + 2.0 * margin;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let (p, q) = if p.y <= q.y { (p, q) } else { (q, p) };
                if p.y > top || q.y < bottom {
                    continue;
                }
                let x_at =
                    |y: f64| if q.y > p.y { p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)) } else { p.x };
                let (x, z) =
                    (if p.y < bottom { x_at(bottom) } else { p.x }, if q.y > top { x_at(top) } else { q.x });
                left = left.min(x).min(z);
                right = right.max(x).max(z);
            }
            if left > right {
                return 0..0;
            }
            self.run(row, self.row(left - margin), self.row(right + margin))
        })
    }
}
