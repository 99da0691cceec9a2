//! The quadratic eigenvalue problem (λ² M̃ + λ C̃ + K̃) u = 0 at its full size (paper, eq. 6), for any C̃.

use super::modes::no_convergence;
use crate::Error;
use crate::model::ReducedMatrices;
use faer::Mat;
use nalgebra::{Complex, DMatrix};

/// An eigenvalue λ, 1/s, with its vector u.
type Pair = (Complex<f64>, Vec<Complex<f64>>);

/// All eigenvalues with their vectors.
pub(super) fn solve(reduced: &ReducedMatrices) -> Result<Vec<Pair>, Error> {
    let (companion, unit) = companion(reduced)?;
    let eigen = companion.eigen().map_err(|error| no_convergence(&error))?;
    let size = reduced.mass.nrows();
    let values = eigen.S().column_vector();
    let pairs = values.iter().enumerate().map(|(column, value)| {
        let part = |row| Complex::new(eigen.U()[(row, column)].re, eigen.U()[(row, column)].im);
        (cleaned(Complex::new(value.re, value.im)) * unit, (0..size).map(part).collect())
    });
    Ok(pairs.collect())
}

/// All eigenvalues λ, 1/s.
pub(super) fn eigenvalues(reduced: &ReducedMatrices) -> Result<Vec<Complex<f64>>, Error> {
    let (companion, unit) = companion(reduced)?;
    let values = companion.eigenvalues().map_err(|error| no_convergence(&error))?;
    let lambda = |value: faer::c64| cleaned(Complex::new(value.re, value.im)) * unit;
    Ok(values.into_iter().map(lambda).collect())
}

/// A motion that no spring and no damper holds has a double zero, which rounding parts by the root of
/// the precision.
fn cleaned(value: Complex<f64>) -> Complex<f64> {
    if value.norm() < 1e-7 { Complex::new(0.0, 0.0) } else { value }
}

/// [[0, 1], [−M̃⁻¹ K̃, −M̃⁻¹ C̃]] in a unit of time that makes its parts of one size, and 1/unit in 1/s.
fn companion(reduced: &ReducedMatrices) -> Result<(Mat<f64>, f64), Error> {
    let size = reduced.mass.nrows();
    let lu = reduced.mass.clone().lu();
    let solve = |matrix: &DMatrix<f64>| {
        lu.solve(matrix).ok_or_else(|| {
            Error::analysis("the masses that this contact state leaves free cannot be accelerated")
        })
    };
    let (k, c) = (solve(&reduced.stiffness)?, solve(&reduced.damping)?);
    let largest = |matrix: &DMatrix<f64>| matrix.iter().fold(0.0, |a, b| f64::max(a, b.abs()));
    let unit = largest(&k).sqrt().max(largest(&c)).max(f64::MIN_POSITIVE);
    let entry = |row: usize, column: usize| match (row < size, column < size) {
        (true, _) => f64::from(u8::from(column == row + size)),
        (false, true) => -k[(row - size, column)] / unit / unit,
        (false, false) => -c[(row - size, column - size)] / unit,
    };
    Ok((Mat::from_fn(2 * size, 2 * size, entry), unit))
}

#[cfg(test)]
mod tests {
    use crate::contact::ContactState::{Slide, Stick};
    use crate::model::{Damping, LumpedModel, SparseMatrix};
    use crate::scene::builtin;
    use crate::stability::{Spectrum, modes};

    #[test]
    fn one_mass_with_a_damper_has_the_roots_of_its_characteristic_polynomial() {
        for (m, d, k) in [(2.0_f64, 3.0_f64, 800.0_f64), (0.5, 90.0, 100.0)] {
            let model = LumpedModel {
                mass: SparseMatrix::diagonal(&[m]),
                stiffness: SparseMatrix::diagonal(&[k]),
                damping: Damping::default(),
                dampers: SparseMatrix::diagonal(&[d]),
                load: vec![0.0],
                contacts: vec![],
            };
            let found = modes(&model, &[], 0.0).unwrap();
            let discriminant = d * d - 4.0 * m * k;
            if discriminant < 0.0 {
                let [mode] = &found.oscillating[..] else { panic!("{found:?}") };
                assert!((mode.eigenvalue.re + 0.5 * d / m).abs() < 1e-12);
                assert!((mode.eigenvalue.im - 0.5 * (-discriminant).sqrt() / m).abs() < 1e-12);
                assert!(mode.residual < 1e-12);
            } else {
                let [slow, fast] = [1.0, -1.0].map(|s| 0.5 * (-d + s * discriminant.sqrt()) / m);
                let real: Vec<f64> = found.real.iter().map(|mode| mode.eigenvalue.re).collect();
                assert!((real[0] - fast).abs() < 1e-9 && (real[1] - slow).abs() < 1e-9, "{real:?}");
            }
        }
    }

    #[test]
    fn dampers_that_are_rayleigh_damping_in_disguise_give_its_spectrum() {
        let rayleigh = LumpedModel::from(&builtin("set1").unwrap().scene());
        let mut single = rayleigh.clone();
        let Damping { beta, .. } = std::mem::take(&mut single.damping);
        let entries = rayleigh.stiffness.entries().map(|(i, j, k)| (i, j, beta * k)).collect();
        single.dampers = SparseMatrix::from_entries(8, entries);
        for states in [[Slide, Slide], [Slide, Stick]] {
            let a = Spectrum::of(&rayleigh, &states, 1.96).unwrap();
            let b = Spectrum::of(&single, &states, 1.96).unwrap();
            let c = modes(&single, &states, 1.96).unwrap();
            assert_eq!((a.oscillating.len(), a.real.len()), (b.oscillating.len(), b.real.len()));
            for ((a, b), c) in a.oscillating.iter().zip(&b.oscillating).zip(&c.oscillating) {
                let size = 1e-8 * a.norm();
                assert!((a - b).norm() < size && (a - c.eigenvalue).norm() < size, "{a} {b}");
                assert!(c.residual < 1e-9);
            }
        }
    }
}
