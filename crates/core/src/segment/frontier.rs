//! The sides along which a segment may grow on, the cheapest first.

use std::hint::select_unpredictable;

use crate::ids::HalfedgeId;

/// What it costs to join a triangle: first the share of its sides beside the segment that opens, then the tie, as the
/// bits of two singles. Those of floats that are not negative sort as the floats do; the smallest is best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Cost(u64);

impl Cost {
    #[inline]
    pub(super) fn new(share: f64, tie: f64) -> Self {
        Self(u64::from((share as f32).to_bits()) << 32 | u64::from((tie as f32).to_bits()))
    }

    #[inline]
    pub(super) fn opens_nothing(self) -> bool {
        self.0 >> 32 == 0
    }
}

/// A heap in which each has up to four below it: half as deep as one with two, and the four share a line of the cache.
#[derive(Debug, Default)]
struct Heap<T>(Vec<T>);

const BELOW: usize = 4;

impl<T: Copy + Ord> Heap<T> {
    fn push(&mut self, item: T) {
        let mut place = self.0.len();
        self.0.push(item);
        while place > 0 {
            let above = (place - 1) / BELOW;
            if self.0[above] <= item {
                break;
            }
            self.0[place] = self.0[above];
            place = above;
        }
        self.0[place] = item;
    }

    /// The least.
    fn pop(&mut self) -> Option<T> {
        let last = self.0.pop()?;
        let Some(&first) = self.0.first() else { return Some(last) };
        self.sink(last);
        Some(first)
    }

    /// Puts another in the first's place.
    fn sink(&mut self, item: T) {
        let items = &mut self.0[..];
        let mut place = 0;
        loop {
            let below = BELOW * place + 1;
            let (least, at) = if let Some(&[a, b, c, d]) = items.get(below..below + BELOW) {
                lesser(lesser((a, below), (b, below + 1)), lesser((c, below + 2), (d, below + 3)))
            } else if let Some(least) = (below..items.len()).map(|i| (items[i], i)).min() {
                least
            } else {
                break;
            };
            if least >= item {
                break;
            }
            items[place] = least;
            place = at;
        }
        items[place] = item;
    }
}

/// Chosen without a jump, which could not be foreseen.
#[inline]
fn lesser<T: Copy + Ord>(a: (T, usize), b: (T, usize)) -> (T, usize) {
    let first = a.0 < b.0;
    (select_unpredictable(first, a.0, b.0), select_unpredictable(first, a.1, b.1))
}

/// A priority queue of sides by their costs, of equal ones by their numbers. What is cheap is many times as often put in
/// and taken out as what has to wait, and needs fewer bits: it has heaps of its own, which stay small. An item is the
/// cost, less what all items of its heap have in common, and then the side, in one number.
#[derive(Debug, Default)]
pub(super) struct Frontier {
    /// Those that cost nothing at all: few at a time, for they are taken at once.
    free: Heap<u32>,
    /// Those that open nothing: only the tie sets them apart.
    closing: Heap<u64>,
    opening: Heap<u128>,
}

impl Frontier {
    #[inline]
    pub(super) fn push(&mut self, cost: Cost, side: HalfedgeId) {
        if cost.0 == 0 {
            self.free.push(side.0);
        } else if cost.opens_nothing() {
            self.closing.push(cost.0 << 32 | u64::from(side.0));
        } else {
            self.opening.push(u128::from(cost.0) << 32 | u128::from(side.0));
        }
    }

    /// What is likely to be popped soon: the cheapest, and the four right below it.
    #[inline]
    pub(super) fn soon(&self, mut see: impl FnMut(HalfedgeId)) {
        const SOON: usize = 1 + BELOW;
        self.free.0.first().into_iter().for_each(|&item| see(HalfedgeId(item)));
        self.closing.0.iter().take(SOON).for_each(|&item| see(HalfedgeId(item as u32)));
        if self.closing.0.is_empty() {
            self.opening.0.iter().take(SOON).for_each(|&item| see(HalfedgeId(item as u32)));
        }
    }

    /// The cheapest.
    #[inline]
    pub(super) fn pop(&mut self) -> Option<(Cost, HalfedgeId)> {
        if let Some(side) = self.free.pop() {
            return Some((Cost(0), HalfedgeId(side)));
        }
        if let Some(item) = self.closing.pop() {
            return Some((Cost(item >> 32), HalfedgeId(item as u32)));
        }
        self.opening.pop().map(|item| (Cost((item >> 32) as u64), HalfedgeId(item as u32)))
    }
}

#[cfg(test)]
mod tests {
    use std::cmp::Reverse;
    use std::collections::BinaryHeap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// As one heap of costs and sides, with sides put in between that are cheaper than what was taken out before.
        #[test]
        fn the_cheapest_comes_first(steps in prop::collection::vec((0..4u8, 0..3u8, 0..5u8), 0..400)) {
            let (mut frontier, mut expected) = (Frontier::default(), BinaryHeap::new());
            for (side, (take, share, tie)) in (0..).zip(steps) {
                // Sides fall, so that equal costs do not come in their order.
                let (cost, side) = (Cost::new(f64::from(share) / 2.0, f64::from(tie)), HalfedgeId(u32::MAX - side));
                frontier.push(cost, side);
                expected.push(Reverse((cost, side)));
                for _ in 0..take / 2 {
                    prop_assert_eq!(frontier.pop(), expected.pop().map(|Reverse(first)| first));
                }
            }
            while let Some(Reverse(first)) = expected.pop() {
                prop_assert_eq!(frontier.pop(), Some(first));
            }
            prop_assert_eq!(frontier.pop(), None);
        }
    }
}
