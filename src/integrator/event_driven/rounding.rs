//! Rounding budgets: the magnitudes relative to which values count as zero.

use super::EventDriven;
use super::ledger::Witness;
use crate::integrator::Motion;
use crate::integrator::dynamics::Dynamics;
use crate::model::{Direction, SparseMatrix};
use crate::numerics::max_norm;

/// Relative budget below which a value counts as zero: the rounding of some dozens of operations.
pub(super) const NOISE: f64 = 1e-13;
/// Smallest velocity with which an impact throws a contact off, as a part of the fastest velocity; less is rounding.
pub(super) const THROWN: f64 = 1e-11;
/// Loss of a difference by rounding, as a part of its terms and of [`NOISE`].
pub(super) const DIFFERENCE: f64 = 0.02;
/// Number of events of one contact at one instant above which each further one doubles [`NOISE`] for it.
const UNDOUBTED: u32 = 2;
/// Largest number of doublings of [`NOISE`].
const MOST_DOUBLINGS: u32 = 12;

/// A contact with more landings than this in one internal step is about to come to rest.
const MANY_LANDINGS: u32 = 16;
/// Largest number of times that the least hop grows fourfold: to 1.05e-5 of the fastest velocity.
const MOST_GROWTHS: u32 = 10;

/// The opening velocity after an impact that is a hop of its own, as a part of the fastest velocity, for a contact that
/// has landed this often in the present internal step.
///
/// Contacts of one body throw each other off in ever smaller hops, infinitely many within a finite time. Followed down to
/// [`THROWN`], their number grows with a high power of the number of contacts. So hops that come after many others have
/// to be larger: [`THROWN`] · 4^(landings − [`MANY_LANDINGS`]). A hop that is ended changes velocities by no more than
/// its own; in a shorter step a contact lands less often, and fewer hops are ended.
pub(super) fn least_hop(landings: u32) -> f64 {
    let growths = landings.saturating_sub(MANY_LANDINGS).min(MOST_GROWTHS);
    THROWN * f64::from(1_u32 << (2 * growths))
}

impl<W: Witness> EventDriven<W> {
    /// The fastest velocity, m/s, as the scale of the rounding of velocities.
    pub(super) fn speed(&self, motion: &Motion) -> f64 {
        max_norm(&motion.velocity).max(self.slowest())
    }

    /// Scale of velocities where all masses are at rest, m/s: a contact thrown off with [`THROWN`] of it is back within
    /// the last digit of a step.
    pub(super) fn slowest(&self) -> f64 {
        f64::EPSILON / THROWN * self.gained
    }

    /// The largest acceleration that outer forces (N) give a mass, m/s². A load and a signal that balance each other
    /// are rounded separately, so the load alone counts too.
    pub(super) fn shaken(&self, force: &[f64]) -> f64 {
        self.dynamics.fastest_driven(force).max(self.loaded)
    }

    /// Factor on the budget of rounding at a contact. Where the sign of a difference is decided by rounding, two states
    /// may each lead to the other at one instant: the factor is doubled until the true changes of the difference
    /// decide.
    pub(super) fn doubt(&self, contact: usize) -> f64 {
        let often = self.repeats[contact].saturating_sub(UNDOUBTED);
        f64::from(1_u32 << often.min(MOST_DOUBLINGS))
    }

    /// Scale of the rounding of an acceleration along the normal (0) or the tangent (1) of a contact at these
    /// displacements (m), m/s², in parts of [`NOISE`]: the sum of the magnitudes of the spring terms. Where these
    /// balance each other, it is far larger than the accelerations of the masses.
    pub(super) fn pulled(&self, contact: usize, row: usize, place: &[f64]) -> f64 {
        let terms = self.pulls[contact][row].0.iter().map(|&(dof, pull)| pull * place[dof].abs());
        DIFFERENCE * terms.fold(0.0, |sum, term| sum + term)
    }

    /// The contact forces that would cause the accelerations of [`pulled`](Self::pulled) along the normal and the
    /// tangent, added, N.
    pub(super) fn pulled_forces(&self, contact: usize, place: &[f64]) -> f64 {
        let own = self.dynamics.problem.delassus.own(contact);
        let force = |row: usize| {
            // A mass does not move along a locked direction.
            if own[3 * row] > 0.0 { self.pulled(contact, row, place) / own[3 * row] } else { 0.0 }
        };
        force(0) + force(1)
    }
}

/// |G M⁻¹ K| along normal and tangent of each contact.
pub(super) fn pulls(dynamics: &Dynamics) -> Vec<[Direction; 2]> {
    let dofs = dynamics.acceleration.len();
    let along = |response: &Direction| {
        let terms = response.0.iter().flat_map(|&(dof, response)| {
            dynamics.stiffness.row(dof).map(move |(other, k)| (other, 0, (response * k).abs()))
        });
        let column = SparseMatrix::from_entries(dofs, terms.collect());
        Direction(column.entries().map(|(dof, _, value)| (dof, value)).collect())
    };
    dynamics.responses.iter().map(|two| two.each_ref().map(along)).collect()
}

/// A time scale of the fastest oscillation of the masses on their springs, s; zero without springs. For a diagonal mass
/// matrix it is a lower bound of 1/ω.
pub(super) fn shortest(dynamics: &Dynamics) -> f64 {
    let square = |dof: usize| {
        let pulls = dynamics.stiffness.row(dof).fold(0.0, |sum, (_, k)| sum + k.abs());
        pulls * dynamics.inverse_mass.get(dof, dof)
    };
    let largest = (0..dynamics.acceleration.len()).map(square).fold(0.0, f64::max);
    if largest > 0.0 { 1.0 / largest.sqrt() } else { 0.0 }
}
