//! Signals: values over time that a scene adds to an input.
//!
//! Shapes are functions of time alone, so that a run may be split anywhere. The sine comes from the `libm` crate,
//! whose results have the same bits on every machine.

use super::{Problem, Rule};
use crate::error::Short;
use serde::Deserialize;
use std::f64::consts::TAU;

/// A signal: a value over time that is added to an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Name of the input in the FMU.
    pub input: String,
    /// The function of time that is added.
    pub shape: Shape,
}

impl Signal {
    /// Frequency of a sine, Hz; `None` for other shapes.
    #[must_use]
    pub const fn frequency(&self) -> Option<f64> {
        match self.shape {
            Shape::Sine(Sine { frequency, .. }) => Some(frequency),
            _ => None,
        }
    }
}

/// A function of the time t (s); values are in the unit of the input.
///
/// ```
/// use amontons::scene::{Ramp, Shape};
///
/// let ramp = Shape::Ramp(Ramp { from: 0.0, to: 1.0, start: 0.0, end: 2.0 });
/// assert_eq!(ramp.at(1.0, 0.0), 0.5);
/// assert_eq!(ramp.at(5.0, 0.0), 1.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Constant value at all times.
    Constant(Constant),
    /// Linear change from one value to another.
    Ramp(Ramp),
    /// Constant value from a start time on, or between two times.
    Pulse(Pulse),
    /// Sine from a start time on, or between two times.
    Sine(Sine),
    /// Points over time, with interpolation between them.
    Table(Table),
}

/// Constant value at all times.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Constant {
    /// The value, in the unit of the input.
    pub value: f64,
}

/// Linear change: `from` up to `start`, `to` from `end` on, linear in between.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ramp {
    /// Value up to `start`, in the unit of the input; 0 by default.
    #[serde(default)]
    pub from: f64,
    /// Value from `end` on, in the unit of the input.
    pub to: f64,
    /// Time at which the change begins, s; 0 by default.
    #[serde(default)]
    pub start: f64,
    /// Time at which the change ends, s; after `start`.
    pub end: f64,
}

/// Pulse: `value` for start ≤ t < end, zero before and after; a step if it has no end.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Pulse {
    /// Value of the pulse, in the unit of the input.
    pub value: f64,
    /// Time at which the pulse begins, s; 0 by default.
    #[serde(default)]
    pub start: f64,
    /// Time at which the pulse ends, s, after `start`; by default it does not end.
    #[serde(default)]
    pub end: Option<f64>,
}

/// Sine: amplitude · sin(2π frequency (t − start) + phase) for start ≤ t < end, zero before and after.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Sine {
    /// Amplitude (half the peak-to-peak value), in the unit of the input.
    pub amplitude: f64,
    /// Frequency, Hz.
    #[cfg_attr(feature = "schema", schemars(transform = Rule::FREQUENCY.bounds()))]
    pub frequency: f64,
    /// Phase at `start`, rad; 0 by default.
    #[serde(default)]
    pub phase: f64,
    /// Time at which the sine begins, s; 0 by default.
    #[serde(default)]
    pub start: f64,
    /// Time at which the sine ends, s, after `start`; by default it does not end.
    #[serde(default)]
    pub end: Option<f64>,
}

/// Points over time; the first value holds before them, the last one after.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Points (t, value), by t; of several with the same time the last one holds from then on.
    pub points: Vec<[f64; 2]>,
    /// Interpolation between the points.
    pub between: Between,
}

/// Interpolation between the points of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Between {
    /// Constant: the value of the point before.
    Constant,
    /// Linear: the straight line from point to point.
    #[default]
    Linear,
}

impl Shape {
    /// Value at time `t` (s). Rounding may have left `t` up to `slack` (s) before an edge that it has reached.
    #[must_use]
    pub fn at(&self, t: f64, slack: f64) -> f64 {
        self.onward(t, t, slack)
    }

