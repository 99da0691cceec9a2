//! Derivatives by variables and by time, as capability flags promise them, held against differences of outputs.

use super::library::{Instance, Library, Value};
use super::plan::Variable;
use super::{ReportedFailure, Subject};
use crate::description::Kind;
use crate::rules::Rule;

/// Limit of the pairs of an output and an input whose derivative is examined.
const MOST_PAIRS: usize = 100;

impl Subject<'_> {
    /// Compares derivatives of outputs by inputs with differences of outputs, in the initialization: during a run the
    /// standard forbids reading an output after setting an input without a step between.
    pub(super) fn directional_derivatives(&self, library: &Library) -> Result<(), ReportedFailure> {
        let instance = self.instance(library)?;
        self.enter_initialization(&instance)?;
        let mut follows = false;
        let mut is_zero = true;
        for (output, input) in self.plan.dependencies.iter().take(MOST_PAIRS) {
            let (output, input) = (&self.plan.outputs[*output], &self.plan.variables[*input]);
            let stated = self.stated(&instance, output, input)?;
            is_zero &= stated == 0.0;
            let Some(found) = self.by_differences(&instance, output, input)? else { continue };
            follows = true;
            if !found.agrees(stated) {
                let message = format!(
                    "the derivative of {} by {} is stated as {stated:?}; differences of the output give {:?}",
                    output.name, input.name, found.value
                );
                self.journal.finding(Rule::DirectionalDerivative, &message);
            }
        }
        if !follows && !is_zero {
            self.journal.note(
                "no output follows an input in the initialization: derivatives of outputs by inputs are not compared with differences",
            );
        }
        self.exit_initialization(&instance)?;
        self.step(&instance, self.plan.start, self.plan.step)?;
        for (output, input) in self.plan.dependencies.iter().take(MOST_PAIRS) {
            self.stated(&instance, &self.plan.outputs[*output], &self.plan.variables[*input])?;
        }
        Ok(())
    }

    /// Returns the derivative of an output by an input that the library states.
    fn stated(
        &self,
        instance: &Instance<'_>,
        output: &Variable,
        input: &Variable,
    ) -> Result<f64, ReportedFailure> {
        let call = "fmi2GetDirectionalDerivative";
        self.at(call);
        let name = format!("{call} of {} by {}", output.name, input.name);
        let stated = self.called(&name, instance.directional(output.reference, input.reference))?;
        if !stated.is_finite() {
            let message =
                format!("the derivative of {} by {} is {stated}", output.name, input.name);
            self.journal.finding(Rule::DirectionalDerivative, &message);
            return Err(ReportedFailure);
        }
        Ok(stated)
    }

    /// Returns the derivative of an output by an input from differences; `None` if the output does not change at once.
    fn by_differences(
        &self,
        instance: &Instance<'_>,
        output: &Variable,
        input: &Variable,
    ) -> Result<Option<Difference>, ReportedFailure> {
        let [Some(start), Some(other)] =
            [&input.start, &input.other].map(|value| value.as_ref().and_then(Value::real))
        else {
            return Ok(None);
        };
        self.at("differences of an output by an input");
        let change = other - start;
        let read = |value: f64| {
            instance.write(input.reference, &Value::Real(value))?;
            let read = instance.read(Kind::Real, &[output.reference])?;
            Ok(read.first().and_then(Value::real).unwrap_or(f64::NAN))
        };
        let read = |value: f64| self.called("fmi2SetReal or fmi2GetReal", read(value));
        let far = read(start + change)?;
        let near = read(start + change / 2.0)?;
        let at = read(start)?;
        if far.to_bits() == at.to_bits() {
            return Ok(None);
        }
        let (far, near) = ((far - at) / change, (near - at) / (change / 2.0));
        // What the differences of first order have in common, their linear error removed.
        let value = 2.0 * near - far;
        let rounding = 1e-14 * at.abs() / change.abs();
        let error = (near - far).abs() + rounding;
        Ok((error <= 0.1 * value.abs()).then_some(Difference { value, error }))
    }

    /// Compares derivatives of outputs by time with differences of outputs.
    pub(super) fn output_derivatives(&self, library: &Library) -> Result<(), ReportedFailure> {
        let references = self.plan.real_outputs();
        let outputs = &self.plan.outputs[..references.len()];
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let mut course = Vec::new();
        for number in 0..self.plan.steps {
            if !self.step(&instance, self.time(number), self.plan.step)? {
                break;
            }
            let call = "fmi2GetRealOutputDerivatives";
            self.at(call);
            let rates = self.called(call, instance.output_derivatives(&references))?;
            course.push((self.read(&instance, outputs)?, rates));
        }
        for (place, output) in outputs.iter().enumerate() {
            let course: Vec<(f64, f64)> = course
                .iter()
                .map(|(values, rates)| (values[place].real().unwrap_or(f64::NAN), rates[place]))
                .collect();
            let name = &output.name;
            if let Some((_, rate)) = course.iter().find(|(_, rate)| !rate.is_finite()) {
                let message = format!("the derivative of the output {name} by time is {rate}");
                self.journal.finding(Rule::OutputDerivative, &message);
            } else if let Some((rate, difference)) = too_small(&course, self.plan.step) {
                let message = format!(
                    "the derivative of the output {name} by time is stated as {rate:?} after step 2; differences of the output give {difference:?}"
                );
                self.journal.finding(Rule::OutputDerivative, &message);
            }
        }
        Ok(())
    }

    /// Sets derivatives of inputs to zero before each step, which changes nothing.
    pub(super) fn input_derivatives(&self, library: &Library) -> Result<(), ReportedFailure> {
        let inputs = self.plan.inputs().filter(|input| input.kind == Kind::Real);
        let references: Vec<u32> = inputs.map(|input| input.reference).collect();
        if references.is_empty() {
            return Ok(());
        }
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let mut held = Vec::new();
        for number in 0..self.plan.steps {
            let call = "fmi2SetRealInputDerivatives";
            self.at(call);
            self.called(call, instance.hold_inputs(&references))?;
            if !self.step(&instance, self.time(number), self.plan.step)? {
                break;
            }
            held.push(self.read(&instance, &self.plan.outputs)?);
        }
        let Some(reference) = self.reference(library)? else { return Ok(()) };
        let far = |(one, other): (&Value, &Value)| match (one.real(), other.real()) {
            (Some(one), Some(other)) => (one - other).abs() > 1e-6 * one.abs().max(other.abs()),
            _ => !one.is_same(other),
        };
        let mut pairs = reference.iter().flatten().zip(held.iter().flatten());
        if pairs.any(far)
            && let Some(difference) = self.difference(&reference, &held)
        {
            let message =
                format!("in the run with derivatives of inputs that are zero, {difference}");
            self.journal.finding(Rule::InputDerivative, &message);
        }
        Ok(())
    }
}

