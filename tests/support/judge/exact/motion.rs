//! Exact motion in one contact state by the exponential of a matrix that is built from M, C, K, the directions of the
//! contacts and their states.

use super::{Observation, SLOW};
use crate::judge::{Acting, ROUNDING, Run, singular};
use amontons::contact::ContactState::{self, Detached, Stick};
use amontons::contact::Friction;
use amontons::integrator::{Inputs, Integrator, Wave};
use amontons::model::LumpedModel;
use amontons::simulation::Simulation;
use nalgebra::{DMatrix, DVector};

/// Number of exponentials that are kept.
const KEPT: usize = 256;

/// The effect of a force f on the masses and of the accelerations of the sliders in one contact state.
pub(in crate::judge) struct Held {
    pub(super) states: Vec<ContactState>,
    friction: Vec<Friction>,
    /// λ, (N, T) of each contact, from f: 2 c × n.
    pub(in crate::judge) multipliers: DMatrix<f64>,
    /// λ from the sliders' accelerations: 2 c × c.
    pub(super) carried: DMatrix<f64>,
    /// ẍ from f: n × n.
    pub(in crate::judge) mobility: DMatrix<f64>,
    /// ẍ from the sliders' accelerations: n × c.
    pub(super) follows: DMatrix<f64>,
    /// `true` if redundant contacts can share their load in several ways and the masses move accordingly. The law then
    /// does not determine the motion.
    pub(super) is_undetermined: bool,
}

/// Kept exponentials: arguments and results.
type Exponentials = Vec<(Vec<f64>, DMatrix<f64>)>;

#[derive(Default)]
pub(in crate::judge) struct Memory {
    pub(in crate::judge) held: Vec<Held>,
    kept: Exponentials,
    pub(super) probe: Option<Simulation>,
    pub(super) integrator: Option<Box<dyn Integrator>>,
}

/// Position and velocity at one instant.
pub type Place = [DVector<f64>; 2];

/// A sine that acts over a step.
pub(in crate::judge) struct Swing {
    /// 1/s.
    pub(in crate::judge) pulsation: f64,
    /// Its amplitude times sine and cosine of its phase, where the step begins.
    pub(in crate::judge) start: [f64; 2],
    /// The force that a unit of it is, and the velocities that it gives sliders.
    pub(in crate::judge) pushes: DVector<f64>,
    pub(in crate::judge) moves: DVector<f64>,
}

impl Swing {
    /// Sine and cosine `t` (s) later.
    fn at(&self, t: f64) -> [f64; 2] {
        let ((sin, cos), [s, c]) = ((self.pulsation * t).sin_cos(), self.start);
        [s * cos + c * sin, c * cos - s * sin]
    }

    /// By how much it has changed by then.
    fn change(&self, t: f64) -> f64 {
        self.at(t)[0] - self.start[0]
    }
}

/// The actions over a step: forces and slider velocities change linearly and by sines.
pub(super) struct Span {
    pub(super) start: Acting,
    /// Linear rate of the forces, N/s.
    pub(super) rate: DVector<f64>,
    /// Linear rate of the sliders' velocities, m/s².
    pub(super) steady: DVector<f64>,
    swings: Vec<Swing>,
    /// `true` if this form holds; `false` if a slider's velocity bends within the step.
    pub(super) is_straight: bool,
}

impl Span {
    pub(super) fn force(&self, t: f64) -> DVector<f64> {
        let swings = self.swings.iter().map(|swing| &swing.pushes * swing.change(t));
        swings.fold(&self.start.force + &self.rate * t, |sum, force| sum + force)
    }

    pub(super) fn slider(&self, contact: usize, t: f64) -> f64 {
        let swings = self.swings.iter().map(|swing| swing.moves[contact] * swing.change(t));
        self.start.slider_velocity[contact] + self.steady[contact] * t + swings.sum::<f64>()
    }

