//! The eigenvalue problem of a contact state with the contact forces as unknowns, and its derivatives by parameters.
//!
//! With the displacements x and the forces p of the closed contacts, each in the unit of a stiffness times a displacement,
//! λ² M x + λ C x + K x − B p = 0 and G x = 0. G holds the directions in which the contacts hold the structure, and B those
//! of their forces: n + s µ t for a contact that slides, n and t for one that sticks. No basis of the free motions is
//! needed, so a direction that changes with the slider's angle has a simple derivative.

use super::change::ModelChange;
use crate::stability::Linearised;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::{Contact, Direction, Entry, LumpedModel, SlidingFriction};
use nalgebra::{Complex, DMatrix};

/// The three matrices of (λ² mass + λ damping + stiffness) z = 0 for z = (x, p).
#[derive(Clone, Debug)]
pub(super) struct Bordered {
    pub(super) mass: DMatrix<f64>,
    pub(super) damping: DMatrix<f64>,
    pub(super) stiffness: DMatrix<f64>,
}

/// The derivatives of the three matrices by one parameter, as their entries.
#[derive(Clone, Debug, Default)]
pub(super) struct BorderedChange {
    mass: Vec<Entry>,
    damping: Vec<Entry>,
    stiffness: Vec<Entry>,
}

/// A contact that is closed in a contact state.
#[derive(Clone, Copy)]
struct Closed {
    contact: usize,
    /// The row of its first force.
    row: usize,
    /// The direction s of friction on a sliding contact; `None` for one that sticks.
    sign: Option<f64>,
}

/// The contact state about which the problem is linear.
pub(super) struct Problem<'a> {
    here: &'a Linearised,
    closed: Vec<Closed>,
    size: usize,
    /// The largest stiffness, N/m: the border is of its size.
    unit: f64,
    /// Friction of each contact that slides.
    friction: Vec<SlidingFriction>,
}

impl<'a> Problem<'a> {
    /// The problem of a contact state.
    ///
    /// # Errors
    /// Returns an error if the equations need an equilibrium and there is none, or if contacts hold one motion twice:
    /// derivatives by the friction of one of them do not exist then.
    pub(super) fn of(here: &'a Linearised, states: &[ContactState]) -> Result<Self, Error> {
        let linear = here.linear()?;
        let model = here.model();
        let mut size = model.dofs();
        let mut closed = Vec::new();
        for (contact, state) in states.iter().enumerate() {
            let sign = state.sliding_direction();
            if *state != ContactState::Detached {
                closed.push(Closed { contact, row: size, sign });
                size += if sign.is_some() { 1 } else { 2 };
            }
        }
        let held = size - model.dofs();
        let free = linear.reduced(states).map_or(0, |reduced| reduced.stiffness.nrows());
        if free + held != model.dofs() {
            return Err(Error::analysis(
                "several contacts hold one motion in this contact state, so their forces are not determined one by one; \
                 derivatives are computed for states whose contacts hold different motions: name another state with --state",
            ));
        }
        let stiffest =
            model.stiffness.entries().fold(0.0_f64, |most, entry| most.max(entry.2.abs()));
        let unit = if stiffest > 0.0 { stiffest } else { 1.0 };
        Ok(Self { here, closed, size, unit, friction: linear.friction().collect() })
    }

    fn model(&self) -> &LumpedModel {
        self.here.model()
    }

    /// The matrices of the contact state.
    pub(super) fn matrices(&self) -> Bordered {
        let model = self.model();
        let dense = |entries: Vec<Entry>| {
            let mut matrix = DMatrix::zeros(self.size, self.size);
            entries.into_iter().for_each(|(row, column, value)| matrix[(row, column)] += value);
            matrix
        };
        let mass: Vec<Entry> = model.mass.entries().collect();
        let mut stiffness: Vec<Entry> = model.stiffness.entries().collect();
        let mut damping: Vec<Entry> = model.dampers.entries().collect();
        add(&mut damping, model.damping.alpha, &mass);
        add(&mut damping, model.damping.beta, &stiffness);
        for &Closed { contact, row, sign } in &self.closed {
            let Contact { normal, tangent, transverse, .. } = &model.contacts[contact];
            self.hold(&mut stiffness, row, normal);
            let Some(sign) = sign else {
                self.press(&mut stiffness, row, normal, 1.0);
                self.hold(&mut stiffness, row + 1, tangent);
                self.press(&mut stiffness, row + 1, tangent, 1.0);
                continue;
            };
            let friction = self.friction[contact];
            self.press(&mut stiffness, row, normal, 1.0);
            self.press(&mut stiffness, row, tangent, sign * friction.coefficient);
            outer(&mut damping, friction.damping, tangent, tangent);
            if let Some(across) = transverse {
                outer(&mut damping, friction.transverse, across, across);
            }
        }
        Bordered { mass: dense(mass), damping: dense(damping), stiffness: dense(stiffness) }
    }

