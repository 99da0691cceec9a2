//! Independent pieces of work on all cores.

use amontons::Error;
use std::cell::Cell;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

thread_local! {
    /// `true` while the pieces of work of this thread are carried out in the thread itself.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Carries out an analysis without other threads, as one of many workers that share the cores. Results do not depend on
/// the number of threads.
pub fn on_this_thread<T>(analysis: impl FnOnce() -> T) -> T {
    struct Restore(bool);
    impl Drop for Restore {
        fn drop(&mut self) {
            ALONE.set(self.0);
        }
    }
    let _restore = Restore(ALONE.replace(true));
    analysis()
}

/// `true` within [`on_this_thread`].
#[must_use]
pub fn is_on_this_thread() -> bool {
    ALONE.get()
}

/// `work(i)` for i below `count`, on all cores, in the order of i; `done` hears how many are done.
///
/// # Errors
/// Returns the first error in the order of i. After an error no new piece is begun.
///
/// # Panics
/// Panics if a piece of work does.
pub fn collect<T: Send + Clone>(
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
    if is_on_this_thread() {
        run();
    } else {
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count.max(1));
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(run);
            }
        });
    }
    // Work that was not begun stands behind the error that was its reason.
    results.into_inner().expect("no worker panics").1.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_many_workers_starts_no_other_thread() {
        let here = std::thread::current().id();
        let threads = || collect(4, &|_| Ok(std::thread::current().id()), &|_| {}).unwrap();
        assert_eq!(on_this_thread(threads), [here; 4]);
        assert!(!threads().contains(&here));
    }

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
