//! The modes of a contact state as a basis of its motions.

use crate::contact::ContactState;
use crate::model::LumpedModel;
use crate::stability::modes;
use nalgebra::{Complex, DMatrix, DVector};

/// Eigenvalues this near, in parts of themselves, are those of one mode that comes more than once.
const EQUAL: f64 = 1e-7;
/// A matrix of modes that solves no better than this is not used.
const WORST: f64 = 1e-6;

/// The modes of one contact state as a basis of its motions.
pub(super) struct Basis {
    /// Coordinates that the contacts leave free from degrees of freedom, m × n.
    free: DMatrix<f64>,
    /// By what velocities are divided, the largest modulus of an eigenvalue, 1/s.
    pub(super) pace: f64,
    /// Coefficients of the modes from free coordinates and their velocities, 2m × 2m.
    inverse: DMatrix<Complex<f64>>,
    /// One of each conjugate pair; those of one eigenvalue together.
    pub(super) modes: Vec<Members>,
}

/// The modes of one eigenvalue.
pub(super) struct Members {
    pub(super) eigenvalue: Complex<f64>,
    /// Each its row of the inverse, and its shape.
    pub(super) members: Vec<(usize, Vec<Complex<f64>>)>,
}

impl Basis {
    /// `None` where the modes do not span the motions, or are too nearly parallel to be told from each other.
    pub(super) fn of(model: &LumpedModel, states: &[ContactState], friction: f64) -> Option<Self> {
        let reduced = model.reduced(states, friction)?;
        let motions = reduced.motions;
        let free = (motions.transpose() * &motions).try_inverse()? * motions.transpose();
        let found = modes(model, states, friction).ok()?;
        let pace = found.all().map(|mode| mode.eigenvalue.norm()).fold(0.0, f64::max);
        if !(pace > 0.0 && pace.is_finite()) {
            return None;
        }
        let size = free.nrows();
        let mut columns: Vec<DVector<Complex<f64>>> = Vec::new();
        let mut all: Vec<Members> = Vec::new();
        let is_equal = |a: Complex<f64>, b: Complex<f64>| (a - b).norm() <= EQUAL * a.norm();
        let in_free = |shape: &[Complex<f64>]| -> Vec<Complex<f64>> {
            (0..size)
                .map(|row| shape.iter().zip(free.row(row).iter()).map(|(x, f)| x * *f).sum())
                .collect()
        };
        let mut last_real: Option<(Complex<f64>, Vec<Complex<f64>>)> = None;
        for mode in found.all() {
            let (lambda, u) = (mode.eigenvalue, in_free(&mode.shape));
            let column = |factor: [Complex<f64>; 2], u: &[Complex<f64>]| {
                DVector::from_fn(2 * size, |row, _| factor[row / size] * u[row % size])
            };
            let is_real = lambda.im.abs() <= 1e-9 * lambda.norm();
            // A motion that no spring holds, or one at the border of oscillation: the same vector twice.
            let is_double = is_real
                && last_real.as_ref().is_some_and(|(other, v)| {
                    is_equal(lambda, *other)
                        && u.iter().zip(v).all(|(a, b)| (a - b).norm() <= EQUAL)
                });
            if is_double {
                columns.push(column([Complex::ZERO, Complex::ONE], &u));
                continue;
            }
            if is_real {
                last_real = Some((lambda, u.clone()));
            }
            let place = columns.len();
            columns.push(column([Complex::ONE, lambda / pace], &u));
            if !is_real {
                columns.push(columns[place].map(|value| value.conj()));
            }
            let member = (place, mode.shape.clone());
            match all.iter_mut().find(|members| is_equal(members.eigenvalue, lambda)) {
                Some(members) => members.members.push(member),
                None => all.push(Members { eigenvalue: lambda, members: vec![member] }),
            }
        }
        if columns.len() != 2 * size {
            return None;
        }
        let norms: Vec<f64> = columns.iter().map(|column| column.norm()).collect();
        let columns: Vec<_> = columns
            .into_iter()
            .zip(&norms)
            .map(|(column, norm)| column / Complex::from(*norm))
            .collect();
        let matrix = DMatrix::from_columns(&columns);
        let mut inverse = matrix.clone().try_inverse()?;
        let rest = &inverse * matrix - DMatrix::identity(2 * size, 2 * size);
        if !rest.iter().all(|value| value.norm() < WORST) {
            return None;
        }
        for (row, norm) in norms.iter().enumerate() {
            inverse.row_mut(row).iter_mut().for_each(|value| *value /= *norm);
        }
        Some(Self { free, pace, inverse, modes: all })
    }

    /// The coefficients of all modes, in the order of the inverse's rows.
    pub(super) fn coefficients(&self, kept: &[f64]) -> DVector<Complex<f64>> {
        let (displacement, velocity) = kept.split_at(kept.len() / 2);
        let [u, v] = [displacement, velocity].map(|x| &self.free * DVector::from_column_slice(x));
        let size = u.len();
        let state = DVector::from_fn(2 * size, |row, _| {
            Complex::from(if row < size { u[row] } else { v[row - size] / self.pace })
        });
        &self.inverse * state
    }
}
