//! The rule by which a tolerance determines method and step, without runs of the scene.
//!
//! The relative error that the rule expects of a step h over a span T, where no mode without friction exceeds the
//! frequency ω:
//!
//! | method | relative error |
//! | --- | --- |
//! | forward increment | h ω (A + B ω T): an event is a step late, and frequencies are off by a part of h ω, which the phase gathers |
//! | event-driven | R (1 + ω T): rounding |
//!
//! Both methods also have the error of signals (`signals.rs`). Of the steps that keep the tolerance, the one with the
//! fewest operations ([`Cost`]) is taken. The numbers come from measured tables (`docs/decisions/tolerance.md`). The rule
//! does not include motions that forget their start, for which no such rule exists.

mod cost;
mod signals;

pub use cost::Cost;

use crate::decimal::{one_two_five, to_significant};
use crate::integrator::{EventDriven, Method};
use crate::model::LumpedModel;
use crate::scene::{Scene, Selection};
use crate::stability::{StepGuard, highest_frequency};
use std::f64::consts::TAU;
use std::fmt;

/// A: error of single events, in parts of h ω.
const EVENT: f64 = 2.5;
/// B: relative error of frequencies, in parts of h ω.
const DRIFT: f64 = 0.01;
/// R: rounding after one radian.
const ROUNDING: f64 = 5e-14;
/// Largest step of the scheme in parts of 1/ω; longer steps do not yet show the first order.
const LONGEST: f64 = 0.2;
/// Estimated number of changes of state of a contact in a period.
const EVENTS_A_PERIOD: f64 = 2.0;
/// Largest divisor of the series 1, 2, 5, 10, … by which steps divide the scene's output interval.
const MOST_PARTS: f64 = 1e8;
/// Significant digits of steps. An equal part of an interval has far fewer; further digits are rounding.
const STEP_DIGITS: usize = 12;
/// Largest number of steps of a run, which takes some minutes.
const MOST_STEPS: f64 = 1e9;

/// The method and step chosen for a tolerance.
///
/// ```
/// use amontons::selection::select;
///
/// let scene = amontons::scene::builtin("set1").expect("a built-in scene").scene();
/// let selected = select(&scene, 1e-3);
/// assert!(selected.is_kept() && selected.step > 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selected {
    /// The requested relative error.
    pub tolerance: f64,
    /// The method.
    pub method: Method,
    /// The step of the method, s.
    pub step: f64,
    /// The relative error that the rule expects; above the tolerance where no candidate keeps it.
    pub error: f64,
    /// The operations of a run, as [`Cost`] counts them.
    pub operations: f64,
}

impl Selected {
    /// `true` if the rule expects the tolerance to be kept.
    #[must_use]
    pub fn is_kept(&self) -> bool {
        self.error <= self.tolerance
    }

    /// A message about a tolerance that is not kept, with the error that is expected.
    #[must_use]
    pub fn shortfall(&self) -> Option<String> {
        let Self { tolerance, error, .. } = self;
        (!self.is_kept()).then(|| {
            format!(
                "no method and step are known to keep a relative error of {tolerance:e}; the expected error is {error:.0e}"
            )
        })
    }
}

impl fmt::Display for Selected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tolerance, method, step, error, operations } = self;
        write!(
            f,
            "{method}, step {step:e} s, for a relative error of {tolerance:e} (expected {error:.0e}, with \
             {operations:.1e} operations)"
        )
    }
}

/// Gives a scene the method and step that its tolerance chooses, if a tolerance chooses them; returns the choice.
pub fn resolve(scene: &mut Scene) -> Option<Selected> {
    let selected = select(scene, scene.selection.tolerance()?);
    (scene.method, scene.step, scene.selection) =
        (selected.method, selected.step, Selection::Given);
    Some(selected)
}

