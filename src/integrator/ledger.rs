//! The energy ledger: sources and sinks of the energy of a motion.
//!
//! Displacements count from the reference position, whose contact forces λ₀ balance the load there. Of impulses
//! P = (P_N, P_T) of a contact, along which the masses have the mean velocities u_N and u_T while the slider has v,
//!
//! | entry, J | is |
//! | --- | --- |
//! | kinetic | ½ ẋᵀ M ẋ |
//! | elastic | ½ xᵀ K x + x·Gᵀ λ₀, of springs and constant loads, less what they have in the reference position |
//! | damping | ∫ ẋᵀ C ẋ dt |
//! | friction | Σ P_T (v − u_T), of impacts too |
//! | impact | −Σ P_N u_N, zero except where a contact lands |
//! | slider | Σ P_T v, the work of the sliders on the masses |
//! | forces | the work of external forces, and of loads so far as they have changed |
//! | residual | (kinetic + elastic) − those at the start − slider − forces + damping + friction + impact |
//!
//! The entries from damping to forces accumulate since the start. The integrators themselves contain no part of the
//! ledger: each has a variant that writes the ledger of its motion and is made only on request
//! ([`choose_recording`](super::choose_recording)).

use super::Motion;
use crate::model::{Equilibrium, LumpedModel, SparseMatrix};
use serde::{Deserialize, Serialize};

/// Work done and energy dissipated since the start of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Gᵀ λ₀, N, one value for each degree of freedom: the part of a drive's forces that the elastic energy includes.
    pub(super) balance: Vec<f64>,
    /// Kinetic and elastic energy at the start, J.
    start: f64,
    pub(super) damping: f64,
    pub(super) friction: f64,
    pub(super) impact: f64,
    pub(super) slider: f64,
    pub(super) forces: f64,
}

/// The energy of a motion, J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    /// Kinetic energy of the masses at this instant, J.
    pub kinetic: f64,
    /// Elastic energy of springs and constant loads at this instant, J; zero in the reference position.
    pub elastic: f64,
    /// Energy dissipated by damping since the start, J.
    pub damping: f64,
    /// Energy dissipated by friction since the start, J, in impacts too.
    pub friction: f64,
    /// Energy dissipated by normal impulses of impacts since the start, J.
    pub impact: f64,
    /// Work of the sliders on the masses since the start, J.
    pub slider: f64,
    /// Work of external forces and of changed loads since the start, J.
    pub forces: f64,
    /// Residual of the energy balance, J.
    pub residual: f64,
}

impl Energy {
    /// All entries, in the order of the catalogue of variables.
    #[must_use]
    pub fn parts(&self) -> [f64; 8] {
        let &Self { kinetic, elastic, damping, friction, impact, slider, forces, residual } = self;
        [kinetic, elastic, damping, friction, impact, slider, forces, residual]
    }
}

impl Ledger {
    /// The ledger of a motion that starts now, measured from an equilibrium of the model.
    #[must_use]
    pub fn new(model: &LumpedModel, reference: &Equilibrium, motion: &Motion) -> Self {
        let mut balance = vec![0.0; model.dofs()];
        let forces = reference.normal_force.iter().zip(&reference.friction_force);
        for (contact, (&normal, &friction)) in model.contacts.iter().zip(forces) {
            contact.normal.add_to(&mut balance, normal);
            contact.tangent.add_to(&mut balance, friction);
        }
        let [kinetic, elastic] = present(model, &balance, motion);
        Self {
            balance,
            start: kinetic + elastic,
            damping: 0.0,
            friction: 0.0,
            impact: 0.0,
            slider: 0.0,
            forces: 0.0,
        }
    }

    /// The energy of the motion to which the ledger belongs.
    #[must_use]
    pub fn energy(&self, model: &LumpedModel, motion: &Motion) -> Energy {
        let &Self { start, damping, friction, impact, slider, forces, .. } = self;
        let [kinetic, elastic] = present(model, &self.balance, motion);
        let supplied = slider + forces;
        let dissipated = damping + friction + impact;
        let residual = (kinetic + elastic - start) - (supplied - dissipated);
        Energy { kinetic, elastic, damping, friction, impact, slider, forces, residual }
    }

    /// Gᵀ λ₀, N, the forces of the contacts in the reference position; one value for each degree of freedom.
    #[must_use]
    pub fn balance(&self) -> &[f64] {
        &self.balance
    }

    /// Number of degrees of freedom of the model to which the ledger belongs.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.balance.len()
    }

    /// Adds the work of the impulses (normal, tangential; N s) of a contact, along which the masses have these mean
    /// velocities and the slider has this one, m/s.
    pub(super) fn add_impulses(
        &mut self,
        [normal, tangential]: [f64; 2],
        [approach, along]: [f64; 2],
        surface: f64,
    ) {
        self.impact -= normal * approach;
        self.friction += tangential * (surface - along);
        self.slider += tangential * surface;
    }
}

/// Returns the present kinetic and elastic energy, J.
fn present(model: &LumpedModel, balance: &[f64], motion: &Motion) -> [f64; 2] {
    let (x, v) = (&*motion.displacement, &*motion.velocity);
    let held = x.iter().zip(balance).fold(0.0, |sum, (x, balance)| sum + x * balance);
    [half_form(&model.mass, v), half_form(&model.stiffness, x) + held]
}

/// Returns ½ uᵀ A u.
pub(super) fn half_form(matrix: &SparseMatrix, u: &[f64]) -> f64 {
    (0..u.len()).fold(0.0, |sum, row| sum + 0.5 * u[row] * matrix.row_times(row, u))
}
