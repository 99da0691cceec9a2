//! Limits of the linear answer: the amplitude that a mode of uniform sliding may reach before a contact leaves
//! sliding.

use super::modes::{Mode, largest};
use amontons::contact::ContactState;
use amontons::model::{Equilibrium, LinearModel};
use amontons::stability::singular_values::SingularValues;
use nalgebra::{Complex, DMatrix, DVector};

/// A mode that moves or loads a contact by less than this part of the most that it does anywhere does not reach the contact:
/// rounding of its shape does.
const UNSEEN: f64 = 1e-12;

/// The first contact that a growing mode makes leave sliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearityLimit {
    /// The contact, from 0; the first of those that symmetry makes leave together.
    pub contact: usize,
    /// The state that it enters: where its slip velocity reaches zero it sticks (friction then has
    /// force to spare) or, without friction, slides the other way; where its normal force does, it
    /// detaches. A contact that is open in the equilibrium slides where its gap is gone.
    pub into: ContactState,
    /// Amplitude at which it does, m, of the degree of freedom that moves most.
    pub amplitude: f64,
    /// The degree of freedom of `amplitude`.
    pub dof: usize,
}

/// The smallest amplitude of `mode`, a mode of uniform sliding, at which a contact leaves sliding.
/// The mode is taken as harmonic over a cycle; one that does not oscillate may go either way, and
/// the way that leaves first counts. `None` where it makes no contact leave, or a contact
/// could not be solved for.
#[must_use]
pub fn linearity_limit(
    linear: LinearModel<'_>,
    equilibrium: &Equilibrium,
    mode: &Mode,
) -> Option<LinearityLimit> {
    let model = linear.model();
    let normal = normal_force_amplitudes(linear, equilibrium, mode)?;
    let along = |direction: &amontons::model::Direction| -> Complex<f64> {
        direction.0.iter().map(|&(dof, value)| mode.shape[dof] * value).sum()
    };
    let dof = largest(&mode.shape)?;
    let closed = (0..model.contacts.len()).filter(|contact| equilibrium.is_closed(*contact));
    let first = closed.flat_map(|contact| {
        let rows = &model.contacts[contact];
        let moved = along(&rows.tangent);
        let is_reached = moved.norm() > UNSEEN * mode.shape[dof].norm();
        let speed = if is_reached { (mode.eigenvalue * moved).norm() } else { 0.0 };
        let velocity = rows.surface_velocity;
        let slow = match velocity {
            _ if linear.friction_of(contact).coefficient > 0.0 => ContactState::Stick,
            v if v > 0.0 => ContactState::ReverseSlide,
            _ => ContactState::Slide,
        };
        let slow = (slow, velocity.abs() / speed);
        let open = (ContactState::Detached, equilibrium.normal_force[contact] / normal[contact]);
        // Transitions that the law of contact leaves out do not happen.
        let may = [!model.law.has_fixed_state(), model.law.detachment];
        let happens = [slow, open].into_iter().zip(may).filter_map(|(to, may)| may.then_some(to));
        happens.map(move |(into, amplitude)| LinearityLimit { contact, into, amplitude, dof })
    });
    let open = (0..model.contacts.len()).filter(|contact| !equilibrium.is_closed(*contact));
    let landing = open.map(|contact| {
        let rows = &model.contacts[contact];
        let moved = along(&rows.normal).norm();
        let is_reached = moved > UNSEEN * mode.shape[dof].norm();
        let amplitude = if is_reached { equilibrium.gap[contact] / moved } else { f64::INFINITY };
        LinearityLimit { contact, into: rows.resting_state(), amplitude, dof }
    });
    let all: Vec<LinearityLimit> =
        first.chain(landing).filter(|limit| limit.amplitude.is_finite()).collect();
    let least = all.iter().map(|limit| limit.amplitude).fold(f64::INFINITY, f64::min);
    all.into_iter().find(|limit| limit.amplitude <= least * (1.0 + 1e-9))
}

/// |N| of each contact for the shape as it is, zero for one that is open in the equilibrium:
/// (λ² M + λ C + K) x = Σ (G_N + s µ G_T)ᵀ N.
fn normal_force_amplitudes(
    linear: LinearModel<'_>,
    equilibrium: &Equilibrium,
    mode: &Mode,
) -> Option<Vec<f64>> {
    let model = linear.model();
    let (lambda, dofs) = (mode.eigenvalue, model.dofs());
    let damping = model.damping;
    let pull = |row: usize| -> f64 {
        model.stiffness.row(row).map(|(column, value)| (mode.shape[column] * value).norm()).sum()
    };
    let strongest = (0..dofs).map(pull).fold(0.0, f64::max);
    let mut rest = DVector::from_fn(dofs, |row, _| {
        let times = |matrix: &amontons::model::SparseMatrix| -> Complex<f64> {
            matrix.row(row).map(|(column, value)| mode.shape[column] * value).sum()
        };
        times(&model.mass) * (lambda * lambda + lambda * damping.alpha)
            + times(&model.stiffness) * (lambda * damping.beta + 1.0)
            + times(&model.dampers) * lambda
    });
    for (_, along, coefficient) in linear.friction_damping() {
        let parts = along.0.iter();
        let moved = parts.map(|&(dof, value)| mode.shape[dof] * value).sum::<Complex<f64>>();
        for &(dof, value) in &along.0 {
            rest[dof] += moved * lambda * (coefficient * value);
        }
    }
    let mut forces = DMatrix::<Complex<f64>>::zeros(dofs, model.contacts.len());
    let contacts = model.contacts.iter().zip(model.sliding_ratios()).enumerate();
    for (column, (contact, ratio)) in contacts.filter(|(i, _)| equilibrium.is_closed(*i)) {
        for (direction, factor) in [(&contact.normal, 1.0), (&contact.tangent, ratio)] {
            for &(dof, value) in &direction.0 {
                forces[(dof, column)] += Complex::new(factor * value, 0.0);
            }
        }
    }
    // Least squares, because contacts that carry the same load twice leave their shares open.
    let found = SingularValues::of(forces)?;
    let solved = found.least_squares(&rest, 1e-10 * found.most());
    let size = |force: f64| if force > UNSEEN * strongest { force } else { 0.0 };
    Some(solved.iter().map(|force| size(force.norm())).collect())
}
