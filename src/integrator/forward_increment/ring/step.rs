//! The time step of the paper on a ring of modules, eqs. (13) to (18).
//!
//! The paper keeps x_n and x_{n−1}; this file keeps x_n and ẋ_n = (x_n − x_{n−1})/h. A displacement of eqs. (13) to
//! (18) is then x_n + h ẋ, and the equations are, for the velocities:
//!
//! * predictor, eq. (13): ẋ* = ẋ_n + h M⁻¹ (F_n − C ẋ_n − K x_n);
//! * multipliers, eqs. (15) and (16): λ = (N, T) such that x*_N + h² M⁻¹ N = 0 and ẋ*_T + h M⁻¹ T is the surface's
//!   velocity, as far as N ≥ 0 and the law of friction allow;
//! * corrector, eqs. (17) and (18): ẋ_{n+1} = ẋ* + h M⁻¹ Gᵀ λ and x_{n+1} = x_n + h ẋ_{n+1}.
//!
//! Each contact has degrees of freedom of its own and M is diagonal, so G M⁻¹ Gᵀ is diagonal too: one iteration of
//! Gauss–Seidel, eqs. (19) to (23), solves all contacts. N ≥ 0 is compressive here; the paper's N is −N.
//!
//! C = α M + β K. The term with α multiplies ẋ_n by 1 − h α; the term with β makes K act on x_n + β ẋ_n.

use crate::contact::{ContactState, FrictionLaw};
use crate::integrator::{Inputs, Motion};
use crate::model::Damping;
use crate::model::ring::{MODULE_DOFS, NORMAL, TANGENT};
use std::marker::PhantomData;

/// One value for each degree of freedom of a module.
pub(super) type ModuleVector = [f64; MODULE_DOFS];

/// The rows of M and K that belong to one module.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// The mass in contact, along the tangent and along the normal, kg.
    pub(super) mass: [f64; 2],
    /// The diagonal of M⁻¹, 1/kg.
    pub(super) inverse_mass: ModuleVector,
    /// The columns of the module's own block of K, N/m.
    pub(super) own: [ModuleVector; MODULE_DOFS],
    /// The entries of K between x1, x2 and the same coordinates of the module before, N/m.
    pub(super) before: [f64; 2],
    /// The entries of K between x1, x2 and the same coordinates of the module after, N/m.
    pub(super) after: [f64; 2],
}

/// Writes x + β ẋ (m) of as many modules as `effective` has room for.
#[inline(always)]
pub(super) fn set_effective(effective: &mut [ModuleVector], motion: &Motion, beta: f64) {
    // Number by number, which the compiler does faster than module by module: this is a good part of a call for one
    // step.
    let moving = motion.displacement.iter().zip(&motion.velocity);
    for (w, (x, v)) in effective.as_flattened_mut().iter_mut().zip(moving) {
        *w = x + beta * v;
    }
}

/// x + β ẋ of a module, m.
#[inline(always)]
fn effective_displacement(x: &ModuleVector, v: &ModuleVector, beta: f64) -> ModuleVector {
    [x[0] + beta * v[0], x[1] + beta * v[1], x[2] + beta * v[2], x[3] + beta * v[3]]
}

/// The coordinates of a module that links join: x1 and x2.
#[inline(always)]
pub(super) fn linked(vector: &ModuleVector) -> [f64; 2] {
    [vector[0], vector[1]]
}

impl Block {
    /// F − K w with w = x + β ẋ, N. With `RESTING` the normal column is left out, which then acts on zero; without `LINKS`
    /// the links, which are then zero.
    #[inline(always)]
    pub(super) fn force<const RESTING: bool, const LINKS: bool>(
        &self,
        load: &ModuleVector,
        w: &ModuleVector,
        [before, after]: [[f64; 2]; 2],
    ) -> ModuleVector {
        let row = |r: usize| {
            let upper = self.own[0][r] * w[0] + self.own[1][r] * w[1];
            let tangential = self.own[2][r] * w[2];
            let lower = if RESTING { tangential } else { tangential + self.own[3][r] * w[3] };
            load[r] - (upper + lower)
        };
        let link = |r: usize| self.before[r] * before[r] + self.after[r] * after[r];
        let [first, second] = [row(0), row(1)];
        [
            if LINKS { first - link(0) } else { first },
            if LINKS { second - link(1) } else { second },
            row(2),
            row(3),
        ]
    }
}

