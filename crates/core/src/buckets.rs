//! Things made in pieces, on every core, and taken up again in another order: first sorted into buckets, then bucket after
//! bucket, so that what is looked at together lies together.

use std::ops::Range;

use crate::parallel;

/// Pieces whose items are sorted by bucket.
pub(crate) struct Buckets<T> {
    pieces: Vec<Vec<T>>,
    /// The runs of each bucket, bucket after bucket, piece after piece.
    runs: Vec<Run>,
    /// For each bucket where its runs start.
    starts: Vec<u32>,
}

/// Items of a piece that are in one bucket.
#[derive(Clone, Copy)]
struct Run {
    piece: u32,
    start: u32,
    end: u32,
}

impl<T: Copy + Send + Sync> Buckets<T> {
    /// Sorts what `make` makes for each piece into `count` buckets; items of a piece and a bucket keep their order.
    pub(crate) fn new(
        pieces: usize,
        make: impl Fn(usize) -> Vec<T> + Sync + Send,
        count: usize,
        bucket: impl Fn(&T) -> usize + Sync + Send,
    ) -> Self {
        let sorted = parallel::map(pieces, |piece| sorted(make(piece), &bucket));
        Self::of_sorted(sorted, count)
    }

    /// As [`new`](Self::new), of pieces that are there.
    pub(crate) fn of_pieces(
        pieces: Vec<Vec<T>>,
        count: usize,
        bucket: impl Fn(&T) -> usize + Sync + Send,
    ) -> Self {
        // Piece by piece, so that never both are there.
        let mut pieces: Vec<(Vec<T>, Runs)> = pieces.into_iter().map(|items| (items, Runs::new())).collect();
        parallel::change_chunks(&mut pieces, 1, |_, pieces| {
            for piece in pieces {
                *piece = sorted(std::mem::take(&mut piece.0), &bucket);
            }
        });
        Self::of_sorted(pieces, count)
    }

    fn of_sorted(sorted: Vec<Sorted<T>>, count: usize) -> Self {
        let mut starts = vec![0u32; count + 1];
        for (bucket, _) in sorted.iter().flat_map(|(_, runs)| runs) {
            starts[bucket + 1] += 1;
        }
        for bucket in 0..count {
            starts[bucket + 1] += starts[bucket];
        }
        let mut cursor = starts.clone();
        let mut runs = vec![Run { piece: 0, start: 0, end: 0 }; starts[count] as usize];
        for (piece, (bucket, Range { start, end })) in
            (0u32..).zip(&sorted).flat_map(|(piece, (_, runs))| runs.iter().map(move |run| (piece, run)))
        {
            let slot = &mut cursor[*bucket];
            runs[*slot as usize] = Run { piece, start: *start, end: *end };
            *slot += 1;
        }
        Self { pieces: sorted.into_iter().map(|(items, _)| items).collect(), runs, starts }
    }

    /// How many items there are.
    pub(crate) fn len(&self) -> usize {
        self.pieces.iter().map(Vec::len).sum()
    }

    /// How many buckets there are.
    pub(crate) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The items of a bucket, piece after piece.
    pub(crate) fn bucket(&self, bucket: usize) -> impl Iterator<Item = &T> {
        self.runs(bucket).flatten()
    }

    /// The same in slices.
    pub(crate) fn runs(&self, bucket: usize) -> impl Iterator<Item = &[T]> + Clone {
        let runs = &self.runs[self.starts[bucket] as usize..self.starts[bucket + 1] as usize];
        runs.iter().map(|run| &self.pieces[run.piece as usize][run.start as usize..run.end as usize])
    }

    /// Copies of the items of a bucket.
    pub(crate) fn to_vec(&self, bucket: usize) -> Vec<T> {
        let mut items = Vec::with_capacity(self.runs(bucket).map(<[T]>::len).sum());
        self.runs(bucket).for_each(|run| items.extend_from_slice(run));
        items
    }
}

/// Buckets that have items, each with its run of them.
type Runs = Vec<(usize, Range<u32>)>;

/// Items in the order of their buckets.
type Sorted<T> = (Vec<T>, Runs);

/// Items by their buckets, those of one in the order they had.
fn sorted<T: Copy>(mut items: Vec<T>, bucket: impl Fn(&T) -> usize) -> Sorted<T> {
    let mut buckets: Vec<u32> = items.iter().map(|item| bucket(item) as u32).collect();
    if !buckets.is_sorted() {
        let low = buckets.iter().fold(u32::MAX, |low, &b| low.min(b)) as usize;
        let high = buckets.iter().fold(0, |high, &b| high.max(b)) as usize;
        // Counting is faster as long as the counters are not many more than the items.
        if high - low > 4 * items.len() {
            items.sort_by_key(&bucket);
            buckets.sort_unstable();
            return (items, runs(&buckets));
        }
        let mut cursor = vec![0u32; high - low + 2];
        for &b in &buckets {
            cursor[b as usize - low + 1] += 1;
        }
        for b in 1..cursor.len() {
            cursor[b] += cursor[b - 1];
        }
        let mut placed = items.clone();
        for (item, &b) in items.iter().zip(&buckets) {
            let slot = &mut cursor[b as usize - low];
            placed[*slot as usize] = *item;
            *slot += 1;
        }
        // Each cursor stands where the next bucket starts.
        let ends = cursor[..=high - low].iter();
        let mut start = 0;
        let runs = ends.zip(low..).filter_map(|(&end, bucket)| {
            let run = start..end;
            start = end;
            (!run.is_empty()).then_some((bucket, run))
        });
        return (placed, runs.collect());
    }
    let runs = runs(&buckets);
    (items, runs)
}

/// The runs of buckets in order.
fn runs(buckets: &[u32]) -> Runs {
    let mut start = 0;
    let run = |run: &[u32]| {
        let first = start;
        start += run.len() as u32;
        (run[0] as usize, first..start)
    };
    buckets.chunk_by(|a, b| a == b).map(run).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// As one stable sort of everything, with few buckets and with many more than items.
        #[test]
        fn buckets_are_a_stable_sort(items in prop::collection::vec(0..200u32, 0..400), size in 1..50usize, wide in 1..90u32) {
            let piece = |p: usize| -> Vec<(u32, usize)> {
                let range = p * size..((p + 1) * size).min(items.len());
                range.map(|i| (items[i], i)).collect()
            };
            let bucket = |item: &(u32, usize)| (item.0 * wide) as usize;
            let buckets = Buckets::new(items.len().div_ceil(size), piece, 200 * wide as usize, bucket);
            let mut expected: Vec<(u32, usize)> = items.iter().copied().zip(0..).collect();
            expected.sort_by_key(|item| item.0);
            let found: Vec<_> = (0..buckets.count()).flat_map(|b| buckets.bucket(b)).copied().collect();
            prop_assert_eq!(&found, &expected);
            prop_assert_eq!(buckets.len(), items.len());
            let copies: Vec<_> = (0..buckets.count()).flat_map(|b| buckets.to_vec(b)).collect();
            prop_assert_eq!(copies, expected);
        }
    }
}
