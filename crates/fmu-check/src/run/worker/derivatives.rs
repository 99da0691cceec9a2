//! Derivatives by variables and by time, as capability flags promise them, held against differences of outputs.

use super::library::{Instance, Library, Refused, Value};
use super::plan::{Dependency, Variable};
use super::{Ended, Subject};
use crate::description::Kind;
use crate::rules::Rule;
use std::collections::BTreeSet;

/// Limit of the pairs of an output and an input whose derivative is examined.
const MOST_PAIRS: usize = 100;
/// Limit of the inputs that may be refused before the comparison ends.
const MOST_REFUSED: usize = 12;

impl Subject<'_> {
    /// Compares derivatives of outputs by inputs with differences of outputs, in the initialization: during a run the
    /// standard forbids reading an output after setting an input without a step between.
    pub(super) fn directional_derivatives(&self, library: &Library) -> Result<(), Ended> {
        let mut instance = self.instance(library)?;
        self.enter_initialization(&instance)?;
        let (mut follows, mut is_zero) = (false, true);
        let mut refused = BTreeSet::new();
        for pair in self.plan.initial_dependencies.iter().take(MOST_PAIRS) {
            if refused.contains(&pair.input) {
                continue;
            }
            let (output, input) = self.pair(*pair);
            let [Some(start), Some(other)] =
                [&input.start, &input.other].map(|value| value.as_ref().and_then(Value::real))
            else {
                continue;
            };
            self.at("differences of an output by an input");
            let Ok(values) = differences(&instance, output, input, start, other) else {
                // A library may refuse a value; nothing else may then be asked of the instance.
                refused.insert(pair.input);
                if refused.len() > MOST_REFUSED || self.plan.abilities.once_per_process {
                    break;
                }
                instance = self.instance(library)?;
                self.enter_initialization(&instance)?;
                continue;
            };
            let stated = self.stated(&instance, output, input)?;
            is_zero &= stated == 0.0;
            follows |= values.has_followed();
            if let Some(found) = values.contradict(stated) {
                let message = format!(
                    "the derivative of {} by {} is stated as {stated:?}; differences of the output give {found:?}",
                    output.name, input.name
                );
                self.journal.finding(Rule::DirectionalDerivative, &message);
            }
            if instance.write(&[(input.reference, &Value::Real(start))]).is_err() {
                break;
            }
        }
        if !follows && !is_zero {
            self.journal.note(
                "no output follows an input in the initialization: derivatives of outputs by inputs are not compared with differences",
            );
        }
        Ok(())
    }

    /// Compares derivatives of outputs in the direction of several inputs, after a step, with those by each of them.
    pub(super) fn directions(&self, library: &Library) -> Result<(), Ended> {
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        self.step(&instance, self.plan.start, self.plan.step)?;
        let pairs = &self.plan.dependencies[..self.plan.dependencies.len().min(MOST_PAIRS)];
        for pairs in pairs.chunk_by(|one, next| one.output == next.output) {
            self.sums(&instance, pairs)?;
        }
        Ok(())
    }

    /// Compares the derivative of an output in the direction of several inputs with those by each of them.
    fn sums(&self, instance: &Instance<'_>, pairs: &[Dependency]) -> Result<(), Ended> {
        let (mut sum, mut size) = (0.0, 0.0);
        let mut direction = Vec::new();
        for (number, pair) in pairs.iter().enumerate() {
            let (output, input) = self.pair(*pair);
            let stated = self.stated(instance, output, input)?;
            #[allow(clippy::cast_precision_loss)]
            let part = 2.0 + number as f64;
            sum += part * stated;
            size += (part * stated).abs();
            direction.push((input.reference, part));
        }
        let (output, _) = self.pair(pairs[0]);
        let call = "fmi2GetDirectionalDerivative";
        self.at(call);
        let found = self.called(
            &format!("{call} of {} in a direction of all its inputs", output.name),
            instance.directional(output.reference, &direction),
        )?;
        // A library may compute both by differences. Written so that NaN is reported.
        let is_sum = (found - sum).abs() <= 0.05 * size;
        if !is_sum {
            let message = format!(
                "the derivative of {} in a direction of all its inputs is {found:?}; the derivatives by each of them give {sum:?}",
                output.name
            );
            self.journal.finding(Rule::DirectionalDerivative, &message);
        }
        Ok(())
    }

    fn pair(&self, pair: Dependency) -> (&Variable, &Variable) {
        (&self.plan.outputs[pair.output], &self.plan.variables[pair.input])
    }

    /// Returns the derivative of an output by an input that the library states.
    fn stated(
        &self,
        instance: &Instance<'_>,
        output: &Variable,
        input: &Variable,
    ) -> Result<f64, Ended> {
        let call = "fmi2GetDirectionalDerivative";
        self.at(call);
        let name = format!("{call} of {} by {}", output.name, input.name);
        let stated =
            self.called(&name, instance.directional(output.reference, &[(input.reference, 1.0)]))?;
        if !stated.is_finite() {
            let message =
                format!("the derivative of {} by {} is {stated}", output.name, input.name);
            self.journal.finding(Rule::DirectionalDerivative, &message);
            return Err(Ended::Failed);
        }
        Ok(stated)
    }

    /// Compares derivatives of outputs by time with differences of outputs.
    pub(super) fn output_derivatives(&self, library: &Library) -> Result<(), Ended> {
        let outputs = self.plan.continuous_outputs();
        let references: Vec<u32> = outputs.iter().map(|output| output.reference).collect();
        let instance = self.instance(library)?;
        self.initialize(&instance)?;
        let mut course = Vec::new();
        for number in 0..self.plan.steps {
            self.step(&instance, self.time(number), self.plan.step)?;
            let call = "fmi2GetRealOutputDerivatives";
            self.at(call);
            let rates = self.called(call, instance.output_derivatives(&references))?;
            course.push((self.read(&instance, &outputs)?, rates));
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
    pub(super) fn input_derivatives(&self, library: &Library) -> Result<(), Ended> {
        let inputs = self.plan.inputs().filter(|input| input.is_continuous);
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
            self.step(&instance, self.time(number), self.plan.step)?;
            held.push(self.read(&instance, &self.plan.outputs)?);
        }
        let Some(reference) = self.reference(library)? else { return Ok(()) };
        // A library may compute the same motion in another way.
        if let Some(difference) = self.difference(&reference, &held, Value::agrees_with) {
            let message =
                format!("in the run with derivatives of inputs that are zero, {difference}");
            self.journal.finding(Rule::InputDerivative, &message);
        }
        Ok(())
    }
}

