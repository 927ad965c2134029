//! Cranley-Patterson rotation: a point set moved on the torus, so that runs can be replicated (DOI 10.1137/0713071).

use glam::DVec2;

use crate::random::Random;

/// Keeps the shifts apart from other random numbers of the same seed.
const PURPOSE: u64 = 0x0073_6869_6674;

/// The point moved by `by` modulo 1, in [0, 1)^2. `by` may be any finite vector.
#[inline]
pub fn shift(point: DVec2, by: DVec2) -> DVec2 {
    let moved = |x: f64, by: f64| modulo_one(modulo_one(x) + modulo_one(by));
    DVec2::new(moved(point.x, by.x), moved(point.y, by.y))
}

/// The shift of a seed, uniform on the unit square; seed 0 leaves the points where they are.
pub fn shift_of_seed(seed: u64) -> DVec2 {
    if seed == 0 {
        return DVec2::ZERO;
    }
    let mut random = Random::new(seed, PURPOSE);
    DVec2::new(random.unit(), random.unit())
}

/// In [0, 1): a tiny negative number, whose remainder rounds to 1, gives 0.
#[inline]
fn modulo_one(x: f64) -> f64 {
    let rest = x - x.floor();
    if rest < 1.0 { rest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn moves_around_the_torus() {
        assert_eq!(shift(DVec2::new(0.75, 0.5), DVec2::new(0.5, 0.25)), DVec2::new(0.25, 0.75));
        assert_eq!(shift(DVec2::new(0.75, 0.5), DVec2::ZERO), DVec2::new(0.75, 0.5));
        assert_eq!(shift(DVec2::ZERO, DVec2::new(-1e-30, -0.25)), DVec2::new(0.0, 0.75));
    }

    #[test]
    fn seeds() {
        assert_eq!(shift_of_seed(0), DVec2::ZERO);
        assert_eq!(shift_of_seed(3), shift_of_seed(3));
        assert_ne!(shift_of_seed(1), shift_of_seed(2));
        let mean = (1..=1000).map(shift_of_seed).sum::<DVec2>() / 1000.0;
        // Four standard deviations.
        assert!((mean - DVec2::splat(0.5)).abs().max_element() < 4.0 / 12000.0_f64.sqrt(), "{mean}");
    }

    proptest! {
        #[test]
        fn stays_in_the_square(x in 0.0..1.0, y in 0.0..1.0, a in -1e3..1e3, b: u64) {
            let below_one = 1.0 - f64::EPSILON / 2.0;
            for by in [DVec2::new(a, -a), shift_of_seed(b), DVec2::splat(below_one), DVec2::splat(-1e-300)] {
                for point in [DVec2::new(x, y), DVec2::splat(below_one), DVec2::ZERO] {
                    let p = shift(point, by);
                    prop_assert!(p.x >= 0.0 && p.x < 1.0 && p.y >= 0.0 && p.y < 1.0, "{}", p);
                }
            }
        }
    }
}
