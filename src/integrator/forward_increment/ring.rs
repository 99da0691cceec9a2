//! The scheme on a ring of modules: diagonal mass, one contact a module, links to the neighbours.

use crate::contact::{ContactForce, ContactState, coulomb};
use crate::integrator::{Drive, Integrator, Motion, StepFailure};
use crate::model::ring::MODULE_DOFS;
use crate::model::{Damping, LumpedModel};

/// Places of the tangential and the normal degree of freedom in a module.
const TANGENT: usize = 2;
const NORMAL: usize = 3;

/// Forward increment Lagrange multipliers on a ring of modules.
pub struct RingForwardIncrement {
    blocks: Vec<Block>,
    damping: Damping,
    /// x + β ẋ, on which K acts for springs and dampers at once.
    strained: Vec<[f64; MODULE_DOFS]>,
}

/// A module's rows of M and K.
#[derive(Clone, Copy, Debug)]
struct Block {
    mass: [f64; MODULE_DOFS],
    inverse_mass: [f64; MODULE_DOFS],
    /// Columns of the module's own block of K.
    own: [[f64; MODULE_DOFS]; MODULE_DOFS],
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
    slider_velocity: f64,
    friction: f64,
}

impl RingForwardIncrement {
    /// The integrator for this model, if its matrices have the pattern of a ring of modules.
    #[must_use]
    pub fn new(model: &LumpedModel) -> Option<Self> {
        let mass = model.mass.as_diagonal()?;
        let count = model.contacts.len();
        if count == 0 || model.dofs() != MODULE_DOFS * count {
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
        let (x, _) = motion.displacement.as_chunks::<MODULE_DOFS>();
        let (v, _) = motion.velocity.as_chunks::<MODULE_DOFS>();
        for ((strained, x), v) in self.strained.iter_mut().zip(x).zip(v) {
            for dof in 0..MODULE_DOFS {
                strained[dof] = x[dof] + self.damping.beta * v[dof];
            }
        }
    }

    /// F − K (x + β ẋ) of module `i`, N: all but the mass-proportional damping and the contact.
    #[inline]
    fn force(&self, i: usize, load: &[f64; MODULE_DOFS]) -> [f64; MODULE_DOFS] {
        let block = &self.blocks[i];
        let w = &self.strained[i];
        let last = self.strained.len() - 1;
        let before = &self.strained[if i == 0 { last } else { i - 1 }];
        let after = &self.strained[if i == last { 0 } else { i + 1 }];
        let mut force = [0.0; MODULE_DOFS];
        for r in 0..MODULE_DOFS {
            let upper = block.own[0][r] * w[0] + block.own[1][r] * w[1];
            let lower = block.own[2][r] * w[2] + block.own[3][r] * w[3];
            force[r] = load[r] - (upper + lower);
        }
        for r in 0..2 {
            force[r] -= block.before[r] * before[r] + block.after[r] * after[r];
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
        let constants = StepConstants {
            step,
            per_step: 1.0 / step,
            retained: 1.0 - step * self.damping.alpha,
            slider_velocity: drive.slider_velocity,
            friction: drive.friction_coefficient,
        };
        let (load, _) = drive.force.as_chunks::<MODULE_DOFS>();
        let (mut changes, mut touch_downs) = (0, 0);
        for _ in 0..count {
            self.strain(motion);
            let (x, _) = motion.displacement.as_chunks_mut::<MODULE_DOFS>();
            let (v, _) = motion.velocity.as_chunks_mut::<MODULE_DOFS>();
            for i in 0..self.blocks.len() {
                let force = self.force(i, &load[i]);
                let state = constants.step_module(&self.blocks[i], &force, &mut x[i], &mut v[i]);
                if state != motion.contacts[i] {
                    changes += 1;
                    touch_downs += u64::from(motion.contacts[i] == ContactState::Detached);
                    motion.contacts[i] = state;
                }
            }
        }
        motion.statistics.steps += count;
        motion.statistics.state_changes += changes;
        motion.statistics.touch_downs += touch_downs;
        // The Delassus matrix is diagonal: the first sweep over the contacts solves them.
        motion.statistics.sweeps += count;
        motion.statistics.most_sweeps = motion.statistics.most_sweeps.max(count.min(1));
        Ok(())
    }

    fn contact_forces(
        &mut self,
        motion: &Motion,
        drive: &Drive,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        self.strain(motion);
        let (load, _) = drive.force.as_chunks::<MODULE_DOFS>();
        for (i, out) in forces.iter_mut().enumerate() {
            let (tangent, normal) = (MODULE_DOFS * i + TANGENT, MODULE_DOFS * i + NORMAL);
            let force = self.force(i, &load[i]);
            let damped = |place: usize, dof: usize| {
                let drag = self.damping.alpha * self.blocks[i].mass[place];
                force[place] - drag * motion.velocity[dof]
            };
            let slip = drive.slider_velocity - motion.velocity[tangent];
            let pressing = -damped(NORMAL, normal);
            let open = motion.displacement[normal] > 0.0 || motion.velocity[normal] > 0.0;
            *out = if open || pressing < 0.0 {
                ContactForce::detached(slip)
            } else {
                let holding = -damped(TANGENT, tangent);
                ContactForce::closed(drive.friction_coefficient, pressing, slip, holding)
            };
        }
        Ok(())
    }

    fn set_damping(&mut self, damping: Damping) {
        self.damping = damping;
    }
}

impl StepConstants {
    /// One step of one module; returns the state that its contact was in.
    #[inline]
    fn step_module(
        &self,
        block: &Block,
        force: &[f64; MODULE_DOFS],
        x: &mut [f64; MODULE_DOFS],
        v: &mut [f64; MODULE_DOFS],
    ) -> ContactState {
        let h = self.step;
        // Predictor, eq. (13), in velocities.
        let mut new = [0.0; MODULE_DOFS];
        for dof in 0..MODULE_DOFS {
            new[dof] = v[dof] * self.retained + h * (force[dof] * block.inverse_mass[dof]);
        }
        // Multipliers, eq. (16), and corrector, eqs. (17), (18).
        let state = if x[NORMAL] + h * new[NORMAL] <= 0.0 {
            // With gap and normal velocity at zero this is exactly minus the force.
            let impact = v[NORMAL] * self.retained + x[NORMAL] * self.per_step;
            let mass = block.mass[NORMAL];
            let normal_force = (-(force[NORMAL] + mass * impact * self.per_step)).max(0.0);
            let lag = self.slider_velocity - v[TANGENT] * self.retained;
            let holding = block.mass[TANGENT] * lag * self.per_step - force[TANGENT];
            let (friction, state) = coulomb(holding, self.friction * normal_force);
            new[TANGENT] = if state == ContactState::Stick {
                self.slider_velocity
            } else {
                let pushed = force[TANGENT] + friction;
                v[TANGENT] * self.retained + h * (pushed * block.inverse_mass[TANGENT])
            };
            new[NORMAL] = (0.0 - x[NORMAL]) * self.per_step;
            x[NORMAL] = 0.0;
            state
        } else {
            x[NORMAL] += h * new[NORMAL];
            ContactState::Detached
        };
        for dof in 0..NORMAL {
            x[dof] += h * new[dof];
        }
        *v = new;
        state
    }
}
