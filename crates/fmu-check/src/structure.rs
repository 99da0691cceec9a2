//! Rules on `ModelStructure`: the lists of outputs, derivatives and initial unknowns.

use super::description::{Description, Variable};
use super::report::{Place, Report};
use super::rules::Rule;
use super::xml::Element;
use super::xml::values::count;
use std::collections::{BTreeSet, HashMap};

pub(super) fn examine(description: &Description<'_>, report: &mut Report) {
    let Some(structure) = description.root.child("ModelStructure") else { return };
    let variables =
        description.variables.iter().map(|variable| (variable.index, variable)).collect();
    let lists = Lists { count: description.count(), variables };
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
    for index in &derivatives {
        let Some(derivative) = lists.variables.get(index) else { continue };
        let Some(state) = derivative.element.attribute("derivative").and_then(count) else {
            let message =
                format!("Derivatives lists {}, which has no attribute derivative", derivative.name);
            report.add(Rule::DerivativesList, place("Derivatives"), message);
            continue;
        };
        for index in [*index, state as usize] {
            let variable = lists.variables.get(&index);
            if variable
                .is_some_and(|variable| matches!(variable.initial, Some("approx" | "calculated")))
            {
                wanted.insert(index);
            }
        }
    }
    let what = (Rule::InitialUnknownsList, "InitialUnknowns", &place("InitialUnknowns"));
    lists.compare(&initial, &wanted, what, report);
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
}

impl Lists<'_> {
    /// Reads the indices of a list; invalid indices are reported and left out.
    fn read(&self, structure: &Element, name: &str, report: &mut Report) -> Vec<usize> {
        let mut indices = Vec::new();
        let mut seen = BTreeSet::new();
        for unknown in structure.below(name) {
            self.dependencies(unknown, report);
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

    fn dependencies(&self, unknown: &Element, report: &mut Report) {
        let dependencies = unknown.attribute("dependencies");
        for index in dependencies.unwrap_or_default().split_ascii_whitespace().filter_map(count) {
            if index == 0 || index as usize > self.count {
                let message = format!(
                    "dependencies lists variable {index}, but only the variables 1 to {} exist",
                    self.count
                );
                report.add(Rule::DependenciesIndex, unknown.place(), message);
            }
        }
        let Some(kinds) = unknown.attribute("dependenciesKind") else { return };
        let kinds = kinds.split_ascii_whitespace().count();
        let Some(dependencies) = dependencies else {
            report.add(
                Rule::DependenciesKind,
                unknown.place(),
                "dependenciesKind is stated without dependencies",
            );
            return;
        };
        let dependencies = dependencies.split_ascii_whitespace().count();
        if kinds != dependencies {
            let message = format!(
                "dependenciesKind and dependencies need equal numbers of entries, but have {kinds} and {dependencies}"
            );
            report.add(Rule::DependenciesKind, unknown.place(), message);
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
