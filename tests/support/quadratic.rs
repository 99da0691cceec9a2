//! The paper's own way to the eigenvalues of a contact state, which the analyser does not go.

use amontons::contact::ContactState;
use amontons::model::LumpedModel;
use nalgebra::{Complex, DMatrix};

/// All eigenvalues, 1/s, by eqs. (4)–(6) as they stand: the quadratic problem made linear, twice
/// its size.
pub fn eigenvalues(model: &LumpedModel, states: &[ContactState], mu: f64) -> Vec<Complex<f64>> {
    let model = model.clone().with_friction(mu);
    let reduced = model.linear().unwrap().reduced(states).unwrap();
    let n = reduced.mass.nrows();
    let square = |[a, b, c, d]: [&DMatrix<f64>; 4]| {
        let mut matrix = DMatrix::zeros(2 * n, 2 * n);
        for (place, block) in [(0, 0), (0, n), (n, 0), (n, n)].into_iter().zip([a, b, c, d]) {
            matrix.view_mut(place, (n, n)).copy_from(block);
        }
        matrix
    };
    let zero = DMatrix::zeros(n, n);
    let a = square([&reduced.damping, &reduced.mass, &reduced.mass, &zero]);
    let b = square([&reduced.stiffness, &zero, &zero, &-&reduced.mass]);
    a.lu().solve(&-b).unwrap().complex_eigenvalues().iter().copied().collect()
}