    /// The drive of an integrator for the part of the step between two times (s). `force` holds the outer forces (N) where the
    /// part begins.
    pub(super) fn drive(&self, force: &DVector<f64>, [from, to]: [f64; 2]) -> Inputs {
        let contacts = 0..self.steady.len();
        let wave = |swing: &Swing| {
            let [sine, cosine] = swing.at(from);
            let pushes = swing.pushes.iter().copied().enumerate().filter(|push| push.1 != 0.0);
            let moves = contacts.clone().filter(|&i| swing.moves[i] != 0.0);
            Wave {
                amplitude: sine.hypot(cosine),
                pulsation: swing.pulsation,
                phase: sine.atan2(cosine),
                pushes: pushes.collect(),
                moves: moves.collect(),
                friction: Vec::new(),
            }
        };
        // Not a difference of velocities, of which rounding is a part of them however short the time is.
        let half = 0.5 * (to - from);
        let mean = |i: usize| {
            let swung = self.swings.iter().map(|swing| {
                let phase = swing.pulsation * half;
                swing.moves[i] * swing.at(from + half)[1] * phase.sin() / half
            });
            self.steady[i] + swung.sum::<f64>()
        };
        Inputs {
            force: force.as_slice().to_vec(),
            force_rate: self.rate.as_slice().to_vec(),
            slider_velocity: contacts.clone().map(|i| self.slider(i, to)).collect(),
            slider_acceleration: contacts.clone().map(mean).collect(),
            friction: self.start.friction.clone(),
            friction_rate: vec![[0.0; 2]; self.steady.len()],
            waves: self.swings.iter().map(wave).collect(),
        }
    }

    /// The accelerations of the sliders, m/s².
    pub(super) fn acceleration(&self, t: f64) -> DVector<f64> {
        let swings = self.swings.iter();
        let swings = swings.map(|swing| &swing.moves * (swing.pulsation * swing.at(t)[1]));
        swings.fold(self.steady.clone(), |sum, acceleration| sum + acceleration)
    }
}

impl Held {
    fn new(run: &Run, states: &[ContactState], friction: &[Friction]) -> Self {
        let (n, contacts) = (run.model.dofs(), states.len());
        // Unknowns: N of each closed contact, which brings T = ±µN where it slides, and T of each stuck
        // one; rows: the directions that are held.
        let (mut rows, mut expands, mut sliders) = (Vec::new(), Vec::new(), Vec::new());
        for (i, &state) in states.iter().enumerate() {
            if state == Detached {
                continue;
            }
            let slope = state.sliding_direction().unwrap_or(0.0) * friction[i].kinetic;
            rows.push(2 * i);
            sliders.push(None);
            expands.push(vec![(2 * i, 1.0), (2 * i + 1, slope)]);
            if state == Stick {
                rows.push(2 * i + 1);
                sliders.push(Some(i));
                expands.push(vec![(2 * i + 1, 1.0)]);
            }
        }
        let unknowns = rows.len();
        let inverse = &run.inverse_mass;
        let held = run.directions.select_columns(&rows).transpose();
        let mut expand = DMatrix::zeros(2 * contacts, unknowns);
        for (column, parts) in expands.iter().enumerate() {
            parts.iter().for_each(|&(row, value)| expand[(row, column)] = value);
        }
        let mut surface = DMatrix::zeros(unknowns, contacts);
        for (row, slider) in sliders.into_iter().enumerate() {
            if let Some(contact) = slider {
                surface[(row, contact)] = 1.0;
            }
        }
        let pushes = &run.directions * &expand;
        let matrix = &held * inverse * &pushes;
        let solved = solve(&matrix);
        let multipliers = -(&expand * &solved * &held * inverse);
        let carried = &expand * &solved * surface;
        let mobility = inverse * (DMatrix::identity(n, n) + &run.directions * &multipliers);
        let follows = inverse * &run.directions * &carried;
        let free = DMatrix::identity(unknowns, unknowns) - &solved * &matrix;
        let moved = inverse * &pushes;
        let is_undetermined = (&moved * free).amax() > 1e-6 * moved.amax();
        let (states, friction) = (states.to_vec(), friction.to_vec());
        Self { states, friction, multipliers, carried, mobility, follows, is_undetermined }
    }
}

/// The inverse, or where contacts are redundant, the least of them.
fn solve(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.is_empty() {
        return matrix.transpose();
    }
    let largest = matrix.amax();
    if singular::rank(matrix, 1e-9 * largest) == matrix.nrows() {
        matrix.clone().try_inverse().unwrap()
    } else {
        singular::pseudo_inverse(matrix, 1e-9 * largest)
    }
}

