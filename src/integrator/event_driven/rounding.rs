//! Rounding budgets: the magnitudes below which values count as zero.
//!
//! A sign that rounding decides would make a contact change its state without a reason. So values are compared with
//! budgets: magnitudes of the terms that they are sums of, times a factor. These are the magnitudes of one contact
//! over a series of span τ (s) with the powers c_k (m); |c_k|∞ is the largest of one power.
//!
//! ```text
//! d   = 2^min(n − 2, 12) for n > 2, else 1; n: events that the contact has had at this instant     [rounding_factor]
//! A   = 2 |c_2|∞ / τ²                        largest acceleration at the beginning, m/s²
//! L_r = Σ_j |G_r M⁻¹ K|_j |x_j|              magnitudes of the spring terms along r = N or T, m/s²
//! A_F                                        acceleration by outer forces, m/s²                    [driven]
//! S   = d (max(|N_0|, A / W_NN) + 0.02 (L_N / W_NN + L_T / W_TT))                                   N
//! e_k = 0.02 |c_k|∞                          if any contact holds differences of displacements or has a gap g in the
//!                                            reference position, else 0, m
//! B   = d (A τ² + 0.02 τ² (L_N + A_F) + e_1)                                                        m
//! D   = max(d τ v_max, d A τ² + (1 + µ_s) S (W_TT + µ_s |W_NT|) τ²) + d e_1                         m
//! V   = max(|ẋ|∞ since the instant began, 2.2e-5 h A_F)                                             m/s
//! ```
//!
//! v_max is the largest speed of the surface in the step, and A_F, where h is its factor, leaves out the phase of
//! waves. A sum of terms keeps all but 0.02 · 1e-13 = 2e-15 = 9 ε of them ([`DIFFERENCE`]).
//!
//! | value | counts as zero up to |
//! | --- | --- |
//! | N (`Lift`), each power | 1e-13 S |
//! | µ_s N ∓ T (`Slip`), each power | 1e-13 (1 + µ_s) S |
//! | τ v_r (`Stop`, `Leave`), each power | 1e-13 D |
//! | gap (`Touch`): powers from the second on | 1e-13 B |
//! | its slope, G_N c_1 | the smaller of 1e-13 B and 0.5e-11 max(\|c_1\|∞, 2.2e-5 h A_F τ) |
//! | its value, g + G_N c_0 | that of the slope + 1e-13 d e_0 |
//! | \|G_N c_2\| of a closed contact (`Part`) | d (1e-10 τ² (A + L_N + A_F) + 1e-13 e_0) |
//! | v_r at the beginning of a step | 1e-13 max(v_max, Σ \|t_j ẋ_j\|, h A_F), with the terms t_j ẋ_j of G_T ẋ |
//! | v_r after an impact | 1e-13 max(V, v_max) |
//! | opening velocity after an impact | 1e-11 V, more after many landings ([`least_hop`]) |
//!
//! The slope of a gap counts from 0.5e-11 of the fastest velocity on, half of what throws a contact off in an impact: a
//! contact that was thrown off opens. The budgets leave out the forces of dampers, and A_F is that at the beginning of
//! the step, so a force that grows much within one step has a budget that is too small.

use super::EventDriven;
use super::ledger::MotionObserver;
use crate::integrator::Motion;
use crate::integrator::dynamics::Dynamics;
use crate::model::{Direction, SparseMatrix};
use crate::numerics::max_norm;

/// Relative budget below which a value counts as zero: the rounding of some dozens of operations.
pub(super) const NOISE: f64 = 1e-13;
/// Smallest velocity with which an impact throws a contact off, as a part of the fastest velocity; less is rounding.
/// It is the relative tolerance of the contact problem where W is nearly singular.
pub(super) const THROWN: f64 = 1e-11;
/// Loss of a difference by rounding, as a part of its terms, in parts of [`NOISE`]: 2e-15, or 9 ε.
pub(super) const DIFFERENCE: f64 = 0.02;
/// Number of events of one contact at one instant above which each further one doubles [`NOISE`] for it.
const UNDOUBTED: u32 = 2;
/// Largest number of doublings of [`NOISE`].
const MOST_DOUBLINGS: u32 = 12;

/// A contact with more landings than this in one internal step is about to come to rest.
const MANY_LANDINGS: u32 = 16;
/// Number of contacts of a group up to which each counts its own landings alone.
const FEW_TOGETHER: u32 = 8;
/// Largest number of times that the least hop grows fourfold: to 1.05e-5 of the fastest velocity.
const MOST_GROWTHS: u32 = 10;

