//! The plan of a run, derived from the model description.

use crate::description::{Description, Kind};
use crate::xml::values::{boolean, double, integer};

/// Limit of the number of steps of a run.
const STEPS: u32 = 10;

/// The start value of a variable.
pub(super) enum Start {
    Real(f64),
    Integer(i32),
    Boolean(bool),
    String(String),
}

pub(super) struct Plan {
    pub(super) guid: String,
    pub(super) start: f64,
    pub(super) stop: Option<f64>,
    pub(super) tolerance: Option<f64>,
    pub(super) step: f64,
    pub(super) steps: u32,
    /// Variables whose value after initialization is their start value: name, reference and start value.
    pub(super) exact: Vec<(String, u32, Start)>,
    /// Real outputs: name and reference.
    pub(super) reals: Vec<(String, u32)>,
    pub(super) integers: Vec<u32>,
    pub(super) booleans: Vec<u32>,
    pub(super) saves_states: bool,
    pub(super) serializes_states: bool,
    pub(super) needs_no_memory_callbacks: bool,
    pub(super) once_per_process: bool,
}

impl Plan {
    pub(super) fn new(description: &Description<'_>) -> Self {
        let start = description.experiment("startTime").unwrap_or(0.0);
        let stop = description.experiment("stopTime").filter(|stop| *stop > start);
        let usual = stop.map_or(0.01, |stop| (stop - start) / 100.0);
        let wish = description.experiment("stepSize").filter(|step| *step > 0.0).unwrap_or(usual);
        let step = stop.map_or(wish, |stop| wish.min(stop - start));
        let room =
            stop.map_or(f64::from(STEPS), |stop| ((stop - start) / step * (1.0 + 1e-9)).floor());
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let steps = (room as u32).clamp(1, STEPS);
        let outputs = |kind: Kind| {
            let is = move |variable: &&crate::description::Variable<'_>| {
                variable.causality == "output" && variable.kind.base() == kind
            };
            description
                .variables
                .iter()
                .filter(is)
                .map(|variable| (variable.name.to_owned(), variable.reference))
        };
        Self {
            guid: description.root.attribute("guid").unwrap_or_default().to_owned(),
            start,
            stop,
            tolerance: description.experiment("tolerance").filter(|tolerance| *tolerance > 0.0),
            step,
            steps,
            exact: exact(description),
            reals: outputs(Kind::Real).collect(),
            integers: outputs(Kind::Integer).map(|(_, reference)| reference).collect(),
            booleans: outputs(Kind::Boolean).map(|(_, reference)| reference).collect(),
            saves_states: description.can("canGetAndSetFMUstate"),
            serializes_states: description.can("canSerializeFMUstate"),
            needs_no_memory_callbacks: description.can("canNotUseMemoryManagementFunctions"),
            once_per_process: description.can("canBeInstantiatedOnlyOncePerProcess"),
        }
    }
}

fn exact(description: &Description<'_>) -> Vec<(String, u32, Start)> {
    let of = |variable: &crate::description::Variable<'_>| {
        // Other variables may already have been computed anew when they can first be read.
        if !matches!(variable.causality, "input" | "parameter")
            && variable.variability != "constant"
        {
            return None;
        }
        let stated = variable.start?;
        let start = match variable.kind.base() {
            Kind::Real => Start::Real(double(stated)?),
            Kind::Integer | Kind::Enumeration => Start::Integer(integer(stated)?),
            Kind::Boolean => Start::Boolean(boolean(stated)?),
            Kind::String => Start::String(stated.to_owned()),
        };
        Some((variable.name.to_owned(), variable.reference, start))
    };
    description.variables.iter().filter_map(of).collect()
}
