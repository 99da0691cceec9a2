//! The symmetry of a ring of equal modules, which reduces its eigenvalue problems.

use super::reduced_problem::stiffness_eigenvalues;
use crate::Error;
use crate::contact::ContactState;
use crate::model::ring::{self, MODULE_DOFS};
use crate::model::{LinearModel, LumpedModel, SparseMatrix};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Transformations of contact states of a ring that keep the eigenvalues.
///
/// ```
/// use amontons::contact::ContactState::{Slide, Stick};
/// use amontons::model::LumpedModel;
/// use amontons::stability::Symmetry;
///
/// let scene = amontons::scene::builtin("ring12").expect("a built-in scene").scene();
/// let symmetry = Symmetry::of(&LumpedModel::from(&scene));
/// assert_eq!(symmetry, Symmetry::Ring);
/// assert_eq!(symmetry.representative(&[Stick, Slide]), [Slide, Stick]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Modules differ: no two states are equivalent.
    None,
    /// All modules are equal: a state has the eigenvalues of its rotations and reflections.
    Ring,
}

impl Symmetry {
    /// The symmetry of a model: that of a ring if turning it by one module and turning it round
    /// change no entry of its matrices.
    #[must_use]
    pub fn of(model: &LumpedModel) -> Self {
        let dofs = model.dofs();
        let count = dofs / MODULE_DOFS;
        let is_ring = ring::has_contacts_in_place(model) && ring::has_equal_contacts(model);
        // Slopes of µ(v) act with the normal force of each contact, which loads make different.
        let has_slopes = !model.law.friction.info().is_constant();
        let is_damped = has_slopes || !model.dampers.is_empty();
        if !is_ring || model.mass.as_diagonal().is_none() || is_damped {
            return Self::None;
        }
        let turned = |dof: usize| (dof + MODULE_DOFS) % dofs;
        let reflected = |dof: usize| {
            let (module, place) = (dof / MODULE_DOFS, dof % MODULE_DOFS);
            MODULE_DOFS * (count - 1 - module) + place
        };
        let keeps = |place: &dyn Fn(usize) -> usize| {
            ring::is_invariant(&model.mass, place) && ring::is_invariant(&model.stiffness, place)
        };
        if keeps(&turned) && keeps(&reflected) { Self::Ring } else { Self::None }
    }

    /// The representative of all states that symmetry makes equivalent to this one.
    #[must_use]
    pub fn representative(self, states: &[ContactState]) -> Vec<ContactState> {
        let mut best = states.to_vec();
        if self == Self::None {
            return best;
        }
        let key = |states: &[ContactState]| states.iter().map(|s| *s as u8).collect::<Vec<_>>();
        let mut candidate = states.to_vec();
        for _ in 0..2 {
            for _ in 0..candidate.len() {
                candidate.rotate_left(1);
                if key(&candidate) < key(&best) {
                    best.clone_from(&candidate);
                }
            }
            candidate.reverse();
        }
        best
    }
}

/// A part of the modes of a contact state that does not couple with the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymmetrySector {
    /// All modes.
    Whole,
    /// The travelling waves exp(±2πi k j / n), j counting modules, of a ring of n equal modules in
    /// equal states: they make the matrices block-diagonal, and reflection makes the blocks
    /// Σ_j K_0j cos(2π k j / n) real.
    Wave {
        /// Number of waves around the ring k, from 0 to n/2.
        k: usize,
        /// Number of modules n.
        modules: usize,
    },
}

impl SymmetrySector {
    /// The parts of a contact state, for models that differ in the value of a parameter.
    pub fn all<'a>(
        models: impl IntoIterator<Item = LinearModel<'a>>,
        states: &[ContactState],
    ) -> Vec<Self> {
        let uniform = !states.is_empty() && states.windows(2).all(|pair| pair[0] == pair[1]);
        if uniform && models.into_iter().all(|model| Symmetry::of(model.model()) == Symmetry::Ring)
        {
            let modules = states.len();
            (0..=modules / 2).map(|k| Self::Wave { k, modules }).collect()
        } else {
            vec![Self::Whole]
        }
    }

    /// Multiplicity of the modes: waves travel in both directions and count twice.
    #[must_use]
    pub fn copies(self) -> usize {
        match self {
            Self::Wave { k, modules } if k != 0 && 2 * k != modules => 2,
            Self::Wave { .. } | Self::Whole => 1,
        }
    }

    /// The eigenvalues σ of M̃⁻¹ K̃ of this part, 1/s², each once.
    ///
    /// # Errors
    /// Returns an error if the model is too large to be solved as one matrix, if its masses cannot be accelerated, or if
    /// no eigenvalues are found.
    pub fn stiffness_eigenvalues(
        self,
        model: LinearModel<'_>,
        states: &[ContactState],
    ) -> Result<Vec<Complex<f64>>, Error> {
        match self {
            Self::Whole => stiffness_eigenvalues(model, states),
            Self::Wave { k, modules } => {
                let module = module_of_wave(model.model(), k, modules);
                stiffness_eigenvalues(model.of_part(&module), &states[..1])
            }
        }
    }
}

