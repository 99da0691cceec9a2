//! Inputs that change during a step: their values at an instant, from the signals of a scene and the rates of an importer.

use super::catalogue::Quantity;
use super::clock::NOTHING;
use super::values::{check_value, place_in, write_scene};
use super::{Parameters, Variable};
use crate::Error;
use crate::contact::Friction;
use crate::error::Short;
use crate::integrator::Wave;
use crate::model::LumpedModel;
use crate::scene::{Method, Scene, Shape, Signal, Sine};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Largest slack of a time, s, so that long steps of event-driven motion do not blur the edges of signals.
const MOST_SLACK: f64 = 1e-9;

/// The inputs that signals or rates drive. The effective value of an input is its nominal value plus their contributions.
pub(super) struct DrivenInputs {
    inputs: Vec<Input>,
    signals: Arc<[Signal]>,
    /// Largest rounding error of a time, s.
    slack: f64,
    /// `true` if the motion follows signals within a step. If `false`, it uses values at the ends of steps.
    is_followed: bool,
}

struct Input {
    variable: Variable,
    /// Index of the input's nominal value among all parameters.
    place: usize,
    /// Present effective value of the input.
    effective: f64,
    /// Contacts whose surface the input moves, in ascending order.
    moves: Vec<usize>,
    /// Contacts whose µ_k or µ_s the input changes, each with the changes for one unit of the input.
    friction: Vec<(usize, [f64; 2])>,
    /// Indices of the input's signals in the scene.
    signals: Vec<usize>,
    /// Ramp that an importer adds to the input over a step.
    ramp: Option<InputRamp>,
}

/// Ramp that is added to an input over one step of the importer: zero at `origin` (s), then growing by `rate` per second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct InputRamp {
    pub(super) origin: f64,
    pub(super) rate: f64,
    /// `true` if the step of the ramp has been taken. The ramp then only gives the rate of change up to now.
    pub(super) is_over: bool,
}

/// Effect of an input: degrees of freedom with the force for one unit of the input, N, and contacts whose sliders it moves.
#[derive(Default)]
pub(super) struct InputEffect {
    pub(super) pushes: Vec<(usize, f64)>,
    pub(super) moves: Vec<usize>,
}

impl InputRamp {
    fn at(self, t: f64) -> f64 {
        self.rate * (t - self.origin)
    }
}

/// The contacts whose surface an input moves, in ascending order: contacts without their own velocity move with the slider.
pub(super) fn moved_contacts(scene: &Scene, input: &Variable) -> Vec<usize> {
    let has_own = |contact: usize| {
        scene.contact_definition(contact).is_some_and(|place| place.velocity.is_some())
    };
    match input.template.quantity {
        Quantity::SliderVelocity => (0..scene.contact_count()).filter(|i| !has_own(*i)).collect(),
        Quantity::OwnVelocity => vec![input.index],
        _ => Vec::new(),
    }
}

/// The contacts whose µ_k or µ_s an input changes, each with the changes for one unit of the input.
fn changed_friction(scene: &Scene, input: &Variable) -> Vec<(usize, [f64; 2])> {
    let drives_friction = matches!(
        input.template.quantity,
        Quantity::FrictionCoefficient
            | Quantity::StaticFriction
            | Quantity::OwnFriction
            | Quantity::OwnStaticFriction
    );
    if !drives_friction {
        return Vec::new();
    }
    let mut other = scene.clone();
    let Some(value) = place_in(&mut other, input) else { return Vec::new() };
    *value += 1.0;
    let changes = (0..scene.contact_count()).map(|contact| {
        let [old, new] = [scene, &other].map(|scene| scene.friction_of(contact));
        // Each is 0 or 1.
        let change = |part: fn(&Friction) -> f64| (part(&new) - part(&old)).round();
        (contact, [change(|friction| friction.kinetic), change(|friction| friction.static_)])
    });
    changes.filter(|(_, change)| *change != [0.0; 2]).collect()
}

impl Input {
    fn new(scene: &Scene, nominal: &Parameters, place: usize) -> Self {
        let variable = nominal.variable(place).expect("a place among the parameters").clone();
        let moves = moved_contacts(scene, &variable);
        let (effective, friction) = (nominal.number(place), changed_friction(scene, &variable));
        Self { variable, place, effective, moves, friction, signals: Vec::new(), ramp: None }
    }
}

impl DrivenInputs {
    /// The inputs driven by the signals of a scene, which has been checked; `None` if there are no signals.
    pub(super) fn of(scene: &Scene, nominal: &Parameters) -> Option<Self> {
        (!scene.signals.is_empty()).then(|| Self::new(scene, nominal))
    }