    /// Value at time `t` (s) of the function that holds from time `from` (s) on, continued past any edges before `t`.
    /// `slack` as in [`at`](Self::at).
    #[must_use]
    pub fn onward(&self, from: f64, t: f64, slack: f64) -> f64 {
        let reached = from + slack;
        match self {
            Self::Constant(Constant { value }) => *value,
            Self::Ramp(Ramp { from, to, start, end }) => {
                if reached < *start {
                    *from
                } else if reached >= *end {
                    *to
                } else {
                    between([*start, *from], [*end, *to], t)
                }
            }
            Self::Pulse(Pulse { value, start, end }) => {
                if is_on(*start, *end, reached) {
                    *value
                } else {
                    0.0
                }
            }
            Self::Sine(sine) => {
                if sine.is_on(reached) {
                    sine.amplitude * libm::sin(sine.phase_at(t))
                } else {
                    0.0
                }
            }
            // Interpolation would change a constant value by rounding.
            Self::Table(table) => {
                table.plateau(reached).unwrap_or_else(|| table.onward(from, t, slack))
            }
        }
    }

    /// Rate of change of the value from time `t` (s) on, per second; jumps do not count. `slack` as in [`at`](Self::at).
    #[must_use]
    pub fn rate(&self, t: f64, slack: f64) -> f64 {
        let reached = t + slack;
        match self {
            Self::Ramp(Ramp { from, to, start, end }) if is_on(*start, Some(*end), reached) => {
                (to - from) / (end - start)
            }
            Self::Sine(sine) if sine.is_on(reached) => {
                sine.amplitude * (TAU * sine.frequency) * libm::cos(sine.phase_at(t))
            }
            Self::Table(table) => table.rate(t, slack),
            Self::Constant(_) | Self::Ramp(_) | Self::Pulse(_) | Self::Sine(_) => 0.0,
        }
    }

    /// Second derivative of the value from time `t` (s) on, per second squared; jumps and corners do not count.
    /// `slack` as in [`at`](Self::at).
    #[must_use]
    pub fn curvature(&self, t: f64, slack: f64) -> f64 {
        match self {
            Self::Sine(Sine { frequency, .. }) => {
                let pulsation = TAU * frequency;
                0.0 - pulsation * pulsation * self.at(t, slack)
            }
            Self::Constant(_) | Self::Ramp(_) | Self::Pulse(_) | Self::Table(_) => 0.0,
        }
    }

    /// Time (s) up to which, exclusively, the value stays as it is at `t`; `t` itself while the value changes. A sine of
    /// amplitude 0 never changes. `slack` as in [`at`](Self::at).
    #[must_use]
    pub fn constant_until(&self, t: f64, slack: f64) -> f64 {
        let reached = t + slack;
        let ahead = |times: &[f64]| times.iter().copied().find(|time| reached < *time);
        match self {
            Self::Constant(_) => f64::INFINITY,
            Self::Ramp(Ramp { start, end, .. }) => match ahead(&[*start, *end]) {
                Some(time) if time == *start => *start,
                Some(_) => t,
                None => f64::INFINITY,
            },
            Self::Pulse(Pulse { start, end, .. }) => {
                ahead(&[*start, end.unwrap_or(f64::INFINITY)]).unwrap_or(f64::INFINITY)
            }
            Self::Sine(Sine { amplitude: 0.0, .. }) => f64::INFINITY,
            Self::Sine(Sine { start, .. }) if reached < *start => *start,
            Self::Sine(Sine { end: Some(end), .. }) if reached >= *end => f64::INFINITY,
            Self::Sine(_) => t,
            Self::Table(table) => table.constant_until(t, slack),
        }
    }

