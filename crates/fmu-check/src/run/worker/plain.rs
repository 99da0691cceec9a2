//! The run that every host makes.

use super::experiment::fingerprint;
use super::library::Library;
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
}
