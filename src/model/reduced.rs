//! Reduced matrices of a contact state (paper, eq. 3).

use super::{Contact, LinearModel, LumpedModel};
use crate::contact::ContactState;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// The linear equation of motion in the coordinates that a contact state leaves free,
/// M̃ ü + C̃ u̇ + K̃ u = 0 about the equilibrium.
///
/// With V spanning the motions that the closed contacts allow, and U the test directions that
/// their forces do no work on, M̃ = Uᵀ M V and so on. A sliding contact's force acts along
/// G_N ± µ G_T, so U differs from V and the matrices are not symmetric. Friction follows the whole
/// normal force, damping included, so C̃ is reduced like K̃.
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedMatrices {
    /// Reduced mass matrix M̃.
    pub mass: DMatrix<f64>,
    /// Reduced damping matrix C̃.
    pub damping: DMatrix<f64>,
    /// Reduced stiffness matrix K̃.
    pub stiffness: DMatrix<f64>,
    /// Basis V of the motions, n × m: x = V u.
    pub motions: DMatrix<f64>,
}

impl LinearModel<'_> {
    /// The reduced matrices of a contact state, one entry of `states` for each contact. `None` where the contacts leave
    /// a motion or a force undetermined: redundant ones on one mass whose friction differs, such as Sl and R-Sl at the
    /// same place.
    ///
    /// # Panics
    /// Panics if `states` has another length than the model has contacts.
    #[must_use]
    pub fn reduced(self, states: &[ContactState]) -> Option<ReducedMatrices> {
        let model = self.model();
        assert_eq!(states.len(), model.contacts.len(), "one state a contact");
        let dofs = model.dofs();
        let sliding = || model.contacts.iter().zip(states).zip(self.friction());
        let mut forces = Vec::new();
        for ((contact, state), friction) in sliding() {
            let [normal, tangent] = rows(contact);
            if let Some(direction) = state.sliding_direction() {
                let mut force = normal;
                let slope = direction * friction.coefficient;
                subtract(&mut force, -slope, &tangent);
                forces.push(force);
            } else if *state == ContactState::Stick {
                forces.extend([normal, tangent]);
            }
        }
        let motions = model.motions(states);
        let tests = null_space(forces, dofs).transpose();
        if tests.nrows() != motions.ncols() {
            return None;
        }
        let mass = &tests * dense(&model.mass) * &motions;
        let stiffness = &tests * dense(&model.stiffness) * &motions;
        let mut damping = &mass * model.damping.alpha + &stiffness * model.damping.beta;
        if !model.dampers.is_empty() {
            damping += &tests * dense(&model.dampers) * &motions;
        }
        for (contact, direction, coefficient) in self.friction_damping() {
            if states[contact].sliding_direction().is_some() {
                let mut along = DVector::zeros(dofs);
                direction.0.iter().for_each(|&(dof, value)| along[dof] = value);
                damping += (&tests * &along) * (along.transpose() * &motions) * coefficient;
            }
        }
        Some(ReducedMatrices { mass, damping, stiffness, motions })
    }

    /// `true` if damping besides α M + β K acts in a contact state, one entry of `states` for each contact. The modes
    /// of the state then have no common eigenvectors. A damper on masses that contacts hold does nothing.
    #[must_use]
    pub fn has_single_damping_in(self, states: &[ContactState]) -> bool {
        if self.friction_damping().any(|part| states[part.0].sliding_direction().is_some()) {
            return true;
        }
        let model = self.model();
        if model.dampers.is_empty() {
            return false;
        }
        let dampers = dense(&model.dampers);
        let rates = &dampers * model.motions(states);
        rates.amax() > 1e-12 * dampers.amax()
    }
}

impl LumpedModel {
    /// V: a basis, by columns, of the motions that the closed contacts allow.
    fn motions(&self, states: &[ContactState]) -> DMatrix<f64> {
        let mut constraints = Vec::new();
        for (contact, state) in self.contacts.iter().zip(states) {
            let [normal, tangent] = rows(contact);
            match state {
                ContactState::Detached => {}
                ContactState::Stick => constraints.extend([normal, tangent]),
                ContactState::Slide | ContactState::ReverseSlide => constraints.push(normal),
            }
        }
        null_space(constraints, self.dofs())
    }
}

/// G_N and G_T of a contact.
fn rows(contact: &Contact) -> [Row; 2] {
    [&contact.normal, &contact.tangent].map(|direction| direction.0.iter().copied().collect())
}

fn dense(matrix: &super::SparseMatrix) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(matrix.rows(), matrix.rows());
    for (row, column, value) in matrix.entries() {
        dense[(row, column)] = value;
    }
    dense
}

/// A sparse row by columns.
type Row = BTreeMap<usize, f64>;

