//! Owen's nested uniform scrambling in base 2, DOI 10.1007/978-1-4612-2552-2_19.

/// Scrambles the upper 53 of 64 bits after the binary point; the others become 0. This is the true nested scrambling, not
/// the cheaper permutation of Laine and Karras (DOI 10.1111/j.1467-8659.2011.02004.x): whether a bit is flipped is a
/// random bit of its own for every value of the bits before it, a hash of these and of the key. Dyadic boxes stay boxes,
/// so a net stays a net. Cost: 53 hashes.
pub(super) fn nested(bits: u64, seed: u64, dimension: u64) -> u64 {
    let key = mix(seed ^ mix(dimension.wrapping_add(1)));
    let mut flips = 0u64;
    for level in 0..53u32 {
        // The bits before this one after a leading 1: a number of its own for every node of the tree.
        let node = (1 << level) | (bits >> (63 - level) >> 1);
        flips |= (mix(key ^ node.wrapping_mul(0x9e37_79b9_7f4a_7c15)) >> 63) << (63 - level);
    }
    (bits ^ flips) & !0x7ff
}

/// What [`nested`] makes into these first `levels` (at most 53) bits; the others are 0.
pub(super) fn undo(scrambled: u64, levels: u32, seed: u64, dimension: u64) -> u64 {
    let key = mix(seed ^ mix(dimension.wrapping_add(1)));
    let mut bits = 0u64;
    for level in 0..levels {
        let node = (1 << level) | (bits >> (63 - level) >> 1);
        let flip = mix(key ^ node.wrapping_mul(0x9e37_79b9_7f4a_7c15)) >> 63;
        bits |= ((scrambled >> (63 - level) & 1) ^ flip) << (63 - level);
    }
    bits
}

/// The finalizer of SplitMix64 (Steele, Lea and Flood, DOI 10.1145/2714064.2660195): every bit of the result depends
/// on every bit of the argument.
#[inline]
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Numbers that first differ in some bit still first differ in that bit.
        #[test]
        fn keeps_boxes(a: u64, b: u64, shared in 0..53u32, seed: u64) {
            let b = if shared == 0 { b } else { a >> (64 - shared) << (64 - shared) | b >> shared };
            let differ = ((a ^ b) & !0x7ff).leading_zeros();
            prop_assert_eq!((nested(a, seed, 0) ^ nested(b, seed, 0)).leading_zeros(), differ);
        }
    }

    #[test]
    fn flips_are_fair_and_independent() {
        // 4,096 seeds: each of the flips of the root and of the two nodes below it, and each pair, near one half.
        let corner = |bits, seed, dimension| nested(bits, seed, dimension) >> 62 ^ bits >> 62;
        let mut counts = [0; 6];
        for seed in 0..4096 {
            let (low, high, other) = (corner(0, seed, 0), corner(1 << 63, seed, 0), corner(0, seed, 1));
            let flips = [low >> 1, low & 1, high & 1, other >> 1];
            let pairs =
                [flips[0], flips[1], flips[2], flips[0] ^ flips[3], flips[1] ^ flips[2], flips[0] ^ flips[1]];
            for (count, flip) in counts.iter_mut().zip(pairs) {
                *count += flip;
            }
        }
        // Four standard deviations are 128.
        assert!(counts.iter().all(|c| c.abs_diff(2048) < 128), "{counts:?}");
    }

    #[test]
    fn mean_square_error_falls_faster_than_that_of_random_points() {
        // The mean of x over n = 1,024 scrambled points of a one-dimensional net has variance 1 / (12 n^3).
        let (n, seeds) = (1024u64, 64);
        let mut square = 0.0;
        for seed in 0..seeds {
            let sum: u64 = (0..n).map(|i: u64| nested(i.reverse_bits(), seed, 0) >> 11).sum();
            let error = sum as f64 / n as f64 / (1u64 << 53) as f64 - 0.5;
            square += error * error / seeds as f64;
        }
        let expected = 1.0 / (12.0 * (n as f64) * (n as f64) * (n as f64));
        assert!((0.5..2.0).contains(&(square / expected)), "{}", square / expected);
    }
}
