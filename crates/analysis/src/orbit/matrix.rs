//! Products and exponentials of small dense matrices, the same to the last bit on every machine.
//!
//! Rows of zeros stay exact: a row of A with no entry is a row of the unit matrix in exp(A).

use nalgebra::{DMatrix, DVector};

/// Powers of the exponential series: 1/19! = 8e-18.
const POWERS: i32 = 18;

/// The product of two matrices, summed column by column from the left; zeros are skipped.
pub(super) fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(a.nrows(), b.ncols());
    for (mut to, from) in out.column_iter_mut().zip(b.column_iter()) {
        for (column, &factor) in a.column_iter().zip(&from) {
            if factor != 0.0 {
                to.axpy(factor, &column, 1.0);
            }
        }
    }
    out
}

/// The product of a matrix and a vector.
pub(super) fn times(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let mut out = DVector::zeros(a.nrows());
    for (column, &factor) in a.column_iter().zip(b) {
        if factor != 0.0 {
            out.axpy(factor, &column, 1.0);
        }
    }
    out
}

/// exp(A t): the power series of the matrix in units in which its norm is at most one half, squared repeatedly.
/// `units` scale the rows, so that their numbers are of one size.
pub(super) fn exponential(matrix: &DMatrix<f64>, units: &[f64], t: f64) -> DMatrix<f64> {
    let n = matrix.nrows();
    let mut a = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] * units[j] / units[i] * t);
    let norm = a.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
    let mut halvings = 0;
    let mut left = norm;
    while left > 0.5 {
        left *= 0.5;
        halvings += 1;
    }
    a *= 0.5_f64.powi(halvings);
    // exp(A) − 1 is summed: small changes would be lost beside the unit matrix.
    let mut change = DMatrix::zeros(n, n);
    for k in (1..=POWERS).rev() {
        change = product(&a, &(change + DMatrix::identity(n, n))) / f64::from(k);
    }
    for _ in 0..halvings {
        // (1 + c)² − 1 = 2 c + c².
        change = product(&change, &change) + 2.0 * &change;
    }
    let mut out = DMatrix::from_fn(n, n, |i, j| change[(i, j)] * units[i] / units[j]);
    for i in 0..n {
        out[(i, i)] += 1.0;
    }
    out
}

/// An orthonormal basis, by columns, of the space on which all `rows` vanish.
pub(super) fn null_space(rows: &[DVector<f64>], size: usize) -> DMatrix<f64> {
    /// A vector depends on the others if the remainder across them is below this part of it.
    const DEPENDENT: f64 = 1e-9;
    let mut known: Vec<DVector<f64>> = Vec::new();
    let add = |mut vector: DVector<f64>, known: &mut Vec<DVector<f64>>| {
        let whole = vector.norm();
        for _ in 0..2 {
            for other in known.iter() {
                vector.axpy(-other.dot(&vector), other, 1.0);
            }
        }
        let left = vector.norm();
        let is_new = left > DEPENDENT * whole;
        if is_new {
            known.push(vector / left);
        }
        is_new
    };
    for row in rows {
        add(row.clone(), &mut known);
    }
    let held = known.len();
    // Vectors that have most left come first, so that none is a small remainder.
    while known.len() < size {
        let left = |i: usize| {
            let along: f64 = known.iter().map(|other| other[i] * other[i]).sum();
            1.0 - along
        };
        let best = (0..size).max_by(|a, b| left(*a).total_cmp(&left(*b))).unwrap_or(0);
        let mut unit = DVector::zeros(size);
        unit[best] = 1.0;
        if !add(unit, &mut known) {
            break;
        }
    }
    let mut basis = DMatrix::zeros(size, known.len() - held);
    for (mut column, vector) in basis.column_iter_mut().zip(&known[held..]) {
        column.copy_from(vector);
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_of_a_rotation_turns_and_rows_of_zeros_stay_exact() {
        let a = DMatrix::from_row_slice(3, 3, &[0.0, 2.0, 0.3, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let turned = exponential(&a, &[1.0, 1.0, 1.0], 7.0);
        assert!((turned[(0, 0)] - 14.0_f64.cos()).abs() < 1e-14);
        assert!((turned[(0, 1)] - 14.0_f64.sin()).abs() < 1e-14);
        assert!((turned[(0, 2)] - 0.15 * 14.0_f64.sin()).abs() < 1e-14);
        assert_eq!([turned[(2, 0)], turned[(2, 1)], turned[(2, 2)]], [0.0, 0.0, 1.0]);
    }

    #[test]
    fn units_do_not_change_an_exponential() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -4e6, -20.0]);
        let [plain, scaled] =
            [[1.0, 1.0], [1.0, 2000.0]].map(|units| exponential(&a, &units, 3e-3));
        assert!((&plain - &scaled).column(0).amax() < 1e-9);
        let decay = (-0.01_f64 * 3.0).exp();
        assert!((scaled.determinant() - decay * decay).abs() < 1e-13);
    }

    #[test]
    fn a_null_space_is_what_rows_leave() {
        let rows = [[1.0, 2.0, 0.0], [2.0, 4.0, 0.0]].map(|row| DVector::from_row_slice(&row));
        let basis = null_space(&rows, 3);
        assert_eq!(basis.ncols(), 2);
        for row in &rows {
            assert!((row.transpose() * &basis).amax() < 1e-15);
        }
        assert!((basis.transpose() * &basis - DMatrix::identity(2, 2)).amax() < 1e-15);
    }
}
