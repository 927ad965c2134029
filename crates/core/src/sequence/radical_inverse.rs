//! The radical inverse: the digits of a whole number mirrored at the point.

use crate::sequence::fraction;

/// The radical inverse of `index`: 6 is 110 in base 2 and gives 0.011 there, 0.375. In base 2 the bits are
/// reversed and those beyond 53 cut off: exact for indices below 2^53. In other bases the mirrored number is built
/// from whole numbers and divided once: rounded to nearest for indices below 2^53 / base, rounded down to a multiple
/// of 2^-53 above. Never 1. A base below 2 has no digits and gives 0. Cost: one division a digit, none in base 2.
#[inline]
pub fn radical_inverse(index: u64, base: u32) -> f64 {
    match base {
        0 | 1 => 0.0,
        2 => fraction::of_bits(index.reverse_bits()),
        _ => {
            // Both stay below 2^64 * 2^32.
            let (mut mirrored, mut scale) = (0u128, 1u128);
            let base = u64::from(base);
            let mut rest = index;
            while rest != 0 {
                mirrored = mirrored * u128::from(base) + u128::from(rest % base);
                scale *= u128::from(base);
                rest /= base;
            }
            fraction::of(mirrored, scale)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn first_values_by_hand() {
        let base_2 = [0.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875, 0.0625];
        let base_3 =
            [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0 / 9.0, 4.0 / 9.0, 7.0 / 9.0, 2.0 / 9.0, 5.0 / 9.0, 8.0 / 9.0];
        let base_10 = [(1, 0.1), (7, 0.7), (123, 0.321), (9_999, 0.9999), (1_000_000, 0.000_000_1)];
        for i in 0..9 {
            assert_eq!(radical_inverse(i as u64, 2), base_2[i]);
            assert_eq!(radical_inverse(i as u64, 3), base_3[i]);
        }
        for (index, value) in base_10 {
            assert_eq!(radical_inverse(index, 10), value);
        }
    }

    #[test]
    fn largest_indices() {
        let below_one = 1.0 - f64::EPSILON / 2.0;
        assert_eq!(radical_inverse(u64::MAX, 2), below_one);
        assert_eq!(radical_inverse(1 << 63, 2), 0.0, "2^-64 is cut off");
        assert_eq!(radical_inverse(1 << 52, 2), f64::EPSILON / 2.0);
        // With base b = 2^32 - 1: 2^64 - 1 = b^2 + 2 b, digits 1 2 0 mirrored to 0.021, which is cut off; one less
        // has the digits 1 1 (b - 1).
        assert_eq!(radical_inverse(u64::MAX, u32::MAX), 0.0);
        let b = f64::from(u32::MAX);
        assert!(
            (radical_inverse(u64::MAX - 1, u32::MAX) - (1.0 - 1.0 / b + 1.0 / (b * b))).abs() < f64::EPSILON
        );
        assert!(radical_inverse(3u64.pow(40) - 1, 3) < 1.0);
    }

    proptest! {
        #[test]
        fn digits_are_mirrored(digits in prop::collection::vec(0..7u64, 1..18)) {
            let index = digits.iter().rev().fold(0, |sum, d| sum * 7 + d);
            let scale = digits.iter().fold(1.0, |scale, _| scale * 7.0);
            let mirrored = digits.iter().fold(0, |sum, d| sum * 7 + d);
            prop_assert!((radical_inverse(index, 7) - mirrored as f64 / scale).abs() <= f64::EPSILON / 2.0);
        }
    }
}
