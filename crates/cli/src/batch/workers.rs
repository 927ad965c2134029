//! Several meshes at a time, each with its share of the threads.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::sync_channel;

use anyhow::Context;

/// As much as the main thread has on most systems: what works there works here.
const STACK: usize = 8 << 20;

/// How many meshes at a time, and with how many threads each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Workers {
    pub(crate) jobs: usize,
    pub(crate) threads: usize,
}

impl Workers {
    /// Shares `threads` out among `jobs`, by default among as many.
    pub(crate) fn new(jobs: Option<usize>, threads: usize) -> Self {
        let jobs = jobs.unwrap_or(threads);
        Self { jobs, threads: (threads / jobs).max(1) }
    }

    /// Does `work` on every item and hands each result with its place to `take`, in the order in which they are ready. A
    /// panic is a result too: what it said. An error of `take` ends the work.
    pub(crate) fn run<T: Sync, R: Send>(
        self,
        items: &[T],
        work: impl Fn(&T) -> R + Sync,
        mut take: impl FnMut(usize, Result<R, String>) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let next = AtomicUsize::new(0);
        let stopped = AtomicBool::new(false);
        let jobs = self.jobs.min(items.len());
        let pools: Result<Vec<_>, _> = (0..jobs)
            .map(|_| rayon::ThreadPoolBuilder::new().num_threads(self.threads).stack_size(STACK).build())
            .collect();
        let pools = pools.context("the threads cannot be started: choose fewer --jobs or --threads")?;
        std::thread::scope(|scope| {
            let (sender, receiver) = sync_channel(jobs);
            for pool in &pools {
                let (sender, next, stopped, work) = (sender.clone(), &next, &stopped, &work);
                scope.spawn(move || {
                    while !stopped.load(Ordering::Relaxed) {
                        let place = next.fetch_add(1, Ordering::Relaxed);
                        let Some(item) = items.get(place) else { break };
                        // Nothing that a panic could leave half changed is looked at again.
                        let done = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(item))));
                        if sender.send((place, done.map_err(|panic| words(&*panic)))).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            for (place, result) in receiver {
                if let Err(error) = take(place, result) {
                    stopped.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
            Ok(())
        })
    }
}

/// What a panic said.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without words").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_shared_out() {
        let shared = |jobs, threads| {
            let workers = Workers::new(jobs, threads);
            (workers.jobs, workers.threads)
        };
        assert_eq!(shared(None, 8), (8, 1));
        assert_eq!(shared(Some(2), 8), (2, 4));
        assert_eq!(shared(Some(3), 8), (3, 2));
        assert_eq!(shared(Some(16), 8), (16, 1));
    }

    #[test]
    fn every_item_is_worked_on_once_even_beside_panics() {
        let items: Vec<usize> = (0..100).collect();
        for jobs in [1, 3, 200] {
            let mut results = vec![None; items.len()];
            let work = |&item: &usize| {
                assert!(item % 10 != 3, "item {item}");
                item * 2
            };
            Workers { jobs, threads: 1 }
                .run(&items, work, |place, result| {
                    assert!(results[place].replace(result).is_none());
                    Ok(())
                })
                .unwrap();
            for (item, result) in results.into_iter().enumerate() {
                let expected = if item % 10 == 3 { Err(format!("item {item}")) } else { Ok(item * 2) };
                assert_eq!(result, Some(expected));
            }
        }
    }

    #[test]
    fn an_error_ends_the_work() {
        let items: Vec<usize> = (0..10_000).collect();
        let mut taken = 0;
        let ended = Workers { jobs: 2, threads: 1 }.run(
            &items,
            |&item| item,
            |_, _| {
                taken += 1;
                if taken == 3 { Err(anyhow::anyhow!("the disk is full")) } else { Ok(()) }
            },
        );
        assert_eq!((ended.unwrap_err().to_string().as_str(), taken), ("the disk is full", 3));
        assert!(Workers { jobs: 2, threads: 1 }.run(&[], |item: &usize| *item, |_, _| Ok(())).is_ok());
    }
}
