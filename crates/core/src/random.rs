//! Seeded random numbers whose stream never changes: xoshiro256++ seeded by SplitMix64, as its authors advise.

use std::f64::consts::PI;

use glam::{DMat3, DQuat};
use rand_core::{Rng as _, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A stream of random numbers fixed by its seed.
#[derive(Clone, Debug)]
pub(crate) struct Random(Xoshiro256PlusPlus);

impl Random {
    /// The stream of `seed`; `purpose` keeps streams of the same seed apart.
    pub(crate) fn new(seed: u64, purpose: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed ^ purpose.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// 64 random bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in `0..count`; the bias is below 2^-64 times `count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.bits()) * count as u128) >> 64) as usize
    }

    /// A uniform random rotation (Shoemake, "Uniform random rotations", Graphics Gems III, 1992).
    pub(crate) fn rotation(&mut self) -> DMat3 {
        let [u, v, w] = [self.unit(), self.unit(), self.unit()];
        let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
        let (sin_v, cos_v) = libm::sincos(2.0 * PI * v);
        let (sin_w, cos_w) = libm::sincos(2.0 * PI * w);
        DMat3::from_quat(DQuat::from_xyzw(a * sin_v, a * cos_v, b * sin_w, b * cos_w).normalize())
    }
}
