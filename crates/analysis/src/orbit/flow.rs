//! The equation of motion of a scene, as one linear equation for each set of contact states.
//!
//! The state is y = (x, ẋ, 1, sin θ_1, cos θ_1, …): displacements (m) and velocities (m/s) of all degrees of freedom,
//! the number 1, and sine and cosine of the phase θ_j = θ_j0 + ω_j t of each sine signal. In given contact states
//! ẏ = A y with a constant matrix A, the contact forces are linear in y, and so is every function whose zero is an
//! event. Where sines drive friction coefficients of contacts that slip, A depends on time: a [`Field`] then has the
//! linearisations of all these at a state.

use super::field::Field;
use super::signals::check_signals;
use amontons::Error;
use amontons::contact::{ContactState, Friction};
use amontons::integrator::{
    Event, EventDriven, EventRecord, EventRecorder, Inputs, Integrator, Motion, StepFailure, Wave,
};
use amontons::model::{Contact, LumpedModel};
use amontons::numerics::max_norm;
use amontons::scene::{Method, Scene, Shape, Signal, Sine};
use amontons::simulation::Simulation;
use nalgebra::DVector;
use std::collections::HashMap;
use std::rc::Rc;

/// Changes of contact states within this part of an internal step are one instant: modules that move in step have
/// events that rounding sets apart.
const ONE_INSTANT: f64 = 1e-10;

/// A scene whose drive is constant but for sines, as a piecewise linear flow. Time 0 is the instant of the simulation
/// that it was made of.
pub struct Flow {
    pub(super) model: LumpedModel,
    pub(super) integrator: EventDriven<EventRecorder>,
    /// Constant parts of the outer forces, N, and of the velocities of the surfaces, m/s; µ of each contact.
    pub(super) force: Vec<f64>,
    pub(super) surface: Vec<f64>,
    pub(super) friction: Vec<Friction>,
    pub(super) waves: Vec<Wave>,
    /// The internal step of runs, s.
    step: f64,
    /// Units of the state's places, for sums of numbers of one size.
    pub(super) units: Vec<f64>,
    fields: HashMap<Vec<ContactState>, Rc<Field>>,
}

/// One event after another at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The contacts with an event, from 0.
    pub events: Vec<(usize, Event)>,
    /// How contacts took part in the impact of those that touched ([`EventRecord::impact`]).
    pub impact: Option<Vec<ContactState>>,
    /// The states that follow.
    pub states: Vec<ContactState>,
}

/// All that happens at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Instant {
    /// Time since the run began, s.
    pub time: f64,
    /// The motion before.
    pub before: Motion,
    /// The stages of the instant, in their order.
    pub stages: Vec<Stage>,
    /// The motion after.
    pub after: Motion,
}

impl Instant {
    /// `true` if a contact changes its state.
    #[must_use]
    pub fn is_change(&self) -> bool {
        self.before.contacts != self.after.contacts
    }

    /// The first contact with an event, and the event.
    #[must_use]
    pub fn first_event(&self) -> Option<(usize, Event)> {
        self.stages.iter().flat_map(|stage| stage.events.first()).next().copied()
    }

    /// `true` if the same contacts have the same events here and there, in the same states.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        let events = |instant: &Self| {
            let events = instant.stages.iter().flat_map(|stage| stage.events.iter().copied());
            let mut events: Vec<(usize, Event)> = events.collect();
            events.sort_by_key(|event| event.0);
            events
        };
        self.before.contacts == other.before.contacts
            && self.after.contacts == other.after.contacts
            && events(self) == events(other)
    }
}

