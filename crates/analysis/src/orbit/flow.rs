//! The equation of motion of a scene, as one linear equation for each set of contact states.
//!
//! The state is y = (x, ẋ, 1, sin θ_1, cos θ_1, …): displacements (m) and velocities (m/s) of all degrees of freedom,
//! the number 1, and sine and cosine of the phase θ_j = θ_j0 + ω_j t of each sine signal. In given contact states
//! ẏ = A y with a constant matrix A, the contact forces are linear in y, and so is every function whose zero is an
//! event.

use super::matrix::{exponential, times};
use amontons::Error;
use amontons::contact::{ContactState, Friction};
use amontons::integrator::{
    AppliedLoad, ConstrainedResponse, Event, EventDriven, EventRecord, EventRecorder, HeldStates,
    Inputs, Integrator, Motion, StepFailure, Wave,
};
use amontons::model::{Direction, LumpedModel, SparseMatrix};
use amontons::numerics::max_norm;
use amontons::scene::{Method, Scene, Shape, Signal, Sine};
use amontons::simulation::Simulation;
use nalgebra::{DMatrix, DVector};
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Changes of contact states within this part of an internal step are one instant: modules that move in step have
/// events that rounding sets apart.
const ONE_INSTANT: f64 = 1e-10;

/// Powers of a motion over a part of a segment in which A t has at most norm 1: 1/20! = 4e-19.
const POWERS: usize = 19;

/// A scene whose drive is constant but for sines, as a piecewise linear flow. Time 0 is the instant of the simulation
/// that it was made of.
pub struct Flow {
    model: LumpedModel,
    integrator: EventDriven<EventRecorder>,
    /// Constant parts of the outer forces, N, and of the velocities of the surfaces, m/s; µ of each contact.
    force: Vec<f64>,
    surface: Vec<f64>,
    friction: Vec<Friction>,
    waves: Vec<Wave>,
    /// The internal step of runs, s.
    step: f64,
    /// Units of the state's places, for sums of numbers of one size.
    units: Vec<f64>,
    fields: HashMap<Vec<ContactState>, Rc<Field>>,
}

/// The linear equation in given contact states.
pub struct Field {
    /// A of ẏ = A y.
    pub matrix: DMatrix<f64>,
    /// Rows of (N, T) of each contact, N: the forces are their products with y.
    pub forces: Vec<[DVector<f64>; 2]>,
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
    /// What happens, in its order.
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
    /// Returns an error if a signal still changes otherwise than by a sine without an end, if a sine drives a friction
    /// coefficient, or if the event-driven method does not support the scene.
    pub fn of(simulation: &mut Simulation) -> Result<Self, Error> {
        let scene = simulation.scene();
        check_signals(scene, simulation.time())?;
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
        for wave in &waves {
            for &(dof, factor) in &wave.pushes {
                force[dof] -= factor * wave.after(0.0);
            }
            for &contact in &wave.moves {
                surface[contact] -= wave.after(0.0);
            }
        }
        let mut integrator = EventDriven::recording(&model)?;
        integrator.expect_waves(waves.len());
        let mut flow = Self {
            model,
            integrator,
            force,
            surface,
            friction: inputs.friction,
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
            self.integrator.record_step(&mut motion, &inputs, end - done)?;
            let new = self.integrator.take_record().into_iter();
            records.extend(new.map(|record| EventRecord { time: record.time + done, ..record }));
            done = end;
            if !goes_on(&records) {
                break;
            }
        }
        Ok((motion, instants(records, ONE_INSTANT * self.step)))
    }

