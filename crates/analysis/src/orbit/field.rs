//! The equation of motion in given contact states, and its motions as power series.
//!
//! ẏ = A y has a constant matrix unless a sine drives the friction coefficient of a contact c that slips. Its friction
//! force is then s (µ + δµ) N: µ has its value at the beginning of the series, and δµ is linear in the sines among the
//! places of y. The force s δµ N is one more load of the equation of the constant µ, with
//!
//! ```text
//! (k + 1) y_{k+1} = A y_k + Σ_c p_c q_{c,k},   N_{c,k} = F_c y_k + Σ_d g_{cd} q_{d,k},
//! q_{c,k} = s_c Σ_{j=1..k} δµ_{c,j} N_{c,k−j}
//! ```
//!
//! for the powers of time; p_c and g_cd are the rates and the normal forces that a force of 1 N along the tangent of c
//! causes. Derivatives by the state at the beginning follow the same equations, differentiated.
//!
//! A function f of the state is represented near y by the row h for which h y = f(y) and h δ is its change: what the
//! derivative lacks is in the place of the number 1, which never changes. Matrices likewise.

use super::flow::Flow;
use super::matrix::{exponential, product, times};
use amontons::contact::ContactState;
use amontons::integrator::StepFailure;
use nalgebra::{DMatrix, DVector};

/// Powers of a motion over a part in which A t has at most norm 1: 1/20! = 4e-19.
const POWERS: usize = 19;
/// Products of sines and normal forces have powers that fall less quickly: those of exp(e^(t/4) + t/4 − 1) are below
/// 2e-17 from the 20th on.
const PARTS_OF_PRODUCTS: f64 = 4.0;

/// The equation of motion in given contact states at an instant, as matrix and rows near a state.
pub struct Field {
    /// A of ẏ = A y.
    pub matrix: DMatrix<f64>,
    /// Rows of (N, T) of each contact, N: the forces are their products with y.
    pub forces: Vec<[DVector<f64>; 2]>,
    /// The contacts that slip while sines drive their friction coefficients; none: the field is the same everywhere.
    pub(super) rubbing: Vec<Rubbing>,
}

/// A contact that slips while sines drive its friction coefficient.
pub(super) struct Rubbing {
    /// The contact.
    pub(super) contact: usize,
    /// The row of s δµ: zero at the state of the field.
    pub(super) change: DVector<f64>,
    /// The rate of the state that a force of 1 N along the tangent causes.
    pub(super) push: DVector<f64>,
    /// (N, T) of each contact that this force causes.
    pub(super) forces: Vec<[f64; 2]>,
}

impl Field {
    /// Adds the changes of friction forces with the places of time, each with the normal force at the state `y`, to the
    /// matrix and the rows.
    pub(super) fn rub(&mut self, y: &DVector<f64>) {
        let normal = |rubbing: &Rubbing| self.forces[rubbing.contact][0].dot(y);
        let normal: Vec<f64> = self.rubbing.iter().map(normal).collect();
        for (rubbing, normal) in self.rubbing.iter().zip(normal) {
            self.matrix.ger(normal, &rubbing.push, &rubbing.change, 1.0);
            for (rows, forces) in self.forces.iter_mut().zip(&rubbing.forces) {
                for (row, force) in rows.iter_mut().zip(forces) {
                    row.axpy(normal * force, &rubbing.change, 1.0);
                }
            }
        }
    }

    /// The powers of the motion from a state on, and those of the normal forces N of the contacts that rub.
    fn powers(&self, y: &DVector<f64>) -> (Vec<DVector<f64>>, Vec<Vec<f64>>) {
        let mut powers = vec![y.clone()];
        let mut normal: Vec<Vec<f64>> = vec![Vec::new(); self.rubbing.len()];
        let mut ahead = 0.0;
        for k in 0..POWERS {
            // The matrix and the rows have the parts of power 0 of one factor.
            let rubbed: Vec<f64> = (self.rubbing.iter().zip(&normal))
                .map(|(rubbing, n)| (1..k).map(|j| rubbing.change.dot(&powers[j]) * n[k - j]).sum())
                .collect();
            for (n, c) in normal.iter_mut().zip(&self.rubbing) {
                let caused = self.rubbing.iter().zip(&rubbed);
                let caused: f64 = caused.map(|(d, q)| d.forces[c.contact][0] * q).sum();
                n.push(self.forces[c.contact][0].dot(&powers[k]) + caused);
            }
            let mut next = times(&self.matrix, &powers[k]);
            for (rubbing, force) in self.rubbing.iter().zip(&rubbed) {
                next.axpy(*force, &rubbing.push, 1.0);
            }
            ahead += 1.0;
            powers.push(next / ahead);
        }
        (powers, normal)
    }

