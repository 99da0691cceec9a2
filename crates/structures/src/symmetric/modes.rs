//! All undamped modes below a frequency, and the count that shows that none is missing.

use super::bounds::{Bounded, bound, frequency};
use super::factor::{Factors, Pattern};
use super::lanczos::{Modes, lowest};
use crate::sparse::Sparse;
use amontons::Error;
use amontons_analysis::watch::Watch;
use std::f64::consts::TAU;

/// The shift below all eigenvalues, as a part of the limit's frequency: free structures have modes at 0, where K itself has
/// no inverse.
const SHIFT: f64 = 0.1;
/// No eigenvalue is nearer to the limit than this part of it.
const CLEAR: f64 = 1e-6;
/// Trials of a limit.
const TRIALS: usize = 50;

/// All modes below a limit.
pub struct Counted {
    /// The limit at which they were counted, 1/s²: that of the caller, or a little above.
    pub limit: f64,
    /// The number of eigenvalues below the limit, by the signs of the pivots of K − λM.
    pub count: usize,
    /// The modes.
    pub modes: Modes,
}

/// Finds all modes of K x = λ M x below a frequency in Hz.
///
/// # Errors
/// Returns an error if an eigenvalue is negative, if the work has been ended, or if more than `memory` bytes are needed.
pub fn below(
    stiffness: &Sparse,
    mass: &Sparse,
    limit: f64,
    memory: usize,
    watch: Watch<'_>,
) -> Result<Counted, Error> {
    let pattern = Pattern::new(&stiffness.sum(1.0, mass, 1.0), memory)?;
    let (limit, count) = count(stiffness, mass, &pattern, (TAU * limit).powi(2))?;
    let needed = pattern.bytes() + 4 * count * mass.rows() * size_of::<f64>();
    if needed > memory {
        return Err(Error::analysis(format!(
            "{count} modes below {} Hz need about {:.1} GB of memory; allow more with --memory, or ask for a lower frequency",
            frequency(limit),
            needed as f64 * 1e-9
        )));
    }
    watch.check()?;
    let shift = -(SHIFT * SHIFT) * limit;
    let factors = Factors::new(&pattern, &stiffness.sum(1.0, mass, -shift));
    match factors.negative() {
        Some(0) => {}
        Some(negative) => {
            return Err(Error::analysis(format!(
                "the stiffness matrix has {negative} negative eigenvalues, so the structure is not at rest; check the sign of the \
                 matrix, and whether loads were applied that buckle it"
            )));
        }
        None => {
            return Err(Error::analysis(
                "the stiffness matrix cannot be factored: a pivot is zero or not finite",
            ));
        }
    }
    let modes = lowest(stiffness, mass, &factors, shift, count, limit, watch)?;
    Ok(Counted { limit, count, modes })
}

/// The number of eigenvalues below a limit. It is counted a little below and a little above; if the numbers differ, the limit
/// is moved up, so that rounding cannot put an eigenvalue on the wrong side.
fn count(
    stiffness: &Sparse,
    mass: &Sparse,
    pattern: &Pattern,
    mut limit: f64,
) -> Result<(f64, usize), Error> {
    let below = |limit: f64| Factors::new(pattern, &stiffness.sum(1.0, mass, -limit)).negative();
    for _ in 0..TRIALS {
        let [low, high] = [below(limit * (1.0 - CLEAR)), below(limit * (1.0 + CLEAR))];
        if let (Some(low), Some(high)) = (low, high)
            && low == high
        {
            return Ok((limit, low));
        }
        limit *= 1.0 + 4.0 * CLEAR;
    }
    Err(Error::analysis(format!(
        "the modes below {} Hz cannot be counted: there are modes too near to it; ask for another frequency",
        frequency(limit)
    )))
}

/// The intervals of all modes found.
///
/// # Errors
/// Returns an error if the mass matrix is not positive definite, or needs more than `memory` bytes.
pub fn bounded(
    stiffness: &Sparse,
    mass: &Sparse,
    modes: &Modes,
    memory: usize,
) -> Result<Vec<Bounded>, Error> {
    let pattern = Pattern::new(mass, memory)?;
    let factors = Factors::new(&pattern, mass);
    if factors.negative() != Some(0) {
        return Err(Error::analysis(
            "the mass matrix is not positive definite: some motion has no kinetic energy, or a negative one; check that it is the \
             mass matrix, and that its digits were not cut",
        ));
    }
    Ok(bound(stiffness, mass, &factors, &modes.values, modes.vectors.as_ref()))
}
