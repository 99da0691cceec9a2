//! The formats of a report: text for people, JSON for programs, SARIF and JUnit for services that test each change.

mod json;
mod junit;
mod sarif;

use crate::Error;
use crate::report::Report;
use crate::rules::Class;
use clap::ValueEnum;
use std::path::Path;

/// The format in which reports are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// One line for each finding
    #[default]
    Text,
    /// An object for one FMU; for several an array
    Json,
    /// SARIF 2.1.0, as code scanning reads it
    Sarif,
    /// JUnit's XML, with one test case for each rule
    Junit,
}

/// An FMU and what its examination returned.
pub(crate) struct Examined<'a> {
    pub(crate) file: &'a Path,
    pub(crate) result: Result<Report, Error>,
}

/// Returns the lines of a report; if it is one of several, each line begins with the path of its FMU.
pub(crate) fn text(file: &Path, report: &Report, is_one_of_several: bool) -> String {
    let path = crate::report::printable(&file.to_string_lossy());
    let front = if is_one_of_several { format!("{path}: ") } else { String::new() };
    report.lines().iter().map(|line| format!("{front}{line}\n")).collect()
}

/// Returns all reports as one document. `Format::Text` is written FMU by FMU instead; see [`text`].
pub(crate) fn document(format: Format, all: &[Examined<'_>], strict: bool) -> String {
    let mut document = match format {
        Format::Text => return String::new(),
        Format::Json => json::document(all),
        Format::Sarif => sarif::document(all, strict),
        Format::Junit => junit::document(all, strict),
    };
    document.push('\n');
    document
}

/// `true` if a finding of this class lets the examination fail.
pub(crate) fn fails(class: Class, strict: bool) -> bool {
    class != Class::Hint || strict
}
