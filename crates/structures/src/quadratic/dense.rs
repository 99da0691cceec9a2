//! Dense kernels of the fronts.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve as triangular;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par, c64};

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
