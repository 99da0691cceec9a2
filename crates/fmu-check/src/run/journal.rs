//! What the processes of a run tell the one that asked for it: a file of lines.

use crate::report::{Report, printable};
use crate::rules::Rule;
use std::cell::RefCell;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// Written by the worker, which runs the library, and by its supervisor.
pub(super) struct Journal(RefCell<File>);

impl Journal {
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        File::options().append(true).create(true).open(path).map(|file| Self(RefCell::new(file)))
    }

    fn line(&self, kind: &str, text: &str) {
        // One write a line: whatever happens next, it is there. Nobody is left to tell of a full disk.
        let _ = self.0.borrow_mut().write_all(format!("{kind}\t{}\n", printable(text)).as_bytes());
    }

    /// What comes next.
    pub(super) fn at(&self, stage: &str) {
        self.line("at", stage);
    }

    pub(super) fn finding(&self, rule: Rule, message: &str) {
        self.line(rule.id(), message);
    }

    pub(super) fn note(&self, note: &str) {
        self.line("note", note);
    }

    /// The worker has come to its end.
    pub(super) fn done(&self) {
        self.line("done", "");
    }
}

/// How far a worker is.
pub(super) struct State {
    /// The last stage that was begun.
    pub(super) stage: String,
    pub(super) done: bool,
}

/// What a journal says; nothing where there is none yet.
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

/// Puts what a journal says of `library` into the report.
pub(super) fn report(text: &str, library: &str, report: &mut Report) {
    for (kind, text) in text.lines().filter_map(|line| line.split_once('\t')) {
        if kind == "note" {
            report.note(text);
        } else if let Some(rule) = Rule::named(kind) {
            report.add(rule, library, text);
        }
    }
}
