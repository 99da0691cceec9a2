//! The check of a tree against the schema.

use super::schema::{ELEMENTS, ElementKind};
use super::tree::Element;
use super::values::InvalidValue;
use crate::report::Report;
use crate::rules::Rule;
use std::collections::HashSet;

/// Checks an element and all elements below it against the schema.
pub(super) fn examine(element: &Element, parent: &str, report: &mut Report) {
    let Some(kind) = kind(parent, &element.name) else { return };
    attributes(element, kind, report);
    if element.name != "Tool" {
        children(element, kind, report);
    }
}

/// Returns the schema of an element; `None` if the schema leaves it open.
fn kind(parent: &str, name: &str) -> Option<&'static ElementKind> {
    let path = format!("{parent}/{name}");
    ELEMENTS.iter().find(|kind| kind.name == path || kind.name == name)
}

fn attributes(element: &Element, kind: &ElementKind, report: &mut Report) {
    let tag = &element.name;
    for (name, value) in &element.attributes {
        // Namespaces and the location of the schema belong to XML, not to FMI.
        if name == "xmlns"
            || name.starts_with("xmlns:")
            || name.starts_with("xsi:")
            || name.starts_with("xml:")
        {
            continue;
        }
        let Some((_, kind, _)) = kind.attributes.iter().find(|(known, ..)| known == name) else {
            let message = format!("FMI 2.0 defines no attribute {name} of <{tag}>");
            report.add(Rule::AttributeUnknown, element.place(), message);
            continue;
        };
        match kind.check(value) {
            Ok(()) => {}
            Err(InvalidValue::NotFinite) => {
                let message = format!("{name}=\"{value}\" of <{tag}> is not a finite number");
                report.add(Rule::NotFinite, element.place(), message);
            }
            Err(InvalidValue::Value(right)) => {
                let message = format!("{name}=\"{value}\" of <{tag}> must be {right}");
                report.add(Rule::AttributeValue, element.place(), message);
            }
        }
    }
    for (name, _, _) in kind.attributes.iter().filter(|(.., required)| *required) {
        if element.attribute(name).is_none() {
            let message = format!("<{tag}> is missing the attribute {name}");
            report.add(Rule::AttributeMissing, element.place(), message);
        }
    }
}

fn children(element: &Element, kind: &ElementKind, report: &mut Report) {
    let tag = &element.name;
    if element.has_text {
        report.add(
            Rule::XmlElement,
            element.place(),
            format!("<{tag}> contains text, which FMI 2.0 does not allow"),
        );
    }
    let mut reached = 0;
    let mut seen = HashSet::new();
    for child in &element.children {
        let name = &child.name;
        let Some(step) = kind.children.iter().position(|step| step.names.contains(&name.as_str()))
        else {
            report.add(
                Rule::XmlElement,
                child.place(),
                format!("FMI 2.0 defines no <{name}> in <{tag}>"),
            );
            continue;
        };
        if step < reached {
            let before = kind.children[reached].names.join(", ");
            report.add(
                Rule::XmlElement,
                child.place(),
                format!("<{name}> must come before {before} in <{tag}>"),
            );
        }
        reached = reached.max(step);
        // Names that exclude each other count as the first of them.
        let twin = if kind.children[step].either { kind.children[step].names[0] } else { name };
        if !seen.insert(twin) && !kind.children[step].many {
            report.add(
                Rule::XmlElement,
                child.place(),
                format!("<{tag}> contains one <{name}> too many"),
            );
        }
        examine(child, tag, report);
    }
    for step in kind.children.iter().filter(|step| step.required) {
        if !element.children.iter().any(|child| step.names.contains(&child.name.as_str())) {
            let names = step.names.join(" or ");
            let message = format!("<{tag}> is missing the element {names}");
            report.add(Rule::XmlElement, element.place(), message);
        }
    }
}
