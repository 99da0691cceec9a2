//! Reports: one HTML page that needs nothing else, from plain data.
//!
//! A page has answers that link to the sections which show them, claims with their verdicts, figures, tables and commands. It is one file that opens without a network; a
//! [content security policy](https://www.w3.org/TR/CSP3/) in it forbids to load or run anything. Each figure is an SVG
//! in the colours of the reader's scheme, light or dark, and has its data as a table.
//!
//! One set of data gives one sequence of bytes.

mod answers;
mod figure;
mod listing;
mod markup;
mod summary;
mod thin;

pub use markup::{BASE_STYLE, add, plain_table, sheet, text};
pub use thin::{envelope, evenly_spaced};

use crate::picture::{Bars, Chart, Map, Structure};
use amontons::Error;
use amontons_analysis::output::AtomicFile;
use std::io::Write as _;
use std::path::Path;

/// A report. All texts are plain: what HTML would take for markup is shown as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Subject of the report.
    pub title: String,
    /// Paragraphs before everything else.
    pub lead: Vec<String>,
    /// Answers in a few sentences, which stand before all sections.
    pub answers: Vec<Answer>,
    /// The sections in order. The summary of all their claims stands before them.
    pub sections: Vec<Section>,
    /// The last line: what made the page.
    pub footer: String,
}

/// A question of the reader with its answer, and the section that shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// The question.
    pub question: String,
    /// Sentences of the answer.
    pub text: Vec<String>,
    /// Heading of the section that shows it.
    pub section: String,
}

/// A part of a report with a heading. Its text comes first, then key tables, claims, figures, tables, points and commands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Heading of the section, also in the table of contents.
    pub heading: String,
    /// Paragraphs.
    pub text: Vec<String>,
    /// Tables that stand before the figures.
    pub key_tables: Vec<Table>,
    /// Numbered through all sections.
    pub claims: Vec<Claim>,
    /// The figures in order.
    pub figures: Vec<Figure>,
    /// The tables in order.
    pub tables: Vec<Table>,
    /// The points of a list.
    pub points: Vec<String>,
    /// Command lines, one below the other.
    pub commands: Vec<String>,
}

/// Something that the paper says, and what came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The statement of the paper.
    pub paper: String,
    /// The result that was found.
    pub found: String,
    /// Comparison of the two.
    pub verdict: Verdict,
}

/// Agreement of a claim with the result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The claim agrees with the result.
    Holds,
    /// The claim disagrees with the result.
    Differs {
        /// The reason of the difference; `None` is shown as “not known”.
        reason: Option<String>,
    },
    /// It is not known if the claim agrees with the result.
    Unknown {
        /// The evidence that would decide it.
        decided_by: String,
    },
}

/// A picture with its caption and the command that makes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Content of the figure in words.
    pub caption: String,
    /// The command line that makes it.
    pub command: Option<String>,
    /// The picture.
    pub content: Content,
}

/// The picture of a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Panels over one x axis.
    Chart(Chart),
    /// Classes over a plane.
    Map(Map),
    /// Masses and what joins them.
    Structure(Structure),
    /// Groups of bars.
    Bars(Bars),
}

/// A table. The first cell of each row names the row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Content of the table in words, and the meaning of its emphasis.
    pub caption: String,
    /// Names of the columns.
    pub head: Vec<String>,
    /// The rows, with one cell for each name in `head`.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table: lines of text, one below the other. A text alone is a cell of one line: `"0.3 kg".into()`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Lines from top to bottom.
    pub lines: Vec<Line>,
}

/// A line in a cell.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Line {
    /// Text of the line.
    pub text: String,
    /// `true` if the line is to stand out (an eigenvalue that grows).
    pub emphasised: bool,
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self { lines: vec![Line { text: text.into(), emphasised: false }] }
    }
}

impl Verdict {
    /// `true` if the claim holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        *self == Self::Holds
    }
}

/// The page as HTML.
///
/// Pictures are thinned to the visible points: of curves along x the lowest and the highest point in each of 2000
/// parts of the axis, of other curves (limit cycles in a phase plane) points that differ visibly, of dots one in each
/// cell of a fine grid; 4000 points or a few more. Points with labels all stay.
///
/// # Errors
/// Returns an error if a figure has nothing to draw or has data that contradict each other, if a row of a table does not
/// have as many cells as the table has columns, or if an answer names a section that the page does not have.
pub fn html(page: &Page) -> Result<String, Error> {
    markup::page(page)
}

/// Writes the page; it appears whole or not at all.
///
/// # Errors
/// Returns an error of [`html`], or if the file cannot be written.
pub fn write(page: &Page, path: &Path) -> Result<(), Error> {
    let text = html(page)?;
    let mut file = AtomicFile::create(path)?;
    file.write_all(text.as_bytes()).map_err(|error| Error::file(path, &error))?;
    file.complete()
}
