//! The linear equations of a [`Flow`]: the matrix of each set of contact states, the functions whose zeros are events,
//! and the maps across them.

use super::field::{DrivenSlip, Field};
use super::flow::{Flow, Stage};
use super::matrix::{product, times};
use amontons::contact::ContactState;
use amontons::integrator::{
    AppliedLoad, ConstrainedResponse, Event, HeldStates, Integrator, StepFailure, Wave,
};
use amontons::model::{Contact, Direction, SparseMatrix};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

impl Flow {
    /// The row of µ_k or µ_s (`part` 0 or 1) of a contact.
    fn friction_row(&self, contact: usize, part: usize) -> DVector<f64> {
        let first = 2 * self.dofs();
        let mut row = DVector::zeros(self.size());
        let friction = self.friction[contact];
        row[first] = [friction.kinetic, friction.static_][part];
        for (j, wave) in self.waves.iter().enumerate() {
            for (_, parts) in wave.friction.iter().filter(|driven| driven.0 == contact) {
                row[first + 1 + 2 * j] += wave.amplitude * parts[part];
            }
        }
        row
    }

    /// µ_k or µ_s (`part` 0 or 1) of a contact at a state, which depends on the places of time alone.
    fn friction_at(&self, contact: usize, part: usize, y: &DVector<f64>) -> f64 {
        let friction = self.friction[contact];
        let first = 2 * self.dofs() + 1;
        let mut value = [friction.kinetic, friction.static_][part];
        for (j, wave) in self.waves.iter().enumerate() {
            for (_, parts) in wave.friction.iter().filter(|driven| driven.0 == contact) {
                value += wave.amplitude * parts[part] * y[first + 2 * j];
            }
        }
        value
    }

    /// T/N of each contact that slides at this state, 0 of others.
    fn slopes(&self, states: &[ContactState], y: &DVector<f64>) -> Vec<f64> {
        let slope = |(contact, state): (usize, &ContactState)| {
            let direction = state.sliding_direction();
            direction.map_or(0.0, |direction| direction * self.friction_at(contact, 0, y))
        };
        states.iter().enumerate().map(slope).collect()
    }

    /// The contacts that slip in these states while sines drive their µ_k, each with the row of s δµ, which is zero at the
    /// state `y`.
    pub(super) fn friction_changes(
        &self,
        states: &[ContactState],
        y: &DVector<f64>,
    ) -> Vec<(usize, DVector<f64>)> {
        let change = |(contact, state): (usize, &ContactState)| {
            let direction = state.sliding_direction()?;
            let drives = |wave: &Wave| {
                let is_own = |(own, parts): &(usize, [f64; 2])| *own == contact && parts[0] != 0.0;
                wave.amplitude != 0.0 && wave.friction.iter().any(is_own)
            };
            self.waves.iter().any(drives).then(|| {
                let mut row = self.friction_row(contact, 0);
                row[2 * self.dofs()] -= self.friction_at(contact, 0, y);
                (contact, row * direction)
            })
        };
        states.iter().enumerate().filter_map(change).collect()
    }

    /// The equation in these states, linearised at the state `y`.
    pub(super) fn make_field(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
    ) -> Result<Field, StepFailure> {
        let (n, size, contacts) = (self.dofs(), self.size(), self.surface.len());
        let slopes = self.slopes(states, y);
        let mut field = Field {
            matrix: DMatrix::zeros(size, size),
            forces: vec![[DVector::zeros(size), DVector::zeros(size)]; contacts],
            driven_slips: Vec::new(),
            parts_per_second: 0.0,
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
        for (contact, change) in self.friction_changes(states, y) {
            let held = HeldStates { states, slopes: &slopes };
            let rate = self.rate_by_tangential_force(contact, held, &mut response)?;
            let mut forces = response.forces.clone();
            forces[contact][1] += 1.0;
            field.driven_slips.push(DrivenSlip { contact, change, rate, forces });
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
                for slip in &mut field.driven_slips {
                    slip.rate[n + dof] = 0.0;
                }
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
                field.matrix.row_mut(n + dof).fill(0.0);
                for (j, wave) in self.waves.iter().enumerate() {
                    if wave.moves.contains(&i) {
                        field.matrix[(n + dof, 2 * n + 2 + 2 * j)] +=
                            wave.amplitude * wave.pulsation;
                    }
                }
                for slip in &mut field.driven_slips {
                    slip.rate[n + dof] = 0.0;
                }
            }
        }
        field.parts_per_second = self.parts_per_second(&field);
        field.linearise_at(y);
        Ok(field)
    }

