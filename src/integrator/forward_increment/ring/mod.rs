//! The scheme on a ring of modules: diagonal mass, one contact for each module, links to the neighbours.

mod step;

use crate::contact::{ContactForce, ContactLaw, ContactState, FrictionLaw, Law, LawVisitor};
use crate::integrator::Kernel;
use crate::integrator::{
    AppliedLoad, ConstrainedResponse, HeldStates, Inputs, Integrator, Motion, StepFailure,
};
use crate::model::ring::{MODULE_DOFS, NORMAL, TANGENT, has_contacts_in_place};
use crate::model::{Damping, LumpedModel};
use step::{Block, ModuleVector, Scheme, linked, set_effective};

/// Integrator of the forward increment Lagrange multiplier method for a ring of modules.
pub struct RingForwardIncrement {
    rings: Rings,
    kernel: StepLoop,
}

/// Takes `count` steps of length `step` (s) of a ring: the loop of [`Scheme`] that is compiled for what the ring has.
type StepLoop = fn(&mut Rings, &mut Motion, &Inputs, f64, u64);

/// A ring and the memory for its steps.
struct Rings {
    law: ContactLaw,
    blocks: Vec<Block>,
    damping: Damping,
    /// x + β ẋ, on which K acts for springs and dampers at once; one item for each module.
    effective: Vec<ModuleVector>,
}

/// The effects besides the law of friction that a kernel is chosen by.
struct KernelEffects {
    detachment: bool,
    damping: bool,
    links: bool,
}

impl LawVisitor for KernelEffects {
    type Output = StepLoop;

    fn under<L: FrictionLaw>(self) -> StepLoop {
        match (self.detachment, self.damping, self.links) {
            (true, true, true) => Rings::run::<L, true, true, true>,
            (true, true, false) => Rings::run::<L, true, true, false>,
            (true, false, true) => Rings::run::<L, true, false, true>,
            (true, false, false) => Rings::run::<L, true, false, false>,
            (false, true, true) => Rings::run::<L, false, true, true>,
            (false, true, false) => Rings::run::<L, false, true, false>,
            (false, false, true) => Rings::run::<L, false, false, true>,
            (false, false, false) => Rings::run::<L, false, false, false>,
        }
    }
}

/// The law of friction of a kernel.
struct Named;

impl LawVisitor for Named {
    type Output = String;

    fn under<L: FrictionLaw>(self) -> String {
        let path = std::any::type_name::<L>();
        let is_end = |c: char| !c.is_alphanumeric();
        let names = path.split(is_end).filter(|part| part.starts_with(char::is_uppercase));
        names.collect::<Vec<_>>().join(" ")
    }
}

/// All kernels of rings. Modules without links are a structure of their own.
pub(super) fn kernels() -> Vec<Kernel> {
    let mut all = Vec::new();
    let switches = [false, true];
    for law in Law::ALL {
        for sticking in switches {
            for (detachment, damping) in switches.map(|a| switches.map(|b| (a, b))).concat() {
                for structure in ["ring", "modules"] {
                    let name = law.apply(sticking, Named);
                    let opens = if detachment { "opens" } else { "held" };
                    let damps = if damping { "Rayleigh damping" } else { "no damping" };
                    let arithmetic = format!("{name}, {opens}, {damps}");
                    let listed = Kernel { structure, arithmetic };
                    // Laws that cannot stick are equal with and without sticking.
                    if !all.contains(&listed) {
                        all.push(listed);
                    }
                }
            }
        }
    }
    all
}

impl RingForwardIncrement {
    /// The integrator for this model, if its matrices have the pattern of a ring of modules.
    #[must_use]
    pub fn new(model: &LumpedModel) -> Option<Self> {
        let blocks = blocks(model)?;
        let effective = vec![[0.0; MODULE_DOFS]; blocks.len()];
        let rings = Rings { law: model.law, blocks, damping: model.damping, effective };
        Some(Self { kernel: rings.kernel(), rings })
    }
}

impl Rings {
    /// The kernel for the effects of this ring.
    fn kernel(&self) -> StepLoop {
        let has_link = |block: &Block| block.before != [0.0; 2] || block.after != [0.0; 2];
        let choice = KernelEffects {
            detachment: self.law.detachment,
            damping: self.damping != Damping::default(),
            links: self.blocks.iter().any(has_link),
        };
        self.law.friction.apply(self.law.sticking, choice)
    }

