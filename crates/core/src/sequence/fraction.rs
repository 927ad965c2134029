//! Whole numbers made fractions in [0, 1).

/// 2^53: every whole number up to it is a double.
const EXACT: u64 = 1 << 53;

/// The upper 53 of 64 bits after the binary point, the others cut off.
#[inline]
pub(super) fn of_bits(bits: u64) -> f64 {
    (bits >> 11) as f64 / EXACT as f64
}

/// `numerator / denominator`, for numerator < denominator < 2^127: rounded to nearest where the denominator is at
/// most 2^53 (such a quotient never rounds to 1), else rounded down to a multiple of 2^-53.
pub(super) fn of(numerator: u128, denominator: u128) -> f64 {
    debug_assert!(numerator < denominator && denominator < 1 << 127);
    if denominator <= u128::from(EXACT) {
        // Numbers that fit are converted from signed 64 bits, which is one instruction.
        return (numerator as i64) as f64 / (denominator as i64) as f64;
    }
    let mut rest = numerator;
    let mut bits = 0u64;
    for _ in 0..53 {
        rest <<= 1;
        bits <<= 1;
        if rest >= denominator {
            rest -= denominator;
            bits |= 1;
        }
    }
    bits as f64 / EXACT as f64
}

/// The multiple `index` of a number, modulo 1, plus `start`; both numbers are given as 128 bits after the binary
/// point. Wrong by less than 2^-64 before the last 75 bits are cut off, at any index.
#[inline]
pub(super) fn of_multiple(index: u64, step: u128, start: u128) -> f64 {
    of_bits((u128::from(index).wrapping_mul(step).wrapping_add(start) >> 64) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_stay_below_one() {
        let below_one = 1.0 - 1.0 / EXACT as f64;
        assert_eq!(of_bits(u64::MAX), below_one);
        for denominator in [u128::from(EXACT), u128::from(u64::MAX), 1 << 126] {
            assert_eq!(of(denominator - 1, denominator), below_one);
        }
        assert_eq!(of(1, 3), 1.0 / 3.0);
        // A third cut off after 53 bits.
        assert_eq!(of(1 << 100, 3 << 100), 0.333_333_333_333_333_26);
        assert_eq!(of(3 << 100, 1 << 103), 0.375);
    }
}
