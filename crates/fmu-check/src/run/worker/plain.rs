//! The run that every host makes.

use super::experiment::fingerprint;
use super::library::{Instance, Library};
use super::plan::{Role, Variable};
use super::{Ended, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes the run that every host makes, and once more after a reset.
    pub(super) fn plain(&self, library: &Library) -> Result<(), Ended> {
        if self.plan.abilities.once_per_process {
            self.journal.note(
                "canBeInstantiatedOnlyOncePerProcess is true: what needs a second instance is not tried",
            );
        }
        self.answers(library);
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let first = self.steps(&instance, 0, self.plan.steps)?;
        self.journal.first_run(fingerprint(&first));
        self.finite(&first, (1..).map(|number| self.time(number)), "");
        self.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())?;
        self.at("fmi2Reset");
        self.called("fmi2Reset", instance.reset())?;
        self.initialize(&instance)?;
        // Not in the first run, with which others are compared: these make the same calls.
        self.starts(&instance)?;
        self.steps(&instance, 0, self.plan.steps)?;
        self.at("fmi2FreeInstance");
        Ok(())
    }

    fn answers(&self, library: &Library) {
        for (rule, name, right) in [
            (Rule::TypesPlatform, "fmi2GetTypesPlatform", "default"),
            (Rule::Version, "fmi2GetVersion", "2.0"),
        ] {
            self.at(name);
            let answer = library.answer(name);
            if answer != right {
                let message = format!("{name} returns {answer}; FMI 2.0 requires \"{right}\"");
                self.journal.finding(rule, &message);
            }
        }
    }

    /// Compares variables with their start values after the initialization: before its end the standard allows hosts to
    /// read outputs and states only. Inputs, parameters and constants are changed by hosts alone.
    fn starts(&self, instance: &Instance<'_>) -> Result<(), Ended> {
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
}
