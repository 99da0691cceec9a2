//! Reports as JSON.

use super::Examined;
use crate::report::{Report, printable};
use crate::rules::Class;
use serde::Serialize;

#[derive(Serialize)]
struct Finding {
    class: Class,
    rule: &'static str,
    place: String,
    line: Option<usize>,
    message: String,
    section: Option<&'static str>,
    since: Option<&'static str>,
}

/// Findings of a rule that are counted but not listed.
#[derive(Serialize)]
struct More {
    class: Class,
    rule: &'static str,
    count: usize,
}

#[derive(Serialize)]
struct Fmu {
    file: String,
    violations: usize,
    defects: usize,
    hints: usize,
    findings: Vec<Finding>,
    more: Vec<More>,
    notes: Vec<String>,
}

/// An FMU that could not be examined.
#[derive(Serialize)]
struct Unreadable {
    file: String,
    error: String,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Entry {
    Read(Fmu),
    Unreadable(Unreadable),
}

pub(super) fn document(all: &[Examined<'_>]) -> String {
    let entries: Vec<Entry> = all.iter().map(entry).collect();
    let text = match &entries[..] {
        [entry] => serde_json::to_string_pretty(entry),
        entries => serde_json::to_string_pretty(entries),
    };
    text.expect("texts and numbers can be written as JSON")
}

fn entry(examined: &Examined<'_>) -> Entry {
    let file = examined.file.to_string_lossy().into_owned();
    match &examined.result {
        Ok(report) => Entry::Read(fmu(file, report)),
        Err(error) => Entry::Unreadable(Unreadable { file, error: printable(&error.to_string()) }),
    }
}

fn fmu(file: String, report: &Report) -> Fmu {
    let finding = |finding: &crate::Finding| Finding {
        class: finding.class,
        rule: finding.rule.id(),
        place: printable(&finding.place.file),
        line: finding.place.line,
        message: printable(&finding.message),
        section: finding.section(),
        since: finding.since(),
    };
    Fmu {
        file,
        violations: report.count(Class::Violation),
        defects: report.count(Class::Defect),
        hints: report.count(Class::Hint),
        findings: report.findings.iter().map(finding).collect(),
        more: (report.more())
            .map(|(class, rule, count)| More { class, rule: rule.id(), count })
            .collect(),
        notes: report.notes.iter().map(|note| printable(note)).collect(),
    }
}
