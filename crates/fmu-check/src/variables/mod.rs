//! Rules on the variables, on each alone and on aliases.

mod aliases;
mod names;
mod starts;

use super::description::{Description, Kind, Variable};
use super::report::Report;
use super::rules::Rule;
use super::xml::{CAUSALITIES, VARIABILITIES};

pub(super) fn examine(description: &Description<'_>, report: &mut Report) {
    names::examine(description, report);
    for variable in &description.variables {
        roles(variable, report);
        starts::examine(variable, report);
        derivative(variable, description, report);
    }
    let mut independent =
        description.variables.iter().filter(|variable| variable.causality == "independent");
    if let Some(variable) = independent.nth(1) {
        let message =
            format!("{} is a second independent variable; only one is allowed", variable.name);
        report.add(Rule::IndependentVariable, variable.element.place(), message);
    }
    aliases::examine(&description.variables, report);
    exchange(description, report);
}

/// Examines the attributes that only model exchange knows (FMI 2.0, section 2.2.7).
fn exchange(description: &Description<'_>, report: &mut Report) {
    const MULTIPLE: &str = "canHandleMultipleSetPerTimeInstant";
    let is_exchange = description.root.child("ModelExchange").is_some();
    for scalar in description.root.below("ModelVariables") {
        if scalar.attribute(MULTIPLE).is_none() {
            continue;
        }
        let name = scalar.attribute("name").unwrap_or("a variable");
        let problem = if !is_exchange {
            "only FMUs for model exchange may have"
        } else if scalar.attribute("causality") != Some("input") {
            "only inputs may have"
        } else {
            continue;
        };
        let message = format!("{name} has the attribute {MULTIPLE}, which {problem}");
        report.add(Rule::MultipleSet, scalar.place(), message);
    }
    let states = description.states();
    for variable in &description.variables {
        let Variable { name, causality, .. } = *variable;
        let is_state = states.as_ref().is_some_and(|states| states.contains(&variable.index));
        if is_state && !matches!(causality, "local" | "output") {
            let message =
                format!("{name} is a continuous-time state but has causality {causality}");
            report.add(Rule::StateCausality, variable.element.place(), message);
        }
        let problem = if variable.element.attribute("reinit").is_none() {
            continue;
        } else if !is_exchange {
            "only FMUs for model exchange may have"
        } else if states.is_some() && !is_state {
            "only continuous-time states may have"
        } else {
            continue;
        };
        let message = format!("{name} has the attribute reinit, which {problem}");
        report.add(Rule::Reinit, variable.element.place(), message);
    }
}

/// Examines the combination of causality, variability and initial (FMI 2.0, section 2.2.7).
fn roles(variable: &Variable<'_>, report: &mut Report) {
    let Variable { name, causality, variability, initial, .. } = *variable;
    let place = || variable.element.place();
    if variability == "continuous" && variable.kind != Kind::Real {
        let message = format!(
            "{name} is of kind {:?} but continuous (the default); state another variability, such as discrete",
            variable.kind
        );
        report.add(Rule::ContinuousNotReal, place(), message);
        return;
    }
    if causality == "independent" && variable.kind != Kind::Real {
        report.add(
            Rule::IndependentVariable,
            place(),
            format!("{name} is independent but not a Real"),
        );
        return;
    }
    let right: &[&str] = match (causality, variability) {
        ("parameter", "fixed" | "tunable") | ("output" | "local", "constant") => &["exact"],
        ("calculatedParameter" | "local", "fixed" | "tunable") => &["calculated", "approx"],
        ("input", "discrete" | "continuous") | ("independent", "continuous") => &[],
        ("output" | "local", "discrete" | "continuous") => &["calculated", "exact", "approx"],
        // Words that FMI does not define are reported by the check against the schema.
        _ if !CAUSALITIES.contains(&causality) || !VARIABILITIES.contains(&variability) => return,
        _ => {
            let message = format!(
                "{name}: causality {causality} cannot be combined with variability {variability}"
            );
            report.add(Rule::CausalityVariability, place(), message);
            return;
        }
    };
    let message = match initial {
        Some(initial) if right.is_empty() => {
            format!(
                "{name}: causality {causality} does not allow the attribute initial ({initial})"
            )
        }
        Some(initial) if !right.contains(&initial) => {
            format!(
                "{name}: initial {initial} cannot be combined with causality {causality} and variability {variability}"
            )
        }
        _ => return,
    };
    if variable.states_initial {
        report.add(Rule::CausalityVariability, place(), message);
    }
}

fn derivative(variable: &Variable<'_>, description: &Description<'_>, report: &mut Report) {
    let Some(stated) = variable.element.attribute("derivative") else { return };
    let Some(index) = stated.trim_ascii().parse::<usize>().ok() else { return };
    let place = description.variables.binary_search_by_key(&index, |other| other.index);
    let state = place.ok().map(|place| &description.variables[place]);
    let problem = match state {
        _ if index == 0 || index > description.count() => {
            format!("only the variables 1 to {} exist", description.count())
        }
        _ if index == variable.index => "this is the variable itself".to_owned(),
        Some(state) if state.kind != Kind::Real => format!("{} is not a Real", state.name),
        _ => return,
    };
    let message = format!("{} has derivative=\"{stated}\", but {problem}", variable.name);
    report.add(Rule::DerivativeIndex, variable.element.place(), message);
}