/// The highest frequency of the masses on their own springs, 1/s; 1 without springs.
pub(in crate::judge) fn fastest(model: &LumpedModel) -> f64 {
    let squares = (0..model.dofs()).map(|i| model.stiffness.get(i, i) / model.mass.get(i, i));
    let square = squares.fold(0.0, f64::max);
    if square > 0.0 { square.sqrt() } else { 1.0 }
}

impl Run {
    /// The place in `memory.held` of a contact state.
    pub(in crate::judge) fn held(
        &mut self,
        states: &[ContactState],
        friction: &[Friction],
    ) -> usize {
        let known = self.memory.held.iter();
        let found = known.clone().position(|h| h.states == states && h.friction == friction);
        found.unwrap_or_else(|| {
            let held = Held::new(self, states, friction);
            self.memory.held.push(held);
            self.memory.held.len() - 1
        })
    }

    /// Returns the actions over the step that begins at `time`.
    pub(super) fn span(&mut self, time: f64) -> Span {
        let h = self.h();
        let middle = self.acting_at([time, time + 0.5 * h]).slider_velocity;
        let Acting { slider_velocity: end, friction, .. } = self.acting_at([time, time + h]);
        let [rate, _] = self.rates(time);
        let start = Acting { friction, ..self.acting_at([time, time]) };
        let swings = self.swings(time);
        let contacts = start.slider_velocity.len();
        let swung = |i: usize, t: f64| -> f64 {
            swings.iter().map(|swing| swing.moves[i] * swing.change(t)).sum()
        };
        let change = |i: usize| end[i] - start.slider_velocity[i] - swung(i, h);
        let steady = DVector::from_fn(contacts, |i, _| change(i) / h);
        let bends = |i: usize| {
            let moved = middle[i] - start.slider_velocity[i] - swung(i, 0.5 * h);
            (moved - 0.5 * change(i)).abs()
        };
        let scale = self.scales.velocity;
        let is_straight = (0..contacts).all(|i| bends(i) <= 1e-12 * scale.max(end[i].abs()));
        Span { start, rate, steady, swings, is_straight }
    }

