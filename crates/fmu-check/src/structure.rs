//! Rules on `ModelStructure`: the lists of outputs, derivatives and initial unknowns.

use super::description::{Description, Kind, Variable};
use super::report::{Place, Report};
use super::rules::{Class, Rule};
use super::xml::Element;
use super::xml::values::count;
use std::collections::{BTreeSet, HashMap};

pub(super) fn examine(description: &Description<'_>, report: &mut Report) {
    let Some(structure) = description.root.child("ModelStructure") else { return };
    let variables =
        description.variables.iter().map(|variable| (variable.index, variable)).collect();
    let lists = Lists { count: description.count(), variables, states: description.states() };
    let outputs = lists.read(structure, "Outputs", report);
    let derivatives = lists.read(structure, "Derivatives", report);
    let initial = lists.read(structure, "InitialUnknowns", report);
    let place = |name| structure.child(name).unwrap_or(structure).place();

    let wanted = lists.indices(|variable| variable.causality == "output");
    lists.compare(&outputs, &wanted, (Rule::OutputsList, "Outputs", &place("Outputs")), report);

    let mut wanted = lists.indices(|variable| match variable.causality {
        "output" => matches!(variable.initial, Some("approx" | "calculated")),
        causality => causality == "calculatedParameter",
    });
    let mut initial_listed = initial.clone();
    for index in &derivatives {
        let Some(derivative) = lists.variables.get(index) else { continue };
        let Some(state) = derivative.derivative_of() else {
            if description.ignores_derivatives() {
                continue;
            }
            let message =
                format!("Derivatives lists {}, which has no attribute derivative", derivative.name);
            report.add(Rule::DerivativesList, place("Derivatives"), message);
            continue;
        };
        for index in [*index, state] {
            let Some(variable) = lists.variables.get(&index) else { continue };
            let is_unknown = matches!(variable.initial, Some("approx" | "calculated"));
            if !description.ignores_derivatives() {
                wanted.extend(is_unknown.then_some(index));
            } else if !wanted.contains(&index) {
                // Neither its presence nor its absence is wrong.
                initial_listed.retain(|listed| *listed != index);
            }
        }
    }
    let what = (Rule::InitialUnknownsList, "InitialUnknowns", &place("InitialUnknowns"));
    lists.compare(&initial_listed, &wanted, what, report);
    if let Some(pair) = initial.windows(2).find(|pair| pair[0] > pair[1]) {
        let message = format!(
            "InitialUnknowns lists variable {} before variable {}; the indices must ascend",
            pair[0], pair[1]
        );
        report.add(Rule::InitialUnknownsOrder, place("InitialUnknowns"), message);
    }
}

struct Lists<'a> {
    /// Number of variables.
    count: usize,
    variables: HashMap<usize, &'a Variable<'a>>,
    /// The continuous-time states; `None` if the FMU does not tell them.
    states: Option<BTreeSet<usize>>,
}

