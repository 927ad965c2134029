//! What decides how many points face a viewer: the odd spherical harmonics of their normals.
//!
//! From a direction d all that has a normal n with n . d > 0 is seen, were nothing hidden. That is 1/2 plus the sum over odd
//! degrees l of c_l P_l(n . d); even degrees do not matter. By the addition theorem the mean square over all directions
//! of an error in what faces them is a sum of squares, one for each harmonic.

use glam::DVec3;

/// The highest degree. Six percent of the mean square by which random normals are off lie beyond.
const DEGREE: usize = 9;

/// Singles that are summed side by side.
const SINGLES: usize = 8;

/// The harmonics of a normal, 3 + 7 + 11 + 15 + 19 of them, and zeros up to whole lanes.
pub(super) const COUNT: usize = 55_usize.next_multiple_of(SINGLES);

/// Scaled so that the sum of the squares of an error is its mean square over directions.
pub(super) type Harmonics = [f32; COUNT];

/// The factors of harmonics by degree and order.
pub(super) struct Basis([[f64; DEGREE + 1]; DEGREE + 1]);

impl Basis {
    pub(super) fn new() -> Self {
        let mut factors = [[0.0; DEGREE + 1]; DEGREE + 1];
        // P_(l - 1)(0); c_l is its (2 l + 1) / (2 l + 2).
        let mut at_zero = 1.0;
        for degree in (1..=DEGREE).step_by(2) {
            let l = degree as f64;
            // (l - m)! / (l + m)!
            let mut ratio = 1.0;
            for (order, factor) in factors[degree].iter_mut().enumerate().take(degree + 1) {
                let m = order as f64;
                if order > 0 {
                    ratio /= (l + m) * (l - m + 1.0);
                }
                let both = if order > 0 { 2.0 } else { 1.0 };
                *factor = at_zero / (2.0 * l + 2.0) * (both * (2.0 * l + 1.0) * ratio).sqrt();
            }
            at_zero *= -l / (l + 1.0);
        }
        Self(factors)
    }

    /// The harmonics of a unit vector.
    pub(super) fn of(&self, normal: DVec3) -> Harmonics {
        let mut all = [0.0; COUNT];
        let mut next = 0;
        // The parts of (x + i y)^m.
        let (mut real, mut imaginary) = (1.0, 0.0);
        // (2 m - 1)!!
        let mut diagonal = 1.0;
        for order in 0..=DEGREE {
            // Associated Legendre functions over the power of the sine, of this degree and of the one before.
            let (mut before, mut here) = (0.0, diagonal);
            for degree in order..=DEGREE {
                if degree % 2 == 1 {
                    let factor = self.0[degree][order] * here;
                    all[next] = (factor * real) as f32;
                    next += 1;
                    if order > 0 {
                        all[next] = (factor * imaginary) as f32;
                        next += 1;
                    }
                }
                let [l, m] = [degree as f64, order as f64];
                let after = ((2.0 * l + 1.0) * normal.z * here - (l + m) * before) / (l + 1.0 - m);
                (before, here) = (here, after);
            }
            (real, imaginary) =
                (normal.x * real - normal.y * imaginary, normal.x * imaginary + normal.y * real);
            diagonal *= (2 * order + 1) as f64;
        }
        all
    }
}

/// The sum of products, always in the same order.
#[inline]
pub(super) fn dot(a: &Harmonics, b: &Harmonics) -> f32 {
    let mut sums = [0.0; SINGLES];
    for (a, b) in a.chunks_exact(SINGLES).zip(b.chunks_exact(SINGLES)) {
        for lane in 0..SINGLES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Sums of products are those of the series by the addition theorem, and near the share of directions that both face
    /// less the quarter that two directions of their own would share.
    #[test]
    fn products_are_what_both_face() {
        let basis = Basis::new();
        let mut random = Random::new(1, 1);
        for _ in 0..200 {
            let [a, b] = [(); 2].map(|()| (random.rotation() * DVec3::X).normalize());
            let cos = a.dot(b).clamp(-1.0, 1.0);
            // c_l squared over 2 l + 1, by hand.
            let squares =
                [9.0 / 16.0, 49.0 / 256.0, 121.0 / 1024.0, 5625.0 / 65536.0, 70_756.0 / 1_048_576.0];
            let (mut before, mut here, mut series) = (1.0, cos, 0.0);
            for degree in 1..=DEGREE {
                let l = degree as f64;
                if degree % 2 == 1 {
                    series += squares[degree / 2] / (2.0 * l + 1.0) * here;
                }
                (before, here) = (here, ((2.0 * l + 1.0) * cos * here - l * before) / (l + 1.0));
            }
            let product = f64::from(dot(&basis.of(a), &basis.of(b)));
            assert!((product - series).abs() < 1e-6, "{product} for {series}");
            let shared = 0.25 - libm::acos(cos) / std::f64::consts::TAU;
            assert!((product - shared).abs() < 0.011, "{product} for {shared}");
        }
    }
}
