//! Work on many items, on all processors.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Does work on each item. The results have the order of the items.
pub fn on_each<I: Sync, T: Send>(items: &[I], work: impl Fn(&I) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<T>>> = items.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(i) = Some(next.fetch_add(1, Relaxed)).filter(|i| *i < items.len()) {
                    *results[i].lock().unwrap() = Some(work(&items[i]));
                }
            });
        }
    });
    let results = results.into_iter().map(|result| result.into_inner().unwrap());
    results.map(|result| result.expect("each item is worked on")).collect()
}
