//! The process that runs a library: a plain run, the same run after other beginnings, and many instances.

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

/// Runs `library` of the FMU that is unpacked in `folder`; what comes of it goes into the journal. None where it
/// ended early, which has been told.
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
        journal.note("only one instance may be made: no other runs, and memory is not watched");
        return Some(());
    }
    subject.repeated(&library, &first);
    subject.other_beginnings(&library);
    journal.at("unloading it");
    drop(library);
    growth::watch(&subject, timeout / 4);
    Some(())
}

/// An FMU whose library is run.
struct Subject<'a> {
    /// The folder that it is unpacked in.
    fmu: PathBuf,
    /// Its library.
    path: PathBuf,
    plan: Plan,
    journal: &'a Journal,
}

/// A call that failed has been told; there is nothing to go on with.
struct Told;

impl Subject<'_> {
    fn load(&self) -> Option<Library> {
        self.journal.at("loading it");
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
                self.journal.finding(rule, &format!("{name} answers {answer}, not {right}"));
            }
        }
    }

    /// Tells of a call that failed.
    fn called<T>(&self, name: &str, result: Result<T, Refused>) -> Result<T, Told> {
        result.map_err(|refused| {
            let message = format!("{name} answers {refused}{}", said());
            self.journal.finding(Rule::CallFailed, &message);
            Told
        })
    }

    /// The folder of the resources.
    fn resources(&self) -> PathBuf {
        self.fmu.join("resources")
    }

    /// That folder as importers mostly write it.
    fn location(&self) -> String {
        uri(&self.resources(), "///")
    }
}

/// What the library said of it to its logger.
fn said() -> String {
    let heard = heard();
    if heard.is_empty() { String::new() } else { format!(" and says: {heard}") }
}
