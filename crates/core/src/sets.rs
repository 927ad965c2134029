//! Disjoint sets of the numbers below a count.

/// A forest in which the root of a set is its smallest member; paths are halved when they are walked.
#[derive(Clone, Debug)]
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    /// Each number below `count` alone.
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// How many numbers there are.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// One more number, alone.
    pub(crate) fn add(&mut self) -> u32 {
        let member = self.0.len() as u32;
        self.0.push(member);
        member
    }

    /// The smallest member of the set that holds `member`.
    pub(crate) fn root(&mut self, mut member: u32) -> u32 {
        while !self.is_root(member) {
            let above = self.0[self.0[member as usize] as usize];
            self.0[member as usize] = above;
            member = above;
        }
        member
    }

    pub(crate) fn is_root(&self, member: u32) -> bool {
        self.0[member as usize] == member
    }

    /// Makes one set of two and returns its root.
    pub(crate) fn join(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
        a.min(b)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_root_is_the_smallest_that_can_be_reached(pairs in prop::collection::vec((0_u32..40, 0_u32..40), 0..60)) {
            let mut sets = Sets::new(40);
            let mut smallest: Vec<u32> = (0..40).collect();
            for &(a, b) in &pairs {
                let (low, high) = (smallest[a as usize].min(smallest[b as usize]), smallest[a as usize].max(smallest[b as usize]));
                smallest.iter_mut().filter(|s| **s == high).for_each(|s| *s = low);
                prop_assert_eq!(sets.join(a, b), low);
            }
            for (member, root) in (0..).zip(smallest) {
                prop_assert_eq!(sets.root(member), root);
                prop_assert_eq!(sets.is_root(member), root == member);
            }
        }
    }
}
