//! R2: the additive recurrence of the plastic number, the two-dimensional sibling of the golden ratio.

use glam::DVec2;

use crate::sequence::fraction;

/// a = 1/g, 128 bits after the binary point, where g^3 = g + 1.
const FIRST: u128 = 0xc13f_a9a9_02a6_328f_434f_f71b_2d97_724b;
/// a^2.
const SECOND: u128 = 0x91e1_0da5_c79e_7b1c_d438_a0a8_e6c9_c0fc;
/// One half, where the author starts.
const START: u128 = 1 << 127;

/// (i a + 1/2, i a^2 + 1/2) modulo 1.
pub(super) fn point(index: u64) -> DVec2 {
    DVec2::new(fraction::of_multiple(index, FIRST, START), fraction::of_multiple(index, SECOND, START))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The upper half of the product of two numbers of 128 bits after the point, to a few units of the last place.
    fn product(a: u128, b: u128) -> u128 {
        let low = u128::from(u64::MAX);
        let (ah, al, bh, bl) = (a >> 64, a & low, b >> 64, b & low);
        ah * bh + ((ah * bl) >> 64) + ((al * bh) >> 64)
    }

    #[test]
    fn constants_satisfy_their_equation() {
        // g^3 = g + 1 divided by g^3: 1 = a^2 + a^3.
        assert!(product(FIRST, FIRST).abs_diff(SECOND) < 8);
        assert!(product(SECOND, FIRST).wrapping_add(SECOND).wrapping_add(8) < 16);
    }

    #[test]
    fn first_points() {
        assert_eq!(point(0), DVec2::splat(0.5));
        let near = |p: DVec2, x: f64, y: f64| p.distance(DVec2::new(x, y)) < 1e-15;
        assert!(near(point(1), 0.254_877_666_246_692_8, 0.069_840_290_998_053_27));
        assert!(near(point(2), 0.009_755_332_493_385_52, 0.639_680_581_996_106_5));
    }

    #[test]
    fn far_points_are_as_exact_as_near_ones() {
        // Steps of 2^63 twice are a step of 2^64: 0 but for the error of the constants.
        let back = point(5) - (point(u64::MAX) - point(u64::MAX - 5));
        let wrapped = back - back.round() - DVec2::splat(0.5);
        assert!((wrapped - wrapped.round()).length() < 1e-15, "{wrapped}");
    }
}
