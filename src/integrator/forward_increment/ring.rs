//! The scheme on a ring of modules: diagonal mass, one contact a module, links to the neighbours.

use crate::contact::{ContactForce, ContactState, Coulomb, FrictionLaw};
use crate::integrator::{Drive, Integrator, Motion, StepFailure};
use crate::model::ring::MODULE_DOFS;
use crate::model::{Damping, LumpedModel};

/// Places of the tangential and the normal degree of freedom in a module.
const TANGENT: usize = 2;
const NORMAL: usize = 3;

/// One value a degree of freedom of a module.
type Vector = [f64; MODULE_DOFS];

/// Forward increment Lagrange multipliers on a ring of modules.
pub struct RingForwardIncrement {
    blocks: Vec<Block>,
    damping: Damping,
    /// x + β ẋ, on which K acts for springs and dampers at once.
    strained: Vec<Vector>,
}

/// A module's rows of M and K.
#[derive(Clone, Copy, Debug)]
struct Block {
    mass: Vector,
    inverse_mass: Vector,
    /// Columns of the module's own block of K.
    own: [Vector; MODULE_DOFS],
    /// Links of x1 and x2 to the same coordinate of the module before and of the one after.
    before: [f64; 2],
    after: [f64; 2],
}

/// What a step needs, worked out once for all steps of a call.
#[derive(Clone, Copy)]
struct StepConstants {
    step: f64,
    per_step: f64,
    /// 1 − h α.
    retained: f64,
}

/// What a mass rubs on: v and the law of friction of its contact.
#[derive(Clone, Copy, PartialEq)]
struct Surface<L> {
    velocity: f64,
    law: L,
}

impl RingForwardIncrement {
    /// The integrator for this model, if its matrices have the pattern of a ring of modules.
    #[must_use]
    pub fn new(model: &LumpedModel) -> Option<Self> {
        let mass = model.mass.as_diagonal()?;
        let count = model.contacts.len();
        if count == 0 || model.dofs() != MODULE_DOFS * count || !model.dampers.is_empty() {
            return None;
        }
        let in_place = |(i, contact): (usize, &crate::model::Contact)| {
            contact.tangent.as_unit() == Some(MODULE_DOFS * i + TANGENT)
                && contact.normal.as_unit() == Some(MODULE_DOFS * i + NORMAL)
        };
        if !model.contacts.iter().enumerate().all(in_place) {
            return None;
        }
        let mut blocks: Vec<Block> = mass
            .chunks_exact(MODULE_DOFS)
            .map(|mass| Block {
                mass: [mass[0], mass[1], mass[2], mass[3]],
                inverse_mass: [1.0 / mass[0], 1.0 / mass[1], 1.0 / mass[2], 1.0 / mass[3]],
                own: [[0.0; MODULE_DOFS]; MODULE_DOFS],
                before: [0.0; 2],
                after: [0.0; 2],
            })
            .collect();
        for (row, column, value) in model.stiffness.entries() {
            let (i, r) = (row / MODULE_DOFS, row % MODULE_DOFS);
            let (j, c) = (column / MODULE_DOFS, column % MODULE_DOFS);
            let block = &mut blocks[i];
            if i == j {
                block.own[c][r] = value;
            } else if r == c && r < 2 && j == (i + 1) % count {
                block.after[r] = value;
            } else if r == c && r < 2 && i == (j + 1) % count {
                block.before[r] = value;
            } else if value != 0.0 {
                return None;
            }
        }
        let strained = vec![[0.0; MODULE_DOFS]; count];
        Some(Self { blocks, damping: model.damping, strained })
    }

    fn strain(&mut self, motion: &Motion) {
        let (x, _) = motion.displacement.as_chunks();
        let (v, _) = motion.velocity.as_chunks();
        for ((strained, x), v) in self.strained.iter_mut().zip(x).zip(v) {
            *strained = strain(x, v, self.damping.beta);
        }
    }

