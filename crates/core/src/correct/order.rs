//! Samples that were picked, in their order: made block by block, so that never all of them are there at once.

use crate::buckets::Buckets;
use crate::correct::{Corrected, Mended};
use crate::ids::FaceId;
use crate::parallel;

/// A sample of those on a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Pick {
    pub(crate) face: FaceId,
    /// Which of the face's.
    pub(crate) nth: u32,
}

/// A pick with the bin of its number.
#[derive(Clone, Copy)]
struct Binned {
    pick: Pick,
    bin: u32,
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
    blocks: Buckets<Binned>,
    /// For each block the number at which it starts, and one above all numbers.
    starts: Vec<u64>,
}

/// So many samples are in a block, or a few more.
const BLOCK: u64 = 1 << 17;

impl Picks {
    /// Of samples that are there, in pieces. Linear time, 12 bytes a pick.
    pub(crate) fn new(mended: &Mended<'_>, picked: Vec<Vec<Pick>>) -> Self {
        /// Numbers fall into at most two to the power of this many bins, of which blocks are made.
        const BINS: u32 = 12;
        let shift = (u64::BITS - mended.end().leading_zeros()).saturating_sub(BINS);
        // Piece by piece, so that never both are there.
        let mut pieces: Vec<(Vec<Pick>, Vec<Binned>)> = picked.into_iter().map(|p| (p, Vec::new())).collect();
        parallel::change_chunks(&mut pieces, 1, |_, pieces| {
            for (picked, binned) in pieces {
                binned.reserve_exact(picked.len());
                for of_face in picked.chunk_by(|a, b| a.face == b.face) {
                    let on = mended.on(of_face[0].face);
                    binned.extend(of_face.iter().filter_map(|&pick| {
                        Some(Binned { pick, bin: (on.index(pick.nth as usize)? >> shift) as u32 })
                    }));
                }
                *picked = Vec::new();
            }
        });
        let binned: Vec<Vec<Binned>> = pieces.into_iter().map(|(_, binned)| binned).collect();
        let bins = (mended.end() >> shift) as usize + 1;
        let mut counts = vec![0_u64; bins];
        for pick in binned.iter().flatten() {
            counts[pick.bin as usize] += 1;
        }
        let mut block_of_bin = Vec::with_capacity(bins);
        let mut starts = vec![0];
        let mut held = 0;
        for (bin, count) in (0..).zip(&counts) {
            if held >= BLOCK {
                starts.push(bin << shift);
                held = 0;
            }
            held += count;
            block_of_bin.push(starts.len() - 1);
        }
        let count = starts.len();
        starts.push((bins as u64) << shift);
        Self { blocks: Buckets::of_pieces(binned, count, |pick| block_of_bin[pick.bin as usize]), starts }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.blocks.len()
    }

    /// Makes the samples block by block and calls `visit` with those of each block that are kept, in order; the first
    /// error ends it.
    pub(crate) fn blocks<E>(
        &self,
        mended: &Mended<'_>,
        keep: Keep,
        mut visit: impl FnMut(&[&Corrected]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut is_kept = keep.test(self.count());
        for block in 0..self.blocks.count() {
            let made = self.make(mended, block);
            let mut order = made.by_key(|c| (c.index, c.sample.strip, c.sample.point.face));
            if keep != Keep::All {
                order.retain(|_| is_kept());
            }
            if !order.is_empty() {
                visit(&order)?;
            }
        }
        Ok(())
    }

    /// The samples of a block, in buckets that follow each other in the order.
    fn make(&self, mended: &Mended<'_>, block: usize) -> Buckets<Corrected> {
        /// Picks in a piece of work.
        const PICKS: usize = 4096;
        /// Buckets of this many numbers, which hold some thousands of samples, as long as there are not too many of them.
        const NUMBERS: u32 = 14;
        const MOST: u32 = 12;
        let (start, end) = (self.starts[block], self.starts[block + 1]);
        let shift = (u64::BITS - (end - start).leading_zeros()).saturating_sub(MOST).max(NUMBERS);
        let picks: Vec<Pick> = self.blocks.bucket(block).map(|binned| binned.pick).collect();
        let make = |piece: usize| {
            let picks = &picks[piece * PICKS..((piece + 1) * PICKS).min(picks.len())];
            let mut samples = Vec::with_capacity(picks.len());
            // Most of a face's follow each other.
            for of_face in picks.chunk_by(|a, b| a.face == b.face) {
                let on = mended.on(of_face[0].face);
                samples.extend(of_face.iter().filter_map(|pick| on.sample(pick.nth as usize)));
            }
            samples
        };
        let count = ((end - start) >> shift) as usize + 1;
        Buckets::new(picks.len().div_ceil(PICKS), make, count, |c| ((c.index - start) >> shift) as usize)
    }
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
