//! What is wrong with a scene.

use crate::Error;
use crate::error::Short;
use std::fmt;

/// The most problems that one message lists.
pub const MAX_PROBLEMS: usize = 20;

/// A number with more characters says less than its power of ten.
const LONG: usize = 24;

/// Something wrong with a scene: where, what, and what would be right.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The place, as a path through the scene file (`ring.m1[2]`, `initial[1].module`; items are
    /// counted from 1, as the FMU's variables are), or the FMU's name of the variable.
    pub path: String,
    /// The value that stands there, where it says something.
    pub value: Option<String>,
    /// What is wrong, following on the place and value.
    pub message: String,
    /// What would be right, where the message does not say it; else empty.
    pub help: String,
}

impl Problem {
    /// A problem of the place itself: something that lacks, or too much.
    pub fn new(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self { path: path.into(), value: None, message: message.into(), help: String::new() }
    }

    /// The value that stands at the place; a number that is far from one in short.
    #[must_use]
    pub fn of(self, value: impl fmt::Display) -> Self {
        let text = value.to_string();
        let number = text.parse().ok().filter(|_| text.len() > LONG).map(Short);
        Self { value: Some(number.map_or(text, |number| number.to_string())), ..self }
    }

    /// What would be right.
    #[must_use]
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: help.into(), ..self }
    }

    /// Place, value and message in one line, without the help.
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

/// All problems as one error, one a line.
pub(super) fn error(problems: &[Problem]) -> Error {
    let mut lines: Vec<String> =
        problems.iter().take(MAX_PROBLEMS).map(ToString::to_string).collect();
    lines.extend(and_more(problems.len()));
    Error::scene(lines.join("\n"))
}

/// The last line of a list of `count` problems that is cut at [`MAX_PROBLEMS`].
#[must_use]
pub fn and_more(count: usize) -> Option<String> {
    let more = count.checked_sub(MAX_PROBLEMS).filter(|&more| more > 0)?;
    Some(format!("and {more} more"))
}
