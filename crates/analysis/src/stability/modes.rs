//! Complex eigenvalue analysis of one contact state (paper, eqs. 3–6).

use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::{Damping, LinearModel, ReducedMatrices};
use amontons::stability::damped_modes::QuadraticProblem;
use amontons::stability::reduced_problem::{
    EigenvalueKind, check_size, cleaned, operator, quadratic_roots, rounding,
};
use amontons::stability::symmetry::{SymmetrySector, module_of_wave, turn};
use amontons::stability::{Eigenpair, eigenpairs};
use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;

/// One mode of a contact state.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// λ, 1/s.
    pub eigenvalue: Complex<f64>,
    /// σ with λ² + (α + β σ) λ + σ = 0, 1/s²: the eigenvalue of M̃⁻¹ K̃ that λ belongs to, but where
    /// there are single dampers.
    pub stiffness_eigenvalue: Complex<f64>,
    /// Shape of x, one value for each degree of freedom; the largest is 1.
    pub shape: Vec<Complex<f64>>,
    /// Number of waves that the shape has around a ring of equal modules in equal states. All but none and half as
    /// many as modules come twice, as cosine and sine; any mixture is a mode too.
    pub waves: Option<usize>,
    /// ‖λ² M̃ u + λ C̃ u + K̃ u‖ against what its rows would have if their terms did not cancel.
    pub residual: f64,
}

impl Mode {
    /// Re λ, 1/s: positive where the mode grows.
    #[must_use]
    pub fn growth_rate(&self) -> f64 {
        self.eigenvalue.re
    }

    /// Im λ / 2π, Hz.
    #[must_use]
    pub fn frequency_hz(&self) -> f64 {
        self.eigenvalue.im / TAU
    }

    /// −Re λ / |λ|.
    #[must_use]
    pub fn damping_ratio(&self) -> f64 {
        -self.eigenvalue.re / self.eigenvalue.norm()
    }
}

/// All modes of one contact state.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// Modes that oscillate, one of each conjugate pair (Im λ > 0), by frequency.
    pub oscillating: Vec<Mode>,
    /// Modes that do not (Im λ = 0), by growth rate; a positive one is divergence.
    pub real: Vec<Mode>,
}

impl Modes {
    /// `true` if any mode grows.
    #[must_use]
    pub fn unstable(&self) -> bool {
        self.all().any(|mode| mode.growth_rate() > 0.0)
    }

    fn add(&mut self, modes: Vec<Mode>) {
        for mode in modes {
            match EigenvalueKind::of(mode.eigenvalue) {
                EigenvalueKind::Real => self.real.push(mode),
                EigenvalueKind::Oscillating | EigenvalueKind::Conjugate => {
                    self.oscillating.push(mode);
                }
            }
        }
    }

    fn sort(&mut self) {
        self.oscillating.sort_by(|a, b| a.eigenvalue.im.total_cmp(&b.eigenvalue.im));
        self.real.sort_by(|a, b| a.eigenvalue.re.total_cmp(&b.eigenvalue.re));
    }

    /// Oscillating modes, then real ones.
    pub fn all(&self) -> impl Iterator<Item = &Mode> {
        self.oscillating.iter().chain(&self.real)
    }
}

/// The modes of a contact state, one entry of `states` a contact; none where its contacts contradict
/// each other (two on one mass, one Sl, one R-Sl).
///
/// # Errors
/// Returns an error if the masses of the state cannot be inverted (friction wedges a contact), the eigenvalue
/// iteration does not converge or leaves the range of numbers, or the model is too large for dense matrices.
pub fn modes(model: LinearModel<'_>, states: &[ContactState]) -> Result<Modes, Error> {
    let mut found = Modes { oscillating: Vec::new(), real: Vec::new() };
    for part in SymmetrySector::all([model], states) {
        match part {
            SymmetrySector::Whole => found.add(modes_of(model, states)?),
            SymmetrySector::Wave { k, modules } => {
                let module = module_of_wave(model.model(), k, modules);
                let one = modes_of(model.of_part(&module), &states[..1])?;
                found.add(one.iter().map(|mode| around(mode, k, modules, f64::cos)).collect());
                if part.copies() == 2 {
                    found.add(one.iter().map(|mode| around(mode, k, modules, f64::sin)).collect());
                }
            }
        }
    }
    found.sort();
    Ok(found)
}

