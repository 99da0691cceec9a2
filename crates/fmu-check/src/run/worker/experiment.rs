//! The run of an instance from its creation to its last step, as every host makes it, and the comparison of two runs.

use super::library::{Arguments, Instance, Library, Refused, Value, function, heard};
use super::plan::{Plan, Variable};
use super::{Ended, Subject, said};
use crate::rules::Rule;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::time::Duration;

/// Values of all outputs after each step.
pub(super) type OutputHistory = Vec<Vec<Value>>;

impl Subject<'_> {
    /// The arguments with which most hosts instantiate.
    pub(super) fn arguments<'a>(&'a self, location: &'a str) -> Arguments<'a> {
        Arguments { guid: &self.plan.guid, location, memory_callbacks: true, logging: false }
    }

    pub(super) fn instance<'a>(&self, library: &'a Library) -> Result<Instance<'a>, Ended> {
        let location = self.location();
        self.instance_with(library, &self.arguments(&location))
    }

    pub(super) fn instance_with<'a>(
        &self,
        library: &'a Library,
        arguments: &Arguments<'_>,
    ) -> Result<Instance<'a>, Ended> {
        heard();
        let with = if arguments.logging { " with logging on" } else { "" };
        self.at(&format!("fmi2Instantiate{with}"));
        library.instantiate(arguments).ok_or_else(|| {
            let guid = arguments.guid;
            let message =
                format!("fmi2Instantiate{with} returns NULL for the guid {guid}{}", said());
            self.journal.finding(Rule::Instantiate, &message);
            Ended::Failed
        })
    }

    pub(super) fn initialize(&self, instance: &Instance<'_>) -> Result<(), Ended> {
        self.enter_initialization(instance)?;
        self.exit_initialization(instance)
    }

    pub(super) fn enter_initialization(&self, instance: &Instance<'_>) -> Result<(), Ended> {
        let Plan { tolerance, start, stop, .. } = self.plan;
        self.at("fmi2SetupExperiment");
        self.called("fmi2SetupExperiment", instance.setup(tolerance, start, stop))?;
        self.at("fmi2EnterInitializationMode");
        self.called("fmi2EnterInitializationMode", instance.enter_initialization())
    }

    pub(super) fn exit_initialization(&self, instance: &Instance<'_>) -> Result<(), Ended> {
        self.at("fmi2ExitInitializationMode");
        self.called("fmi2ExitInitializationMode", instance.exit_initialization())
    }

    /// Makes the run of a new instance.
    pub(super) fn fresh(&self, library: &Library) -> Result<OutputHistory, Ended> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.steps(&instance, 0, self.plan.steps)
    }

    /// Makes the run of a new instance; `None` if it cannot be compared.
    pub(super) fn reference(&self, library: &Library) -> Result<Option<OutputHistory>, Ended> {
        let first = self.fresh(library)?;
        Ok(self.is_first_run(&first).then_some(first))
    }

    /// `true` if a run from the start gave what the first trial's gave in another process. Otherwise the model is random
    /// by intent, or an output is an address of memory, and runs are not compared.
    pub(super) fn is_first_run(&self, history: &OutputHistory) -> bool {
        self.journal.is_first_run(fingerprint(history))
    }

    /// `true` if the outputs of a new instance are still those of the first trial in another second: a model may be
    /// random with the time as its seed.
    pub(super) fn is_first_run_later(&self, library: &Library) -> Result<bool, Ended> {
        const SECOND: Duration = Duration::from_millis(1100);
        if self.plan.abilities.once_per_process {
            return Ok(true);
        }
        std::thread::sleep(SECOND);
        Ok(self.reference(library)?.is_some())
    }

    /// Makes a call whose stage is told with more `words`. Returns the name of a call that failed, and its answer.
    pub(super) fn staged(
        &self,
        name: &str,
        words: &str,
        call: impl FnOnce() -> Result<(), Refused>,
    ) -> Result<(), (String, Refused)> {
        self.at(&format!("{name}{words}"));
        call().map_err(|refused| (name.to_owned(), refused))
    }

    /// Steps from one communication point to another. Returns the outputs after each step.
    pub(super) fn steps(
        &self,
        instance: &Instance<'_>,
        from: u32,
        to: u32,
    ) -> Result<OutputHistory, Ended> {
        let mut history = OutputHistory::new();
        for number in from..to {
            self.step(instance, self.time(number), self.plan.step)?;
            history.push(self.read(instance, &self.plan.outputs)?);
        }
        Ok(history)
    }

    /// The communication point at which a step begins.
    pub(super) fn time(&self, number: u32) -> f64 {
        self.plan.start + f64::from(number) * self.plan.step
    }

    /// Makes one step.
    pub(super) fn step(&self, instance: &Instance<'_>, time: f64, step: f64) -> Result<(), Ended> {
        let name = format!("fmi2DoStep at {time} s");
        self.at(&name);
        match instance.step(time, step) {
            Err(refused) if refused.is_no_step() => {
                self.journal.note(&format!("{name} returns {refused}: runs end there"));
                Err(Ended::NoStep)
            }
            result => self.called(&name, result),
        }
    }

    /// Reads variables that are in the order of their types, with one call for each type.
    pub(super) fn read(
        &self,
        instance: &Instance<'_>,
        variables: &[Variable],
    ) -> Result<Vec<Value>, Ended> {
        let mut values = Vec::with_capacity(variables.len());
        for variables in by_type(variables) {
            let kind = variables[0].kind;
            self.at(&function("Get", kind));
            match instance.read(kind, &references(variables)) {
                Ok(read) => values.extend(read),
                Err(refused) => return Err(self.unreadable(instance, variables, refused)),
            }
        }
        Ok(values)
    }

    /// Reports that variables cannot be read, with the first that cannot be read alone.
    fn unreadable(
        &self,
        instance: &Instance<'_>,
        variables: &[Variable],
        refused: Refused,
    ) -> Ended {
        let said = said();
        let cannot = |variable: &&Variable| {
            instance.read(variable.kind, &[variable.reference]).is_err_and(|alone| alone == refused)
        };
        let which = match (variables, variables.iter().find(cannot)) {
            ([variable], _) | (_, Some(variable)) => variable.name.clone(),
            _ => format!("{} variables", variables.len()),
        };
        let name = function("Get", variables[0].kind);
        let message = format!("{name} of {which} returns {refused}{said}");
        self.journal.finding(Rule::CallFailed, &message);
        Ended::Failed
    }

    /// Reports an output that is not finite in a run, which `run` describes; `times` are those after the steps.
    pub(super) fn finite(
        &self,
        history: &OutputHistory,
        times: impl Iterator<Item = f64>,
        run: &str,
    ) {
        for (values, time) in history.iter().zip(times) {
            for (output, value) in self.plan.outputs.iter().zip(values) {
                if value.real().is_some_and(|value| !value.is_finite()) {
                    let name = &output.name;
                    let message = format!("the output {name} is {value} at {time} s{run}");
                    self.journal.finding(Rule::OutputNotFinite, &message);
                    return;
                }
            }
        }
    }

    /// Describes in words the first place where the values of a run are not the `same` as those `wanted`.
    pub(super) fn difference(
        &self,
        wanted: &[Vec<Value>],
        run: &[Vec<Value>],
        same: impl Fn(&Value, &Value) -> bool,
    ) -> Option<String> {
        for (step, (wanted, found)) in (1..).zip(wanted.iter().zip(run)) {
            for (output, (wanted, found)) in self.plan.outputs.iter().zip(wanted.iter().zip(found))
            {
                if !same(wanted, found) {
                    let name = &output.name;
                    return Some(format!(
                        "{name} is {found} after step {step} instead of {wanted}"
                    ));
                }
            }
        }
        None
    }
}

/// A number that only equal outputs share, in every process.
pub(super) fn fingerprint(history: &OutputHistory) -> u64 {
    let mut hasher = DefaultHasher::new();
    for value in history.iter().flatten() {
        match value.real() {
            // Zero has two signs, and NaN many bits, which are the same for a host.
            Some(value) if value.is_nan() => f64::NAN.to_bits().hash(&mut hasher),
            Some(value) => (value + 0.0).to_bits().hash(&mut hasher),
            None => value.to_string().hash(&mut hasher),
        }
    }
    hasher.finish()
}

/// Parts of variables of one type each.
pub(super) fn by_type(variables: &[Variable]) -> impl Iterator<Item = &[Variable]> {
    variables.chunk_by(|one, next| one.kind.base() == next.kind.base())
}

pub(super) fn references(variables: &[Variable]) -> Vec<u32> {
    variables.iter().map(|variable| variable.reference).collect()
}
