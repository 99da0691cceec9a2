//! The critical step of structures whose mass matrix is full, from a few contact states.
//!
//! A hundred contacts that share masses have too many states to examine, and where the mass matrix is full no bound over all of them
//! is known. Two kinds of states are examined in their place. Those in which all contacts are alike: contacts that hold lower
//! frequencies, so all open has the highest ones without friction, and all slide adds what friction does. And that of the equilibrium,
//! in which a run begins and in which it stays where it dies out; the load may leave some of its contacts open. Any other state may
//! have higher frequencies, or modes that the scheme lets grow.

use super::complex::modulus;
use super::critical_step::{coarse_limit, squares, state_admits};
use super::eigenvalues::eigenvalues;
use super::reduced_problem::check_size;
use crate::Error;
use crate::contact::ContactState;
use crate::decimal::to_significant;
use crate::model::{LinearModel, LumpedModel};

/// Digits that do not depend on the machine.
const DIGITS: usize = 6;

/// The states in which all contacts are alike, of which there is one where there is no contact, and that of the equilibrium where
/// there is one.
fn states(model: &LumpedModel) -> Vec<Vec<ContactState>> {
    let kinds = if model.contacts.is_empty() { 1 } else { ContactState::ALL.len() };
    let allowed = ContactState::ALL.into_iter().take(kinds);
    let allowed = allowed.filter(|state| kinds == 1 || model.law.allows(*state));
    let mut states: Vec<_> = allowed.map(|state| vec![state; model.contacts.len()]).collect();
    states.extend(at_rest(model).filter(|found| !states.contains(found)));
    states
}

/// The state of the equilibrium; `None` where there is none.
pub(super) fn at_rest(model: &LumpedModel) -> Option<Vec<ContactState>> {
    let found = model.equilibrium(&|contact| contact.to_string());
    found.ok().map(|found| found.states(model))
}

/// A step, s, that all these states admit; a larger one is not known.
///
/// # Errors
/// Returns an error if the model is too large, or if the eigenvalues of a state are not found.
pub(super) fn critical(linear: LinearModel<'_>) -> Result<f64, Error> {
    let model = linear.model();
    check_size(model)?;
    let limits = states(model).into_iter().map(|states| coarse_limit(linear, &states));
    let least = limits.reduce(|a, b| Ok(a?.min(b?))).unwrap_or(Ok(f64::INFINITY))?;
    Ok(to_significant(least, DIGITS))
}

/// `true` if all these states admit a step (s).
pub(super) fn admit(step: f64, linear: LinearModel<'_>) -> bool {
    let model = linear.model();
    check_size(model).is_ok()
        && states(model).iter().all(|states| state_admits(step, linear, states).unwrap_or(false))
}

/// The highest frequency without contacts, rad/s; `None` where it is not found.
pub(super) fn frictionless(model: &LumpedModel) -> Option<f64> {
    check_size(model).ok()?;
    let open = vec![ContactState::Detached; model.contacts.len()];
    let found = squares(model.with_greatest_friction(), &open, eigenvalues).ok()?;
    let most = found.into_iter().fold(0.0, |most, s| f64::max(most, modulus(s)));
    Some(to_significant(most.sqrt(), DIGITS))
}