/// A derivative from differences, and how well it is known.
struct Difference {
    value: f64,
    error: f64,
}

impl Difference {
    /// `true` unless the stated derivative is certainly another one.
    fn agrees(&self, stated: f64) -> bool {
        (stated - self.value).abs() <= 0.02 * self.value.abs() + 10.0 * self.error
    }
}

/// Returns the stated rate and the difference quotient after the second step, if the rate is too small there and after
/// all other steps but the last. A rate that is larger than the quotient contradicts nothing: the output may oscillate
/// within a step.
fn too_small(course: &[(f64, f64)], step: f64) -> Option<(f64, f64)> {
    /// Number of steps from which on the comparison says something.
    const LEAST: usize = 6;
    let compare = |three: &[(f64, f64)]| {
        let [(before, _), (at, rate), (after, _)] = three else { return None };
        let quotient = (after - before) / (2.0 * step);
        let bend = (after - 2.0 * at + before) / step;
        let rounding = 1e-12 * at.abs() / step;
        let is_small = rate.abs() < 0.5 * quotient.abs() - 2.0 * bend.abs() - rounding;
        is_small.then_some((*rate, quotient))
    };
    let all: Option<Vec<(f64, f64)>> = course.windows(3).map(compare).collect();
    all.filter(|_| course.len() >= LEAST).and_then(|all| all.first().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values and rates of an exponential decay, the rates times a factor.
    fn decay(factor: f64) -> Vec<(f64, f64)> {
        let value = |number: u32| (-0.1 * f64::from(number)).exp();
        (1..=10).map(|number| (value(number), -factor * value(number))).collect()
    }

    #[test]
    fn rates_that_are_too_small_are_told_from_others() {
        assert_eq!(too_small(&decay(1.0), 0.1), None);
        // The difference quotient of the last step, as a library may define it.
        assert_eq!(too_small(&decay(1.05), 0.1), None);
        assert!(too_small(&decay(0.0), 0.1).is_some());
        assert!(too_small(&decay(0.1), 0.1).is_some());
    }

    #[test]
    fn an_oscillation_within_a_step_says_nothing() {
        // Sampled with steps of 1, sin(6.3 t) looks like sin(0.0168 t), and sin(2 pi t) like 0.
        for frequency in [7.0, 6.3, std::f64::consts::TAU] {
            let phase = |number: u32| frequency * f64::from(number);
            let value = |number| (phase(number).sin(), frequency * phase(number).cos());
            assert_eq!(too_small(&(1..=10).map(value).collect::<Vec<_>>(), 1.0), None);
        }
    }
}
