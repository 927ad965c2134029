//! The Fibonacci lattice, extended from Fibonacci numbers to any number of points.

use glam::DVec2;

use crate::sequence::fraction;

/// The reciprocal of the golden ratio, 128 bits after the binary point.
const STEP: u128 = 0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c834;

/// (i / n, i / golden ratio modulo 1).
pub(super) fn point(index: u64, count: u64) -> DVec2 {
    let count = count.max(1);
    let index = index % count;
    DVec2::new(fraction::of(u128::from(index), u128::from(count)), fraction::of_multiple(index, STEP, 0))
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
