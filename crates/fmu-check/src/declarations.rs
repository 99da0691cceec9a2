//! Rules on the model description before its variables: the model, its capabilities, units, types, log categories and
//! the default experiment.

use super::archive::{Archive, plain};
use super::description::{Description, Kind, is_identifier};
use super::report::Report;
use super::rules::Rule;
use super::xml::Element;
use super::xml::values::{boolean, double, moment};
use std::collections::{HashMap, HashSet};

pub(super) fn examine(description: &Description<'_>, archive: &Archive, report: &mut Report) {
    model(description.root, report);
    for simulation in &description.root.children {
        if matches!(simulation.name.as_str(), "CoSimulation" | "ModelExchange") {
            abilities(simulation, archive, report);
        }
    }
    unique(
        description.root.below("LogCategories"),
        Rule::CategoryDuplicate,
        "log category",
        report,
    );
    unique(description.root.below("VendorAnnotations"), Rule::ToolDuplicate, "tool", report);
    experiment(description, report);
    units(description, report);
    types(description, report);
}

fn model(root: &Element, report: &mut Report) {
    if root.attribute("guid").is_some_and(|guid| guid.trim().is_empty()) {
        let message =
            "the guid is empty; the library needs it to refuse a model description of another FMU";
        report.add(Rule::GuidEmpty, root.place(), message);
    }
    // What is no date at all is reported by the check against the schema.
    let date = root.attribute("generationDateAndTime");
    if let Some((date, rest)) = date.and_then(|date| Some((date, moment(date)?)))
        && rest != "Z"
    {
        let message =
            format!("generationDateAndTime {date} should be in UTC, such as 2024-12-31T23:59:59Z");
        report.add(Rule::GenerationDate, root.place(), message);
    }
}

fn abilities(simulation: &Element, archive: &Archive, report: &mut Report) {
    if let Some(name) = simulation.attribute("modelIdentifier").filter(|name| !is_identifier(name))
    {
        let message = format!(
            "modelIdentifier {name} is not a C identifier (letters, digits and _, without a digit in front)"
        );
        report.add(Rule::ModelIdentifier, simulation.place(), message);
    }
    let can = |flag: &str| simulation.attribute(flag).and_then(boolean).unwrap_or(false);
    if can("canSerializeFMUstate") && !can("canGetAndSetFMUstate") {
        let message =
            "canSerializeFMUstate is true, but canGetAndSetFMUstate, which it requires, is not";
        report.add(Rule::CapabilityFlags, simulation.place(), message);
    }
    for file in simulation.below("SourceFiles") {
        let Some(name) = file.attribute("name") else { continue };
        let path = plain(&format!("sources/{name}"));
        if path.is_none_or(|path| archive.find(&path).is_none()) {
            let message = format!("SourceFiles lists {name}, which is not in sources/");
            report.add(Rule::SourceFileMissing, file.place(), message);
        }
    }
}

/// Reports names that are declared more than once.
fn unique(elements: &[Element], rule: Rule, what: &str, report: &mut Report) {
    let mut seen = HashSet::new();
    for element in elements {
        let Some(name) = element.attribute("name") else { continue };
        if !seen.insert(name) {
            report.add(rule, element.place(), format!("the {what} {name} is declared twice"));
        }
    }
}

fn experiment(description: &Description<'_>, report: &mut Report) {
    let Some(element) = description.root.child("DefaultExperiment") else { return };
    let value = |name| description.experiment(name);
    let start = value("startTime").unwrap_or(0.0);
    if let Some(stop) = value("stopTime").filter(|stop| *stop <= start) {
        let message = format!("stopTime {stop} is not after startTime {start}");
        report.add(Rule::DefaultExperiment, element.place(), message);
    }
    for name in ["stepSize", "tolerance"] {
        if let Some(number) = value(name).filter(|number| *number <= 0.0) {
            let message = format!("{name} {number} is not above zero");
            report.add(Rule::DefaultExperiment, element.place(), message);
        }
    }
}

