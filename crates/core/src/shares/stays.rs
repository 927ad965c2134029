//! One point for each region.

use crate::buckets::Buckets;
use crate::ids::FaceId;
use crate::parallel;

/// A point that may stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) region: u32,
    /// The square of its distance from the middle of the region.
    pub(super) off: f32,
    /// The face that caught it, and which of the face's points it is.
    pub(super) face: FaceId,
    pub(super) nth: u32,
}

/// One candidate stays in each of `count` regions, the most central one; a region without any gets one of the next that has
/// some to spare, and what the last ones lack those before them give. Buckets have `size` regions each, and what stays is
/// returned bucket by bucket; `None` if there are fewer candidates than regions.
pub(super) fn stays(
    candidates: Buckets<Candidate>,
    count: usize,
    size: usize,
) -> Option<Vec<Vec<Candidate>>> {
    if candidates.len() < count {
        return None;
    }
    let buckets: Vec<Vec<Candidate>> = parallel::map(candidates.count(), |bucket| {
        let first = bucket * size;
        sorted(candidates.bucket(bucket).copied().collect(), first, size.min(count - first))
    });
    drop(candidates);
    // How many stay before each bucket: as many as without a lack before it, and as many more as lack and are there.
    let most = parallel::map(buckets.len(), |b| split(&buckets[b], b * size).0.len());
    let mut before = vec![0];
    for (b, candidates) in buckets.iter().enumerate() {
        before.push((before[b] + candidates.len()).min(b * size + most[b]));
    }
    let mut lacking = count - before[buckets.len()];
    let mut more = vec![0; buckets.len()];
    for (b, candidates) in buckets.iter().enumerate().rev() {
        let spare = candidates.len() - (before[b + 1] - before[b]);
        more[b] = spare.min(lacking);
        lacking -= more[b];
    }
    Some(parallel::map(buckets.len(), |b| {
        let (mut stay, spare) = split(&buckets[b], before[b]);
        stay.extend_from_slice(&spare[spare.len() - more[b]..]);
        stay
    }))
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
        of_region
            .sort_unstable_by(|a, b| a.off.total_cmp(&b.off).then((a.face, a.nth).cmp(&(b.face, b.nth))));
    }
    sorted
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// As one loop over all in order: who comes when fewer stayed than there are regions up to its own stays, and of
        /// the others the last fill up what is missing.
        #[test]
        fn buckets_do_not_matter(found in prop::collection::vec((0..40u32, 0..9u8), 0..120), size in 1..50usize) {
            let count = 40_usize;
            let candidate = |(nth, &(region, off)): (u32, &(u32, u8))| {
                Candidate { region, off: f32::from(off), face: FaceId(nth % 7), nth }
            };
            let all: Vec<Candidate> = (0..).zip(&found).map(candidate).collect();
            let piece = |p: usize| all.iter().copied().skip(p * 10).take(10).collect();
            let buckets = Buckets::new(all.len().div_ceil(10), piece, count.div_ceil(size), |c| c.region as usize / size);
            let Some(stay) = stays(buckets, count, size) else {
                prop_assert!(all.len() < count);
                return Ok(());
            };
            let mut stay: Vec<u32> = stay.concat().iter().map(|c| c.nth).collect();
            stay.sort_unstable();
            let mut order = all.clone();
            order.sort_by_key(|c| (c.region, c.off as u32, c.face, c.nth));
            let (mut expected, mut spare) = (Vec::new(), Vec::new());
            for c in order {
                if expected.len() <= c.region as usize { expected.push(c.nth) } else { spare.push(c.nth) }
            }
            let missing = count - expected.len();
            expected.extend(&spare[spare.len() - missing..]);
            expected.sort_unstable();
            prop_assert_eq!(stay, expected);
        }
    }
}