/// Chooses method and step for a scene's experiment by a tolerance, with the values as given. The choice is the same on
/// each machine.
#[must_use]
pub fn select(scene: &Scene, tolerance: f64) -> Selected {
    let model = LumpedModel::from(scene);
    let rule = SelectionRule::new(scene, &model);
    let candidate = |(method, step)| rule.candidate(tolerance, method, step);
    let mut left: Vec<Selected> = rule.steps().map(candidate).collect();
    // Among equal candidates the first is taken: the event-driven one with the longest step.
    while let Some(best) = cheapest_kept(&left).or_else(|| most_accurate(&left)) {
        let is_scheme = best.method == Method::ForwardIncrement;
        if !is_scheme || is_below_critical(&model, best.step) {
            return best;
        }
        left.retain(|one| one.method != best.method || one.step < best.step);
    }
    // A model that neither method takes is refused where its integrator is made.
    rule.candidate(tolerance, Method::EventDriven, scene.experiment.output_interval)
}

fn cheapest_kept(all: &[Selected]) -> Option<Selected> {
    let kept = all.iter().filter(|one| one.is_kept());
    kept.min_by(|a, b| a.operations.total_cmp(&b.operations)).copied()
}

fn most_accurate(all: &[Selected]) -> Option<Selected> {
    let order = |a: &&Selected, b: &&Selected| {
        a.error.total_cmp(&b.error).then(a.operations.total_cmp(&b.operations))
    };
    all.iter().min_by(order).copied()
}

/// `true` if a step of the scheme is below the critical one.
fn is_below_critical(model: &LumpedModel, step: f64) -> bool {
    StepGuard::new(model, step).check(model).is_ok()
}

/// The scene, and the properties of it that the rule uses.
struct SelectionRule<'a> {
    scene: &'a Scene,
    cost: Cost,
    /// Highest frequency ω, rad/s; `None` where none is known.
    frequency: Option<f64>,
    takes_event_driven: bool,
    /// Estimated number of changes of contact state in a run.
    events: f64,
}

impl<'a> SelectionRule<'a> {
    #[allow(clippy::cast_precision_loss)]
    fn new(scene: &'a Scene, model: &LumpedModel) -> Self {
        // A structure without springs moves within the span all the same.
        let slowest = TAU / scene.experiment.stop_time;
        let frequency = highest_frequency(model).map(|frequency| frequency.max(slowest));
        let periods = scene.experiment.stop_time * frequency.unwrap_or(0.0) / TAU;
        Self {
            scene,
            cost: Cost::of(model).driven(&scene.signals),
            frequency,
            takes_event_driven: EventDriven::new(model).is_ok(),
            events: EVENTS_A_PERIOD * model.contacts.len() as f64 * periods,
        }
    }

    /// Methods with their steps (s), the longest first.
    fn steps(&self) -> impl Iterator<Item = (Method, f64)> + '_ {
        let interval = self.scene.experiment.output_interval;
        let most = (MOST_STEPS * interval / self.scene.experiment.stop_time).min(MOST_PARTS);
        let parts = one_two_five().take_while(|parts| *parts <= most.max(1.0));
        let steps: Vec<f64> =
            parts.map(|parts| to_significant(interval / parts, STEP_DIGITS)).collect();
        let longest = self.frequency.map_or(0.0, |frequency| LONGEST / frequency);
        let scheme = steps.clone().into_iter().filter(move |step| *step <= longest);
        let exact = steps.into_iter().filter(|_| self.takes_event_driven);
        let exact = exact.map(|step| (Method::EventDriven, step));
        exact.chain(scheme.map(|step| (Method::ForwardIncrement, step)))
    }

    fn candidate(&self, tolerance: f64, method: Method, step: f64) -> Selected {
        let span = self.scene.experiment.stop_time;
        let operations = self.cost.run(method, step, span, self.events);
        Selected { tolerance, method, step, error: self.error(method, step), operations }
    }

    /// The expected relative error.
    fn error(&self, method: Method, step: f64) -> f64 {
        let frequency = self.frequency.unwrap_or(0.0);
        let passed = frequency * self.scene.experiment.stop_time;
        let own = match method {
            Method::ForwardIncrement => frequency * step * (EVENT + DRIFT * passed),
            Method::EventDriven => ROUNDING * (1.0 + passed),
        };
        let all = self.scene.signals.iter();
        all.fold(own, |sum, signal| {
            sum + signals::error(signal, self.scene, method, step, frequency)
        })
    }
}