    /// The inputs driven by the signals of a scene, possibly none.
    pub(super) fn new(scene: &Scene, nominal: &Parameters) -> Self {
        let mut inputs: Vec<Input> = Vec::new();
        for (place, (variable, _)) in nominal.iter().enumerate() {
            let all = scene.signals.iter().enumerate();
            let signals = all.filter(|(_, signal)| signal.input == variable.name);
            let signals: Vec<usize> = signals.map(|(i, _)| i).collect();
            if !signals.is_empty() {
                inputs.push(Input { signals, ..Input::new(scene, nominal, place) });
            }
        }
        let slack = (NOTHING * scene.step).min(MOST_SLACK);
        let is_followed = scene.method == Method::EventDriven;
        Self { inputs, signals: Arc::clone(&scene.signals), slack, is_followed }
    }

    /// Sets the ramp of the input whose nominal value has this index, in place of its present ramp.
    pub(super) fn set_ramp(
        &mut self,
        place: usize,
        ramp: InputRamp,
        scene: &Scene,
        nominal: &Parameters,
    ) {
        // Hosts give a rate of zero to inputs that do not change; without a ramp, each step is like the one before.
        let ramp = Some(ramp).filter(|ramp| ramp.rate != 0.0);
        match self.inputs.iter_mut().find(|input| input.place == place) {
            Some(input) => input.ramp = ramp,
            None if ramp.is_none() => {}
            None => self.inputs.push(Input { ramp, ..Input::new(scene, nominal, place) }),
        }
    }

    /// Removes all ramps, or those whose step has been taken. Their inputs remain in the list, and so return to their
    /// nominal values.
    pub(super) fn drop_ramps(&mut self, all: bool) {
        for Input { ramp, .. } in &mut self.inputs {
            ramp.take_if(|ramp| all || ramp.is_over);
        }
    }

    /// Records a new nominal value, which is the effective one until the next step adds to it. The rate of change up
    /// to now is then no longer valid.
    pub(super) fn value_is_set(&mut self, variable: &Variable, value: f64) {
        if let Some(input) = self.inputs.iter_mut().find(|input| input.variable.is(variable)) {
            input.ramp.take_if(|ramp| ramp.is_over);
            input.effective = value;
        }
    }

    /// The ramps, each with the index of its input's nominal value.
    pub(super) fn ramps(&self) -> impl Iterator<Item = (usize, InputRamp)> {
        self.inputs.iter().filter_map(|input| Some((input.place, input.ramp?)))
    }

    /// Checks the values that the ramps reach at time `end` (s).
    ///
    /// # Errors
    /// Returns an error if such a value is impossible.
    pub(super) fn check_ramps(&self, end: f64, nominal: &Parameters) -> Result<(), Error> {
        for Input { variable, place, ramp, .. } in &self.inputs {
            let Some(ramp) = ramp.filter(|ramp| !ramp.is_over) else { continue };
            check_value(variable, nominal.number(*place) + ramp.at(end)).map_err(|error| {
                let rate = ramp.rate;
                Error::step(format!(
                    "at {} s, with a rate of {rate:?} per second, {error}",
                    Short(end)
                ))
            })?;
        }
        Ok(())
    }

    /// Ends the step of the ramps at time `end` (s): the values that they have reached become the nominal ones.
    pub(super) fn end_ramps(&mut self, end: f64, nominal: &mut Parameters) {
        for Input { place, ramp, .. } in &mut self.inputs {
            let Some(ramp) = ramp.as_mut().filter(|ramp| !ramp.is_over) else { continue };
            *nominal.number_mut(*place) += ramp.at(end);
            (ramp.origin, ramp.is_over) = (end, true);
        }
    }

    /// Makes the nominal values in `scene` the effective ones, until the next step adds to them.
    pub(super) fn restart(&mut self, nominal: &Parameters, scene: &mut Scene) {
        for Input { variable, place, effective, .. } in &mut self.inputs {
            *effective = nominal.number(*place);
            write_scene(scene, variable, *effective).expect("inputs can be written");
        }
    }