    /// The linear equation in these contact states.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    pub fn field(&mut self, states: &[ContactState]) -> Result<Rc<Field>, StepFailure> {
        if let Some(known) = self.fields.get(states) {
            return Ok(Rc::clone(known));
        }
        let field = Rc::new(self.make_field(states)?);
        self.fields.insert(states.to_vec(), Rc::clone(&field));
        Ok(field)
    }

    /// T/N of each contact that slides, 0 of others.
    fn slopes(&self, states: &[ContactState]) -> Vec<f64> {
        let slope = |(state, friction): (&ContactState, &Friction)| {
            state.sliding_direction().unwrap_or(0.0) * friction.kinetic
        };
        states.iter().zip(&self.friction).map(slope).collect()
    }

    fn make_field(&mut self, states: &[ContactState]) -> Result<Field, StepFailure> {
        let (n, size, contacts) = (self.dofs(), self.size(), self.surface.len());
        let slopes = self.slopes(states);
        let mut field = Field {
            matrix: DMatrix::zeros(size, size),
            forces: vec![[DVector::zeros(size), DVector::zeros(size)]; contacts],
        };
        let mut response = ConstrainedResponse::new(contacts, n);
        for column in 0..size {
            let mut force = vec![0.0; n];
            let mut slider_acceleration = vec![0.0; contacts];
            if column < n {
                subtract_column(&mut force, &self.model.stiffness, column, 1.0);
                // A velocity is the rate of its displacement, below.
            } else if column < 2 * n {
                let dof = column - n;
                let damping = self.model.damping;
                subtract_column(&mut force, &self.model.mass, dof, damping.alpha);
                subtract_column(&mut force, &self.model.stiffness, dof, damping.beta);
                subtract_column(&mut force, &self.model.dampers, dof, 1.0);
                field.matrix[(dof, column)] = 1.0;
            } else if column == 2 * n {
                force.copy_from_slice(&self.force);
            } else {
                let first = 2 * n + 1;
                let wave = &self.waves[(column - first) / 2];
                let is_sine = (column - first).is_multiple_of(2);
                if is_sine {
                    for &(dof, factor) in &wave.pushes {
                        force[dof] += factor * wave.amplitude;
                    }
                    field.matrix[(column + 1, column)] = -wave.pulsation;
                } else {
                    for &contact in &wave.moves {
                        slider_acceleration[contact] += wave.amplitude * wave.pulsation;
                    }
                    field.matrix[(column - 1, column)] = wave.pulsation;
                }
            }
            let held = HeldStates { states, slopes: &slopes };
            let load = AppliedLoad { force: &force, slider_acceleration: &slider_acceleration };
            self.integrator.respond(held, load, &mut response)?;
            for (dof, acceleration) in response.acceleration.iter().enumerate() {
                field.matrix[(n + dof, column)] = *acceleration;
            }
            for (rows, forces) in field.forces.iter_mut().zip(&response.forces) {
                (rows[0][column], rows[1][column]) = (forces[0], forces[1]);
            }
        }
        // What a contact holds by itself is held exactly.
        for (i, state) in states.iter().enumerate() {
            let contact = &self.model.contacts[i];
            if *state == ContactState::Detached {
                continue;
            }
            if let Some(dof) = contact.normal.as_unit() {
                field.matrix.row_mut(dof).fill(0.0);
                field.matrix.row_mut(n + dof).fill(0.0);
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
                field.matrix.row_mut(n + dof).fill(0.0);
                for (j, wave) in self.waves.iter().enumerate() {
                    if wave.moves.contains(&i) {
                        field.matrix[(n + dof, 2 * n + 2 + 2 * j)] +=
                            wave.amplitude * wave.pulsation;
                    }
                }
            }
        }
        Ok(field)
    }

    /// exp(A t) of a field.
    #[must_use]
    pub fn propagator(&self, field: &Field, t: f64) -> DMatrix<f64> {
        exponential(&field.matrix, &self.units, t)
    }

    /// exp(A t) y, as the power series of the motion over parts of the time.
    #[must_use]
    pub fn propagate(&self, field: &Field, y: &DVector<f64>, t: f64) -> DVector<f64> {
        let mut end = y.clone();
        for (powers, part) in self.powers(field, y, t) {
            end = powers.iter().rev().fold(DVector::zeros(y.len()), |sum, c| sum * part + c);
        }
        end
    }

    /// The motion from a state on over the time `t` (s), as power series in the time since the beginning of each of its
    /// parts, with the parts' lengths (s). Over a part A t has at most norm 1.
    pub(super) fn powers<'a>(
        &'a self,
        field: &'a Field,
        y: &DVector<f64>,
        t: f64,
    ) -> impl Iterator<Item = (Vec<DVector<f64>>, f64)> + 'a {
        let of_column = |j: usize| {
            let column = field.matrix.column(j);
            let sizes = column.iter().zip(&self.units).map(|(a, unit)| (a / unit).abs());
            sizes.sum::<f64>() * self.units[j]
        };
        let norm = (0..self.units.len()).map(of_column).fold(0.0, f64::max);
        let count = (norm * t.abs()).ceil().max(1.0);
        let part = t / count;
        let mut start = y.clone();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        (0..count as usize).map(move |_| {
            let mut powers = Vec::with_capacity(POWERS + 1);
            powers.push(start.clone());
            let mut factor = 0.0;
            for k in 0..POWERS {
                factor += 1.0;
                let next = times(&field.matrix, &powers[k]) / factor;
                powers.push(next);
            }
            let zero = DVector::zeros(start.len());
            start = powers.iter().rev().fold(zero, |sum, c| sum * part + c);
            (powers, part)
        })
    }

    /// The units of a state's places.
    #[must_use]
    pub fn units(&self) -> &[f64] {
        &self.units
    }

    /// The row of the velocity of a contact's surface, m/s.
    fn surface_row(&self, contact: usize) -> DVector<f64> {
        let first = 2 * self.dofs();
        let mut row = DVector::zeros(self.size());
        row[first] = self.surface[contact];
        for (j, wave) in self.waves.iter().enumerate() {
            if wave.moves.contains(&contact) {
                row[first + 1 + 2 * j] += wave.amplitude;
            }
        }
        row
    }

    /// The row of the function that is zero at an event of a contact: gap (m), slip velocity (m/s), normal force or
    /// reserve of friction (N). `field` is that of the states before. `None` of an event that has no such function.
    #[must_use]
    pub fn event_row(&self, field: &Field, contact: usize, event: Event) -> Option<DVector<f64>> {
        let n = self.dofs();
        let Contact { normal, tangent } = self.directions(contact);
        Some(match event {
            Event::Touch => self.spread(normal, 0, 1.0),
            Event::Stop => self.surface_row(contact) + self.spread(tangent, n, -1.0),
            Event::Lift => field.forces[contact][0].clone(),
            Event::Slip(state) => {
                let [normal, tangential] = &field.forces[contact];
                let direction = state.sliding_direction().unwrap_or(1.0);
                self.friction[contact].static_ * normal - direction * tangential
            }
            Event::Leave(_) | Event::Part => return None,
        })
    }

    /// `true` if all sines have turned a whole number of times after this time (s).
    #[must_use]
    pub fn returns_after(&self, time: f64) -> bool {
        /// Turns are whole up to this part of one.
        const WHOLE: f64 = 1e-9;
        self.waves.iter().all(|wave| {
            let turns = wave.pulsation * time / TAU;
            turns.round() >= 1.0 && (turns - turns.round()).abs() <= WHOLE * turns
        })
    }

    /// By how much the first sine has turned since time 0 at time `t` (s), rad; 0 without a drive.
    #[must_use]
    pub fn turn(&self, t: f64) -> f64 {
        self.waves.first().map_or(0.0, |wave| wave.pulsation * t)
    }

    /// The time, s, at which the first sine has turned by so much since time 0.
    #[must_use]
    pub fn time_of(&self, turn: f64) -> f64 {
        self.waves.first().map_or(0.0, |wave| turn / wave.pulsation)
    }

    /// The row that is zero when the first sine has turned by so much since time 0, up to full turns, and rises there.
    #[must_use]
    pub fn phase_row(&self, turn: f64) -> Option<DVector<f64>> {
        let phase = self.waves.first()?.phase + turn;
        let first = 2 * self.dofs() + 1;
        let mut row = DVector::zeros(self.size());
        row[first] = libm::cos(phase);
        row[first + 1] = -libm::sin(phase);
        Some(row)
    }

    /// The linear map of the state across the events of one stage; `before` are the states before.
    ///
    /// # Errors
    /// Returns the contact whose impulses were not found.
    pub fn reset(
        &mut self,
        before: &[ContactState],
        stage: &Stage,
    ) -> Result<DMatrix<f64>, StepFailure> {
        let size = self.size();
        let mut map = DMatrix::identity(size, size);
        let stops = |event: &(usize, Event)| event.1 == Event::Stop;
        let nothing = vec![0.0; before.len()];
        if stage.events.iter().any(stops) {
            let mut kept = before.to_vec();
            for (contact, _) in stage.events.iter().filter(|event| stops(event)) {
                kept[*contact] = ContactState::Stick;
            }
            // Contacts that slip are held along their normals only.
            map = self.velocity_map(&kept, &nothing)?;
        }
        if let Some(states) = &stage.impact {
            let closed: Vec<ContactState> = states
                .iter()
                .zip(before)
                .map(|(struck, before)| match (struck, before) {
                    (ContactState::Detached, ContactState::Detached) => ContactState::Detached,
                    _ => ContactState::Slide,
                })
                .collect();
            let placed = self.position_map(&closed, &nothing)?;
            let slopes = self.slopes(states);
            let struck = self.velocity_map(states, &slopes)?;
            map = super::matrix::product(&struck, &super::matrix::product(&placed, &map));
        }
        Ok(super::matrix::product(&self.held(&stage.states)?, &map))
    }

    /// The map of the state onto what contacts in these states hold: closed gaps and slip velocities of zero.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    pub fn held(&mut self, states: &[ContactState]) -> Result<DMatrix<f64>, StepFailure> {
        let is_inclined = self.model.contacts.iter().any(|contact| {
            contact.normal.as_unit().is_none() || contact.tangent.as_unit().is_none()
        });
        let size = self.size();
        let mut map = DMatrix::identity(size, size);
        if is_inclined {
            let nothing = vec![0.0; states.len()];
            let closed: Vec<ContactState> = states
                .iter()
                .map(|state| match state {
                    ContactState::Detached => ContactState::Detached,
                    _ => ContactState::Slide,
                })
                .collect();
            let placed = self.position_map(&closed, &nothing)?;
            map = super::matrix::product(&self.velocity_map(states, &nothing)?, &placed);
        }
        self.hold_exactly(states, &mut map);
        Ok(map)
    }

    /// Puts the rows of what contacts hold by themselves to their exact values.
    fn hold_exactly(&self, states: &[ContactState], map: &mut DMatrix<f64>) {
        let n = self.dofs();
        for (i, state) in states.iter().enumerate() {
            if *state == ContactState::Detached {
                continue;
            }
            let contact = &self.model.contacts[i];
            if let Some(dof) = contact.normal.as_unit() {
                map.row_mut(dof).fill(0.0);
                map.row_mut(n + dof).fill(0.0);
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
                map.set_row(n + dof, &self.surface_row(i).transpose());
            }
        }
    }

    /// The map of an impact in which contacts take these states, or that removes velocities which contacts hold.
    fn velocity_map(
        &mut self,
        states: &[ContactState],
        slopes: &[f64],
    ) -> Result<DMatrix<f64>, StepFailure> {
        let (n, size, contacts) = (self.dofs(), self.size(), self.surface.len());
        let mut map = DMatrix::identity(size, size);
        let surfaces: Vec<DVector<f64>> = (0..contacts).map(|i| self.surface_row(i)).collect();
        let mut response = ConstrainedResponse::new(contacts, n);
        for column in n..size {
            let mut force = vec![0.0; n];
            if column < 2 * n {
                subtract_column(&mut force, &self.model.mass, column - n, -1.0);
            }
            let velocity: Vec<f64> = surfaces.iter().map(|row| row[column]).collect();
            let load = AppliedLoad { force: &force, slider_acceleration: &velocity };
            self.integrator.respond(HeldStates { states, slopes }, load, &mut response)?;
            for (dof, velocity) in response.acceleration.iter().enumerate() {
                map[(n + dof, column)] = *velocity;
            }
        }
        Ok(map)
    }

    /// The map that puts the gaps of closed contacts to zero.
    fn position_map(
        &mut self,
        closed: &[ContactState],
        slopes: &[f64],
    ) -> Result<DMatrix<f64>, StepFailure> {
        let (n, size, contacts) = (self.dofs(), self.size(), self.surface.len());
        let mut map = DMatrix::identity(size, size);
        let still = vec![0.0; contacts];
        let mut response = ConstrainedResponse::new(contacts, n);
        for column in 0..n {
            let mut force = vec![0.0; n];
            subtract_column(&mut force, &self.model.mass, column, -1.0);
            let load = AppliedLoad { force: &force, slider_acceleration: &still };
            let held = HeldStates { states: closed, slopes };
            self.integrator.respond(held, load, &mut response)?;
            for (dof, place) in response.acceleration.iter().enumerate() {
                map[(dof, column)] = *place;
            }
        }
        Ok(map)
    }

    /// The rows that vanish on all changes of the state (x, ẋ) that these contact states allow.
    #[must_use]
    pub fn held_rows(&self, states: &[ContactState]) -> Vec<DVector<f64>> {
        let n = self.dofs();
        let mut rows = Vec::new();
        for (i, state) in states.iter().enumerate() {
            let Contact { normal, tangent } = self.directions(i);
            if *state != ContactState::Detached {
                rows.extend([0, n].map(|first| self.spread(normal, first, 1.0)));
            }
            if *state == ContactState::Stick {
                rows.push(self.spread(tangent, n, 1.0));
            }
        }
        rows.iter().map(|row| row.rows(0, 2 * n).into_owned()).collect()
    }

    fn directions(&self, contact: usize) -> Contact<'_> {
        let contact = &self.model.contacts[contact];
        Contact { normal: &contact.normal, tangent: &contact.tangent }
    }

    /// A direction as a row, from the place `first` on.
    fn spread(&self, direction: &Direction, first: usize, factor: f64) -> DVector<f64> {
        let mut row = DVector::zeros(self.size());
        for &(dof, value) in &direction.0 {
            row[first + dof] += factor * value;
        }
        row
    }

    /// The rate of a state, ẏ = A y.
    #[must_use]
    pub fn rate(field: &Field, y: &DVector<f64>) -> DVector<f64> {
        times(&field.matrix, y)
    }
}