/// A mode of a module as a standing wave around the ring.
fn around(mode: &Mode, k: usize, modules: usize, wave: fn(f64) -> f64) -> Mode {
    let shape = (0..modules).flat_map(|j| {
        let factor = wave(turn(k * j, modules));
        mode.shape.iter().map(move |x| x * factor)
    });
    Mode { shape: scaled(shape.collect()), waves: Some(k), ..mode.clone() }
}

/// The modes of a contact state, from its whole matrices.
fn modes_of(linear: LinearModel<'_>, states: &[ContactState]) -> Result<Vec<Mode>, Error> {
    let model = linear.model();
    check_size(model)?;
    let Some(reduced) = linear.reduced(states) else { return Ok(Vec::new()) };
    let mut found = Vec::new();
    let mut add = |eigenvalue, stiffness_eigenvalue, vector: &[Complex<f64>]| {
        if !matches!(EigenvalueKind::of(eigenvalue), EigenvalueKind::Conjugate) {
            found.push(Mode {
                eigenvalue,
                stiffness_eigenvalue,
                residual: residual(&reduced, eigenvalue, vector),
                shape: shape(&reduced.motions, vector),
                waves: None,
            });
        }
    };
    if linear.has_single_damping_in(states) {
        let Damping { alpha, beta } = model.damping;
        for (eigenvalue, vector) in damped(&reduced)? {
            let rayleigh = -eigenvalue * (eigenvalue + alpha) / (eigenvalue * beta + 1.0);
            add(eigenvalue, rayleigh, &vector);
        }
        return Ok(found);
    }
    let (operator, scale) = operator(&reduced)?;
    let floor = rounding(&operator);
    for (sigma, mut vector) in eigenpairs(&operator).ok_or_else(not_found)? {
        let sigma = cleaned(sigma, floor);
        vector.iter_mut().zip(&scale).for_each(|(value, scale)| *value *= scale);
        for eigenvalue in quadratic_roots(model, sigma) {
            add(eigenvalue, sigma, &vector);
        }
    }
    Ok(found)
}

/// All eigenvalues λ, 1/s, with their vectors u, of a state with single dampers.
fn damped(reduced: &ReducedMatrices) -> Result<Vec<Eigenpair>, Error> {
    let problem = QuadraticProblem::of(reduced)?;
    let (mut values, mut vectors): (Vec<_>, Vec<_>) =
        eigenpairs(&problem.companion()).ok_or_else(not_found)?.into_iter().unzip();
    problem.refine(&mut values);
    vectors.iter_mut().for_each(|vector| vector.truncate(reduced.mass.nrows()));
    Ok(values.into_iter().map(|value| value * problem.unit).zip(vectors).collect())
}

fn not_found() -> Error {
    Error::analysis("the modes of the contact state were not found")
}

fn residual(reduced: &ReducedMatrices, lambda: Complex<f64>, u: &[Complex<f64>]) -> f64 {
    let times = |matrix: &DMatrix<f64>, row: usize| -> Complex<f64> {
        (0..u.len()).map(|column| u[column] * matrix[(row, column)]).sum()
    };
    let (mut rest, mut terms) = (0.0, 0.0);
    for row in 0..u.len() {
        let parts = [
            lambda * lambda * times(&reduced.mass, row),
            lambda * times(&reduced.damping, row),
            times(&reduced.stiffness, row),
        ];
        rest += parts.iter().sum::<Complex<f64>>().norm_sqr();
        terms += parts.iter().map(|part| part.norm()).sum::<f64>().powi(2);
    }
    if terms > 0.0 { (rest / terms).sqrt() } else { 0.0 }
}

