//! The run of an instance from its creation to its last step, as every host makes it, and the comparison of two runs.

use super::library::{Instance, Library, Refused, Value, function, heard};
use super::plan::{Plan, Variable};
use super::{ReportedFailure, Subject, said};
use crate::rules::Rule;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

/// Values of all outputs after each step.
pub(super) type OutputHistory = Vec<Vec<Value>>;

impl Subject<'_> {
    pub(super) fn instance<'a>(
        &self,
        library: &'a Library,
    ) -> Result<Instance<'a>, ReportedFailure> {
        heard();
        self.at("fmi2Instantiate");
        let guid = &self.plan.guid;
        library.instantiate(guid, &self.location(), true, false).ok_or_else(|| {
            let message = format!("fmi2Instantiate returns NULL for the guid {guid}{}", said());
            self.journal.finding(Rule::Instantiate, &message);
            ReportedFailure
        })
    }

    pub(super) fn initialize(&self, instance: &Instance<'_>) -> Result<(), ReportedFailure> {
        self.enter_initialization(instance)?;
        self.exit_initialization(instance)
    }

    pub(super) fn enter_initialization(
        &self,
        instance: &Instance<'_>,
    ) -> Result<(), ReportedFailure> {
        let Plan { tolerance, start, stop, .. } = self.plan;
        self.at("fmi2SetupExperiment");
        self.called("fmi2SetupExperiment", instance.setup(tolerance, start, stop))?;
        self.at("fmi2EnterInitializationMode");
        self.called("fmi2EnterInitializationMode", instance.enter_initialization())
    }

    pub(super) fn exit_initialization(
        &self,
        instance: &Instance<'_>,
    ) -> Result<(), ReportedFailure> {
        self.at("fmi2ExitInitializationMode");
        self.called("fmi2ExitInitializationMode", instance.exit_initialization())
    }

    /// Steps from one communication point to another. Returns the outputs after each step.
    pub(super) fn steps(
        &self,
        instance: &Instance<'_>,
        from: u32,
        to: u32,
    ) -> Result<OutputHistory, ReportedFailure> {
        let mut history = OutputHistory::new();
        for number in from..to {
            if !self.step(instance, self.time(number), self.plan.step)? {
                break;
            }
            history.push(self.read(instance, &self.plan.outputs)?);
        }
        Ok(history)
    }

    /// The communication point at which a step begins.
    pub(super) fn time(&self, number: u32) -> f64 {
        self.plan.start + f64::from(number) * self.plan.step
    }

    /// Makes one step. Returns `false` if the library does not complete it, which is no fault.
    pub(super) fn step(
        &self,
        instance: &Instance<'_>,
        time: f64,
        step: f64,
    ) -> Result<bool, ReportedFailure> {
        let name = format!("fmi2DoStep at {time} s");
        self.at(&name);
        match instance.step(time, step) {
            Err(refused) if refused.is_no_step() => {
                self.journal.note(&format!("{name} returns {refused}: the run ends there"));
                Ok(false)
            }
            result => self.called(&name, result).map(|()| true),
        }
    }

    /// Reads variables that are in the order of their types, with one call for each type.
    pub(super) fn read(
        &self,
        instance: &Instance<'_>,
        variables: &[Variable],
    ) -> Result<Vec<Value>, ReportedFailure> {
        let mut values = Vec::with_capacity(variables.len());
        for variables in by_type(variables) {
            let (kind, references) = (variables[0].kind, references(variables));
            let name = function("Get", kind);
            self.at(&name);
            match instance.read(kind, &references) {
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
    ) -> ReportedFailure {
        let said = said();
        let name = function("Get", variables[0].kind);
        let cannot = |variable: &&Variable| {
            !refused.is_fatal() && instance.read(variable.kind, &[variable.reference]).is_err()
        };
        let which = match (variables, variables.iter().find(cannot)) {
            ([variable], _) | (_, Some(variable)) => variable.name.clone(),
            _ => format!("{} variables", variables.len()),
        };
        let message = format!("{name} of {which} returns {refused}{said}");
        self.journal.finding(Rule::CallFailed, &message);
        ReportedFailure
    }

    pub(super) fn finite(&self, history: &OutputHistory) {
        for (step, values) in (1..).zip(history) {
            for (output, value) in self.plan.outputs.iter().zip(values) {
                if value.real().is_some_and(|value| !value.is_finite()) {
                    let (name, time) = (&output.name, self.time(step));
                    let message = format!("the output {name} is {value} at {time} s");
                    self.journal.finding(Rule::OutputNotFinite, &message);
                    return;
                }
            }
        }
    }

    /// Describes the first difference between a run and the first run in words; `None` if a host sees no difference.
    pub(super) fn difference(&self, first: &[Vec<Value>], other: &[Vec<Value>]) -> Option<String> {
        for (step, (first, other)) in (1..).zip(first.iter().zip(other)) {
            for (output, (first, other)) in self.plan.outputs.iter().zip(first.iter().zip(other)) {
                if !first.is_same(other) {
                    let name = &output.name;
                    return Some(format!(
                        "{name} is {other} after step {step}, but was {first} in the first run"
                    ));
                }
            }
        }
        let (first, other) = (first.len(), other.len());
        (first != other)
            .then(|| format!("{other} steps are completed, but were {first} in the first run"))
    }
}

/// A number that only equal outputs share, in every process.
pub(super) fn fingerprint(history: &OutputHistory) -> u64 {
    let mut hasher = DefaultHasher::new();
    for value in history.iter().flatten() {
        match value.real() {
            Some(value) => value.to_bits().hash(&mut hasher),
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
