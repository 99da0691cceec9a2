//! Runs that must give the outputs of the first run: after resets, and from saved states.

use super::experiment::{OutputHistory, fingerprint};
use super::library::{Instance, Library, SavedState};
use super::plan::{Role, Variable};
use super::{ReportedFailure, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes the run that every host makes, and once more after a reset.
    pub(super) fn plain(&self, library: &Library) -> Result<(), ReportedFailure> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.starts(&instance)?;
        let first = self.steps(&instance, 0, self.plan.steps)?;
        self.journal.first_run(fingerprint(&first));
        self.finite(&first);
        self.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())?;
        self.after_reset(&instance, "after fmi2Terminate")?;
        self.at("fmi2FreeInstance");
        Ok(())
    }

    /// Compares variables with their start values after the initialization: before its end the standard allows hosts to
    /// read outputs and states only. Inputs, parameters and constants are changed by hosts alone.
    fn starts(&self, instance: &Instance<'_>) -> Result<(), ReportedFailure> {
        let is_exact =
            |variable: &&Variable| variable.role.keeps_value() || variable.role == Role::Constant;
        let variables: Vec<_> = self.plan.variables.iter().filter(is_exact).cloned().collect();
        let found = self.read(instance, &variables)?;
        for (variable, found) in variables.iter().zip(found) {
            let Some(start) = &variable.start else { continue };
            if !start.agrees_with(&found) {
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

    /// `true` if a run from the start gave what the first trial's gave in another process. Otherwise the model is random
    /// by intent, or an output is an address of memory, and runs are not compared.
    pub(super) fn is_first_run(&self, history: &OutputHistory) -> bool {
        self.journal.is_first_run(fingerprint(history))
    }

    /// Makes the run of a new instance; `None` if it cannot be compared.
    pub(super) fn reference(
        &self,
        library: &Library,
    ) -> Result<Option<OutputHistory>, ReportedFailure> {
        let first = self.fresh(library)?;
        Ok(self.is_first_run(&first).then_some(first))
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
        self.initialize(&instance)?;
        let first = self.steps(&instance, 0, self.plan.steps)?;
        if !self.is_first_run(&first) {
            self.journal.note(
                "each process gives other outputs, as those of a model that is random by intent or addresses of memory do: runs are not compared",
            );
            return Ok(());
        }
        for when in [
            "after the last step",
            "before the initialization",
            "in the initialization",
            "after the initialization",
            "before the last step",
        ] {
            self.prepare(&instance, when)?;
            let again = self.after_reset(&instance, when)?;
            if let Some(difference) = self.difference(&first, &again) {
                let message = format!("in the run after fmi2Reset {when}, {difference}");
                self.journal.finding(Rule::ResetDiffers, &message);
                break;
            }
        }
        Ok(())
    }

    /// Brings an instance from the end of its run to the moment of a reset.
    fn prepare(&self, instance: &Instance<'_>, when: &str) -> Result<(), ReportedFailure> {
        if when == "after the last step" {
            return Ok(());
        }
        self.at("fmi2Reset after the last step");
        self.called("fmi2Reset after the last step", instance.reset())?;
        if when == "before the initialization" {
            return Ok(());
        }
        self.enter_initialization(instance)?;
        if when == "in the initialization" {
            return Ok(());
        }
        self.exit_initialization(instance)?;
        if when == "before the last step" {
            self.steps(instance, 0, self.plan.steps - 1)?;
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
        if !self.is_first_run(&[first, rest.clone()].concat()) {
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
