//! Start vectors that are the same in each run and on each system.

use faer::c64;

/// A vector with parts between −1 and 1 by SplitMix64.
pub(super) fn vector(seed: u64, length: usize) -> Vec<c64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        // 53 bits fill a double.
        (bits >> 11) as f64 * (-52f64).exp2() - 1.0
    };
    (0..length).map(|_| c64::new(next(), next())).collect()
}
