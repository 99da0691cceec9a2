//! All undamped modes below a frequency, their bounds, and the count that shows that none is missing.

use super::bounds::{Bounded, bound, frequency};
use super::factor::{Factors, Pattern};
use super::lanczos::{Modes, Wanted, lowest};
use crate::random;
use crate::sparse::Sparse;
use amontons::Error;
use amontons_analysis::watch::Watch;
use faer::Mat;
use std::f64::consts::TAU;

/// The shift below all eigenvalues, as a part of the limit's frequency: free structures have modes at 0, where K itself has
/// no inverse.
const SHIFT: f64 = 0.1;
/// No eigenvalue is nearer to the limit than this part of it.
const CLEAR: f64 = 1e-6;
/// Rounding of the factors may move an eigenvalue near the limit by this part of that distance.
const MOVED: f64 = 0.1;
/// Trials of a limit.
const TRIALS: usize = 20;
/// Programs print 14 digits or more: the entries of K are rounded by this part, and so is an eigenvalue by this part of the
/// largest one.
const DIGITS: f64 = 1e-13;
/// Multiplications in the estimate of the largest eigenvalue, which they find within a few percent.
const MULTIPLICATIONS: usize = 30;

/// All modes below a limit.
pub struct Counted {
    /// The limit at which they were counted, 1/s²: that of the caller, or a little above.
    pub limit: f64,
    /// The number of eigenvalues below the limit, by the signs of the pivots of K − λM.
    pub count: usize,
    /// The modes.
    pub modes: Modes,
    /// The intervals of the modes.
    pub bounds: Vec<Bounded>,
    /// The rounding of an eigenvalue by the digits of the matrices, 1/s²: a smaller one cannot be told from 0.
    pub rounding: f64,
}

/// Finds all modes of K x = λ M x below a frequency in Hz.
///
/// # Errors
/// Returns an error if K has a negative eigenvalue or M one that is not positive, if the work has been ended, or if more than
/// `memory` bytes are needed.
pub fn below(
    stiffness: &Sparse,
    mass: &Sparse,
    limit: f64,
    memory: usize,
    watch: Watch<'_>,
) -> Result<Counted, Error> {
    let pattern = Pattern::new(&stiffness.sum(1.0, mass, 1.0), memory)?;
    let mass_pattern = Pattern::new(mass, memory)?;
    let mass_factors = Factors::new(&mass_pattern, mass);
    if mass_factors.negative() != Some(0) {
        return Err(Error::analysis(
            "the mass matrix is not positive definite: some motion has no kinetic energy, or a negative one; check that it is the \
             mass matrix, that its digits were not cut, and that its elements are integrated at enough points (CalculiX writes singular mass \
             matrices for C3D8R and C3D8I; C3D8, C3D10 and C3D20 have positive ones)",
        ));
    }
    let rounding = DIGITS * largest(stiffness, mass, &mass_factors);
    let (limit, count) = count(stiffness, mass, &pattern, (TAU * limit).powi(2), watch)?;
    let shift = -(SHIFT * SHIFT) * limit;
    let factors = Factors::new(&pattern, &stiffness.sum(1.0, mass, -shift));
    if factors.negative() != Some(0) {
        return Err(unstable("far below 0"));
    }
    let room = memory.saturating_sub(pattern.bytes()) / (3 * size_of::<f64>() * mass.rows().max(1));
    let wanted = Wanted { count, below: limit, room };
    let modes = lowest(stiffness, mass, &factors, shift, &wanted, watch)?;
    let bounds = bound(stiffness, mass, &mass_factors, &modes.values, modes.vectors.as_ref());
    match bounds.iter().find(|bounded| bounded.value + bounded.distance < -rounding) {
        Some(negative) => Err(unstable(&format!("ω² = {:.4e} 1/s²", negative.value))),
        None => Ok(Counted { limit, count, modes, bounds, rounding }),
    }
}

fn unstable(eigenvalue: &str) -> Error {
    Error::analysis(format!(
        "the stiffness matrix has a negative eigenvalue, {eigenvalue}: the structure falls away from its position; check the sign of \
         the matrix, and whether loads that buckle it are in it"
    ))
}

/// About the largest eigenvalue, by repeated multiplication.
fn largest(stiffness: &Sparse, mass: &Sparse, mass_factors: &Factors<'_>) -> f64 {
    let mut vector = random::block(1, stiffness.rows(), 1);
    let mut quotient = 0.0;
    for _ in 0..MULTIPLICATIONS {
        let mut next = stiffness.times(vector.as_ref());
        let inertia = mass.times(vector.as_ref());
        let product = |a: &Mat<f64>| (vector.transpose() * a)[(0, 0)];
        quotient = product(&next) / product(&inertia);
        mass_factors.solve(next.as_mut());
        let scale = next.norm_max();
        if !(scale.is_normal() && quotient.is_finite()) {
            break;
        }
        vector = next * faer::Scale(1.0 / scale);
    }
    quotient.abs()
}

/// The number of eigenvalues below a limit. It is counted a little below and a little above; if the numbers differ, the limit
/// is moved up, so that rounding cannot put an eigenvalue on the wrong side.
fn count(
    stiffness: &Sparse,
    mass: &Sparse,
    pattern: &Pattern,
    mut limit: f64,
    watch: Watch<'_>,
) -> Result<(f64, usize), Error> {
    for _ in 0..TRIALS {
        let mut counts = [None; 2];
        for (count, part) in counts.iter_mut().zip([1.0 - CLEAR, 1.0 + CLEAR]) {
            watch.check()?;
            let shifted = stiffness.sum(1.0, mass, -limit * part);
            let factors = Factors::new(pattern, &shifted);
            if moved(&shifted, mass, &factors) > MOVED * CLEAR * limit {
                return Err(Error::analysis(format!(
                    "the modes below {:.6} Hz cannot be counted: rounding moves eigenvalues there by more than a millionth; the \
                     stiffest parts are too stiff beside this frequency, so make rigid parts softer or ask for a higher frequency",
                    frequency(limit)
                )));
            }
            *count = factors.negative();
        }
        if let [Some(low), Some(high)] = counts
            && low == high
        {
            return Ok((limit, low));
        }
        limit *= 1.0 + 4.0 * CLEAR;
    }
    Err(Error::analysis(format!(
        "the modes below {:.6} Hz cannot be counted: there are modes too near to it; ask for another frequency",
        frequency(limit)
    )))
}

/// About how far the rounding of the factors of K − λM moves the eigenvalue nearest to λ, 1/s². The factors are exact ones of
/// K − λM + E; the solution of a right side shows E x, and x is mostly the vector of that eigenvalue.
fn moved(shifted: &Sparse, mass: &Sparse, factors: &Factors<'_>) -> f64 {
    let mut vector = random::block(2, shifted.rows(), 1);
    let mut moved = 0.0;
    for _ in 0..2 {
        let right = mass.times(vector.as_ref());
        let mut solved = right.clone();
        factors.solve(solved.as_mut());
        let scale = 1.0 / solved.norm_max();
        let rest = (shifted.times(solved.as_ref()) - right) * faer::Scale(scale);
        vector = solved * faer::Scale(scale);
        let energy = (vector.transpose() * mass.times(vector.as_ref()))[(0, 0)];
        moved = vector.norm_l2() * rest.norm_l2() / energy;
    }
    moved
}
