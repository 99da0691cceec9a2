//! Damping by ratios of the modes of the free superelement.

use super::eigen::modes_of;
use amontons::scene::Problem;

/// Squares of circular frequencies below this part of the largest one, times the number of modes, are those of rigid bodies:
/// rounding leaves a stiffness there.
const RIGID: f64 = 16.0 * f64::EPSILON;

/// Squares of circular frequencies below this part of the largest one may be those of rigid bodies too where the numbers
/// of the files are rounded to eight or more digits.
const DOUBTFUL: f64 = 1e-8;

/// The matrix D = Σ 2 ζ_i ω_i (M φ_i)(M φ_i)ᵀ over the modes K φ = ω² M φ with φᵀ M φ = 1, N s/m; n × n by rows. `ratios` are ζ of
/// all modes that oscillate, or one for each of the first by frequency. Motions of rigid bodies get none and are not counted.
///
/// # Errors
/// Returns a problem if there are more ratios than modes that oscillate, if several ratios are given and rounding hides
/// which modes oscillate, or if the mass matrix is not positive definite.
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
    if ratios.len() > 1
        && let Some(doubt) = doubtful(&modes.values, most)
    {
        return Err(vec![doubt]);
    }
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

/// The problem of modes that may be motions of rigid bodies with a stiffness that rounding has left, or oscillations;
/// `values` are ω², of which `most` is the largest. `None` if there are none.
fn doubtful(values: &[f64], most: f64) -> Option<Problem> {
    #[allow(clippy::cast_precision_loss)]
    let rigid = RIGID * values.len() as f64 * most;
    let is_doubtful = |value: &&f64| value.abs() > rigid && **value < DOUBTFUL * most;
    let count = values.iter().filter(is_doubtful).count();
    let highest = values.iter().filter(is_doubtful).fold(0.0_f64, |most, value| most.max(*value));
    let message = format!(
        "numbers modes, but {count} of the lowest modes, up to {:.4} Hz, may be motions of a rigid body with rounded \
         stiffnesses, or oscillations",
        highest.sqrt() / std::f64::consts::TAU
    );
    let help = "give one number for all modes, or write the stiffness matrix with all its digits";
    (count > 0).then(|| Problem::new("damping_ratio", message).help(help))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_not_counted_from_a_rigid_motion_that_rounding_has_stiffened() {
        // Three equal masses in a free row: ω² = 0, k/m and 3 k/m.
        let k = 1e6;
        let stiffness = |error: f64| [k + error, -k, 0.0, -k, 2.0 * k, -k, 0.0, -k, k].to_vec();
        let mass = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let ratios = [0.01, 0.02];
        let found = damping(&mass, &stiffness(0.0), 3, &ratios).unwrap();
        // The trace is Σ 2 ζ ω.
        let expected = 2.0 * (0.01 * k.sqrt() + 0.02 * (3.0 * k).sqrt());
        assert!((found[0] + found[4] + found[8] - expected).abs() < 1e-9 * expected);
        for error in [3e-3, -3e-3] {
            let problems = damping(&mass, &stiffness(error), 3, &ratios).unwrap_err();
            assert!(problems[0].to_string().contains("rigid body"), "{}", problems[0]);
            assert!(damping(&mass, &stiffness(error), 3, &ratios[..1]).is_ok());
        }
    }
}