/// Values of an output at the start value of an input, in the middle, and at another value of the input.
struct Differences {
    values: [f64; 3],
    /// Half the change of the input.
    half: f64,
}

/// Reads an output at three values of an input. The input then has the middle one, where a derivative can be asked: at a
/// start value the output may have a corner, and two derivatives.
fn differences(
    instance: &Instance<'_>,
    output: &Variable,
    input: &Variable,
    start: f64,
    other: f64,
) -> Result<Differences, Refused> {
    let half = (other - start) / 2.0;
    let read = |value: f64| {
        instance.write(&[(input.reference, &Value::Real(value))])?;
        let read = instance.read(Kind::Real, &[output.reference])?;
        Ok(read.first().and_then(Value::real).unwrap_or(f64::NAN))
    };
    let (at, far) = (read(start)?, read(other)?);
    let middle = read(start + half)?;
    Ok(Differences { values: [at, middle, far], half })
}

impl Differences {
    /// `true` if the output follows the input at once.
    fn has_followed(&self) -> bool {
        let [at, _, far] = self.values;
        far.to_bits() != at.to_bits()
    }

    /// Returns the derivative in the middle if the stated one is certainly another.
    fn contradict(&self, stated: f64) -> Option<f64> {
        let [at, middle, far] = self.values;
        let found = (far - at) / (2.0 * self.half);
        // A library may compute in single precision.
        let rounding = f64::from(f32::EPSILON) * at.abs().max(far.abs()) / self.half.abs();
        let error = ((far - middle) - (middle - at)).abs() / self.half.abs() + rounding;
        let is_known = self.has_followed() && error <= 0.1 * found.abs();
        let differs = (stated - found).abs() > 0.02 * found.abs() + 10.0 * error;
        (is_known && differs).then_some(found)
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

    #[test]
    fn a_stated_derivative_is_held_to_differences_that_are_known() {
        let of = |function: fn(f64) -> f64| Differences {
            values: [1.0, 1.005, 1.01].map(function),
            half: 0.005,
        };
        assert_eq!(of(|u| u * u).contradict(2.01), None);
        assert!(of(|u| u * u).contradict(-2.01).is_some());
        assert!(of(|u| u * u).contradict(2.4).is_some());
        // The output does not follow, or has a corner in between.
        assert_eq!(of(|_| 3.0).contradict(1.0), None);
        assert_eq!(of(|u| (u - 1.004).max(0.0)).contradict(0.0), None);
    }

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
