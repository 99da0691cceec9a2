//! Independent pieces of work on all cores.

use amontons::Error;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `work(i)` for i below `count`, on all cores, in the order of i; `done` hears how many are done.
/// After an error no new piece is begun; of several the first in the order of i is given.
pub(crate) fn collect<T: Send + Clone>(
    count: usize,
    work: &(dyn Fn(usize) -> Result<T, Error> + Sync),
    done: &(dyn Fn(usize) + Sync),
) -> Result<Vec<T>, Error> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new((0, vec![None; count]));
    let run = || {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return;
            }
            let result = work(i);
            if result.is_err() {
                next.store(count, Ordering::Relaxed);
            }
            let mut results = results.lock().expect("no worker panics");
            results.0 += 1;
            results.1[i] = Some(result);
            done(results.0);
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count.max(1));
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(run);
        }
    });
    // Work that was not begun stands behind the error that was its reason.
    results.into_inner().expect("no worker panics").1.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_and_the_first_error_ends_the_work() {
        assert_eq!(collect(5, &|i| Ok(i * i), &|_| {}), Ok(vec![0, 1, 4, 9, 16]));
        let begun = AtomicUsize::new(0);
        let work = |i: usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            if i == 3 { Err(Error::analysis("three")) } else { Ok(i) }
        };
        assert!(collect(100_000, &work, &|_| {}).unwrap_err().is_analysis());
        assert!(begun.load(Ordering::Relaxed) < 100_000);
    }
}
