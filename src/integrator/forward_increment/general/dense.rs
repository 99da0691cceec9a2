//! Forces of a small structure: full matrices of a size known at compile time.

use super::{Damps, InternalForces, Vectors};
use crate::integrator::Motion;
use crate::integrator::dynamics::Dynamics;
use crate::model::{Damping, LumpedModel, SparseMatrix};
use std::array::from_fn;

/// K and D by columns and a diagonal M, of up to N degrees of freedom, padded with zeros. A motion stays in arrays over
/// all steps of a call.
pub(super) struct Dense<const N: usize> {
    stiffness: [[f64; N]; N],
    dampers: [[f64; N]; N],
    mass: [f64; N],
    inverse_mass: [f64; N],
}

impl<const N: usize> InternalForces for Dense<N> {
    const NAME: &'static str = match N {
        1 => "1 degree of freedom",
        2 => "2 degrees of freedom",
        4 => "3 to 4 degrees of freedom",
        8 => "5 to 8 degrees of freedom",
        _ => "9 to 16 degrees of freedom",
    };
    type Vector = [f64; N];

    fn new(model: &LumpedModel, dynamics: &Dynamics) -> Self {
        let diagonal = |matrix: &SparseMatrix| {
            padded(&matrix.as_diagonal().expect("only a diagonal mass matrix comes here"))
        };
        Self {
            stiffness: columns(&model.stiffness),
            dampers: columns(&model.dampers),
            mass: diagonal(&model.mass),
            inverse_mass: diagonal(&dynamics.inverse_mass),
        }
    }

    fn take(&mut self, motion: &mut Motion, load: &[f64]) -> Vectors<[f64; N]> {
        Vectors {
            load: padded(load).map(|force| force + 0.0),
            x: padded(&motion.displacement),
            v: padded(&motion.velocity),
            a: [0.0; N],
        }
    }

    fn give(&mut self, vectors: Vectors<[f64; N]>, motion: &mut Motion) {
        let dofs = motion.displacement.len();
        motion.displacement.copy_from_slice(&vectors.x[..dofs]);
        motion.velocity.copy_from_slice(&vectors.v[..dofs]);
    }

    #[inline(always)]
    fn accelerate<D: Damps>(&mut self, dynamics: &Dynamics, vectors: &mut Vectors<[f64; N]>) {
        let Damping { alpha, beta } = dynamics.damping;
        let Vectors { load, x, v, a } = vectors;
        let mut strained = *x;
        if D::RAYLEIGH {
            for (strained, v) in strained.iter_mut().zip(&*v) {
                *strained += beta * v;
            }
        }
        let springs = product(&self.stiffness, &strained);
        for ((a, load), springs) in a.iter_mut().zip(load).zip(springs) {
            *a = *load - springs;
        }
        if D::RAYLEIGH {
            for ((a, mass), v) in a.iter_mut().zip(&self.mass).zip(&*v) {
                *a -= alpha * (mass * v);
            }
        }
        if D::DAMPERS {
            let damped = product(&self.dampers, v);
            for (a, damped) in a.iter_mut().zip(damped) {
                *a -= damped;
            }
        }
        for (a, inverse) in a.iter_mut().zip(&self.inverse_mass) {
            *a *= inverse;
        }
    }
}

/// Pads a vector with zeros.
fn padded<const N: usize>(vector: &[f64]) -> [f64; N] {
    let mut padded = [0.0; N];
    padded[..vector.len()].copy_from_slice(vector);
    padded
}

/// The columns of a matrix. For N = 2, the diagonal and the off-diagonal entries: a vector is then multiplied as it is
/// and swapped, which takes fewer instructions than spreading each of its values. The order of two terms leaves no
/// trace.
fn columns<const N: usize>(matrix: &SparseMatrix) -> [[f64; N]; N] {
    let mut columns = [[0.0; N]; N];
    for (row, column, value) in matrix.entries() {
        let place = if N == 2 { row ^ column } else { column };
        columns[place][row] = value;
    }
    columns
}

/// The product of a matrix with a vector. Each row is summed by ascending columns, as for sparse matrices; a sum begins
/// with −0, since adding to +0 would be an operation.
#[inline(always)]
fn product<const N: usize>(columns: &[[f64; N]; N], vector: &[f64; N]) -> [f64; N] {
    if N == 2 {
        return from_fn(|row| columns[0][row] * vector[row] + columns[1][row] * vector[1 - row]);
    }
    let mut sums = [-0.0; N];
    for (column, factor) in columns.iter().zip(vector) {
        for (sum, value) in sums.iter_mut().zip(column) {
            *sum += value * factor;
        }
    }
    sums
}
