//! The plan of a run, derived from the model description.

use super::library::Value;
use crate::description::{self, Description, Kind};
use crate::xml::Element;
use crate::xml::values::{boolean, double, integer};
use std::collections::{HashMap, HashSet};

/// Limit of the number of steps of a run.
const STEPS: u32 = 10;

/// Number of dependencies after which no more are read.
const MOST_DEPENDENCIES: usize = 10_000;

/// A variable of the model description.
#[derive(Clone)]
pub(super) struct Variable {
    /// Number in the model description, from 1.
    index: String,
    pub(super) name: String,
    pub(super) reference: u32,
    pub(super) kind: Kind,
    pub(super) role: Role,
    /// `true` for a Real that changes continuously.
    pub(super) is_continuous: bool,
    pub(super) start: Option<Value>,
    /// A value beside the start value that the description allows; `None` if a host may not set the variable before the
    /// initialization ends, or if there is no other value.
    pub(super) other: Option<Value>,
}

/// When a host may set a variable.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Input,
    Tunable,
    /// A parameter that is fixed once the initialization has ended.
    Fixed,
    Output,
    Constant,
    Rest,
}

impl Role {
    /// `true` if the variable keeps the value that it is given: nothing else changes it.
    pub(super) fn keeps_value(self) -> bool {
        matches!(self, Self::Input | Self::Tunable | Self::Fixed)
    }
}

pub(super) struct Plan {
    pub(super) guid: String,
    pub(super) start: f64,
    pub(super) stop: Option<f64>,
    pub(super) tolerance: Option<f64>,
    pub(super) step: f64,
    pub(super) steps: u32,
    /// All variables, those of a type beside each other.
    pub(super) variables: Vec<Variable>,
    /// The outputs, those of a type beside each other.
    pub(super) outputs: Vec<Variable>,
    /// Dependencies of the outputs during a run.
    pub(super) dependencies: Vec<Dependency>,
    /// Dependencies of the outputs in the initialization.
    pub(super) initial_dependencies: Vec<Dependency>,
    pub(super) log_categories: Vec<String>,
    pub(super) abilities: Abilities,
}

/// A continuous Real output and an input on which it depends.
#[derive(Clone, Copy)]
pub(super) struct Dependency {
    /// Place in `outputs`.
    pub(super) output: usize,
    /// Place in `variables`.
    pub(super) input: usize,
}

/// The capability flags of the FMU.
#[allow(clippy::struct_excessive_bools)]
pub(super) struct Abilities {
    pub(super) saves_states: bool,
    pub(super) serializes_states: bool,
    pub(super) needs_no_memory_callbacks: bool,
    pub(super) once_per_process: bool,
    pub(super) varies_steps: bool,
    pub(super) directional_derivatives: bool,
    pub(super) output_derivatives: bool,
    pub(super) interpolates_inputs: bool,
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
        let mut stated: Vec<&description::Variable<'_>> = description.variables.iter().collect();
        stated.sort_by_key(|variable| order(variable.kind));
        let variables: Vec<_> = stated.iter().map(|variable| Variable::new(variable)).collect();
        let is_output = |variable: &&Variable| variable.role == Role::Output;
        let number = |name: &str| {
            let text = description.simulation.and_then(|element| element.attribute(name));
            text.and_then(integer).unwrap_or(0)
        };
        let categories = description.root.below("LogCategories").iter();
        Self {
            guid: description.root.attribute("guid").unwrap_or_default().to_owned(),
            start,
            stop,
            tolerance: description.experiment("tolerance").filter(|tolerance| *tolerance > 0.0),
            step,
            steps,
            outputs: variables.iter().filter(is_output).cloned().collect(),
            dependencies: dependencies(description, &variables, "Outputs"),
            initial_dependencies: dependencies(description, &variables, "InitialUnknowns"),
            variables,
            log_categories: categories
                .filter_map(|category| category.attribute("name").map(str::to_owned))
                .collect(),
            abilities: Abilities {
                saves_states: description.can("canGetAndSetFMUstate"),
                serializes_states: description.can("canSerializeFMUstate"),
                needs_no_memory_callbacks: description.can("canNotUseMemoryManagementFunctions"),
                once_per_process: description.can("canBeInstantiatedOnlyOncePerProcess"),
                varies_steps: description.can("canHandleVariableCommunicationStepSize"),
                directional_derivatives: description.can("providesDirectionalDerivative"),
                output_derivatives: number("maxOutputDerivativeOrder") > 0,
                interpolates_inputs: description.can("canInterpolateInputs"),
            },
        }
    }

    pub(super) fn inputs(&self) -> impl Iterator<Item = &Variable> {
        self.variables.iter().filter(|variable| variable.role == Role::Input)
    }

    pub(super) fn continuous_outputs(&self) -> Vec<Variable> {
        self.outputs.iter().filter(|output| output.is_continuous).cloned().collect()
    }
}

