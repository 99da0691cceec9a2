//! The outputs of a run, and the comparison of two runs.

use super::Subject;
use crate::rules::Rule;

/// Values of all outputs after each step, as bits.
pub(super) type OutputHistory = Vec<Vec<u64>>;

impl Subject<'_> {
    pub(super) fn finite(&self, course: &OutputHistory) {
        for (step, values) in (1..).zip(course) {
            for ((name, _), bits) in self.plan.reals.iter().zip(values) {
                let value = f64::from_bits(*bits);
                if !value.is_finite() {
                    let time = self.plan.start + f64::from(step) * self.plan.step;
                    let message = format!("the output {name} is {value} at {time} s");
                    self.journal.finding(Rule::OutputNotFinite, &message);
                    return;
                }
            }
        }
    }

    /// Describes the first difference between two runs in words.
    pub(super) fn difference(&self, one: &[Vec<u64>], other: &[Vec<u64>]) -> String {
        for (step, (one, other)) in (1..).zip(one.iter().zip(other)) {
            let Some(at) = one.iter().zip(other).position(|(one, other)| one != other) else {
                continue;
            };
            return match self.plan.reals.get(at) {
                Some((name, _)) => {
                    let [one, other] = [one[at], other[at]].map(f64::from_bits);
                    format!(
                        "{name} is {other:?} after step {step}, but was {one:?} in the first run"
                    )
                }
                None => format!(
                    "an Integer or Boolean output is {} after step {step}, but was {} in the first run",
                    other[at], one[at]
                ),
            };
        }
        "the number of completed steps is different".to_owned()
    }
}
