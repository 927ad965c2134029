//! Cutting a heap of masses where it is to be cut: what balancing and choosing by regions have in common.

use std::cmp::Ordering;

/// Reorders the items so that those before the returned place are the lowest by `order` and their mass is as near to
/// `wanted` as whole items allow. Neither side is empty. Linear time.
///
/// # Panics
/// If there are fewer than two items.
pub(crate) fn split_by_mass<T>(
    items: &mut [T],
    order: impl Fn(&T, &T) -> Ordering,
    mass: impl Fn(&T) -> f64,
    wanted: f64,
) -> usize {
    let (mut low, mut high) = (0, items.len());
    let mut below = 0.0;
    // Items before `low` are lower, items from `high` on are higher; `below` is the mass before `low`.
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        items[low..high].select_nth_unstable_by(middle - low, &order);
        let between: f64 = items[low..middle].iter().map(&mass).sum();
        if below + between <= wanted {
            below += between;
            low = middle;
        } else {
            high = middle;
        }
    }
    // The cut falls before or behind the item at `low`.
    let behind = wanted - below > 0.5 * mass(&items[low]);
    (low + usize::from(behind)).clamp(1, items.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cut_is_as_near_as_whole_items_allow() {
        let cut = |wanted| {
            let mut items = [5.0, 1.0, 4.0, 2.0, 3.0];
            let cut = split_by_mass(&mut items, f64::total_cmp, |x| *x, wanted);
            let mut below = items[..cut].to_vec();
            below.sort_by(f64::total_cmp);
            below
        };
        // Sums from below: 1, 3, 6, 10, 15.
        assert_eq!(cut(6.0), [1.0, 2.0, 3.0]);
        assert_eq!(cut(7.9), [1.0, 2.0, 3.0]);
        assert_eq!(cut(8.1), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(cut(0.0), [1.0]);
        assert_eq!(cut(15.0), [1.0, 2.0, 3.0, 4.0]);
    }
}
