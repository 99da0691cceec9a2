//! Runs with inputs that change, and with steps of different sizes.

use super::library::{Library, Value, heard};
use super::{ReportedFailure, Subject, said};
use crate::rules::Rule;

impl Subject<'_> {
    /// Makes a run in which the inputs have other values in every second step.
    pub(super) fn changed_inputs(&self, library: &Library) -> Result<(), ReportedFailure> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        heard();
        let mut history = Vec::new();
        for number in 0..self.plan.steps {
            self.at("setting of inputs during the run");
            for input in self.plan.inputs() {
                let (Some(start), Some(other)) = (&input.start, &input.other) else { continue };
                let value = if number % 2 == 0 { other } else { start };
                // A library may refuse a value; that of a start value is seen elsewhere.
                let _ = instance.write(input.reference, value);
            }
            let time = self.time(number);
            self.at(&format!("fmi2DoStep at {time} s, with other inputs"));
            if let Err(refused) = instance.step(time, self.plan.step) {
                let note = format!(
                    "with other inputs fmi2DoStep at {time} s returns {refused}: the run ends there{}",
                    said()
                );
                self.journal.note(&note);
                break;
            }
            history.push(self.read(&instance, &self.plan.outputs)?);
        }
        let Some(reference) = self.reference(library)? else { return Ok(()) };
        let is_finite = |history: &Vec<Vec<Value>>| {
            let mut values = history.iter().flatten().filter_map(Value::real);
            values.all(f64::is_finite)
        };
        if is_finite(&reference) && !is_finite(&history) {
            let message = "an output is not finite if the inputs change within their bounds by one per cent during the run";
            self.journal.finding(Rule::OutputNotFinite, message);
        }
        let compared = history.len().min(reference.len());
        let is_unmoved = self.difference(&reference[..compared], &history[..compared]).is_none();
        if is_unmoved && !self.plan.dependencies.is_empty() {
            self.journal.note(
                "no output follows the inputs: each input was changed by one per cent during the run",
            );
        }
        Ok(())
    }

    /// Makes a run with steps of different sizes.
    pub(super) fn varied_steps(&self, library: &Library) -> Result<(), ReportedFailure> {
        /// Sizes of the steps in a row, as parts of the usual step.
        const PARTS: [f64; 6] = [1.0, 0.5, 0.25, 0.25, 0.75, 0.25];
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let rows = self.plan.steps.div_ceil(3).max(1);
        let mut history = Vec::new();
        let mut number = 0.0;
        for part in (0..rows).flat_map(|_| PARTS) {
            if number + part > f64::from(self.plan.steps) {
                break;
            }
            let time = self.plan.start + number * self.plan.step;
            if !self.step(&instance, time, part * self.plan.step)? {
                break;
            }
            number += part;
            history.push(self.read(&instance, &self.plan.outputs)?);
        }
        let values = history.iter().flatten().filter_map(Value::real);
        if values.clone().any(|value| !value.is_finite()) {
            let message = "an output is not finite in a run with steps of different sizes";
            self.journal.finding(Rule::OutputNotFinite, message);
        }
        Ok(())
    }
}
