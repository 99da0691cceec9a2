//! Sizes of modes of structures whose mass matrix is full, from a few contact states.
//!
//! A hundred contacts that share masses have too many states to examine, and where the mass matrix is full no bound over all of them
//! is known. The states in which all contacts are alike are examined in their place: contacts that hold lower frequencies, so all open
//! has the highest ones without friction, and all slide adds what friction does. A state that nearly jams may have higher ones.

use super::complex::modulus;
use super::critical_step::squares;
use super::eigenvalues::eigenvalues;
use super::frequency_bound::{Ellipse, Sizes};
use super::reduced_problem::check_size;
use crate::contact::ContactState;
use crate::decimal::to_significant;
use crate::model::{Contact, LinearModel, LumpedModel, SlidingFriction, SparseMatrix};
use nalgebra::{Cholesky, Complex, DMatrix};

/// Digits that do not depend on the machine.
const DIGITS: usize = 6;
/// Friction beyond the present one for which states are examined ahead, as a part of it, and added to that.
const ROOM: f64 = 0.1;
const LEAST_ROOM: f64 = 0.01;

/// The sizes of the modes of the states in which all contacts are alike.
#[derive(Clone, Debug)]
pub(super) struct AlikeStates {
    sizes: Sizes,
    /// Friction of each contact in these states.
    friction: Vec<f64>,
}

impl AlikeStates {
    /// The sizes with the present friction; `None` where they are not found, or only in minutes.
    pub(super) fn of(linear: LinearModel<'_>) -> Option<Self> {
        let model = linear.model();
        check_size(model).ok()?;
        let mut found = Vec::new();
        // Without contacts all states are one.
        let states = if model.contacts.is_empty() { 1 } else { ContactState::ALL.len() };
        for state in ContactState::ALL.into_iter().take(states) {
            if states == 1 || model.law.allows(state) {
                found.extend(squares_of(linear, state)?);
            }
        }
        let friction = linear.friction().map(|friction| friction.coefficient).collect();
        let most = found.iter().fold(0.0, |most, s| f64::max(most, modulus(*s)));
        let ellipse = Ellipse::around(&found);
        let dampers = norm(&model.dampers, &model.mass)?;
        Some(Self {
            sizes: Sizes { square: to_significant(most, DIGITS), dampers, ellipse },
            friction,
        })
    }

    /// The sizes with somewhat more than the present friction, so that they hold while µ grows a little.
    pub(super) fn with_room(model: &LumpedModel) -> Option<Self> {
        let mut rougher = model.clone();
        let more = |coefficient: f64| (1.0 + ROOM) * coefficient + LEAST_ROOM;
        for Contact { friction, .. } in &mut rougher.contacts {
            (friction.kinetic, friction.static_) = (more(friction.kinetic), more(friction.static_));
        }
        Self::of(rougher.with_greatest_friction())
    }

    /// `true` if no contact of this model has more friction than the states that were examined. The model is otherwise the one
    /// that the sizes were made for.
    pub(super) fn cover(&self, linear: LinearModel<'_>) -> bool {
        let is_less = |(now, most): (SlidingFriction, &f64)| now.coefficient <= *most;
        linear.friction().zip(&self.friction).all(is_less)
    }

    /// The sizes with the friction of this model, which is otherwise the one that they were made for.
    pub(super) fn at(&self, linear: LinearModel<'_>) -> Sizes {
        if self.cover(linear) {
            return self.sizes;
        }
        let unknown = Sizes { square: f64::INFINITY, dampers: f64::INFINITY, ellipse: None };
        Self::of(linear).map_or(unknown, |new| new.sizes)
    }

    /// Ratio of the size of the dampers to that of the stiffness, s.
    pub(super) fn dampers_against_stiffness(&self) -> f64 {
        let Sizes { square, dampers, .. } = self.sizes;
        if dampers == 0.0 { 0.0 } else { dampers / square }
    }
}

/// The highest frequency without contacts, rad/s; `None` where it is not found.
pub(super) fn frictionless(model: &LumpedModel) -> Option<f64> {
    check_size(model).ok()?;
    let found = squares_of(model.with_greatest_friction(), ContactState::Detached)?;
    let most = found.into_iter().fold(0.0, |most, s| f64::max(most, modulus(s)));
    Some(to_significant(most.sqrt(), DIGITS))
}

/// The eigenvalues s of M̃⁻¹ K̃ with all contacts in one state, 1/s².
fn squares_of(linear: LinearModel<'_>, state: ContactState) -> Option<Vec<Complex<f64>>> {
    let states = vec![state; linear.model().contacts.len()];
    squares(linear, &states, eigenvalues).ok()
}

/// ‖M^-½ A M^-½‖; `None` where M is not positive definite.
fn norm(matrix: &SparseMatrix, mass: &SparseMatrix) -> Option<f64> {
    if matrix.is_empty() {
        return Some(0.0);
    }
    let dense = |matrix: &SparseMatrix| {
        let mut dense = DMatrix::zeros(matrix.rows(), matrix.rows());
        matrix.entries().for_each(|(row, column, value)| dense[(row, column)] = value);
        dense
    };
    let lower = Cholesky::new(dense(mass))?.l();
    let half = lower.solve_lower_triangular(&dense(matrix))?;
    let scaled = lower.solve_lower_triangular(&half.transpose())?;
    let squares = eigenvalues(scaled.tr_mul(&scaled))?;
    let most = squares.into_iter().fold(0.0, |most, s| f64::max(most, s.re));
    Some(to_significant(most.sqrt(), DIGITS))
}