impl Flow {
    /// The flow of a scene from the present instant of a simulation on.
    ///
    /// # Errors
    /// Returns an error if a signal still changes otherwise than by a sine without an end, or if the event-driven method
    /// does not support the scene.
    pub fn of(simulation: &mut Simulation) -> Result<Self, Error> {
        let scene = simulation.scene();
        check_method(scene)?;
        check_signals(scene, simulation.time())?;
        check_gaps(simulation)?;
        let step = scene.step;
        let time = simulation.time();
        let is_over = |signal: &Signal| matches!(signal.shape, Shape::Sine(Sine { end: Some(end), .. }) if end <= time);
        let any_is_over = scene.signals.iter().any(is_over);
        let model = simulation.model().clone();
        let inputs = simulation.inputs_now()?.clone();
        // A sine without amplitude may have one with another value of a parameter; only what is over is left out.
        let waves: Vec<Wave> =
            inputs.waves.into_iter().filter(|wave| wave.amplitude != 0.0 || !any_is_over).collect();
        let (mut force, mut surface) = (inputs.force, inputs.slider_velocity);
        let mut friction = inputs.friction;
        for wave in &waves {
            for &(dof, factor) in &wave.pushes {
                force[dof] -= factor * wave.after(0.0);
            }
            for &contact in &wave.moves {
                surface[contact] -= wave.after(0.0);
            }
            for &(contact, [kinetic, static_]) in &wave.friction {
                friction[contact].kinetic -= kinetic * wave.after(0.0);
                friction[contact].static_ -= static_ * wave.after(0.0);
            }
        }
        let mut integrator = EventDriven::recording(&model)?;
        integrator.expect_waves(waves.len());
        let mut flow = Self {
            model,
            integrator,
            force,
            surface,
            friction,
            waves,
            step,
            units: Vec::new(),
            fields: HashMap::new(),
        };
        flow.units = flow.natural_units();
        Ok(flow)
    }

    /// Number of degrees of freedom.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.model.dofs()
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &LumpedModel {
        &self.model
    }

    /// `true` if sines drive the motion.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        !self.waves.is_empty()
    }

    /// Number of places of a state.
    #[must_use]
    pub fn size(&self) -> usize {
        2 * self.dofs() + 1 + 2 * self.waves.len()
    }

    /// Units in which displacements, velocities, forces' constants and phases have numbers of one size: m, and m times
    /// the highest angular frequency of the masses on their springs.
    fn natural_units(&self) -> Vec<f64> {
        let n = self.dofs();
        let inverse = |dof: usize| 1.0 / self.model.mass.get(dof, dof);
        let square = (0..n).map(|dof| self.model.stiffness.get(dof, dof) * inverse(dof));
        let fastest = square.fold(0.0, f64::max).sqrt();
        // A power of two keeps the digits.
        let rate = if fastest > 0.0 { 2.0_f64.powf(fastest.log2().round()) } else { 1.0 };
        let pushed = |dof: usize| (self.force[dof] * inverse(dof)).abs() / (rate * rate);
        let length = (0..n).map(pushed).fold(max_norm(&self.surface) / rate, f64::max);
        let length = if length > 0.0 { 2.0_f64.powf(length.log2().round()) } else { 1.0 };
        let mut units = vec![length; n];
        units.extend(vec![length * rate; n]);
        units.resize(self.size(), 1.0);
        units
    }

    /// The state of a motion at time `t` (s).
    #[must_use]
    pub fn state(&self, motion: &Motion, t: f64) -> DVector<f64> {
        let values = motion.displacement.iter().chain(&motion.velocity).copied();
        let mut y = DVector::zeros(self.size());
        for (place, value) in y.iter_mut().zip(values) {
            *place = value;
        }
        self.set_time(&mut y, t);
        y
    }

    /// Writes the places that depend on time alone.
    pub(super) fn set_time(&self, y: &mut DVector<f64>, t: f64) {
        let first = 2 * self.dofs();
        y[first] = 1.0;
        for (j, wave) in self.waves.iter().enumerate() {
            let phase = wave.phase_after(t);
            y[first + 1 + 2 * j] = libm::sin(phase);
            y[first + 2 + 2 * j] = libm::cos(phase);
        }
    }

    /// The motion of a state in these contact states.
    #[must_use]
    pub fn motion(&self, y: &DVector<f64>, states: &[ContactState]) -> Motion {
        let n = self.dofs();
        let (x, v) = (y.as_slice()[..n].to_vec(), y.as_slice()[n..2 * n].to_vec());
        Motion::new(x, v, states.to_vec())
    }

    /// The inputs of a step of length `h` (s) from time `t` (s) on.
    fn inputs(&self, t: f64, h: f64) -> Inputs {
        let mut inputs = Inputs::uniform(self.force.clone(), self.surface.len(), 0.0, 0.0);
        inputs.slider_velocity.clone_from(&self.surface);
        inputs.friction.clone_from(&self.friction);
        inputs.waves.clone_from(&self.waves);
        for wave in &mut inputs.waves {
            wave.phase = wave.phase_after(t);
            let [start, end] = [0.0, h].map(|t| wave.after(t));
            for &(dof, factor) in &wave.pushes {
                inputs.force[dof] += factor * start;
            }
            for &contact in &wave.moves {
                inputs.slider_velocity[contact] += end;
                inputs.slider_acceleration[contact] += (end - start) / h;
            }
            for &(contact, [kinetic, static_]) in &wave.friction {
                inputs.friction[contact].kinetic += kinetic * start;
                inputs.friction[contact].static_ += static_ * start;
            }
        }
        inputs
    }

    /// Runs from a motion at time `t` (s) for `duration` (s), in internal steps, and returns the motion at the end and
    /// all that happened on the way. `goes_on` is asked after each step with what has happened so far.
    ///
    /// # Errors
    /// Returns why a step failed.
    #[allow(clippy::cast_precision_loss)]
    pub fn run(
        &mut self,
        motion: &Motion,
        t: f64,
        duration: f64,
        mut goes_on: impl FnMut(&[EventRecord]) -> bool,
    ) -> Result<(Motion, Vec<Instant>), StepFailure> {
        let mut motion = Motion::new(
            motion.displacement.clone(),
            motion.velocity.clone(),
            motion.contacts.clone(),
        );
        self.integrator.take_record();
        let mut records: Vec<EventRecord> = Vec::new();
        let (mut done, mut steps) = (0.0, 0_u64);
        while done < duration {
            steps += 1;
            let end = (steps as f64 * self.step).min(duration);
            let inputs = self.inputs(t + done, end - done);
            self.integrator
                .advance(&mut motion, &inputs, end - done, 1)
                .map_err(|failure| failure.later(t + done))?;
            let new = self.integrator.take_record().into_iter();
            records.extend(new.map(|record| EventRecord { time: record.time + done, ..record }));
            done = end;
            if !goes_on(&records) {
                break;
            }
        }
        Ok((motion, instants(records, ONE_INSTANT * self.step)))
    }

    /// The equation in these contact states, near a state where sines drive friction in slip.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    pub fn field(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
    ) -> Result<Rc<Field>, StepFailure> {
        if !self.friction_changes(states, y).is_empty() {
            return Ok(Rc::new(self.make_field(states, y)?));
        }
        if let Some(known) = self.fields.get(states) {
            return Ok(Rc::clone(known));
        }
        let field = Rc::new(self.make_field(states, y)?);
        self.fields.insert(states.to_vec(), Rc::clone(&field));
        Ok(field)
    }
}

