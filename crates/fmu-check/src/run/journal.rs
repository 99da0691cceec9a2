//! The journal of a run: a file of lines through which the processes of the run report to the process that asked for
//! it.

use crate::report::{Report, printable};
use crate::rules::Rule;
use std::cell::RefCell;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// The journal, written by the worker, which runs the library, and by its supervisor.
pub(super) struct Journal(RefCell<File>);

impl Journal {
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        File::options().append(true).create(true).open(path).map(|file| Self(RefCell::new(file)))
    }

    fn line(&self, kind: &str, text: &str) {
        // Each line is one write, so that it is kept if the process crashes next. An error, such as a full disk, cannot
        // be reported.
        let _ = self.0.borrow_mut().write_all(format!("{kind}\t{}\n", printable(text)).as_bytes());
    }

    /// Records the stage that begins now.
    pub(super) fn at(&self, stage: &str) {
        self.line("at", stage);
    }

    pub(super) fn finding(&self, rule: Rule, message: &str) {
        self.line(rule.id(), message);
    }

    pub(super) fn note(&self, note: &str) {
        self.line("note", note);
    }

    /// Records that the worker has ended regularly.
    pub(super) fn done(&self) {
        self.line("done", "");
    }
}

/// Progress of a worker.
pub(super) struct State {
    /// The stage that began last.
    pub(super) stage: String,
    pub(super) done: bool,
}

/// The text of a journal; empty if there is no journal yet.
pub(super) fn text(path: &Path) -> String {
    String::from_utf8_lossy(&fs::read(path).unwrap_or_default()).into_owned()
}

pub(super) fn state(text: &str) -> State {
    let stage = text.lines().rev().find_map(|line| line.strip_prefix("at\t"));
    State {
        stage: stage.unwrap_or("the start of the process").to_owned(),
        done: text.lines().any(|line| line.starts_with("done\t")),
    }
}

/// Adds the findings and notes of a journal about `library` to the report.
pub(super) fn report(text: &str, library: &str, report: &mut Report) {
    for (kind, text) in text.lines().filter_map(|line| line.split_once('\t')) {
        if kind == "note" {
            report.note(text);
        } else if let Some(rule) = Rule::named(kind) {
            report.add(rule, library, text);
        }
    }
}
