//! The scheme on a ring of modules: diagonal mass, one contact a module, links to the neighbours.

#[cfg(feature = "tools")]
pub(super) mod batch;
mod step;
#[cfg(feature = "tools")]
mod wide;

use crate::contact::{ContactForce, Coulomb, Friction, FrictionLaw};
use crate::integrator::{Drive, Integrator, Motion, StepFailure};
use crate::model::ring::MODULE_DOFS;
use crate::model::{Contact, Damping, LumpedModel};
use std::marker::PhantomData;
use step::{
    Block, Common, Fixed, Moving, NORMAL, StepConstants, Surface, Surfaces, TANGENT, Vector, linked,
};

/// Forward increment Lagrange multipliers on a ring of modules.
pub struct RingForwardIncrement {
    blocks: Vec<Block<f64>>,
    damping: Damping,
    /// x + β ẋ, on which K acts for springs and dampers at once.
    strained: Vec<Vector<f64>>,
}

/// Surfaces as the drive has them, with a law of this kind.
struct OfDrive<'a, L> {
    velocities: &'a [f64],
    frictions: &'a [Friction],
    law: PhantomData<L>,
}

impl<L: FrictionLaw + From<Friction>> Surfaces<f64> for OfDrive<'_, L> {
    type Law = L;

    #[inline(always)]
    fn of(&self, module: usize) -> Surface<f64, L> {
        Surface { velocity: self.velocities[module], law: L::from(self.frictions[module]) }
    }
}

impl RingForwardIncrement {
    /// The integrator for this model, if its matrices have the pattern of a ring of modules.
    #[must_use]
    pub fn new(model: &LumpedModel) -> Option<Self> {
        let blocks = blocks(model)?;
        let strained = vec![[0.0; MODULE_DOFS]; blocks.len()];
        Some(Self { blocks, damping: model.damping, strained })
    }

    fn strain(&mut self, motion: &Motion) {
        // As `step::strain`, number by number: of one step this is a good part.
        let moving = motion.displacement.iter().zip(&motion.velocity);
        for (strained, (x, v)) in self.strained.as_flattened_mut().iter_mut().zip(moving) {
            *strained = x + self.damping.beta * v;
        }
    }

    /// Takes the steps under a law of friction of this kind.
    fn run<L: FrictionLaw + From<Friction> + PartialEq>(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        (step, count): (f64, u64),
    ) {
        let modules = self.blocks.len();
        let surfaces = OfDrive {
            velocities: &drive.slider_velocity[..modules],
            frictions: &drive.friction[..modules],
            law: PhantomData::<L>,
        };
        let first = surfaces.of(0);
        // Compiled once for a surface that is common to all and stays in registers, once for surfaces that
        // are looked up.
        // Without a branch for each: a call may be for one step.
        let velocities =
            surfaces.velocities.iter().fold(true, |same, v| same & (*v == first.velocity));
        let laws =
            surfaces.frictions.iter().fold(true, |same, f| same & (L::from(*f) == first.law));
        if velocities & laws {
            self.run_on(motion, drive, (step, count), Common(first));
        } else {
            self.run_on(motion, drive, (step, count), surfaces);
        }
    }

    fn run_on(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        (step, count): (f64, u64),
        surfaces: impl Surfaces<f64>,
    ) {
        self.strain(motion);
        let Damping { alpha, beta } = self.damping;
        let constants =
            StepConstants { step, per_step: 1.0 / step, retained: 1.0 - step * alpha, beta };
        let load = drive.force.as_chunks().0;
        let fixed = Fixed { blocks: &self.blocks[..], load, surfaces };
        let mut moving = Moving {
            x: motion.displacement.as_chunks_mut().0,
            v: motion.velocity.as_chunks_mut().0,
            strained: &mut self.strained,
            contacts: &mut motion.contacts,
            statistics: std::slice::from_mut(&mut motion.statistics),
        };
        constants.steps(&fixed, &mut moving, count);
    }
}

/// The modules of a model whose matrices have the pattern of a ring of them.
fn blocks(model: &LumpedModel) -> Option<Vec<Block<f64>>> {
    let mass = model.mass.as_diagonal()?;
    let count = model.contacts.len();
    if count == 0 || model.dofs() != MODULE_DOFS * count || !model.dampers.is_empty() {
        return None;
    }
    let in_place = |(i, contact): (usize, &Contact)| {
        contact.tangent.as_unit() == Some(MODULE_DOFS * i + TANGENT)
            && contact.normal.as_unit() == Some(MODULE_DOFS * i + NORMAL)
    };
    if !model.contacts.iter().enumerate().all(in_place) {
        return None;
    }
    let mut blocks: Vec<Block<f64>> = mass
        .as_chunks::<MODULE_DOFS>()
        .0
        .iter()
        .map(|mass| Block {
            mass: [mass[TANGENT], mass[NORMAL]],
            inverse_mass: mass.map(|mass| 1.0 / mass),
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
    Some(blocks)
}

impl Integrator for RingForwardIncrement {
    fn advance(
        &mut self,
        motion: &mut Motion,
        drive: &Drive,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        let frictions = &drive.friction[..self.blocks.len()];
        if frictions.iter().fold(true, |equal, f| equal & (f.static_ == f.kinetic)) {
            self.run::<Coulomb>(motion, drive, (step, count));
        } else {
            self.run::<Friction>(motion, drive, (step, count));
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
            let links = [linked(&w[before]), linked(&w[after])];
            let force = self.blocks[i].force(&load[i], &w[i], false, links);
            let [tangent_mass, normal_mass] = self.blocks[i].mass;
            let damped = |place: usize, mass: f64, dof: usize| {
                force[place] - self.damping.alpha * mass * motion.velocity[dof]
            };
            let slip = drive.slider_velocity[i] - motion.velocity[tangent];
            let pressing = -damped(NORMAL, normal_mass, normal);
            let open = motion.displacement[normal] > 0.0 || motion.velocity[normal] > 0.0;
            *out = if open || pressing < 0.0 {
                ContactForce::detached(slip)
            } else {
                let carried = tangent_mass * drive.slider_acceleration[i];
                let holding = carried - damped(TANGENT, tangent_mass, tangent);
                ContactForce::closed(drive.friction[i], pressing, slip, holding)
            };
        }
        Ok(())
    }

    fn set_damping(&mut self, damping: Damping) {
        self.damping = damping;
    }
}
