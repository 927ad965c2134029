//! Points on the unit square that low-discrepancy sets are compared with (paper, figure 1).

use glam::DVec2;

use super::purpose;
use crate::random::Random;

/// A square lattice: `side` x `side` points in the middles of its cells.
pub fn square_lattice(side: u32) -> Vec<DVec2> {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    (0..side).flat_map(|row| (0..side).map(move |column| DVec2::new(at(column), at(row)))).collect()
}

/// `count` independent uniform points of [0, 1) x [0, 1).
pub fn square_random(count: usize, seed: u64) -> Vec<DVec2> {
    let mut random = Random::new(seed, purpose::SQUARE);
    (0..count)
        .map(|_| {
            let x = random.unit();
            DVec2::new(x, random.unit())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_by_hand() {
        let expected = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)].map(DVec2::from);
        assert_eq!(square_lattice(2), expected);
        assert!(square_lattice(0).is_empty());
    }

    #[test]
    fn random_points_fill_the_quarters_of_the_square_alike() {
        let points = square_random(4000, 7);
        let mut quarters = [0u32; 4];
        for p in &points {
            assert!((0.0..1.0).contains(&p.x) && (0.0..1.0).contains(&p.y));
            quarters[usize::from(p.x >= 0.5) + 2 * usize::from(p.y >= 0.5)] += 1;
        }
        // Five standard deviations of a count of 1,000.
        assert!(quarters.iter().all(|&count| count.abs_diff(1000) < 137), "{quarters:?}");
        assert_eq!(points[..10], square_random(10, 7));
        assert_ne!(points[..10], square_random(10, 8));
    }
}