    /// Takes the steps under a law of friction, each contact on its surface.
    fn run<L: FrictionLaw + PartialEq>(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        (step, count): (f64, u64),
        surface: impl Fn(usize) -> Surface<L>,
    ) {
        let first = surface(0);
        if (0..self.blocks.len()).all(|i| surface(i) == first) {
            self.run_on(motion, drive, (step, count), |_| first);
        } else {
            self.run_on(motion, drive, (step, count), surface);
        }
    }

    /// Compiled once for a surface that is common to all and stays in registers, once for surfaces that
    /// are looked up.
    fn run_on<L: FrictionLaw>(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        (step, count): (f64, u64),
        surface: impl Fn(usize) -> Surface<L>,
    ) {
        let constants =
            StepConstants { step, per_step: 1.0 / step, retained: 1.0 - step * self.damping.alpha };
        self.strain(motion);
        let beta = self.damping.beta;
        // In slices of one length no index needs a check.
        let modules = self.blocks.len();
        let (blocks, w) = (&self.blocks[..], &mut self.strained[..modules]);
        let load = &drive.force.as_chunks().0[..modules];
        let x = &mut motion.displacement.as_chunks_mut().0[..modules];
        let v = &mut motion.velocity.as_chunks_mut().0[..modules];
        let contacts = &mut motion.contacts[..modules];
        let (mut changes, mut touch_downs) = (0, 0);
        for _ in 0..count {
            // Neighbours act with what they had before the step; these two are overwritten too early.
            let first = w[0];
            let mut before = w[modules - 1];
            for i in 0..modules {
                let own = w[i];
                let after = if i + 1 < modules { w[i + 1] } else { first };
                let force = blocks[i].force(&load[i], &own, &before, &after);
                let (moved, moving, state) = constants.step_module(
                    &blocks[i],
                    &force,
                    surface(i),
                    (x[i], v[i], contacts[i]),
                );
                (x[i], v[i], w[i]) = (moved, moving, strain(&moved, &moving, beta));
                before = own;
                if state != contacts[i] {
                    changes += 1;
                    touch_downs += u64::from(contacts[i] == ContactState::Detached);
                    contacts[i] = state;
                }
            }
        }
        motion.statistics.steps += count;
        motion.statistics.state_changes += changes;
        motion.statistics.touch_downs += touch_downs;
        // The Delassus matrix is diagonal: the first sweep over the contacts solves them.
        motion.statistics.sweeps += count;
        motion.statistics.most_sweeps = motion.statistics.most_sweeps.max(count.min(1));
    }
}

/// x + β ẋ of a module.
#[inline]
fn strain(x: &Vector, v: &Vector, beta: f64) -> Vector {
    std::array::from_fn(|dof| x[dof] + beta * v[dof])
}

impl Block {
    /// F − K (x + β ẋ), N: all but the mass-proportional damping and the contact.
    #[inline]
    fn force(&self, load: &Vector, own: &Vector, before: &Vector, after: &Vector) -> Vector {
        let mut force = [0.0; MODULE_DOFS];
        for r in 0..MODULE_DOFS {
            let upper = self.own[0][r] * own[0] + self.own[1][r] * own[1];
            let lower = self.own[2][r] * own[2] + self.own[3][r] * own[3];
            force[r] = load[r] - (upper + lower);
        }
        for r in 0..2 {
            force[r] -= self.before[r] * before[r] + self.after[r] * after[r];
        }
        force
    }
}

impl Integrator for RingForwardIncrement {
    fn advance(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        let modules = self.blocks.len();
        let velocities = &drive.slider_velocity[..modules];
        let frictions = &drive.friction[..modules];
        if frictions.iter().all(|friction| friction.static_ == friction.kinetic) {
            let law = |i: usize| Coulomb(frictions[i].kinetic);
            let surface = |i: usize| Surface { velocity: velocities[i], law: law(i) };
            self.run(motion, drive, (step, count), surface);
        } else {
            let surface = |i: usize| Surface { velocity: velocities[i], law: frictions[i] };
            self.run(motion, drive, (step, count), surface);
        }
        Ok(())
    }

