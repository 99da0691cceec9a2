//! Runs that must give the outputs of the first run: after resets, and from saved states.

use super::experiment::{OutputHistory, fingerprint};
use super::library::{Instance, Library, SavedState, Value};
use super::{ReportedFailure, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes the run that every host makes, and repeats it after a reset.
    pub(super) fn plain(&self, library: &Library) -> Result<(), ReportedFailure> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.starts(&instance)?;
        let first = self.steps(&instance, 0, self.plan.steps)?;
        self.journal.first_run(fingerprint(&first));
        self.finite(&first);
        self.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())?;
        let again = self.after_reset(&instance, "after fmi2Terminate")?;
        self.at("fmi2FreeInstance");
        drop(instance);
        let Some(difference) = self.difference(&first, &again) else { return Ok(()) };
        if self.is_random(library, &first)? {
            self.journal.note(
                "a run after fmi2Reset and one of a second instance give other outputs than the first run, as a model may intend: runs after a reset and from saved states are not compared",
            );
        } else {
            let message = format!("in the run after fmi2Reset, {difference}");
            self.journal.finding(Rule::ResetDiffers, &message);
        }
        Ok(())
    }

    /// `true` if a new instance gives other outputs than the first run: some models are random by intent.
    fn is_random(&self, library: &Library, first: &OutputHistory) -> Result<bool, ReportedFailure> {
        Ok(!self.plan.abilities.once_per_process
            && self.difference(first, &self.fresh(library)?).is_some())
    }

    /// Compares variables with their start values after the initialization: before its end the standard allows hosts to
    /// read outputs and states only. Inputs, parameters and constants are changed by hosts alone.
    fn starts(&self, instance: &Instance<'_>) -> Result<(), ReportedFailure> {
        let is_exact = |variable: &&super::plan::Variable| {
            variable.role.keeps_value() || variable.role == super::plan::Role::Constant
        };
        let variables: Vec<_> = self.plan.variables.iter().filter(is_exact).cloned().collect();
        let found = self.read(instance, &variables)?;
        for (variable, found) in variables.iter().zip(found) {
            let Some(start) = &variable.start else { continue };
            let is_equal = match (&found, start) {
                // Zero has two signs.
                (Value::Real(found), Value::Real(start)) => found == start,
                _ => found.is_same(start),
            };
            if !is_equal {
                let name = &variable.name;
                let message = format!(
                    "{name} is {found} after initialization, but its start value is {start}"
                );
                self.journal.finding(Rule::StartDiffers, &message);
            }
        }
        Ok(())
    }

    /// Makes the run of a new instance.
    pub(super) fn fresh(&self, library: &Library) -> Result<OutputHistory, ReportedFailure> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.steps(&instance, 0, self.plan.steps)
    }

    /// Makes the run of a new instance; `None` if a second one gives other outputs, which a model may intend.
    pub(super) fn reference(
        &self,
        library: &Library,
    ) -> Result<Option<OutputHistory>, ReportedFailure> {
        let (first, second) = (self.fresh(library)?, self.fresh(library)?);
        Ok(self.difference(&first, &second).is_none().then_some(first))
    }

    /// Makes the run after a reset.
    fn after_reset(
        &self,
        instance: &Instance<'_>,
        when: &str,
    ) -> Result<OutputHistory, ReportedFailure> {
        let name = format!("fmi2Reset {when}");
        self.at(&name);
        self.called(&name, instance.reset())?;
        self.initialize(instance)?;
        self.steps(instance, 0, self.plan.steps)
    }

    /// Resets an instance before, in and after its initialization and in the middle of its run.
    pub(super) fn resets(&self, library: &Library) -> Result<(), ReportedFailure> {
        let instance = self.instance(library)?;
        let first = self.after_reset(&instance, "before the initialization")?;
        let again = self.after_reset(&instance, "after the last step")?;
        if self.difference(&first, &again).is_some() {
            // The first trial has reported it.
            return Ok(());
        }
        for when in ["in the initialization", "after the initialization", "before the last step"] {
            self.at("fmi2Reset after the last step");
            self.called("fmi2Reset after the last step", instance.reset())?;
            self.enter_initialization(&instance)?;
            if when != "in the initialization" {
                self.exit_initialization(&instance)?;
            }
            if when == "before the last step" {
                self.steps(&instance, 0, self.plan.steps - 1)?;
            }
            let again = self.after_reset(&instance, when)?;
            if let Some(difference) = self.difference(&first, &again) {
                let message = format!("in the run after fmi2Reset {when}, {difference}");
                self.journal.finding(Rule::ResetDiffers, &message);
                break;
            }
        }
        Ok(())
    }

    /// Goes back to a state that was saved in the middle of the run.
    pub(super) fn states(&self, library: &Library) -> Result<(), ReportedFailure> {
        let middle = self.plan.steps / 2;
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let first = self.steps(&instance, 0, middle)?;
        self.at("fmi2GetFMUstate");
        let state = self.called("fmi2GetFMUstate", instance.save())?;
        let rest = self.steps(&instance, middle, self.plan.steps)?;
        if self.is_random(library, &[first, rest.clone()].concat())? {
            return Ok(());
        }
        self.resume(&instance, &state, &rest, Rule::StateDiffers)?;
        if self.plan.abilities.serializes_states {
            self.at("fmi2SerializeFMUstate");
            let bytes = self.called("fmi2SerializeFMUstate", instance.serialize(&state))?;
            self.at("fmi2DeSerializeFMUstate");
            let copy = self.called("fmi2DeSerializeFMUstate", instance.deserialize(&bytes))?;
            self.resume(&instance, &copy, &rest, Rule::SerializedStateDiffers)?;
            self.at("fmi2FreeFMUstate");
            self.called("fmi2FreeFMUstate", instance.free(copy))?;
        }
        self.at("fmi2FreeFMUstate");
        self.called("fmi2FreeFMUstate", instance.free(state))
    }

    fn resume(
        &self,
        instance: &Instance<'_>,
        state: &SavedState,
        rest: &OutputHistory,
        rule: Rule,
    ) -> Result<(), ReportedFailure> {
        let middle = self.plan.steps / 2;
        self.at("fmi2SetFMUstate");
        self.called("fmi2SetFMUstate", instance.restore(state))?;
        let again = self.steps(instance, middle, self.plan.steps)?;
        if let Some(difference) = self.difference(rest, &again) {
            let message = format!(
                "in the run after fmi2SetFMUstate, whose step 1 is step {} of the first run, {difference}",
                middle + 1,
            );
            self.journal.finding(rule, &message);
        }
        Ok(())
    }
}
