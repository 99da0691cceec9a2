//! The equation of motion in given contact states, linearised at a state, and its motions as power series.
//!
//! ẏ = A₀ y has a constant matrix unless a sine drives the friction coefficient of a contact c that slips. Its friction
//! force is then s (µ + δµ) N: µ has its value at the beginning of the series, and s δµ = χ_c y is linear in the sines
//! among the places of y. The force χ_c y N is one more load of the equation with the constant µ. With a for the rate of
//! the state, and g for the normal forces, that a force of 1 N along the tangent causes, the powers of time satisfy
//!
//! ```text
//! (k + 1) y_{k+1} = A₀ y_k + Σ_c a_c q_{c,k},   N_{c,k} = F_c y_k + Σ_d g_{cd} q_{d,k},
//! q_{c,k} = Σ_{j=1..k} χ_c y_j N_{c,k−j}.
//! ```
//!
//! The fundamental matrix, of the derivatives by the state at the beginning, has the same equations, differentiated.
//!
//! The matrix and the rows of a [`Field`] are linearised: A = A₀ + Σ_c N_c a_c χ_c, and the rows of forces likewise. A y is
//! the rate at the state y of the field, and A δ the change of the rate with a small change δ of y. Where a linearised
//! function is not zero at y = 0, what it lacks is in the place of the number 1, which never changes.

use super::flow::Flow;
use super::matrix::{exponential, product, times};
use amontons::contact::ContactState;
use amontons::integrator::StepFailure;
use nalgebra::{DMatrix, DVector};
use std::rc::Rc;

/// Powers of a motion over a part in which A t has at most norm 1: 1/20! = 4e-19.
const POWERS: usize = 19;
/// Products of sines and normal forces have powers that fall less quickly: those of exp(e^(t/r) + t/r − 1) are below 2e-17
/// from the 20th on.
const PARTS_OF_PRODUCTS: f64 = 4.5;
/// Most parts of a motion: a correction that makes a segment this long leads nowhere.
const MOST_PARTS: u32 = 1_000_000;

/// The equation of motion in given contact states, linearised at a state.
pub struct Field {
    /// A of ẏ = A y.
    pub matrix: DMatrix<f64>,
    /// Rows of (N, T) of each contact, N: the forces are their products with y.
    pub forces: Vec<[DVector<f64>; 2]>,
    /// The contacts that slip while sines drive their friction coefficients; none: the field is the same at all states.
    pub(super) driven_slips: Vec<DrivenSlip>,
    /// Number of parts per second of time that power series take ([`Flow::parts_per_second`]), 1/s.
    pub(super) parts_per_second: f64,
}

/// A contact that slips while sines drive its friction coefficient.
pub(super) struct DrivenSlip {
    /// The contact.
    pub(super) contact: usize,
    /// The row χ of s δµ: zero at the state of the field.
    pub(super) change: DVector<f64>,
    /// The rate a of the state that a force of 1 N along the tangent causes.
    pub(super) rate: DVector<f64>,
    /// (N, T) of each contact that this force causes.
    pub(super) forces: Vec<[f64; 2]>,
}

/// A motion over a part of the time, as power series.
pub(super) struct Part {
    field: Rc<Field>,
    /// The powers of the state.
    pub(super) powers: Vec<DVector<f64>>,
    /// The powers of the normal forces of driven slips, N.
    normal: Vec<Vec<f64>>,
    /// Its duration, s.
    pub(super) duration: f64,
}

impl Field {
    /// Linearises the matrix A₀ and the rows with constant friction coefficients at the state `y`.
    pub(super) fn linearise_at(&mut self, y: &DVector<f64>) {
        let normal = |slip: &DrivenSlip| self.forces[slip.contact][0].dot(y);
        let normal: Vec<f64> = self.driven_slips.iter().map(normal).collect();
        for (slip, normal) in self.driven_slips.iter().zip(normal) {
            self.matrix.ger(normal, &slip.rate, &slip.change, 1.0);
            for (rows, forces) in self.forces.iter_mut().zip(&slip.forces) {
                for (row, force) in rows.iter_mut().zip(forces) {
                    row.axpy(normal * force, &slip.change, 1.0);
                }
            }
        }
    }

