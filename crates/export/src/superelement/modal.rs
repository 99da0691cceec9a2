//! Damping by ratios of the modes of the free superelement.

use super::eigen::modes_of;
use amontons::scene::Problem;

/// Squares of circular frequencies below this part of the largest one, times the number of modes, are those of rigid bodies:
/// rounding leaves a stiffness there.
const RIGID: f64 = 16.0 * f64::EPSILON;

/// The matrix D = Σ 2 ζ_i ω_i (M φ_i)(M φ_i)ᵀ over the modes K φ = ω² M φ with φᵀ M φ = 1, N s/m; n × n by rows. `ratios` are ζ of
/// all modes that oscillate, or one for each of the first by frequency. Motions of rigid bodies get none and are not counted.
///
/// # Errors
/// Returns a problem if there are more ratios than modes that oscillate, or the mass matrix is not positive definite.
pub(super) fn damping(
    mass: &[f64],
    stiffness: &[f64],
    n: usize,
    ratios: &[f64],
) -> Result<Vec<f64>, Vec<Problem>> {
    let Some(lower) = cholesky(mass, n) else {
        let message = "must be positive definite";
        let help = "give each degree of freedom a mass, or leave out those that have none";
        return Err(vec![Problem::new("mass", message).help(help)]);
    };
    // L⁻¹ K L⁻ᵀ has the eigenvectors z = Lᵀ φ, so that M φ = L z.
    let mut reduced = stiffness.to_vec();
    for _ in 0..2 {
        solve_columns(&lower, &mut reduced, n);
        transpose(&mut reduced, n);
    }
    for row in 0..n {
        for column in 0..row {
            reduced[column * n + row] = reduced[row * n + column];
        }
    }
    let modes = modes_of(reduced, n);
    let most = modes.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    #[allow(clippy::cast_precision_loss)]
    let oscillates = |place: &usize| modes.values[*place] > RIGID * n as f64 * most;
    let flexible: Vec<usize> = (0..n).filter(oscillates).collect();
    if ratios.len() > flexible.len() {
        let message = format!(
            "has {} values, but {} modes of the free superelement oscillate",
            ratios.len(),
            flexible.len()
        );
        let help = "give one number for all modes, or one for each of the first modes by frequency";
        return Err(vec![Problem::new("damping_ratio", message).help(help)]);
    }
    let mut damping = vec![0.0; n * n];
    for (number, place) in flexible.into_iter().enumerate() {
        let ratio = match ratios {
            [all] => *all,
            each => each.get(number).copied().unwrap_or(0.0),
        };
        if ratio == 0.0 {
            continue;
        }
        let vector = modes.vector(place);
        let weight = 2.0 * ratio * modes.values[place].sqrt();
        let momentum: Vec<f64> =
            (0..n).map(|row| dot(&lower[row * n..], &vector[..=row])).collect();
        for (row, values) in damping.chunks_exact_mut(n).enumerate() {
            let factor = weight * momentum[row];
            values[..=row]
                .iter_mut()
                .zip(&momentum)
                .for_each(|(sum, other)| *sum += factor * other);
        }
    }
    for row in 0..n {
        for column in 0..row {
            damping[column * n + row] = damping[row * n + column];
        }
    }
    Ok(damping)
}

/// Σ a_i b_i over the places of both.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// The lower triangle L with M = L Lᵀ; `None` if the matrix is not positive definite.
fn cholesky(matrix: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut lower = vec![0.0; n * n];
    for row in 0..n {
        for column in 0..=row {
            let known = dot(&lower[row * n..row * n + column], &lower[column * n..]);
            let left = matrix[row * n + column] - known;
            lower[row * n + column] = if column < row {
                left / lower[column * n + column]
            } else if left > 0.0 {
                left.sqrt()
            } else {
                return None;
            };
        }
    }
    Some(lower)
}

/// Replaces B by L⁻¹ B.
fn solve_columns(lower: &[f64], matrix: &mut [f64], n: usize) {
    for row in 0..n {
        let (above, from) = matrix.split_at_mut(row * n);
        let values = &mut from[..n];
        for (factor, other) in lower[row * n..].iter().zip(above.chunks_exact(n)) {
            values.iter_mut().zip(other).for_each(|(value, other)| *value -= factor * other);
        }
        let pivot = lower[row * n + row];
        values.iter_mut().for_each(|value| *value /= pivot);
    }
}

fn transpose(matrix: &mut [f64], n: usize) {
    for row in 0..n {
        for column in 0..row {
            matrix.swap(row * n + column, column * n + row);
        }
    }
}
