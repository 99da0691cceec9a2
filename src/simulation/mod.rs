//! A model and its motion together: advance, read, write, save, restore.

pub mod catalogue;
mod clock;
mod fingerprint;
mod snapshot;
mod values;
#[cfg(feature = "tools")]
mod warning;

pub use catalogue::{Variable, variables};
pub use fingerprint::fingerprint;
pub use snapshot::Snapshot;
pub(crate) use snapshot::{from_bytes, to_bytes};
#[cfg(feature = "tools")]
pub use values::assign;
pub use values::{check_value, read_scene, write_scene};
#[cfg(feature = "tools")]
pub use warning::step_warning;

use crate::Error;
use crate::contact::{ContactForce, ContactState};
use crate::integrator::{self, Drive, Integrator, Motion, Statistics, StepFailure};
use crate::model::{Equilibrium, LumpedModel, ring};
use crate::scene::Scene;
use crate::stability::StepGuard;
use clock::Clock;
use serde::{Deserialize, Serialize};

/// Steps taken between two looks at whether the motion is still finite.
const CHUNK: u64 = 1 << 16;

/// A scene in motion.
pub struct Simulation {
    /// The values as they are now: inputs and tunable parameters may have changed since the start.
    scene: Scene,
    model: LumpedModel,
    guard: StepGuard,
    integrator: Box<dyn Integrator>,
    reference: Reference,
    motion: Motion,
    clock: Clock,
    drive: Drive,
    contact_forces: Vec<ContactForce>,
    /// What a change of values has made out of date.
    stale: Stale,
}

#[derive(Clone, Copy, Debug, Default)]
struct Stale {
    drive: bool,
    limit: bool,
    contact_forces: bool,
}

/// The position that displacements are measured from: the equilibrium at initialization, with the
/// load that made it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Reference {
    equilibrium: Equilibrium,
    load: Vec<f64>,
}

impl Simulation {
    /// A simulation of the scene, at `start_time` (s) and in its initial position.
    ///
    /// # Errors
    /// Impossible values, no equilibrium, or a step above the critical one.
    pub fn new(scene: Scene, start_time: f64) -> Result<Self, Error> {
        scene.check()?;
        let model = LumpedModel::from(&scene);
        let equilibrium = ring::equilibrium(&scene, &model)?;
        let reference = Reference { equilibrium, load: model.load.clone() };
        let motion = initial_motion(&scene);
        Self::assemble(scene, model, reference, motion, Clock::at(start_time))
    }

    fn assemble(
        scene: Scene,
        model: LumpedModel,
        reference: Reference,
        motion: Motion,
        clock: Clock,
    ) -> Result<Self, Error> {
        let mut guard = StepGuard::new(&model, scene.friction_coefficient, scene.step);
        guard.check(&model, scene.friction_coefficient)?;
        let integrator = integrator::choose(&model)?;
        let drive = Drive {
            force: vec![0.0; model.dofs()],
            slider_velocity: scene.slider.velocity,
            friction_coefficient: scene.friction_coefficient,
        };
        let contact_forces = vec![ContactForce::detached(0.0); model.contacts.len()];
        let stale = Stale { drive: true, limit: false, contact_forces: true };
        Ok(Self {
            scene,
            model,
            guard,
            integrator,
            reference,
            motion,
            clock,
            drive,
            contact_forces,
            stale,
        })
    }

