//! Samples that were picked, in their order: made block by block, so that never all of them are there at once.

use crate::buckets::Buckets;
use crate::correct::Mended;
use crate::ids::FaceId;
use crate::parallel;

/// A sample: its face and the slot of its domain point. Twelve bytes, because there are many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pick {
    pub(crate) face: FaceId,
    /// The lower half and the upper one.
    slot: [u32; 2],
}

impl Pick {
    #[inline]
    pub(crate) fn new(face: FaceId, slot: u64) -> Self {
        Self { face, slot: [slot as u32, (slot >> 32) as u32] }
    }

    #[inline]
    pub(crate) fn slot(self) -> u64 {
        u64::from(self.slot[0]) | u64::from(self.slot[1]) << 32
    }
}

/// Which of the samples in order are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    All,
    /// The first so many.
    First(usize),
    /// So many; the others are left out evenly.
    Spread(usize),
}

/// Picks in blocks of the order: by the number of their domain point, then by strip and face.
pub(crate) struct Picks {
    blocks: Buckets<Pick>,
    /// For each block the number at which it starts, and one above all numbers.
    starts: Vec<u64>,
}

/// So many samples are in a block, or a few more.
const BLOCK: u64 = 1 << 17;

/// In so many parts picks are counted.
const COUNTS: usize = 16;

impl Picks {
    /// Of samples in pieces. Linear time, 12 bytes a pick.
    pub(crate) fn new(mended: &Mended<'_>, picked: Vec<Vec<Pick>>) -> Self {
        /// Numbers fall into at most two to the power of this many bins, of which blocks are made.
        const BINS: u32 = 12;
        let shift = (u64::BITS - mended.end().leading_zeros()).saturating_sub(BINS);
        let bins = (mended.end() >> shift) as usize + 1;
        let bin = |pick: Pick| (mended.index(pick) >> shift) as usize;
        let counted = parallel::map_chunks(picked.len(), picked.len().div_ceil(COUNTS).max(1), |range| {
            let mut counts = vec![0_u64; bins];
            for piece in &picked[range] {
                for &pick in piece {
                    counts[bin(pick)] += 1;
                }
            }
            counts
        });
        let mut block_of_bin = Vec::with_capacity(bins);
        let mut starts = vec![0];
        let mut held = 0;
        for b in 0..bins {
            if held >= BLOCK {
                starts.push((b as u64) << shift);
                held = 0;
            }
            held += counted.iter().map(|counts| counts[b]).sum::<u64>();
            block_of_bin.push(starts.len() - 1);
        }
        let count = starts.len();
        starts.push((bins as u64) << shift);
        Self { blocks: Buckets::of_pieces(picked, count, |&pick| block_of_bin[bin(pick)]), starts }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.blocks.len()
    }

    /// Calls `visit` with those of each block that are kept, in order; the first error ends it.
    pub(crate) fn blocks<E>(
        &self,
        mended: &Mended<'_>,
        keep: Keep,
        mut visit: impl FnMut(&[Pick]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut is_kept = keep.test(self.count());
        for block in 0..self.blocks.count() {
            let mut order = self.sorted(mended, block);
            if keep != Keep::All {
                order.retain(|_| is_kept());
            }
            if !order.is_empty() {
                visit(&order)?;
            }
        }
        Ok(())
    }

    /// Those of a block, in order.
    fn sorted(&self, mended: &Mended<'_>, block: usize) -> Vec<Pick> {
        /// Picks in a piece of work.
        const PICKS: usize = 8192;
        /// Buckets of this many numbers, which hold some thousands of samples, as long as there are not too many of them.
        const NUMBERS: u32 = 14;
        const MOST: u32 = 12;
        let (start, end) = (self.starts[block], self.starts[block + 1]);
        let shift = (u64::BITS - (end - start).leading_zeros()).saturating_sub(MOST).max(NUMBERS);
        let picks = self.blocks.to_vec(block);
        let piece = |piece: usize| picks[piece * PICKS..((piece + 1) * PICKS).min(picks.len())].to_vec();
        let count = ((end - start) >> shift) as usize + 1;
        let bucket = |&pick: &Pick| ((mended.index(pick) - start) >> shift) as usize;
        let buckets = Buckets::new(picks.len().div_ceil(PICKS), piece, count, bucket);
        let sorted = parallel::map(count, |bucket| {
            let first = start + ((bucket as u64) << shift);
            by_number(mended, &buckets.to_vec(bucket), first, shift)
        });
        sorted.concat()
    }
}

/// Picks by the number of their point, then by strip and face; numbers are those from `first` on of as many bits as `bits`.
fn by_number(mended: &Mended<'_>, picks: &[Pick], first: u64, bits: u32) -> Vec<Pick> {
    // As many bins as picks, or up to twice as many: few have more than one or two.
    let shift = bits.saturating_sub(picks.len().max(1).ilog2() + 1);
    let bin = |pick: Pick| ((mended.index(pick) - first) >> shift) as usize;
    let mut cursor = vec![0_u32; (1 << (bits - shift)) + 1];
    for &pick in picks {
        cursor[bin(pick) + 1] += 1;
    }
    for b in 1..cursor.len() {
        cursor[b] += cursor[b - 1];
    }
    let mut sorted = picks.to_vec();
    for &pick in picks {
        let slot = &mut cursor[bin(pick)];
        sorted[*slot as usize] = pick;
        *slot += 1;
    }
    // Each cursor stands where the next bin starts.
    let mut start = 0;
    for end in cursor {
        let of_bin = &mut sorted[start..end as usize];
        start = end as usize;
        if of_bin.len() > 1 {
            of_bin.sort_unstable_by(|a, b| {
                let strip_and_face = |pick: &Pick| (mended.strip(pick.face), pick.face);
                let numbers = mended.index(*a).cmp(&mended.index(*b));
                numbers.then_with(|| strip_and_face(a).cmp(&strip_and_face(b)))
            });
        }
    }
    sorted
}

impl Keep {
    /// How many of so many are kept.
    pub(crate) fn count(self, of: usize) -> usize {
        match self {
            Self::All => of,
            Self::First(n) | Self::Spread(n) => of.min(n),
        }
    }

    /// Whether the next of so many is kept.
    fn test(self, of: usize) -> impl FnMut() -> bool {
        let surplus = match self {
            Self::Spread(n) => of.saturating_sub(n),
            Self::All | Self::First(_) => 0,
        };
        let first = self.count(of);
        // In 64 bits also where indices have 32.
        let (wide, surplus) = (of as u64, surplus as u64);
        let mut left_out = (0..surplus).map(move |k| ((2 * k + 1) * wide) / (2 * surplus)).peekable();
        let mut at = 0;
        move || {
            let is_left_out = left_out.next_if_eq(&at).is_some() || (surplus == 0 && at >= first as u64);
            at += 1;
            !is_left_out
        }
    }
}
