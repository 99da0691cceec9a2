//! The worker: the process that tries a library in one way.

mod creation;
mod derivatives;
mod experiment;
mod growth;
mod inputs;
mod instances;
mod library;
mod location;
mod logging;
mod plan;
mod repetition;
mod variables;

#[cfg(unix)]
mod arrays;

use super::journal::Journal;
use super::process;
use super::trial::Trial;
use crate::description::Description;
use crate::report::Report;
use crate::rules::Rule;
use crate::xml;
use library::{HostSettings, Library, Refused, heard};
use location::uri;
use plan::Plan;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Tries `library` of the FMU that is unpacked in `folder` and writes the findings into the journal. Returns `None` if
/// the trial ended early, after the reason has been written.
pub(super) fn run(
    folder: &Path,
    library: &str,
    trial: Trial,
    timeout: Duration,
    journal: &Journal,
) -> Option<()> {
    let fmu = folder.join("fmu");
    let description = std::fs::read(fmu.join(xml::PATH)).ok()?;
    let root = xml::read(&description, &mut Report::default())?;
    let plan = Plan::new(&Description::new(&root));
    process::limit(timeout);
    let path = fmu.join(library);
    let host = RefCell::new(("the start of the process".to_owned(), HostSettings::read()));
    let subject = Subject { fmu, path, plan, journal, host };
    if !subject.applies(trial) {
        return Some(());
    }
    // A model that is random by intent may use this generator without a seed of its own. Runs of two processes then differ.
    library::seed(trial as u32 + 1);
    let library = subject.load()?;
    subject.make(trial, library, timeout).ok()
}

/// An FMU whose library is run.
struct Subject<'a> {
    /// Folder in which the FMU is unpacked.
    fmu: PathBuf,
    /// Path of the library.
    path: PathBuf,
    plan: Plan,
    journal: &'a Journal,
    /// The present stage, and the host's settings as they were last seen.
    host: RefCell<(String, HostSettings)>,
}

/// A call failed and has been reported; the trial cannot continue.
struct ReportedFailure;

impl Subject<'_> {
    /// `true` if the FMU is to be tried in this way.
    fn applies(&self, trial: Trial) -> bool {
        let can = &self.plan.abilities;
        if can.once_per_process && trial.needs_instances() {
            return false;
        }
        match trial {
            Trial::NullCallbacks => can.needs_no_memory_callbacks,
            Trial::OneSlash | Trial::Space => self.resources().is_dir(),
            Trial::Inputs => self.plan.inputs().any(|input| input.other.is_some()),
            Trial::Steps => can.varies_steps,
            Trial::States => can.saves_states,
            Trial::Derivatives => can.directional_derivatives,
            Trial::OutputDerivatives => {
                can.output_derivatives && !self.plan.real_outputs().is_empty()
            }
            Trial::InputDerivatives => can.interpolates_inputs,
            _ => true,
        }
    }

    fn make(
        &self,
        trial: Trial,
        library: Library,
        timeout: Duration,
    ) -> Result<(), ReportedFailure> {
        let result = match trial {
            Trial::Plain => {
                if self.plan.abilities.once_per_process {
                    self.journal.note(
                        "canBeInstantiatedOnlyOncePerProcess is true: what needs a second instance is not tried",
                    );
                }
                self.answers(&library);
                self.plain(&library)
            }
            Trial::FreeNull => self.free_null(&library),
            Trial::WrongGuid => self.wrong_guid(&library),
            Trial::OneSlash => self.one_slash(&library),
            Trial::Space => self.space(&library),
            Trial::NullCallbacks => self.null_callbacks(&library),
            Trial::Reset => self.resets(&library),
            Trial::Variables => self.variables(&library),
            Trial::Inputs => self.changed_inputs(&library),
            Trial::Steps => self.varied_steps(&library),
            Trial::Instances => self.instances(&library),
            Trial::States => self.states(&library),
            Trial::Derivatives => self.directional_derivatives(&library),
            Trial::OutputDerivatives => self.output_derivatives(&library),
            Trial::InputDerivatives => self.input_derivatives(&library),
            Trial::Logging => self.logging(&library),
            #[cfg(unix)]
            Trial::Arrays => self.arrays(&library),
            #[cfg(not(unix))]
            Trial::Arrays => Ok(()),
            Trial::Memory => {
                drop(library);
                growth::watch(self, timeout / 4);
                return Ok(());
            }
            Trial::Valgrind => self.run_once(&library),
        };
        self.at("unloading of the library");
        drop(library);
        self.at("the end of the process");
        result
    }

    /// Records the stage that begins now, and reports settings of the host that the last stage has changed.
    fn at(&self, stage: &str) {
        self.compare_host();
        self.host.borrow_mut().0 = stage.to_owned();
        self.journal.at(stage);
    }

    /// As [`at`](Self::at), for a stage in which a crash breaks a rule of its own.
    fn at_risk(&self, rule: Rule, stage: &str) {
        self.at(stage);
        self.journal.risk(rule);
    }

    fn compare_host(&self) {
        let now = HostSettings::read();
        let (stage, before) = &mut *self.host.borrow_mut();
        if now.floating_point != before.floating_point {
            let message = format!(
                "{stage} changes how floating point is computed: rounding, denormal numbers or traps (control registers {}, before {})",
                registers(&now),
                registers(before)
            );
            self.journal.finding(Rule::FloatingPointMode, &message);
        }
        let changed = (1..).zip(now.signals.iter().zip(&before.signals));
        let changed: Vec<String> = changed
            .filter(|(_, (now, before))| now != before)
            .map(|(signal, _)| process::signal_name(signal))
            .collect();
        if !changed.is_empty() {
            let message = format!("{stage} changes who handles {}", changed.join(", "));
            self.journal.finding(Rule::SignalHandlers, &message);
        }
        *before = now;
    }

    fn load(&self) -> Option<Library> {
        self.at("loading of the library");
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
            self.at(name);
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

fn registers(host: &HostSettings) -> String {
    host.floating_point
        .map_or("unknown".to_owned(), |(vector, scalar)| format!("{vector:#06x} {scalar:#06x}"))
}

/// Text that quotes the last message of the library to its logger; empty if there is none.
fn said() -> String {
    let heard = heard();
    if heard.is_empty() { String::new() } else { format!("; its last log message: {heard}") }
}
