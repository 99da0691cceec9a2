//! The comparison of the first values of variables with the start values of the model description.

use super::library::Instance;
use super::plan::Start;
use super::{ReportedFailure, Subject};
use crate::rules::Rule;

impl Subject<'_> {
    /// Reads variables with exact start values after the initialization: before its end the standard allows importers
    /// to read outputs and states only, and nothing but an importer changes these variables.
    pub(super) fn starts(&self, instance: &Instance<'_>) -> Result<(), ReportedFailure> {
        self.journal.at("reading of the start values");
        for (name, reference, start) in &self.plan.exact {
            let reference = [*reference];
            let get = |kind| format!("fmi2Get{kind} of {name} before the first step");
            let (found, stated) = match start {
                Start::Real(start) => {
                    let found = self.called(&get("Real"), instance.reals(&reference))?[0];
                    (found != *start)
                        .then_some((format!("{found:?}"), format!("{start:?}")))
                        .unzip()
                }
                Start::Integer(start) => {
                    let found = self.called(&get("Integer"), instance.integers(&reference))?[0];
                    (found != *start).then_some((found.to_string(), start.to_string())).unzip()
                }
                Start::Boolean(start) => {
                    let found = self.called(&get("Boolean"), instance.booleans(&reference))?[0];
                    (found != i32::from(*start))
                        .then_some((found.to_string(), start.to_string()))
                        .unzip()
                }
                Start::String(start) => {
                    let found =
                        self.called(&get("String"), instance.strings(&reference))?.remove(0);
                    (found != *start).then_some((found, start.clone())).unzip()
                }
            };
            if let (Some(found), Some(stated)) = (found, stated) {
                let message = format!(
                    "{name} is {found} after initialization, but its start value is {stated}"
                );
                self.journal.finding(Rule::StartDiffers, &message);
            }
        }
        Ok(())
    }
}