    /// Updates the effective values in `scene` for a step between two times (s). Velocities of sliders take their
    /// values at its end, since contacts are enforced there (in event-driven motion the values before any jump at the
    /// end); all other inputs take their values at its beginning. Calls `changed` with each variable whose value
    /// changes.
    ///
    /// # Errors
    /// Returns an error that names the impossible value, its time and its rule. The input then keeps its value.
    pub(super) fn bring_to(
        &mut self,
        [start, end]: [f64; 2],
        nominal: &Parameters,
        scene: &mut Scene,
        mut changed: impl FnMut(&Variable),
    ) -> Result<(), Error> {
        let mut result = Ok(());
        for Input { variable, place, effective, signals, ramp, .. } in &mut self.inputs {
            let t = if is_velocity(variable) { end } else { start };
            let from = if self.is_followed { start } else { t };
            let added = signals.iter().map(|&i| self.signals[i].shape.onward(from, t, self.slack));
            let nominal = nominal.number(*place);
            let nominal = ramp.map_or(nominal, |ramp| nominal + ramp.at(t));
            let sum = added.fold(nominal, |sum, added| sum + added);
            if sum == *effective {
                continue;
            }
            if let Err(error) = check_value(variable, sum) {
                let by = if signals.is_empty() { "its rate" } else { "the scene's signals" };
                let message = format!("at {} s, with {by}, {error}", Short(t));
                result = result.and(Err(Error::step(message)));
                continue;
            }
            write_scene(scene, variable, sum)?;
            *effective = sum;
            changed(variable);
        }
        result
    }

    /// Time (s) up to which, exclusively, the inputs stay as they are at `t`; `t` itself while one of them changes.
    pub(super) fn constant_until(&self, t: f64) -> f64 {
        if self.ramps().any(|(_, ramp)| !ramp.is_over) {
            return t;
        }
        let shapes = self.signals.iter().map(|signal| &signal.shape);
        shapes.fold(f64::INFINITY, |until, shape| until.min(shape.constant_until(t, self.slack)))
    }

    /// Acceleration of a contact's slider from time `t` (s) on, m/s².
    pub(super) fn slider_acceleration(&self, t: f64, contact: usize) -> f64 {
        self.of_slider(contact).fold(0.0, |sum, input| self.rate(input, t, sum))
    }

    /// Change of the velocity of a contact's slider during a step, m/s.
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

    /// `true` if the shape is a sine that the motion follows within a step.
    fn is_wave(&self, shape: &Shape) -> bool {
        self.is_followed && matches!(shape, Shape::Sine(_))
    }

    /// The sines that drive the motion; `reach` gives the effect of an input. Empty if the motion uses values at the
    /// ends of steps.
    pub(super) fn waves(&self, effect_of: impl Fn(&Variable) -> InputEffect) -> Vec<Wave> {
        let wave = |(input, sine): (&Input, &Sine)| {
            let InputEffect { pushes, moves } = effect_of(&input.variable);
            let (pulsation, friction) = (TAU * sine.frequency, input.friction.clone());
            Wave { amplitude: 0.0, pulsation, phase: 0.0, pushes, moves, friction }
        };
        self.sines().map(wave).collect()
    }

    /// Updates the waves for a step that begins at time `t` (s). They change friction only where `model` has any.
    pub(super) fn bring_waves(&self, t: f64, model: &LumpedModel, waves: &mut [Wave]) {
        for (wave, (input, sine)) in waves.iter_mut().zip(self.sines()) {
            wave.amplitude = if sine.is_on(t + self.slack) { sine.amplitude } else { 0.0 };
            wave.phase = sine.phase_at(t);
            for ((contact, change), (_, own)) in wave.friction.iter_mut().zip(&input.friction) {
                let rubs = model.rubs(&model.contacts[*contact]);
                *change = if rubs { *own } else { [0.0; 2] };
            }
        }
    }

    /// The sines that the motion follows as waves, each with the input that it drives.
    fn sines(&self) -> impl Iterator<Item = (&Input, &Sine)> {
        let all = self.inputs.iter().filter(|_| self.is_followed);
        all.flat_map(move |input| {
            self.shapes(input).filter_map(move |shape| match shape {
                Shape::Sine(sine) => Some((input, sine)),
                _ => None,
            })
        })
    }

    /// The first edge of a signal after time `t` (s) and before `end` at which the motion must stop.
    pub(super) fn edge_between(&self, t: f64, end: f64) -> Option<f64> {
        if !self.is_followed {
            return None;
        }
        let shapes = self.signals.iter().map(|signal| &signal.shape);
        let edges = shapes.map(|shape| shape.next_edge(t, self.slack));
        Some(edges.fold(f64::INFINITY, f64::min)).filter(|edge| edge + self.slack < end)
    }

    /// Jerk of a contact's slider from time `t` (s) on, m/s³.
    pub(super) fn slider_jerk(&self, t: f64, contact: usize) -> f64 {
        let shapes = self.of_slider(contact).flat_map(|input| self.shapes(input));
        shapes.fold(0.0, |sum, shape| sum + shape.curvature(t, self.slack))
    }