    /// The powers of the derivatives of the motion by the state at its beginning, whose own powers are known.
    fn derivative_powers(&self, powers: &[DVector<f64>], normal: &[Vec<f64>]) -> Vec<DMatrix<f64>> {
        let size = self.matrix.nrows();
        let mut derivatives: Vec<DMatrix<f64>> = vec![DMatrix::identity(size, size)];
        let mut normal_by: Vec<Vec<DVector<f64>>> = vec![Vec::new(); self.rubbing.len()];
        let mut changes_by: Vec<Vec<DVector<f64>>> = vec![Vec::new(); self.rubbing.len()];
        let mut ahead = 0.0;
        for k in 0..POWERS {
            let now = &derivatives[k];
            let rubbed: Vec<DVector<f64>> = (0..self.rubbing.len())
                .map(|c| {
                    let change = &self.rubbing[c].change;
                    let mut sum = DVector::zeros(size);
                    for j in 0..k {
                        sum.axpy(normal[c][k - j], &changes_by[c][j], 1.0);
                        sum.axpy(change.dot(&powers[k - j]), &normal_by[c][j], 1.0);
                    }
                    sum
                })
                .collect();
            for (c, rubbing) in self.rubbing.iter().enumerate() {
                let mut by = row_times(&self.forces[rubbing.contact][0], now);
                for (other, rubbed) in self.rubbing.iter().zip(&rubbed) {
                    by.axpy(other.forces[rubbing.contact][0], rubbed, 1.0);
                }
                normal_by[c].push(by);
                changes_by[c].push(row_times(&rubbing.change, now));
            }
            let mut next = product(&self.matrix, now);
            for (rubbing, rubbed) in self.rubbing.iter().zip(&rubbed) {
                next.ger(1.0, &rubbing.push, rubbed, 1.0);
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
    /// The derivative of the motion over the time `t` (s) by the state `y` at its beginning, in these contact states: the
    /// matrix Φ near `y`, with Φ y the state at the end. It is exp(A t) where no sine drives friction in slip.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    pub fn propagator(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
        t: f64,
    ) -> Result<DMatrix<f64>, StepFailure> {
        let field = self.field(states, y)?;
        if field.rubbing.is_empty() {
            return Ok(exponential(&field.matrix, &self.units, t));
        }
        let one = 2 * self.dofs();
        let mut whole = DMatrix::identity(self.size(), self.size());
        for (powers, part) in self.powers(states, y, t)? {
            let start = &powers[0];
            let field = self.field(states, start)?;
            let (powers, normal) = field.powers(start);
            let mut across = sum(&field.derivative_powers(&powers, &normal), part);
            let left = sum(&powers, part) - times(&across, &powers[0]);
            across.column_mut(one).axpy(1.0, &left, 1.0);
            whole = product(&across, &whole);
        }
        Ok(whole)
    }

    /// The state after the time `t` (s) in these contact states.
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    pub fn propagate(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
        t: f64,
    ) -> Result<DVector<f64>, StepFailure> {
        let parts = self.powers(states, y, t)?;
        let (powers, part) = parts.last().expect("there is at least one part");
        Ok(sum(powers, *part))
    }

    /// The motion from a state on over the time `t` (s), as power series in the time since the beginning of each of its
    /// parts, with the parts' lengths (s).
    ///
    /// # Errors
    /// Returns the contact whose forces were not found.
    #[allow(clippy::type_complexity)]
    pub(super) fn powers(
        &mut self,
        states: &[ContactState],
        y: &DVector<f64>,
        t: f64,
    ) -> Result<Vec<(Vec<DVector<f64>>, f64)>, StepFailure> {
        let mut parts = Vec::new();
        let (mut start, mut left) = (y.clone(), t);
        loop {
            let field = self.field(states, &start)?;
            let of_column = |j: usize| {
                let column = field.matrix.column(j);
                let sizes = column.iter().zip(&self.units).map(|(a, unit)| (a / unit).abs());
                sizes.sum::<f64>() * self.units[j]
            };
            let norm = (0..self.units.len()).map(of_column).fold(0.0, f64::max);
            let more = if field.rubbing.is_empty() { 1.0 } else { PARTS_OF_PRODUCTS };
            let count = (more * norm * left.abs()).ceil().max(1.0);
            let part = left / count;
            let powers = field.powers(&start).0;
            start = sum(&powers, part);
            left -= part;
            parts.push((powers, part));
            if count <= 1.0 {
                return Ok(parts);
            }
        }
    }
}
