//! The rule by which a tolerance chooses method and step, without runs of the scene.
//!
//! What it expects of a step h over a span T, with the frequency ω that no mode without friction exceeds:
//!
//! | method | relative error |
//! | --- | --- |
//! | forward increment | h ω (A + B ω T): an event is a step late, and frequencies are off by a part of h ω, which the phase gathers |
//! | event-driven | R (1 + ω T): rounding |
//!
//! and with either what it makes of signals (`signals.rs`). Of the steps that keep the tolerance that with the
//! fewest operations ([`Cost`]) is taken. The numbers come from measured tables (DESIGN.md). It knows nothing of
//! motions that forget their start, for which no rule can.

mod cost;
mod signals;

pub use cost::Cost;

use crate::decimal::{one_two_five, to_significant};
use crate::integrator::{EventDriven, Method};
use crate::model::LumpedModel;
use crate::scene::Scene;
use crate::stability::{StepGuard, highest_frequency};
use std::f64::consts::TAU;
use std::fmt;

/// A: what the errors of single events come to.
const EVENT: f64 = 2.5;
/// B: what a step of the scheme makes of a frequency.
const DRIFT: f64 = 0.01;
/// R: what rounding leaves after one radian.
const ROUNDING: f64 = 5e-14;
/// Steps of the scheme above this part of 1/ω are not of first order yet.
const LONGEST: f64 = 0.2;
/// Contacts change their state about so often in a period.
const EVENTS_A_PERIOD: f64 = 2.0;
/// Steps are the scene's output interval over 1, 2, 5, 10, … up to so much.
const MOST_PARTS: f64 = 1e8;
/// As equal parts of an interval steps are known to far fewer significant digits; beyond these is what rounding has left.
const STEP_DIGITS: usize = 12;
/// A run may have so many steps, which take some minutes.
const MOST_STEPS: f64 = 1e9;

/// The method and step that were chosen by a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selected {
    /// The relative error that was asked for.
    pub tolerance: f64,
    /// The method.
    pub method: Method,
    /// Its step, s.
    pub step: f64,
    /// The relative error that the rule expects; above the tolerance where nothing keeps that.
    pub error: f64,
    /// The operations of a run, as [`Cost`] counts them.
    pub operations: f64,
}

impl Selected {
    /// Is the tolerance kept, as far as the rule knows?
    #[must_use]
    pub fn is_kept(&self) -> bool {
        self.error <= self.tolerance
    }

    /// Words on a tolerance that is not kept, with the error that is.
    #[must_use]
    pub fn shortfall(&self) -> Option<String> {
        let Self { tolerance, error, .. } = self;
        (!self.is_kept()).then(|| {
            format!(
                "no method and step are known to keep a relative error of {tolerance:e}; expected is {error:.0e}"
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

/// Chooses method and step for a scene's experiment by a tolerance, with the values as they are given. The
/// same on each machine.
#[must_use]
pub fn select(scene: &Scene, tolerance: f64) -> Selected {
    let model = LumpedModel::from(scene);
    let rule = SelectionRule::new(scene, &model);
    let candidate = |(method, step)| rule.candidate(tolerance, method, step);
    let mut left: Vec<Selected> = rule.steps().map(candidate).collect();
    // Of equal ones the first: the event-driven one with the longest step.
    while let Some(best) = cheapest_kept(&left).or_else(|| most_accurate(&left)) {
        let is_scheme = best.method == Method::ForwardIncrement;
        if !is_scheme || is_below_critical(&model, best.step) {
            return best;
        }
        left.retain(|one| one.method != best.method || one.step < best.step);
    }
    // What neither method takes is refused where its integrator is made.
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

/// Is a step of the scheme below the critical one?
fn is_below_critical(model: &LumpedModel, step: f64) -> bool {
    StepGuard::new(model, step).check(model).is_ok()
}

/// What the rule knows of a scene.
struct SelectionRule<'a> {
    scene: &'a Scene,
    cost: Cost,
    /// ω, rad/s; `None` where none is known.
    frequency: Option<f64>,
    takes_event_driven: bool,
    /// About how often contacts change their state.
    events: f64,
}

impl<'a> SelectionRule<'a> {
    #[allow(clippy::cast_precision_loss)]
    fn new(scene: &'a Scene, model: &LumpedModel) -> Self {
        // What has no springs moves within the span all the same.
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

    /// The relative error that is to be expected.
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
