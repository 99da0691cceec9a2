//! Dense kernels of the fronts.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve as triangular;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, ColMut, ColRef, MatMut, MatRef, Par, c64};

/// Eliminates the columns of a front of `width` + `below` rows.
///
/// `panel` holds its first `width` columns and `right` the rows of those columns right of them. Both become factors, and
/// `update` loses their product. `exchanged` receives the row that went to each of the first `width` rows. Returns `true`
/// if the number of exchanges was odd.
pub(super) fn eliminate(
    width: usize,
    below: usize,
    panel: &mut [c64],
    right: &mut [c64],
    update: &mut [c64],
    exchanged: &mut [usize],
) -> bool {
    let panel = MatMut::from_column_major_slice_mut(panel, width + below, width);
    let (mut diagonal, mut lower) = panel.split_at_row_mut(width);
    let mut inverse = vec![0; width];
    let scratch = lu_in_place_scratch::<usize, c64>(width, width, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let (info, _) = lu_in_place(
        diagonal.rb_mut(),
        exchanged,
        &mut inverse,
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    );
    if below > 0 {
        let mut column = vec![c64::default(); width];
        for values in right.chunks_exact_mut(width) {
            column.copy_from_slice(values);
            for (value, &row) in values.iter_mut().zip(&*exchanged) {
                *value = column[row];
            }
        }
        let mut right = MatMut::from_column_major_slice_mut(right, width, below);
        triangular::solve_unit_lower_triangular_in_place(diagonal.rb(), right.rb_mut(), Par::Seq);
        triangular::solve_lower_triangular_in_place(
            diagonal.rb().transpose(),
            lower.rb_mut().transpose_mut(),
            Par::Seq,
        );
        let update = MatMut::from_column_major_slice_mut(update, below, below);
        matmul(update, Accum::Add, lower.rb(), right.rb(), c64::new(-1.0, 0.0), Par::Seq);
    }
    info.transposition_count % 2 == 1
}

/// Subtracts the product of a matrix by column and the vector x from y.
pub(super) fn subtract_product(matrix: MatRef<'_, c64>, x: &[c64], y: &mut [c64]) {
    let (x, y) = (ColRef::from_slice(x).as_mat(), ColMut::from_slice_mut(y).as_mat_mut());
    matmul(y, Accum::Add, matrix, x, c64::new(-1.0, 0.0), Par::Seq);
}

/// Adds `factor` times x to y.
pub(super) fn add(factor: c64, x: &[c64], y: &mut [c64]) {
    for (y, x) in y.iter_mut().zip(x) {
        y.re += factor.re * x.re - factor.im * x.im;
        y.im += factor.re * x.im + factor.im * x.re;
    }
}

/// The sum of the products x y, or of x̄ y if `CONJUGATE`.
pub(super) fn dot<const CONJUGATE: bool>(x: &[c64], y: &[c64]) -> c64 {
    // Several sums at once, since additions are not exchanged by the compiler.
    let mut sums = [[0.0; 4]; 4];
    let (many, rest) = x.as_chunks::<4>();
    let (others, other_rest) = y.as_chunks::<4>();
    let mut add = |lane: usize, x: &c64, y: &c64| {
        sums[0][lane] += x.re * y.re;
        sums[1][lane] += x.im * y.im;
        sums[2][lane] += x.re * y.im;
        sums[3][lane] += x.im * y.re;
    };
    for (x, y) in many.iter().zip(others) {
        for lane in 0..4 {
            add(lane, &x[lane], &y[lane]);
        }
    }
    rest.iter().zip(other_rest).for_each(|(x, y)| add(0, x, y));
    let [re_re, im_im, re_im, im_re] = sums.map(|sums| (sums[0] + sums[1]) + (sums[2] + sums[3]));
    if CONJUGATE {
        c64::new(re_re + im_im, re_im - im_re)
    } else {
        c64::new(re_re - im_im, re_im + im_re)
    }
}