fn units(description: &Description<'_>, report: &mut Report) {
    let units = description.root.below("UnitDefinitions");
    unique(units, Rule::UnitDuplicate, "unit", report);
    let mut known: HashMap<&str, HashSet<&str>> = HashMap::new();
    for unit in units {
        let shown: Vec<_> =
            unit.children.iter().filter(|child| child.name == "DisplayUnit").collect();
        let mut names = HashSet::new();
        for display in shown {
            let Some(name) = display.attribute("name") else { continue };
            if !names.insert(name) {
                report.add(
                    Rule::UnitDuplicate,
                    display.place(),
                    format!("the display unit {name} is declared twice"),
                );
            }
        }
        known.entry(unit.attribute("name").unwrap_or_default()).or_default().extend(names);
    }
    let mut check = |owner: &str, element: &Element, unit: Option<&str>| {
        if let Some(unit) = element.attribute("unit").filter(|unit| !known.contains_key(unit)) {
            report.add(
                Rule::UnitUndeclared,
                element.place(),
                format!("the unit {unit} of {owner} is not declared"),
            );
            return;
        }
        let Some(display) = element.attribute("displayUnit") else { return };
        let Some(unit) = unit else {
            let message = format!("{owner} has the display unit {display} but no unit");
            report.add(Rule::DisplayUnitWithoutUnit, element.place(), message);
            return;
        };
        if known.get(unit).is_some_and(|names| !names.contains(display)) {
            let message = format!(
                "the display unit {display} of {owner} is not declared, so hosts ignore it: {unit} has no such DisplayUnit"
            );
            report.add(Rule::DisplayUnitUndeclared, element.place(), message);
        }
    };
    for kind in description.root.below("TypeDefinitions") {
        if let Some(element) = kind.child("Real") {
            check(kind.attribute("name").unwrap_or("a type"), element, element.attribute("unit"));
        }
    }
    for variable in &description.variables {
        check(variable.name, variable.element, variable.attribute("unit"));
    }
}

fn types(description: &Description<'_>, report: &mut Report) {
    let types = description.root.below("TypeDefinitions");
    unique(types, Rule::TypeDuplicate, "type", report);
    let names: HashSet<&str> = types.iter().filter_map(|kind| kind.attribute("name")).collect();
    for kind in types {
        let name = kind.attribute("name").unwrap_or("a type");
        for element in &kind.children {
            bounds(name, element, report);
        }
        if let Some(items) = kind.child("Enumeration") {
            enumeration(name, items, report);
        }
    }
    for variable in &description.variables {
        let (name, place) = (variable.name, variable.element.place());
        if names.contains(name) {
            let message = format!("the variable {name} has the name of a type");
            report.add(Rule::TypeName, place.clone(), message);
        }
        let Some(declared) = variable.element.attribute("declaredType") else { continue };
        match variable
            .declared
            .map(|kind| kind.children.first().and_then(|child| Kind::named(&child.name)))
        {
            None => report.add(
                Rule::TypeUndeclared,
                place,
                format!("the declaredType {declared} of {name} is not defined"),
            ),
            Some(Some(kind)) if kind != variable.kind => {
                let message = format!(
                    "{name} is of kind {:?}, but its declaredType {declared} is of kind {kind:?}",
                    variable.kind
                );
                report.add(Rule::TypeKind, place, message);
            }
            Some(_) => {}
        }
    }
}

fn bounds(name: &str, element: &Element, report: &mut Report) {
    let number = |name| element.attribute(name).and_then(double);
    if let (Some(min), Some(max)) = (number("min"), number("max"))
        && min > max
    {
        report.add(
            Rule::BoundsOrder,
            element.place(),
            format!("min {min} of the type {name} is above max {max}"),
        );
    }
    if let Some(nominal) = number("nominal").filter(|nominal| *nominal <= 0.0) {
        report.add(
            Rule::NominalValue,
            element.place(),
            format!("nominal {nominal} of the type {name} is not above zero"),
        );
    }
}

fn enumeration(name: &str, items: &Element, report: &mut Report) {
    for attribute in ["name", "value"] {
        let mut seen = HashSet::new();
        for item in &items.children {
            let Some(value) = item.attribute(attribute) else { continue };
            if !seen.insert(value.trim_ascii()) {
                let message = format!(
                    "two items of the enumeration {name} have the same {attribute}, {value}"
                );
                report.add(Rule::Enumeration, item.place(), message);
            }
        }
    }
}
