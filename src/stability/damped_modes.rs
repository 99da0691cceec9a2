//! The quadratic eigenvalue problem (λ² M̃ + λ C̃ + K̃) u = 0 at its full size (paper, eq. 6), for any C̃.

use super::complex::modulus;
use super::eigenvalues::eigenvalues;
#[cfg(feature = "tools")]
use super::modes::{Eigenpair, eigenpairs};
use super::reduced_problem::{per_mass, rounding};
use super::singular_values::SingularValues;
use crate::Error;
use crate::model::ReducedMatrices;
use nalgebra::{Complex, DMatrix};

/// All eigenvalues λ, 1/s, with their vectors u.
#[cfg(feature = "tools")]
pub(super) fn solve(reduced: &ReducedMatrices) -> Result<Vec<Eigenpair>, Error> {
    let problem = Problem::of(reduced)?;
    let (mut values, mut vectors): (Vec<_>, Vec<_>) =
        eigenpairs(&problem.companion())?.into_iter().unzip();
    problem.refine(&mut values);
    vectors.iter_mut().for_each(|vector| vector.truncate(reduced.mass.nrows()));
    Ok(values.into_iter().map(|value| value * problem.unit).zip(vectors).collect())
}

/// All eigenvalues λ, 1/s.
pub(super) fn all_eigenvalues(reduced: &ReducedMatrices) -> Result<Vec<Complex<f64>>, Error> {
    let problem = Problem::of(reduced)?;
    let mut values = eigenvalues(problem.companion())
        .ok_or_else(|| Error::analysis("the eigenvalues of the contact state were not found"))?;
    problem.refine(&mut values);
    Ok(values.into_iter().map(|value| value * problem.unit).collect())
}

/// Eigenvalues below this part of the largest have lost digits to it.
const SMALL: f64 = 1e-4;
/// A double zero comes out of rounding as two values of up to this size, the root of rounding.
const SPLIT: f64 = 1e-7;
/// A step of Newton's that is longer than this part of the distance to the next eigenvalue may lead to that one.
const NEAR: f64 = 0.3;
/// Values that differ by less than this part of themselves, or by rounding, are those of equal parts of a structure.
const TWINS: f64 = 1e-6;
const ROUNDING: f64 = 1e-14;
/// No more than the smallest ones are refined, each of which takes some times as long as a factorisation.
const MOST_REFINED: usize = 16;
/// A real part below this part of the largest eigenvalue is what rounding makes of zero in a mode that oscillates and that no
/// damper sees: it neither grows nor decays.
const NO_GROWTH: f64 = 1e-13;

/// λ² + λ C + K, both multiplied by M̃⁻¹, in a unit of time that makes them of one size.
struct Problem {
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// 1/s.
    unit: f64,
}

impl Problem {
    fn of(reduced: &ReducedMatrices) -> Result<Self, Error> {
        let ReducedMatrices { mass, damping, stiffness, .. } = reduced;
        let (stiffness, damping) = (per_mass(mass, stiffness)?, per_mass(mass, damping)?);
        let unit = stiffness.amax().sqrt().max(damping.amax()).max(f64::MIN_POSITIVE);
        Ok(Self { damping: damping / unit, stiffness: stiffness / unit / unit, unit })
    }

    /// [[0, 1], [−K, −C]].
    fn companion(&self) -> DMatrix<f64> {
        let size = self.stiffness.nrows();
        let entry = |row: usize, column: usize| match (row < size, column < size) {
            (true, _) => f64::from(u8::from(column == row + size)),
            (false, true) => -self.stiffness[(row - size, column)],
            (false, false) => -self.damping[(row - size, column - size)],
        };
        DMatrix::from_fn(2 * size, 2 * size, entry)
    }

    /// Gives small eigenvalues the digits that large ones have taken from them, and takes for zero what rounding makes of it.
    fn refine(&self, values: &mut [Complex<f64>]) {
        let by_size =
            |one: &usize, other: &usize| modulus(values[*one]).total_cmp(&modulus(values[*other]));
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(by_size);
        let count = order.iter().take_while(|&&at| modulus(values[at]) <= SPLIT).count();
        let zeros = if count > 0 { self.zeros().min(count) } else { 0 };
        for &at in &order[..zeros] {
            values[at] = Complex::ZERO;
        }
        let found = values.to_vec();
        let (mut refined, mut pairs) = (0, Vec::new());
        for &at in &order[zeros..] {
            let value = found[at];
            // Of a pair the one below is the other's conjugate.
            let is_other = |other: &Complex<f64>| value.im < 0.0 && *other == value.conj();
            if let Some(other) = found.iter().position(is_other) {
                pairs.push([at, other]);
                continue;
            }
            let is_small = modulus(value) <= SMALL && refined < MOST_REFINED;
            refined += usize::from(is_small);
            let again = if is_small { self.again(value, &found, at) } else { None };
            // What is neither known to be zero nor found again is not known any better.
            let is_lost = again.is_none() && modulus(value) <= SPLIT;
            let better = if is_lost { Complex::ZERO } else { again.unwrap_or(value) };
            let is_real = better.im == 0.0 && again.is_some();
            let nothing = if is_real { 0.0 } else { NO_GROWTH };
            let grows = better.re.abs() > nothing;
            values[at] = if grows { better } else { Complex::new(0.0, better.im) };
        }
        for [below, other] in pairs {
            values[below] = values[other].conj();
        }
    }