    /// The derivatives of the matrices by a parameter that changes the model so.
    ///
    /// # Errors
    /// Returns an error if the normal forces of the equilibrium have no derivative: where a structure jams.
    pub(super) fn change(&self, by: &ModelChange) -> Result<BorderedChange, Error> {
        let model = self.model();
        let mass: Vec<Entry> = by.mass.entries().collect();
        let mut stiffness: Vec<Entry> = by.stiffness.entries().collect();
        let mut damping: Vec<Entry> = by.dampers.entries().collect();
        add(&mut damping, model.damping.alpha, &mass);
        add(&mut damping, model.damping.beta, &stiffness);
        damping.extend(model.mass.entries().map(|(i, j, m)| (i, j, by.damping.alpha * m)));
        damping.extend(model.stiffness.entries().map(|(i, j, k)| (i, j, by.damping.beta * k)));
        let normal_force = self.normal_force_change(by)?;
        for &Closed { contact, row, sign } in &self.closed {
            let Contact { tangent, transverse, .. } = &model.contacts[contact];
            let change = &by.contacts[contact];
            self.hold(&mut stiffness, row, &change.normal);
            self.press(&mut stiffness, row, &change.normal, 1.0);
            let Some(sign) = sign else {
                self.hold(&mut stiffness, row + 1, &change.tangent);
                self.press(&mut stiffness, row + 1, &change.tangent, 1.0);
                continue;
            };
            let friction = self.friction[contact];
            let changed = self.friction_change(contact, by, normal_force[contact]);
            self.press(&mut stiffness, row, tangent, sign * changed.coefficient);
            self.press(&mut stiffness, row, &change.tangent, sign * friction.coefficient);
            outer(&mut damping, changed.damping, tangent, tangent);
            outer(&mut damping, friction.damping, &change.tangent, tangent);
            outer(&mut damping, friction.damping, tangent, &change.tangent);
            if let Some(across) = transverse {
                outer(&mut damping, changed.transverse, across, across);
                if let Some(turned) = &change.transverse {
                    outer(&mut damping, friction.transverse, turned, across);
                    outer(&mut damping, friction.transverse, across, turned);
                }
            }
        }
        let none = |entry: &Entry| entry.2 != 0.0;
        damping.retain(none);
        stiffness.retain(none);
        Ok(BorderedChange { mass, damping, stiffness })
    }

    /// `true` if a parameter is the velocity of a surface that stands still under a sliding contact whose friction depends on
    /// it: friction turns round there.
    pub(super) fn turns_round(&self, by: &ModelChange) -> bool {
        let model = self.model();
        let depends = model.needs_equilibrium() || model.law.has_fixed_direction();
        depends
            && self.closed.iter().any(|one| {
                let velocity = model.contacts[one.contact].surface_velocity;
                by.contacts[one.contact].velocity != 0.0 && velocity == 0.0
            })
    }

    /// Adds a row of G.
    fn hold(&self, entries: &mut Vec<Entry>, row: usize, direction: &Direction) {
        entries.extend(direction.0.iter().map(|&(dof, value)| (row, dof, self.unit * value)));
    }

    /// Adds to a column of −B.
    fn press(&self, entries: &mut Vec<Entry>, column: usize, direction: &Direction, factor: f64) {
        let factor = -self.unit * factor;
        entries.extend(direction.0.iter().map(|&(dof, value)| (dof, column, factor * value)));
    }

