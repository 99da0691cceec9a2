//! Bisection, norms and the range of a set of values, and linear complementarity problems.

mod lemke;

pub(crate) use lemke::Lemke;

/// Maximum norm ‖x‖∞: the largest magnitude of some values, in their unit; 0 of none. Values that are not a number are
/// ignored.
#[must_use]
pub fn max_norm(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| f64::max(most, value.abs()))
}

/// Euclidean norm ‖x‖₂ of some values, in their unit; 0 of none.
pub fn euclidean_norm(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |sum, value| sum + value * value).sqrt()
}

/// The smallest and the largest of some values, in their unit; `[∞, −∞]` of none. Values that are not a number are
/// ignored.
pub fn range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let nothing = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(nothing, |[least, most], value| [least.min(value), most.max(value)])
}

/// The middle of an interval; `None` where no double lies between its ends.
#[must_use]
pub fn middle(low: f64, high: f64) -> Option<f64> {
    let middle = 0.5 * (low + high);
    (low < middle && middle < high).then_some(middle)
}

/// Returns the ends of an interval in which a condition changes that holds at `low` and not at `high`, which is above
/// `low`: neighbouring doubles, or 2⁻¹⁰⁰ of the first interval if the change is that near to zero. Of several changes it
/// finds one. Calls `holds` at most 100 times.
pub fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> [f64; 2] {
    for _ in 0..100 {
        let Some(middle) = middle(low, high) else { break };
        if holds(middle) { low = middle } else { high = middle }
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_has_no_part_in_a_norm_or_a_range() {
        let values = [1.0, f64::NAN, -3.0, 2.0];
        assert_eq!((max_norm(&values), range(values)), (3.0, [-3.0, 2.0]));
        assert_eq!((max_norm(&[]), range([])), (0.0, [f64::INFINITY, f64::NEG_INFINITY]));
    }

    #[test]
    fn a_change_is_found_between_neighbouring_doubles() {
        for change in [0.3, 1e-14, 1.0] {
            let [below, above] = bisect(0.0, 1.0, |x| x < change);
            assert_eq!((below, above), (change.next_down(), change));
        }
    }

    /// A condition on eigenvalues may cease to hold at once, and each call takes time.
    #[test]
    fn a_change_at_zero_takes_a_hundred_calls() {
        let calls = std::cell::Cell::new(0);
        let holds = |_| {
            calls.set(calls.get() + 1);
            false
        };
        assert_eq!(bisect(0.0, 1.0, holds), [0.0, 0.5_f64.powi(100)]);
        assert_eq!(calls.get(), 100);
    }
}
