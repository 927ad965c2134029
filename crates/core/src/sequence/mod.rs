//! Low-discrepancy sequences on the unit square (paper, section 3).
//!
//! Every coordinate is a multiple of 2^-53 or a correctly rounded quotient of whole numbers, lies in [0, 1) (never
//! 1), and has the same bits on every platform. An index is any `u64`.

mod fibonacci;
mod finder;
mod fraction;
mod halton;
mod hammersley;
mod r2;
mod radical_inverse;
mod scramble;
mod shift;
mod sobol;

use glam::DVec2;

pub(crate) use finder::Finder;
pub use radical_inverse::radical_inverse;
pub use shift::{shift, shift_of_seed};

/// A point set on the unit square, scaled isotropically to the planar domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
#[non_exhaustive]
pub enum Sequence {
    /// (i / n, radical inverse of i in `base`): Hammersley 1960, DOI 10.1111/j.1749-6632.1960.tb42846.x.
    Hammersley {
        /// The base of the radical inverse, at least 2.
        base: u32,
    },
    /// Radical inverses of i in two bases, which must have no common factor: Halton 1960, DOI 10.1007/BF01386213.
    Halton {
        /// The bases, each at least 2.
        bases: [u32; 2],
    },
    /// The first two dimensions of Sobol' 1967, DOI 10.1016/0041-5553(67)90144-9, under Owen's nested scrambling,
    /// DOI 10.1007/978-1-4612-2552-2_19.
    Sobol {
        /// Chooses the scrambling; every seed gives another set of the same quality.
        seed: u64,
    },
    /// (i a + 1/2, i a^2 + 1/2) modulo 1, where 1/a is the plastic number: Roberts 2018, "The unreasonable
    /// effectiveness of quasirandom sequences".
    R2,
    /// (i / n, i / golden ratio modulo 1): the Fibonacci lattice for any n (Korobov 1963 where n is a Fibonacci number).
    Fibonacci,
}

/// The largest base that [`Sequence::validate`] allows: fewer points than the base lie on one line.
pub const LARGEST_BASE: u32 = 1024;

impl Default for Sequence {
    fn default() -> Self {
        Self::Hammersley { base: 2 }
    }
}

/// A sequence that does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SequenceError {
    /// A base that has no digits.
    #[error("base {base} of the sequence is too small: a base is at least 2")]
    SmallBase {
        /// The base.
        base: u32,
    },
    /// A base so large that a set of a useful number of points would lie on a few lines.
    #[error("base {base} of the sequence is too large: at most {LARGEST_BASE} can be used")]
    LargeBase {
        /// The base.
        base: u32,
    },
    /// Bases whose coordinates would depend on each other.
    #[error("bases {} and {} of the sequence share the factor {factor}: they must have none in common", bases[0], bases[1])]
    SharedFactor {
        /// The bases.
        bases: [u32; 2],
        /// Their greatest common divisor.
        factor: u32,
    },
}

impl Sequence {
    /// Point `index` of the first `count`, in [0, 1)^2. Only Hammersley and Fibonacci depend on `count`; for them
    /// indices from `count` on begin anew. Total: what [`validate`](Self::validate) refuses gives points too, but not
    /// well spread ones. Cost: O(log index).
    pub fn point(&self, index: u64, count: u64) -> DVec2 {
        match *self {
            Self::Hammersley { base } => hammersley::point(base, index, count),
            Self::Halton { bases } => halton::point(bases, index),
            Self::Sobol { seed } => sobol::point(seed, index),
            Self::R2 => r2::point(index),
            Self::Fibonacci => fibonacci::point(index, count),
        }
    }

    /// Whether the points of n + m contain those of n: the point of an index does not depend on the count.
    pub fn is_extensible(&self) -> bool {
        match self {
            Self::Hammersley { .. } | Self::Fibonacci => false,
            Self::Halton { .. } | Self::Sobol { .. } | Self::R2 => true,
        }
    }

