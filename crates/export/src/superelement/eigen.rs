//! Eigenvalues and eigenvectors of a symmetric matrix, in plain loops: libraries use fused products where the processor has
//! them, so that the last bits would depend on the machine.
//!
//! Householder reflections make the matrix tridiagonal; implicit QL steps with Wilkinson's shift make that diagonal (Golub and
//! Van Loan, Matrix Computations, sections 8.3.1 and 8.3.3).

/// Most steps for one eigenvalue; two or three are usual.
const MOST_STEPS: usize = 60;

/// The eigenvalues in ascending order, and orthonormal eigenvectors.
pub(super) struct Modes {
    pub(super) values: Vec<f64>,
    /// Row by row, each an eigenvector.
    vectors: Vec<f64>,
}

impl Modes {
    pub(super) fn vector(&self, place: usize) -> &[f64] {
        let n = self.values.len();
        &self.vectors[place * n..(place + 1) * n]
    }
}

/// The modes of a symmetric matrix, n × n by rows.
pub(super) fn modes_of(mut matrix: Vec<f64>, n: usize) -> Modes {
    // Rows of `vectors` are columns of the orthogonal matrix Q with A = Q T Qᵀ.
    let mut vectors = vec![0.0; n * n];
    (0..n).for_each(|place| vectors[place * n + place] = 1.0);
    let mut reflections = Vec::with_capacity(n.saturating_sub(2));
    for place in 0..n.saturating_sub(2) {
        reflections.push(reflect(&mut matrix, n, place));
    }
    let mut diagonal: Vec<f64> = (0..n).map(|place| matrix[place * n + place]).collect();
    let mut beside: Vec<f64> = (1..n).map(|place| matrix[place * n + place - 1]).collect();
    beside.push(0.0);
    // Q = H_1 H_2 …, applied to the unit matrix from the last one on.
    for (place, reflection) in reflections.iter().enumerate().rev() {
        let Some((direction, factor)) = reflection else { continue };
        for row in vectors.chunks_exact_mut(n) {
            let row = &mut row[place + 1..];
            let along = factor * dot(direction, row);
            row.iter_mut().zip(direction).for_each(|(value, part)| *value -= along * part);
        }
    }
    diagonalise(&mut diagonal, &mut beside, &mut vectors);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| diagonal[*a].total_cmp(&diagonal[*b]));
    Modes {
        values: order.iter().map(|place| diagonal[*place]).collect(),
        vectors: order
            .iter()
            .flat_map(|place| vectors[place * n..(place + 1) * n].to_vec())
            .collect(),
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// Makes all but the first entry of a column below the diagonal zero by H = 1 − β v vᵀ on both sides. Returns v, for the rows
/// below `place`, and β; `None` if the entries are zero already.
fn reflect(matrix: &mut [f64], n: usize, place: usize) -> Option<(Vec<f64>, f64)> {
    let first = place + 1;
    let mut v: Vec<f64> = (first..n).map(|row| matrix[row * n + place]).collect();
    let most = v[1..].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    if most == 0.0 {
        return None;
    }
    // Scaled, since squares may leave the range of numbers.
    let scale = most.max(v[0].abs());
    v.iter_mut().for_each(|value| *value /= scale);
    let length = dot(&v, &v).sqrt();
    let target = if v[0] > 0.0 { -length } else { length };
    v[0] -= target;
    let factor = 2.0 / dot(&v, &v);
    // A − v wᵀ − w vᵀ with p = β A v, w = p − ½ β (pᵀ v) v.
    let mut w: Vec<f64> =
        (first..n).map(|row| factor * dot(&matrix[row * n + first..(row + 1) * n], &v)).collect();
    let half = 0.5 * factor * dot(&w, &v);
    w.iter_mut().zip(&v).for_each(|(w, v)| *w -= half * v);
    for (row, (v_row, w_row)) in (first..n).zip(v.iter().zip(&w)) {
        let values = &mut matrix[row * n + first..(row + 1) * n];
        for (value, (v, w)) in values.iter_mut().zip(v.iter().zip(&w)) {
            *value -= v_row * w + w_row * v;
        }
    }
    matrix[first * n + place] = scale * target;
    Some((v, factor))
}

/// Turns a tridiagonal matrix into its eigenvalues, in `diagonal`, and the rows of `vectors` with it.
fn diagonalise(diagonal: &mut [f64], beside: &mut [f64], vectors: &mut [f64]) {
    let n = diagonal.len();
    for start in 0..n {
        for _ in 0..MOST_STEPS {
            let is_small = |place: &usize| {
                let size = diagonal[*place].abs() + diagonal[*place + 1].abs();
                beside[*place].abs() <= f64::EPSILON * size
            };
            let end = (start..n - 1).find(is_small).unwrap_or(n - 1);
            if end == start {
                break;
            }
            ql_step(diagonal, beside, vectors, [start, end]);
        }
    }
}

/// One implicit QL step on the block from `start` to `end`.
fn ql_step(
    diagonal: &mut [f64],
    beside: &mut [f64],
    vectors: &mut [f64],
    [start, end]: [usize; 2],
) {
    let n = diagonal.len();
    let half = (diagonal[start + 1] - diagonal[start]) / (2.0 * beside[start]);
    let length = (half * half + 1.0).sqrt();
    let turned = if half >= 0.0 { half + length } else { half - length };
    let mut g = diagonal[end] - diagonal[start] + beside[start] / turned;
    let (mut sine, mut cosine, mut shift) = (1.0, 1.0, 0.0);
    for place in (start..end).rev() {
        let (f, b) = (sine * beside[place], cosine * beside[place]);
        let r = length_of(f, g);
        beside[place + 1] = r;
        if r == 0.0 {
            diagonal[place + 1] -= shift;
            beside[end] = 0.0;
            return;
        }
        (sine, cosine) = (f / r, g / r);
        g = diagonal[place + 1] - shift;
        let r = (diagonal[place] - g) * sine + 2.0 * cosine * b;
        shift = sine * r;
        diagonal[place + 1] = g + shift;
        g = cosine * r - b;
        let (above, below) = vectors.split_at_mut((place + 1) * n);
        for (a, b) in above[place * n..].iter_mut().zip(&mut below[..n]) {
            (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
        }
    }
    diagonal[start] -= shift;
    beside[start] = g;
    beside[end] = 0.0;
}

/// √(a² + b²) without leaving the range of numbers.
fn length_of(a: f64, b: f64) -> f64 {
    let (small, large) = if a.abs() < b.abs() { (a.abs(), b.abs()) } else { (b.abs(), a.abs()) };
    if large == 0.0 {
        return 0.0;
    }
    let part = small / large;
    large * (1.0 + part * part).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// −u″ on a chain of n masses between walls has the eigenvalues 2 − 2 cos(π k / (n + 1)), here in a basis without zeros.
    #[test]
    fn the_modes_of_a_chain_are_found_in_any_basis() {
        const N: usize = 17;
        let mut chain = vec![0.0; N * N];
        for i in 0..N {
            chain[i * N + i] = 2.0;
            if i > 0 {
                chain[i * N + i - 1] = -1.0;
                chain[(i - 1) * N + i] = -1.0;
            }
        }
        // H = 1 − 2 u uᵀ / uᵀu on both sides.
        let u: Vec<f64> =
            (0..N).map(|i| 1.0 + f64::from(u8::try_from(i * i % 7).unwrap())).collect();
        let uu = dot(&u, &u);
        for _ in 0..2 {
            for row in chain.chunks_exact_mut(N) {
                let along = 2.0 * dot(row, &u) / uu;
                row.iter_mut().zip(&u).for_each(|(value, u)| *value -= along * u);
            }
            let old = chain.clone();
            for i in 0..N {
                for j in 0..N {
                    chain[i * N + j] = old[j * N + i];
                }
            }
        }
        let modes = modes_of(chain.clone(), N);
        for (k, value) in (1_u8..).zip(&modes.values) {
            let expected =
                2.0 - 2.0 * (std::f64::consts::PI * f64::from(k) / (N as f64 + 1.0)).cos();
            assert!((value - expected).abs() < 1e-13, "{k}: {value} {expected}");
        }
        for i in 0..N {
            let product: Vec<f64> =
                (0..N).map(|row| dot(&chain[row * N..(row + 1) * N], modes.vector(i))).collect();
            for j in 0..N {
                let expected = if i == j { modes.values[i] } else { 0.0 };
                assert!((dot(&product, modes.vector(j)) - expected).abs() < 1e-13, "{i} {j}");
                let unit = f64::from(u8::from(i == j));
                assert!((dot(modes.vector(i), modes.vector(j)) - unit).abs() < 1e-13, "{i} {j}");
            }
        }
    }

    #[test]
    fn equal_eigenvalues_and_matrices_of_one_row_have_modes_too() {
        assert_eq!(modes_of(vec![3.0], 1).values, [3.0]);
        let modes = modes_of(vec![2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, -1.0], 3);
        assert_eq!(modes.values, [-1.0, 2.0, 2.0]);
        assert_eq!(modes.vector(0), [0.0, 0.0, 1.0]);
    }
}
