//! The result of an examination: findings of three classes, and notes on parts that could not be examined.

use super::rules::{Class, Part, Rule};
use std::collections::BTreeMap;
use std::fmt;

/// Limit of the findings of one rule that a report lists; further findings are only counted.
const TOLD: usize = 20;

/// A place in an FMU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Path of a file of the archive, or another name of the part.
    pub file: String,
    /// Number of the line, from 1, where the file is a text.
    pub line: Option<usize>,
}

impl Place {
    pub(super) fn line(file: &str, line: usize) -> Self {
        Self { file: file.to_owned(), line: Some(line) }
    }
}

impl<T: AsRef<str>> From<T> for Place {
    fn from(file: T) -> Self {
        Self { file: file.as_ref().to_owned(), line: None }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", printable(&self.file))?;
        self.line.map_or(Ok(()), |line| write!(f, ":{line}"))
    }
}

/// A rule that an FMU breaks, with the place and the mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The class: that of the rule, unless this case of the rule is of another one. `glibc-floor`, for example, is a
    /// hint, but a defect if the caller has stated the glibc of the hosts.
    pub class: Class,
    /// The rule.
    pub rule: Rule,
    /// Where it is broken.
    pub place: Place,
    /// The mistake and what would be right.
    pub message: String,
}

impl Finding {
    /// The section of FMI 2.0.5 that states the requirement; `None` if no sentence does.
    #[must_use]
    pub fn section(&self) -> Option<&'static str> {
        self.rule.section().filter(|_| self.class == self.rule.class())
    }

    /// The version of FMI 2.0 since which the requirement holds; `None` if there is no section.
    #[must_use]
    pub fn since(&self) -> Option<&'static str> {
        self.rule.since().filter(|_| self.class == self.rule.class())
    }
}

impl fmt::Display for Finding {
    /// Writes the class, the rule, the place, the mistake, and the section.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (class, rule) = (self.class, self.rule.id());
        write!(f, "{class}: {rule} {}: {}", self.place, printable(&self.message))?;
        self.section().map_or(Ok(()), |section| write!(f, " [FMI 2.0.5, {section}]"))
    }
}

/// The result of an examination.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Broken rules.
    pub findings: Vec<Finding>,
    /// Parts that could not be examined, each with its reason.
    pub notes: Vec<String>,
    more: BTreeMap<(Class, Rule), usize>,
    reached: Part,
}

impl Report {
    /// Number of findings of a class, including those that are only counted.
    #[must_use]
    pub fn count(&self, class: Class) -> usize {
        let listed = self.findings.iter().filter(|finding| finding.class == class).count();
        let more = self.more.iter().filter(|((other, _), _)| *other == class);
        listed + more.map(|(_, count)| count).sum::<usize>()
    }

    /// Number of findings of a class and rule that are counted but not listed, for each that has such.
    pub(super) fn more(&self) -> impl Iterator<Item = (Class, Rule, usize)> {
        self.more.iter().map(|(&(class, rule), &count)| (class, rule, count))
    }

    /// The part in which the examination ended; the rules of later parts were not examined.
    #[must_use]
    pub fn reached(&self) -> Part {
        self.reached
    }

    pub(super) fn reach(&mut self, part: Part) {
        self.reached = part;
    }

    /// Adds a finding of the rule's own class.
    pub(super) fn add(&mut self, rule: Rule, place: impl Into<Place>, message: impl Into<String>) {
        self.add_as(rule.class(), rule, place, message);
    }

    /// Adds a finding of a class that differs from the rule's.
    pub(super) fn add_as(
        &mut self,
        class: Class,
        rule: Rule,
        place: impl Into<Place>,
        message: impl Into<String>,
    ) {
        let alike = |finding: &&Finding| finding.rule == rule && finding.class == class;
        if self.findings.iter().filter(alike).count() < TOLD {
            let (place, message) = (place.into(), message.into());
            self.findings.push(Finding { class, rule, place, message });
        } else {
            *self.more.entry((class, rule)).or_default() += 1;
        }
    }

    pub(super) fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    /// Returns one line for each finding, the gravest class first, then one for each note.
    pub(super) fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for class in Class::ALL {
            let of_class = self.findings.iter().filter(|finding| finding.class == class);
            lines.extend(of_class.map(ToString::to_string));
            for (_, rule, count) in self.more().filter(|(other, ..)| *other == class) {
                lines.push(format!("{class}: {} …: {count} more of this rule", rule.id()));
            }
        }
        lines.extend(self.notes.iter().map(|note| format!("note: {}", printable(note))));
        lines
    }
}

impl fmt::Display for Report {
    /// Writes one line for each finding, the gravest class first, then one for each note.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.lines().iter().try_for_each(|line| writeln!(f, "{line}"))
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
        // XML, which one of the formats of a report is, has no way to write the last two.
        let never = matches!(c, '\u{2028}' | '\u{2029}' | '\u{fffe}' | '\u{ffff}');
        if c.is_control() || turns || never {
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
        assert_eq!(report.count(Class::Violation), TOLD + 5);
        assert_eq!(report.count(Class::Defect), 0);
        assert!(report.to_string().ends_with("violation: zip-link …: 5 more of this rule\n"));
    }

    #[test]
    fn the_gravest_class_is_written_first_and_only_the_class_of_the_rule_has_its_section() {
        let mut report = Report::default();
        report.note("d");
        report.add(Rule::ZipUnknownEntry, "a", "b");
        report.add(Rule::GuidEmpty, Place::line("x", 3), "c");
        report.add_as(Class::Hint, Rule::ZipPath, "e", "f");
        report.add(Rule::ZipPath, "e", "g");
        let lines = [
            "violation: zip-path e: g [FMI 2.0.5, 2.3]",
            "hint: zip-unknown-entry a: b [FMI 2.0.5, 2.3]",
            "hint: guid-empty x:3: c [FMI 2.0.5, 2.2.1]",
            "hint: zip-path e: f",
            "note: d",
        ];
        assert_eq!(report.lines(), lines);
    }
}
