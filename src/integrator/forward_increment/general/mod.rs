//! The scheme on a model of any structure, as a family of kernels.
//!
//! A kernel is the loop over the steps of a call, compiled for one way of evaluating forces ([`InternalForces`]), one
//! kind of damping ([`Damps`]), and with contacts or without. It is chosen when the integrator is made or its damping
//! is replaced. The step tests no option, and the code of absent effects is compiled out.

mod contacts;
mod dense;
mod full;
mod sparse;

use crate::Error;
use crate::contact::ContactForce;
use crate::integrator::dynamics::Dynamics;
use crate::integrator::per_mass::PerMass;
use crate::integrator::{
    AppliedLoad, ConstrainedResponse, HeldStates, Inputs, Integrator, Kernel, Motion, StepFailure,
};
use crate::model::{Damping, LumpedModel};
use contacts::Contacts;
use dense::Dense;
use full::Full;
use sparse::{DiagonalMass, FullMass, Sparse};

/// A full matrix with more zeros than this for each other entry is slower than a sparse one, as measured on
/// chains of 1 to 16 degrees of freedom.
const ZEROS: usize = 5;

/// The faster one of the integrators [`dense`] and [`sparse`] for the model.
///
/// # Errors
/// Returns an error if the mass matrix is not positive definite.
pub(in crate::integrator) fn faster(model: &LumpedModel) -> Result<Box<dyn Integrator>, Error> {
    let size = model.dofs().next_power_of_two();
    if size * size <= (1 + ZEROS) * model.stiffness.entries().count()
        && let Some(dense) = dense(model)?
    {
        return Ok(dense);
    }
    sparse(model)
}

/// The scheme on sparse matrices: the cost of a step is proportional to the entries of K and D (and of M⁻¹, if it is
/// full), plus that of the contacts that share masses.
///
/// # Errors
/// Returns an error if the mass matrix is not positive definite.
pub fn sparse(model: &LumpedModel) -> Result<Box<dyn Integrator>, Error> {
    if model.mass.as_diagonal().is_some() {
        GeneralScheme::<Sparse<DiagonalMass>>::boxed(model)
    } else if PerMass::suits(model) {
        GeneralScheme::<Full>::boxed(model)
    } else {
        GeneralScheme::<Sparse<FullMass>>::boxed(model)
    }
}

/// The scheme on full matrices of a fixed size, for up to 16 degrees of freedom with a diagonal mass matrix; `None` for
/// others. Its results are the same doubles as those of [`sparse`].
///
/// # Errors
/// Returns an error if the mass matrix is not positive definite.
pub fn dense(model: &LumpedModel) -> Result<Option<Box<dyn Integrator>>, Error> {
    if model.mass.as_diagonal().is_none() {
        return Ok(None);
    }
    Ok(Some(match model.dofs() {
        0..=1 => GeneralScheme::<Dense<1>>::boxed(model)?,
        2 => GeneralScheme::<Dense<2>>::boxed(model)?,
        3..=4 => GeneralScheme::<Dense<4>>::boxed(model)?,
        5..=8 => GeneralScheme::<Dense<8>>::boxed(model)?,
        9..=16 => GeneralScheme::<Dense<16>>::boxed(model)?,
        _ => return Ok(None),
    }))
}

/// All kernels of [`sparse`] and [`dense`].
pub(super) fn kernels() -> Vec<Kernel> {
    [
        GeneralScheme::<Sparse<DiagonalMass>>::list("sparse"),
        GeneralScheme::<Sparse<FullMass>>::list("sparse"),
        GeneralScheme::<Full>::list("sparse"),
        GeneralScheme::<Dense<1>>::list("dense"),
        GeneralScheme::<Dense<2>>::list("dense"),
        GeneralScheme::<Dense<4>>::list("dense"),
        GeneralScheme::<Dense<8>>::list("dense"),
        GeneralScheme::<Dense<16>>::list("dense"),
    ]
    .concat()
}

/// Evaluation of the forces of a structure.
trait InternalForces: Send + Sized {
    /// Name that distinguishes the evaluation from others.
    const NAME: &'static str;
    /// Vector with one value for each degree of freedom, in the storage of the steps of a call.
    type Vector: AsRef<[f64]> + AsMut<[f64]>;

    /// The evaluation for this model.
    fn new(model: &LumpedModel, dynamics: &Dynamics) -> Self;

    /// Moves the motion into vectors for the steps of a call, under the outer forces `load` (N).
    fn take(&mut self, motion: &mut Motion, load: &[f64]) -> Vectors<Self::Vector>;

    /// Moves the vectors back into the motion.
    fn give(&mut self, vectors: Vectors<Self::Vector>, motion: &mut Motion);

    /// Writes the acceleration without contact forces, M⁻¹ (F − C ẋ − K x).
    fn accelerate<D: Damps>(&mut self, dynamics: &Dynamics, vectors: &mut Vectors<Self::Vector>);
}

/// The vectors on which the steps of a call work.
struct Vectors<V> {
    /// Force F, N. It has no negative zero, so no force has one: the number of zeros in the sum of a row of K then
    /// leaves no trace, not even in a sign.
    load: V,
    /// Displacement x, m.
    x: V,
    /// Velocity ẋ, m/s.
    v: V,
    /// Acceleration ẍ, m/s².
    a: V,
}

