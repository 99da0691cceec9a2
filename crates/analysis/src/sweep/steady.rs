//! Constancy of the size of a motion.

/// The size of a settled motion differs by less than this from one window to the next, relative.
const SAME_SIZE: f64 = 1e-3;
/// Drifting one way all the time it must not have further to go than this, relative.
const LEFT_TO_GO: f64 = 2e-3;
/// A drift that does not slow down must be below this, relative: rounding.
pub(crate) const STANDING: f64 = 1e-7;
/// A size tends to zero if its limit is at most this part of the last size.
const REST: f64 = 0.2;
/// A displacement that moves by less than this part of the largest displacement, or of the equilibrium's, rests.
pub(crate) const ROUNDING: f64 = 1e-12;

/// A sum of all displacements with factors that no symmetry of a structure has.
#[allow(clippy::cast_precision_loss)]
pub(crate) fn mixture(displacement: &[f64]) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let factor = |i: usize| 0.5 + (i as f64 * GOLDEN).fract();
    displacement.iter().enumerate().fold(0.0, |sum, (i, x)| sum + factor(i) * x)
}

/// Deviation of values from their mean, root mean square of the weighted values: as many periods as fit in a window,
/// whole or not, have the same size wherever it begins.
pub(crate) fn weighted_deviation(values: &[f64], weights: &[f64]) -> f64 {
    let over = |quantity: &dyn Fn(f64) -> f64| {
        let pairs = values.iter().zip(weights);
        pairs.fold(0.0, |sum, (value, weight)| sum + weight * quantity(*value))
    };
    let sum = over(&|_| 1.0);
    let mean = over(&|x| x) / sum;
    (over(&|x| (x - mean) * (x - mean)) / sum).sqrt()
}

/// The limit of sizes that fall by ever less, by Aitken's extrapolation; `None` of others. It is exact for the sizes of windows that
/// follow each other of what decays exponentially, and for those at times that double of what decays like a power of time.
pub(crate) fn limit([a, b, c]: [f64; 3]) -> Option<f64> {
    let (before, after) = (b - a, c - b);
    (after < 0.0 && before < after).then(|| c - after * after / (after - before))
}

/// `true` if sizes fall to zero as they go on.
pub(crate) fn tends_to_zero(sizes: [f64; 3]) -> bool {
    limit(sizes).is_some_and(|limit| limit.abs() <= REST * sizes[2])
}

/// `true` if the size goes one way from each window to the next, by more than a settled motion's may differ.
pub(crate) fn drifts(sizes: &[f64]) -> bool {
    let change = || sizes.windows(2).map(|two| two[1] / two[0] - 1.0);
    let is_one_way = change().all(|change| change > 0.0) || change().all(|change| change < 0.0);
    is_one_way && change().all(|change| change.abs() > SAME_SIZE)
}

/// `true` if the size stays over the last four windows.
pub(crate) fn is_steady(sizes: &[f64]) -> bool {
    let Some(first) = sizes.len().checked_sub(4) else { return false };
    let last = &sizes[first..];
    let change: Vec<f64> = last.windows(2).map(|two| two[1] / two[0] - 1.0).collect();
    if change.iter().any(|change| change.abs() > SAME_SIZE) {
        return false;
    }
    let one_way =
        change.iter().all(|change| *change > 0.0) || change.iter().all(|change| *change < 0.0);
    if !one_way || change.iter().all(|change| change.abs() <= STANDING) {
        return true;
    }
    let slowing = change[2].abs() / change[1].abs();
    change[1].abs() < change[0].abs()
        && slowing < 1.0
        && change[2].abs() * slowing / (1.0 - slowing) <= LEFT_TO_GO
}
