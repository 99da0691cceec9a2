//! Accelerations of a structure whose mass and stiffness matrices are full.

use super::{Damps, InternalForces, Vectors};
use crate::integrator::Motion;
use crate::integrator::dynamics::Dynamics;
use crate::integrator::per_mass::Strain;
use crate::model::LumpedModel;
use std::mem::take;

/// The products of [`PerMass`](crate::integrator::per_mass::PerMass), and M⁻¹ F of the load that acted last.
pub(super) struct Full {
    load: Vec<f64>,
    /// The load to which `driven` belongs, N, and its accelerations, m/s².
    known: Vec<f64>,
    driven: Vec<f64>,
    /// x + β ẋ, m.
    strained: Vec<f64>,
    acceleration: Vec<f64>,
}

impl InternalForces for Full {
    const NAME: &'static str = "full mass and stiffness";
    type Vector = Vec<f64>;

    fn new(model: &LumpedModel, _: &Dynamics) -> Self {
        let zero = vec![0.0; model.dofs()];
        Self {
            load: zero.clone(),
            known: zero.clone(),
            driven: zero.clone(),
            strained: zero.clone(),
            acceleration: zero,
        }
    }

    fn take(&mut self, motion: &mut Motion, load: &[f64]) -> Vectors<Vec<f64>> {
        self.load.copy_from_slice(load);
        Vectors {
            load: take(&mut self.load),
            x: take(&mut motion.displacement),
            v: take(&mut motion.velocity),
            a: take(&mut self.acceleration),
        }
    }

    fn give(&mut self, vectors: Vectors<Vec<f64>>, motion: &mut Motion) {
        let Vectors { load, x, v, a } = vectors;
        (self.load, self.acceleration) = (load, a);
        (motion.displacement, motion.velocity) = (x, v);
    }

    #[inline(always)]
    fn accelerate<D: Damps>(&mut self, dynamics: &Dynamics, vectors: &mut Vectors<Vec<f64>>) {
        let Vectors { load, x, v, a } = vectors;
        if self.known != *load {
            self.known.copy_from_slice(load);
            let driven = &mut self.driven;
            dynamics.inverse_mass.each_product(load, |dof, value| driven[dof] = value);
        }
        a.copy_from_slice(&self.driven);
        for ((strained, x), v) in self.strained.iter_mut().zip(&*x).zip(&*v) {
            *strained = x + dynamics.damping.beta * v;
        }
        if let Some(per_mass) = &dynamics.per_mass {
            let alpha = dynamics.damping.alpha;
            per_mass.subtract(Strain { stretch: &self.strained, velocity: v, alpha }, a);
        }
    }
}
