//! Inputs that change over a step: what the signals of a scene, and the rates that an importer gives, make of
//! them at an instant.

use super::Variable;
use super::catalogue::{Quantity, variables};
use super::clock::NOTHING;
use super::values::{check_value, read_scene, write_scene};
use crate::Error;
use crate::error::Short;
use crate::integrator::Wave;
use crate::scene::{Method, Scene, Shape, Sine};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Long steps of exact motion must not blur the edges of signals, s.
const MOST_SLACK: f64 = 1e-9;

/// A scene whose inputs signals or rates drive.
pub(super) struct Driven {
    /// The values that act: those of the scene as it is given, and what the signals add to them.
    pub(super) scene: Scene,
    /// What is driven.
    inputs: Vec<Input>,
    /// What times may be off by rounding, s.
    slack: f64,
    /// Does the motion follow what drives it within a step? Else it takes values at the ends of steps.
    is_followed: bool,
}

struct Input {
    variable: Variable,
    /// The places of its signals in the scene.
    signals: Vec<usize>,
    /// What an importer adds to it over a step.
    ramp: Option<InputRamp>,
}

/// What is added to an input over one step of whoever gives it: nothing at `origin` (s), and from there `rate` per
/// second more.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct InputRamp {
    pub(super) origin: f64,
    pub(super) rate: f64,
    /// Has its step been taken? Then it only says how fast the input changed up to now.
    pub(super) is_over: bool,
}

/// What an input acts on: degrees of freedom with the force that one unit of it is, N, and contacts whose sliders it
/// moves.
#[derive(Default)]
pub(super) struct Reach {
    pub(super) pushes: Vec<(usize, f64)>,
    pub(super) moves: Vec<usize>,
}

impl InputRamp {
    fn at(self, t: f64) -> f64 {
        self.rate * (t - self.origin)
    }
}

/// The values that act: those of the driven scene, or where nothing drives it, those given.
pub(super) fn acting<'a>(driven: Option<&'a Driven>, given: &'a Scene) -> &'a Scene {
    driven.map_or(given, |driven| &driven.scene)
}

impl Driven {
    /// The scene at work, so far as it is given; `None` if it has no signals. It has been checked.
    pub(super) fn of(given: &Scene) -> Option<Self> {
        (!given.signals.is_empty()).then(|| Self::new(given))
    }

    /// The scene at work, whether it has signals or not.
    pub(super) fn new(given: &Scene) -> Self {
        let mut inputs: Vec<Input> = Vec::new();
        for variable in variables(given) {
            let all = given.signals.iter().enumerate();
            let signals = all.filter(|(_, signal)| signal.input == variable.name);
            let signals: Vec<usize> = signals.map(|(i, _)| i).collect();
            if !signals.is_empty() {
                inputs.push(Input { variable, signals, ramp: None });
            }
        }
        let slack = (NOTHING * given.step).min(MOST_SLACK);
        let is_followed = given.method == Method::EventDriven;
        Self { scene: given.clone(), inputs, slack, is_followed }
    }

    /// Gives an input this ramp, in place of the one that it has.
    pub(super) fn set_ramp(&mut self, variable: &Variable, ramp: InputRamp) {
        // Hosts give a rate of zero to what does not change: then each step is like the one before.
        let ramp = Some(ramp).filter(|ramp| ramp.rate != 0.0);
        match self.inputs.iter_mut().find(|input| input.is(variable)) {
            Some(input) => input.ramp = ramp,
            None if ramp.is_none() => {}
            None => {
                self.inputs.push(Input { variable: variable.clone(), signals: Vec::new(), ramp });
            }
        }
    }

    /// Takes all ramps away, or those whose step has been taken. Their inputs stay among those that are looked
    /// after, and so become again what they are given as.
    pub(super) fn drop_ramps(&mut self, all: bool) {
        for Input { ramp, .. } in &mut self.inputs {
            ramp.take_if(|ramp| all || ramp.is_over);
        }
    }

    /// Takes over another value that an input is given, until the next step adds to it again. How fast the input
    /// has changed up to now is no longer true then.
    ///
    /// # Errors
    /// The variable is an output.
    pub(super) fn write(&mut self, variable: &Variable, value: f64) -> Result<(), Error> {
        if let Some(input) = self.inputs.iter_mut().find(|input| input.is(variable)) {
            input.ramp.take_if(|ramp| ramp.is_over);
        }
        write_scene(&mut self.scene, variable, value)
    }

