//! The linear equations of a [`Flow`]: the matrix of each set of contact states, the functions whose zeros are events,
//! and the maps across them.

use super::flow::{Field, Flow, Stage};
use super::matrix::{exponential, product, times};
use amontons::contact::{ContactState, Friction};
use amontons::integrator::{
    AppliedLoad, ConstrainedResponse, Event, HeldStates, Integrator, StepFailure,
};
use amontons::model::{Contact, Direction, SparseMatrix};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Powers of a motion over a part of a segment in which A t has at most norm 1: 1/20! = 4e-19.
const POWERS: usize = 19;

impl Flow {
    /// T/N of each contact that slides, 0 of others.
    fn slopes(&self, states: &[ContactState]) -> Vec<f64> {
        let slope = |(state, friction): (&ContactState, &Friction)| {
            state.sliding_direction().unwrap_or(0.0) * friction.kinetic
        };
        states.iter().zip(&self.friction).map(slope).collect()
    }

    pub(super) fn make_field(&mut self, states: &[ContactState]) -> Result<Field, StepFailure> {
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
        let (powers, part) = self.powers(field, y, t).last().expect("there is at least one part");
        powers.iter().rev().fold(DVector::zeros(y.len()), |sum, c| sum * part + c)
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
        let Contact { normal, tangent, .. } = &self.model.contacts[contact];
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
            let placed = self.position_map(&closed)?;
            let slopes = self.slopes(states);
            let struck = self.velocity_map(states, &slopes)?;
            map = product(&struck, &product(&placed, &map));
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

    /// The rate of a state, ẏ = A y.
    #[must_use]
    pub fn rate(field: &Field, y: &DVector<f64>) -> DVector<f64> {
        times(&field.matrix, y)
    }
}

/// Subtracts a column of a symmetric matrix, times a factor.
fn subtract_column(force: &mut [f64], matrix: &SparseMatrix, column: usize, factor: f64) {
    if factor != 0.0 && !matrix.is_empty() {
        for (row, value) in matrix.row(column) {
            force[row] -= factor * value;
        }
    }
}
