//! Time computed from a count of steps, never accumulated.

use crate::scene::MAX_STEPS;
use serde::{Deserialize, Serialize};

/// Relative tolerance for a requested step to count as a whole multiple of the internal step.
const TOLERANCE: f64 = 1e-9;
/// A requested step counts as a rounding error if it is shorter than this part of the internal step and below the
/// precision of times that hosts add up (`DIGITS`).
pub(super) const NOTHING: f64 = 1e-6;
const DIGITS: f64 = 1e-12;
/// Largest number of steps by which rounding may leave a saved clock behind its time.
const MOST_MADE_UP: f64 = 1e6;

/// Time of a motion: whole internal steps since a start, and the present time as the caller requested it. The two
/// differ by rounding errors, half an internal step at most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Clock {
    start: f64,
    steps: u64,
    asked: f64,
}

/// Steps from the present time to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepPlan {
    /// Length of a step, s.
    pub(super) step: f64,
    /// Number of steps, and number of steps that have been taken.
    pub(super) count: u64,
    pub(super) done: u64,
    /// Start of step 0 of the grid, s, and number of the plan's first step on this grid.
    origin: f64,
    first: u64,
    /// Present time within the next step, s; `None` at its beginning.
    within: Option<f64>,
    /// Clock at the end of the plan.
    pub(super) arrival: Clock,
}

impl StepPlan {
    pub(super) fn take(&mut self, steps: u64) {
        self.done += steps;
        self.within = None;
    }

    /// Takes a part of the next step, up to time `time` (s).
    pub(super) fn take_part(&mut self, time: f64) {
        self.within = Some(time);
    }

    /// `true` if a part of the next step has been taken.
    pub(super) fn is_within(&self) -> bool {
        self.within.is_some()
    }

    pub(super) fn is_done(&self) -> bool {
        self.done == self.count
    }

    /// Beginning and end of the next step, or of what is left of it, s.
    pub(super) fn next_step(&self) -> [f64; 2] {
        [self.within.unwrap_or_else(|| self.time(self.done)), self.time(self.done + 1)]
    }

    /// Beginning of a step of the plan (from 0), s; for a `step` equal to the number of steps, the end of the plan.
    #[allow(clippy::cast_precision_loss)]
    fn time(&self, step: u64) -> f64 {
        if step == self.count {
            return self.arrival.grid_time(self.step);
        }
        self.origin + (self.first + step) as f64 * self.step
    }

    /// Number of steps left.
    pub(super) fn left(&self) -> u64 {
        self.count - self.done
    }

    /// Number of steps, from the next one on, that end before time `until` (s): at least one, and at most the number left.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn steps_before(&self, until: f64) -> u64 {
        // One step less than fit, so that the last one ends a step before that time. Casts saturate.
        let count = ((until - self.time(self.done)) / self.step).floor() as u64;
        count.saturating_sub(1).clamp(1, self.left())
    }
}

impl Clock {
    pub(super) fn at(start: f64) -> Self {
        Self { start, steps: 0, asked: start }
    }

    /// Start of the count of steps, s.
    pub(super) fn start(self) -> f64 {
        self.start
    }

    /// Present time, s, as the caller requested it.
    pub(super) fn time(self) -> f64 {
        self.asked
    }

