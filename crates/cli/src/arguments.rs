//! Arguments that both programs take: values of a parameter, and the format of an output.

use amontons_analysis::sweep::range;
use clap::ValueEnum;

/// Values of a parameter, ascending.
#[derive(Clone, Debug)]
pub struct Values(pub Vec<f64>);

/// The format of an output.
// Documentation of the variants would become a help text of its own.
#[expect(missing_docs, reason = "the names say all")]
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Table,
    Csv,
    Json,
}

/// Parses `A:B:STEP` or `A:B/N` ([`range::steps`]).
///
/// # Errors
/// Returns the mistake, for the message of the command line.
pub fn steps(text: &str) -> Result<Values, String> {
    range::steps(text).map(Values)
}

/// Parses `A:B/N` ([`range::grid`]).
///
/// # Errors
/// Returns the mistake, for the message of the command line.
pub fn grid(text: &str) -> Result<Values, String> {
    range::grid(text).map(Values)
}

/// Parses `NAME=A:B:STEP` or `NAME=A:B/N`.
///
/// # Errors
/// Returns the mistake, for the message of the command line.
pub fn named_steps(text: &str) -> Result<(String, Values), String> {
    range::named(text, steps)
}

/// Parses `NAME=A:B/N`.
///
/// # Errors
/// Returns the mistake, for the message of the command line.
pub fn named_grid(text: &str) -> Result<(String, Values), String> {
    range::named(text, grid)
}

/// Parses the width and height, in points, of the islands that are found wherever they lie.
///
/// # Errors
/// Returns the mistake, for the message of the command line.
pub fn islands(text: &str) -> Result<usize, String> {
    let points = text.parse().ok().filter(|points: &usize| points.is_power_of_two());
    points.ok_or_else(|| "must be a power of two: 1, 2, 4, 8 or more points".into())
}