/// x = V u.
fn shape(motions: &DMatrix<f64>, u: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let row = |row: usize| (0..u.len()).map(|column| u[column] * motions[(row, column)]).sum();
    scaled((0..motions.nrows()).map(row).collect())
}

/// Turned and scaled so that the largest value is 1.
fn scaled(shape: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
    let Some(largest) = largest(&shape).map(|dof| shape[dof]) else { return shape };
    shape.into_iter().map(|value| value / largest).collect()
}

/// The place of the largest value; the first, where symmetry makes several equal.
pub(super) fn largest(shape: &[Complex<f64>]) -> Option<usize> {
    let most = shape.iter().map(|value| value.norm()).fold(0.0, f64::max);
    shape.iter().position(|value| value.norm() >= most * (1.0 - 1e-9))
}

#[cfg(test)]
mod tests {
    use crate::stability::modes;
    use amontons::contact::ContactState::{Slide, Stick};
    use amontons::model::{Damping, LumpedModel, SparseMatrix};
    use amontons::scene::builtin;
    use amontons::stability::Spectrum;

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
            let found =
                modes(model(&[m], &[(0, 0, k)], &[(0, 0, d)]).linear().unwrap(), &[]).unwrap();
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
            law: amontons::contact::ContactLaw::default(),
        }
    }

    fn spectrum(model: &LumpedModel) -> Spectrum {
        Spectrum::of(model.linear().unwrap(), &[]).unwrap()
    }

    #[test]
    fn what_no_spring_holds_has_eigenvalues_zero_and_nothing_else_has() {
        let tie = |c: f64| [(0, 0, c), (0, 1, -c), (1, 0, -c), (1, 1, c)];
        let zeros = |model: &LumpedModel| {
            let Spectrum { real, oscillating } = spectrum(model);
            let count = real.iter().filter(|value| **value == 0.0).count();
            assert_eq!(real.len() + 2 * oscillating.len(), 4);
            count
        };
        for d in [3.0, 1e6] {
            // Two masses that fly: twice zero. A damper to the ground leaves a place that is any, once zero.
            assert_eq!(zeros(&model(&[1.0, 0.3], &tie(2e5), &tie(d))), 2, "{d}");
            assert_eq!(zeros(&model(&[1.0, 0.3], &tie(2e5), &[(0, 0, d)])), 1, "{d}");
            // The rate of a damper that hardly brakes is lost in the zero's rounding, and is no growth.
            let slow = spectrum(&model(&[1.0, 0.3], &tie(2e5), &[(0, 0, 1e-4)]));
            assert!(!slow.unstable());
            // A soft spring to the ground holds them.
            let held: Vec<_> = tie(2e5).into_iter().chain([(0, 0, 1e-3)]).collect();
            assert_eq!(zeros(&model(&[1.0, 0.3], &held, &tie(d))), 0, "{d}");
        }
    }

    #[test]
    fn a_slow_motion_of_two_equal_parts_is_that_of_one() {
        for (m, d, k) in [(1.0, 5e4, -100.0), (0.05, 1e6, 2e5)] {
            let twice = |value: f64| [(0, 0, value), (1, 1, value)];
            let Spectrum { real, .. } = spectrum(&model(&[m, m], &twice(k), &twice(d)));
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
        let found = spectrum(&model(&[1.0, 1.0], &held, &tie(1e5)));
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
                let found = spectrum(&model);
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
            let [a, b] = [&rayleigh, &single]
                .map(|model| Spectrum::of(model.linear().unwrap(), &states).unwrap());
            let c = modes(single.linear().unwrap(), &states).unwrap();
            assert_eq!((a.oscillating.len(), a.real.len()), (b.oscillating.len(), b.real.len()));
            for ((a, b), c) in a.oscillating.iter().zip(&b.oscillating).zip(&c.oscillating) {
                let size = 1e-8 * a.norm();
                assert!((a - b).norm() < size && (a - c.eigenvalue).norm() < size, "{a} {b}");
                assert!(c.residual < 1e-9);
            }
        }
    }
}
