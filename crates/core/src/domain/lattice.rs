//! Hammersley points, which need no list: those of a row of the square are an arithmetic progression of numbers, and lie
//! in it from left to right.

use std::ops::RangeInclusive;

use glam::DVec2;

use super::PlanarDomain;
use super::bands::Bands;
use crate::sequence::{self, radical_inverse};

/// The points (i / count, radical inverse of i), moved on the torus and scaled to the domain.
///
/// In base b the numbers of the points whose second coordinate lies in [j / b^k, (j + 1) / b^k) are those whose last k
/// digits are the mirrored digits of j. These are the rows; about as many as points lie in each.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    base: u32,
    count: u64,
    /// In [0, 1)^2.
    shift: DVec2,
    side: f64,
    /// base^digits.
    rows: u64,
    digits: u32,
}

impl Lattice {
    /// `count` is at most 2^53, so that every number is a double.
    pub(super) fn new(domain: &PlanarDomain, base: u32, count: u64, shift: DVec2) -> Self {
        let base = base.max(2);
        let wanted = libm::sqrt(count as f64) * ROWS;
        let (mut rows, mut digits) = (1_u64, 0);
        // As near as possible, as a ratio.
        while (rows as f64) * f64::from(base) <= wanted * libm::sqrt(f64::from(base)) {
            rows *= u64::from(base);
            digits += 1;
        }
        Self { base, count, shift: sequence::shift(DVec2::ZERO, shift), side: domain.side, rows, digits }
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Where a point lies: the same bits as [`sequence::shift`] gives.
    #[inline]
    pub(super) fn place(&self, index: u64) -> DVec2 {
        let moved = self.moved(index);
        DVec2::new(around(moved.x), around(moved.y)) * self.side
    }

    /// Before what lies beyond 1 is carried around the torus.
    #[inline]
    fn moved(&self, index: u64) -> DVec2 {
        let y = if self.base == 2 { radical_inverse(index, 2) } else { radical_inverse(index, self.base) };
        DVec2::new(exact(index) / exact(self.count), y) + self.shift
    }

    /// The rows between two heights. Row t lies from t rows above the shift on; those below it hold what was carried
    /// around.
    fn rows(&self, low: f64, high: f64) -> RangeInclusive<i64> {
        let rows = exact(self.rows);
        let row = |y: f64| (((y / self.side).clamp(0.0, 1.0) - self.shift.y) * rows).floor() as i64;
        let margin = MARGIN * self.side;
        let last = self.rows as i64 - 1;
        row(low - margin)..=row(high + margin).min(last)
    }

    /// The points that may lie in the convex polygon, each once: those of its rows, cut to it.
    #[inline]
    pub(super) fn in_polygon<const N: usize>(&self, corners: [DVec2; N], visit: &mut impl FnMut(u64, DVec2)) {
        let bands = Bands::new(corners);
        let height = self.side / exact(self.rows);
        // Rounding is far below these margins.
        let margin = MARGIN * self.side;
        for row in self.rows(bands.low.y, bands.high.y) {
            let bottom = row as f64 * height + self.shift.y * self.side - margin;
            if let Some((left, right)) = bands.between(bottom, bottom + height + 2.0 * margin) {
                self.in_row(row, left, right, visit);
            }
        }
    }

    /// The points of a row between two x, each once.
    #[inline]
    fn in_row(&self, row: i64, left: f64, right: f64, visit: &mut impl FnMut(u64, DVec2)) {
        let residue = self.residue(row.rem_euclid(self.rows as i64) as u64);
        let (left, right) = (left / self.side - MARGIN, right / self.side + MARGIN);
        let count = exact(self.count);
        // What was carried around in x lies from 1 less the shift on.
        for around_x in [false, true] {
            let turn = f64::from(u8::from(around_x)) - self.shift.x;
            let (from, to) = (left.max(0.0) + turn, right.min(1.0) + turn);
            if from >= 1.0 || to < 0.0 {
                continue;
            }
            let first = (from * count).max(0.0) as u64;
            let end = ((to * count) as u64 + 1).min(self.count);
            let mut index = residue + first.saturating_sub(residue).div_ceil(self.rows) * self.rows;
            while index < end {
                let moved = self.moved(index);
                // A row or a run that the torus cuts holds points of both sides.
                if (moved.x >= 1.0) == around_x && (moved.y >= 1.0) == (row < 0) {
                    visit(index, DVec2::new(around(moved.x), around(moved.y)) * self.side);
                }
                index += self.rows;
            }
        }
    }

    /// The last digits of the numbers of a row's points.
    #[inline]
    fn residue(&self, row: u64) -> u64 {
        if self.base == 2 {
            return row.reverse_bits().checked_shr(64 - self.digits).unwrap_or(0);
        }
        let base = u64::from(self.base);
        let (mut rest, mut residue) = (row, 0);
        for _ in 0..self.digits {
            residue = residue * base + rest % base;
            rest /= base;
        }
        residue
    }
}

/// Rows for each point in a row.
const ROWS: f64 = 1.0;

/// Shares of the side by which cuts are wider than computed: far above rounding.
const MARGIN: f64 = 1e-14;

/// Whole numbers up to 2^53; a signed conversion is the faster one.
#[inline]
fn exact(number: u64) -> f64 {
    number as i64 as f64
}

/// Of [0, 2) into [0, 1).
#[inline]
fn around(x: f64) -> f64 {
    if x >= 1.0 { x - 1.0 } else { x }
}
