//! Signals: values over time that a scene adds to an input.
//!
//! Shapes are functions of the time alone, so that a run may be split anywhere; sine comes from the
//! `libm` crate, whose bits do not depend on the machine.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A value over time that is added to an input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Signal {
    /// The name of the input, as the FMU has it.
    pub input: String,
    /// What is added.
    pub shape: Shape,
}

/// A function of the time t (s); values are in the unit of the input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// The same always.
    Constant(Constant),
    /// Straight from one value to another, constant before and after.
    Ramp(Ramp),
    /// A value for a while, zero before and after.
    Pulse(Pulse),
    /// An oscillation for a while, zero before and after.
    Sine(Sine),
    /// Points, by ascending time.
    Table(Table),
}

/// The same always.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constant {
    /// The value.
    pub value: f64,
}

/// `from` up to `start`, `to` from `end` on, straight between.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ramp {
    /// The value before.
    #[serde(default)]
    pub from: f64,
    /// The value after.
    pub to: f64,
    /// When it begins to change, s.
    #[serde(default)]
    pub start: f64,
    /// When it has changed, s; after `start`.
    pub end: f64,
}

/// `value` for start ≤ t < end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pulse {
    /// The value.
    pub value: f64,
    /// When it begins, s.
    #[serde(default)]
    pub start: f64,
    /// When it is over, s; after `start`.
    pub end: f64,
}

/// amplitude · sin(2π frequency (t − start) + phase) for start ≤ t < end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sine {
    /// Half peak to peak.
    pub amplitude: f64,
    /// Hz.
    pub frequency: f64,
    /// At the start, rad.
    #[serde(default)]
    pub phase: f64,
    /// When it begins, s.
    #[serde(default)]
    pub start: f64,
    /// When it is over, s; never unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
}

/// Points over time; the first value holds before them, the last one after.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// (t, value), by t; of two at one time the second holds from then on.
    pub points: Vec<[f64; 2]>,
    /// What holds between points.
    pub between: Between,
}

/// What a table holds between its points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Between {
    /// The value of the point before.
    Constant,
    /// The straight line from point to point.
    #[default]
    Linear,
}

impl Shape {
    /// The value at time `t` (s).
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Constant(Constant { value }) => *value,
            Self::Ramp(Ramp { from, to, start, end }) => {
                if t < *start {
                    *from
                } else if t >= *end {
                    *to
                } else {
                    from + (to - from) * ((t - start) / (end - start))
                }
            }
            Self::Pulse(Pulse { value, start, end }) => {
                if *start <= t && t < *end { *value } else { 0.0 }
            }
            Self::Sine(Sine { amplitude, frequency, phase, start, end }) => {
                if t < *start || end.is_some_and(|end| t >= end) {
                    0.0
                } else {
                    amplitude * libm::sin(TAU * frequency * (t - start) + phase)
                }
            }
            Self::Table(table) => table.at(t),
        }
    }
}

impl Table {
    /// The value at time `t` (s); zero without points.
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        let after = self.points.partition_point(|[time, _]| *time <= t);
        match (after.checked_sub(1).map(|i| self.points[i]), self.points.get(after)) {
            (Some([from, low]), Some([to, high])) if self.between == Between::Linear => {
                low + (high - low) * ((t - from) / (to - from))
            }
            (Some([_, value]), _) | (None, Some([_, value])) => *value,
            (None, None) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_straight_between_constants() {
        let ramp = Shape::Ramp(Ramp { from: 1.0, to: 3.0, start: 2.0, end: 4.0 });
        assert_eq!([0.0, 2.0, 2.5, 4.0, 9.0].map(|t| ramp.at(t)), [1.0, 1.0, 1.5, 3.0, 3.0]);
    }

    #[test]
    fn a_pulse_lasts_from_its_start_to_just_before_its_end() {
        let pulse = Shape::Pulse(Pulse { value: 5.0, start: 1.0, end: 2.0 });
        assert_eq!([0.9, 1.0, 1.9, 2.0].map(|t| pulse.at(t)), [0.0, 5.0, 5.0, 0.0]);
    }

    #[test]
    fn a_sine_starts_at_its_phase_and_ends() {
        let mut sine =
            Sine { amplitude: 2.0, frequency: 0.25, phase: 0.0, start: 1.0, end: Some(3.5) };
        let at = |sine: Sine, t| Shape::Sine(sine).at(t);
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
        assert_eq!(times.map(|t| linear.at(t)), [1.0, 2.0, 5.0, 5.5, 6.0]);
        let constant = Table { between: Between::Constant, ..linear };
        assert_eq!(times.map(|t| constant.at(t)), [1.0, 1.0, 5.0, 5.0, 6.0]);
    }
}
