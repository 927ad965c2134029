//! The first two dimensions of Sobol's sequence, scrambled.

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