    /// The inputs that have ramps.
    pub(super) fn ramps(&self) -> impl Iterator<Item = (&Variable, InputRamp)> {
        self.inputs.iter().filter_map(|input| Some((&input.variable, input.ramp?)))
    }

    /// The values that the ramps lead to by time `end` (s), where without them the inputs are as `given`.
    ///
    /// # Errors
    /// A value that cannot be.
    pub(super) fn check_ramps(&self, end: f64, given: &Scene) -> Result<(), Error> {
        for (variable, ramp) in self.ramps().filter(|(_, ramp)| !ramp.is_over) {
            let value = read_scene(given, variable).unwrap_or(0.0) + ramp.at(end);
            check_value(variable, value).map_err(|error| {
                let rate = ramp.rate;
                Error::step(format!(
                    "at {} s, with a rate of {rate:?} per second, {error}",
                    Short(end)
                ))
            })?;
        }
        Ok(())
    }

    /// Ends the step of the ramps at time `end` (s): what they have led to is given from now on.
    ///
    /// # Errors
    /// None: what has a ramp can be written.
    pub(super) fn end_ramps(&mut self, end: f64, given: &mut Scene) -> Result<(), Error> {
        for Input { variable, ramp, .. } in &mut self.inputs {
            let Some(ramp) = ramp.as_mut().filter(|ramp| !ramp.is_over) else { continue };
            let value = read_scene(given, variable).unwrap_or(0.0) + ramp.at(end);
            write_scene(given, variable, value)?;
            (ramp.origin, ramp.is_over) = (end, true);
        }
        Ok(())
    }

    /// Takes over other values of the same structure, so far as they are given.
    pub(super) fn restart(&mut self, given: &Scene) {
        self.scene.clone_from(given);
    }