    /// The value at a place among those that were found, with all its digits; `None` where they cannot be had.
    fn again(
        &self,
        value: Complex<f64>,
        found: &[Complex<f64>],
        at: usize,
    ) -> Option<Complex<f64>> {
        let others = (0..found.len()).filter(|other| *other != at);
        let distances: Vec<f64> = others.map(|other| modulus(found[other] - value)).collect();
        let is_twin = |distance: &&f64| **distance <= (TWINS * modulus(value)).max(ROUNDING);
        let count = 1 + distances.iter().filter(is_twin).count();
        let far = distances.iter().filter(|distance| !is_twin(distance));
        self.refined(value, far.copied().fold(f64::INFINITY, f64::min), count)
    }

    /// How many eigenvalues are zero: of each motion that no spring holds one, and another one if no damper does.
    fn zeros(&self) -> usize {
        let complex = |matrix: &DMatrix<f64>| matrix.map(Complex::from);
        let stiffness = complex(&self.stiffness);
        let both = [SingularValues::of(stiffness.adjoint()), SingularValues::of(stiffness)];
        let [Some(left), Some(right)] = both else { return 0 };
        let floor = rounding(&self.stiffness);
        let free = right.values().into_iter().filter(|value| *value <= floor).count();
        let [left, right] = [left.least_vectors(free), right.least_vectors(free)];
        let damped = left.ad_mul(&(complex(&self.damping) * right));
        let floor = rounding(&self.damping);
        let Some(damped) = SingularValues::of(damped) else { return free };
        2 * free - damped.values().into_iter().filter(|value| *value > floor).count()
    }

    /// A root of det(λ² + λ C + K) that comes `count` times, by Newton's steps from one near it, the next one being so far away;
    /// `None` where they lead elsewhere.
    #[allow(clippy::cast_precision_loss)]
    fn refined(&self, start: Complex<f64>, gap: f64, count: usize) -> Option<Complex<f64>> {
        const STEPS: usize = 4;
        let size = self.stiffness.nrows();
        let mut value = start;
        for _ in 0..STEPS {
            let at = |row: usize, column: usize| {
                let diagonal = if row == column { value * value } else { Complex::ZERO };
                diagonal + value * self.damping[(row, column)] + self.stiffness[(row, column)]
            };
            let slope = |row: usize, column: usize| {
                let diagonal = if row == column { value * 2.0 } else { Complex::ZERO };
                diagonal + self.damping[(row, column)]
            };
            let problem = DMatrix::from_fn(size, size, at).lu();
            // Of a matrix that is singular to the last digit the value is the root.
            let Some(solved) = problem.solve(&DMatrix::from_fn(size, size, slope)) else { break };
            let step = -solved.trace().inv() * count as f64;
            if !step.is_finite() {
                break;
            }
            value += step;
            if modulus(value - start) > NEAR * gap {
                return None;
            }
            if modulus(step) <= f64::EPSILON * modulus(value) {
                break;
            }
        }
        Some(value)
    }
}

#[cfg(all(test, feature = "tools"))]
mod tests {
    use crate::contact::ContactState::{Slide, Stick};
    use crate::model::{Damping, LumpedModel, SparseMatrix};
    use crate::scene::builtin;
    use crate::stability::{Spectrum, modes};

    #[test]
    fn one_mass_with_a_damper_has_the_roots_of_its_characteristic_polynomial() {
        // The last ones creep by parts of 1e-11 and less of how fast they would stop.
        const MASSES: [(f64, f64, f64); 5] = [
            (2.0, 3.0, 800.0),
            (0.5, 90.0, 100.0),
            (0.05, 1e6, 2e5),
            (1.0, 5e4, -100.0),
            (0.02, 1e8, -3.0),
        ];
        for (m, d, k) in MASSES {
            let found = modes(&model(&[m], &[(0, 0, k)], &[(0, 0, d)]), &[], 0.0).unwrap();
            let discriminant = d * d - 4.0 * m * k;
            if discriminant < 0.0 {
                let [mode] = &found.oscillating[..] else { panic!("{found:?}") };
                assert!((mode.eigenvalue.re + 0.5 * d / m).abs() < 1e-12);
                assert!((mode.eigenvalue.im - 0.5 * (-discriminant).sqrt() / m).abs() < 1e-12);
                assert!(mode.residual < 1e-12);
            } else {
                let fast = -0.5 * (d + discriminant.sqrt()) / m;
                let slow = k / m / fast;
                let real: Vec<f64> = found.real.iter().map(|mode| mode.eigenvalue.re).collect();
                assert!((real[0] / fast - 1.0).abs() < 1e-12, "{real:?} {fast}");
                assert!((real[1] / slow - 1.0).abs() < 1e-12, "{real:?} {slow}");
            }
        }
    }

