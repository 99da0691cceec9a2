//! Time from a step count, never accumulated.

use crate::scene::MAX_STEPS;
use serde::{Deserialize, Serialize};

/// A step asked for is a whole multiple of the internal step if it misses it by this part.
const TOLERANCE: f64 = 1e-9;
/// A step asked for that is shorter than this part of the internal step, and than the digits of times that
/// hosts add up, is a rounding error.
pub(super) const NOTHING: f64 = 1e-6;
const DIGITS: f64 = 1e-12;
/// Steps that a saved clock may be behind its time by rounding.
const MOST_MADE_UP: f64 = 1e6;

/// The time of a motion: whole internal steps since a start, and what whoever asks for the steps
/// calls the present time. The two differ by rounding errors, half an internal step at most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Clock {
    start: f64,
    steps: u64,
    asked: f64,
}

/// How to get from here to a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    /// Length of a step, s.
    pub(super) step: f64,
    /// How many, and how many of them have been taken.
    pub(super) count: u64,
    pub(super) done: u64,
    /// Where step 0 of its grid begins, s, and the number of its first step there.
    origin: f64,
    first: u64,
    /// Where within the next step the motion is, s; none at its beginning.
    within: Option<f64>,
    /// The clock at the end.
    pub(super) arrival: Clock,
}

impl Leg {
    pub(super) fn take(&mut self, steps: u64) {
        self.done += steps;
        self.within = None;
    }

    /// Takes a part of the next step, to time `time` (s).
    pub(super) fn take_part(&mut self, time: f64) {
        self.within = Some(time);
    }

    /// Has a part of the next step been taken?
    pub(super) fn is_within(&self) -> bool {
        self.within.is_some()
    }

    pub(super) fn is_done(&self) -> bool {
        self.done == self.count
    }

    /// When the next step begins and ends, s, or what is left of it.
    pub(super) fn next_step(&self) -> [f64; 2] {
        [self.within.unwrap_or_else(|| self.time(self.done)), self.time(self.done + 1)]
    }

    /// When one of its steps (from 0) begins, s; that of the count is the end.
    #[allow(clippy::cast_precision_loss)]
    fn time(&self, step: u64) -> f64 {
        if step == self.count {
            return self.arrival.grid_time(self.step);
        }
        self.origin + (self.first + step) as f64 * self.step
    }

    /// How many steps are left.
    pub(super) fn left(&self) -> u64 {
        self.count - self.done
    }

    /// How many steps from the next one on end before time `until` (s); at least that one, at most those
    /// that are left.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub(super) fn steps_before(&self, until: f64) -> u64 {
        // One less than fit in leaves the last one's end a step before that time. Casts saturate.
        let count = ((until - self.time(self.done)) / self.step).floor() as u64;
        count.saturating_sub(1).clamp(1, self.left())
    }
}

impl Clock {
    pub(super) fn at(start: f64) -> Self {
        Self { start, steps: 0, asked: start }
    }

    /// Where its count of steps begins, s.
    pub(super) fn start(self) -> f64 {
        self.start
    }

    /// Present time, s, in the words of whoever asked for it.
    pub(super) fn time(self) -> f64 {
        self.asked
    }

    /// Present time, s, on the grid of steps of this length: however a run is split, the same double.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn grid_time(self, step: f64) -> f64 {
        self.start + self.steps as f64 * step
    }

    /// Do two times mean the same, for a run with this internal step? Whoever adds up their steps
    /// gathers rounding errors.
    pub(super) fn same(a: f64, b: f64, step: f64) -> bool {
        (a - b).abs() <= 0.5 * step
    }

    /// Does it keep what every clock with this internal step keeps? A count that does not belong to its times
    /// would be made up for step by step.
    pub(super) fn is_possible(self, step: f64) -> bool {
        let off = (self.grid_time(step) - self.asked).abs();
        let rounding = 4.0 * f64::EPSILON * (self.start.abs() + self.asked.abs());
        // Where times are too large for the step to be seen, that many steps are all that it may cost.
        let rounding = rounding.min(MOST_MADE_UP * step);
        self.start.is_finite() && self.asked.is_finite() && off <= step + rounding
    }

    /// The way to time `target`.
    ///
    /// Where the span from the last time asked for is a whole multiple of `step`, it is that many
    /// steps on the grid, to the point nearest to the target: however a run is split at points of
    /// the grid, the same steps are taken, and rounding errors of the times never add up. Else it is
    /// the fewest equal steps that are not longer than `step`, and a new grid starts at the target.
    /// `None` if the target lies in the past or farther ahead than can be counted.
    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]
    pub(super) fn way_to(self, target: f64, step: f64) -> Option<Leg> {
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
            return Some(Leg { step, count, done: 0, origin, first, within: None, arrival });
        }
        let origin = self.grid_time(step);
        let span = target - origin;
        let count = (span / step - TOLERANCE).ceil().max(1.0);
        let (step, count, arrival) = (span / count, count as u64, Self::at(target));
        Some(Leg { step, count, done: 0, origin, first: 0, within: None, arrival })
    }
}