    /// Brings the inputs to a step from one time to another (s), where without signals they would be as
    /// `given`: velocities of sliders are those at its end, where contacts are held (in exact motion those that lead
    /// there, before any jump), all others those at its beginning. Gives the variables whose value this changes to `changed`.
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
        for Input { variable, signals, ramp } in &self.inputs {
            let value = |scene| read_scene(scene, variable).unwrap_or(0.0);
            let t = if is_velocity(variable) { end } else { start };
            let from = if self.is_followed { start } else { t };
            let added = signals.iter().map(|&i| given.signals[i].shape.onward(from, t, self.slack));
            let given = ramp.map_or(value(given), |ramp| value(given) + ramp.at(t));
            let sum = added.fold(given, |sum, added| sum + added);
            if sum == value(&self.scene) {
                continue;
            }
            if let Err(error) = check_value(variable, sum) {
                let by = if signals.is_empty() { "its rate" } else { "the scene's signals" };
                let message = format!("at {} s, with {by}, {error}", Short(t));
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
        if self.ramps().any(|(_, ramp)| !ramp.is_over) {
            return t;
        }
        let shapes = self.scene.signals.iter().map(|signal| &signal.shape);
        shapes.fold(f64::INFINITY, |until, shape| until.min(shape.constant_until(t, self.slack)))
    }

    /// How fast the velocity of a contact's slider changes from time `t` (s) on, m/s².
    pub(super) fn slider_acceleration(&self, t: f64, contact: usize) -> f64 {
        self.of_slider(contact).fold(0.0, |sum, input| self.rate(input, t, sum))
    }

    /// By how much the velocity of a contact's slider changes over a step, m/s.
    pub(super) fn slider_change(&self, [start, end]: [f64; 2], contact: usize) -> f64 {
        let at = |t: f64| {
            let from = if self.is_followed { start } else { t };
            let inputs = self.of_slider(contact);
            inputs.fold(0.0, |sum, input| {
                let ramp = input.ramp.map_or(0.0, |ramp| ramp.at(t));
                let shapes = self.shapes(input);
                shapes.fold(sum + ramp, |sum, shape| sum + shape.onward(from, t, self.slack))
            })
        };
        at(end) - at(start)
    }

    /// Is it one of the waves?
    fn is_wave(&self, shape: &Shape) -> bool {
        self.is_followed && matches!(shape, Shape::Sine(_))
    }

    /// The sines that drive the motion, where `reach` says what an input acts on; none where the motion takes values
    /// at the ends of steps.
    pub(super) fn waves(&self, reach: impl Fn(&Variable) -> Reach) -> Vec<Wave> {
        let wave = |(variable, sine): (&Variable, &Sine)| {
            let Reach { pushes, moves } = reach(variable);
            let pulsation = TAU * sine.frequency;
            Wave { amplitude: 0.0, pulsation, phase: 0.0, pushes, moves }
        };
        self.sines().map(wave).collect()
    }

    /// Brings waves to a step that begins at time `t` (s).
    pub(super) fn bring_waves(&self, t: f64, waves: &mut [Wave]) {
        for (wave, (_, sine)) in waves.iter_mut().zip(self.sines()) {
            wave.amplitude = if sine.is_on(t + self.slack) { sine.amplitude } else { 0.0 };
            wave.phase = sine.phase_at(t);
        }
    }

    /// The sines that are waves, each with the input that it drives.
    fn sines(&self) -> impl Iterator<Item = (&Variable, &Sine)> {
        let all = self.inputs.iter().filter(|_| self.is_followed);
        all.flat_map(move |input| {
            self.shapes(input).filter_map(|shape| match shape {
                Shape::Sine(sine) => Some((&input.variable, sine)),
                _ => None,
            })
        })
    }

    /// The first edge of a signal after time `t` (s), before `end`, that the motion must stop at.
    pub(super) fn edge_between(&self, t: f64, end: f64) -> Option<f64> {
        if !self.is_followed {
            return None;
        }
        let shapes = self.scene.signals.iter().map(|signal| &signal.shape);
        let edges = shapes.map(|shape| shape.next_edge(t, self.slack));
        Some(edges.fold(f64::INFINITY, f64::min)).filter(|edge| edge + self.slack < end)
    }

    /// How fast the acceleration of a contact's slider changes from time `t` (s) on, m/s³.
    pub(super) fn slider_jerk(&self, t: f64, contact: usize) -> f64 {
        let shapes = self.of_slider(contact).flat_map(|input| self.shapes(input));
        shapes.fold(0.0, |sum, shape| sum + shape.curvature(t, self.slack))
    }

    /// The driven inputs, with how fast they change from time `t` (s) on, per second.
    pub(super) fn rates(&self, t: f64) -> impl Iterator<Item = (&Variable, f64)> {
        self.inputs.iter().map(move |input| (&input.variable, self.rate(input, t, 0.0)))
    }

    /// The driven external forces and preloads, with how fast they change from time `t` (s) on, per second,
    /// [`waves`](Self::waves) apart.
    pub(super) fn load_rates(&self, t: f64) -> impl Iterator<Item = (&Variable, f64)> {
        let loads = self.inputs.iter().filter(|input| {
            let quantity = input.variable.template.quantity;
            matches!(quantity, Quantity::ExternalForce | Quantity::Preload)
        });
        loads.map(move |input| {
            let ramp = input.ramp.map_or(0.0, |ramp| ramp.rate);
            let shapes = self.shapes(input).filter(|shape| !self.is_wave(shape));
            let rate = shapes.fold(0.0 + ramp, |sum, shape| sum + shape.rate(t, self.slack));
            (&input.variable, rate)
        })
    }

    /// `sum` and how fast an input changes from time `t` (s) on, per second.
    fn rate(&self, input: &Input, t: f64, sum: f64) -> f64 {
        let ramp = input.ramp.map_or(0.0, |ramp| ramp.rate);
        self.shapes(input).fold(sum + ramp, |sum, shape| sum + shape.rate(t, self.slack))
    }

    fn shapes<'a>(&'a self, input: &'a Input) -> impl Iterator<Item = &'a Shape> {
        input.signals.iter().map(|&i| &self.scene.signals[i].shape)
    }

    fn of_slider(&self, contact: usize) -> impl Iterator<Item = &Input> {
        let own = self.scene.network().and_then(|network| network.contacts[contact].velocity);
        self.inputs.iter().filter(move |input| match input.variable.template.quantity {
            Quantity::SliderVelocity => own.is_none(),
            Quantity::OwnVelocity => input.variable.index == contact,
            _ => false,
        })
    }
}

impl Input {
    /// Is it this variable?
    fn is(&self, variable: &Variable) -> bool {
        std::ptr::eq(self.variable.template, variable.template)
            && self.variable.index == variable.index
    }
}

fn is_velocity(variable: &Variable) -> bool {
    matches!(variable.template.quantity, Quantity::SliderVelocity | Quantity::OwnVelocity)
}

/// The scene as it is at time `t` (s): its signals are added to what they drive, and then left out.
///
/// # Errors
/// A signal gives a value that cannot be.
pub fn at_instant(scene: &Scene, t: f64) -> Result<Scene, Error> {
    let Some(mut driven) = Driven::of(scene) else { return Ok(scene.clone()) };
    driven.bring_to([t, t], scene, |_| {})?;
    let mut found = driven.scene;
    found.signals = [].into();
    Ok(found)
}
