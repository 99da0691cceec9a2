//! The modes of a contact state as a basis of its motions.

use crate::stability::{Modes, modes};
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::{Damping, Entry, LinearModel, LumpedModel, SparseMatrix};
use amontons::scene::{Method, Scene};
use nalgebra::{Complex, DMatrix, DVector};

/// Eigenvalues this near, in parts of themselves, are those of one mode that comes more than once.
const EQUAL: f64 = 1e-7;
/// A matrix of modes V is not used if an entry of V⁻¹ V differs from that of the identity by more than this.
const WORST: f64 = 1e-6;

/// The modes of one contact state as a basis of its motions.
pub(super) struct Basis {
    /// Coordinates that the contacts leave free from degrees of freedom, m × n.
    free: DMatrix<f64>,
    /// Divisor of velocities, the largest modulus of an eigenvalue, 1/s.
    pub(super) pace: f64,
    /// Coefficients of the modes from free coordinates and their velocities, 2m × 2m.
    inverse: DMatrix<Complex<f64>>,
    /// One mode of each conjugate pair; those of one eigenvalue together.
    pub(super) modes: Vec<Members>,
}

/// The modes of one eigenvalue.
pub(super) struct Members {
    /// λ of x ∝ exp(λ t), 1/s; of the paper's scheme from step to step.
    pub(super) eigenvalue: Complex<f64>,
    /// The row of the inverse and the shape of each mode.
    pub(super) members: Vec<(usize, Vec<Complex<f64>>)>,
}

/// The step of the paper's scheme, s; `None` of a scene that moves exactly.
pub(super) fn scheme_step(scene: &Scene) -> Option<f64> {
    (scene.method == Method::ForwardIncrement).then_some(scene.step)
}

/// The modes of the paper's scheme with this `step` (h, s), each with s in place of λ, where ẋ = s x in a mode.
///
/// A step ẋ′ = ẋ + h ẍ, x′ = x + h ẋ′ takes such a mode to x′ = x / (1 − h s). With M ẍ = −C ẋ − K x that is s² (M −
/// h C) + s (C − h K) + K = 0. The modes of the differential equation would differ by a part h |λ| from these, so
/// that each would show in the others.
fn modes_of_scheme(
    linear: LinearModel<'_>,
    states: &[ContactState],
    step: f64,
) -> Result<Modes, Error> {
    let model = linear.model();
    let Damping { alpha, beta } = model.damping;
    if !linear.has_single_damping_in(states) {
        // Shapes are those of M⁻¹ K.
        let mut found = modes(linear, states)?;
        for mode in found.oscillating.iter_mut().chain(&mut found.real) {
            let sigma = mode.stiffness_eigenvalue;
            let damping = sigma * beta + alpha;
            let (mass, damping) = (-damping * step + 1.0, damping - sigma * step);
            let root = (damping * damping - mass * sigma * 4.0).sqrt();
            let roots = [root, -root].map(|root| (root - damping) / (mass * 2.0));
            let apart = |s: &Complex<f64>| (s - mode.eigenvalue).norm();
            let nearest = roots.into_iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
            mode.eigenvalue = nearest.unwrap_or(mode.eigenvalue);
        }
        return Ok(found);
    }
    let times = |matrix: &SparseMatrix, factor: f64| {
        matrix.entries().map(move |(row, column, value)| (row, column, factor * value)).collect()
    };
    let sum = |parts: [Vec<Entry>; 3]| SparseMatrix::from_entries(model.dofs(), parts.concat());
    let LumpedModel { mass, stiffness, dampers, .. } = model;
    let stepped = LumpedModel {
        mass: sum([
            times(mass, 1.0 - step * alpha),
            times(stiffness, -step * beta),
            times(dampers, -step),
        ]),
        damping: Damping { alpha: 0.0, beta: 0.0 },
        dampers: sum([times(mass, alpha), times(stiffness, beta - step), times(dampers, 1.0)]),
        ..model.clone()
    };
    modes(linear.of_part(&stepped), states)
}

impl Basis {
    /// The basis of exact motion, or of the paper's scheme with a step (s). `None` where the modes do not span the
    /// motions, or are too nearly parallel to be told from each other.
    pub(super) fn of(
        model: LinearModel<'_>,
        states: &[ContactState],
        step: Option<f64>,
    ) -> Option<Self> {
        let reduced = model.reduced(states)?;
        let motions = reduced.motions;
        let free = (motions.transpose() * &motions).try_inverse()? * motions.transpose();
        let found = match step {
            Some(step) => modes_of_scheme(model, states, step),
            None => modes(model, states),
        }
        .ok()?;
        // The eigenvalue of the mode's amplitude over time.
        let eigenvalue = |s: Complex<f64>| match step {
            Some(step) => {
                let left: Complex<f64> = Complex::from(1.0) - s * step;
                let [size, turn] = [libm::hypot(left.re, left.im), libm::atan2(left.im, left.re)];
                -Complex::new(libm::log(size), turn) / step
            }
            None => s,
        };
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
            match all.iter_mut().find(|members| is_equal(members.eigenvalue, eigenvalue(lambda))) {
                Some(members) => members.members.push(member),
                None => {
                    all.push(Members { eigenvalue: eigenvalue(lambda), members: vec![member] });
                }
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
