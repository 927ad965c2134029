//! Finds the points of a sequence inside a box without looking at all others.
//!
//! A radical inverse lies in an interval of length b^-k when the last k digits of the index are given, so boxes are
//! residue classes of indices (for Halton joined by the Chinese remainder theorem). Sobol' points: the bits of both
//! coordinates are linear in those of the index. Fibonacci: a rotation, whose next visit of an interval Euclid's
//! algorithm tells.

use std::ops::Range;

use super::{Sequence, fibonacci, sobol};

/// Finds points of one sequence.
#[derive(Clone, Debug)]
pub(crate) struct Finder {
    count: u64,
    structure: Structure,
}

#[derive(Clone, Debug)]
enum Structure {
    Hammersley(u32),
    Halton([u32; 2]),
    Sobol(Box<sobol::Solver>),
    Fibonacci,
}

impl Finder {
    /// Prepares for the first `count` points; `None` for R2, whose points can only be looked at one by one.
    pub(crate) fn new(sequence: &Sequence, count: u64) -> Option<Self> {
        let structure = match *sequence {
            Sequence::Hammersley { base } => Structure::Hammersley(base.max(2)),
            Sequence::Halton { bases } => Structure::Halton(bases.map(|b| b.max(2))),
            Sequence::Sobol { seed } => Structure::Sobol(Box::new(sobol::Solver::new(seed, count))),
            Sequence::Fibonacci => Structure::Fibonacci,
            Sequence::R2 => return None,
        };
        Some(Self { count, structure })
    }

    /// Appends the indices of all points with x and y in these ranges (inside the unit square), and of some more
    /// beside it. Cost: about that of the points of the box and of the strips along two of its sides that are as
    /// narrow as the point set allows.
    pub(crate) fn candidates(&self, x: Range<f64>, y: Range<f64>, found: &mut Vec<u64>) {
        match &self.structure {
            Structure::Hammersley(base) => {
                let indices = self.indices(&x);
                let within = (indices.end - indices.start) as f64;
                for digits in Digits::most_selective(*base, &y, within).residues(&y) {
                    digits.of(indices.clone(), found);
                }
            }
            Structure::Halton([a, b]) => {
                let across = Digits::most_selective(*b, &y, self.count as f64);
                let along = Digits::most_selective(*a, &x, self.count as f64 / across.scale as f64);
                let inverse = inverse(along.scale, across.scale);
                for second in across.residues(&y) {
                    for first in along.residues(&x) {
                        first.and(second, inverse).of(0..self.count, found);
                    }
                }
            }
            Structure::Sobol(solver) => solver.candidates(x, y, self.count, found),
            Structure::Fibonacci => {
                let indices = self.indices(&x);
                let mut next = indices.start;
                while let Some(index) = fibonacci::next_visit(next, &y).filter(|i| *i < indices.end) {
                    found.push(index);
                    next = index + 1;
                }
            }
        }
    }

    /// The indices i with i / count in the range.
    fn indices(&self, x: &Range<f64>) -> Range<u64> {
        let count = self.count as f64;
        let first = (x.start * count).floor().max(0.0) as u64;
        first.min(self.count)..((x.end * count).floor() as u64 + 1).min(self.count)
    }
}

/// Some last digits in a base.
#[derive(Clone, Copy)]
struct Digits {
    base: u64,
    count: u32,
    /// base^count.
    scale: u64,
}

impl Digits {
    /// As many digits as make the least work of finding those of `within` indices whose inverse lies in the range.
    fn most_selective(base: u32, range: &Range<f64>, within: f64) -> Self {
        /// Powers stay below this, so that products of two fit in 128 bits and doubles hold them.
        const LARGEST: u64 = 1 << 52;
        let base = u64::from(base);
        let width = range.end - range.start;
        let work = |d: &Self| {
            let scale = d.scale as f64;
            (width * scale + 2.0) * (1.0 + within / scale)
        };
        let mut digits = Self { base, count: 0, scale: 1 };
        while digits.scale <= LARGEST / base {
            let more = Self { count: digits.count + 1, scale: digits.scale * base, ..digits };
            if work(&more) > work(&digits) {
                break;
            }
            digits = more;
        }
        digits
    }