    /// Present time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.clock.time()
    }

    /// Do two times (s) mean the same point of this run? Rounding errors of up to half an internal
    /// step are forgiven.
    #[must_use]
    pub fn same_time(&self, a: f64, b: f64) -> bool {
        Clock::same(a, b, self.scene.step)
    }

    /// The values as they are now.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What has been counted since the start.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.motion.statistics
    }

    /// The equilibrium that displacements are measured from.
    #[must_use]
    pub fn reference(&self) -> &Equilibrium {
        &self.reference.equilibrium
    }

    /// Moves on to time `target` (s), inputs held.
    ///
    /// # Errors
    /// A target in the past; a step that, with the values as they are now, is above the critical
    /// one; a step that fails, or leaves the range of numbers. Then the motion is not to be used.
    pub fn advance_to(&mut self, target: f64) -> Result<(), Error> {
        let leg = self.clock.way_to(target, self.scene.step).ok_or_else(|| {
            Error::step(format!("cannot go from {} s to {target} s", self.time()))
        })?;
        self.update_drive();
        self.check_limit()?;
        let mut left = leg.count;
        while left > 0 {
            let count = left.min(CHUNK);
            self.integrator
                .advance(&mut self.motion, &self.drive, leg.step, count)
                .map_err(|failure| self.failed(failure, target))?;
            self.check_finite(target)?;
            left -= count;
        }
        self.clock = leg.arrival;
        self.stale.contact_forces = true;
        Ok(())
    }

    /// State and forces of every contact, now.
    ///
    /// # Errors
    /// Contacts that are coupled in a way that has no solution.
    pub fn contact_forces(&mut self) -> Result<&[ContactForce], Error> {
        if self.stale.contact_forces {
            self.update_drive();
            self.integrator
                .contact_forces(&self.motion, &self.drive, &mut self.contact_forces)
                .map_err(|failure| self.failed(failure, self.time()))?;
            self.stale.contact_forces = false;
        }
        Ok(&self.contact_forces)
    }

    /// Brings drive and damping up to date. The drive is the load's change since the reference, the
    /// contact forces that balanced it, and the external forces; at the reference nothing but the
    /// contacts' part is left.
    fn update_drive(&mut self) {
        if !std::mem::replace(&mut self.stale.drive, false) {
            return;
        }
        ring::load(&self.scene, &mut self.model.load);
        let loads = self.model.load.iter().zip(&self.reference.load);
        let external = self.scene.modules.iter().flat_map(|module| module.force);
        let force = self.drive.force.iter_mut().zip(external);
        for ((force, external), (now, then)) in force.zip(loads) {
            *force = (now - then) + external;
        }
        let Equilibrium { normal_force, friction_force, .. } = &self.reference.equilibrium;
        let balanced = normal_force.iter().zip(friction_force);
        for (contact, (normal, friction)) in self.model.contacts.iter().zip(balanced) {
            contact.normal.add_to(&mut self.drive.force, -normal);
            contact.tangent.add_to(&mut self.drive.force, -friction);
        }
        self.drive.slider_velocity = self.scene.slider.velocity;
        self.drive.friction_coefficient = self.scene.friction_coefficient;
        self.model.damping = self.scene.damping;
        self.integrator.set_damping(self.scene.damping);
    }

    fn check_limit(&mut self) -> Result<(), Error> {
        if self.stale.limit {
            self.guard.check(&self.model, self.scene.friction_coefficient)?;
            self.stale.limit = false;
        }
        Ok(())
    }

    fn check_finite(&self, target: f64) -> Result<(), Error> {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if finite(&self.motion.displacement) && finite(&self.motion.velocity) {
            return Ok(());
        }
        Err(Error::step(format!(
            "between {} s and {target} s the motion left the range of numbers; \
             look for an input that is not finite, or a flutter that nothing bounds",
            self.time()
        )))
    }

    fn failed(&self, failure: StepFailure, target: f64) -> Error {
        let time = self.time();
        Error::step(match failure {
            StepFailure::NoConvergence { sweeps } => {
                format!(
                    "between {time} s and {target} s the contact forces did not converge in \
                     {sweeps} sweeps"
                )
            }
            StepFailure::Wedged { contact } => format!(
                "between {time} s and {target} s friction wedges contact[{}]: no contact force satisfies its law; \
                 lower friction.coefficient",
                contact + 1
            ),
        })
    }
}

fn initial_motion(scene: &Scene) -> Motion {
    let modules = scene.modules.iter();
    let contacts = modules.clone().map(|module| {
        let slip = scene.slider.velocity - module.velocity[2];
        if module.displacement[3] > 0.0 || module.velocity[3] > 0.0 {
            ContactState::Detached
        } else if slip > 0.0 {
            ContactState::Slide
        } else if slip < 0.0 {
            ContactState::ReverseSlide
        } else {
            ContactState::Stick
        }
    });
    Motion {
        contacts: contacts.collect(),
        displacement: modules.clone().flat_map(|module| module.displacement).collect(),
        velocity: modules.flat_map(|module| module.velocity).collect(),
        statistics: Statistics::default(),
    }
}
