//! Reading and setting of all variables in the phases that allow it.

use super::experiment::{by_type, references};
use super::library::{Instance, Library, Refused, Value, function, heard};
use super::plan::{Plan, Role, Variable};
use super::{Ended, Subject, said};
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
    /// `true` if variables were left out for want of instances.
    is_cut: bool,
    /// Names of the variables with a finding, which is told of one phase.
    told: Vec<String>,
}

impl Subject<'_> {
    /// Reads all variables, then sets those that can be set to other values and reads these back.
    pub(super) fn variables(&self, library: &Library) -> Result<(), Ended> {
        self.run_once(library)?;
        if self.plan.abilities.once_per_process {
            return Ok(());
        }
        let settable = self.plan.variables.iter().filter(|variable| variable.other.is_some());
        let settable: Vec<Variable> = settable.cloned().collect();
        let mut told = Vec::new();
        for (phase, when) in Phase::ALL {
            let is_tried =
                |variable: &&Variable| phase.allows(variable) && !told.contains(&variable.name);
            let mut group: Vec<Variable> = settable.iter().filter(is_tried).cloned().collect();
            // A library that changes one value with another shows it in one of two orders.
            if phase == Phase::Initialization {
                group.reverse();
            }
            let room = MOST_INSTANCES;
            let mut search = Search { phase, when, room, is_cut: false, told: Vec::new() };
            self.set(library, &group, &mut search);
            told.extend(search.told);
            if search.is_cut {
                let note = format!(
                    "other values are refused {when}: after {MOST_INSTANCES} instances, or as many as the library allows, no more are tried"
                );
                self.journal.note(&note);
            }
        }
        Ok(())
    }

    /// Makes a short run in which all variables are read.
    pub(super) fn run_once(&self, library: &Library) -> Result<(), Ended> {
        const STEPS: u32 = 3;
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let values = self.read(&instance, &self.plan.variables)?;
        self.compare_starts(&values);
        for number in 0..self.plan.steps.min(STEPS) {
            self.step(&instance, self.time(number), self.plan.step)?;
            self.read(&instance, &self.plan.variables)?;
        }
        self.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())
    }

    /// Compares the values of all variables after the initialization with their start values. Inputs, parameters and
    /// constants are changed by hosts alone.
    fn compare_starts(&self, values: &[Value]) {
        for (variable, found) in self.plan.variables.iter().zip(values) {
            let is_exact = variable.role.keeps_value() || variable.role == Role::Constant;
            let Some(start) = variable.start.as_ref().filter(|_| is_exact) else { continue };
            if !start.agrees_with(found) {
                let name = &variable.name;
                let message = format!(
                    "{name} is {found} after initialization, but its start value is {start}"
                );
                self.journal.finding(Rule::StartDiffers, &message);
            }
        }
    }

    /// Sets variables of a group together; if that is refused, those of each half, down to single ones.
    fn set(&self, library: &Library, group: &[Variable], search: &mut Search) {
        if group.is_empty() {
            return;
        }
        let instance = search.room.checked_sub(1).and_then(|room| {
            search.room = room;
            self.at("fmi2Instantiate");
            let location = self.location();
            library.instantiate(&self.arguments(&location))
        });
        // The library has made instances before: if it makes no more, it has a limit.
        let Some(instance) = instance else {
            search.is_cut = true;
            return;
        };
        heard();
        let Err((call, refused)) = self.attempt(&instance, group, search) else { return };
        let said = said();
        drop(instance);
        if let [variable] = group {
            let (name, when) = (&variable.name, search.when);
            if !refused.is_fatal() && !said.is_empty() {
                return;
            }
            let (rule, no_reason) = if refused.is_fatal() {
                (Rule::CallFailed, "")
            } else {
                (Rule::RefusalSilent, ", and the logger is told no reason")
            };
            let message = format!(
                "{call} returns {refused} with another value of {name} set {when}{no_reason}{said}"
            );
            self.journal.finding(rule, &message);
            search.told.push(name.clone());
        } else {
            let (one, other) = group.split_at(group.len() / 2);
            self.set(library, one, search);
            self.set(library, other, search);
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
        let words = format!(", other values set {when}");
        let calls =
            |name: &str, call: &dyn Fn() -> Result<(), Refused>| self.staged(name, &words, call);
        // Returns the variables whose other values were accepted without a warning.
        let set = || {
            let mut accepted = Vec::new();
            for variables in by_type(group) {
                instance.has_warned();
                let name = function("Set", variables[0].kind);
                calls(&name, &|| instance.write(&others(variables)))?;
                if !instance.has_warned() {
                    let kept = variables.iter().filter(|variable| variable.role.keeps_value());
                    accepted.extend(kept.cloned());
                }
            }
            Ok(accepted)
        };
        let mut accepted = Vec::new();
        calls("fmi2SetupExperiment", &|| instance.setup(tolerance, start, stop))?;
        if phase == Phase::Before {
            accepted = set()?;
        }
        calls("fmi2EnterInitializationMode", &|| instance.enter_initialization())?;
        if phase == Phase::Initialization {
            accepted = set()?;
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
            accepted = set()?;
        } else {
            self.read_back(instance, &accepted, when)?;
        }
        match calls("fmi2DoStep", &|| instance.step(time, step)) {
            Err((_, refused)) if refused.is_no_step() => Ok(()),
            Err(refused) => Err(refused),
            Ok(()) => self.read_back(instance, &accepted, when),
        }
    }

    /// Reports values that were accepted and are not kept.
    fn read_back(
        &self,
        instance: &Instance<'_>,
        accepted: &[Variable],
        when: &str,
    ) -> Result<(), (String, Refused)> {
        for variables in by_type(accepted) {
            let name = function("Get", variables[0].kind);
            self.at(&format!("{name}, other values set {when}"));
            let read = instance.read(variables[0].kind, &references(variables));
            let found = read.map_err(|refused| (name, refused))?;
            for (variable, found) in variables.iter().zip(found) {
                let Some(other) = &variable.other else { continue };
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

/// Other values of variables, by reference.
pub(super) fn others(variables: &[Variable]) -> Vec<(u32, &Value)> {
    variables
        .iter()
        .filter_map(|variable| Some((variable.reference, variable.other.as_ref()?)))
        .collect()
}
