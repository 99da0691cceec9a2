//! The signals of a scene at work: what they make of its inputs at an instant.

use super::Variable;
use super::catalogue::{Quantity, variables};
use super::clock::NOTHING;
use super::values::{check_value, read_scene, write_scene};
use crate::Error;
use crate::scene::{Scene, Shape};

/// Long steps of exact motion must not blur the edges of signals, s.
const MOST_SLACK: f64 = 1e-9;

/// A scene whose inputs signals drive.
pub(super) struct Driven {
    /// The values that act: those of the scene as it is given, and what the signals add to them.
    pub(super) scene: Scene,
    /// What is driven, each by one signal or more.
    inputs: Vec<Input>,
    /// What times may be off by rounding, s.
    slack: f64,
}

struct Input {
    variable: Variable,
    /// The places of its signals in the scene.
    signals: Vec<usize>,
}

/// The values that act: those of the driven scene, or where nothing drives it, those given.
pub(super) fn acting<'a>(driven: Option<&'a Driven>, given: &'a Scene) -> &'a Scene {
    driven.map_or(given, |driven| &driven.scene)
}

impl Driven {
    /// The scene at work, so far as it is given; `None` if nothing drives it. It has been checked.
    pub(super) fn of(given: &Scene) -> Option<Self> {
        if given.signals.is_empty() {
            return None;
        }
        let mut inputs: Vec<Input> = Vec::new();
        for variable in variables(given) {
            let all = given.signals.iter().enumerate();
            let signals = all.filter(|(_, signal)| signal.input == variable.name);
            let signals: Vec<usize> = signals.map(|(i, _)| i).collect();
            if !signals.is_empty() {
                inputs.push(Input { variable, signals });
            }
        }
        Some(Self { scene: given.clone(), inputs, slack: (NOTHING * given.step).min(MOST_SLACK) })
    }

    /// Takes over other values of the same structure, so far as they are given.
    pub(super) fn restart(&mut self, given: &Scene) {
        self.scene.clone_from(given);
    }

    /// Brings the inputs to a step from one time to another (s), where without signals they would be as
    /// `given`: velocities of sliders are those at its end, where contacts are held, all others those at
    /// its beginning. Gives the variables whose value this changes to `changed`.
    ///
    /// # Errors
    /// A value that cannot be: which, when, and what it must be. That input stays as it is.
    pub(super) fn bring_to(
        &mut self,
        [start, end]: [f64; 2],
        given: &Scene,
        mut changed: impl FnMut(&Variable),
    ) -> Result<(), Error> {
        let mut result = Ok(());
        for Input { variable, signals } in &self.inputs {
            let value = |scene| read_scene(scene, variable).unwrap_or(0.0);
            let t = if is_velocity(variable) { end } else { start };
            let added = signals.iter().map(|&i| given.signals[i].shape.at(t, self.slack));
            let sum = added.fold(value(given), |sum, added| sum + added);
            if sum == value(&self.scene) {
                continue;
            }
            if let Err(error) = check_value(variable, sum) {
                let message = format!("at {t} s, with the scene's signals, {error}");
                result = result.and(Err(Error::step(message)));
                continue;
            }
            write_scene(&mut self.scene, variable, sum)?;
            changed(variable);
        }
        result
    }

    /// The time (s) up to which, but not including it, the inputs stay as they are at `t`; `t` itself
    /// while one of them changes.
    pub(super) fn constant_until(&self, t: f64) -> f64 {
        let shapes = self.scene.signals.iter().map(|signal| &signal.shape);
        shapes.fold(f64::INFINITY, |until, shape| until.min(shape.constant_until(t, self.slack)))
    }

    /// How fast the velocity of a contact's slider changes from time `t` (s) on, m/s².
    pub(super) fn slider_acceleration(&self, t: f64, contact: usize) -> f64 {
        self.of_slider(contact).fold(0.0, |sum, shape| sum + shape.rate(t, self.slack))
    }

    /// By how much the velocity of a contact's slider changes over a step, m/s.
    pub(super) fn slider_change(&self, [start, end]: [f64; 2], contact: usize) -> f64 {
        let at = |t: f64| self.of_slider(contact).fold(0.0, |sum, s| sum + s.at(t, self.slack));
        at(end) - at(start)
    }

    /// The driven external forces and preloads, with how fast they change from time `t` (s) on, per second.
    pub(super) fn load_rates(&self, t: f64) -> impl Iterator<Item = (&Variable, f64)> {
        let is_load = |input: &&Input| {
            matches!(input.variable.template.quantity, Quantity::ExternalForce | Quantity::Preload)
        };
        self.inputs.iter().filter(is_load).map(move |input| {
            let shapes = input.signals.iter().map(|&i| &self.scene.signals[i].shape);
            (&input.variable, shapes.fold(0.0, |sum, shape| sum + shape.rate(t, self.slack)))
        })
    }

    fn of_slider(&self, contact: usize) -> impl Iterator<Item = &Shape> {
        let own = self.scene.network().and_then(|network| network.contacts[contact].velocity);
        let drives_it = move |input: &&Input| match input.variable.template.quantity {
            Quantity::SliderVelocity => own.is_none(),
            Quantity::OwnVelocity => input.variable.index == contact,
            _ => false,
        };
        let signals = self.inputs.iter().filter(drives_it).flat_map(|input| &input.signals);
        signals.map(|&i| &self.scene.signals[i].shape)
    }
}

fn is_velocity(variable: &Variable) -> bool {
    matches!(variable.template.quantity, Quantity::SliderVelocity | Quantity::OwnVelocity)
}
