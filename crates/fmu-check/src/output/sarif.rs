//! Reports as SARIF 2.1.0, the format of OASIS that code scanning services read.

use super::{Examined, fails};
use crate::report::{Finding, printable};
use crate::rules::{Class, Rule};
use flate2::Crc;
use serde_json::{Value, json};
use std::path::{Component, Path};

const SCHEMA: &str = "https://json.schemastore.org/sarif-2.1.0.json";

pub(super) fn document(all: &[Examined<'_>], strict: bool) -> String {
    let results: Vec<Value> = (all.iter())
        .flat_map(|examined| {
            let findings = examined.result.iter().flat_map(|report| &report.findings);
            findings.map(move |finding| result(examined.file, finding, strict))
        })
        .collect();
    let notifications: Vec<Value> = all.iter().flat_map(notifications).collect();
    let document = json!({
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": env!("CARGO_PKG_NAME"),
                "semanticVersion": env!("CARGO_PKG_VERSION"),
                "rules": Rule::ALL.iter().map(|rule| description(*rule, strict)).collect::<Vec<_>>(),
            }},
            "invocations": [{
                "executionSuccessful": all.iter().all(|examined| examined.result.is_ok()),
                "toolExecutionNotifications": notifications,
            }],
            "results": results,
        }],
    });
    serde_json::to_string_pretty(&document).expect("texts and numbers can be written as JSON")
}

const fn level(class: Class, strict: bool) -> &'static str {
    match class {
        Class::Violation | Class::Defect => "error",
        Class::Hint if strict => "warning",
        Class::Hint => "note",
    }
}

fn description(rule: Rule, strict: bool) -> Value {
    let class = rule.class();
    let source = match (rule.section(), rule.since()) {
        (Some(section), Some(since)) => format!(" FMI 2.0.5, section {section}; since {since}."),
        _ => String::new(),
    };
    let failing = if fails(class, strict) { "" } else { " It does not let the check fail." };
    json!({
        "id": rule.id(),
        "shortDescription": { "text": rule.line() },
        "help": { "text": format!("What is required: {}. Class: {class}.{source}{failing}", rule.line()) },
        "defaultConfiguration": { "level": level(class, strict) },
        "properties": { "tags": [class.word()] },
    })
}

fn result(file: &Path, finding: &Finding, strict: bool) -> Value {
    let index = Rule::ALL.iter().position(|rule| *rule == finding.rule);
    let (place, message) = (&finding.place, printable(&finding.message));
    let mut mark = Crc::new();
    for part in [finding.rule.id(), &place.file, &message] {
        mark.update(part.as_bytes());
        mark.update(&[0]);
    }
    json!({
        "ruleId": finding.rule.id(),
        "ruleIndex": index,
        "level": level(finding.class, strict),
        "message": { "text": format!("{}: {message}", place) },
        "locations": [{
            "physicalLocation": {
                "artifactLocation": { "uri": uri(file) },
                // Services want a line even where the finding concerns no line of a text.
                "region": { "startLine": place.line.unwrap_or(1) },
            },
            "logicalLocations": [{ "fullyQualifiedName": printable(&place.file) }],
        }],
        // The artifact is a binary file, from whose lines services can make no mark of a finding.
        "partialFingerprints": { "primaryLocationLineHash": format!("{:08x}:1", mark.sum()) },
    })
}

fn notifications(examined: &Examined<'_>) -> Vec<Value> {
    let notification = |level: &str, text: &str| {
        json!({
            "level": level,
            "message": { "text": printable(text) },
            "locations": [{ "physicalLocation": { "artifactLocation": { "uri": uri(examined.file) } } }],
        })
    };
    match &examined.result {
        Err(error) => vec![notification("error", &error.to_string())],
        Ok(report) => {
            let more = report.more().map(|(class, rule, count)| {
                format!("{count} more findings of {} ({class}) are not listed", rule.id())
            });
            let notes = report.notes.iter().cloned();
            more.chain(notes).map(|text| notification("note", &text)).collect()
        }
    }
}

/// Returns a path as the reference of a URI: relative paths stay relative.
fn uri(path: &Path) -> String {
    let mut parts = Vec::new();
    let mut is_absolute = false;
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::RootDir => is_absolute = true,
            Component::Prefix(_) | Component::ParentDir | Component::Normal(_) => {
                parts.push(escaped(&component.as_os_str().to_string_lossy()));
            }
        }
    }
    let front = if is_absolute { "file:///" } else { "" };
    format!("{front}{}", parts.join("/"))
}

/// Returns a part of a path with all characters escaped that a URI does not allow there.
fn escaped(part: &str) -> String {
    let keep = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
    part.bytes()
        .map(|byte| if keep(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::uri;
    use std::path::Path;

    #[test]
    fn paths_become_references_of_uris() {
        for (path, wanted) in [
            ("a.fmu", "a.fmu"),
            ("./made/a b.fmu", "made/a%20b.fmu"),
            ("../é.fmu", "../%C3%A9.fmu"),
            ("/tmp/a:b.fmu", "file:///tmp/a%3Ab.fmu"),
        ] {
            assert_eq!(uri(Path::new(path)), wanted);
        }
    }
}
