//! Problems found in a scene.

use crate::Error;
use crate::error::Short;
use std::fmt;

/// Largest number of problems that one message lists.
pub const MAX_PROBLEMS: usize = 20;

/// Largest number of characters of a number in decimal notation; longer ones are abbreviated.
const LONG: usize = 24;

/// A problem found in a scene: its place, the reason, and what would be right.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Place of the problem: a path through the scene file (`ring.m1[2]`, `initial[1].module`; items are counted from
    /// 1, like the FMU's variables), or the FMU's name of the variable.
    pub path: String,
    /// The value at the place, if it helps the reader.
    pub value: Option<String>,
    /// The reason, worded to follow the place and the value.
    pub message: String,
    /// The correct form; empty if the message says it.
    pub help: String,
}

impl Problem {
    /// Makes a problem of the place itself: something is missing, or superfluous.
    pub fn new(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self { path: path.into(), value: None, message: message.into(), help: String::new() }
    }

    /// Adds the value at the place; a very long number is abbreviated.
    #[must_use]
    pub fn of(self, value: impl fmt::Display) -> Self {
        let text = value.to_string();
        let number = text.parse().ok().filter(|_| text.len() > LONG).map(Short);
        Self { value: Some(number.map_or(text, |number| number.to_string())), ..self }
    }

    /// Adds what would be right.
    #[must_use]
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: help.into(), ..self }
    }

    /// Returns place, value and message in one line, without the help.
    #[must_use]
    pub fn title(&self) -> String {
        match &self.value {
            Some(value) => format!("{} = {value}: {}", self.path, self.message),
            None => format!("{}: {}", self.path, self.message),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.title())?;
        if self.help.is_empty() { Ok(()) } else { write!(f, "; {}", self.help) }
    }
}

/// Joins all problems into one error with one line for each.
pub(super) fn error(problems: &[Problem]) -> Error {
    let mut lines: Vec<String> =
        problems.iter().take(MAX_PROBLEMS).map(ToString::to_string).collect();
    lines.extend(and_more(problems.len()));
    Error::scene(lines.join("\n"))
}

/// Returns the last line of a list of `count` problems that is cut at [`MAX_PROBLEMS`]; `None` if nothing is cut.
#[must_use]
pub fn and_more(count: usize) -> Option<String> {
    let more = count.checked_sub(MAX_PROBLEMS).filter(|&more| more > 0)?;
    Some(format!("and {more} more"))
}
