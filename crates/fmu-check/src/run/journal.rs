//! The journal of a run: a file of lines through which the processes of the run report to the process that asked for
//! it.

use super::trial::Trial;
use crate::report::{Report, printable};
use crate::rules::Rule;
use std::cell::RefCell;
use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The journal, written by the supervisor and by the workers, which run the library.
pub(super) struct Journal {
    file: RefCell<File>,
    path: PathBuf,
}

impl Journal {
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let file = File::options().append(true).create(true).open(path)?;
        Ok(Self { file: RefCell::new(file), path: path.to_owned() })
    }

    /// Returns the text that all processes have written so far.
    pub(super) fn text(&self) -> String {
        text(&self.path)
    }

    fn line(&self, kind: &str, text: &str) {
        // Each line is one write, so that it is kept if the process crashes next. An error, such as a full disk, cannot
        // be reported.
        let _ =
            self.file.borrow_mut().write_all(format!("{kind}\t{}\n", printable(text)).as_bytes());
    }

    /// Records the stage that begins now.
    pub(super) fn at(&self, stage: &str) {
        self.line("at", stage);
    }

    /// Records that a crash in the present stage breaks this rule.
    pub(super) fn risk(&self, rule: Rule) {
        self.line("risk", rule.id());
    }

    /// Records the trial that begins now.
    pub(super) fn trial(&self, trial: Trial) {
        self.line("trial", &format!("{trial:?}"));
    }

    pub(super) fn finding(&self, rule: Rule, message: &str) {
        self.line(rule.id(), message);
    }

    pub(super) fn note(&self, note: &str) {
        self.line("note", note);
    }

    /// Records what the first run gave, as a number that only equal outputs share.
    pub(super) fn first_run(&self, outputs: u64) {
        self.line(FIRST_RUN, &outputs.to_string());
    }

    /// `true` if the first run, which another process made, gave these outputs.
    pub(super) fn is_first_run(&self, outputs: u64) -> bool {
        self.text().lines().any(|line| line == format!("{FIRST_RUN}\t{outputs}"))
    }

    /// Records that a trial was made to its end.
    pub(super) fn made(&self) {
        self.line("made", "");
    }

    /// Records that the worker has ended regularly.
    pub(super) fn done(&self) {
        self.line("done", "");
    }
}

const FIRST_RUN: &str = "first run";

/// Progress of a trial.
pub(super) struct State {
    /// The stage that began last.
    pub(super) stage: String,
    /// The rule that a crash in this stage breaks.
    pub(super) rule: Rule,
    /// `true` if the trial came to its end.
    pub(super) made: bool,
    /// `true` if the worker has ended regularly, if only after a failed call.
    pub(super) done: bool,
}

/// The text of a journal; empty if there is no journal yet.
pub(super) fn text(path: &Path) -> String {
    String::from_utf8_lossy(&fs::read(path).unwrap_or_default()).into_owned()
}

/// Returns the progress of the last trial in a journal.
pub(super) fn state(text: &str) -> State {
    let mut state = State {
        stage: "the start of the process".to_owned(),
        rule: Rule::Crash,
        made: false,
        done: false,
    };
    let lines = text.lines().rev().take_while(|line| !line.starts_with("trial\t"));
    for (kind, text) in Vec::from_iter(lines).iter().rev().filter_map(|line| line.split_once('\t'))
    {
        match kind {
            "at" => (state.stage, state.rule) = (text.to_owned(), Rule::Crash),
            "risk" => state.rule = Rule::named(text).unwrap_or(Rule::Crash),
            "made" => state.made = true,
            "done" => state.done = true,
            _ => {}
        }
    }
    state
}

/// Rules whose findings in several trials have one cause, if in other words.
const TOLD_ONCE: [Rule; 7] = [
    Rule::Prints,
    Rule::LeavesProcesses,
    Rule::WritesFiles,
    Rule::OutputNotFinite,
    Rule::SignalHandlers,
    Rule::FloatingPointMode,
    Rule::ProcessSettings,
];

/// Adds the findings and notes of a journal about `library` to the report. What several trials find is told once.
pub(super) fn report(text: &str, library: &str, report: &mut Report) {
    let mut told = HashSet::new();
    let mut trial = "";
    let mut has_result = false;
    for (kind, text) in text.lines().filter_map(|line| line.split_once('\t')) {
        if kind == "trial" {
            trial = text;
        }
        // A library may run otherwise under valgrind; only what valgrind says of it counts.
        let rule =
            Rule::named(kind).filter(|rule| trial != "Valgrind" || *rule == Rule::MemoryErrors);
        let is_told_once = rule.is_some_and(|rule| TOLD_ONCE.contains(&rule));
        if !told.insert((kind, if is_told_once { "" } else { text })) {
            continue;
        }
        has_result |= kind == "made" || rule.is_some();
        if kind == "note" {
            report.note(text);
        } else if let Some(rule) = rule {
            report.add(rule, library, text);
        }
    }
    if !has_result {
        report.note(
            "the run has left no result: the library may have removed files that are not its own",
        );
    }
}
