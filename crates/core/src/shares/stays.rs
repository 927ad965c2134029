//! One point for each region.

use std::ops::Range;

use crate::buckets::Buckets;
use crate::correct::Pick;
use crate::parallel;

/// A point that may stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) region: u32,
    /// The square of its distance from the middle of the region.
    pub(super) off: f32,
    /// Those of a face come in the order in which it caught them.
    pub(super) pick: Pick,
}

/// One candidate stays in each region, the most central one; a region without any gets one of the next that has some to
/// spare, and what the last ones lack those before them give. Regions are looked at in buckets, some buckets at a time.
pub(super) struct Stays {
    /// How many regions there are.
    count: usize,
    /// How many a bucket has.
    size: usize,
    /// What stays in each bucket so far.
    picks: Vec<Vec<Pick>>,
    /// How many that are.
    before: usize,
}

/// What stays of a bucket.
struct Stay {
    picks: Vec<Pick>,
    /// How many candidates there were.
    of: usize,
}

impl Stays {
    /// Nothing stays yet of `count` regions in buckets of `size`.
    pub(super) fn new(count: usize, size: usize) -> Self {
        Self { count, size, picks: Vec::new(), before: 0 }
    }

    /// The bucket whose candidates come next.
    pub(super) fn next(&self) -> usize {
        self.picks.len()
    }

    /// Takes all candidates of the next `buckets` buckets, which are the first of `candidates`. Whether that was enough, if
    /// they are the last ones.
    pub(super) fn add(&mut self, candidates: &Buckets<Candidate>, buckets: usize) -> bool {
        let Self { count, size, .. } = *self;
        let next = self.next();
        let is_last = (next + buckets) * size >= count;
        // What stays of a bucket if so many stayed before it and so many more are to.
        let stay = |bucket: usize, before: usize, more: usize| {
            let first = (next + bucket) * size;
            Stay::of(&candidates.to_vec(bucket), first..(first + size).min(count), before, more)
        };
        // As without a lack before any bucket, which holds for almost all of them.
        let mut stays = parallel::map(buckets, |bucket| stay(bucket, (next + bucket) * size, 0));
        // How many stay before each bucket: as many as without a lack before it, and as many more as lack and are there.
        let mut before = vec![self.before];
        for (b, stay) in stays.iter().enumerate() {
            before.push((before[b] + stay.of).min((next + b) * size + stay.picks.len()));
        }
        let mut lacking = if is_last { count - before[buckets] } else { 0 };
        let mut others = Vec::new();
        for (b, stay) in stays.iter().enumerate().rev() {
            let spare = stay.of - (before[b + 1] - before[b]);
            let more = spare.min(lacking);
            lacking -= more;
            if more > 0 || before[b] < (next + b) * size {
                others.push((b, more));
            }
        }
        let changed = parallel::map(others.len(), |i| stay(others[i].0, before[others[i].0], others[i].1));
        for (stay, (b, _)) in changed.into_iter().zip(others) {
            stays[b] = stay;
        }
        self.before = before[buckets];
        self.picks.extend(stays.into_iter().map(|stay| stay.picks));
        lacking == 0
    }

    /// What stays, bucket by bucket.
    pub(super) fn into_picks(self) -> Vec<Vec<Pick>> {
        self.picks
    }
}

impl Stay {
    /// Of the candidates for some regions, if so many stayed before them; `more` of those that do not stay do so
    /// nevertheless, the last ones.
    fn of(candidates: &[Candidate], regions: Range<usize>, mut before: usize, more: usize) -> Self {
        let own = |c: &Candidate| c.region as usize - regions.start;
        let mut counts = vec![0_u32; regions.len()];
        let mut best = vec![(u64::MAX, 0_u32); regions.len()];
        for (at, c) in (0..).zip(candidates) {
            let region = own(c);
            counts[region] += 1;
            let found = (c.rank(), at);
            best[region] = if found.0 < best[region].0 { found } else { best[region] };
        }
        let mut picks = Vec::with_capacity(regions.len());
        // Of a region that has more than its best candidate stay the number that do. There are few, but where all are
        // to be looked at.
        let mut several = vec![None; if more > 0 { regions.len() } else { 0 }];
        for (region, &count) in counts.iter().enumerate() {
            let due = (regions.start + region + 1).saturating_sub(before).min(count as usize);
            before += due;
            if due == 1 && more == 0 {
                picks.push(candidates[best[region].1 as usize].pick);
            } else if due > 1 || (more > 0 && count > 0) {
                several.resize(regions.len(), None);
                several[region] = Some(due);
            }
        }
        if several.is_empty() {
            return Self { picks, of: candidates.len() };
        }
        let mut others: Vec<&Candidate> = candidates.iter().filter(|c| several[own(c)].is_some()).collect();
        others.sort_by_key(|c| (c.region, c.rank()));
        let mut spare = Vec::new();
        for of_region in others.chunk_by(|a, b| a.region == b.region) {
            let (stay, rest) = of_region.split_at(several[own(of_region[0])].unwrap_or(0));
            picks.extend(stay.iter().map(|c| c.pick));
            spare.extend(rest.iter().map(|c| c.pick));
        }
        picks.extend_from_slice(&spare[spare.len() - more..]);
        Self { picks, of: candidates.len() }
    }
}

impl Candidate {
    /// The most central one of a region is the least, then that of the first face; those of a face stay as they came.
    #[inline]
    fn rank(&self) -> u64 {
        // Numbers from 0 up are in the order of their bits.
        u64::from(self.off.to_bits()) << 32 | u64::from(self.pick.face.0)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::ids::FaceId;

    proptest! {
        /// As one loop over all in order: who comes when fewer stayed than there are regions up to its own stays, and of
        /// the others the last fill up what is missing.
        #[test]
        fn buckets_do_not_matter(found in prop::collection::vec((0..40u32, 0..9u8), 0..120), size in 1..50usize) {
            let count = 40_usize;
            let candidate = |(nth, &(region, off)): (u32, &(u32, u8))| {
                Candidate { region, off: f32::from(off), pick: Pick::new(FaceId(nth % 7), u64::from(nth)) }
            };
            let all: Vec<Candidate> = (0..).zip(&found).map(candidate).collect();
            let piece = |p: usize| all.iter().copied().skip(p * 10).take(10).collect();
            let buckets = Buckets::new(all.len().div_ceil(10), piece, count.div_ceil(size), |c| c.region as usize / size);
            let mut stays = Stays::new(count, size);
            let is_enough = stays.add(&buckets, count.div_ceil(size));
            prop_assert_eq!(is_enough, all.len() >= count);
            if !is_enough {
                return Ok(());
            }
            let mut stay: Vec<u64> = stays.into_picks().concat().iter().map(|pick| pick.slot()).collect();
            stay.sort_unstable();
            let mut order = all.clone();
            order.sort_by_key(|c| (c.region, c.off as u32, c.pick.face));
            let (mut expected, mut spare) = (Vec::new(), Vec::new());
            for c in order {
                if expected.len() <= c.region as usize { expected.push(c.pick.slot()) } else { spare.push(c.pick.slot()) }
            }
            let missing = count - expected.len();
            expected.extend(&spare[spare.len() - missing..]);
            expected.sort_unstable();
            prop_assert_eq!(stay, expected);
        }
    }
}