    /// Checks the bases.
    ///
    /// # Errors
    /// [`SequenceError`] when a base is below 2 or above [`LARGEST_BASE`], or the bases have a common factor.
    pub fn validate(&self) -> Result<(), SequenceError> {
        match *self {
            Self::Hammersley { base } => check_base(base),
            Self::Halton { bases } => {
                check_base(bases[0])?;
                check_base(bases[1])?;
                match greatest_common_divisor(bases[0], bases[1]) {
                    1 => Ok(()),
                    factor => Err(SequenceError::SharedFactor { bases, factor }),
                }
            }
            Self::Sobol { .. } | Self::R2 | Self::Fibonacci => Ok(()),
        }
    }
}

/// A third coordinate in [0, 1) for the point of an index: the radical inverse in a prime base that the other two do not
/// use. Where only the points below a height are kept, that share of them stays, evenly spread.
pub(crate) fn third_coordinate(sequence: &Sequence, index: u64) -> f64 {
    let uses = |prime: u32| match *sequence {
        Sequence::Hammersley { base } => base % prime == 0,
        Sequence::Halton { bases } => bases.iter().any(|b| b % prime == 0),
        Sequence::Sobol { .. } => prime == 2,
        Sequence::R2 | Sequence::Fibonacci => false,
    };
    // Two bases without common factor, up to 1,024 each, have at most seven prime factors.
    let prime = [2, 3, 5, 7, 11, 13, 17].into_iter().find(|p| !uses(*p)).unwrap_or(19);
    radical_inverse(index, prime)
}

fn check_base(base: u32) -> Result<(), SequenceError> {
    match base {
        0 | 1 => Err(SequenceError::SmallBase { base }),
        2..=LARGEST_BASE => Ok(()),
        _ => Err(SequenceError::LargeBase { base }),
    }
}

