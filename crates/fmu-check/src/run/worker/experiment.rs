//! The run of an instance from its creation to its last step, as every importer does it.

use super::course::OutputHistory;
use super::library::{Instance, Library, heard};
use super::plan::Plan;
use super::{ReportedFailure, Subject, said};
use crate::rules::Rule;

impl Subject<'_> {
    pub(super) fn instance<'a>(
        &self,
        library: &'a Library,
    ) -> Result<Instance<'a>, ReportedFailure> {
        heard();
        self.journal.at("fmi2Instantiate");
        let guid = &self.plan.guid;
        library.instantiate(guid, &self.location(), true).ok_or_else(|| {
            let message = format!("fmi2Instantiate returns NULL for the guid {guid}{}", said());
            self.journal.finding(Rule::Instantiate, &message);
            ReportedFailure
        })
    }

    pub(super) fn initialize(&self, instance: &Instance<'_>) -> Result<(), ReportedFailure> {
        let Plan { tolerance, start, stop, .. } = self.plan;
        self.journal.at("fmi2SetupExperiment");
        self.called("fmi2SetupExperiment", instance.setup(tolerance, start, stop))?;
        self.journal.at("fmi2EnterInitializationMode");
        self.called("fmi2EnterInitializationMode", instance.enter_initialization())?;
        self.journal.at("fmi2ExitInitializationMode");
        self.called("fmi2ExitInitializationMode", instance.exit_initialization())
    }

    /// Steps from one communication point to another. Returns the outputs after each step.
    pub(super) fn steps(
        &self,
        instance: &Instance<'_>,
        from: u32,
        to: u32,
    ) -> Result<OutputHistory, ReportedFailure> {
        let mut course = OutputHistory::new();
        for number in from..to {
            let time = self.plan.start + f64::from(number) * self.plan.step;
            let name = format!("fmi2DoStep at {time} s");
            self.journal.at(&name);
            match instance.step(time, self.plan.step) {
                Err(refused) if refused.is_no_step() => {
                    self.journal.note(&format!("{name} returns {refused}: the run ends there"));
                    break;
                }
                result => self.called(&name, result)?,
            }
            course.push(self.outputs(instance)?);
        }
        Ok(course)
    }

    fn outputs(&self, instance: &Instance<'_>) -> Result<Vec<u64>, ReportedFailure> {
        self.journal.at("reading of the outputs");
        let Plan { reals, integers, booleans, .. } = &self.plan;
        let mut values = Vec::new();
        if !reals.is_empty() {
            let references: Vec<u32> = reals.iter().map(|(_, reference)| *reference).collect();
            let found = self.called("fmi2GetReal of the outputs", instance.reals(&references))?;
            values.extend(found.iter().map(|value| value.to_bits()));
        }
        if !integers.is_empty() {
            let found =
                self.called("fmi2GetInteger of the outputs", instance.integers(integers))?;
            values.extend(found.iter().map(|value| u64::from(value.cast_unsigned())));
        }
        if !booleans.is_empty() {
            let found =
                self.called("fmi2GetBoolean of the outputs", instance.booleans(booleans))?;
            values.extend(found.iter().map(|value| u64::from(*value != 0)));
        }
        Ok(values)
    }
}