/// The scheme with steps of one length under the law of friction `L`. The effects that are `false` are not compiled:
/// contacts that open, Rayleigh damping, links between modules.
pub(super) struct Scheme<L, const DETACHMENT: bool, const DAMPING: bool, const LINKS: bool> {
    /// Step h, s.
    h: f64,
    /// Reciprocal of the step 1/h, 1/s.
    per_h: f64,
    /// Factor 1 − h α of the velocities that mass-proportional damping leaves.
    retained: f64,
    /// Stiffness-proportional damping β, s.
    beta: f64,
    law: PhantomData<L>,
}

/// A module at the beginning or at the end of a step.
#[derive(Clone, Copy)]
struct ModuleState {
    /// Displacements x, m.
    x: ModuleVector,
    /// Velocities ẋ, m/s.
    v: ModuleVector,
    /// The state of the module's contact.
    state: ContactState,
}

/// The surface that a module rubs on.
struct Surface<L> {
    /// Velocity of the surface along the tangent, m/s.
    velocity: f64,
    /// The law of friction over this step.
    law: L,
}

/// The parts of the law of contact that a scene leaves out and a step would have needed.
struct LawViolations {
    /// `true` if the mass slips against the direction of friction that is held fixed.
    reversed_slip: bool,
    /// `true` if a contact that cannot open pulls.
    pull: bool,
}