    fn model(mass: &[f64], k: &[(usize, usize, f64)], d: &[(usize, usize, f64)]) -> LumpedModel {
        LumpedModel {
            mass: SparseMatrix::diagonal(mass),
            stiffness: SparseMatrix::from_entries(mass.len(), k.to_vec()),
            damping: Damping::default(),
            dampers: SparseMatrix::from_entries(mass.len(), d.to_vec()),
            load: vec![0.0; mass.len()],
            contacts: vec![],
            law: crate::contact::ContactLaw::default(),
        }
    }

    #[test]
    fn what_no_spring_holds_has_eigenvalues_zero_and_nothing_else_has() {
        let tie = |c: f64| [(0, 0, c), (0, 1, -c), (1, 0, -c), (1, 1, c)];
        let zeros = |model: &LumpedModel| {
            let Spectrum { real, oscillating } = Spectrum::of(model, &[], 0.0).unwrap();
            let count = real.iter().filter(|value| **value == 0.0).count();
            assert_eq!(real.len() + 2 * oscillating.len(), 4);
            count
        };
        for d in [3.0, 1e6] {
            // Two masses that fly: twice zero. A damper to the ground leaves a place that is any, once zero.
            assert_eq!(zeros(&model(&[1.0, 0.3], &tie(2e5), &tie(d))), 2, "{d}");
            assert_eq!(zeros(&model(&[1.0, 0.3], &tie(2e5), &[(0, 0, d)])), 1, "{d}");
            // One that hardly brakes: its rate is lost in the zero's rounding, and is no growth.
            let slow = Spectrum::of(&model(&[1.0, 0.3], &tie(2e5), &[(0, 0, 1e-4)]), &[], 0.0);
            assert!(!slow.unwrap().unstable());
            // A soft spring to the ground holds them.
            let held: Vec<_> = tie(2e5).into_iter().chain([(0, 0, 1e-3)]).collect();
            assert_eq!(zeros(&model(&[1.0, 0.3], &held, &tie(d))), 0, "{d}");
        }
    }

    #[test]
    fn a_slow_motion_of_two_equal_parts_is_that_of_one() {
        for (m, d, k) in [(1.0, 5e4, -100.0), (0.05, 1e6, 2e5)] {
            let twice = |value: f64| [(0, 0, value), (1, 1, value)];
            let Spectrum { real, .. } =
                Spectrum::of(&model(&[m, m], &twice(k), &twice(d)), &[], 0.0).unwrap();
            let slow = -2.0 * k / (d + f64::sqrt(d * d - 4.0 * m * k));
            assert_eq!(real.len(), 4);
            for value in &real[2..] {
                assert!((value / slow - 1.0).abs() < 1e-9, "{real:?} {slow}");
            }
        }
    }

    #[test]
    fn a_mode_that_a_large_damper_does_not_see_neither_grows_nor_decays() {
        // Two masses that a damper of 1e5 N s/m ties, each on a soft spring: together they swing at 4.1 rad/s.
        let tie = |c: f64| [(0, 0, c), (0, 1, -c), (1, 0, -c), (1, 1, c)];
        let held: Vec<_> = tie(1e8).into_iter().chain([(0, 0, 17.0), (1, 1, 17.0)]).collect();
        let found = Spectrum::of(&model(&[1.0, 1.0], &held, &tie(1e5)), &[], 0.0).unwrap();
        let [mode] = found.oscillating[..] else { panic!("{found:?}") };
        assert!(mode.re == 0.0 && (mode.im / 17.0_f64.sqrt() - 1.0).abs() < 1e-6, "{found:?}");
        assert!(!found.unstable());
    }

    #[test]
    fn where_a_static_stiffness_is_lost_no_damper_matters() {
        // det K = 0 at k = 4e10 / 3e5; the rate is that of det K by what dampers and masses oppose to it.
        for d in [1.0, 1e3, 1e6] {
            for (part, grows) in [(1.0 - 1e-12, true), (1.0 + 1e-12, false)] {
                let k = part * 4e10 / 3e5;
                let stiffness = [(0, 0, k), (0, 1, 2e5), (1, 0, 2e5), (1, 1, 3e5)];
                let model = model(&[0.05, 0.02], &stiffness, &[(0, 0, d)]);
                let found = Spectrum::of(&model, &[], 0.0).unwrap();
                let slow = found.real.iter().copied().min_by(|a, b| a.abs().total_cmp(&b.abs()));
                let expected = -3e5 * (k - 4e10 / 3e5) / (3e5 * d);
                let off = slow.unwrap() / expected - 1.0;
                assert!(off.abs() < 1e-3 && found.unstable() == grows, "{d} {found:?} {expected}");
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
