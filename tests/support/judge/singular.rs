//! Pseudo-inverses, and least squares over columns.
//!
//! The singular values of nalgebra 0.35 miss by up to 1e-4 for some matrices whose columns depend on each other in parts, as
//! those of redundant contacts do. So they are found here, by rotations of pairs of columns (Hestenes, J. SIAM 6, 1958).

use nalgebra::{DMatrix, DVector};

/// Columns whose cosine is no more than this are at right angles.
const RIGHT_ANGLE: f64 = 1e-15;
/// Far more rounds over all pairs of columns than any matrix takes.
const MOST_ROUNDS: usize = 100;
/// A column of length 1 of which less than this points away from others depends on them.
const DEPENDENT: f64 = 1e-10;

/// The columns U S of A = U S Vᵀ, and V.
struct Rotated {
    columns: DMatrix<f64>,
    rotation: DMatrix<f64>,
}

impl Rotated {
    fn new(matrix: &DMatrix<f64>) -> Self {
        let count = matrix.ncols();
        let mut columns = matrix.clone();
        let mut rotation = DMatrix::identity(count, count);
        for _ in 0..MOST_ROUNDS {
            let mut any = false;
            for i in 0..count {
                for j in i + 1..count {
                    let squares = [i, j].map(|k| columns.column(k).norm_squared());
                    let product = columns.column(i).dot(&columns.column(j));
                    if product.abs() <= RIGHT_ANGLE * (squares[0] * squares[1]).sqrt() {
                        continue;
                    }
                    any = true;
                    let half = (squares[1] - squares[0]) / (2.0 * product);
                    let tangent = half.signum() / (half.abs() + half.hypot(1.0));
                    let cosine = 1.0 / tangent.hypot(1.0);
                    rotate(&mut columns, [i, j], [cosine, cosine * tangent]);
                    rotate(&mut rotation, [i, j], [cosine, cosine * tangent]);
                }
            }
            if !any {
                break;
            }
        }
        Self { columns, rotation }
    }

    /// The places of the singular values above `least`.
    fn above(&self, least: f64) -> impl Iterator<Item = usize> {
        (0..self.columns.ncols()).filter(move |&i| self.columns.column(i).norm() > least)
    }
}

fn rotate(matrix: &mut DMatrix<f64>, [i, j]: [usize; 2], [cosine, sine]: [f64; 2]) {
    for row in 0..matrix.nrows() {
        let [a, b] = [matrix[(row, i)], matrix[(row, j)]];
        matrix[(row, i)] = cosine * a - sine * b;
        matrix[(row, j)] = sine * a + cosine * b;
    }
}

/// The number of singular values above `least`.
pub(super) fn rank(matrix: &DMatrix<f64>, least: f64) -> usize {
    Rotated::new(matrix).above(least).count()
}

/// The pseudo-inverse, to which singular values up to `least` are zero.
pub(super) fn pseudo_inverse(matrix: &DMatrix<f64>, least: f64) -> DMatrix<f64> {
    let rotated = Rotated::new(matrix);
    let Rotated { columns, rotation } = &rotated;
    let parts = rotated.above(least).map(|i| {
        let column = columns.column(i);
        rotation.column(i) * column.transpose() / column.norm_squared()
    });
    parts.fold(DMatrix::zeros(matrix.ncols(), matrix.nrows()), |sum, part| sum + part)
}

/// Coefficients of these columns of length 1 in the sum that is nearest to a vector; `None` if the columns depend on
/// each other.
pub(super) fn nearest(columns: &[&DVector<f64>], vector: &DVector<f64>) -> Option<Vec<f64>> {
    let count = columns.len();
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(count);
    let mut triangle = DMatrix::zeros(count, count);
    for (place, column) in columns.iter().enumerate() {
        let mut own = (*column).clone();
        // Once more, against rounding.
        for _ in 0..2 {
            for (row, other) in basis.iter().enumerate() {
                let along = other.dot(&own);
                triangle[(row, place)] += along;
                own.axpy(-along, other, 1.0);
            }
        }
        let length = own.norm();
        if length <= DEPENDENT {
            return None;
        }
        triangle[(place, place)] = length;
        basis.push(own / length);
    }
    let mut parts = vec![0.0; count];
    for place in (0..count).rev() {
        let later = (place + 1..count).map(|other| triangle[(place, other)] * parts[other]);
        parts[place] = (basis[place].dot(vector) - later.sum::<f64>()) / triangle[(place, place)];
    }
    Some(parts)
}

#[test]
fn a_pseudo_inverse_of_columns_in_two_blocks_solves_for_what_they_span() {
    let columns = [
        [0.0, 0.0, 0.686_995_39, 0.726_661_77],
        [-0.818_141_6, 0.575_016_8, 0.0, 0.0],
        [0.883_999_06, -0.467_488_67, 0.0, 0.0],
        [0.0, 0.0, 0.999_055_24, 0.043_458_43],
    ];
    let wanted = [9.422_744_05, 45.725_017_06, 45.151_906_42, 0.793_119_65];
    for count in 1..=4 {
        let columns: Vec<DVector<f64>> =
            columns[..count].iter().map(|column| DVector::from_row_slice(column)).collect();
        let matrix = DMatrix::from_columns(&columns);
        let wanted = DVector::from_row_slice(&wanted[..count]);
        let vector = &matrix * &wanted;
        let found = pseudo_inverse(&matrix, 1e-12) * &vector;
        assert!((&found - &wanted).amax() < 1e-12, "{found} {wanted}");
        let found = nearest(&columns.iter().collect::<Vec<_>>(), &vector).unwrap();
        assert!((DVector::from_vec(found) - &wanted).amax() < 1e-12);
        assert_eq!(rank(&matrix, 1e-12), count);
    }
    let column = DVector::from_row_slice(&columns[0]);
    let twice = DMatrix::from_columns(&[column.clone(), column]);
    assert_eq!(rank(&twice, 1e-12), 1);
    let half = pseudo_inverse(&twice, 1e-12) * twice.column(0);
    assert!((half - DVector::from_element(2, 0.5)).amax() < 1e-15);
}
