//! Time from a step count, never accumulated.

use serde::{Deserialize, Serialize};

/// Steps asked for agree with the grid if they miss it by this part of themselves.
const TOLERANCE: f64 = 1e-9;

/// The time of a motion: whole steps of the scene's step since a start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Clock {
    start: f64,
    steps: u64,
}

/// How to get from here to a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    /// Length of a step, s.
    pub(super) step: f64,
    /// How many.
    pub(super) count: u64,
    /// The clock at the end.
    pub(super) arrival: Clock,
}

impl Clock {
    pub(super) fn at(start: f64) -> Self {
        Self { start, steps: 0 }
    }

    /// Present time, s, on the grid of `step`.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn time(self, step: f64) -> f64 {
        self.start + self.steps as f64 * step
    }

    /// How much two times that mean the same may differ, s.
    pub(super) fn slack(time: f64, span: f64, step: f64) -> f64 {
        TOLERANCE * span.abs().max(step) + 4.0 * f64::EPSILON * time.abs()
    }

    /// The way to time `target`: on the grid if that is where it lies, so that however a run is
    /// split at points of the grid, the same steps are taken; else the fewest equal steps that are
    /// not longer than `step`, from where a new grid starts. `None` if `target` lies in the past
    /// or farther ahead than can be counted.
    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
    pub(super) fn way_to(self, target: f64, step: f64) -> Option<Leg> {
        const COUNTABLE: f64 = (1_u64 << 53) as f64;
        let span = target - self.time(step);
        let slack = Self::slack(target, span, step);
        if !(span >= -slack && (target - self.start) / step < COUNTABLE) {
            return None;
        }
        let nearest = ((target - self.start) / step).round();
        let on_grid = (self.start + nearest * step - target).abs() <= slack;
        if on_grid && nearest >= self.steps as f64 {
            let steps = nearest as u64;
            return Some(Leg {
                step,
                count: steps - self.steps,
                arrival: Self { start: self.start, steps },
            });
        }
        let count = (span / step - TOLERANCE).ceil().max(1.0);
        Some(Leg { step: span / count, count: count as u64, arrival: Self::at(target) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 1e-5;

    #[test]
    fn steps_that_arrive_rounded_land_on_the_grid() {
        let mut clock = Clock::at(0.0);
        let mut host = 0.0;
        for _ in 0..1000 {
            host += 0.1; // accumulates rounding errors, as hosts do
            let leg = clock.way_to(host, H).unwrap();
            assert_eq!((leg.step, leg.count), (H, 10_000));
            clock = leg.arrival;
        }
        assert_eq!(clock.time(H), 10_000_000.0 * H);
    }

    #[test]
    fn a_step_of_a_rounding_error_takes_none_and_loses_nothing() {
        let clock = Clock::at(0.0).way_to(0.1, H).unwrap().arrival;
        let leg = clock.way_to(0.1 + 1.1e-16, H).unwrap();
        assert_eq!(leg.count, 0);
        assert_eq!(leg.arrival.way_to(0.2, H).unwrap().count, 10_000);
    }

    #[test]
    fn a_step_off_the_grid_is_parted_evenly_and_starts_a_new_grid() {
        let leg = Clock::at(0.0).way_to(2.5 * H, H).unwrap();
        assert_eq!(leg.count, 3);
        assert!((leg.step - 2.5 * H / 3.0).abs() < 1e-20);
        assert_eq!(leg.arrival, Clock::at(2.5 * H));
    }

    #[test]
    fn a_step_shorter_than_the_internal_one_is_taken_as_it_is() {
        let leg = Clock::at(0.0).way_to(0.3 * H, H).unwrap();
        assert_eq!((leg.step, leg.count), (0.3 * H, 1));
    }

    #[test]
    fn the_past_and_the_unreachable_are_refused() {
        let clock = Clock::at(0.0).way_to(0.1, H).unwrap().arrival;
        assert_eq!(clock.way_to(0.05, H), None);
        assert_eq!(clock.way_to(f64::NAN, H), None);
        assert_eq!(clock.way_to(1e300, H), None);
    }
}
