//! Runs with inputs that change, and with steps of different sizes.

use super::experiment::OutputHistory;
use super::library::{Library, Value, heard};
use super::plan::Variable;
use super::{Ended, Subject, said};

/// Limit of the instances that are made to find the inputs that a library lets change.
const MOST_INSTANCES: usize = 12;

impl Subject<'_> {
    /// Makes a run in which the inputs have other values in every second step.
    pub(super) fn changed_inputs(&self, library: &Library) -> Result<(), Ended> {
        let inputs = self.plan.inputs().filter(|input| input.other.is_some());
        let mut inputs: Vec<&Variable> = inputs.collect();
        let mut history = self.run_with_inputs(library, &inputs)?;
        for _ in 1..MOST_INSTANCES {
            // A library may refuse a value.
            let Err(refused) = history else { break };
            inputs.remove(refused);
            history = self.run_with_inputs(library, &inputs)?;
        }
        let Ok(history) = history else { return Ok(()) };
        let times = (1..).map(|number| self.time(number));
        self.finite(&history, times, " if inputs have other values in every second step");
        let Some(reference) = self.reference(library)? else { return Ok(()) };
        let is_unmoved = self.difference(&reference, &history, Value::is_same).is_none();
        if is_unmoved && !inputs.is_empty() && !self.plan.dependencies.is_empty() {
            let count = inputs.len();
            self.journal.note(&format!(
                "no output follows the inputs: {count} had another value in every second step"
            ));
        }
        Ok(())
    }

    /// Makes a run with other values of inputs in every second step. Returns the outputs, or the place of an input whose
    /// value the library refuses.
    fn run_with_inputs(
        &self,
        library: &Library,
        inputs: &[&Variable],
    ) -> Result<Result<OutputHistory, usize>, Ended> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        heard();
        let mut history = OutputHistory::new();
        for number in 0..self.plan.steps {
            self.at("setting of inputs during the run");
            for (place, input) in inputs.iter().enumerate() {
                let value = if number % 2 == 0 { &input.other } else { &input.start };
                let Some(value) = value else { continue };
                if instance.write(&[(input.reference, value)]).is_err() {
                    return Ok(Err(place));
                }
            }
            let time = self.time(number);
            self.at(&format!("fmi2DoStep at {time} s, with other values of inputs"));
            if let Err(refused) = instance.step(time, self.plan.step) {
                let note = format!(
                    "with other values of inputs fmi2DoStep at {time} s returns {refused}{}",
                    said()
                );
                self.journal.note(&note);
                return Err(Ended::NoStep);
            }
            history.push(self.read(&instance, &self.plan.outputs)?);
        }
        Ok(Ok(history))
    }

    /// Makes a run with steps of different sizes.
    pub(super) fn varied_steps(&self, library: &Library) -> Result<(), Ended> {
        /// Sizes of the steps in a row, as parts of the usual step.
        const PARTS: [f64; 6] = [1.0, 0.5, 0.25, 0.25, 0.75, 0.25];
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let mut history = OutputHistory::new();
        let mut times = Vec::new();
        let mut number = 0.0;
        for part in PARTS.into_iter().cycle() {
            if number + part > f64::from(self.plan.steps) {
                break;
            }
            self.step(&instance, self.plan.start + number * self.plan.step, part * self.plan.step)?;
            number += part;
            times.push(self.plan.start + number * self.plan.step);
            history.push(self.read(&instance, &self.plan.outputs)?);
        }
        self.finite(&history, times.into_iter(), " in a run with steps of different sizes");
        Ok(())
    }
}
