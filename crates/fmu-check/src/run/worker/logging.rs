//! A run with all messages to the logger.

use super::library::Library;
use super::{ReportedFailure, Subject, said};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes a run in which the library logs all that it can, and compares it with a run without.
    pub(super) fn logging(&self, library: &Library) -> Result<(), ReportedFailure> {
        self.at("fmi2Instantiate with logging on");
        let Some(instance) = library.instantiate(&self.plan.guid, &self.location(), true, true)
        else {
            let message = format!("fmi2Instantiate returns NULL with logging on{}", said());
            self.journal.finding(Rule::Instantiate, &message);
            return Err(ReportedFailure);
        };
        for categories in [&[][..], &self.plan.log_categories] {
            self.at("fmi2SetDebugLogging");
            self.called("fmi2SetDebugLogging", instance.log(true, categories))?;
        }
        self.initialize(&instance)?;
        let middle = self.plan.steps / 2;
        let mut logged = self.steps(&instance, 0, middle)?;
        self.at("fmi2SetDebugLogging");
        self.called("fmi2SetDebugLogging", instance.log(false, &[]))?;
        logged.extend(self.steps(&instance, middle, self.plan.steps)?);
        self.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())?;
        let reference = self.reference(library)?;
        let difference = reference.and_then(|reference| self.difference(&reference, &logged));
        if let Some(difference) = difference {
            let message = format!("in the run with logging on, {difference}");
            self.journal.finding(Rule::LoggingDiffers, &message);
        }
        Ok(())
    }
}