impl Lists<'_> {
    /// Reads the indices of a list; invalid indices are reported and left out.
    fn read(&self, structure: &Element, name: &str, report: &mut Report) -> Vec<usize> {
        let mut indices = Vec::new();
        let mut seen = BTreeSet::new();
        for unknown in structure.below(name) {
            self.dependencies(name, unknown, report);
            let Some(index) = unknown.attribute("index").and_then(count) else { continue };
            let index = index as usize;
            if index == 0 || index > self.count {
                let message = format!(
                    "{name} lists variable {index}, but only the variables 1 to {} exist",
                    self.count
                );
                report.add(Rule::UnknownIndex, unknown.place(), message);
            } else if seen.insert(index) {
                indices.push(index);
            } else {
                report.add(
                    Rule::UnknownIndex,
                    unknown.place(),
                    format!("{name} lists variable {index} twice"),
                );
            }
        }
        indices
    }

    fn dependencies(&self, list: &str, unknown: &Element, report: &mut Report) {
        let stated = unknown.attribute("dependencies");
        let indices: Vec<usize> = (stated.unwrap_or_default().split_ascii_whitespace())
            .filter_map(|index| Some(count(index)? as usize))
            .collect();
        for &index in &indices {
            if index == 0 || index > self.count {
                let message = format!(
                    "dependencies lists variable {index}, but only the variables 1 to {} exist",
                    self.count
                );
                report.add(Rule::DependenciesIndex, unknown.place(), message);
            } else if let Some(variable) = self.variables.get(&index)
                && !self.is_known(list, variable)
            {
                let known = match list {
                    "InitialUnknowns" => "inputs, variables with initial exact",
                    _ => "inputs, continuous-time states",
                };
                let message = format!(
                    "dependencies lists variable {index} ({}), on which nothing in {list} can depend; allowed are {known} and the independent variable",
                    variable.name
                );
                // Examples of the standard's makers list fixed parameters.
                let is_common =
                    variable.causality == "parameter" && variable.variability == "fixed";
                let class = if is_common { Class::Hint } else { Rule::DependenciesKnown.class() };
                report.add_as(class, Rule::DependenciesKnown, unknown.place(), message);
            }
        }
        if let Some(pair) = indices.windows(2).find(|pair| pair[0] > pair[1]) {
            let message = format!(
                "dependencies lists variable {} before variable {}; the indices must ascend",
                pair[0], pair[1]
            );
            report.add(Rule::DependenciesOrder, unknown.place(), message);
        }
        self.kinds(list, unknown, report);
    }

    /// `true` if an unknown of this list may depend on a variable.
    fn is_known(&self, list: &str, variable: &Variable<'_>) -> bool {
        let Variable { causality, variability, initial, .. } = *variable;
        if matches!(causality, "input" | "independent") {
            return true;
        }
        if list == "InitialUnknowns" {
            return initial == Some("exact");
        }
        // The standard's list of knowns does not name tunable parameters, but its equation of the outputs does.
        if variability == "tunable" {
            return true;
        }
        match &self.states {
            Some(states) => states.contains(&variable.index),
            None => variability == "continuous" && variable.kind == Kind::Real,
        }
    }

    fn kinds(&self, list: &str, unknown: &Element, report: &mut Report) {
        let Some(kinds) = unknown.attribute("dependenciesKind") else { return };
        let kinds: Vec<_> = kinds.split_ascii_whitespace().collect();
        let Some(dependencies) = unknown.attribute("dependencies") else {
            report.add(
                Rule::DependenciesKind,
                unknown.place(),
                "dependenciesKind is stated without dependencies",
            );
            return;
        };
        let dependencies = dependencies.split_ascii_whitespace().count();
        if kinds.len() != dependencies {
            let message = format!(
                "dependenciesKind and dependencies need equal numbers of entries, but have {} and {dependencies}",
                kinds.len()
            );
            report.add(Rule::DependenciesKind, unknown.place(), message);
        }
        let Some(kind) = kinds.iter().find(|kind| **kind != "dependent") else { return };
        let index = unknown.attribute("index").and_then(count).map(|index| index as usize);
        if let Some(variable) = index.and_then(|index| self.variables.get(&index))
            && variable.kind != Kind::Real
        {
            let message = format!(
                "dependenciesKind {kind} is for Real unknowns, but {} is of kind {:?}",
                variable.name, variable.kind
            );
            report.add(Rule::DependenciesKind, unknown.place(), message);
        }
        let late = kinds.iter().find(|kind| matches!(**kind, "fixed" | "tunable" | "discrete"));
        if let Some(kind) = late.filter(|_| list == "InitialUnknowns") {
            // The schema, which is normative, allows it.
            let message = format!(
                "dependenciesKind {kind} is not for InitialUnknowns by the standard's text, though its schema allows it"
            );
            report.add_as(Class::Hint, Rule::DependenciesKind, unknown.place(), message);
        }
    }

    fn indices(&self, of: impl Fn(&Variable<'_>) -> bool) -> BTreeSet<usize> {
        self.variables
            .iter()
            .filter(|(_, variable)| of(variable))
            .map(|(index, _)| *index)
            .collect()
    }

    fn compare(
        &self,
        found: &[usize],
        wanted: &BTreeSet<usize>,
        (rule, list, place): (Rule, &str, &Place),
        report: &mut Report,
    ) {
        let found: BTreeSet<usize> = found.iter().copied().collect();
        for index in wanted.symmetric_difference(&found) {
            // Variables that could not be read are reported by other rules.
            let Some(variable) = self.variables.get(index) else { continue };
            let verb = if wanted.contains(index) { "is missing" } else { "should not list" };
            let message = format!("{list} {verb} variable {index} ({})", variable.name);
            report.add(rule, place.clone(), message);
        }
    }
}