fn greatest_common_divisor(mut a: u32, mut b: u32) -> u32 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SEQUENCES: [Sequence; 7] = [
        Sequence::Hammersley { base: 2 },
        Sequence::Hammersley { base: 3 },
        Sequence::Halton { bases: [2, 3] },
        Sequence::Halton { bases: [u32::MAX, u32::MAX - 1] },
        Sequence::Sobol { seed: 7 },
        Sequence::R2,
        Sequence::Fibonacci,
    ];

    /// Whether each of the boxes of width 1/columns and height 1/rows holds exactly `each` of the points.
    fn evenly_boxed(points: &[DVec2], columns: usize, rows: usize, each: usize) -> bool {
        let mut held = vec![0; columns * rows];
        for p in points {
            held[(p.x * columns as f64) as usize * rows + (p.y * rows as f64) as usize] += 1;
        }
        held.iter().all(|&h| h == each)
    }

    fn points(sequence: Sequence, from: u64, count: u64) -> Vec<DVec2> {
        (from..from + count).map(|i| sequence.point(i, count)).collect()
    }

    #[test]
    fn hammersley_and_sobol_are_nets() {
        for m in 0..=10u32 {
            let n = 1u64 << m;
            let mut nets = vec![points(Sequence::Hammersley { base: 2 }, 0, n)];
            for seed in 0..4 {
                // A (0, 2)-sequence: every aligned block of 2^m points is a net, not only the first.
                nets.extend([0, 1, 5].map(|block| points(Sequence::Sobol { seed }, block * n, n)));
            }
            for net in nets {
                for k in 0..=m {
                    assert!(evenly_boxed(&net, 1 << k, 1 << (m - k), 1), "n = {n}, 2^{k} columns");
                }
            }
        }
    }

    #[test]
    fn hammersley_in_base_3_is_a_net() {
        let net = points(Sequence::Hammersley { base: 3 }, 0, 81);
        for k in 0..=4u32 {
            let columns = 3usize.pow(k);
            // The first coordinate, i / 81, may fall on a line between columns: half a step keeps it off.
            let moved: Vec<_> = net.iter().map(|p| *p + DVec2::splat(0.5 / 81.0)).collect();
            assert!(evenly_boxed(&moved, columns, 81 / columns, 1), "{columns} columns");
        }
    }

    #[test]
    fn halton_prefixes_fill_the_boxes() {
        let halton = Sequence::Halton { bases: [2, 3] };
        for (columns, rows) in [(2, 1), (1, 3), (2, 3), (4, 3), (8, 9), (16, 27)] {
            let n = (columns * rows) as u64;
            for block in 0..3 {
                let moved: Vec<_> =
                    points(halton, block * n, n).into_iter().map(|p| p + DVec2::splat(1e-9)).collect();
                assert!(evenly_boxed(&moved, columns, rows, 1), "{columns} x {rows}, block {block}");
            }
        }
    }

    #[test]
    fn extensible_means_that_the_count_does_not_matter() {
        for sequence in SEQUENCES {
            let same = (0..50).all(|i| sequence.point(i, 50) == sequence.point(i, 77));
            assert_eq!(same, sequence.is_extensible(), "{sequence:?}");
        }
    }

    #[test]
    fn bases_are_checked() {
        assert_eq!(Sequence::default().validate(), Ok(()));
        assert_eq!(Sequence::Halton { bases: [9, 4] }.validate(), Ok(()));
        for base in [0, 1] {
            let refused = Err(SequenceError::SmallBase { base });
            assert_eq!(Sequence::Hammersley { base }.validate(), refused);
            assert_eq!(Sequence::Halton { bases: [base, 3] }.validate(), refused);
            assert_eq!(Sequence::Halton { bases: [3, base] }.validate(), refused);
        }
        assert_eq!(Sequence::Halton { bases: [1024, 3] }.validate(), Ok(()));
        let refused = Err(SequenceError::LargeBase { base: 1025 });
        assert_eq!(Sequence::Halton { bases: [2, 1025] }.validate(), refused);
        assert_eq!(Sequence::Hammersley { base: 1025 }.validate(), refused);
        assert_eq!(
            Sequence::Halton { bases: [6, 15] }.validate(),
            Err(SequenceError::SharedFactor { bases: [6, 15], factor: 3 })
        );
        assert_eq!(
            SequenceError::SharedFactor { bases: [6, 15], factor: 3 }.to_string(),
            "bases 6 and 15 of the sequence share the factor 3: they must have none in common"
        );
    }

    #[test]
    fn the_third_coordinate_uses_another_base() {
        let third = |sequence| third_coordinate(&sequence, 1);
        assert_eq!(third(Sequence::Hammersley { base: 2 }), 1.0 / 3.0);
        assert_eq!(third(Sequence::Hammersley { base: 3 }), 0.5);
        assert_eq!(third(Sequence::Halton { bases: [2, 3] }), 0.2);
        assert_eq!(third(Sequence::Halton { bases: [770, 39] }), 1.0 / 17.0);
        assert_eq!(third(Sequence::Sobol { seed: 1 }), 1.0 / 3.0);
        assert_eq!(third(Sequence::R2), 0.5);
    }

    proptest! {
        #[test]
        fn points_lie_in_the_half_open_square(which in 0..SEQUENCES.len(), index: u64, count: u64, low in 0..4096u64) {
            for i in [index, low, u64::MAX - low, index >> 11] {
                for n in [count, count >> 40, 0, u64::MAX] {
                    let p = SEQUENCES[which].point(i, n);
                    prop_assert!(p.x >= 0.0 && p.x < 1.0 && p.y >= 0.0 && p.y < 1.0, "{p}");
                }
            }
        }

        #[test]
        fn refused_bases_still_give_points(base in 0..2u32, index: u64) {
            let p = Sequence::Halton { bases: [base, base] }.point(index, 1);
            prop_assert_eq!(p, DVec2::ZERO);
        }
    }
}