    /// Follows the motion for `t` (s) from `from`, when `begin` (s) of the step have passed, without a change of state.
    /// Returns the end and its rounding error, as a velocity.
    pub(super) fn follow(
        &mut self,
        held: usize,
        from: &Place,
        span: &Span,
        [begin, t]: [f64; 2],
    ) -> (Place, f64) {
        let n = self.model.dofs();
        let omega = self.fastest;
        let swings: Vec<[f64; 2]> = span.swings.iter().map(|swing| swing.at(begin)).collect();
        let swung = span.swings.iter().zip(&swings).map(|(swing, now)| &swing.pushes * now[0]);
        let rest = span.force(begin) - &self.stiffness * self.total(&DVector::zeros(n));
        let rest = swung.fold(rest, |rest, force| rest - force);
        let state = &self.memory.held[held];
        let constant = &state.mobility * &rest + &state.follows * &span.steady;
        let linear = &state.mobility * &span.rate;
        // The accelerations by the sine and cosine of each swing.
        let swung = span.swings.iter().map(|swing| {
            let carried = &state.follows * &swing.moves * swing.pulsation;
            (swing.pulsation, [&state.mobility * &swing.pushes, carried])
        });
        let swung: Vec<(f64, [DVector<f64>; 2])> = swung.collect();
        // Two more unknowns, a constant and the time, of the size of the velocities that they make.
        let size = (constant.norm() / omega).max(linear.norm() / (omega * omega));
        let size = swung.iter().zip(&swings).fold(size, |size, ((_, [sine, cosine]), [s, c])| {
            size.max((sine.norm() + cosine.norm()) * s.hypot(*c) / omega)
        });
        let size = if size > 0.0 { size } else { 1.0 };
        let mut key = vec![held as f64, t, size];
        key.extend(constant.iter().chain(linear.iter()));
        for (pulsation, [sine, cosine]) in &swung {
            key.extend([*pulsation].iter().chain(sine.iter()).chain(cosine.iter()));
        }
        let places = 2 * n + 2 + 2 * swung.len();
        let known = self.memory.kept.iter().position(|(known, _)| *known == key);
        let place = known.unwrap_or_else(|| {
            let mut matrix = DMatrix::zeros(places, places);
            matrix.view_mut((0, n), (n, n)).fill_diagonal(omega);
            let part = |block: &DMatrix<f64>, factor: f64| -(&state.mobility * block) * factor;
            matrix.view_mut((n, 0), (n, n)).copy_from(&part(&self.stiffness, 1.0 / omega));
            matrix.view_mut((n, n), (n, n)).copy_from(&part(&self.damping, 1.0));
            matrix.view_mut((n, 2 * n), (n, 1)).copy_from(&(&constant / size));
            matrix.view_mut((n, 2 * n + 1), (n, 1)).copy_from(&(&linear / (size * omega)));
            matrix[(2 * n + 1, 2 * n)] = omega;
            for (i, (pulsation, columns)) in swung.iter().enumerate() {
                let [sine, cosine] = [0, 1].map(|k| 2 * n + 2 + 2 * i + k);
                matrix.view_mut((n, sine), (n, 1)).copy_from(&columns[0]);
                matrix.view_mut((n, cosine), (n, 1)).copy_from(&columns[1]);
                (matrix[(sine, cosine)], matrix[(cosine, sine)]) = (*pulsation, -pulsation);
            }
            if self.memory.kept.len() >= KEPT {
                self.memory.kept.clear();
            }
            self.memory.kept.push((key, (matrix * t).exp()));
            self.memory.kept.len() - 1
        });
        let start = from[0].iter().map(|x| omega * x).chain(from[1].iter().copied());
        let start = start.chain([size, 0.0]).chain(swings.into_iter().flatten());
        let start = DVector::from_iterator(places, start);
        let end = &self.memory.kept[place].1 * &start;
        let reached = [end.rows(0, n) / omega, end.rows(n, n).into_owned()];
        let largest = |z: &DVector<f64>| z.rows(0, 2 * n).amax();
        let turns = omega * t;
        // Loads and springs that hold each other are known to their rounding. A soft spring under a load stretches the
        // stiff ones beside it by as much, so their forces may be far larger than the load.
        let balanced = self.stiffness.abs() * self.total(&from[0]).abs()
            + DVector::from_column_slice(&self.model.load).abs();
        let lost = largest(&start).max(largest(&end)).max(size * turns.min(1.0))
            // Growing motions also amplify the rounding errors of the balance of forces.
            + t * (self.inverse_mass.abs() * balanced).amax() * self.grown(place).max(1.0);
        // Times are known to the last digit of the time since the start, those at which contacts land as
        // near as their gaps are, which are differences of displacements.
        let gap = 4.0 * f64::EPSILON * from[0].amax();
        let ended = SLOW * self.scales.velocity;
        let approaches = (0..state.states.len()).map(|i| {
            let normal = self.directions.column(2 * i);
            [&from[1], &reached[1]].map(|v| normal.dot(v).abs()).into_iter().fold(0.0, f64::max)
        });
        let bounces: Vec<f64> = approaches.filter(|v| *v > 1e-4 * ended).collect();
        let lands = bounces.iter().fold(0.0, |most, v| f64::max(most, gap / v));
        let late = (4.0 * f64::EPSILON * self.time() + lands) * omega;
        let fastest = largest(&start).max(largest(&end)).max(size);
        // A bounce this slow remains from impacts of contacts that throw each other off, each as accurate as rounding
        // permits.
        let is_slow = !self.is_exact && bounces.iter().any(|v| *v < ended);
        let left = if is_slow { ended } else { 0.0 };
        // Putting inclined contacts where they belong costs as much again.
        let often = if self.is_exact { 10.0 } else { 20.0 };
        (reached, often * ROUNDING * (1.0 + turns) * lost + late * fastest + left)
    }

    /// The largest factor from a displacement (times the highest frequency) or a velocity at the beginning to a velocity at the
    /// end, in the exponential that is kept at this place.
    fn grown(&self, place: usize) -> f64 {
        let n = self.model.dofs();
        self.memory.kept[place].1.view((n, 0), (n, 2 * n)).amax()
    }

    /// The force on the masses without that of contacts, and its rounding errors, N.
    pub(super) fn outer(&self, span: &Span, observation: &Observation) -> (DVector<f64>, f64) {
        let [x, v] = &observation.place;
        let total = self.total(x);
        let parts = [span.force(observation.t), -(&self.damping * v), -(&self.stiffness * &total)];
        let lost =
            parts[0].amax() + self.damping.amax() * v.amax() + self.stiffness.amax() * total.amax();
        (parts.into_iter().sum(), ROUNDING * lost)
    }
}