impl<L: FrictionLaw, const DETACHMENT: bool, const DAMPING: bool, const LINKS: bool>
    Scheme<L, DETACHMENT, DAMPING, LINKS>
{
    /// The scheme with steps of length `h` (s).
    pub(super) fn new(h: f64, Damping { alpha, beta }: Damping) -> Self {
        Self { h, per_h: 1.0 / h, retained: 1.0 - h * alpha, beta, law: PhantomData }
    }

    /// Takes `count` steps of all modules. `effective` has room for x + β ẋ of each module.
    #[inline(always)]
    pub(super) fn steps(
        &self,
        blocks: &[Block],
        effective: &mut [ModuleVector],
        motion: &mut Motion,
        inputs: &Inputs,
        count: u64,
    ) {
        // Slices of one length need no checks of indices.
        let modules = blocks.len();
        let w = &mut effective[..if DAMPING { modules } else { 0 }];
        set_effective(w, motion, self.beta);
        let load = &inputs.force.as_chunks().0[..modules];
        let (velocities, frictions) =
            (&inputs.slider_velocity[..modules], &inputs.friction[..modules]);
        let x = &mut motion.displacement.as_chunks_mut().0[..modules];
        let v = &mut motion.velocity.as_chunks_mut().0[..modules];
        let states = &mut motion.contacts[..modules];
        let statistics = &mut motion.statistics;
        for _ in 0..count {
            // Links act on what the neighbours had before the step. The first module's is overwritten before the last one
            // uses it, and each module's before the next one does: those are kept here.
            let now = if DAMPING { &*w } else { &*x };
            let first = linked(&now[0]);
            let mut before = linked(&now[modules - 1]);
            for i in 0..modules {
                let now = if DAMPING { &*w } else { &*x };
                let own = now[i];
                let after = if i + 1 < modules { linked(&now[i + 1]) } else { first };
                let old = ModuleState { x: x[i], v: v[i], state: states[i] };
                let velocity = velocities[i];
                let law = L::new(frictions[i], velocity).at(velocity - old.v[TANGENT], old.state);
                let surface = Surface { velocity, law };
                let links = [before, after];
                let is_resting = !DETACHMENT || (old.x[NORMAL] == 0.0 && old.v[NORMAL] == 0.0);
                let (new, violations) = if is_resting {
                    self.step::<true>(&blocks[i], &load[i], &own, links, &surface, &old)
                } else {
                    self.step::<false>(&blocks[i], &load[i], &own, links, &surface, &old)
                };
                (x[i], v[i]) = (new.x, new.v);
                if DAMPING {
                    w[i] = effective_displacement(&new.x, &new.v, self.beta);
                }
                before = linked(&own);
                if old.state != new.state {
                    states[i] = new.state;
                    statistics.count_change(new.state);
                    statistics.touch_downs += u64::from(old.state == ContactState::Detached);
                }
                if !L::STICKS || !DETACHMENT {
                    statistics.reversed_slips += u64::from(violations.reversed_slip);
                    statistics.pulled_contacts += u64::from(violations.pull);
                }
            }
        }
        statistics.steps += count;
        // The Delassus matrix is diagonal: one iteration solves the contacts.
        statistics.sweeps += count;
        statistics.most_sweeps = statistics.most_sweeps.max(count.min(1));
    }

    /// One step of one module, on which its own `w` and its neighbours' `links` act. `RESTING` says that the mass rests on
    /// its surface, x_N = ẋ_N = 0, as it does most of the time; both kinds are compiled by themselves.
    #[inline(always)]
    fn step<const RESTING: bool>(
        &self,
        block: &Block,
        load: &ModuleVector,
        w: &ModuleVector,
        links: [[f64; 2]; 2],
        surface: &Surface<L>,
        &ModuleState { x, v, state: before }: &ModuleState,
    ) -> (ModuleState, LawViolations) {
        let h = self.h;
        // Forces of eq. (13): F_n − C ẋ_n − K x_n, but for the term with α.
        let force = block.force::<RESTING, LINKS>(load, w, links);

        // Predictor, eq. (13). Closures: each branch below computes no more than it uses.
        let predictor =
            |dof: usize, force: f64| self.retained(v[dof]) + h * (force * block.inverse_mass[dof]);
        let free_normal = || predictor(NORMAL, force[NORMAL]);
        let free_gap = || x[NORMAL] + h * free_normal();
        let is_closed =
            !DETACHMENT || if RESTING { force[NORMAL] <= 0.0 } else { free_gap() <= 0.0 };

        let (tangential, normal, gap, state, pull);
        if is_closed {
            // Multipliers, eqs. (15) and (16): N, then T, which N limits.
            let pressing = if RESTING {
                -force[NORMAL]
            } else {
                self.landing_force(block, force[NORMAL], x[NORMAL], v[NORMAL])
            };
            // Where a contact cannot open, friction that can stick follows |N|, so that it never drives the motion; friction with a
            // fixed direction follows N, so that the motion is linear.
            let limiting = if L::STICKS && !DETACHMENT { pressing.abs() } else { pressing };
            let friction = self.friction(block, &force, v[TANGENT], surface, limiting, before);
            // Corrector, eqs. (17) and (18): it ends exactly on the surface, and exactly with its velocity in stick.
            (tangential, state) = match friction {
                None => (surface.velocity, ContactState::Stick),
                Some((t, state)) => (predictor(TANGENT, force[TANGENT] + t), state),
            };
            normal = if RESTING { 0.0 } else { (0.0 - x[NORMAL]) * self.per_h };
            gap = 0.0;
            pull = !DETACHMENT && pressing < 0.0;
        } else {
            // λ = 0: the predictor is the new motion.
            tangential = predictor(TANGENT, force[TANGENT]);
            (normal, gap, state) = (free_normal(), free_gap(), ContactState::Detached);
            pull = false;
        }
        let new = [predictor(0, force[0]), predictor(1, force[1]), tangential, normal];
        let moved = [x[0] + h * new[0], x[1] + h * new[1], x[2] + h * new[2], gap];

        let has_fixed_direction = !L::STICKS && L::HAS_DIRECTION;
        let slip = surface.velocity - tangential;
        let reversed_slip = has_fixed_direction && is_closed && slip * surface.velocity < 0.0;
        (ModuleState { x: moved, v: new, state }, LawViolations { reversed_slip, pull })
    }

    /// N of a mass that lands, N: eq. (16) along the normal. It takes away the velocity (m/s) with which the mass would
    /// pass its surface, `gap` (m) away, under the normal `force` (N).
    #[inline(always)]
    fn landing_force(&self, block: &Block, force: f64, gap: f64, velocity: f64) -> f64 {
        let excess = self.retained(velocity) + gap * self.per_h;
        let landing = -(force + block.mass[1] * excess * self.per_h);
        if 0.0 < landing { landing } else { 0.0 }
    }

    /// T of a contact that presses with `normal` (N) and slips, N, and its state: eq. (16) along the tangent, cut off by
    /// the law of friction. `None` where the law lets T hold the mass on its surface.
    #[inline(always)]
    fn friction(
        &self,
        block: &Block,
        force: &ModuleVector,
        velocity: f64,
        surface: &Surface<L>,
        normal: f64,
        before: ContactState,
    ) -> Option<(f64, ContactState)> {
        let lag = surface.velocity - self.retained(velocity);
        let holding = block.mass[0] * lag * self.per_h - force[TANGENT];
        if L::STICKS && surface.law.holds(holding, normal, before) {
            return None;
        }
        Some(surface.law.slip(holding, normal))
    }

    /// (1 − h α) ẋ: the velocity that the damping α M leaves, m/s.
    #[inline(always)]
    fn retained(&self, velocity: f64) -> f64 {
        if DAMPING { velocity * self.retained } else { velocity }
    }
}
