//! The quadratic eigenvalue problem (λ² M̃ + λ C̃ + K̃) u = 0 at its full size (paper, eq. 6), for any C̃.

use super::complex::modulus;
use super::eigenvalues::eigenvalues;
#[cfg(feature = "tools")]
use super::modes::{Eigenpair, eigenpairs};
use super::reduced_problem::per_mass;
use crate::Error;
use crate::model::ReducedMatrices;
use nalgebra::{Complex, DMatrix};

/// All eigenvalues λ, 1/s, with their vectors u.
#[cfg(feature = "tools")]
pub(super) fn solve(reduced: &ReducedMatrices) -> Result<Vec<Eigenpair>, Error> {
    let (companion, unit) = companion(reduced)?;
    let size = reduced.mass.nrows();
    let upper = |(value, mut vector): Eigenpair| {
        vector.truncate(size);
        (cleaned(value) * unit, vector)
    };
    Ok(eigenpairs(&companion)?.into_iter().map(upper).collect())
}

/// All eigenvalues λ, 1/s.
pub(super) fn all_eigenvalues(reduced: &ReducedMatrices) -> Result<Vec<Complex<f64>>, Error> {
    let (companion, unit) = companion(reduced)?;
    let found = eigenvalues(companion)
        .ok_or_else(|| Error::analysis("the eigenvalues of the contact state were not found"))?;
    Ok(found.into_iter().map(|value| cleaned(value) * unit).collect())
}

/// Without what rounding makes of zeros: a motion that nothing holds has λ = 0 twice, which it parts by
/// the root of itself; a mode that no damper sees neither grows nor decays.
fn cleaned(value: Complex<f64>) -> Complex<f64> {
    if modulus(value) <= 1e-7 {
        Complex::ZERO
    } else if value.re.abs() <= 1e-13 {
        Complex::new(0.0, value.im)
    } else {
        value
    }
}

/// [[0, 1], [−M̃⁻¹ K̃, −M̃⁻¹ C̃]] in a unit of time that makes its parts of one size, and 1/unit in 1/s.
fn companion(reduced: &ReducedMatrices) -> Result<(DMatrix<f64>, f64), Error> {
    let ReducedMatrices { mass, damping, stiffness, .. } = reduced;
    let (size, k, c) = (mass.nrows(), per_mass(mass, stiffness)?, per_mass(mass, damping)?);
    let largest = |matrix: &DMatrix<f64>| matrix.iter().fold(0.0, |a, b| f64::max(a, b.abs()));
    let unit = largest(&k).sqrt().max(largest(&c)).max(f64::MIN_POSITIVE);
    let entry = |row: usize, column: usize| match (row < size, column < size) {
        (true, _) => f64::from(u8::from(column == row + size)),
        (false, true) => -k[(row - size, column)] / unit / unit,
        (false, false) => -c[(row - size, column - size)] / unit,
    };
    Ok((DMatrix::from_fn(2 * size, 2 * size, entry), unit))
}

#[cfg(all(test, feature = "tools"))]
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
                law: crate::contact::ContactLaw::default(),
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
