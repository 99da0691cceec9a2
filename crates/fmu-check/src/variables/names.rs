//! Rules on the names of variables.

use crate::description::Description;
use crate::report::Report;
use crate::rules::Rule;
use crate::xml::Element;
use std::collections::{HashMap, HashSet};

pub(super) fn examine(description: &Description<'_>, report: &mut Report) {
    let structured = description.root.attribute("variableNamingConvention") == Some("structured");
    let mut seen = HashSet::new();
    for scalar in description.root.below("ModelVariables") {
        let Some(name) = scalar.attribute("name") else { continue };
        if !seen.insert(name) {
            report.add(
                Rule::NameDuplicate,
                scalar.place(),
                format!("another variable is also named {name}"),
            );
        }
        if structured && !is_structured(name) {
            let message = format!(
                "{name} is not a structured name (such as a.b[1,2].c or der(a.b)), but variableNamingConvention is structured"
            );
            report.add(Rule::NameStructured, scalar.place(), message);
        } else if name.is_empty() || name.contains(['\t', '\n', '\r']) {
            let message = "the name of the variable is empty or contains a tab or a line end";
            report.add(Rule::NameFlat, scalar.place(), message);
        }
    }
    if structured {
        arrays(description.root.below("ModelVariables"), report);
    }
}

/// Examines the order of arrays: their elements follow each other, those of the last index first.
fn arrays(scalars: &[Element], report: &mut Report) {
    let mut last: HashMap<&str, (usize, Vec<u64>)> = HashMap::new();
    let mut told = HashSet::new();
    for (place, scalar) in scalars.iter().enumerate() {
        let Some((array, indices)) = scalar.attribute("name").and_then(element) else { continue };
        let Some((before, earlier)) = last.insert(array, (place, indices.clone())) else {
            continue;
        };
        let problem = if before + 1 != place {
            "are not consecutive"
        } else if indices < earlier {
            "are not in the order of their indices"
        } else {
            continue;
        };
        if told.insert(array) {
            let message = format!("the elements of {array} {problem}");
            report.add(Rule::ArrayOrder, scalar.place(), message);
        }
    }
}

/// Returns the array and the indices of a name such as `a.b[1,2]`.
fn element(name: &str) -> Option<(&str, Vec<u64>)> {
    let (array, indices) = name.strip_suffix(']')?.rsplit_once('[')?;
    let indices = indices.split(',').map(|index| index.trim().parse().ok());
    Some((array, indices.collect::<Option<_>>()?))
}

/// `true` if a name follows the grammar of structured names (FMI 2.0, section 2.2.9).
fn is_structured(name: &str) -> bool {
    let Some(inner) = name.strip_prefix("der(").and_then(|rest| rest.strip_suffix(')')) else {
        return identifier(name) == Some("");
    };
    match identifier(inner) {
        Some("") => true,
        Some(rest) => {
            rest.strip_prefix(',').is_some_and(|order| digits(order.trim_start()) == Some(""))
        }
        None => false,
    }
}

/// Parses an identifier. Each parser takes its part from the beginning of the text and returns the rest.
fn identifier(text: &str) -> Option<&str> {
    let mut rest = part(text)?;
    while let Some(next) = rest.strip_prefix('.') {
        rest = part(next)?;
    }
    Some(rest)
}

fn part(text: &str) -> Option<&str> {
    let rest = match text.strip_prefix('\'') {
        Some(quoted) => quoted_end(quoted)?,
        None => {
            let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
            text.starts_with(letter).then_some(())?;
            text.trim_start_matches(|c: char| letter(c) || c.is_ascii_digit())
        }
    };
    let Some(indices) = rest.strip_prefix('[') else { return Some(rest) };
    let mut rest = digits(indices)?;
    while let Some(next) = rest.strip_prefix(',') {
        rest = digits(next.trim_start())?;
    }
    rest.strip_prefix(']')
}

fn quoted_end(text: &str) -> Option<&str> {
    let mut characters = text.char_indices();
    while let Some((at, c)) = characters.next() {
        match c {
            '\'' => return (at > 0).then(|| &text[at + 1..]),
            '\\' => {
                let (_, escaped) = characters.next()?;
                "'\"?\\abfnrtv".contains(escaped).then_some(())?;
            }
            c if c.is_ascii_graphic() && c != '"' && c != '`' || c == ' ' => {}
            _ => return None,
        }
    }
    None
}

fn digits(text: &str) -> Option<&str> {
    let rest = text.trim_start_matches(|c: char| c.is_ascii_digit());
    (rest.len() < text.len()).then_some(rest)
}

#[cfg(test)]
mod tests {
    use super::is_structured;

    #[test]
    fn structured_names_are_those_of_the_grammar() {
        for name in [
            "a",
            "_a1.b",
            "a[1]",
            "a[1,2].b[3].c",
            "der(a.b[1])",
            "der(a,2)",
            "'a b'.c",
            "'\\''",
            "der",
        ] {
            assert!(is_structured(name), "{name}");
        }
        for name in [
            "", "1a", "a.", ".a", "a b", "a[", "a[]", "a[1", "a[x]", "der(a", "der()", "'a", "''",
            "a-b", "é",
        ] {
            assert!(!is_structured(name), "{name}");
        }
    }
}
