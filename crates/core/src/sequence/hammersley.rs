//! Hammersley's point set: evenly spaced in x, the radical inverse in y.

use glam::DVec2;

use crate::sequence::{fraction, radical_inverse};

/// (i / n, radical inverse of i).
pub(super) fn point(base: u32, index: u64, count: u64) -> DVec2 {
    let count = count.max(1);
    let index = if index < count { index } else { index % count };
    DVec2::new(fraction::of(u128::from(index), u128::from(count)), radical_inverse(index, base))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_points_by_hand() {
        let y = [0.0, 0.5, 0.25, 0.75, 0.125];
        for (i, y) in y.into_iter().enumerate() {
            assert_eq!(point(2, i as u64, 5), DVec2::new(i as f64 / 5.0, y));
        }
        assert_eq!(point(2, 6, 5), point(2, 1, 5));
    }
}
