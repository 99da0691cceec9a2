//! The largest step that fulfils a condition together with all smaller ones, and its comparison with a given step.

/// Number of equally spaced steps at which a condition is evaluated first.
const GRID: u32 = 256;
/// Relative precision of the largest step.
const PRECISION: f64 = 1e-6;

/// The largest step below `end` up to which all steps fulfil a condition: on a grid, then refined.
pub(super) fn largest(end: f64, holds: impl Fn(f64) -> bool) -> f64 {
    narrowed(end, holds, |_, _| false)
}

/// `true` if a step above zero is at most the one that [`largest`] finds. The condition is evaluated at no step of the
/// grid beyond the first one above it.
pub(super) fn reaches(step: f64, end: f64, holds: impl Fn(f64) -> bool) -> bool {
    step <= end && narrowed(end, holds, |good, bad| good >= step || bad <= step) >= step
}

/// The largest step that is known to fulfil the condition. The search ends early when `is_enough` returns `true` for
/// this step and the smallest one that is known not to fulfil it.
fn narrowed(end: f64, holds: impl Fn(f64) -> bool, is_enough: impl Fn(f64, f64) -> bool) -> f64 {
    if !end.is_finite() {
        return end;
    }
    let (mut good, mut bad) = (0.0, f64::INFINITY);
    for i in 1..=GRID {
        let step = end * f64::from(i) / f64::from(GRID);
        if !holds(step) {
            bad = step;
            break;
        }
        good = step;
        if is_enough(good, bad) {
            return good;
        }
    }
    while bad.is_finite() && bad - good > PRECISION * bad && !is_enough(good, bad) {
        let middle = 0.5 * (good + bad);
        if holds(middle) { good = middle } else { bad = middle }
    }
    good
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cell::Cell;

    proptest! {
        #[test]
        fn a_step_is_reached_where_it_is_at_most_the_largest_one(
            end in 0.1..10.0_f64,
            gaps in prop::collection::vec((0.0..1.2_f64, 0.0..0.1_f64), 0..4),
            parts in prop::collection::vec(0.0..1.2_f64, 1..20),
        ) {
            let is_in = |step: f64, (from, length): &(f64, f64)| {
                (from * end..(from + length) * end).contains(&step)
            };
            let holds = |step: f64| !gaps.iter().any(|gap| is_in(step, gap));
            let most = largest(end, holds);
            let near = [1.0, 1.0 - 1e-15, 1.0 + 1e-15, 1.0 - 1e-7, 1.0 + 1e-7].map(|part| part * most);
            let steps = parts.iter().map(|part| part * end).chain(near);
            for step in steps.filter(|step| *step > 0.0) {
                prop_assert_eq!(reaches(step, end, holds), step <= most, "{} {}", step, most);
            }
        }
    }

    #[test]
    fn no_larger_steps_are_asked_for() {
        let asked = Cell::new(0);
        let holds = |step: f64| {
            asked.set(asked.get() + 1);
            step < 0.9
        };
        assert!(reaches(0.01, 1.0, holds));
        assert_eq!(asked.replace(0), 3);
        assert!(!reaches(1.01, 1.0, holds));
        assert_eq!(asked.get(), 0);
        assert!(reaches(5.0, f64::INFINITY, holds));
    }
}