    /// The powers of the motion from a state on, and those of the normal forces N of the driven slips.
    fn powers(&self, y: &DVector<f64>) -> (Vec<DVector<f64>>, Vec<Vec<f64>>) {
        let mut powers = vec![y.clone()];
        let mut normal: Vec<Vec<f64>> = vec![Vec::new(); self.driven_slips.len()];
        let mut ahead = 0.0;
        for k in 0..POWERS {
            // The linearised matrix and rows have the terms with N_0, and at power 0 all changes are zero.
            let loads: Vec<f64> = (self.driven_slips.iter().zip(&normal))
                .map(|(slip, n)| (1..k).map(|j| slip.change.dot(&powers[j]) * n[k - j]).sum())
                .collect();
            for (n, c) in normal.iter_mut().zip(&self.driven_slips) {
                let caused = self.driven_slips.iter().zip(&loads);
                let caused: f64 = caused.map(|(d, q)| d.forces[c.contact][0] * q).sum();
                n.push(self.forces[c.contact][0].dot(&powers[k]) + caused);
            }
            let mut next = times(&self.matrix, &powers[k]);
            for (slip, force) in self.driven_slips.iter().zip(&loads) {
                next.axpy(*force, &slip.rate, 1.0);
            }
            ahead += 1.0;
            powers.push(next / ahead);
        }
        (powers, normal)
    }

    /// The powers of the fundamental matrix of a motion whose own powers are known.
    fn fundamental_powers(
        &self,
        powers: &[DVector<f64>],
        normal: &[Vec<f64>],
    ) -> Vec<DMatrix<f64>> {
        let size = self.matrix.nrows();
        let mut derivatives: Vec<DMatrix<f64>> = vec![DMatrix::identity(size, size)];
        let mut normal_by: Vec<Vec<DVector<f64>>> = vec![Vec::new(); self.driven_slips.len()];
        let mut changes_by: Vec<Vec<DVector<f64>>> = vec![Vec::new(); self.driven_slips.len()];
        let mut ahead = 0.0;
        for k in 0..POWERS {
            let now = &derivatives[k];
            let loads: Vec<DVector<f64>> = (0..self.driven_slips.len())
                .map(|c| {
                    let change = &self.driven_slips[c].change;
                    let mut sum = DVector::zeros(size);
                    for j in 0..k {
                        sum.axpy(normal[c][k - j], &changes_by[c][j], 1.0);
                        sum.axpy(change.dot(&powers[k - j]), &normal_by[c][j], 1.0);
                    }
                    sum
                })
                .collect();
            for (c, slip) in self.driven_slips.iter().enumerate() {
                let mut by = row_times(&self.forces[slip.contact][0], now);
                for (other, loads) in self.driven_slips.iter().zip(&loads) {
                    by.axpy(other.forces[slip.contact][0], loads, 1.0);
                }
                normal_by[c].push(by);
                changes_by[c].push(row_times(&slip.change, now));
            }
            let mut next = product(&self.matrix, now);
            for (slip, loads) in self.driven_slips.iter().zip(&loads) {
                next.ger(1.0, &slip.rate, loads, 1.0);
            }
            ahead += 1.0;
            derivatives.push(next / ahead);
        }
        derivatives
    }
}

/// A row times a matrix, summed from the first place on.
fn row_times(row: &DVector<f64>, matrix: &DMatrix<f64>) -> DVector<f64> {
    DVector::from_iterator(matrix.ncols(), matrix.column_iter().map(|column| row.dot(&column)))
}

/// The value of a power series.
fn sum<T>(powers: &[T], t: f64) -> T
where
    T: Clone + std::ops::MulAssign<f64> + for<'a> std::ops::AddAssign<&'a T>,
{
    let (last, others) = powers.split_last().expect("there is a power");
    others.iter().rev().fold(last.clone(), |mut sum, c| {
        sum *= t;
        sum += c;
        sum
    })
}

