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
mod plain;
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
    let description = std::fs::read(fmu.join(xml::PATH)).ok();
    let root = description.and_then(|text| xml::read(&text, &mut Report::default()));
    let Some(root) = root else {
        journal.note("the library is not tried: the unpacked model description cannot be read");
        return None;
    };
    let plan = Plan::new(&Description::new(&root));
    process::limit(timeout);
    let path = fmu.join(library);
    let stage = RefCell::new(Stage {
        name: "the start of the process".to_owned(),
        host: HostSettings::read(),
    });
    let subject = Subject { fmu, path, plan, journal, stage };
    if !subject.applies(trial) {
        return Some(());
    }
    // A model that is random by intent may use this generator without a seed of its own. Runs of two processes then differ.
    library::seed(trial as u32 + 1);
    let library = subject.load()?;
    match subject.make(trial, library, timeout) {
        Ok(()) | Err(Ended::NoStep) => Some(()),
        Err(Ended::Failed) => None,
    }
}

/// An FMU whose library is run.
struct Subject<'a> {
    /// Folder in which the FMU is unpacked.
    fmu: PathBuf,
    /// Path of the library.
    path: PathBuf,
    plan: Plan,
    journal: &'a Journal,
    stage: RefCell<Stage>,
}

/// The present stage.
struct Stage {
    name: String,
    /// The host's settings at its begin.
    host: HostSettings,
}

/// Why a trial cannot continue.
enum Ended {
    /// A call failed and has been reported.
    Failed,
    /// The library did not complete a step, or refused one with other values of inputs, as it may.
    NoStep,
}

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
            Trial::Derivatives | Trial::Directions => can.directional_derivatives,
            Trial::OutputDerivatives => {
                can.output_derivatives && !self.plan.continuous_outputs().is_empty()
            }
            Trial::InputDerivatives => can.interpolates_inputs,
            _ => true,
        }
    }

    fn make(&self, trial: Trial, library: Library, timeout: Duration) -> Result<(), Ended> {
        let result = match trial {
            Trial::Plain => self.plain(&library),
            Trial::FreeNull => {
                self.free_null(&library);
                Ok(())
            }
            Trial::WrongGuid => {
                self.wrong_guid(&library);
                Ok(())
            }
            Trial::OneSlash => self.one_slash(&library),
            #[cfg(unix)]
            Trial::Space => self.space(&library),
            Trial::NullCallbacks => self.null_callbacks(&library),
            Trial::ResetNew => self.reset_new(&library),
            Trial::Reset => self.resets(&library),
            Trial::Variables => self.variables(&library),
            Trial::Inputs => self.changed_inputs(&library),
            Trial::Steps => self.varied_steps(&library),
            Trial::Instances => self.instances(&library),
            Trial::States => self.states(&library),
            Trial::Derivatives => self.directional_derivatives(&library),
            Trial::Directions => self.directions(&library),
            Trial::OutputDerivatives => self.output_derivatives(&library),
            Trial::InputDerivatives => self.input_derivatives(&library),
            Trial::Logging => self.logging(&library),
            #[cfg(unix)]
            Trial::Arrays => self.arrays(&library),
            #[cfg(not(unix))]
            Trial::Space | Trial::Arrays => Ok(()),
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
        stage.clone_into(&mut self.stage.borrow_mut().name);
        self.journal.at(stage);
    }

    /// Records the stage that begins now, as [`at`](Self::at) does, and the rule that a crash in it breaks.
    fn at_risk(&self, rule: Rule, stage: &str) {
        self.at(stage);
        self.journal.risk(rule);
    }

    fn compare_host(&self) {
        let now = HostSettings::read();
        let Stage { name: stage, host: before } = &mut *self.stage.borrow_mut();
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
        for ((name, now), (_, before)) in now.named.iter().zip(&before.named) {
            if now != before {
                let message =
                    format!("{stage} changes {name} of the process from {before} to {now}");
                self.journal.finding(Rule::ProcessSettings, &message);
            }
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

    /// Reports a call that failed.
    fn called<T>(&self, name: &str, result: Result<T, Refused>) -> Result<T, Ended> {
        result.map_err(|refused| {
            let message = format!("{name} returns {refused}{}", said());
            self.journal.finding(Rule::CallFailed, &message);
            Ended::Failed
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