    /// The derivatives of the normal forces of the equilibrium, N per unit of the parameter; zeros where the linear
    /// equations do not depend on them.
    fn normal_force_change(&self, by: &ModelChange) -> Result<Vec<f64>, Error> {
        let model = self.model();
        if !model.needs_equilibrium() {
            return Ok(vec![0.0; model.contacts.len()]);
        }
        let rest = self.here.equilibrium()?;
        let mut load = by.load.clone();
        for (row, load) in load.iter_mut().enumerate() {
            *load -= by.stiffness.row_times(row, &rest.displacement);
        }
        let (mut slope_changes, mut gaps) = (Vec::new(), Vec::new());
        let forces = rest.normal_force.iter().zip(&rest.friction_force);
        for (i, (normal, friction)) in forces.enumerate() {
            let change = &by.contacts[i];
            change.normal.add_to(&mut load, *normal);
            change.tangent.add_to(&mut load, *friction);
            gaps.push(change.normal.dot(&rest.displacement));
            let slope = self.friction_change(i, by, 0.0).coefficient;
            slope_changes.push(model.contacts[i].sliding_sign() * slope);
        }
        let slopes: Vec<f64> = model.sliding_ratios().collect();
        let found = model.equilibrium_change(load, &slopes, &slope_changes, &gaps, rest)?;
        Ok(found.into_iter().map(|[normal, _]| normal).collect())
    }

    /// The derivative of the friction of a contact, whose normal force changes by `pressed`, N per unit of the parameter.
    fn friction_change(&self, contact: usize, by: &ModelChange, pressed: f64) -> SlidingFriction {
        let model = self.model();
        let (place, change) = (&model.contacts[contact], &by.contacts[contact]);
        if !model.rubs(place) {
            return SlidingFriction { coefficient: 0.0, damping: 0.0, transverse: 0.0 };
        }
        let velocity = place.surface_velocity;
        let speed = if velocity < 0.0 { -change.velocity } else { change.velocity };
        let Some(law) = model.law.friction.info().velocity_dependence else {
            let coefficient = change.friction.kinetic;
            let transverse = self.transverse_change(contact, coefficient, pressed, speed);
            return SlidingFriction { coefficient, damping: 0.0, transverse };
        };
        let along = |of: amontons::contact::friction::FrictionDerivatives| {
            of.kinetic * change.friction.kinetic
                + of.static_ * change.friction.static_
                + of.stribeck_velocity * change.friction.stribeck_velocity
                + of.speed * speed
        };
        let by_friction = (law.friction_by)(place.friction, velocity);
        let coefficient = along(by_friction);
        let damping = pressed * by_friction.speed
            + self.normal_force(contact) * along((law.slope_by)(place.friction, velocity));
        let transverse = self.transverse_change(contact, coefficient, pressed, speed);
        SlidingFriction { coefficient, damping, transverse }
    }

    /// The derivative of µ N / |v|, N s/m per unit of the parameter, for derivatives of µ, N (N) and |v| (m/s).
    fn transverse_change(&self, contact: usize, friction: f64, pressed: f64, speed: f64) -> f64 {
        let model = self.model();
        let place = &model.contacts[contact];
        let now = place.surface_velocity.abs();
        if place.transverse.is_none() || now == 0.0 {
            return 0.0;
        }
        let normal = self.normal_force(contact);
        let coefficient = model.sliding_friction(place);
        (friction * normal + coefficient * pressed) / now
            - coefficient * normal / now * (speed / now)
    }

    /// The normal force of a contact in the equilibrium, N; 0 where there is none.
    fn normal_force(&self, contact: usize) -> f64 {
        self.here.equilibrium().map_or(0.0, |rest| rest.normal_force[contact])
    }
}

fn add(entries: &mut Vec<Entry>, factor: f64, others: &[Entry]) {
    if factor != 0.0 {
        entries.extend(others.iter().map(|&(row, column, value)| (row, column, factor * value)));
    }
}

/// Adds factor · a bᵀ.
fn outer(entries: &mut Vec<Entry>, factor: f64, a: &Direction, b: &Direction) {
    if factor == 0.0 {
        return;
    }
    for &(i, a) in &a.0 {
        entries.extend(b.0.iter().map(|&(j, b)| (i, j, factor * (a * b))));
    }
}