impl Flow {
    /// The fundamental matrix Φ of the motion over the time `t` (s) from the state `y` on in these contact states: the
    /// derivatives of the end by the state `y`, and Φ y is the state at the end. It is exp(A t) where no sine drives friction
    /// in slip.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found, or that the motion is too long.
    pub fn propagator(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
        t: f64,
    ) -> Result<DMatrix<f64>, StepFailure> {
        let field = self.field(states, y)?;
        if field.driven_slips.is_empty() {
            return Ok(exponential(&field.matrix, &self.units, t));
        }
        let one = 2 * self.dofs();
        let mut whole = DMatrix::identity(self.size(), self.size());
        self.each_part(states, y, t, |part| {
            let Part { field, powers, normal, duration } = part;
            let mut across = sum(&field.fundamental_powers(powers, normal), *duration);
            let lacks = sum(powers, *duration) - times(&across, &powers[0]);
            across.column_mut(one).axpy(1.0, &lacks, 1.0);
            whole = product(&across, &whole);
        })?;
        Ok(whole)
    }

    /// The state after the time `t` (s) in these contact states.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found, or that the motion is too long.
    pub fn propagate(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
        t: f64,
    ) -> Result<DVector<f64>, StepFailure> {
        self.each_part(states, y, t, |_| ())
    }

    /// Visits the motion from a state on over the time `t` (s), part by part, and returns the state at its end.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found, or that the motion is too long.
    pub(super) fn each_part(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
        t: f64,
        mut visit: impl FnMut(&Part),
    ) -> Result<DVector<f64>, StepFailure> {
        let count = |field: &Field, t: f64| {
            let parts = (field.parts_per_second * t.abs()).ceil().max(1.0);
            if parts > f64::from(MOST_PARTS) {
                return Err(StepFailure::TooManySeries { most: MOST_PARTS.into() });
            }
            Ok(parts)
        };
        let mut field = self.field(states, y)?;
        let (mut start, mut left) = (y.clone(), t);
        let mut parts = count(&field, left)?;
        let mut duration = left / parts;
        loop {
            let (powers, normal) = field.powers(&start);
            start = sum(&powers, duration);
            visit(&Part { field: Rc::clone(&field), powers, normal, duration });
            parts -= 1.0;
            if parts < 0.5 {
                return Ok(start);
            }
            if !field.driven_slips.is_empty() {
                left -= duration;
                field = self.field(states, &start)?;
                parts = count(&field, left)?;
                duration = left / parts;
            }
        }
    }

    /// Number of parts per second of time that power series in a field before it is linearised take, 1/s: the norm of A₀ or,
    /// where sines drive friction in slip, more by their share in the rates and by the reactions of normal forces.
    pub(super) fn parts_per_second(&self, field: &Field) -> f64 {
        let of_column = |j: usize| {
            let column = field.matrix.column(j);
            let sizes = column.iter().zip(&self.units).map(|(a, unit)| (a / unit).abs());
            sizes.sum::<f64>() * self.units[j]
        };
        let norm = (0..self.units.len()).map(of_column).fold(0.0, f64::max);
        if field.driven_slips.is_empty() {
            return norm;
        }
        let motion = 2 * self.dofs();
        let fastest = self.waves.iter().map(|wave| wave.pulsation).fold(0.0, f64::max);
        let of_slip = |slip: &DrivenSlip| {
            let amplitudes: f64 = slip.change.iter().skip(motion + 1).map(|c| c.abs()).sum();
            let rate = slip.rate.iter().zip(&self.units).map(|(a, unit)| (a / unit).abs());
            let row = field.forces[slip.contact][0].iter().zip(&self.units).take(motion);
            let normal = row.map(|(force, unit)| (force * unit).abs()).fold(0.0, f64::max);
            let reactions: f64 = slip.forces.iter().map(|[normal, _]| normal.abs()).sum();
            2.0 * amplitudes * (rate.sum::<f64>() * normal + reactions * fastest)
        };
        PARTS_OF_PRODUCTS * field.driven_slips.iter().map(of_slip).fold(norm, |sum, own| sum + own)
    }
}
