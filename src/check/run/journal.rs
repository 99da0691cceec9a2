//! What the process that runs a library tells the one that watches it: a file of lines.

use crate::check::report::{Report, printable};
use crate::check::rules::Rule;
use std::cell::RefCell;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Written by the process that runs the library.
pub(super) struct Journal(RefCell<File>);

impl Journal {
    pub(super) fn create(path: &Path) -> io::Result<Self> {
        File::create(path).map(|file| Self(RefCell::new(file)))
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

    /// All is done.
    pub(super) fn done(&self) {
        self.line("done", "");
    }
}

/// What a journal says.
pub(super) struct Told {
    /// The last stage that was begun.
    pub(super) stage: String,
    pub(super) done: bool,
}

/// Reads a journal; its findings are of `library`.
pub(super) fn read(text: &str, library: &str, report: &mut Report) -> Told {
    let mut told = Told { stage: "the start of the process".to_owned(), done: false };
    for line in text.lines() {
        match line.split_once('\t') {
            Some(("at", stage)) => stage.clone_into(&mut told.stage),
            Some(("note", note)) => report.note(note),
            Some(("done", _)) => told.done = true,
            Some((id, message)) => {
                if let Some(rule) = Rule::named(id) {
                    report.add(rule, library, message);
                }
            }
            None => {}
        }
    }
    told
}

/// The stage that a journal in the making has reached.
pub(super) fn stage(text: &str) -> Option<&str> {
    text.lines().rev().find_map(|line| line.strip_prefix("at\t"))
}