/// One module that moves as it does in wave k of a ring of equal modules.
pub fn module_of_wave(model: &LumpedModel, k: usize, modules: usize) -> LumpedModel {
    let diagonal: Vec<f64> = (0..MODULE_DOFS).map(|dof| model.mass.get(dof, dof)).collect();
    let entries = (0..MODULE_DOFS).flat_map(|row| {
        model.stiffness.row(row).map(move |(column, value)| {
            (
                row,
                column % MODULE_DOFS,
                value * libm::cos(turn(k * (column / MODULE_DOFS), modules)),
            )
        })
    });
    LumpedModel {
        mass: SparseMatrix::diagonal(&diagonal),
        stiffness: SparseMatrix::from_entries(MODULE_DOFS, entries.collect()),
        damping: model.damping,
        dampers: SparseMatrix::zero(MODULE_DOFS),
        load: vec![0.0; MODULE_DOFS],
        contacts: model.contacts[..1].to_vec(),
        law: model.law,
    }
}

/// 2π · part / whole, without whole turns.
#[allow(clippy::cast_precision_loss)]
pub fn turn(part: usize, whole: usize) -> f64 {
    TAU * ((part % whole) as f64 / whole as f64)
}

/// The eigenvalues σ of M̃⁻¹ K̃ of a contact state, 1/s².
///
/// # Errors
/// Returns an error if the model is too large to be solved as one matrix, if its masses cannot be accelerated, or if no
/// eigenvalues are found.
pub fn all_stiffness_eigenvalues(
    model: LinearModel<'_>,
    states: &[ContactState],
) -> Result<Vec<Complex<f64>>, Error> {
    let mut sigmas = Vec::with_capacity(model.model().dofs());
    for part in SymmetrySector::all([model], states) {
        let found = part.stiffness_eigenvalues(model, states)?;
        for _ in 0..part.copies() {
            sigmas.extend_from_slice(&found);
        }
    }
    Ok(sigmas)
}

#[cfg(test)]
mod tests {
    use super::super::Spectrum;
    use super::*;
    use crate::scene::builtin;
    use ContactState::{Detached as Dt, Slide as Sl, Stick as St};

    fn ring(modules: usize) -> LumpedModel {
        let mut scene = builtin("set1").unwrap().scene();
        let module = scene.modules()[0];
        *scene.modules_mut() = vec![module; modules];
        LumpedModel::from(&scene)
    }

    #[test]
    fn rotated_and_reflected_states_have_one_representative() {
        let ring = Symmetry::of(&ring(4));
        assert_eq!(ring, Symmetry::Ring);
        let states = [[Sl, St, Dt, Dt], [Dt, Sl, St, Dt], [Dt, Dt, St, Sl], [St, Sl, Dt, Dt]];
        for other in states {
            assert_eq!(ring.representative(&other), states[0]);
        }
        assert_ne!(ring.representative(&[Sl, Dt, St, Dt]), states[0]);
    }

    #[test]
    fn one_different_module_breaks_the_symmetry() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.modules_mut()[1].stiffness[4] += 1.0;
        assert_eq!(Symmetry::of(&LumpedModel::from(&scene)), Symmetry::None);
    }

    #[test]
    fn friction_that_falls_breaks_the_symmetry() {
        let mut model = ring(4);
        model.law.friction = crate::contact::Law::Stribeck;
        assert_eq!(Symmetry::of(&model), Symmetry::None);
    }

    #[test]
    fn states_with_one_representative_have_one_spectrum() {
        let model = ring(4);
        let model = model.linear().unwrap();
        let a = Spectrum::of(model, &[Sl, St, Dt, Dt]).unwrap();
        let b = Spectrum::of(model, &[Dt, Dt, St, Sl]).unwrap();
        assert_eq!((a.oscillating.len(), a.real.len()), (b.oscillating.len(), b.real.len()));
        for (a, b) in a.oscillating.iter().zip(&b.oscillating) {
            assert!((a - b).norm() < 1e-9 * a.norm());
        }
    }

    #[test]
    fn waves_give_the_eigenvalues_of_the_whole_ring() {
        for modules in [1, 2, 3, 4, 7] {
            let model = ring(modules);
            let model = model.linear().unwrap();
            for state in ContactState::ALL {
                let whole = stiffness_eigenvalues(model, &vec![state; modules]).unwrap();
                let waves = all_stiffness_eigenvalues(model, &vec![state; modules]).unwrap();
                assert_eq!(whole.len(), waves.len());
                for value in &whole {
                    let near = waves.iter().map(|w| (w - value).norm());
                    assert!(near.fold(f64::MAX, f64::min) < 1e-9 * value.norm());
                }
            }
        }
    }
}
