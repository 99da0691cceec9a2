//! The sections of the page, each made by a function from the report.
//!
//! | file | contents |
//! | --- | --- |
//! | `scene` | the drawing, the values, what the model leaves out |
//! | `squeal` | modes of uniform sliding, modes over µ, candidates |
//! | `loud` | the motions that growing modes or candidates lead to |
//! | `probable` | probabilities where parameters scatter |
//! | `change` | sensitivities, and changes computed anew |
//! | `limits` | what was not looked at, and the commands that give the same numbers |

mod change;
mod limits;
mod loud;
mod probable;
mod scene;
mod squeal;

use limits::scene_words;

pub use change::HEADING as CHANGE;
pub use loud::HEADING as LOUD;
pub use probable::HEADING as PROBABLE;
pub use squeal::HEADING as SQUEAL;

use super::Report;
use amontons_pictures::report::{Cell, Content, Figure, Line, Section, Table};

/// The sections in the order of the page.
pub const SECTIONS: [fn(&Report<'_>) -> Section; 6] = [
    scene::section,
    squeal::section,
    loud::section,
    probable::section,
    change::section,
    limits::section,
];

/// A figure whose command stands at the end of the page.
fn figure(caption: &str, content: Content) -> Figure {
    Figure { caption: caption.to_owned(), command: None, content }
}

fn table(caption: impl Into<String>, head: &[&str], rows: Vec<Vec<Cell>>) -> Table {
    let head = head.iter().map(|&name| name.to_owned()).collect();
    Table { caption: caption.into(), head, rows }
}

/// A cell that stands out where `emphasised` is `true`.
fn cell(text: impl Into<String>, emphasised: bool) -> Cell {
    Cell { lines: vec![Line { text: text.into(), emphasised }] }
}

/// A sentence from words that begin small and have no end.
pub fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    let end = if words.ends_with(['.', '!', '?']) { "" } else { "." };
    format!("{first}{}{end}", letters.as_str())
}
