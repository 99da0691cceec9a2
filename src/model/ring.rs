//! The order of the degrees of freedom of the paper's ring of modules (Fig. 1).
//!
//! Degrees of freedom of module i (from 0), at 4 i + 0 … 3:
//!
//! * x1, x2: mass m1, horizontal (right) and vertical (up);
//! * x3, x4: mass m2, along the slider's tangent t = (cos θ, sin θ) and outward normal
//!   n = (−sin θ, cos θ); a contact without a gap in the reference position is closed at x4 = 0.

use super::{Contact, LumpedModel, SparseMatrix};

/// Degrees of freedom of a module.
pub const MODULE_DOFS: usize = 4;
/// Places of x3 and x4, along the tangent and the normal of the contact, in a module.
pub(crate) const TANGENT: usize = 2;
pub(crate) const NORMAL: usize = 3;

/// `true` if a model has as many modules as contacts, at least one, with contact i between the slider and mass m2 of
/// module i.
pub(crate) fn has_contacts_in_place(model: &LumpedModel) -> bool {
    let count = model.contacts.len();
    let mut contacts = model.contacts.iter().enumerate();
    count > 0
        && model.dofs() == MODULE_DOFS * count
        && contacts.all(|(i, contact)| {
            contact.tangent.as_unit() == Some(MODULE_DOFS * i + TANGENT)
                && contact.normal.as_unit() == Some(MODULE_DOFS * i + NORMAL)
        })
}

/// `true` if all contacts have the same friction and the same velocity of their surfaces.
pub(crate) fn has_equal_contacts(model: &LumpedModel) -> bool {
    let conditions = |contact: &Contact| (contact.friction, contact.surface_velocity);
    model.contacts.windows(2).all(|two| conditions(&two[0]) == conditions(&two[1]))
}

/// `true` if a matrix has the same entries, to the last bit, after each degree of freedom takes the place of another
/// one.
pub(crate) fn is_invariant(matrix: &SparseMatrix, place: &dyn Fn(usize) -> usize) -> bool {
    matrix.entries().all(|(i, j, value)| matrix.get(place(i), place(j)) == value)
}

/// One module that moves as all of them do, if the model is a ring of more than one module that are equal but for their
/// masses: its links to the others, which then do not strain, are left out. As the order of assembly leaves no trace,
/// equal modules have equal doubles.
pub(super) fn one_of_equal_modules(model: &LumpedModel) -> Option<LumpedModel> {
    if model.contacts.len() < 2 || !has_contacts_in_place(model) {
        return None;
    }
    let next = |dof: usize| (dof + MODULE_DOFS) % model.dofs();
    let load = &model.load[..MODULE_DOFS];
    let equal = has_equal_contacts(model)
        && model.contacts.iter().all(|contact| contact.gap == model.contacts[0].gap)
        && is_invariant(&model.stiffness, &next)
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
            contacts: vec![model.contacts[0].clone()],
            law: model.law,
        }
    })
}
