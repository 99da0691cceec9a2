//! The result of an examination: findings, hints, and notes on parts that could not be examined.

use super::rules::Rule;
use std::collections::BTreeMap;
use std::fmt;

/// Limit of the findings of one rule that a report lists; further findings are only counted.
const TOLD: usize = 20;

/// A rule that an FMU breaks, with the place and the mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The rule.
    pub rule: Rule,
    /// A file of the archive, with a line number if there is one.
    pub place: String,
    /// The mistake and what would be right.
    pub message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.rule.id(), printable(&self.place), printable(&self.message))
    }
}

/// The result of an examination.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Broken rules.
    pub findings: Vec<Finding>,
    /// Broken rules that may be intended: whether the FMU is right depends on the hosts for which it is made.
    pub hints: Vec<Finding>,
    /// Parts that could not be examined, each with its reason.
    pub notes: Vec<String>,
    more: BTreeMap<Rule, usize>,
}

impl Report {
    /// Number of findings, including those that are only counted and excluding hints.
    #[must_use]
    pub fn count(&self) -> usize {
        self.findings.len() + self.more.values().sum::<usize>()
    }

    pub(super) fn add(&mut self, rule: Rule, place: impl Into<String>, message: impl Into<String>) {
        if self.findings.iter().filter(|finding| finding.rule == rule).count() < TOLD {
            let (place, message) = (place.into(), message.into());
            self.findings.push(Finding { rule, place, message });
        } else {
            *self.more.entry(rule).or_default() += 1;
        }
    }

    pub(super) fn hint(
        &mut self,
        rule: Rule,
        place: impl Into<String>,
        message: impl Into<String>,
    ) {
        let (place, message) = (place.into(), message.into());
        self.hints.push(Finding { rule, place, message });
    }

    pub(super) fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }
}

impl fmt::Display for Report {
    /// Writes one line for each finding, then one for each hint, then one for each note.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for finding in &self.findings {
            writeln!(f, "{finding}")?;
        }
        for (rule, count) in &self.more {
            let plural = if *count == 1 { "" } else { "s" };
            writeln!(f, "{} …: {count} more finding{plural} of this rule", rule.id())?;
        }
        for hint in &self.hints {
            writeln!(f, "hint: {hint}")?;
        }
        for note in &self.notes {
            writeln!(f, "note: {}", printable(note))?;
        }
        Ok(())
    }
}

/// Returns a text of an FMU as one line of limited length, without characters that control a terminal.
pub(super) fn printable(text: &str) -> String {
    const LONGEST: usize = 600;
    let mut line = String::with_capacity(text.len().min(LONGEST));
    for (place, c) in text.chars().enumerate() {
        if place == LONGEST {
            line.push('…');
            break;
        }
        // Direction marks change the order in which a terminal shows text.
        let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        if c.is_control() || turns || matches!(c, '\u{2028}' | '\u{2029}') {
            line.extend(c.escape_default());
        } else {
            line.push(c);
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_a_terminal_obeys_is_printed() {
        assert_eq!(printable("a\u{1b}[31mb\nc\u{202e}d"), "a\\u{1b}[31mb\\nc\\u{202e}d");
        assert_eq!(printable("é µ"), "é µ");
    }

    #[test]
    fn findings_of_one_rule_are_counted_after_the_first() {
        let mut report = Report::default();
        for _ in 0..TOLD + 5 {
            report.add(Rule::ZipLink, "a", "b");
        }
        assert_eq!(report.findings.len(), TOLD);
        assert!(report.to_string().ends_with("zip-link …: 5 more findings of this rule\n"));
    }
}
