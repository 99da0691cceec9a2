//! Errors of the text itself: what the TOML parser says, made helpful.

use super::Located;
use super::walk::Walked;
use std::collections::HashSet;
use toml::de::Error;

/// The lines of a text; looking one up does not go through the text, of which every line may be wrong.
pub(super) struct Lines {
    /// Beginning of each line but the first, in bytes.
    starts: Vec<usize>,
}

impl Lines {
    pub(super) fn of(text: &str) -> Self {
        Self { starts: text.match_indices('\n').map(|(at, _)| at + 1).collect() }
    }

    /// The line of a byte, from 0.
    fn at(&self, byte: usize) -> usize {
        self.starts.partition_point(|start| *start <= byte)
    }

    /// Lines that contain the parser's errors.
    pub(super) fn with(&self, errors: &[Error]) -> HashSet<usize> {
        errors.iter().filter_map(|error| Some(self.at(error.span()?.start))).collect()
    }
}

/// The parser's errors, the first of each line: what follows there follows from it.
pub(super) fn problems(text: &str, lines: &Lines, errors: &[Error]) -> Vec<Located> {
    let mut known = HashSet::new();
    let problems = errors.iter().map(|error| problem(text, error));
    problems.filter(|problem| known.insert(lines.at(problem.span.start))).collect()
}

/// An error with its place. The slips that people make most are told from the text; for all others
/// the parser speaks.
pub(super) fn problem(text: &str, error: &Error) -> Located {
    let span = error.span().unwrap_or(0..0);
    let (before, rest) = text.split_at_checked(span.start).unwrap_or((text, ""));
    let there = text.get(span.clone()).unwrap_or("");
    let line_before = before.rsplit('\n').next().unwrap_or("");
    let rest = rest.split(['\r', '\n']).next().unwrap_or("");
    let is_value = line_before.contains('=');
    let digits_meet = |a: &str, b: &str| {
        a.ends_with(|c: char| c.is_ascii_digit()) && b.starts_with(|c: char| c.is_ascii_digit())
    };
    let (title, help) = if error.message() == "duplicate key" {
        let title = format!("`{there}` is defined twice in the same table");
        (title, "keep one of them, with everything that belongs to it".to_owned())
    } else if is_value && rest.strip_prefix(',').is_some_and(|rest| digits_meet(line_before, rest))
    {
        ("a comma in a number".to_owned(), "write a decimal point".to_owned())
    } else if is_value && line_before.trim_end().ends_with('=') && rest.trim().is_empty() {
        ("a value is missing".to_owned(), format!("write a value after `{}`", line_before.trim()))
    } else if let Some((number, unit)) = number_and_word(there).filter(|_| is_value) {
        let title = format!("`{there}` is neither a number nor a text in quotes");
        let joined = format!("{number}{unit}");
        let help = if joined.parse::<f64>().is_ok() {
            format!("write it without a space: `{joined}`")
        } else {
            format!("write the number alone; a text after a # is a comment: `{number} # {unit}`")
        };
        (title, help)
    } else {
        let title = format!("this is not TOML: {}", error.message());
        let help = "a line is `key = value`, `[table]`, `[[table of a list]]` or `# comment`; write a text in quotes \
                    and a list in [ ]";
        (title, help.to_owned())
    };
    Located { span, title, help }
}

/// A number and what stands behind it, with or without a blank between them.
fn number_and_word(text: &str) -> Option<(&str, &str)> {
    let end = text.char_indices().map(|(at, _)| at).chain([text.len()]).rev();
    let number = end
        .map(|end| &text[..end])
        .find(|part| part.ends_with(|c: char| c.is_ascii_digit()) && part.parse::<f64>().is_ok())?;
    let word = text[number.len()..].trim();
    (!word.is_empty()).then_some((number, word))
}

impl Walked {
    /// `true` if the problem may be there only because a part of the text could not be read. `unread`: the lines with
    /// errors.
    pub(super) fn may_follow(&self, lines: &Lines, unread: &HashSet<usize>) -> bool {
        self.is_lack || unread.contains(&lines.at(self.problem.span.start))
    }
}
