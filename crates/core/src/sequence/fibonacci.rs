//! The Fibonacci lattice, extended from Fibonacci numbers to any number of points.

use std::ops::Range;

use glam::DVec2;

use crate::sequence::fraction;

/// The reciprocal of the golden ratio, 128 bits after the binary point.
const STEP: u128 = 0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c834;

/// (i / n, i / golden ratio modulo 1).
pub(super) fn point(index: u64, count: u64) -> DVec2 {
    let count = count.max(1);
    let index = if index < count { index } else { index % count };
    DVec2::new(fraction::of(u128::from(index), u128::from(count)), fraction::of_multiple(index, STEP, 0))
}

/// The first index from `from` on whose second coordinate lies in the range, or just beside it; `None` if it is
/// beyond 2^53.
pub(super) fn next_visit(from: u64, y: &Range<f64>) -> Option<u64> {
    // 96 bits after the point: exact enough for 2^53 steps, and the products below fit in 128.
    const ONE: u128 = 1 << 96;
    let bits = |x: f64| ((x * 18_446_744_073_709_551_616.0) as u128) << 32;
    let here = u128::from(from).wrapping_mul(STEP) >> 32;
    let low = (bits(y.start) + ONE - here) % ONE;
    let high = low + (bits(y.end) - bits(y.start)).min(ONE - 1);
    if low == 0 || high >= ONE {
        return Some(from);
    }
    let steps = first_multiple(STEP >> 32, ONE, low, high)?;
    from.checked_add(u64::try_from(steps).ok()?).filter(|i| *i <= 1 << 53)
}

/// The smallest k with `low` <= k `step` modulo `modulus` <= `high`: Euclid's algorithm on intervals.
fn first_multiple(step: u128, modulus: u128, low: u128, high: u128) -> Option<u128> {
    if low == 0 {
        return Some(0);
    }
    if step == 0 {
        return None;
    }
    let k = low.div_ceil(step);
    if k * step <= high {
        return Some(k);
    }
    // k step - t modulus is in [low, high] when t modulus, modulo step, is in this interval.
    let turns = first_multiple(modulus % step, step, k * step - high, k * step - low)?;
    turns.checked_mul(modulus)?.checked_add(low).map(|reached| reached.div_ceil(step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_points() {
        assert_eq!(point(0, 4), DVec2::ZERO);
        assert!(point(1, 4).distance(DVec2::new(0.25, 0.618_033_988_749_894_8)) < 1e-15);
        assert!(point(2, 4).distance(DVec2::new(0.5, 0.236_067_977_499_789_7)) < 1e-15);
    }

    #[test]
    fn far_apart_where_the_count_is_a_fibonacci_number() {
        // Distances on the torus; the lattice of 233 points keeps them all above 0.9 / sqrt(n).
        let n = 233;
        let points: Vec<_> = (0..n).map(|i| point(i, n)).collect();
        let mut smallest = f64::INFINITY;
        for (i, p) in points.iter().enumerate() {
            for q in &points[..i] {
                let d = *p - *q;
                smallest = smallest.min((d - d.round()).length());
            }
        }
        assert!(smallest * (n as f64).sqrt() > 0.9, "{}", smallest * (n as f64).sqrt());
    }
}