    /// Present time, s, on the grid of steps of this length: the same double for every division of a run.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn grid_time(self, step: f64) -> f64 {
        self.start + self.steps as f64 * step
    }

    /// Returns `true` if two times differ by at most half an internal step: callers that add up their steps
    /// accumulate rounding errors.
    pub(super) fn same(a: f64, b: f64, step: f64) -> bool {
        (a - b).abs() <= 0.5 * step
    }

    /// Returns `true` if the clock satisfies what holds for every clock with this internal step. A count that does
    /// not match the times would be made up for step by step.
    pub(super) fn is_possible(self, step: f64) -> bool {
        let off = (self.grid_time(step) - self.asked).abs();
        let rounding = 4.0 * f64::EPSILON * (self.start.abs() + self.asked.abs());
        // If times are too large to resolve a step, this number of steps limits the cost.
        let rounding = rounding.min(MOST_MADE_UP * step);
        self.start.is_finite() && self.asked.is_finite() && off <= step + rounding
    }

    /// Returns the steps to time `target`.
    ///
    /// If the span from the last requested time is a whole multiple of `step`, the plan consists of that many steps on
    /// the grid, to the point nearest to the target: every division of a run at points of the grid takes the same
    /// steps, and rounding errors of the times do not add up. Otherwise it is the smallest number of equal steps that
    /// are not longer than `step`, and a new grid starts at the target. `None` if the target lies in the past or is
    /// farther ahead than steps can be counted.
    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
    pub(super) fn plan_to(self, target: f64, step: f64) -> Option<StepPlan> {
        if !target.is_finite() {
            return None;
        }
        let asked = target - self.asked;
        let rounding = 4.0 * f64::EPSILON * target.abs();
        if !(asked >= -rounding && (target - self.start) / step < MAX_STEPS) {
            return None;
        }
        let multiple = nearest(asked / step) * step;
        let is_multiple = (asked - multiple).abs() <= TOLERANCE * asked + rounding;
        let nothing = (NOTHING * step).min(DIGITS * target.abs()).max(rounding);
        if (is_multiple && multiple > 0.0) || asked <= nothing {
            let steps = (nearest((target - self.start) / step) as u64).max(self.steps);
            let arrival = Self { steps, asked: target, ..self };
            let (origin, first) = (self.start, self.steps);
            let count = steps - self.steps;
            return Some(StepPlan { step, count, done: 0, origin, first, within: None, arrival });
        }
        let origin = self.grid_time(step);
        let span = target - origin;
        let count = (span / step - TOLERANCE).ceil().max(1.0);
        let (step, count, arrival) = (span / count, count as u64, Self::at(target));
        Some(StepPlan { step, count, done: 0, origin, first: 0, within: None, arrival })
    }
}

