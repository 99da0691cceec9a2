//! All that was found, in the form in which it is printed.

use amontons_structures::family::{Branch, Family, Parameter, follow, grows};
use amontons_structures::quadratic::{Count, Eigenvalues, Mode, Outcome};
use serde::Serialize;
use std::f64::consts::TAU;

/// The modes at one value of the parameter.
pub struct Place {
    eigenvalues: Eigenvalues,
    count: Count,
    size: usize,
}

impl Place {
    pub const fn new(eigenvalues: Eigenvalues, count: Count, size: usize) -> Self {
        Self { eigenvalues, count, size }
    }
}

/// Everything of a command.
#[derive(Serialize)]
pub struct Found {
    pub degrees_of_freedom: usize,
    pub growth_rates: [f64; 2],
    pub frequencies_hz: [f64; 2],
    #[serde(skip)]
    pub parameter: Option<Parameter>,
    #[serde(rename = "parameter")]
    name: Option<String>,
    pub values: Vec<Value>,
    /// Modes followed over the values; empty for one value.
    pub branches: Vec<Followed>,
}

/// The modes at one value.
#[derive(Serialize)]
pub struct Value {
    /// The value of the parameter.
    pub value: Option<f64>,
    /// The number of modes in the rectangle, edges moved off modes.
    pub modes: Vec<Line>,
    /// `true` if it was shown that none is missing.
    pub is_complete: bool,
    /// What the count says.
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
    /// Negative for a mode that grows; `None` at λ = 0.
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
        growth_rates: [f64; 2],
        frequencies_hz: [f64; 2],
        places: &[Place],
    ) -> Self {
        let parameter = family.parameter().cloned();
        let values = |place: usize| parameter.as_ref().map(|parameter| parameter.values[place]);
        let lists: Vec<Vec<&Mode>> =
            places.iter().map(|place| place.eigenvalues.inside().collect()).collect();
        let branches = match &parameter {
            Some(parameter) if places.len() > 1 => {
                let followed = follow(&lists);
                followed.iter().map(|branch| Followed::new(branch, &parameter.values)).collect()
            }
            _ => Vec::new(),
        };
        let degrees_of_freedom = places.first().map_or(0, |place| place.size);
        let values = places
            .iter()
            .zip(&lists)
            .enumerate()
            .map(|(number, (place, modes))| Value::new(values(number), modes, &place.count));
        Self {
            degrees_of_freedom,
            growth_rates,
            frequencies_hz,
            name: parameter.as_ref().map(|parameter| parameter.name.clone()),
            values: values.collect(),
            parameter,
            branches,
        }
    }

    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("numbers and texts can be written")
    }
}

impl Value {
    fn new(value: Option<f64>, modes: &[&Mode], count: &Count) -> Self {
        let says = match &count.outcome {
            Outcome::Complete => "none is missing".to_owned(),
            Outcome::Missing(number) => format!("{number} are missing"),
            Outcome::Surplus(number) => format!("{number} are too many"),
            Outcome::NotShown(reason) => format!("not shown that none is missing: {reason}"),
        };
        Self {
            value,
            modes: modes.iter().map(|mode| Line::new(mode)).collect(),
            is_complete: count.outcome == Outcome::Complete,
            count: says,
            counted_growth_rates: count.edges.real(),
            counted_frequencies_hz: count.edges.imaginary().map(|part| part / TAU),
        }
    }
}

impl Line {
    fn new(mode: &Mode) -> Self {
        let size = mode.eigenvalue.norm();
        Self {
            frequency_hz: mode.eigenvalue.im / TAU,
            growth_rate: mode.eigenvalue.re,
            grows: grows(mode),
            damping_ratio: (size > 0.0).then(|| -mode.eigenvalue.re / size),
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
