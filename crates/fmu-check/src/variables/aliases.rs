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
        let settable: Vec<_> = set.iter().filter(|variable| variable.is_settable()).collect();
        if let [first, .., last] = settable[..] {
            let message = format!(
                "{} and {} share valueReference {} and can both be set; only one of them may be settable",
                first.name, last.name, last.reference
            );
            report.add(Rule::AliasSettable, last.element.place(), message);
        }
        let with_unit: Vec<_> = set.iter().filter(|variable| unit(variable).is_some()).collect();
        if let Some(pair) = with_unit.windows(2).find(|pair| unit(pair[0]) != unit(pair[1])) {
            let message = format!(
                "{} ({}) and {} ({}) share valueReference {} but have different units",
                pair[0].name,
                unit(pair[0]).unwrap_or_default(),
                pair[1].name,
                unit(pair[1]).unwrap_or_default(),
                pair[1].reference
            );
            report.add(Rule::AliasUnit, pair[1].element.place(), message);
        }
        let constants: Vec<_> =
            set.iter().filter(|variable| variable.variability == "constant").collect();
        if let Some(pair) = constants.windows(2).find(|pair| !is_same(pair[0], pair[1])) {
            let message = format!(
                "the constants {} and {} share valueReference {} but have different values",
                pair[0].name, pair[1].name, pair[1].reference
            );
            report.add(Rule::AliasStart, pair[1].element.place(), message);
        }
    }
}