    /// Next time (s) after `t` at which the value has a jump or a corner; infinite if there is none. `slack` as in
    /// [`at`](Self::at).
    #[must_use]
    pub fn next_edge(&self, t: f64, slack: f64) -> f64 {
        let reached = t + slack;
        let [start, end] = match self {
            Self::Constant(_) => return f64::INFINITY,
            Self::Ramp(Ramp { start, end, .. }) => [*start, *end],
            Self::Pulse(Pulse { start, end, .. }) | Self::Sine(Sine { start, end, .. }) => {
                [*start, end.unwrap_or(f64::INFINITY)]
            }
            Self::Table(table) => {
                let next = table.points.get(table.points_up_to(reached));
                return next.map_or(f64::INFINITY, |point| point[0]);
            }
        };
        if reached < start {
            start
        } else if reached < end {
            end
        } else {
            f64::INFINITY
        }
    }

    /// Reports every impossible value; `path` is that of the signal.
    pub(super) fn check(&self, path: &str, problems: &mut Vec<Problem>) {
        let mut rule = |key: &str, value: f64, rule: Rule| {
            if let Some(wish) = rule.broken_by(value) {
                problems.push(Problem::new(format!("{path}.{key}"), wish).of(value));
            }
        };
        let span = match self {
            Self::Constant(Constant { value }) => {
                rule("constant.value", *value, Rule::Finite);
                None
            }
            Self::Ramp(Ramp { from, to, start, end }) => {
                rule("ramp.from", *from, Rule::Finite);
                rule("ramp.to", *to, Rule::Finite);
                Some(("ramp", *start, *end))
            }
            Self::Pulse(Pulse { value, start, end }) => {
                rule("pulse.value", *value, Rule::Finite);
                Some(("pulse", *start, end.unwrap_or(f64::MAX)))
            }
            Self::Sine(Sine { amplitude, frequency, phase, start, end }) => {
                rule("sine.amplitude", *amplitude, Rule::Finite);
                rule("sine.frequency", *frequency, Rule::FREQUENCY);
                rule("sine.phase", *phase, Rule::Finite);
                Some(("sine", *start, end.unwrap_or(f64::MAX)))
            }
            Self::Table(table) => return table.check(&format!("{path}.table"), problems),
        };
        let Some((key, start, end)) = span else { return };
        rule(&format!("{key}.start"), start, Rule::Finite);
        rule(&format!("{key}.end"), end, Rule::Finite);
        if end <= start {
            let message = format!("must be after start = {}", Short(start));
            problems.push(Problem::new(format!("{path}.{key}.end"), message).of(end));
        }
    }
}

impl Sine {
    /// `true` if the sine acts at time `t` (s): start ≤ t < end.
    #[must_use]
    pub fn is_on(&self, t: f64) -> bool {
        is_on(self.start, self.end, t)
    }

    /// Phase at time `t` (s), rad.
    #[must_use]
    pub fn phase_at(&self, t: f64) -> f64 {
        TAU * self.frequency * (t - self.start) + self.phase
    }
}

impl Table {
    /// Value at time `t` (s); zero for a table without points. `slack` as in [`Shape::at`].
    #[must_use]
    pub fn at(&self, t: f64, slack: f64) -> f64 {
        self.onward(t, t, slack)
    }

    /// Value at time `t` (s) of the function that holds from time `from` (s) on ([`Shape::onward`]); `slack` as in
    /// [`Shape::at`].
    fn onward(&self, from: f64, t: f64, slack: f64) -> f64 {
        let after = self.points_up_to(from + slack);
        match (after.checked_sub(1).map(|i| self.points[i]), self.points.get(after).copied()) {
            (Some(low), Some(high)) if self.between == Between::Linear => between(low, high, t),
            (Some([_, value]), _) | (None, Some([_, value])) => value,
            (None, None) => 0.0,
        }
    }

    /// Value at time `t` (s) if the points before and after have the same value; else `None`.
    fn plateau(&self, t: f64) -> Option<f64> {
        let after = self.points_up_to(t);
        let [_, low] = *self.points.get(after.checked_sub(1)?)?;
        let [_, high] = *self.points.get(after)?;
        (low == high).then_some(low)
    }