    /// Takes the steps under this law of friction with these effects.
    fn run<L: FrictionLaw, const DETACHMENT: bool, const DAMPING: bool, const LINKS: bool>(
        &mut self,
        motion: &mut Motion,
        inputs: &Inputs,
        step: f64,
        count: u64,
    ) {
        let scheme = Scheme::<L, DETACHMENT, DAMPING, LINKS>::new(step, self.damping);
        scheme.steps(&self.blocks, &mut self.effective, motion, inputs, count);
    }
}

/// The modules of a model whose matrices have the pattern of a ring of them, and whose contacts are all closed in the
/// reference position.
fn blocks(model: &LumpedModel) -> Option<Vec<Block>> {
    let mass = model.mass.as_diagonal()?;
    let count = model.contacts.len();
    let has_gaps = model.contacts.iter().any(|contact| contact.gap != 0.0);
    if !has_contacts_in_place(model) || has_gaps || !model.dampers.is_empty() {
        return None;
    }
    let mut blocks: Vec<Block> = mass
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
        inputs: &Inputs,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        (self.kernel)(&mut self.rings, motion, inputs, step, count);
        Ok(())
    }

    fn contact_forces(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        let rings = &mut self.rings;
        let load = inputs.force.as_chunks().0;
        set_effective(&mut rings.effective, motion, rings.damping.beta);
        let w = &rings.effective;
        let last = w.len() - 1;
        for (i, out) in forces.iter_mut().enumerate() {
            let (tangent, normal) = (MODULE_DOFS * i + TANGENT, MODULE_DOFS * i + NORMAL);
            let before = if i == 0 { last } else { i - 1 };
            let after = if i == last { 0 } else { i + 1 };
            let links = [linked(&w[before]), linked(&w[after])];
            let block = &rings.blocks[i];
            let force = block.force::<false, true>(&load[i], &w[i], links);
            let [tangent_mass, normal_mass] = block.mass;
            let damped = |place: usize, mass: f64, dof: usize| {
                force[place] - rings.damping.alpha * mass * motion.velocity[dof]
            };
            let surface = inputs.slider_velocity[i];
            // A mass that sticks follows its slider, also if its velocity has been set anew since the last step.
            let slip = match motion.contacts[i] {
                ContactState::Stick => 0.0,
                _ => surface - motion.velocity[tangent],
            };
            let pressing = -damped(NORMAL, normal_mass, normal);
            let open = motion.displacement[normal] > 0.0 || motion.velocity[normal] > 0.0;
            *out = if rings.law.detachment && (open || pressing < 0.0) {
                ContactForce::detached(slip)
            } else {
                let carried = tangent_mass * inputs.slider_acceleration[i];
                let holding = carried - damped(TANGENT, tangent_mass, tangent);
                rings.law.closed(inputs.friction[i], surface, pressing, slip, holding)
            };
        }
        Ok(())
    }

    fn respond(
        &mut self,
        held: HeldStates<'_>,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) -> Result<(), StepFailure> {
        let modules = self.rings.blocks.iter().zip(load.force.as_chunks::<MODULE_DOFS>().0);
        let found =
            response.forces.iter_mut().zip(response.acceleration.as_chunks_mut::<MODULE_DOFS>().0);
        for (i, ((block, force), (out, acceleration))) in modules.zip(found).enumerate() {
            let state = held.states[i];
            let [tangent_mass, _] = block.mass;
            let normal = if state == ContactState::Detached { 0.0 } else { 0.0 - force[NORMAL] };
            let tangential = match state {
                ContactState::Detached => 0.0,
                ContactState::Stick => tangent_mass * load.slider_acceleration[i] - force[TANGENT],
                ContactState::Slide | ContactState::ReverseSlide => held.slopes[i] * normal,
            };
            *out = [normal, tangential];
            let mut force = *force;
            force[NORMAL] += normal;
            force[TANGENT] += tangential;
            *acceleration = std::array::from_fn(|dof| force[dof] * block.inverse_mass[dof]);
        }
        Ok(())
    }

    fn set_damping(&mut self, damping: Damping) {
        let was_damped = self.rings.damping != Damping::default();
        self.rings.damping = damping;
        if was_damped != (damping != Damping::default()) {
            self.kernel = self.rings.kernel();
        }
    }
}