/// Refuses contacts that are open in the equilibrium where a normal lies along several degrees of freedom.
///
/// # Errors
/// Returns an error that names the contact.
pub fn check_gaps(simulation: &Simulation) -> Result<(), Error> {
    let contacts = &simulation.model().contacts;
    let is_aslant = |contact: &Contact| contact.normal.as_unit().is_none();
    let Some(open) = contacts.iter().position(|contact| contact.gap != 0.0) else { return Ok(()) };
    if !contacts.iter().any(is_aslant) {
        return Ok(());
    }
    Err(Error::analysis(format!(
        "{} is open in the equilibrium: orbits with such contacts are found only where the normal of each contact lies along \
         one axis of one mass; let the mass have the axes of its contact, or press the contact on",
        simulation.scene().contact_name(open)
    )))
}

/// Refuses a scene that is not in event-driven motion.
///
/// # Errors
/// Returns an error that says what would be right.
pub fn check_method(scene: &Scene) -> Result<(), Error> {
    if scene.method == Method::EventDriven {
        return Ok(());
    }
    Err(Error::scene(
        "periodic motions are followed in event-driven motion only; use --integrator event-driven",
    ))
}

/// Puts changes of contact states at one instant together.
fn instants(records: Vec<EventRecord>, near: f64) -> Vec<Instant> {
    let mut instants: Vec<Instant> = Vec::new();
    for EventRecord { time, events, before, after, impact } in records {
        let stage = Stage { events, impact, states: after.contacts.clone() };
        match instants.last_mut() {
            Some(last) if time - last.time <= near => {
                last.stages.push(stage);
                last.after = after;
            }
            _ => instants.push(Instant { time, before, stages: vec![stage], after }),
        }
    }
    instants
}
