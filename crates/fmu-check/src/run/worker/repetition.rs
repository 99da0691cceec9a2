//! Repetitions that must give the outputs of the first run: after a reset, with another instance, from saved states.

use super::course::OutputHistory;
use super::library::{Instance, Library, SavedState};
use super::{ReportedFailure, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes the run that every importer makes, and repeats it after a reset.
    pub(super) fn plain(&self, library: &Library) -> Result<OutputHistory, ReportedFailure> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.starts(&instance)?;
        let first = self.steps(&instance, 0, self.plan.steps)?;
        self.finite(&first);
        self.journal.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())?;
        self.journal.at("fmi2Reset");
        self.called("fmi2Reset", instance.reset())?;
        self.initialize(&instance)?;
        let again = self.steps(&instance, 0, self.plan.steps)?;
        self.journal.at("fmi2FreeInstance");
        drop(instance);
        if again == first {
            return Ok(first);
        }
        // Some models are random by intent: a difference after a reset is a mistake only if a new instance shows none.
        let fresh = if self.plan.once_per_process { again.clone() } else { self.fresh(library)? };
        if fresh == first {
            let message =
                format!("in the run after fmi2Reset, {}", self.difference(&first, &again));
            self.journal.finding(Rule::ResetDiffers, &message);
        }
        Ok(first)
    }

    fn fresh(&self, library: &Library) -> Result<OutputHistory, ReportedFailure> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.steps(&instance, 0, self.plan.steps)
    }

    /// Repeats the run with another instance, and from saved states.
    pub(super) fn repeated(&self, library: &Library, first: &OutputHistory) {
        let Ok(again) = self.fresh(library) else { return };
        if again != *first {
            self.journal
                .note("two instances give different outputs: saved states are not examined");
        } else if self.plan.saves_states {
            // Failed calls have been reported.
            let _ = self.states(library, first);
        }
    }

    fn states(&self, library: &Library, first: &OutputHistory) -> Result<(), ReportedFailure> {
        let middle = self.plan.steps / 2;
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.steps(&instance, 0, middle)?;
        self.journal.at("fmi2GetFMUstate");
        let state = self.called("fmi2GetFMUstate", instance.save())?;
        self.steps(&instance, middle, self.plan.steps)?;
        self.resume(&instance, &state, first, Rule::StateDiffers)?;
        if self.plan.serializes_states {
            self.journal.at("fmi2SerializeFMUstate");
            let bytes = self.called("fmi2SerializeFMUstate", instance.serialize(&state))?;
            self.journal.at("fmi2DeSerializeFMUstate");
            let copy = self.called("fmi2DeSerializeFMUstate", instance.deserialize(&bytes))?;
            self.resume(&instance, &copy, first, Rule::SerializedStateDiffers)?;
            self.journal.at("fmi2FreeFMUstate");
            self.called("fmi2FreeFMUstate", instance.free(copy))?;
        }
        self.journal.at("fmi2FreeFMUstate");
        self.called("fmi2FreeFMUstate", instance.free(state))
    }

    fn resume(
        &self,
        instance: &Instance<'_>,
        state: &SavedState,
        first: &OutputHistory,
        rule: Rule,
    ) -> Result<(), ReportedFailure> {
        let middle = self.plan.steps / 2;
        self.journal.at("fmi2SetFMUstate");
        self.called("fmi2SetFMUstate", instance.restore(state))?;
        let again = self.steps(instance, middle, self.plan.steps)?;
        let rest = &first[(middle as usize).min(first.len())..];
        if again != rest {
            let message = format!(
                "in the run after fmi2SetFMUstate, whose step 1 is step {} of the first run, {}",
                middle + 1,
                self.difference(rest, &again)
            );
            self.journal.finding(rule, &message);
        }
        Ok(())
    }
}
