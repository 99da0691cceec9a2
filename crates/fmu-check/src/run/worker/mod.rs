//! The worker: the process that runs a library. It makes a plain run, repeats the run in other ways, and makes many
//! instances.

mod course;
mod creation;
mod experiment;
mod growth;
mod library;
mod location;
mod plan;
mod repetition;
mod starts;

use super::journal::Journal;
use super::process;
use crate::description::Description;
use crate::report::Report;
use crate::rules::Rule;
use crate::xml;
use library::{Library, Refused, heard};
use location::uri;
use plan::Plan;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Runs `library` of the FMU that is unpacked in `folder` and writes the findings into the journal. Returns `None` if
/// the run ended early, after the reason has been written.
pub(super) fn run(
    folder: &Path,
    library: &str,
    timeout: Duration,
    journal: &Journal,
) -> Option<()> {
    let fmu = folder.join("fmu");
    let description = std::fs::read(fmu.join(xml::PATH)).ok()?;
    let root = xml::read(&description, &mut Report::default())?;
    let plan = Plan::new(&Description::new(&root));
    process::limit(timeout);
    let path = fmu.join(library);
    let subject = Subject { fmu, path, plan, journal };
    let library = subject.load()?;
    subject.answers(&library);
    subject.refusals(&library);
    let first = subject.plain(&library).ok()?;
    if subject.plan.once_per_process {
        journal.note(
            "canBeInstantiatedOnlyOncePerProcess is true: checks that need a second instance are left out",
        );
        return Some(());
    }
    subject.repeated(&library, &first);
    subject.other_beginnings(&library);
    journal.at("unloading of the library");
    drop(library);
    growth::watch(&subject, timeout / 4);
    Some(())
}

/// An FMU whose library is run.
struct Subject<'a> {
    /// Folder in which the FMU is unpacked.
    fmu: PathBuf,
    /// Path of the library.
    path: PathBuf,
    plan: Plan,
    journal: &'a Journal,
}

/// A call failed and has been reported; the run cannot continue.
struct ReportedFailure;

impl Subject<'_> {
    fn load(&self) -> Option<Library> {
        self.journal.at("loading of the library");
        match Library::load(&self.path) {
            Ok(library) => Some(library),
            Err(error) => {
                let error = error.replace(&format!("{}/", self.fmu.display()), "");
                self.journal.finding(Rule::Load, &format!("cannot be loaded: {error}"));
                None
            }
        }
    }

    fn answers(&self, library: &Library) {
        for (rule, name, right) in [
            (Rule::TypesPlatform, "fmi2GetTypesPlatform", "default"),
            (Rule::Version, "fmi2GetVersion", "2.0"),
        ] {
            self.journal.at(name);
            let answer = library.answer(name);
            if answer != right {
                let message = format!("{name} returns {answer}; FMI 2.0 requires \"{right}\"");
                self.journal.finding(rule, &message);
            }
        }
    }

    /// Reports a call that failed.
    fn called<T>(&self, name: &str, result: Result<T, Refused>) -> Result<T, ReportedFailure> {
        result.map_err(|refused| {
            let message = format!("{name} returns {refused}{}", said());
            self.journal.finding(Rule::CallFailed, &message);
            ReportedFailure
        })
    }

    /// The folder of the FMU's resources.
    fn resources(&self) -> PathBuf {
        self.fmu.join("resources")
    }

    /// The location of the resources in the form that most importers use.
    fn location(&self) -> String {
        uri(&self.resources(), "///")
    }
}

/// Text that quotes the last message of the library to its logger; empty if there is none.
fn said() -> String {
    let heard = heard();
    if heard.is_empty() { String::new() } else { format!("; its last log message: {heard}") }
}