    /// The classes of indices whose radical inverse may lie in the range.
    fn residues(self, range: &Range<f64>) -> impl Iterator<Item = Class> {
        let scale = self.scale as f64;
        let first = (range.start * scale).floor().max(0.0) as u64;
        let end = ((range.end * scale).floor() as u64 + 1).min(self.scale);
        (first..end).map(move |mirrored| {
            let (mut rest, mut residue) = (mirrored, 0);
            for _ in 0..self.count {
                residue = residue * self.base + rest % self.base;
                rest /= self.base;
            }
            Class { residue: u128::from(residue), modulus: u128::from(self.scale) }
        })
    }
}

/// The indices with one residue.
#[derive(Clone, Copy)]
struct Class {
    residue: u128,
    modulus: u128,
}

impl Class {
    /// The indices of two classes whose moduli have no common factor; `inverse` is that of the first modulo the
    /// second.
    fn and(self, other: Self, inverse: u128) -> Self {
        let difference = (other.modulus + other.residue - self.residue % other.modulus) % other.modulus;
        let steps = difference * inverse % other.modulus;
        Self { residue: self.residue + self.modulus * steps, modulus: self.modulus * other.modulus }
    }

    /// Appends those in a range.
    fn of(self, range: Range<u64>, found: &mut Vec<u64>) {
        let start = u128::from(range.start);
        let mut index = start + (self.modulus + self.residue - start % self.modulus) % self.modulus;
        while index < u128::from(range.end) {
            found.push(index as u64);
            index += self.modulus;
        }
    }
}

/// The inverse of `a` modulo `m`, which have no common factor (Euclid); 0 for m = 1.
fn inverse(a: u64, m: u64) -> u128 {
    let (mut r, mut next_r) = (i128::from(m), i128::from(a % m.max(1)));
    let (mut t, mut next_t) = (0i128, 1i128);
    while next_r != 0 {
        let q = r / next_r;
        (r, next_r) = (next_r, r - q * next_r);
        (t, next_t) = (next_t, t - q * next_t);
    }
    t.rem_euclid(i128::from(m.max(1))) as u128
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SEQUENCES: [Sequence; 9] = [
        Sequence::Hammersley { base: 2 },
        Sequence::Hammersley { base: 3 },
        Sequence::Hammersley { base: 29 },
        Sequence::Halton { bases: [2, 3] },
        Sequence::Halton { bases: [3, 2] },
        Sequence::Halton { bases: [7, 10] },
        Sequence::Sobol { seed: 0 },
        Sequence::Sobol { seed: 3 },
        Sequence::Fibonacci,
    ];

    proptest! {
        /// None of the points of a box is missed, and few others are named.
        #[test]
        fn finds_what_a_list_holds(which in 0..SEQUENCES.len(), count in 1..3000u64, x in 0.0..1.0f64, y in 0.0..1.0f64,
            w in 0.0..0.5f64, h in 0.0..0.2f64) {
            let sequence = SEQUENCES[which];
            let (x, y) = (x..(x + w * w).min(1.0), y..(y + h * h).min(1.0));
            let mut found = Vec::new();
            Finder::new(&sequence, count).unwrap().candidates(x.clone(), y.clone(), &mut found);
            found.sort_unstable();
            prop_assert!(found.windows(2).all(|w| w[0] < w[1]) && found.iter().all(|i| *i < count), "{found:?}");
            for i in 0..count {
                let p = sequence.point(i, count);
                if x.contains(&p.x) && y.contains(&p.y) {
                    prop_assert!(found.binary_search(&i).is_ok(), "{i} of {found:?}");
                }
            }
        }
    }

    #[test]
    fn far_points_are_found() {
        let count = (1 << 50) + 12_345;
        for sequence in SEQUENCES {
            let finder = Finder::new(&sequence, count).unwrap();
            for index in [0, 1, 99_999, count / 3, count / 2 + 1, count - 1] {
                let p = sequence.point(index, count);
                let (side, mut found) = (3e-8, Vec::new());
                let around = |c: f64| (c - side).max(0.0)..(c + side).min(1.0);
                finder.candidates(around(p.x), around(p.y), &mut found);
                assert!(found.contains(&index), "{sequence:?}: {index}");
                assert!(found.len() < 3000, "{sequence:?}: {}", found.len());
            }
        }
    }
}
