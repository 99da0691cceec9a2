//! How an eigenvalue of a contact state changes with friction.
//!
//! With the forces of closed contacts as further unknowns, the problem of eq. (3) reads P(λ) z = 0 with
//!
//! P = [λ² M + λ C + K, −F; Gᵀ, 0],
//!
//! where G has the directions that contacts hold and F those of their forces, G_N ± µ G_T of one that slides. In
//! this form all is linear in friction, and with yᴴ P = 0 the change is dλ = −yᴴ dP z / yᴴ P' z. Modes that share an
//! eigenvalue without coalescing (those of equal parts) part by the eigenvalues of −(Yᴴ P' Z)⁻¹ Yᴴ dP Z, Y and Z being
//! all such vectors.

use super::singular_values::SingularValues;
use crate::contact::ContactState;
use crate::model::{Direction, LumpedModel, SparseMatrix};
use nalgebra::{Complex, DMatrix};

type Matrix = DMatrix<Complex<f64>>;

/// What friction of a contact changes by where it slides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlidingChange {
    /// Of µ.
    pub friction: f64,
    /// Of what friction adds to damping along the tangent, N s/m.
    pub weakening: f64,
}

/// What an eigenvalue λ, 1/s, of a contact state changes by; of several modes that share it, the change of the one
/// that grows most. `None` where it has no derivative, as two modes coalesce, or where the contacts leave forces
/// undetermined.
#[must_use]
pub fn eigenvalue_change(
    model: &LumpedModel,
    states: &[ContactState],
    friction: f64,
    eigenvalue: Complex<f64>,
    changes: &[SlidingChange],
) -> Option<Complex<f64>> {
    let contacts = model.contacts.iter().zip(states).zip(changes);
    let (mut matrix, mut by_eigenvalue, unit) = masses(model, eigenvalue, states);
    let mut by_friction = by_eigenvalue.map(|_| Complex::ZERO);
    let mut held = model.dofs();
    for ((contact, state), change) in contacts {
        let mut hold = |direction: &Direction, forces: &[(&Direction, f64)]| {
            for &(dof, value) in &direction.0 {
                matrix[(held, dof)] += unit * value;
            }
            for (direction, size) in forces {
                for &(dof, value) in &direction.0 {
                    matrix[(dof, held)] -= unit * size * value;
                }
            }
            held += 1;
            held - 1
        };
        let (normal, tangent) = (&contact.normal, &contact.tangent);
        if let Some(direction) = state.sliding_direction() {
            let slope = direction * contact.friction(friction);
            let force = hold(normal, &[(normal, 1.0), (tangent, slope)]);
            for &(dof, value) in &tangent.0 {
                by_friction[(dof, force)] -=
                    Complex::from(unit * direction * change.friction * value);
            }
            let weakening = contact.weakening();
            for (&(row, a), &(column, b)) in pairs(tangent) {
                matrix[(row, column)] += eigenvalue * (weakening * a * b);
                by_eigenvalue[(row, column)] += Complex::from(weakening * a * b);
                by_friction[(row, column)] += eigenvalue * (change.weakening * a * b);
            }
        } else if *state == ContactState::Stick {
            hold(normal, &[(normal, 1.0)]);
            hold(tangent, &[(tangent, 1.0)]);
        }
    }
    let (left, right) = null_spaces(matrix)?;
    let along = |matrix: &Matrix| left.ad_mul(&(matrix * &right));
    let gain = along(&by_eigenvalue);
    // Where two modes coalesce, left and right vectors are at right angles.
    let weakest = SingularValues::of(gain.clone())?.least();
    if weakest <= COALESCENCE * by_eigenvalue.norm() {
        return None;
    }
    let changes = gain.lu().solve(&along(&by_friction))?.eigenvalues()?;
    let changes = changes.iter().map(|change| -change);
    changes.reduce(|fastest, other| if other.re > fastest.re { other } else { fastest })
}

/// A part of P' below which two modes are one.
const COALESCENCE: f64 = 1e-9;
/// A part of P below which it takes a vector to nothing.
const NOTHING: f64 = 1e-11;

/// λ² M + λ C + K and its derivative by λ, with room for what contacts hold, and the largest stiffness, the unit of
/// that.
fn masses(
    model: &LumpedModel,
    eigenvalue: Complex<f64>,
    states: &[ContactState],
) -> (Matrix, Matrix, f64) {
    let held: usize = states
        .iter()
        .map(|state| match state {
            ContactState::Slide | ContactState::ReverseSlide => 1,
            ContactState::Stick => 2,
            ContactState::Detached => 0,
        })
        .sum();
    let size = model.dofs() + held;
    let mut matrix = Matrix::zeros(size, size);
    let mut by_eigenvalue = matrix.clone();
    let (alpha, beta) = (model.damping.alpha, model.damping.beta);
    let one = Complex::from(1.0);
    let squared = eigenvalue * eigenvalue;
    let parts: [(&SparseMatrix, Complex<f64>, Complex<f64>); 3] = [
        (&model.mass, squared + eigenvalue * alpha, eigenvalue * 2.0 + alpha),
        (&model.stiffness, one + eigenvalue * beta, one * beta),
        (&model.dampers, eigenvalue, one),
    ];
    for (part, factor, derivative) in parts {
        for (row, column, value) in part.entries() {
            matrix[(row, column)] += factor * value;
            by_eigenvalue[(row, column)] += derivative * value;
        }
    }
    let stiffest = model.stiffness.entries().fold(0.0_f64, |most, entry| most.max(entry.2.abs()));
    (matrix, by_eigenvalue, if stiffest > 0.0 { stiffest } else { 1.0 })
}

fn pairs(direction: &Direction) -> impl Iterator<Item = (&(usize, f64), &(usize, f64))> {
    direction.0.iter().flat_map(|row| direction.0.iter().map(move |column| (row, column)))
}

/// The vectors, by columns, that a singular matrix takes to nothing from the left and from the right; at least one
/// each.
fn null_spaces(matrix: Matrix) -> Option<(Matrix, Matrix)> {
    let left = SingularValues::of(matrix.adjoint())?;
    let right = SingularValues::of(matrix)?;
    let nothing = NOTHING * right.most();
    let count = right.values().iter().filter(|&&value| value <= nothing).count().max(1);
    Some((left.least_vectors(count), right.least_vectors(count)))
}