    /// Times at which two points with the same time make the value jump, s, in ascending order.
    pub fn jumps(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.windows(2).filter(|two| two[0][0] == two[1][0]).map(|two| two[0][0])
    }

    fn rate(&self, t: f64, slack: f64) -> f64 {
        let after = self.points_up_to(t + slack);
        match (after.checked_sub(1).map(|i| self.points[i]), self.points.get(after)) {
            (Some([from, low]), Some([to, high])) if self.between == Between::Linear => {
                (high - low) / (to - from)
            }
            _ => 0.0,
        }
    }

    fn constant_until(&self, t: f64, slack: f64) -> f64 {
        let after = self.points_up_to(t + slack);
        match self.points.get(after) {
            None => f64::INFINITY,
            Some([next, _])
                if after == 0
                    || self.between == Between::Constant
                    || self.plateau(t + slack).is_some() =>
            {
                *next
            }
            Some(_) => t,
        }
    }

    fn points_up_to(&self, t: f64) -> usize {
        self.points.partition_point(|[time, _]| *time <= t)
    }

    fn check(&self, path: &str, problems: &mut Vec<Problem>) {
        if self.points.is_empty() {
            problems.push(Problem::new(path, "has no points"));
        }
        let is_finite = |point: &[f64; 2]| point.iter().all(|value| value.is_finite());
        if let Some(i) = self.points.iter().position(|point| !is_finite(point)) {
            let place = format!("{path}.points[{}]", i + 1);
            problems.push(Problem::new(place, "time and value must be finite numbers"));
        }
        let falls = |two: &[[f64; 2]]| two[1][0] < two[0][0];
        if let Some(i) = self.points.windows(2).position(falls) {
            let message =
                format!("must not be before the previous point, at {} s", Short(self.points[i][0]));
            let place = format!("{path}.points[{}]", i + 2);
            problems.push(Problem::new(place, message).of(format!("{:?}", self.points[i + 1])));
        }
    }
}

/// `true` if start ≤ t < end; an `end` of `None` is infinite.
fn is_on(start: f64, end: Option<f64>, t: f64) -> bool {
    start <= t && end.is_none_or(|end| t < end)
}