/// A basis, by columns, of the vectors on which all `rows` vanish: Gauss–Jordan, each row's largest
/// entry its pivot. Rows that depend on others (two sticking contacts on one mass) drop out.
fn null_space(rows: Vec<Row>, size: usize) -> DMatrix<f64> {
    let mut solved: BTreeMap<usize, Row> = BTreeMap::new();
    for mut row in rows {
        let largest = |row: &Row| row.values().fold(0.0_f64, |most, value| most.max(value.abs()));
        let negligible = 1e-12 * largest(&row);
        let known: Vec<usize> = row.keys().copied().filter(|c| solved.contains_key(c)).collect();
        for column in known {
            let factor = row[&column];
            subtract(&mut row, factor, &solved[&column]);
            row.remove(&column);
        }
        row.retain(|_, value| value.abs() > negligible);
        let pivot = row.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some((&column, &pivot)) = pivot else { continue };
        row.values_mut().for_each(|value| *value /= pivot);
        for other in solved.values_mut() {
            if let Some(factor) = other.remove(&column) {
                subtract(other, factor, &row);
                other.remove(&column);
            }
        }
        solved.insert(column, row);
    }
    let free: Vec<usize> = (0..size).filter(|column| !solved.contains_key(column)).collect();
    let mut basis = DMatrix::zeros(size, free.len());
    for (j, column) in free.iter().enumerate() {
        basis[(*column, j)] = 1.0;
    }
    for (pivot, row) in &solved {
        for (column, value) in row {
            if let Ok(j) = free.binary_search(column) {
                basis[(*pivot, j)] = -value;
            }
        }
    }
    basis
}

/// Subtracts `factor` times another row from a row.
fn subtract(row: &mut Row, factor: f64, other: &Row) {
    for (&column, value) in other {
        *row.entry(column).or_insert(0.0) -= factor * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::ContactState::{Detached, Slide, Stick};
    use crate::model::SparseMatrix;
    use crate::scene::builtin;

    fn set1() -> LumpedModel {
        LumpedModel::from(&builtin("set1").unwrap().scene())
    }

    fn reduced(model: &LumpedModel, states: &[ContactState]) -> Option<ReducedMatrices> {
        model.linear().unwrap().reduced(states)
    }

    #[test]
    fn each_state_leaves_the_degrees_of_freedom_that_the_paper_counts() {
        for (states, free) in [([Slide, Slide], 6), ([Slide, Stick], 5), ([Detached, Stick], 6)] {
            assert_eq!(reduced(&set1(), &states).unwrap().stiffness.nrows(), free);
        }
    }

    #[test]
    fn friction_makes_the_stiffness_unsymmetric_and_stick_does_not() {
        let asymmetry = |states| {
            let k = reduced(&set1(), states).unwrap();
            let k = k.mass.try_inverse().unwrap() * k.stiffness;
            // Masses differ, so compare m_i k_ij with m_j k_ji through the frequencies' reality.
            k.complex_eigenvalues().iter().fold(0.0_f64, |worst, value| worst.max(value.im.abs()))
        };
        assert!(asymmetry(&[Slide, Slide]) > 1e3);
        assert!(asymmetry(&[Stick, Stick]) < 1e-6);
    }

    #[test]
    fn redundant_contacts_with_different_friction_determine_no_motion() {
        let mut model = set1().with_friction(0.5);
        model.contacts[1] = model.contacts[0].clone();
        let freedom = |states| Some(reduced(&model, states)?.stiffness.nrows());
        assert_eq!(freedom(&[Slide, Slide]), Some(7));
        assert_eq!(freedom(&[Stick, Stick]), Some(6));
        assert_eq!(freedom(&[Slide, ContactState::ReverseSlide]), None);
    }

    #[test]
    fn a_damper_acts_only_in_states_that_let_its_masses_move() {
        let mut model = set1();
        assert!(!model.linear().unwrap().has_single_damping_in(&[Slide, Slide]));
        // Between the ground and the second mass of module 1, along the surface.
        let place = model.contacts[0].tangent.as_unit().unwrap();
        model.dampers = SparseMatrix::from_entries(model.dofs(), vec![(place, place, 3.0)]);
        assert!(model.linear().unwrap().has_single_damping_in(&[Slide, Stick]));
        assert!(model.linear().unwrap().has_single_damping_in(&[Detached, Stick]));
        assert!(!model.linear().unwrap().has_single_damping_in(&[Stick, Slide]));
    }

    #[test]
    fn a_constraint_given_twice_counts_once() {
        let row = Row::from([(0, 1.0), (1, 2.0)]);
        assert_eq!(null_space(vec![row.clone(), row], 3).ncols(), 2);
    }

    #[test]
    fn the_null_space_of_rows_that_share_columns_is_the_whole_of_it() {
        let rows = [
            Row::from([(0, 1.0), (1, 2.0), (4, -1.0)]),
            Row::from([(1, 3.0), (2, 1.0)]),
            Row::from([(0, 2.0), (1, 1.0), (2, -1.0), (4, -2.0)]),
            Row::from([(0, 1.0), (2, 5.0), (3, 1.0)]),
        ];
        // The third is twice the first less the second.
        let basis = null_space(rows.to_vec(), 5);
        assert_eq!((basis.ncols(), basis.rank(1e-12)), (2, 2));
        for row in &rows {
            for vector in basis.column_iter() {
                let product: f64 = row.iter().map(|(&column, value)| value * vector[column]).sum();
                assert!(product.abs() < 1e-14);
            }
        }
    }
}