struct Contact<'a> {
    normal: &'a Direction,
    tangent: &'a Direction,
}

/// Subtracts a column of a symmetric matrix, times a factor.
fn subtract_column(force: &mut [f64], matrix: &SparseMatrix, column: usize, factor: f64) {
    if factor != 0.0 && !matrix.is_empty() {
        for (row, value) in matrix.row(column) {
            force[row] -= factor * value;
        }
    }
}

/// Refuses a scene that is not in event-driven motion, or in which a sine drives a friction coefficient.
///
/// # Errors
/// Returns an error that says what would be right, or names the signal.
pub fn check_method(scene: &Scene) -> Result<(), Error> {
    if scene.method != Method::EventDriven {
        return Err(Error::scene(
            "periodic motions are followed in event-driven motion only; use --integrator event-driven",
        ));
    }
    let is_sine = |shape: &Shape| matches!(shape, Shape::Sine(_));
    match scene.signals.iter().find(|signal| signal.drives_friction() && is_sine(&signal.shape)) {
        None => Ok(()),
        Some(signal) => Err(Error::scene(format!(
            "a sine drives {}: periodic motions under a friction coefficient that changes are not followed",
            signal.input
        ))),
    }
}

/// Refuses signals after which the drive is neither constant nor a sum of sines.
fn check_signals(scene: &Scene, time: f64) -> Result<(), Error> {
    check_method(scene)?;
    for signal in scene.signals.iter() {
        let is_over = signal.shape.constant_until(time, 0.0) == f64::INFINITY;
        let is_endless_sine = matches!(
            &signal.shape,
            Shape::Sine(Sine { start, end: None, .. }) if *start <= time
        );
        if !is_over && !is_endless_sine {
            return Err(Error::scene(format!(
                "the signal of {} still changes at {time} s, and not as a sine without an end: such a drive does not \
                 repeat itself",
                signal.input
            )));
        }
    }
    Ok(())
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