    /// The driven inputs, with their rates of change from time `t` (s) on, per second.
    pub(super) fn rates(&self, t: f64) -> impl Iterator<Item = (&Variable, f64)> {
        self.inputs.iter().map(move |input| (&input.variable, self.rate(input, t, 0.0)))
    }

    /// The driven external forces and preloads, with their rates of change from time `t` (s) on, per second, without
    /// the [`waves`](Self::waves).
    pub(super) fn load_rates(&self, t: f64) -> impl Iterator<Item = (&Variable, f64)> {
        let loads = self.inputs.iter().filter(|input| {
            let quantity = input.variable.template.quantity;
            matches!(quantity, Quantity::ExternalForce | Quantity::Preload)
        });
        loads.map(move |input| (&input.variable, self.rate_without_waves(input, t)))
    }

    /// The driven friction coefficients: contacts with the changes of µ_k and µ_s for one unit of an input, and its rate
    /// of change from time `t` (s) on, per second, without the [`waves`](Self::waves).
    pub(super) fn friction_rates(
        &self,
        t: f64,
    ) -> impl Iterator<Item = (&[(usize, [f64; 2])], f64)> {
        let rubbing = self.inputs.iter().filter(|input| !input.friction.is_empty());
        rubbing.map(move |input| (&*input.friction, self.rate_without_waves(input, t)))
    }

    /// Lists the inputs that change the friction of a contact. `changes` chooses them by the changes of µ_k and µ_s for one
    /// unit of the input. Each has the words for what signals add to it, the input, and the index of its nominal value.
    pub(super) fn friction_sources(
        &self,
        contact: usize,
        changes: impl Fn([f64; 2]) -> bool,
    ) -> impl Iterator<Item = (Vec<String>, &Variable, usize)> {
        let inputs = self.inputs.iter().filter(move |input| {
            input.friction.iter().any(|(place, change)| *place == contact && changes(*change))
        });
        let added = |input: &Input| {
            let signal = |&i: &usize| match &self.signals[i].shape {
                Shape::Sine(sine) => {
                    format!("signal[{}] adds a sine of amplitude {}", i + 1, Short(sine.amplitude))
                }
                _ => format!("signal[{}] is added", i + 1),
            };
            let rate = input
                .ramp
                .map(|ramp| format!("a rate of {} per second is added", Short(ramp.rate)));
            input.signals.iter().map(signal).chain(rate).collect()
        };
        inputs.map(move |input| (added(input), &input.variable, input.place))
    }

    fn rate_without_waves(&self, input: &Input, t: f64) -> f64 {
        let ramp = input.ramp.map_or(0.0, |ramp| ramp.rate);
        let shapes = self.shapes(input).filter(|shape| !self.is_wave(shape));
        shapes.fold(0.0 + ramp, |sum, shape| sum + shape.rate(t, self.slack))
    }

    /// The sum of `sum` and the rate of change of an input from time `t` (s) on, per second.
    fn rate(&self, input: &Input, t: f64, sum: f64) -> f64 {
        let ramp = input.ramp.map_or(0.0, |ramp| ramp.rate);
        self.shapes(input).fold(sum + ramp, |sum, shape| sum + shape.rate(t, self.slack))
    }

    fn shapes<'a>(&'a self, input: &'a Input) -> impl Iterator<Item = &'a Shape> {
        input.signals.iter().map(|&i| &self.signals[i].shape)
    }

    /// The inputs that move the surface of a contact.
    fn of_slider(&self, contact: usize) -> impl Iterator<Item = &Input> {
        self.inputs.iter().filter(move |input| input.moves.binary_search(&contact).is_ok())
    }
}

fn is_velocity(variable: &Variable) -> bool {
    matches!(variable.template.quantity, Quantity::SliderVelocity | Quantity::OwnVelocity)
}

/// Returns the scene at time `t` (s): its signals are added to the inputs that they drive, and then removed.
///
/// # Errors
/// Returns an error if a signal gives an impossible value.
pub fn at_instant(scene: &Scene, t: f64) -> Result<Scene, Error> {
    let mut scene = scene.clone();
    if scene.signals.is_empty() {
        return Ok(scene);
    }
    let nominal = Parameters::of(scene.clone());
    DrivenInputs::new(&scene, &nominal).bring_to([t, t], &nominal, &mut scene, |_| {})?;
    scene.signals = [].into();
    Ok(scene)
}
