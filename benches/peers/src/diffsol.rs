//! diffsol: Tsitouras' explicit Runge–Kutta method of order 5 with root finding.
//!
//! Between events the contact forces are eliminated: a sliding contact has N from its own row and
//! T = ±µN, a stuck one no tangential acceleration. M is diagonal and no two contacts share a mass, so
//! each contact's forces follow from its own two rows. The roots: N = 0 and v_r = 0 of a contact that
//! slips, |T| = µN of one that sticks, gap = 0 of one that is open.

use crate::peer::{Candidate, Outcome, Stopwatch};
use crate::scenes::{CONTACTS, DOFS, Problem, ROWS};
use diffsol::{
    NalgebraMat, NalgebraVec, NonLinearOp, OdeBuilder, OdeEquations, OdeSolverMethod,
    OdeSolverStopReason, Vector,
};
use std::array::from_fn;
use std::cell::Cell;

pub const WHO: &str = "diffsol, tsit45 with roots";

/// Typical sizes, by which the tuned settings scale absolute tolerances: m, m/s.
const SIZES: [f64; 2] = [1e-4, 1e-1];

/// A root function starts this far on its good side, so that one that starts at zero has a sign:
/// m/s of slip, m of a gap, N.
const SLIP_OFFSET: f64 = 1e-14;
const GAP_OFFSET: f64 = 1e-17;
const FORCE_OFFSET: f64 = 1e-10;

/// Contacts that change their states more often than this at one instant never come to an end.
const MOST_CHANGES: u32 = 16;

/// The defaults (both tolerances 1e-6), and relative tolerances with absolute ones of the motion's size.
pub fn candidates(problem: &Problem) -> Vec<Candidate> {
    let candidate = |setting, rtol, atol| {
        let problem = problem.clone();
        let run = Box::new(move || run(&problem, rtol, atol));
        Candidate { who: WHO, setting, run }
    };
    let rungs = (4..12).flat_map(|digits| [(1, digits), (3, digits + 1)]).chain([(1, 12)]);
    let tuned = rungs.map(|(times, digits)| {
        let rtol = f64::from(times) * 10_f64.powi(-digits);
        candidate(format!("rtol {times}e-{digits}"), rtol, SIZES.map(|size| rtol * size))
    });
    [candidate("default: rtol = atol = 1e-6".to_owned(), 1e-6, [1e-6; 2])]
        .into_iter()
        .chain(tuned)
        .collect()
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Slide,
    ReverseSlide,
    Stick,
    Detached,
}

/// The motion in the contacts' present states; z is (x, ẋ).
struct Motion<'a> {
    problem: &'a Problem,
    /// Column j: M⁻¹ K e_j. By columns the product runs in vectors.
    columns: [[f64; DOFS]; DOFS],
    free: [f64; DOFS],
    states: Cell<[State; CONTACTS]>,
    events: Cell<u64>,
    touch_downs: Cell<u64>,
}

impl<'a> Motion<'a> {
    fn new(problem: &'a Problem) -> Self {
        let Problem { mass, stiffness, force, .. } = problem;
        Self {
            problem,
            columns: from_fn(|j| from_fn(|i| stiffness[i][j] / mass[i])),
            free: from_fn(|i| force[i] / mass[i]),
            states: Cell::new([State::Slide; CONTACTS]),
            events: Cell::new(0),
            touch_downs: Cell::new(0),
        }
    }

    /// ż.
    fn rates(&self, z: &[f64], rates: &mut [f64]) {
        let Problem { alpha, beta, friction, normal, tangent, .. } = self.problem;
        let (x, v) = z.split_at(DOFS);
        let mut a: [f64; DOFS] = from_fn(|i| self.free[i] - alpha * v[i]);
        for (j, column) in self.columns.iter().enumerate() {
            let u = x[j] + beta * v[j];
            for (a, k) in a.iter_mut().zip(column) {
                *a -= k * u;
            }
        }
        for (c, state) in self.states.get().into_iter().enumerate() {
            let (n, t) = (normal[c], tangent[c]);
            let pull = friction * -a[n] * self.problem.mass[n] / self.problem.mass[t];
            match state {
                State::Slide => a[t] += pull,
                State::ReverseSlide => a[t] -= pull,
                State::Stick => a[t] = 0.0,
                State::Detached => continue,
            }
            a[n] = 0.0;
        }
        rates[..DOFS].copy_from_slice(v);
        rates[DOFS..].copy_from_slice(&a);
    }

    /// F − C ẋ − K x of one degree of freedom, N.
    fn force(&self, dof: usize, z: &[f64]) -> f64 {
        let Problem { mass, stiffness, alpha, beta, force, .. } = self.problem;
        let row = &stiffness[dof];
        let springs: f64 = (0..DOFS).map(|j| row[j] * (z[j] + beta * z[DOFS + j])).sum();
        force[dof] - springs - alpha * mass[dof] * z[DOFS + dof]
    }

    /// N, and T of a contact that sticks.
    fn contact_forces(&self, c: usize, z: &[f64]) -> [f64; 2] {
        [-self.force(self.problem.normal[c], z), -self.force(self.problem.tangent[c], z)]
    }

    fn slip(&self, c: usize, z: &[f64]) -> f64 {
        self.problem.slider_velocity - z[DOFS + self.problem.tangent[c]]
    }

