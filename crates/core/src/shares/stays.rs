//! One point for each region.

use crate::buckets::Buckets;
use crate::correct::Pick;
use crate::parallel;

/// A point that may stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) region: u32,
    /// The square of its distance from the middle of the region.
    pub(super) off: f32,
    /// The face that caught it, and which of the face's points it is.
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
            let sorted = sorted(candidates.bucket(bucket).copied().collect(), first, size.min(count - first));
            let (mut stay, spare) = split(&sorted, before);
            stay.extend_from_slice(&spare[spare.len() - more..]);
            // Not collected, which would keep the memory of candidates.
            let mut picks = Vec::with_capacity(stay.len());
            picks.extend(stay.iter().map(|c| c.pick));
            Stay { picks, of: sorted.len() }
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

/// Those that stay if so many did before, and the others.
fn split(candidates: &[Candidate], mut before: usize) -> (Vec<Candidate>, Vec<Candidate>) {
    candidates.iter().partition(|c| {
        let stays = before <= c.region as usize;
        before += usize::from(stays);
        stays
    })
}

/// By region, the most central first, then by face and number. Regions are `count` from `first` on.
fn sorted(candidates: Vec<Candidate>, first: usize, count: usize) -> Vec<Candidate> {
    let mut cursor = vec![0_u32; count + 1];
    for c in &candidates {
        cursor[c.region as usize - first + 1] += 1;
    }
    for region in 0..count {
        cursor[region + 1] += cursor[region];
    }
    let mut sorted = candidates.clone();
    for c in candidates {
        let slot = &mut cursor[c.region as usize - first];
        sorted[*slot as usize] = c;
        *slot += 1;
    }
    for of_region in sorted.chunk_by_mut(|a, b| a.region == b.region) {
        of_region.sort_unstable_by(|a, b| a.off.total_cmp(&b.off).then(a.pick.cmp(&b.pick)));
    }
    sorted
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
                Candidate { region, off: f32::from(off), pick: Pick { face: FaceId(nth % 7), nth } }
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
            let mut stay: Vec<u32> = stays.into_picks().concat().iter().map(|pick| pick.nth).collect();
            stay.sort_unstable();
            let mut order = all.clone();
            order.sort_by_key(|c| (c.region, c.off as u32, c.pick));
            let (mut expected, mut spare) = (Vec::new(), Vec::new());
            for c in order {
                if expected.len() <= c.region as usize { expected.push(c.pick.nth) } else { spare.push(c.pick.nth) }
            }
            let missing = count - expected.len();
            expected.extend(&spare[spare.len() - missing..]);
            expected.sort_unstable();
            prop_assert_eq!(stay, expected);
        }
    }
}
