//! Halton's sequence: radical inverses in two bases.

use glam::DVec2;

use crate::sequence::radical_inverse;

/// The radical inverses of i.
pub(super) fn point(bases: [u32; 2], index: u64) -> DVec2 {
    DVec2::new(radical_inverse(index, bases[0]), radical_inverse(index, bases[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_points_by_hand() {
        assert_eq!(point([2, 3], 0), DVec2::ZERO);
        assert_eq!(point([2, 3], 1), DVec2::new(0.5, 1.0 / 3.0));
        assert_eq!(point([2, 3], 6), DVec2::new(0.375, 2.0 / 9.0));
        assert_eq!(point([5, 10], 27), DVec2::new(0.408, 0.72));
    }
}