/// The opening velocity after an impact that is a hop of its own, as a part of the fastest velocity, for a contact that
/// has landed this often in the present internal step, the present landing included.
///
/// Contacts of one body throw each other off in ever smaller hops, infinitely many within a finite time. Followed down to
/// [`THROWN`], their number grows with a high power of the number of contacts. So hops that come after many others have
/// to be larger: at the n-th landing in the step, [`THROWN`] · 4^min(n − 16, 10) for n > 16. A hop that is ended
/// changes velocities by no more than its own ([`landings_together`] says which landings count); in a shorter step a contact lands less often, and fewer hops are
/// ended.
pub(super) fn least_hop(landings: u32) -> f64 {
    let growths = landings.saturating_sub(MANY_LANDINGS).min(MOST_GROWTHS);
    THROWN * f64::from(1_u32 << (2 * growths))
}

/// The landings that count for each contact of a group, at least, in place of its own: m/64 of all landings in the group if it has
/// m > 8 contacts.
///
/// One landing on a body with a hundred contacts throws many of them off by next to nothing, each of which throws off others when
/// it lands, and hardly any contact lands often. With 8 contacts the count would be that of the mean contact.
pub(super) fn landings_together(landings: impl ExactSizeIterator<Item = u32>) -> u32 {
    let contacts = u32::try_from(landings.len()).unwrap_or(u32::MAX);
    if contacts <= FEW_TOGETHER {
        return 0;
    }
    landings.sum::<u32>().saturating_mul(contacts) / (FEW_TOGETHER * FEW_TOGETHER)
}

impl<W: MotionObserver> EventDriven<W> {
    /// The fastest velocity, m/s, as the scale of the rounding of velocities.
    pub(super) fn speed(&self, motion: &Motion) -> f64 {
        max_norm(&motion.velocity).max(self.slowest())
    }

    /// Scale of velocities where all masses are at rest, m/s. A contact that is thrown off with [`THROWN`] of it, ε h
    /// a, against the acceleration a = `gained` / h, is back after 2 ε h, the last digit of a step.
    pub(super) fn slowest(&self) -> f64 {
        f64::EPSILON / THROWN * self.gained
    }

    /// The largest acceleration that outer forces (N) give a mass, m/s². A load and a signal that balance each other
    /// are rounded separately, so the load alone counts too.
    pub(super) fn load_acceleration(&self, force: &[f64]) -> f64 {
        self.dynamics.fastest_driven(force).max(self.loaded)
    }

    /// Factor on the budget of rounding at a contact. Where the sign of a difference is decided by rounding, two states
    /// may each lead to the other at one instant: the factor is doubled until the true changes of the difference
    /// decide.
    pub(super) fn rounding_factor(&self, contact: usize) -> f64 {
        let often = self.repeats[contact].saturating_sub(UNDOUBTED);
        f64::from(1_u32 << often.min(MOST_DOUBLINGS))
    }

    /// Scale of the rounding of an acceleration along the normal (0) or the tangent (1) of a contact at these
    /// displacements (m), m/s², in parts of [`NOISE`]: [`DIFFERENCE`] times the sum of the magnitudes of the spring
    /// terms. Where these balance each other, it is far larger than the accelerations of the masses.
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
        if dynamics.stiffness.is_full() {
            // The terms of one place need not be sorted: rounding of a budget is nothing.
            let mut sums = vec![0.0; dofs];
            for &(dof, response) in &response.0 {
                dynamics
                    .stiffness
                    .row(dof)
                    .for_each(|(other, k)| sums[other] += (response * k).abs());
            }
            let parts = sums.into_iter().enumerate().filter(|part| part.1 != 0.0);
            return Direction(parts.collect());
        }
        let terms = response.0.iter().flat_map(|&(dof, response)| {
            dynamics.stiffness.row(dof).map(move |(other, k)| (other, 0, (response * k).abs()))
        });
        let column = SparseMatrix::from_entries(dofs, terms.collect());
        Direction(column.entries().map(|(dof, _, value)| (dof, value)).collect())
    };
    dynamics.responses.iter().map(|two| two.each_ref().map(along)).collect()
}

/// A time scale of the fastest oscillation of the masses on their springs, s; zero without springs: 1 / √(max_i
/// (M⁻¹)_ii Σ_j |K_ij|). For a diagonal mass matrix the root is a row sum of M⁻¹ K, and so an upper bound of all ω
/// (Gershgorin).
pub(super) fn shortest(dynamics: &Dynamics) -> f64 {
    let square = |dof: usize| {
        let pulls = dynamics.stiffness.row(dof).fold(0.0, |sum, (_, k)| sum + k.abs());
        pulls * dynamics.inverse_mass.get(dof, dof)
    };
    let largest = (0..dynamics.acceleration.len()).map(square).fold(0.0, f64::max);
    if largest > 0.0 { 1.0 / largest.sqrt() } else { 0.0 }
}