/// Complex vectors as columns.
pub(super) type Matrix = DMatrix<Complex<f64>>;

impl Bordered {
    /// λ² mass + λ damping + stiffness.
    pub(super) fn at(&self, lambda: Complex<f64>) -> Matrix {
        let size = self.mass.nrows();
        DMatrix::from_fn(size, size, |row, column| {
            let place = (row, column);
            lambda * (lambda * self.mass[place] + self.damping[place]) + self.stiffness[place]
        })
    }

    /// Its derivative by λ times vectors: (2 λ mass + damping) Z.
    pub(super) fn slope_times(&self, lambda: Complex<f64>, vectors: &Matrix) -> Matrix {
        times(&self.mass, vectors) * (lambda * 2.0) + times(&self.damping, vectors)
    }

    /// Its second derivative by λ times vectors: 2 mass Z.
    pub(super) fn curvature_times(&self, vectors: &Matrix) -> Matrix {
        times(&self.mass, vectors) * Complex::from(2.0)
    }

    /// `true` if the state has no damping.
    pub(super) fn is_undamped(&self) -> bool {
        self.damping.iter().all(|entry| *entry == 0.0)
    }
}

/// A real matrix times complex vectors.
fn times(matrix: &DMatrix<f64>, vectors: &Matrix) -> Matrix {
    let [real, imaginary] = [vectors.map(|entry| entry.re), vectors.map(|entry| entry.im)];
    (matrix * real).zip_map(&(matrix * imaginary), Complex::new)
}

impl BorderedChange {
    /// `true` if the parameter changes nothing.
    pub(super) fn is_zero(&self) -> bool {
        self.mass.is_empty() && self.damping.is_empty() && self.stiffness.is_empty()
    }

    /// Adds a change of all three matrices with a factor.
    pub(super) fn add(&mut self, factor: f64, other: &Self) {
        add(&mut self.mass, factor, &other.mass);
        add(&mut self.damping, factor, &other.damping);
        add(&mut self.stiffness, factor, &other.stiffness);
    }

    /// The three lists of entries with the factors λ², λ and 1, or their derivatives by λ.
    fn parts(
        &self,
        factors: [Complex<f64>; 3],
    ) -> impl Iterator<Item = (usize, usize, Complex<f64>)> {
        let lists = [&self.mass, &self.damping, &self.stiffness].into_iter().zip(factors);
        lists.flat_map(|(entries, factor)| {
            entries.iter().map(move |&(i, j, value)| (i, j, factor * value))
        })
    }

    fn product(&self, factors: [Complex<f64>; 3], vectors: &Matrix) -> Matrix {
        let mut product = Matrix::zeros(vectors.nrows(), vectors.ncols());
        for (row, column, value) in self.parts(factors) {
            for vector in 0..vectors.ncols() {
                product[(row, vector)] += value * vectors[(column, vector)];
            }
        }
        product
    }

    /// (λ² mass + λ damping + stiffness) Z.
    pub(super) fn times(&self, lambda: Complex<f64>, vectors: &Matrix) -> Matrix {
        self.product([lambda * lambda, lambda, Complex::ONE], vectors)
    }

    /// Its derivative by λ: (2 λ mass + damping) Z.
    pub(super) fn slope_times(&self, lambda: Complex<f64>, vectors: &Matrix) -> Matrix {
        self.product([lambda * 2.0, Complex::ONE, Complex::ZERO], vectors)
    }

    /// Its second derivative by λ: 2 mass Z.
    pub(super) fn curvature_times(&self, vectors: &Matrix) -> Matrix {
        self.product([Complex::from(2.0), Complex::ZERO, Complex::ZERO], vectors)
    }

    /// Adds `factor` times the change to a matrix.
    pub(super) fn add_to(&self, matrix: &mut Matrix, lambda: Complex<f64>, factor: Complex<f64>) {
        for (row, column, value) in self.parts([lambda * lambda, lambda, Complex::ONE]) {
            matrix[(row, column)] += factor * value;
        }
    }
}