    /// Two functions a contact that are positive as long as its state lasts.
    fn roots(&self, z: &[f64], roots: &mut [f64]) {
        for (c, state) in self.states.get().into_iter().enumerate() {
            let pressure = || -self.force(self.problem.normal[c], z) + FORCE_OFFSET;
            let pair = match state {
                State::Slide => [self.slip(c, z) + SLIP_OFFSET, pressure()],
                State::ReverseSlide => [-self.slip(c, z) + SLIP_OFFSET, pressure()],
                State::Stick => {
                    let [pressure, drag] = self.contact_forces(c, z);
                    let limit = self.problem.friction * pressure + FORCE_OFFSET;
                    [limit - drag, limit + drag]
                }
                State::Detached => [z[self.problem.normal[c]] + GAP_OFFSET, 1.0],
            };
            roots[2 * c..2 * c + 2].copy_from_slice(&pair);
        }
    }

    /// Root `index` has been reached: the states, and the velocities where a gap closes.
    fn change(&self, index: usize, z: &mut [f64]) {
        let mut roots = [0.0; 2 * CONTACTS];
        let mut next = Some(index);
        for _ in 0..MOST_CHANGES {
            let Some(root) = next else { return };
            self.change_contact(root / 2, root % 2, z);
            self.roots(z, &mut roots);
            next = roots.iter().position(|&root| root < 0.0);
        }
        panic!("the contacts change their states again and again at one instant");
    }

    fn change_contact(&self, c: usize, which: usize, z: &mut [f64]) {
        let mut states = self.states.get();
        let before = states[c];
        states[c] = match (before, which) {
            (State::Slide | State::ReverseSlide, 0) => {
                z[DOFS + self.problem.tangent[c]] = self.problem.slider_velocity;
                self.held(c, z)
            }
            (State::Slide | State::ReverseSlide, _) => State::Detached,
            (State::Stick, 0) => State::Slide,
            (State::Stick, _) => State::ReverseSlide,
            (State::Detached, _) => self.touch_down(c, z),
        };
        self.states.set(states);
        if states[c] != before {
            self.events.set(self.events.get() + 1);
            self.touch_downs.set(self.touch_downs.get() + u64::from(before == State::Detached));
        }
    }

    /// The state of a closed contact without slip.
    fn held(&self, c: usize, z: &[f64]) -> State {
        let [pressure, drag] = self.contact_forces(c, z);
        let limit = self.problem.friction * pressure;
        match drag {
            _ if pressure < 0.0 => State::Detached,
            drag if drag > limit => State::Slide,
            drag if drag < -limit => State::ReverseSlide,
            _ => State::Stick,
        }
    }

    /// A perfectly inelastic impact, with a tangential impulse of up to µ times the normal one.
    fn touch_down(&self, c: usize, z: &mut [f64]) -> State {
        let Problem { mass, friction, normal, tangent, .. } = self.problem;
        let (n, t) = (normal[c], tangent[c]);
        let limit = friction * mass[n] * z[DOFS + n].abs();
        (z[n], z[DOFS + n]) = (0.0, 0.0);
        let stop = mass[t] * self.slip(c, z);
        z[DOFS + t] += stop.clamp(-limit, limit) / mass[t];
        if stop.abs() <= limit {
            z[DOFS + t] = self.problem.slider_velocity;
            return self.held(c, z);
        }
        match self.contact_forces(c, z)[0] {
            pressure if pressure < 0.0 => State::Detached,
            _ if stop > 0.0 => State::Slide,
            _ => State::ReverseSlide,
        }
    }
}

fn run(problem: &Problem, rtol: f64, [x_atol, v_atol]: [f64; 2]) -> Outcome {
    let motion = &Motion::new(problem);
    let start_at = problem.displacement.iter().chain(&problem.velocity);
    let ode = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(rtol)
        .atol((0..2 * DOFS).map(|i| if i < DOFS { x_atol } else { v_atol }))
        .h0(1e-5)
        .rhs(|z, _, _, rates| motion.rates(z, rates))
        .init(
            |_, _, z| z.iter_mut().zip(start_at.clone()).for_each(|(z, start)| *z = *start),
            2 * DOFS,
        )
        .root(|z, _, _, roots| motion.roots(z, roots), 2 * CONTACTS)
        .build()
        .expect("the equations are complete");
    let mut solver = ode.tsit45().expect("they are explicit");
    let mut at_row = NalgebraVec::zeros(2 * DOFS, Default::default());
    let mut displacements = Vec::with_capacity(ROWS * DOFS);
    let mut row = 1;

    let mut watch = Stopwatch::start();
    while row <= ROWS {
        let root = match solver.step().expect("it goes on") {
            OdeSolverStopReason::RootFound(time, index) => Some((time, index)),
            _ => None,
        };
        let reached = root.map_or(solver.state().t, |(time, _)| time);
        while row <= ROWS && 1e-3 * row as f64 <= reached {
            solver.interpolate_inplace(1e-3 * row as f64, &mut at_row).expect("it is in the step");
            displacements.extend_from_slice(&at_row.batch_as_slice(0)[..DOFS]);
            watch.row(row);
            row += 1;
        }
        if let Some((time, index)) = root.filter(|_| row <= ROWS) {
            solver.state_mut_back(time).expect("it is in the step");
            let state = solver.state_mut();
            motion.change(index, state.y.batch_as_mut_slice(0));
            ode.eqn.rhs().call_inplace(state.y, time, state.dy);
        }
    }
    let [events, touch_downs] =
        [&motion.events, &motion.touch_downs].map(|count| Some(count.get()));
    Outcome { displacements, events, touch_downs, slices: watch.slices() }
}