/// The kind of damping of a kernel.
trait Damps {
    /// `true` if C includes α M + β K.
    const RAYLEIGH: bool;
    /// `true` if C includes D.
    const DAMPERS: bool;
}

struct Undamped;
struct Rayleigh;
/// Discrete dampers besides Rayleigh damping.
struct SingleDampers;

impl Damps for Undamped {
    const RAYLEIGH: bool = false;
    const DAMPERS: bool = false;
}

impl Damps for Rayleigh {
    const RAYLEIGH: bool = true;
    const DAMPERS: bool = false;
}

impl Damps for SingleDampers {
    const RAYLEIGH: bool = true;
    const DAMPERS: bool = true;
}

/// Loop that takes `count` steps of length `step` (s).
type TimeLoop<S> = fn(
    &mut GeneralScheme<S>,
    &mut Motion,
    &Inputs,
    step: f64,
    count: u64,
) -> Result<(), StepFailure>;

/// The forward increment scheme on one structure.
struct GeneralScheme<S> {
    dynamics: Dynamics,
    contacts: Contacts,
    structure: S,
    run: TimeLoop<S>,
}

/// Names of the rows and columns of [`GeneralScheme::KERNELS`].
const DAMPINGS: [&str; 3] = ["no damping", "Rayleigh damping", "single dampers"];
const CONTACTS: [&str; 2] = ["no contacts", "contacts"];

impl<S: InternalForces + 'static> GeneralScheme<S> {
    const KERNELS: [[TimeLoop<S>; 2]; 3] = [
        [Self::run::<Undamped, false>, Self::run::<Undamped, true>],
        [Self::run::<Rayleigh, false>, Self::run::<Rayleigh, true>],
        [Self::run::<SingleDampers, false>, Self::run::<SingleDampers, true>],
    ];

    fn boxed(model: &LumpedModel) -> Result<Box<dyn Integrator>, Error> {
        let dynamics = Dynamics::new(model)?;
        let contacts = Contacts::new(&dynamics);
        let structure = S::new(model, &dynamics);
        let run = Self::kernel(&dynamics);
        Ok(Box::new(Self { dynamics, contacts, structure, run }))
    }

    /// The kernel for this dynamics.
    fn kernel(dynamics: &Dynamics) -> TimeLoop<S> {
        let Damping { alpha, beta } = dynamics.damping;
        let damping = match dynamics.dampers.is_empty() {
            true if alpha == 0.0 && beta == 0.0 => 0,
            true => 1,
            false => 2,
        };
        Self::KERNELS[damping][usize::from(!dynamics.contacts.is_empty())]
    }

    fn list(structure: &'static str) -> Vec<Kernel> {
        let row = |(row, damping): ([TimeLoop<S>; 2], &'static str)| {
            row.into_iter().zip(CONTACTS).map(move |(_, contacts)| Kernel {
                structure,
                arithmetic: format!("{}, {damping}, {contacts}", S::NAME),
            })
        };
        Self::KERNELS.into_iter().zip(DAMPINGS).flat_map(row).collect()
    }

    fn run<D: Damps, const IN_CONTACT: bool>(
        &mut self,
        motion: &mut Motion,
        inputs: &Inputs,
        h: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        let mut vectors = self.structure.take(motion, &inputs.force);
        let mut outcome = Ok(());
        for _ in 0..count {
            self.structure.accelerate::<D>(&self.dynamics, &mut vectors);
            let Vectors { x, v, a, .. } = &mut vectors;
            let (x, v, a) = (x.as_mut(), v.as_mut(), a.as_mut());
            if IN_CONTACT {
                let moving = (&mut *x, &mut *v, &mut *a);
                outcome = self.contacts.step(&mut self.dynamics, motion, moving, inputs, h);
                if outcome.is_err() {
                    break;
                }
            } else {
                for ((x, v), a) in x.iter_mut().zip(v).zip(a) {
                    *v += h * *a;
                    *x += h * *v;
                }
            }
        }
        if !IN_CONTACT {
            motion.statistics.steps += count;
        }
        self.structure.give(vectors, motion);
        outcome
    }
}

impl<S: InternalForces + 'static> Integrator for GeneralScheme<S> {
    fn advance(
        &mut self,
        motion: &mut Motion,
        inputs: &Inputs,
        step: f64,
        count: u64,
    ) -> Result<(), StepFailure> {
        (self.run)(self, motion, inputs, step, count)
    }

    fn contact_forces(
        &mut self,
        motion: &Motion,
        inputs: &Inputs,
        forces: &mut [ContactForce],
    ) -> Result<(), StepFailure> {
        self.dynamics.contact_forces(motion, inputs, forces)
    }

    fn respond(
        &mut self,
        held: HeldStates<'_>,
        load: AppliedLoad<'_>,
        response: &mut ConstrainedResponse,
    ) -> Result<(), StepFailure> {
        self.dynamics.respond(held, load, response)
    }

    fn multipliers(&self) -> Option<&[[f64; 2]]> {
        Some(&self.dynamics.problem.forces)
    }

    fn set_damping(&mut self, damping: Damping) {
        self.dynamics.damping = damping;
        self.run = Self::kernel(&self.dynamics);
    }
}