/// Nearest whole number to x, the larger one of two; 0 for a negative x. `f64::round` calls the C library, which
/// would slow short steps down.
fn nearest(x: f64) -> f64 {
    /// From here on all doubles are whole numbers.
    const WHOLE: f64 = (1_u64 << (f64::MANTISSA_DIGITS - 1)) as f64;
    if x >= WHOLE {
        return x;
    }
    let x = x.max(0.0);
    // This rounds halves to even numbers.
    let even = (x + WHOLE) - WHOLE;
    if x - even >= 0.5 { even + 1.0 } else { even }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_counted_to_the_nearest_whole_number() {
        let whole = 2.0_f64.powi(52);
        for x in [0.0, 0.5, 1.0, 1.5, 2.5, 7.0, 1e6 + 0.5, whole / 2.0 + 0.5, whole, 3.0 * whole] {
            for x in [x, f64::next_down(x), f64::next_up(x)] {
                assert_eq!(nearest(x), x.round().max(0.0), "{x:e}");
            }
        }
        assert!(nearest(-7.3) == 0.0 && nearest(f64::INFINITY) == f64::INFINITY);
    }

    const H: f64 = 1e-5;

    /// The clock after steps of the given lengths, added up as hosts do, and the number of steps taken.
    fn after(steps: impl IntoIterator<Item = f64>) -> (Clock, u64) {
        let (mut clock, mut host, mut taken) = (Clock::at(0.0), 0.0, 0);
        for size in steps {
            assert!(Clock::same(host, clock.time(), H));
            host += size;
            let plan = clock.plan_to(host, H).unwrap();
            assert!(plan.count == 0 || plan.step == H, "{plan:?}");
            taken += plan.count;
            clock = plan.arrival;
        }
        (clock, taken)
    }

    #[test]
    fn times_that_are_added_up_stay_on_the_grid() {
        assert_eq!(after(std::iter::repeat_n(0.1, 10_000)).1, 100_000_000);
        assert_eq!(after(std::iter::repeat_n(1e-4, 100_000)).1, 1_000_000);
        // The last step is ten internal steps long, or shorter than the rounding errors accumulated before it.
        for (last, taken) in [(1e-4, 10), (1.7e-13, 0), (1.1e-16, 0)] {
            let steps = std::iter::repeat_n(0.01, 1000).chain([last]);
            assert_eq!(after(steps).1, 1_000_000 + taken);
        }
        assert_eq!(after(std::iter::repeat_n(0.1, 1000).chain([1e-3])).1, 10_000_100);
    }

    /// A step of event-driven motion may be longer than the whole run; a requested time within it is not a rounding error.
    #[test]
    fn however_long_the_internal_step_what_is_asked_for_is_gone() {
        for (size, internal) in [(2e-4, 1e3), (5e-9, 1e-2), (2e-10, 2.5e-4)] {
            let mut clock = Clock::at(0.0);
            for row in 1..=1000 {
                let target = f64::from(row) * size;
                let plan = clock.plan_to(target, internal).unwrap();
                assert_eq!((plan.count, plan.time(1)), (1, target), "{size} of {internal}");
                clock = plan.arrival;
            }
        }
    }

    #[test]
    fn a_step_within_the_tolerance_is_whole_and_the_next_one_starts_from_it() {
        assert_eq!(after([1.000_000_000_5, 1e-3]).1, 100_100);
    }

    #[test]
    fn steps_that_are_too_long_by_a_hair_never_lead_astray() {
        // Each step is within the tolerance; together they deviate by 0.27 internal steps.
        let (clock, taken) = after(std::iter::repeat_n(0.1 * (1.0 + 0.9e-9), 30_000));
        let reached = f64::from(u32::try_from(taken).unwrap()) * H;
        assert!((clock.time() - reached).abs() <= 0.5 * H + 1e-9, "{clock:?} {reached}");
        assert_eq!(taken, 300_000_000);
    }

    #[test]
    fn a_step_off_the_grid_is_parted_evenly_and_starts_a_new_grid() {
        let plan = Clock::at(0.0).plan_to(2.5 * H, H).unwrap();
        assert_eq!(plan.count, 3);
        assert!((plan.step - 2.5 * H / 3.0).abs() < 1e-20);
        assert_eq!(plan.arrival, Clock::at(2.5 * H));
        assert_eq!(plan.arrival.plan_to(4.5 * H, H).unwrap().count, 2);
    }

    #[test]
    fn a_step_shorter_than_the_internal_one_is_taken_as_it_is() {
        let plan = Clock::at(0.0).plan_to(0.3 * H, H).unwrap();
        assert_eq!((plan.step, plan.count), (0.3 * H, 1));
    }

    #[test]
    fn a_clock_whose_count_is_not_that_of_its_times_is_impossible() {
        let clock = after([0.1, 1e-4]).0;
        assert!(clock.is_possible(H) && Clock::at(-1e300).is_possible(H));
        for forged in [
            Clock { start: -1e3, ..clock },
            Clock { start: 1e20, asked: 1e20 + 1e5, steps: 0 },
            Clock { asked: 1e300, ..clock },
            Clock { steps: 1 << 63, ..clock },
            Clock { steps: 0, ..clock },
            Clock::at(f64::NAN),
            Clock::at(f64::INFINITY),
        ] {
            assert!(!forged.is_possible(H), "{forged:?}");
        }
    }

    #[test]
    fn the_past_and_the_unreachable_are_refused() {
        let clock = Clock::at(0.0).plan_to(0.1, H).unwrap().arrival;
        assert_eq!(clock.plan_to(0.05, H), None);
        assert_eq!(clock.plan_to(f64::NAN, H), None);
        assert_eq!(clock.plan_to(1e300, H), None);
    }
}
