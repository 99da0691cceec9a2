//! What the symmetry of a ring of equal modules saves.

use super::modes::stiffness_eigenvalues;
use crate::Error;
use crate::contact::ContactState;
use crate::model::ring::MODULE_DOFS;
use crate::model::{LumpedModel, SparseMatrix};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// How contact states of a ring can be turned into each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Modules differ: every state stands for itself.
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
        let in_place = model.contacts.iter().enumerate().all(|(i, contact)| {
            contact.tangent.as_unit() == Some(MODULE_DOFS * i + 2)
                && contact.normal.as_unit() == Some(MODULE_DOFS * i + 3)
                && contact.own == model.contacts[0].own
        });
        if model.contacts.len() != count
            || dofs != MODULE_DOFS * count
            || !in_place
            || !model.dampers.is_empty()
        {
            return Self::None;
        }
        let turned = |dof: usize| (dof + MODULE_DOFS) % dofs;
        let reflected = |dof: usize| {
            let (module, place) = (dof / MODULE_DOFS, dof % MODULE_DOFS);
            MODULE_DOFS * (count - 1 - module) + place
        };
        let keeps = |to: &dyn Fn(usize) -> usize| {
            [&model.mass, &model.stiffness].into_iter().all(|matrix| {
                matrix.entries().all(|(i, j, value)| matrix.get(to(i), to(j)) == value)
            })
        };
        if keeps(&turned) && keeps(&reflected) { Self::Ring } else { Self::None }
    }

    /// The one state that stands for all that symmetry makes equal to this one.
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

/// The eigenvalues σ of M̃⁻¹ K̃, 1/s²: wave by wave where all modules of a ring are equal and in
/// equal states, else from the whole matrix.
///
/// # Errors
/// As [`modes`](super::modes()).
pub(super) fn all_stiffness_eigenvalues(
    model: &LumpedModel,
    states: &[ContactState],
    friction_coefficient: f64,
) -> Result<Vec<Complex<f64>>, Error> {
    let uniform = states.windows(2).all(|pair| pair[0] == pair[1]);
    if uniform && !states.is_empty() && Symmetry::of(model) == Symmetry::Ring {
        wave_eigenvalues(model, states[0], friction_coefficient)
    } else {
        stiffness_eigenvalues(model, states, friction_coefficient)
    }
}

/// The eigenvalues σ of a ring of equal modules with all contacts in the same state, from problems
/// of the size of one module: travelling waves exp(2πi k j / n), j counting modules, make the
/// matrices block-diagonal, and reflection makes the blocks Σ_j K_0j cos(2π k j / n) real; waves k
/// and n − k have the same.
fn wave_eigenvalues(
    model: &LumpedModel,
    state: ContactState,
    friction_coefficient: f64,
) -> Result<Vec<Complex<f64>>, Error> {
    let count = model.contacts.len();
    let diagonal: Vec<f64> = (0..MODULE_DOFS).map(|dof| model.mass.get(dof, dof)).collect();
    let mut sigmas = Vec::with_capacity(model.dofs());
    for wave in 0..=count / 2 {
        let entries = (0..MODULE_DOFS).flat_map(|row| {
            model.stiffness.row(row).map(move |(column, value)| {
                #[allow(clippy::cast_precision_loss)]
                let turn = (wave * (column / MODULE_DOFS) % count) as f64 / count as f64;
                (row, column % MODULE_DOFS, value * (TAU * turn).cos())
            })
        });
        let module = LumpedModel {
            mass: SparseMatrix::diagonal(&diagonal),
            stiffness: SparseMatrix::from_entries(MODULE_DOFS, entries.collect()),
            damping: model.damping,
            dampers: SparseMatrix::zero(MODULE_DOFS),
            load: vec![0.0; MODULE_DOFS],
            contacts: model.contacts[..1].to_vec(),
        };
        let found = stiffness_eigenvalues(&module, &[state], friction_coefficient)?;
        let twice = wave != 0 && 2 * wave != count;
        for _ in 0..=usize::from(twice) {
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
    fn states_with_one_representative_have_one_spectrum() {
        let model = ring(4);
        let a = Spectrum::of(&model, &[Sl, St, Dt, Dt], 1.96).unwrap();
        let b = Spectrum::of(&model, &[Dt, Dt, St, Sl], 1.96).unwrap();
        for (a, b) in a.oscillating.iter().zip(&b.oscillating) {
            assert!((a - b).norm() < 1e-9 * a.norm());
        }
    }

    #[test]
    fn waves_give_the_eigenvalues_of_the_whole_ring() {
        for modules in [1, 2, 3, 4, 7] {
            let model = ring(modules);
            for state in ContactState::ALL {
                let whole = stiffness_eigenvalues(&model, &vec![state; modules], 1.96).unwrap();
                let waves = wave_eigenvalues(&model, state, 1.96).unwrap();
                assert_eq!(whole.len(), waves.len());
                for value in &whole {
                    let near = waves.iter().map(|w| (w - value).norm());
                    assert!(near.fold(f64::MAX, f64::min) < 1e-9 * value.norm());
                }
            }
        }
    }
}
