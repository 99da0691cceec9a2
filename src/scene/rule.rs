//! What values must be, and the list of those that are not.

use crate::Error;

/// The most impossible values that one message lists.
const MAX_PROBLEMS: usize = 20;

/// What is wrong with a scene, one line each.
#[derive(Default)]
pub(super) struct Problems(Vec<String>);

impl Problems {
    /// Takes note of a problem.
    pub(super) fn add(&mut self, problem: String) {
        self.0.push(problem);
    }

    /// Takes note of a value that breaks its rule.
    pub(super) fn check(&mut self, name: impl FnOnce() -> String, value: f64, rule: Rule) {
        if let Some(wish) = rule.broken_by(value) {
            self.0.push(format!("{} = {value}: {wish}", name()));
        }
    }

    /// All problems, up to twenty, as one error.
    pub(super) fn into_result(self) -> Result<(), Error> {
        let Self(mut problems) = self;
        if problems.is_empty() {
            return Ok(());
        }
        let more = problems.len().saturating_sub(MAX_PROBLEMS);
        problems.truncate(MAX_PROBLEMS);
        if more > 0 {
            problems.push(format!("and {more} more"));
        }
        Err(Error::scene(problems.join("\n")))
    }
}

/// What a value must be.
#[derive(Clone, Copy)]
pub(super) enum Rule {
    Finite,
    NotNegative,
    Positive,
    NotInsideSlider,
    QuarterTurn,
}

impl Rule {
    /// What would be right, if `value` breaks the rule.
    fn broken_by(self, value: f64) -> Option<&'static str> {
        if !value.is_finite() {
            return Some("must be a finite number");
        }
        match self {
            Self::NotNegative if value < 0.0 => Some("must not be negative"),
            Self::Positive if value <= 0.0 => Some("must be above zero"),
            Self::NotInsideSlider if value < 0.0 => {
                Some("starts inside the slider; a displacement along the normal must be ≥ 0")
            }
            Self::QuarterTurn if value.abs() > std::f64::consts::FRAC_PI_2 => {
                Some("must be between −π/2 and π/2 rad (30° are 0.5236)")
            }
            _ => None,
        }
    }
}