/// The whole number that is nearest to x, of two the larger one; 0 where x is below. `f64::round` is a call
/// into the C library, which a short step would feel.
fn nearest(x: f64) -> f64 {
    /// From here on no double has a fraction.
    const WHOLE: f64 = (1_u64 << (f64::MANTISSA_DIGITS - 1)) as f64;
    if x >= WHOLE {
        return x;
    }
    let x = x.max(0.0);
    // Rounds halves to even ones.
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

    /// The clock after steps of the given lengths, added up as hosts do, and the steps taken.
    fn after(steps: impl IntoIterator<Item = f64>) -> (Clock, u64) {
        let (mut clock, mut host, mut taken) = (Clock::at(0.0), 0.0, 0);
        for size in steps {
            assert!(Clock::same(host, clock.time(), H));
            host += size;
            let leg = clock.way_to(host, H).unwrap();
            assert!(leg.count == 0 || leg.step == H, "{leg:?}");
            taken += leg.count;
            clock = leg.arrival;
        }
        (clock, taken)
    }

    #[test]
    fn times_that_are_added_up_stay_on_the_grid() {
        assert_eq!(after(std::iter::repeat_n(0.1, 10_000)).1, 100_000_000);
        assert_eq!(after(std::iter::repeat_n(1e-4, 100_000)).1, 1_000_000);
        // Each of these ends in a step shorter than the rounding errors gathered before it.
        for (last, taken) in [(1e-4, 10), (1.7e-13, 0), (1.1e-16, 0)] {
            let steps = std::iter::repeat_n(0.01, 1000).chain([last]);
            assert_eq!(after(steps).1, 1_000_000 + taken);
        }
        assert_eq!(after(std::iter::repeat_n(0.1, 1000).chain([1e-3])).1, 10_000_100);
    }

    /// A step of exact motion may be longer than all else; what is asked for in between is no rounding.
    #[test]
    fn however_long_the_internal_step_what_is_asked_for_is_gone() {
        for (size, internal) in [(2e-4, 1e3), (5e-9, 1e-2), (2e-10, 2.5e-4)] {
            let mut clock = Clock::at(0.0);
            for row in 1..=1000 {
                let target = f64::from(row) * size;
                let leg = clock.way_to(target, internal).unwrap();
                assert_eq!((leg.count, leg.time(1)), (1, target), "{size} of {internal}");
                clock = leg.arrival;
            }
        }
    }

    #[test]
    fn a_step_within_the_tolerance_is_whole_and_the_next_one_starts_from_it() {
        assert_eq!(after([1.000_000_000_5, 1e-3]).1, 100_100);
    }

    #[test]
    fn steps_that_are_too_long_by_a_hair_never_lead_astray() {
        // Within the tolerance each, half an internal step after 10⁴ of them.
        let (clock, taken) = after(std::iter::repeat_n(0.1 * (1.0 + 0.9e-9), 30_000));
        let reached = f64::from(u32::try_from(taken).unwrap()) * H;
        assert!((clock.time() - reached).abs() <= 0.5 * H + 1e-9, "{clock:?} {reached}");
        assert_eq!(taken, 300_000_000);
    }

    #[test]
    fn a_step_off_the_grid_is_parted_evenly_and_starts_a_new_grid() {
        let leg = Clock::at(0.0).way_to(2.5 * H, H).unwrap();
        assert_eq!(leg.count, 3);
        assert!((leg.step - 2.5 * H / 3.0).abs() < 1e-20);
        assert_eq!(leg.arrival, Clock::at(2.5 * H));
        assert_eq!(leg.arrival.way_to(4.5 * H, H).unwrap().count, 2);
    }

    #[test]
    fn a_step_shorter_than_the_internal_one_is_taken_as_it_is() {
        let leg = Clock::at(0.0).way_to(0.3 * H, H).unwrap();
        assert_eq!((leg.step, leg.count), (0.3 * H, 1));
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
        let clock = Clock::at(0.0).way_to(0.1, H).unwrap().arrival;
        assert_eq!(clock.way_to(0.05, H), None);
        assert_eq!(clock.way_to(f64::NAN, H), None);
        assert_eq!(clock.way_to(1e300, H), None);
    }
}
