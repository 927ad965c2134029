//! Hammersley points, which need no list: those of a row of the square are an arithmetic progression of numbers, and lie
//! in it from left to right.

use std::ops::RangeInclusive;

use glam::DVec2;

use super::PlanarDomain;
use super::bands::Bands;
use super::occupied::Occupied;
use crate::lanes::{LANES, Lanes};
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
    /// Its reciprocal: the height of a row as a share of the side.
    height: f64,
    digits: u32,
    /// The first number whose point is carried around in x.
    turn: u64,
    /// Where any points are, if they are few.
    occupied: Option<Occupied>,
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
        let shift = sequence::shift(DVec2::ZERO, shift);
        let (mut turn, mut end) = (0, count);
        while turn < end {
            let middle = turn + (end - turn) / 2;
            if exact(middle) / exact(count) + shift.x >= 1.0 {
                end = middle;
            } else {
                turn = middle + 1;
            }
        }
        let (side, height) = (domain.side, 1.0 / exact(rows));
        let mut lattice = Self { base, count, shift, side, rows, height, digits, turn, occupied: None };
        lattice.occupied = Occupied::new(side, count, |index| lattice.place(index));
        lattice
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

    /// As [`place`](Self::place), of some points.
    #[inline(always)]
    pub(super) fn places(&self, indices: &[u64; LANES]) -> [Lanes; 2] {
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        if self.base == 2 {
            for lane in 0..LANES {
                y[lane] = radical_inverse(indices[lane], 2);
            }
        } else {
            y = indices.map(|index| radical_inverse(index, self.base));
        }
        let count = exact(self.count);
        for lane in 0..LANES {
            x[lane] = around(exact(indices[lane]) / count + self.shift.x) * self.side;
            y[lane] = around(y[lane] + self.shift.y) * self.side;
        }
        [x, y]
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
        let row = |y: f64| {
            let at = ((y / self.side).clamp(0.0, 1.0) - self.shift.y) * rows;
            // Rounded down.
            at as i64 - i64::from(at < (at as i64) as f64)
        };
        let margin = MARGIN * self.side;
        let last = self.rows as i64 - 1;
        row(low - margin)..=row(high + margin).min(last)
    }

    /// The points that may lie in the convex polygon, each once: those of its rows, cut to it. `visit` hears some at a time
    /// and where they lie; lanes beyond them hold places of others.
    #[inline]
    pub(super) fn in_polygon<const N: usize>(
        &self,
        corners: [DVec2; N],
        visit: &mut impl FnMut(&[u64], &[Lanes; 2]),
    ) {
        /// Points that are held back so that lanes are full.
        const HELD: usize = 16 * LANES;
        /// As a rule as many points as a row of a triangle has, or more.
        const TOGETHER: usize = 8;
        // Rounding is far below these margins.
        let margin = MARGIN * self.side;
        if let Some(occupied) = &self.occupied {
            let low = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
            let high = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
            if !occupied.may_hold(low - margin, high + margin) {
                return;
            }
        }
        let mut look = |indices: &[u64]| {
            for some in indices.chunks(LANES) {
                let mut lanes = [some[0]; LANES];
                lanes[..some.len()].copy_from_slice(some);
                visit(some, &self.places(&lanes));
            }
        };
        let (mut held, mut count) = ([0; HELD], 0);
        let mut hold = |mut index: u64, mut points: u64| {
            while points > 0 {
                if count + TOGETHER > HELD {
                    let whole = count - count % LANES;
                    look(&held[..whole]);
                    held.copy_within(whole..count, 0);
                    count -= whole;
                }
                // All of them whether they are points of the row or not: how many are is not foreseen.
                for (held, nth) in held[count..count + TOGETHER].iter_mut().zip(0..) {
                    *held = index + nth * self.rows;
                }
                let some = points.min(TOGETHER as u64);
                count += some as usize;
                index += some * self.rows;
                points -= some;
            }
        };
        let bands = Bands::new(corners);
        let height = self.side / exact(self.rows);
        let (first, last) = self.rows(bands.low.y, bands.high.y).into_inner();
        for row in (first..=last).step_by(LANES) {
            let mut bottoms = [0.0; LANES];
            for (bottom, row) in bottoms.iter_mut().zip(row..) {
                *bottom = row as f64 * height + self.shift.y * self.side - margin;
            }
            let [mut left, mut right] = bands.between(&bottoms, height + 2.0 * margin);
            for lane in 0..LANES {
                (left[lane], right[lane]) =
                    (left[lane] / self.side - MARGIN, right[lane] / self.side + MARGIN);
            }
            for (lane, row) in (row..=last).take(LANES).enumerate() {
                if left[lane] <= right[lane] {
                    self.in_row(row, left[lane], right[lane], &mut hold);
                }
            }
        }
        look(&held[..count]);
    }

    /// The points of a row between two x, as shares of the side, each once: `hold` hears the first and how many there are.
    #[inline]
    fn in_row(&self, row: i64, left: f64, right: f64, hold: &mut impl FnMut(u64, u64)) {
        let residue = self.residue(if row < 0 { row + self.rows as i64 } else { row } as u64);
        let count = exact(self.count);
        let (left, right) = (left.max(0.0), right.min(1.0));
        let bottom = row as f64 * self.height + self.shift.y;
        // A row that the torus cuts holds points of both sides.
        let is_cut = if row < 0 { bottom < CUT } else { bottom + self.height > 1.0 - CUT };
        // What was carried around in x lies from 1 less the shift on.
        for (numbers, turn) in [(0..self.turn, -self.shift.x), (self.turn..self.count, 1.0 - self.shift.x)] {
            let (from, to) = (left + turn, right + turn);
            if numbers.is_empty() || from >= 1.0 || to < 0.0 {
                continue;
            }
            let steps = (from * count - exact(residue)) * self.height;
            let whole = steps as i64;
            let steps = (whole + i64::from((whole as f64) < steps)).max(0) as u64;
            let mut index = residue + steps * self.rows;
            let end = ((to * count) as i64 as u64 + 1).min(numbers.end);
            while index < numbers.start {
                index += self.rows;
            }
            if !is_cut && index < end {
                let further = end - 1 - index;
                hold(index, 1 + if self.base == 2 { further >> self.digits } else { further / self.rows });
            }
            while is_cut && index < end {
                if (self.moved(index).y >= 1.0) == (row < 0) {
                    hold(index, 1);
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

/// As a share of the side, how near to where the torus is cut a row is looked at closely: also far above rounding.
const CUT: f64 = 1e-9;

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