/// The order of types in `variables` and `outputs`.
fn order(kind: Kind) -> usize {
    let kinds = [Kind::Real, Kind::Integer, Kind::Boolean, Kind::String];
    kinds.iter().position(|other| *other == kind.base()).unwrap_or(kinds.len())
}

/// Reads the dependencies that a list of `ModelStructure` states.
fn dependencies(
    description: &Description<'_>,
    variables: &[Variable],
    list: &str,
) -> Vec<Dependency> {
    let structure = description.root.child("ModelStructure");
    let unknowns = structure.map_or(&[][..], |structure| structure.below(list));
    let unknowns: HashMap<&str, &Element> = unknowns
        .iter()
        .filter_map(|unknown| Some((unknown.attribute("index")?.trim_ascii(), unknown)))
        .collect();
    let inputs: Vec<(usize, &Variable)> = (variables.iter().enumerate())
        .filter(|(_, input)| input.role == Role::Input && input.is_continuous)
        .collect();
    let outputs = variables.iter().filter(|variable| variable.role == Role::Output);
    let mut pairs = Vec::new();
    for (output, variable) in outputs.enumerate().filter(|(_, output)| output.is_continuous) {
        let Some(unknown) = unknowns.get(&*variable.index) else { continue };
        let listed = unknown.attribute("dependencies");
        let listed = listed.map(|list| list.split_ascii_whitespace().collect::<HashSet<_>>());
        // An unknown without a list may depend on every input.
        let depends =
            |input: &Variable| listed.as_ref().is_none_or(|listed| listed.contains(&*input.index));
        let known = inputs.iter().filter(|(_, input)| depends(input));
        pairs.extend(known.map(|(input, _)| Dependency { output, input: *input }));
        if pairs.len() > MOST_DEPENDENCIES {
            break;
        }
    }
    pairs
}

impl Variable {
    fn new(stated: &description::Variable<'_>) -> Self {
        let role = match (stated.causality, stated.variability) {
            (_, "constant") => Role::Constant,
            ("input", _) => Role::Input,
            ("parameter", "tunable") => Role::Tunable,
            ("parameter", _) => Role::Fixed,
            ("output", _) => Role::Output,
            _ => Role::Rest,
        };
        let start = stated.start.and_then(|text| {
            Some(match stated.kind.base() {
                Kind::Real => Value::Real(double(text)?),
                Kind::Integer | Kind::Enumeration => Value::Integer(integer(text)?),
                Kind::Boolean => Value::Boolean(boolean(text)?),
                Kind::String => Value::String(text.to_owned()),
            })
        });
        let is_settable =
            role == Role::Input || stated.is_settable() && stated.initial == Some("exact");
        let other = start.as_ref().filter(|_| is_settable).and_then(|start| beside(stated, start));
        Self {
            index: stated.index.to_string(),
            name: stated.name.to_owned(),
            reference: stated.reference,
            kind: stated.kind,
            role,
            is_continuous: stated.kind == Kind::Real && stated.variability == "continuous",
            start,
            other,
        }
    }
}

/// Returns another value than the start value, within the bounds.
fn beside(stated: &description::Variable<'_>, start: &Value) -> Option<Value> {
    let (least, most) = (stated.number("min"), stated.number("max"));
    let is_within = |value: f64| {
        least.is_none_or(|least| value >= least) && most.is_none_or(|most| value <= most)
    };
    match start {
        Value::Real(start) => {
            let size = [start.abs(), stated.number("nominal").unwrap_or(1.0).abs()];
            let size = size.into_iter().find(|size| *size > 0.0 && size.is_finite())?;
            let values = [start + 0.01 * size, start - 0.01 * size];
            values.into_iter().find(|value| is_within(*value)).map(Value::Real)
        }
        Value::Integer(start) if stated.kind == Kind::Enumeration => {
            let items = stated.declared?.child("Enumeration")?;
            let values = items.children.iter().filter_map(|item| item.attribute("value"));
            let mut values = values.filter_map(integer);
            let is_other = |value: &i32| value != start && is_within(f64::from(*value));
            values.find(is_other).map(Value::Integer)
        }
        Value::Integer(start) => {
            let values = [start.checked_add(1), start.checked_sub(1)];
            let mut values = values.into_iter().flatten();
            values.find(|value| is_within(f64::from(*value))).map(Value::Integer)
        }
        Value::Boolean(start) => Some(Value::Boolean(!start)),
        // Texts often name a file or a licence, of which no other is known.
        Value::String(start) => Some(Value::String(start.clone())),
    }
}
