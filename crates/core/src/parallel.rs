//! Work on every core with results that do not depend on how many there are: the pieces are cut by size alone
//! and put together in order.

use std::ops::Range;

/// `f` of every index from 0 to `count - 1`, in order.
pub(crate) fn map<R: Send>(count: usize, f: impl Fn(usize) -> R + Sync + Send) -> Vec<R> {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().map(f).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count).map(f).collect()
    }
}

/// Puts `f` of every index from 0 to `count - 1` behind the items, in order.
pub(crate) fn extend<T: Send>(items: &mut Vec<T>, count: usize, f: impl Fn(usize) -> T + Sync + Send) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        items.par_extend((0..count).into_par_iter().map(f));
    }
    #[cfg(not(feature = "parallel"))]
    items.extend((0..count).map(f));
}

/// As [`map`], of an `f` that gives two, apart.
pub(crate) fn map_pairs<A: Send, B: Send>(
    count: usize,
    f: impl Fn(usize) -> (A, B) + Sync + Send,
) -> (Vec<A>, Vec<B>) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        let mut pairs = (Vec::new(), Vec::new());
        (0..count).into_par_iter().map(f).unzip_into_vecs(&mut pairs.0, &mut pairs.1);
        pairs
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count).map(f).unzip()
    }
}

/// The result of work that asks for many cores again and again: done by one of those, it need not wake them from outside
/// each time.
pub(crate) fn inside<R: Send>(f: impl FnOnce() -> R + Send) -> R {
    #[cfg(feature = "parallel")]
    {
        rayon::scope(|_| f())
    }
    #[cfg(not(feature = "parallel"))]
    {
        f()
    }
}

/// The results of two, side by side.
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    #[cfg(feature = "parallel")]
    {
        rayon::join(a, b)
    }
    #[cfg(not(feature = "parallel"))]
    {
        (a(), b())
    }
}

/// Sorts items; equal ones must be the same.
pub(crate) fn sort<T: Ord + Send>(items: &mut [T]) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        items.par_sort_unstable();
    }
    #[cfg(not(feature = "parallel"))]
    items.sort_unstable();
}

/// Changes runs of `size` items (the last may be shorter); `f` hears where each starts.
pub(crate) fn change_chunks<T: Send>(
    items: &mut [T],
    size: usize,
    f: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    debug_assert!(size > 0);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        items.par_chunks_mut(size).enumerate().for_each(|(i, chunk)| f(i * size, chunk));
    }
    #[cfg(not(feature = "parallel"))]
    for (i, chunk) in items.chunks_mut(size).enumerate() {
        f(i * size, chunk);
    }
}

/// `f` of the ranges of `size` that `0..count` falls into (the last may be shorter), in order. Summing the
/// results one after the other gives the same bits with any number of threads.
pub(crate) fn map_chunks<R: Send>(
    count: usize,
    size: usize,
    f: impl Fn(Range<usize>) -> R + Sync + Send,
) -> Vec<R> {
    debug_assert!(size > 0);
    map(count.div_ceil(size), |i| f(i * size..((i + 1) * size).min(count)))
}