    fn contact_forces(
        &mut self,
        motion: &Motion,
        drive: &Drive,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        self.strain(motion);
        let load = drive.force.as_chunks().0;
        let w = &self.strained;
        let last = w.len() - 1;
        for (i, out) in forces.iter_mut().enumerate() {
            let (tangent, normal) = (MODULE_DOFS * i + TANGENT, MODULE_DOFS * i + NORMAL);
            let before = if i == 0 { last } else { i - 1 };
            let after = if i == last { 0 } else { i + 1 };
            let force = self.blocks[i].force(&load[i], &w[i], &w[before], &w[after]);
            let damped = |place: usize, dof: usize| {
                let drag = self.damping.alpha * self.blocks[i].mass[place];
                force[place] - drag * motion.velocity[dof]
            };
            let slip = drive.slider_velocity[i] - motion.velocity[tangent];
            let pressing = -damped(NORMAL, normal);
            let open = motion.displacement[normal] > 0.0 || motion.velocity[normal] > 0.0;
            *out = if open || pressing < 0.0 {
                ContactForce::detached(slip)
            } else {
                let carried = self.blocks[i].mass[TANGENT] * drive.slider_acceleration[i];
                let holding = carried - damped(TANGENT, tangent);
                ContactForce::closed(drive.friction[i], pressing, slip, holding)
            };
        }
        Ok(())
    }

    fn set_damping(&mut self, damping: Damping) {
        self.damping = damping;
    }
}

impl StepConstants {
    /// One step of one module: its new position and velocity, and the state of its contact.
    #[inline]
    fn step_module<L: FrictionLaw>(
        &self,
        block: &Block,
        force: &Vector,
        surface: Surface<L>,
        (mut x, v, before): (Vector, Vector, ContactState),
    ) -> (Vector, Vector, ContactState) {
        let h = self.step;
        // Predictor, eq. (13), in velocities.
        let predicted =
            |dof: usize, force: f64| v[dof] * self.retained + h * (force * block.inverse_mass[dof]);
        let mut new = [predicted(0, force[0]), predicted(1, force[1]), 0.0, 0.0];
        // Multipliers, eq. (16), and corrector, eqs. (17), (18).
        let state = if let Some(normal_force) = self.normal_force(block, force, &x, &v) {
            let lag = surface.velocity - v[TANGENT] * self.retained;
            let holding = block.mass[TANGENT] * lag * self.per_step - force[TANGENT];
            let (friction, state) = surface.law.friction(holding, normal_force, before);
            new[TANGENT] = if state == ContactState::Stick {
                surface.velocity
            } else {
                predicted(TANGENT, force[TANGENT] + friction)
            };
            new[NORMAL] = (0.0 - x[NORMAL]) * self.per_step;
            x[NORMAL] = 0.0;
            state
        } else {
            new[TANGENT] = predicted(TANGENT, force[TANGENT]);
            new[NORMAL] = predicted(NORMAL, force[NORMAL]);
            x[NORMAL] += h * new[NORMAL];
            ContactState::Detached
        };
        for dof in 0..NORMAL {
            x[dof] += h * new[dof];
        }
        (x, new, state)
    }

    /// N of a contact that is closed at the end of this step, as seen from its beginning.
    #[inline]
    fn normal_force(&self, block: &Block, force: &Vector, x: &Vector, v: &Vector) -> Option<f64> {
        let (x, v, force) = (x[NORMAL], v[NORMAL], force[NORMAL]);
        if x == 0.0 && v == 0.0 {
            // At rest on the slider, which is the rule: all but the force is zero below.
            return (force <= 0.0).then_some(-force);
        }
        let h = self.step;
        let retained = v * self.retained;
        let closes = x + h * (retained + h * (force * block.inverse_mass[NORMAL])) <= 0.0;
        closes.then(|| {
            let impact = retained + x * self.per_step;
            (-(force + block.mass[NORMAL] * impact * self.per_step)).max(0.0)
        })
    }
}
