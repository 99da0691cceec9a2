//! The forward increment Lagrange multiplier method (paper, section 2.2, eqs. 7–24).
//!
//! With the lagged velocity ẋ_n = (x_n − x_{n−1})/h of eq. (12) the scheme is a one-step map:
//!
//! * predictor, eq. (13): ẋ* = ẋ_n + h M⁻¹ (F − C ẋ_n − K x_n);
//! * multipliers, eqs. (15), (16): normal force N from x_N = 0 where the predictor penetrates,
//!   friction T from ẋ_T = v, cut off at |T| ≤ µ N;
//! * corrector, eqs. (17), (18): ẋ_{n+1} = ẋ* + h M⁻¹ Gᵀ (N, T), x_{n+1} = x_n + h ẋ_{n+1}.
//!
//! It is of first order: events fall on the grid and damping lags by a step. Without damping it
//! keeps E − ½ h xᵀ K ẋ. A touch-down is a perfectly inelastic impact; its multiplier is the
//! impulse over h, so the forces that a user reads come from `contact_forces` instead.
//!
//! Three structures share the scheme: [`RingForwardIncrement`] for rings of modules, whose Delassus matrix G M⁻¹ Gᵀ is
//! diagonal, so that Gauss–Seidel converges after one iteration; [`dense`] for a few degrees of freedom; [`sparse`] for
//! any other structure.

mod general;
mod ledger;
mod ring;

use super::Kernel;

pub(super) use general::faster;
pub use general::{dense, sparse};
pub(super) use ledger::WithLedger;
pub use ring::RingForwardIncrement;

/// All kernels of the scheme.
pub(super) fn kernels() -> Vec<Kernel> {
    [ring::kernels(), general::kernels()].concat()
}
