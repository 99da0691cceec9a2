//! Start vectors that are the same in each run and on each system.

use faer::{Mat, c64};

/// A complex vector with parts between −1 and 1.
pub fn vector(seed: u64, length: usize) -> Vec<c64> {
    let mut next = numbers(seed);
    (0..length).map(|_| c64::new(next(), next())).collect()
}

/// Real vectors, the columns of a matrix, with entries between −1 and 1.
pub fn block(seed: u64, rows: usize, columns: usize) -> Mat<f64> {
    let mut next = numbers(seed);
    Mat::from_fn(rows, columns, |_, _| next())
}

/// Numbers between −1 and 1 by SplitMix64.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        // 53 bits fill a double.
        (bits >> 11) as f64 * (-52f64).exp2() - 1.0
    }
}
