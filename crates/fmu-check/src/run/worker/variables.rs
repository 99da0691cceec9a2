//! Reading and setting of all variables in the phases that allow it.

use super::experiment::{by_type, references};
use super::library::{Instance, Library, Refused, function, heard};
use super::plan::{Plan, Role, Variable};
use super::{ReportedFailure, Subject, said};
use crate::rules::Rule;

/// Limit of the instances that one phase takes. Some libraries allow no more than 50 in a process.
const MOST_INSTANCES: u32 = 12;

/// A phase in which variables are set.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    Before,
    Initialization,
    Run,
}

impl Phase {
    const ALL: [(Self, &'static str); 3] = [
        (Self::Before, "before the initialization"),
        (Self::Initialization, "in the initialization"),
        (Self::Run, "after the first step"),
    ];

    /// `true` if FMI 2.0 allows that a host sets the variable in this phase.
    fn allows(self, variable: &Variable) -> bool {
        match self {
            // Inputs have no `initial`, which the standard asks for here.
            Self::Before => variable.role != Role::Input,
            Self::Initialization => true,
            Self::Run => matches!(variable.role, Role::Input | Role::Tunable),
        }
    }
}

/// A search for the variables of a phase whose other values are refused.
struct Search {
    phase: Phase,
    /// The phase in words.
    when: &'static str,
    /// Number of instances that may still be made.
    room: u32,
    /// Names of the variables that were refused without a word to the logger.
    silent: Vec<String>,
}

impl Subject<'_> {
    /// Reads all variables, then sets those that can be set to other values and reads these back.
    pub(super) fn variables(&self, library: &Library) -> Result<(), ReportedFailure> {
        self.run_once(library)?;
        let settable = self.plan.variables.iter().filter(|variable| variable.other.is_some());
        let settable: Vec<Variable> = settable.cloned().collect();
        let mut silent = Vec::new();
        for (phase, when) in Phase::ALL {
            let is_tried =
                |variable: &&Variable| phase.allows(variable) && !silent.contains(&variable.name);
            let group: Vec<Variable> = settable.iter().filter(is_tried).cloned().collect();
            let mut search = Search { phase, when, room: MOST_INSTANCES, silent: Vec::new() };
            self.set(library, &group, &mut search)?;
            silent.extend(search.silent);
            if search.room == 0 {
                let note = format!(
                    "other values are refused {when}: after {MOST_INSTANCES} instances, or as many as the library allows, no more are tried"
                );
                self.journal.note(&note);
            }
        }
        Ok(())
    }

    /// Makes a short run in which all variables are read.
    pub(super) fn run_once(&self, library: &Library) -> Result<(), ReportedFailure> {
        const STEPS: u32 = 3;
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.read(&instance, &self.plan.variables)?;
        for number in 0..self.plan.steps.min(STEPS) {
            if !self.step(&instance, self.time(number), self.plan.step)? {
                break;
            }
            self.read(&instance, &self.plan.variables)?;
        }
        self.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())
    }

    /// Sets variables of a group together; if that is refused, those of each half, down to single ones.
    fn set(
        &self,
        library: &Library,
        group: &[Variable],
        search: &mut Search,
    ) -> Result<(), ReportedFailure> {
        if group.is_empty() || search.room == 0 {
            return Ok(());
        }
        search.room -= 1;
        let when = search.when;
        self.at("fmi2Instantiate");
        let location = self.location();
        let Some(instance) = library.instantiate(&self.plan.guid, &location, true, false) else {
            // The library has made instances before; it has a limit.
            search.room = 0;
            return Ok(());
        };
        heard();
        let Err((call, refused)) = self.attempt(&instance, group, search) else {
            return Ok(());
        };
        let said = said();
        drop(instance);
        match group {
            [variable] => {
                if said.is_empty() {
                    let name = &variable.name;
                    let message = format!(
                        "{call} returns {refused} with another value of {name} set {when}, and the logger is told no reason"
                    );
                    self.journal.finding(Rule::RefusalSilent, &message);
                    search.silent.push(name.clone());
                }
                Ok(())
            }
            _ => {
                let (one, other) = group.split_at(group.len() / 2);
                self.set(library, one, search)?;
                self.set(library, other, search)
            }
        }
    }

    /// Makes a run with other values of the variables, and reads them back. Returns the call that was refused, as a
    /// library may.
    fn attempt(
        &self,
        instance: &Instance<'_>,
        group: &[Variable],
        search: &Search,
    ) -> Result<(), (String, Refused)> {
        let Search { phase, when, .. } = *search;
        let Plan { tolerance, start, stop, step, .. } = self.plan;
        let calls = |name: &str, call: &dyn Fn() -> Result<(), Refused>| {
            self.at(&format!("{name}, other values set {when}"));
            call().map_err(|refused| (name.to_owned(), refused))
        };
        let set = || {
            group.iter().try_for_each(|variable| {
                let Some(other) = &variable.other else { return Ok(()) };
                let name = function("Set", variable.kind);
                calls(&name, &|| instance.write(variable.reference, other))
            })
        };
        calls("fmi2SetupExperiment", &|| instance.setup(tolerance, start, stop))?;
        if phase == Phase::Before {
            set()?;
        }
        calls("fmi2EnterInitializationMode", &|| instance.enter_initialization())?;
        if phase == Phase::Initialization {
            set()?;
        }
        calls("fmi2ExitInitializationMode", &|| instance.exit_initialization())?;
        // During a run the standard allows reading only once a step has followed the setting, and no step after the last.
        let mut time = start;
        if phase == Phase::Run {
            if self.plan.steps == 1 {
                return Ok(());
            }
            calls("fmi2DoStep", &|| instance.step(start, step))?;
            time = self.time(1);
            set()?;
        } else {
            self.read_back(instance, group, when)?;
        }
        calls("fmi2DoStep", &|| instance.step(time, step))?;
        self.read_back(instance, group, when)
    }

    /// Reports values that were accepted and are not kept.
    fn read_back(
        &self,
        instance: &Instance<'_>,
        group: &[Variable],
        when: &str,
    ) -> Result<(), (String, Refused)> {
        for variables in by_type(group) {
            let name = function("Get", variables[0].kind);
            self.at(&format!("{name}, other values set {when}"));
            let read = instance.read(variables[0].kind, &references(variables));
            let found = read.map_err(|refused| (name, refused))?;
            for (variable, found) in variables.iter().zip(found) {
                let Some(other) = variable.other.as_ref().filter(|_| variable.role.keeps_value())
                else {
                    continue;
                };
                if !other.agrees_with(&found) {
                    let (name, call) = (&variable.name, function("Set", variable.kind));
                    let message = format!(
                        "{name} is {found}, although {call} accepted {other} {when}, and no later call set it"
                    );
                    self.journal.finding(Rule::ValueLost, &message);
                }
            }
        }
        Ok(())
    }
}
