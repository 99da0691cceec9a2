//! Runs that must give the outputs of the first run: after resets, and from saved states.

use super::experiment::OutputHistory;
use super::library::{Instance, Library, Refused, SavedState, Value};
use super::plan::{Role, Variable};
use super::{Ended, Subject};
use crate::rules::Rule;

/// The moment of a reset.
#[derive(Clone, Copy)]
enum Moment {
    AfterTerminate,
    AfterLastStep,
    BeforeInitialization,
    InInitialization,
    AfterInitialization,
    BeforeLastStep,
    AfterOtherValues,
}

impl Moment {
    const ALL: [Self; 7] = [
        Self::AfterTerminate,
        Self::AfterLastStep,
        Self::BeforeInitialization,
        Self::InInitialization,
        Self::AfterInitialization,
        Self::BeforeLastStep,
        Self::AfterOtherValues,
    ];

    const fn words(self) -> &'static str {
        match self {
            Self::AfterTerminate => "after fmi2Terminate",
            Self::AfterLastStep => "after the last step",
            Self::BeforeInitialization => "before the initialization",
            Self::InInitialization => "in the initialization",
            Self::AfterInitialization => "after the initialization",
            Self::BeforeLastStep => "before the last step",
            Self::AfterOtherValues => "after a step with other values",
        }
    }
}

impl Subject<'_> {
    /// Resets an instance at all moments, and compares the runs that follow.
    pub(super) fn resets(&self, library: &Library) -> Result<(), Ended> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let first = self.steps(&instance, 0, self.plan.steps)?;
        if !self.is_first_run(&first) {
            self.journal.note(
                "each process gives other outputs, as those of a model that is random by intent or addresses of memory do: runs are not compared",
            );
            return Ok(());
        }
        for moment in Moment::ALL {
            self.prepare(&instance, moment)?;
            self.reset(&instance, moment)?;
            self.initialize(&instance)?;
            let again = self.steps(&instance, 0, self.plan.steps)?;
            if let Some(difference) = self.difference(&first, &again, Value::is_same)
                && self.is_first_run_later(library)?
            {
                let when = moment.words();
                let message = format!("in the run after fmi2Reset {when}, {difference}");
                self.journal.finding(Rule::ResetDiffers, &message);
                break;
            }
        }
        Ok(())
    }

    /// Resets a new instance, and makes its run.
    pub(super) fn reset_new(&self, library: &Library) -> Result<(), Ended> {
        let instance = self.instance(library)?;
        self.at("fmi2Reset of a new instance");
        self.called("fmi2Reset of a new instance", instance.reset())?;
        self.initialize(&instance)?;
        let run = self.steps(&instance, 0, self.plan.steps)?;
        if self.plan.abilities.once_per_process {
            return Ok(());
        }
        let Some(reference) = self.reference(library)? else { return Ok(()) };
        if let Some(difference) = self.difference(&reference, &run, Value::is_same)
            && self.is_first_run_later(library)?
        {
            let message = format!("in the run after fmi2Reset of a new instance, {difference}");
            self.journal.finding(Rule::ResetDiffers, &message);
        }
        Ok(())
    }

    fn reset(&self, instance: &Instance<'_>, moment: Moment) -> Result<(), Ended> {
        let name = format!("fmi2Reset {}", moment.words());
        self.at(&name);
        self.called(&name, instance.reset())
    }

    /// Brings an instance from the end of its run to a moment.
    fn prepare(&self, instance: &Instance<'_>, moment: Moment) -> Result<(), Ended> {
        match moment {
            Moment::AfterTerminate => {
                self.at("fmi2Terminate");
                return self.called("fmi2Terminate", instance.terminate());
            }
            Moment::AfterLastStep => return Ok(()),
            _ => self.reset(instance, Moment::AfterLastStep)?,
        }
        if matches!(moment, Moment::BeforeInitialization) {
            return Ok(());
        }
        if matches!(moment, Moment::AfterOtherValues) {
            self.at("a step with other values");
            // A library may refuse values, and can be reset then.
            let run = self
                .initialize_with(instance, true)
                .and_then(|()| instance.step(self.plan.start, self.plan.step));
            // Nothing may follow fmi2Fatal, which is reported where all variables are set.
            let is_lost = run.is_err_and(Refused::is_fatal);
            return if is_lost { Err(Ended::Failed) } else { Ok(()) };
        }
        self.enter_initialization(instance)?;
        if matches!(moment, Moment::InInitialization) {
            return Ok(());
        }
        self.exit_initialization(instance)?;
        if matches!(moment, Moment::BeforeLastStep) {
            self.steps(instance, 0, self.plan.steps - 1)?;
        }
        Ok(())
    }

    /// Goes back to a state that was saved in the middle of the run.
    pub(super) fn states(&self, library: &Library) -> Result<(), Ended> {
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
        self.resume(library, &instance, &state, &rest, Rule::StateDiffers)?;
        let copy = if self.plan.abilities.serializes_states {
            self.at("fmi2SerializeFMUstate");
            Some(self.called("fmi2SerializeFMUstate", instance.serialize(&state))?)
        } else {
            None
        };
        self.free(&instance, state)?;
        // Only after the state is freed: the bytes must be all of it.
        if let Some(bytes) = copy {
            self.at("fmi2DeSerializeFMUstate");
            let copy = self.called("fmi2DeSerializeFMUstate", instance.deserialize(&bytes))?;
            self.resume(library, &instance, &copy, &rest, Rule::SerializedStateDiffers)?;
            self.free(&instance, copy)?;
        }
        self.at_risk(Rule::FreeState, "fmi2FreeFMUstate of NULL");
        self.called("fmi2FreeFMUstate of NULL", instance.free_no_state())
    }

    fn free(&self, instance: &Instance<'_>, state: SavedState) -> Result<(), Ended> {
        self.at("fmi2FreeFMUstate");
        if !self.called("fmi2FreeFMUstate", instance.free(state))? {
            let message = "fmi2FreeFMUstate does not set the pointer to the state to NULL";
            self.journal.finding(Rule::FreeState, message);
        }
        Ok(())
    }

    fn resume(
        &self,
        library: &Library,
        instance: &Instance<'_>,
        state: &SavedState,
        rest: &OutputHistory,
        rule: Rule,
    ) -> Result<(), Ended> {
        let middle = self.plan.steps / 2;
        self.at("setting of other values before fmi2SetFMUstate");
        let is_set = |variable: &&Variable| matches!(variable.role, Role::Input | Role::Tunable);
        for variable in self.plan.variables.iter().filter(is_set) {
            let Some(other) = &variable.other else { continue };
            match instance.write(&[(variable.reference, other)]) {
                Ok(()) => {}
                // Nothing may follow fmi2Fatal, which is reported where all variables are set.
                Err(refused) if refused.is_fatal() => return Err(Ended::Failed),
                // A library may refuse a value, and can go back to a state then.
                Err(_) => break,
            }
        }
        self.at("fmi2SetFMUstate");
        self.called("fmi2SetFMUstate", instance.restore(state))?;
        let again = self.steps(instance, middle, self.plan.steps)?;
        if let Some(difference) = self.difference(rest, &again, Value::is_same)
            && self.is_first_run_later(library)?
        {
            let message = format!(
                "in the run after fmi2SetFMUstate, whose step 1 is step {} of the first run, {difference}",
                middle + 1,
            );
            self.journal.finding(rule, &message);
        }
        Ok(())
    }
}
