//! All that was found, in the form in which it is printed.

use amontons::decimal::to_significant;
use amontons_structures::family::{Branch, Family, Parameter, grows};
use amontons_structures::quadratic::{Count, Mode, Outcome};
use serde::Serialize;
use std::f64::consts::TAU;

/// Everything of a command.
#[derive(Serialize)]
pub struct Found {
    pub degrees_of_freedom: usize,
    pub growth_rates: [f64; 2],
    pub frequencies_hz: [f64; 2],
    pub parameter: Option<Named>,
    pub values: Vec<Value>,
    /// Modes followed over the values; empty for one value.
    pub branches: Vec<Followed>,
}

/// The parameter on which the matrices depend.
#[derive(Serialize)]
pub struct Named {
    pub name: String,
    pub unit: String,
}

/// The modes at one value.
#[derive(Serialize)]
pub struct Value {
    /// The value of the parameter.
    pub value: Option<f64>,
    /// The modes in the rectangle, with edges moved off modes, by frequency.
    pub modes: Vec<Line>,
    /// `true` if it was shown that none is missing.
    pub is_complete: bool,
    /// The result of the count, in words.
    pub count: String,
    /// The edges along which was counted: growth rates and frequencies in Hz.
    pub counted_growth_rates: [f64; 2],
    pub counted_frequencies_hz: [f64; 2],
}

/// A mode.
#[derive(Serialize)]
pub struct Line {
    pub frequency_hz: f64,
    pub growth_rate: f64,
    /// `None` if the growth rate is within its error bound.
    pub grows: Option<bool>,
    /// Negative for a mode that grows; `None` for one that does not oscillate.
    pub damping_ratio: Option<f64>,
    pub backward_error: f64,
    /// A bound of |λ − the exact one| to first order, 1/s.
    pub error_bound: Option<f64>,
}

/// A mode over the values.
#[derive(Serialize)]
pub struct Followed {
    pub points: Vec<FollowedPoint>,
    pub crossings: Vec<Turn>,
}

#[derive(Serialize)]
pub struct FollowedPoint {
    pub value: f64,
    /// The number of the mode at this value, from 1.
    pub mode: usize,
    pub frequency_hz: f64,
    pub growth_rate: f64,
    pub assurance: Option<f64>,
}

/// A change of the sign of a growth rate, by a straight line between two values.
#[derive(Serialize)]
pub struct Turn {
    pub between: [f64; 2],
    pub value: f64,
    pub begins_to_grow: bool,
    pub frequency_hz: f64,
}

impl Found {
    pub fn new(
        family: &Family,
        degrees_of_freedom: usize,
        [growth_rates, frequencies_hz]: [[f64; 2]; 2],
        values: Vec<Value>,
        branches: &[Branch],
    ) -> Self {
        let parameter = family.parameter();
        let at = parameter.map_or(&[][..], |parameter| &parameter.values);
        let branches = if values.len() > 1 { branches } else { &[] };
        Self {
            degrees_of_freedom,
            growth_rates,
            frequencies_hz,
            parameter: parameter.map(|Parameter { name, unit, .. }| Named {
                name: name.clone(),
                unit: unit.clone(),
            }),
            values,
            branches: branches.iter().map(|branch| Followed::new(branch, at)).collect(),
        }
    }

    /// `true` if at no value a mode is missing.
    pub fn is_complete(&self) -> bool {
        self.values.iter().all(|value| value.is_complete)
    }

    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("numbers and texts can be written")
    }
}

impl Value {
    pub fn new(value: Option<f64>, modes: &[Mode], count: &Count) -> Self {
        let is_mirrored = count.edges.imaginary()[0] == 0.0;
        let both = if is_mirrored { " (both of a pair are counted)" } else { "" };
        let says = match &count.outcome {
            Outcome::Complete => "none is missing".to_owned(),
            Outcome::Missing(number) => format!("{number} eigenvalues are missing{both}"),
            Outcome::Surplus(number) => format!("{number} eigenvalues are too many{both}"),
            Outcome::NotShown(reason) => format!("not shown that none is missing: {reason}"),
        };
        Self {
            value,
            modes: modes.iter().map(Line::new).collect(),
            is_complete: count.outcome == Outcome::Complete,
            count: says,
            counted_growth_rates: count.edges.real(),
            counted_frequencies_hz: count
                .edges
                .imaginary()
                .map(|part| to_significant(part / TAU, 12)),
        }
    }
}

impl Line {
    fn new(mode: &Mode) -> Self {
        let is_oscillating = mode.eigenvalue.im != 0.0;
        Self {
            frequency_hz: mode.eigenvalue.im / TAU,
            growth_rate: mode.eigenvalue.re,
            grows: grows(mode),
            damping_ratio: is_oscillating.then(|| -mode.eigenvalue.re / mode.eigenvalue.norm()),
            backward_error: mode.backward,
            error_bound: mode.bound,
        }
    }
}

impl Followed {
    fn new(branch: &Branch, values: &[f64]) -> Self {
        let points = branch.points.iter().map(|point| FollowedPoint {
            value: values[point.value],
            mode: point.mode + 1,
            frequency_hz: point.eigenvalue.im / TAU,
            growth_rate: point.eigenvalue.re,
            assurance: point.assurance,
        });
        let crossings = branch.crossings().into_iter().map(|crossing| {
            let between = crossing.between.map(|value| values[value]);
            Turn {
                between,
                value: between[0] + crossing.part * (between[1] - between[0]),
                begins_to_grow: crossing.begins,
                frequency_hz: crossing.frequency / TAU,
            }
        });
        Self { points: points.collect(), crossings: crossings.collect() }
    }
}