    /// The rate of the state that a force of 1 N along the tangent of a contact causes.
    fn rate_by_tangential_force(
        &mut self,
        contact: usize,
        held: HeldStates<'_>,
        response: &mut ConstrainedResponse,
    ) -> Result<DVector<f64>, StepFailure> {
        let n = self.dofs();
        let mut force = vec![0.0; n];
        self.model.contacts[contact].tangent.add_to(&mut force, 1.0);
        let still = vec![0.0; held.states.len()];
        let load = AppliedLoad { force: &force, slider_acceleration: &still };
        self.integrator.respond(held, load, response)?;
        let mut rate = DVector::zeros(self.size());
        rate.rows_mut(n, n).copy_from_slice(&response.acceleration);
        Ok(rate)
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

    /// The row, near the state `y`, of the function that is zero at an event of a contact: gap (m), slip velocity (m/s),
    /// normal force or reserve of friction (N). `field` is that of the states before at `y`. `None` of an event that has no
    /// such function.
    #[must_use]
    pub fn event_row(
        &self,
        field: &Field,
        y: &DVector<f64>,
        contact: usize,
        event: Event,
    ) -> Option<DVector<f64>> {
        let n = self.dofs();
        let Contact { normal, tangent, .. } = &self.model.contacts[contact];
        Some(match event {
            Event::Touch => {
                let mut row = self.spread(normal, 0, 1.0);
                row[2 * n] += self.model.contacts[contact].gap;
                row
            }
            Event::Stop => self.surface_row(contact) + self.spread(tangent, n, -1.0),
            Event::Lift => field.forces[contact][0].clone(),
            Event::Slip(state) => {
                let [normal, tangential] = &field.forces[contact];
                let direction = state.sliding_direction().unwrap_or(1.0);
                let friction = self.friction_at(contact, 1, y);
                let mut change = self.friction_row(contact, 1);
                change[2 * n] -= friction;
                friction * normal - direction * tangential + change * normal.dot(y)
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

    /// The linear map of the state across the events of one stage, near the state `y` just before; `before` are the contact
    /// states before.
    ///
    /// # Errors
    /// Returns the contact whose impulses were not found.
    pub fn reset(
        &mut self,
        before: &[ContactState],
        stage: &Stage,
        y: &DVector<f64>,
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
            let placed = self.position_map(&closed)?;
            map = product(&placed, &map);
            let struck = self.impact_map(states, &times(&map, y))?;
            map = product(&struck, &map);
        }
        Ok(product(&self.held(&stage.states)?, &map))
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
            let placed = self.position_map(&closed)?;
            map = product(&self.velocity_map(states, &nothing)?, &placed);
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
                map[(dof, 2 * n)] = 0.0 - contact.gap;
                map.row_mut(n + dof).fill(0.0);
            }
            if let (Some(dof), ContactState::Stick) = (contact.tangent.as_unit(), state) {
                map.set_row(n + dof, &self.surface_row(i).transpose());
            }
        }
    }

    /// The map, near the state `y`, of an impact in which contacts take these states.
    fn impact_map(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
    ) -> Result<DMatrix<f64>, StepFailure> {
        let slopes = self.slopes(states, y);
        let mut map = self.velocity_map(states, &slopes)?;
        let changes = self.friction_changes(states, y);
        if changes.is_empty() {
            return Ok(map);
        }
        let (n, contacts) = (self.dofs(), self.surface.len());
        let held = HeldStates { states, slopes: &slopes };
        let mut momentum = vec![0.0; n];
        for (dof, velocity) in y.rows(n, n).iter().enumerate() {
            subtract_column(&mut momentum, &self.model.mass, dof, -velocity);
        }
        let surfaces: Vec<f64> = (0..contacts).map(|i| self.surface_row(i).dot(y)).collect();
        let mut response = ConstrainedResponse::new(contacts, n);
        let load = AppliedLoad { force: &momentum, slider_acceleration: &surfaces };
        self.integrator.respond(held, load, &mut response)?;
        let impulses = response.forces.clone();
        for (contact, change) in changes {
            let jump = self.rate_by_tangential_force(contact, held, &mut response)?;
            map.ger(impulses[contact][0], &jump, &change, 1.0);
        }
        Ok(map)
    }

    /// The map of an impact with these ratios T/N, or that removes velocities which contacts hold.
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
    fn position_map(&mut self, closed: &[ContactState]) -> Result<DMatrix<f64>, StepFailure> {
        let (n, size, contacts) = (self.dofs(), self.size(), self.surface.len());
        let mut map = DMatrix::identity(size, size);
        let still = vec![0.0; contacts];
        let mut response = ConstrainedResponse::new(contacts, n);
        for column in 0..n {
            let mut force = vec![0.0; n];
            subtract_column(&mut force, &self.model.mass, column, -1.0);
            let load = AppliedLoad { force: &force, slider_acceleration: &still };
            let held = HeldStates { states: closed, slopes: &still };
            self.integrator.respond(held, load, &mut response)?;
            for (dof, place) in response.acceleration.iter().enumerate() {
                map[(dof, column)] = *place;
            }
        }
        // The map leaves a place with closed gaps as it is. Contacts with gaps lie along degrees of freedom
        // ([`check_gaps`](super::flow::check_gaps)), which hold such a place.
        let mut place = DVector::zeros(size);
        for (contact, state) in self.model.contacts.iter().zip(closed) {
            if let (Some(dof), true) = (contact.normal.as_unit(), *state != ContactState::Detached)
            {
                place[dof] = 0.0 - contact.gap;
            }
        }
        if place.amax() > 0.0 {
            let off = &place - times(&map, &place);
            for (dof, off) in off.iter().enumerate().take(n) {
                map[(dof, 2 * n)] = *off;
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
            let Contact { normal, tangent, .. } = &self.model.contacts[i];
            if *state != ContactState::Detached {
                rows.extend([0, n].map(|first| self.spread(normal, first, 1.0)));
            }
            if *state == ContactState::Stick {
                rows.push(self.spread(tangent, n, 1.0));
            }
        }
        rows.iter().map(|row| row.rows(0, 2 * n).into_owned()).collect()
    }

    /// A direction as a row, from the place `first` on.
    fn spread(&self, direction: &Direction, first: usize, factor: f64) -> DVector<f64> {
        let mut row = DVector::zeros(self.size());
        for &(dof, value) in &direction.0 {
            row[first + dof] += factor * value;
        }
        row
    }

    /// The rate of the state of a field, ẏ = A y.
    #[must_use]
    pub fn rate(field: &Field, y: &DVector<f64>) -> DVector<f64> {
        times(&field.matrix, y)
    }
}

/// Subtracts a column of a matrix, times a factor.
fn subtract_column(force: &mut [f64], matrix: &SparseMatrix, column: usize, factor: f64) {
    if factor != 0.0 && !matrix.is_empty() {
        for (row, force) in force.iter_mut().enumerate() {
            *force -= factor * matrix.get(row, column);
        }
    }
}
