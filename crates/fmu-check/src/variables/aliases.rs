//! Rules on aliases: variables that share a value reference and so have one value.

use crate::description::{Kind, Variable};
use crate::report::Report;
use crate::rules::Rule;
use crate::xml::values::{boolean, double, integer};
use std::collections::BTreeMap;

fn unit<'a>(variable: &Variable<'a>) -> Option<&'a str> {
    variable.attribute("unit")
}

/// `true` if two start values are equal as text or as numbers (9.81 and 9.810).
fn is_same(one: &Variable<'_>, other: &Variable<'_>) -> bool {
    let number = |variable: &Variable<'_>| match variable.kind.base() {
        Kind::Real => variable.start.and_then(double),
        Kind::Integer => variable.start.and_then(integer).map(f64::from),
        Kind::Boolean => variable.start.and_then(boolean).map(|value| f64::from(u8::from(value))),
        _ => None,
    };
    one.start == other.start || number(one).is_some_and(|value| number(other) == Some(value))
}

pub(super) fn examine(variables: &[Variable<'_>], report: &mut Report) {
    let mut sets: BTreeMap<(u8, u32), Vec<&Variable<'_>>> = BTreeMap::new();
    for variable in variables {
        sets.entry((variable.kind.base() as u8, variable.reference)).or_default().push(variable);
    }
    for set in sets.values().filter(|set| set.len() > 1) {
        settable(set, report);
        constants(set, report);
        if let Some(pair) = set.windows(2).find(|pair| unit(pair[0]) != unit(pair[1])) {
            let unit = |variable| {
                unit(variable).map_or("no unit".to_owned(), |unit| format!("unit {unit}"))
            };
            let message = format!(
                "{} ({}) and {} ({}) share valueReference {} but have different units",
                pair[0].name,
                unit(pair[0]),
                pair[1].name,
                unit(pair[1]),
                pair[1].reference
            );
            report.add(Rule::AliasUnit, pair[1].element.place(), message);
        }
    }
}

/// Examines what the environment gives a value: of an alias set at most one variable.
fn settable(set: &[&Variable<'_>], report: &mut Report) {
    let settable: Vec<_> = set.iter().copied().filter(|variable| variable.is_settable()).collect();
    let independent = set.iter().copied().find(|variable| variable.causality == "independent");
    let (first, last, why) = match (&settable[..], independent) {
        ([first, .., last], _) => {
            (*first, *last, "and can both be set; only one of them may be settable")
        }
        ([first], Some(independent)) => (
            *first,
            independent,
            "but the first can be set and the second is the independent variable",
        ),
        _ => return,
    };
    let message =
        format!("{} and {} share valueReference {} {why}", first.name, last.name, last.reference);
    report.add(Rule::AliasSettable, last.element.place(), message);
}

/// Examines constants: they may be aliases of constants of the same value only.
fn constants(set: &[&Variable<'_>], report: &mut Report) {
    let (constants, others): (Vec<&Variable<'_>>, Vec<&Variable<'_>>) =
        set.iter().partition(|variable| variable.variability == "constant");
    if let (Some(constant), Some(other)) = (constants.first(), others.first()) {
        let message = format!(
            "the constant {} and {}, which is not constant, share valueReference {}",
            constant.name, other.name, other.reference
        );
        report.add(Rule::AliasConstant, other.element.place(), message);
    }
    if let Some(pair) = constants.windows(2).find(|pair| !is_same(pair[0], pair[1])) {
        let message = format!(
            "the constants {} and {} share valueReference {} but have different values",
            pair[0].name, pair[1].name, pair[1].reference
        );
        report.add(Rule::AliasStart, pair[1].element.place(), message);
    }
}
