//! Rules on start values and bounds.

use crate::description::{Kind, Variable};
use crate::report::Report;
use crate::rules::Rule;
use crate::xml::values::{double, integer};

pub(super) fn examine(variable: &Variable<'_>, report: &mut Report) {
    presence(variable, report);
    let (min, max) = (variable.number("min"), variable.number("max"));
    // The bounds of a type are examined with the type.
    let own = variable.element.attribute("min").or(variable.element.attribute("max")).is_some();
    if let (Some(min), Some(max)) = (min, max)
        && min > max
    {
        if own {
            let message = format!("min {min} of {} is above max {max}", variable.name);
            report.add(Rule::BoundsOrder, variable.element.place(), message);
        }
        return;
    }
    if let Some(nominal) =
        variable.element.attribute("nominal").and_then(double).filter(|nominal| *nominal <= 0.0)
    {
        let message = format!("nominal {nominal} of {} is not above zero", variable.name);
        report.add(Rule::NominalValue, variable.element.place(), message);
    }
    let Some(stated) = variable.start else { return };
    let Some(start) =
        double(stated).filter(|_| !matches!(variable.kind, Kind::String | Kind::Boolean))
    else {
        return;
    };
    let outside = if min.is_some_and(|min| start < min) {
        format!("is below min {}", variable.attribute("min").unwrap_or_default())
    } else if max.is_some_and(|max| start > max) {
        format!("is above max {}", variable.attribute("max").unwrap_or_default())
    } else if let Some(items) = variable.declared.and_then(|kind| kind.child("Enumeration"))
        && !items
            .children
            .iter()
            .any(|item| item.attribute("value").and_then(integer) == integer(stated))
    {
        "is not an item of its enumeration".to_owned()
    } else {
        return;
    };
    let message = format!("start {stated} of {} {outside}", variable.name);
    report.add(Rule::StartOutsideBounds, variable.element.place(), message);
}

fn presence(variable: &Variable<'_>, report: &mut Report) {
    let Variable { name, causality, initial, .. } = *variable;
    let place = variable.element.place();
    let wanted = causality == "input"
        || matches!(initial, Some("exact" | "approx")) && causality != "independent";
    match variable.start {
        None if wanted => {
            let why = initial.map_or_else(
                || causality.to_owned(),
                |initial| format!("{causality}, initial {initial}"),
            );
            report.add(Rule::StartMissing, place, format!("{name} ({why}) has no start value"));
        }
        Some(start) if causality == "independent" => {
            report.add(
                Rule::StartForbidden,
                place,
                format!("{name} is independent and must not have a start value ({start})"),
            );
        }
        Some(start) if causality != "input" && initial == Some("calculated") => {
            let message = format!(
                "{name} has initial calculated and must not have a start value ({start}); state initial approx if the value is a guess"
            );
            report.add(Rule::StartForbidden, place, message);
        }
        _ => {}
    }
}
