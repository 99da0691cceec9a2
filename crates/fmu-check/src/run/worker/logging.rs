//! A run with all messages to the logger.

use super::library::{Arguments, Library, Value};
use super::{Ended, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes a run in which the library logs all that it can, and compares it with a run without.
    pub(super) fn logging(&self, library: &Library) -> Result<(), Ended> {
        let location = self.location();
        let arguments = Arguments { logging: true, ..self.arguments(&location) };
        let instance = self.instance_with(library, &arguments)?;
        let log = |on: bool, categories: &[String]| {
            self.at("fmi2SetDebugLogging");
            self.called("fmi2SetDebugLogging", instance.log(on, categories))
        };
        log(true, &[])?;
        if !self.plan.log_categories.is_empty() {
            log(true, &self.plan.log_categories)?;
        }
        self.initialize(&instance)?;
        let middle = self.plan.steps / 2;
        let mut logged = self.steps(&instance, 0, middle)?;
        log(false, &[])?;
        logged.extend(self.steps(&instance, middle, self.plan.steps)?);
        self.at("fmi2Terminate");
        self.called("fmi2Terminate", instance.terminate())?;
        let reference = self.reference(library)?;
        let difference =
            reference.and_then(|reference| self.difference(&reference, &logged, Value::is_same));
        if let Some(difference) = difference
            && self.is_first_run_later(library)?
        {
            let message = format!("in the run with logging on, {difference}");
            self.journal.finding(Rule::LoggingDiffers, &message);
        }
        Ok(())
    }
}
