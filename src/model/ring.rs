//! The order of the degrees of freedom of the paper's ring of modules (Fig. 1).
//!
//! Degrees of freedom of module i (from 0), at 4 i + 0 … 3:
//!
//! * x1, x2: mass m1, horizontal (right) and vertical (up);
//! * x3, x4: mass m2, along the slider's tangent t = (cos θ, sin θ) and outward normal
//!   n = (−sin θ, cos θ); the contact is closed at x4 = 0.

use super::{Contact, LumpedModel, SparseMatrix};

/// Degrees of freedom of a module.
pub const MODULE_DOFS: usize = 4;

/// One module that moves as all of them do, if the model is a ring of more than one module that
/// nothing tells apart but their masses: its links to the others, which then do not strain, are
/// left out. As the order of assembly leaves no trace, equal modules have equal doubles.
pub(super) fn one_of_equal_modules(model: &LumpedModel) -> Option<LumpedModel> {
    let (dofs, count) = (model.dofs(), model.contacts.len());
    if count < 2 || dofs != MODULE_DOFS * count {
        return None;
    }
    let first = &model.contacts[0];
    let in_place = |(i, contact): (usize, &Contact)| {
        contact.tangent.as_unit() == Some(MODULE_DOFS * i + 2)
            && contact.normal.as_unit() == Some(MODULE_DOFS * i + 3)
            && (contact.friction, contact.surface_velocity)
                == (first.friction, first.surface_velocity)
    };
    let next = |dof: usize| (dof + MODULE_DOFS) % dofs;
    let is_turned =
        model.stiffness.entries().all(|(i, j, k)| model.stiffness.get(next(i), next(j)) == k);
    let load = &model.load[..MODULE_DOFS];
    let equal = model.contacts.iter().enumerate().all(in_place)
        && is_turned
        && model.load.chunks_exact(MODULE_DOFS).all(|other| other == load);
    equal.then(|| {
        let rows = (0..MODULE_DOFS)
            .flat_map(|i| model.stiffness.row(i).map(move |(j, k)| (i, j % MODULE_DOFS, k)));
        LumpedModel {
            mass: SparseMatrix::diagonal(&[1.0; MODULE_DOFS]),
            stiffness: SparseMatrix::from_entries(MODULE_DOFS, rows.collect()),
            damping: model.damping,
            dampers: SparseMatrix::zero(MODULE_DOFS),
            load: load.to_vec(),
            contacts: vec![first.clone()],
            law: model.law,
        }
    })
}