/// Value at `t` of the straight line through two points (t, value), the first not after `t` and the second after it.
fn between([from, low]: [f64; 2], [to, high]: [f64; 2], t: f64) -> f64 {
    // FMPy interpolates an importer's inputs by the same operations, so that both get the same doubles.
    let weight = (to - t) / (to - from);
    weight * low + (1.0 - weight) * high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_straight_between_constants() {
        let ramp = Shape::Ramp(Ramp { from: 1.0, to: 3.0, start: 2.0, end: 4.0 });
        assert_eq!([0.0, 2.0, 2.5, 4.0, 9.0].map(|t| ramp.at(t, 0.0)), [1.0, 1.0, 1.5, 3.0, 3.0]);
    }

    #[test]
    fn a_pulse_lasts_from_its_start_to_just_before_its_end() {
        let pulse = Shape::Pulse(Pulse { value: 5.0, start: 1.0, end: Some(2.0) });
        assert_eq!([0.9, 1.0, 1.9, 2.0].map(|t| pulse.at(t, 0.0)), [0.0, 5.0, 5.0, 0.0]);
        let step = Shape::Pulse(Pulse { value: 5.0, start: 1.0, end: None });
        assert_eq!([0.9, 1.0, 1e9].map(|t| step.at(t, 0.0)), [0.0, 5.0, 5.0]);
    }

    #[test]
    fn a_sine_starts_at_its_phase_and_ends() {
        let mut sine =
            Sine { amplitude: 2.0, frequency: 0.25, phase: 0.0, start: 1.0, end: Some(3.5) };
        let at = |sine: Sine, t| Shape::Sine(sine).at(t, 0.0);
        assert_eq!([0.5, 1.0, 2.0, 3.5].map(|t| at(sine, t)), [0.0, 0.0, 2.0, 0.0]);
        sine.phase = std::f64::consts::FRAC_PI_2;
        assert_eq!(at(sine, 1.0), 2.0);
        sine.end = None;
        assert!((at(sine, 101.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_table_holds_its_ends_and_jumps_where_a_time_stands_twice() {
        let points = vec![[1.0, 1.0], [2.0, 3.0], [2.0, 5.0], [4.0, 6.0]];
        let linear = Table { points, between: Between::Linear };
        let times = [0.0, 1.5, 2.0, 3.0, 9.0];
        assert_eq!(times.map(|t| linear.at(t, 0.0)), [1.0, 2.0, 5.0, 5.5, 6.0]);
        assert_eq!(linear.jumps().collect::<Vec<_>>(), [2.0]);
        let constant = Table { between: Between::Constant, ..linear };
        assert_eq!(times.map(|t| constant.at(t, 0.0)), [1.0, 1.0, 5.0, 5.0, 6.0]);
    }

    #[test]
    fn a_table_that_stays_where_it_is_does_not_waver_by_a_bit() {
        // Interpolation between two equal values would make a slider at rest creep by rounding.
        let points = vec![[0.2, 0.0], [0.3, -0.1], [1.0, -0.1], [1.1, 0.0]];
        let shape = Shape::Table(Table { points, between: Between::Linear });
        for i in 0..700 {
            assert_eq!(shape.at(0.3 + 1e-3 * f64::from(i), 0.0), -0.1, "{i}");
        }
        assert_eq!(shape.constant_until(0.5, 0.0), 1.0);
    }

    #[test]
    fn a_value_stays_as_long_as_is_said_and_changes_then() {
        let points = vec![[1.0, 1.0], [2.0, 3.0], [4.0, 6.0]];
        let (start, end) = (1.0, 3.0);
        let sine = Sine { amplitude: 2.0, frequency: 0.31, phase: 0.5, start, end: Some(end) };
        for (shape, changes) in [
            (Shape::Constant(Constant { value: 3.0 }), &[][..]),
            (Shape::Ramp(Ramp { from: 1.0, to: 2.0, start, end }), &[(1.0, 3.0)]),
            (Shape::Pulse(Pulse { value: 1.0, start, end: Some(end) }), &[(1.0, 1.0), (3.0, 3.0)]),
            (Shape::Pulse(Pulse { value: 1.0, start, end: None }), &[(1.0, 1.0)]),
            (Shape::Sine(sine), &[(1.0, 3.0)]),
            (
                Shape::Table(Table { points: points.clone(), between: Between::Constant }),
                &[(1.0, 1.0), (2.0, 2.0), (4.0, 4.0)],
            ),
            (Shape::Table(Table { points, between: Between::Linear }), &[(1.0, 2.0), (2.0, 4.0)]),
        ] {
            for i in 0..50 {
                let t = 0.1 * f64::from(i);
                let is_changing = changes.iter().any(|(from, to)| *from <= t && t < *to);
                let next = changes.iter().map(|change| change.0).find(|from| t < *from);
                let expected = if is_changing { t } else { next.unwrap_or(f64::INFINITY) };
                assert_eq!(shape.constant_until(t, 0.0), expected, "{shape:?} at {t}");
                let later = t + 0.999 * (expected.min(9.0) - t);
                assert_eq!(shape.at(t, 0.0), shape.at(later, 0.0), "{shape:?} at {t}");
                // Within a linear stretch, the change is the rate times the elapsed time.
                let (t, ahead) = (t + 1e-9, 1e-7);
                let change = (shape.at(t + ahead, 0.0) - shape.at(t, 0.0)) / ahead;
                assert!((change - shape.rate(t, 0.0)).abs() < 1e-5, "{shape:?} at {t}: {change}");
                let change = (shape.rate(t + ahead, 0.0) - shape.rate(t, 0.0)) / ahead;
                let error = (change - shape.curvature(t, 0.0)).abs();
                assert!(error < 1e-5, "{shape:?} at {t}: {change}");
            }
        }
    }
}
