//! Independent pieces of work on all cores.

use crate::Error;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `work(i)` for i below `count`, on all cores, in the order of i; `done` hears how many are done.
/// After an error no new piece is begun.
pub(super) fn collect<T: Send + Default + Clone>(
    count: usize,
    work: &(dyn Fn(usize) -> Result<T, Error> + Sync),
    done: &(dyn Fn(usize) + Sync),
) -> Result<Vec<T>, Error> {
    let (next, finished) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let results = Mutex::new(vec![T::default(); count]);
    let run = || -> Result<(), Error> {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return Ok(());
            }
            let result = work(i).inspect_err(|_| next.store(count, Ordering::Relaxed))?;
            results.lock().expect("no worker panics")[i] = result;
            done(finished.fetch_add(1, Ordering::Relaxed) + 1);
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count.max(1));
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(run)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().expect("no worker panics"))
    })?;
    Ok(results.into_inner().expect("no worker panics"))
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
