//! The first two dimensions of Sobol's sequence, scrambled.

use std::ops::Range;

use glam::DVec2;

use crate::sequence::{fraction, scramble};

/// The first dimension: the radical inverse in base 2, as 64 bits after the binary point.
#[inline]
fn first(index: u64) -> u64 {
    index.reverse_bits()
}

/// The second dimension, the one of the primitive polynomial x + 1, as 64 bits after the binary point. Its
/// generator matrix is Pascal's triangle modulo 2, the sixfold tensor power of (1 1; 0 1): six steps multiply by it.
#[inline]
fn second(index: u64) -> u64 {
    const MASKS: [u64; 6] = [
        0x5555_5555_5555_5555,
        0x3333_3333_3333_3333,
        0x0f0f_0f0f_0f0f_0f0f,
        0x00ff_00ff_00ff_00ff,
        0x0000_ffff_0000_ffff,
        0x0000_0000_ffff_ffff,
    ];
    let mut bits = index;
    for (step, mask) in MASKS.into_iter().enumerate() {
        bits ^= (bits >> (1 << step)) & mask;
    }
    bits.reverse_bits()
}

/// Point i; each dimension has a scrambling of its own.
pub(super) fn point(seed: u64, index: u64) -> DVec2 {
    let scrambled = |bits, dimension| fraction::of_bits(scramble::nested(bits, seed, dimension));
    DVec2::new(scrambled(first(index), 0), scrambled(second(index), 1))
}

/// Finds the points of a box: an aligned block of 2^(along + across) indices has one point in each box of width
/// 2^-along and height 2^-across, whose index solves a linear system over two elements.
#[derive(Clone, Debug)]
pub(super) struct Solver {
    seed: u64,
    along: u32,
    across: u32,
    /// Row r of the inverse of the matrix that takes the middle bits of an index to the first bits of its second
    /// coordinate.
    inverse: Vec<u64>,
}

impl Solver {
    pub(super) fn new(seed: u64, count: u64) -> Self {
        let bits = count.max(1).ilog2().min(52);
        let across = bits / 2;
        let along = bits - across;
        // Column c of the matrix: what the index bit along + c does to the first `across` bits. Rows are solved with
        // the unit matrix beside them.
        let image: Vec<u64> = (0..across).map(|c| first_bits(second(1 << (along + c)), across)).collect();
        let mut rows: Vec<(u64, u64)> = (0..across)
            .map(|r| {
                let row =
                    (0..across).fold(0, |row, c| row | (image[c as usize] >> (across - 1 - r) & 1) << c);
                (row, 1 << r)
            })
            .collect();
        for c in 0..across as usize {
            // A net has a point in every box, so the matrix can be inverted and there is a pivot.
            let pivot = (c..rows.len()).find(|&r| rows[r].0 >> c & 1 == 1).unwrap_or(c);
            rows.swap(c, pivot);
            for r in 0..rows.len() {
                if r != c && rows[r].0 >> c & 1 == 1 {
                    rows[r].0 ^= rows[c].0;
                    rows[r].1 ^= rows[c].1;
                }
            }
        }
        Self { seed, along, across, inverse: rows.into_iter().map(|(_, inverse)| inverse).collect() }
    }

    /// Appends the indices below `count` of the points in all boxes that meet the ranges.
    pub(super) fn candidates(&self, x: Range<f64>, y: Range<f64>, count: u64, found: &mut Vec<u64>) {
        let columns = self.unscrambled(&x, self.along, 0);
        let rows = self.unscrambled(&y, self.across, 1);
        let block = self.along + self.across;
        for &column in &columns {
            let low = column.reverse_bits();
            for start in (0..count).step_by(1 << block) {
                let known = start | low;
                let reached = first_bits(second(known), self.across);
                for &row in &rows {
                    let missing = first_bits(row, self.across) ^ reached;
                    let missing = missing.reverse_bits() >> 1 >> (63 - self.across);
                    let middle = (0..).zip(&self.inverse).fold(0, |bits, (c, inverse)| {
                        bits | u64::from((inverse & missing).count_ones() & 1) << c
                    });
                    let index = known | middle << self.along;
                    if index < count {
                        found.push(index);
                    }
                }
            }
        }
    }

    /// The first `bits` bits, before scrambling, of the intervals that meet the range.
    fn unscrambled(&self, range: &Range<f64>, bits: u32, dimension: u64) -> Vec<u64> {
        let scale = (1u64 << bits) as f64;
        let first = (range.start * scale).floor().max(0.0) as u64;
        let end = ((range.end * scale).floor() as u64 + 1).min(1 << bits);
        let aligned = |k: u64| if bits == 0 { 0 } else { k << (64 - bits) };
        (first..end).map(|k| scramble::undo(aligned(k), bits, self.seed, dimension)).collect()
    }
}

/// The first bits after the point, as a whole number.
fn first_bits(fraction: u64, bits: u32) -> u64 {
    fraction >> 1 >> (63 - bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn unscrambled_values_are_the_published_ones() {
        // Second coordinates as tabulated with the direction numbers of Joe and Kuo, DOI 10.1137/070709359.
        let y = [0.0, 0.5, 0.75, 0.25, 0.625, 0.125, 0.375, 0.875];
        for (i, y) in y.into_iter().enumerate() {
            assert_eq!(fraction::of_bits(second(i as u64)), y, "point {i}");
        }
    }

    #[test]
    fn seeds_differ() {
        let points = |seed| (0..16).map(|i| point(seed, i)).collect::<Vec<_>>();
        assert_ne!(points(0), points(1));
        assert_eq!(points(5), points(5));
    }

    proptest! {
        /// Against the definition: direction numbers v_1 = 1/2, v_(k+1) = v_k xor v_k / 2, one for each bit set.
        #[test]
        fn matches_the_direction_numbers(index: u64) {
            let mut direction = 1u64 << 63;
            let mut bits = 0;
            for k in 0..64 {
                if index >> k & 1 == 1 {
                    bits ^= direction;
                }
                direction ^= direction >> 1;
            }
            prop_assert_eq!(second(index), bits);
        }
    }
}
