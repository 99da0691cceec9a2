//! Forces of a large structure: sparse matrices by rows.

use super::{Damps, InternalForces, Vectors};
use crate::integrator::Motion;
use crate::integrator::dynamics::Dynamics;
use crate::model::{Damping, LumpedModel};
use std::mem::take;

/// K and D by rows, from the dynamics. The motion is not copied.
pub(super) struct Sparse<M> {
    mass: M,
    load: Vec<f64>,
    /// x + β ẋ, on which K acts for springs and dampers at once.
    strained: Vec<f64>,
    acceleration: Vec<f64>,
}

/// Operations of a structure with its mass matrix.
pub(super) trait MassMatrix: Send + 'static {
    const NAME: &'static str;

    fn new(model: &LumpedModel, dynamics: &Dynamics) -> Self;

    /// Calls `found` with each row of M ẋ.
    fn each_product(&self, dynamics: &Dynamics, v: &[f64], found: impl FnMut(usize, f64));

    /// Replaces the force f by M⁻¹ f.
    fn divide(&mut self, dynamics: &Dynamics, force: &mut [f64]);
}

/// A diagonal mass matrix with its inverse.
pub(super) struct DiagonalMass {
    mass: Vec<f64>,
    inverse: Vec<f64>,
}

pub(super) struct FullMass {
    force: Vec<f64>,
}

impl MassMatrix for DiagonalMass {
    const NAME: &'static str = "diagonal mass";

    fn new(model: &LumpedModel, dynamics: &Dynamics) -> Self {
        let [mass, inverse] = [&model.mass, &dynamics.inverse_mass]
            .map(|matrix| (0..matrix.rows()).map(|i| matrix.get(i, i)).collect());
        Self { mass, inverse }
    }

    #[inline(always)]
    fn each_product(&self, _: &Dynamics, v: &[f64], mut found: impl FnMut(usize, f64)) {
        for (row, (mass, v)) in self.mass.iter().zip(v).enumerate() {
            found(row, mass * v);
        }
    }

    #[inline(always)]
    fn divide(&mut self, _: &Dynamics, force: &mut [f64]) {
        for (force, inverse) in force.iter_mut().zip(&self.inverse) {
            *force *= inverse;
        }
    }
}

impl MassMatrix for FullMass {
    const NAME: &'static str = "full mass";

    fn new(model: &LumpedModel, _: &Dynamics) -> Self {
        Self { force: vec![0.0; model.dofs()] }
    }

    #[inline(always)]
    fn each_product(&self, dynamics: &Dynamics, v: &[f64], found: impl FnMut(usize, f64)) {
        dynamics.mass.each_product(v, found);
    }

    #[inline(always)]
    fn divide(&mut self, dynamics: &Dynamics, force: &mut [f64]) {
        self.force.copy_from_slice(force);
        dynamics.inverse_mass.each_product(&self.force, |row, driven| force[row] = driven);
    }
}

impl<M: MassMatrix> InternalForces for Sparse<M> {
    const NAME: &'static str = M::NAME;
    type Vector = Vec<f64>;

    fn new(model: &LumpedModel, dynamics: &Dynamics) -> Self {
        let zero = vec![0.0; model.dofs()];
        Self {
            mass: M::new(model, dynamics),
            load: zero.clone(),
            strained: zero.clone(),
            acceleration: zero,
        }
    }

    fn take(&mut self, motion: &mut Motion, load: &[f64]) -> Vectors<Vec<f64>> {
        for (kept, load) in self.load.iter_mut().zip(load) {
            *kept = load + 0.0;
        }
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
        let Damping { alpha, beta } = dynamics.damping;
        let Vectors { load, x, v, a } = vectors;
        let strained = if D::RAYLEIGH {
            for ((strained, x), v) in self.strained.iter_mut().zip(&*x).zip(&*v) {
                *strained = x + beta * v;
            }
            &self.strained
        } else {
            &*x
        };
        dynamics.stiffness.each_product(strained, |row, springs| a[row] = load[row] - springs);
        if D::RAYLEIGH {
            self.mass.each_product(dynamics, v, |row, momentum| a[row] -= alpha * momentum);
        }
        if D::DAMPERS {
            dynamics.dampers.each_product(v, |row, damped| a[row] -= damped);
        }
        self.mass.divide(dynamics, a);
    }
}
