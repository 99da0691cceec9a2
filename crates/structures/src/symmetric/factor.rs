//! Factors of sparse symmetric matrices, and the number of negative eigenvalues that they tell.

use crate::sparse::Sparse;
use amontons::Error;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::supernodal::SupernodalIntranodeLbltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, SymbolicCholesky, SymbolicCholeskyRaw,
    SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// The order of elimination of all matrices with one pattern, and where their factors have entries.
pub struct Pattern {
    symbolic: SymbolicCholesky<usize>,
}

impl Pattern {
    /// Finds an order of elimination with few entries in the factors (approximate minimum degree).
    ///
    /// # Errors
    /// Returns an error if the numbers of factors of this pattern need more than `memory` bytes.
    pub fn new(matrix: &Sparse, memory: usize) -> Result<Self, Error> {
        let symbolic = factorize_symbolic_cholesky(
            of_pattern(matrix),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams {
                // One kind of factors to read the pivots from. FORCE_SUPERNODAL leaves out diagonal matrices, which need no
                // operations to factor.
                supernodal_flop_ratio_threshold: SupernodalThreshold(-1.0),
                supernodal_params: SymbolicSupernodalParams::default(),
                ..CholeskySymbolicParams::default()
            },
        )
        .map_err(|error| {
            Error::analysis(format!("cannot order the matrix for elimination: {error:?}"))
        })?;
        let pattern = Self { symbolic };
        let needed = pattern.bytes();
        if needed > memory {
            return Err(Error::analysis(format!(
                "the factors of {} degrees of freedom need {} of memory, and {} are allowed; allow more with --memory, or use \
                 a coarser mesh",
                matrix.rows(),
                gigabytes(needed),
                gigabytes(memory)
            )));
        }
        Ok(pattern)
    }

    /// The memory of the factors of one matrix, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.symbolic.len_val().saturating_mul(size_of::<f64>())
    }
}

/// A number of bytes in a message.
#[allow(clippy::cast_precision_loss)]
pub fn gigabytes(bytes: usize) -> String {
    format!("{:.3} GB", bytes as f64 * 1e-9)
}

/// Factors P A Pᵀ = L B Lᵀ of a symmetric matrix, with 1 × 1 and 2 × 2 pivots in B (Bunch and Kaufman, within each
/// supernode).
pub struct Factors<'a> {
    pattern: &'a Pattern,
    values: Vec<f64>,
    below: Vec<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
}

impl<'a> Factors<'a> {
    /// Factors a matrix of this pattern.
    #[must_use]
    pub fn new(pattern: &'a Pattern, matrix: &Sparse) -> Self {
        let symbolic = &pattern.symbolic;
        let order = matrix.rows();
        let mut factors = Self {
            pattern,
            values: vec![0.0; symbolic.len_val()],
            below: vec![0.0; order],
            forward: vec![0; order],
            inverse: vec![0; order],
        };
        let scratch =
            symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Default::default());
        symbolic.factorize_numeric_intranode_lblt(
            &mut factors.values,
            &mut factors.below,
            &mut factors.forward,
            &mut factors.inverse,
            SparseColMatRef::new(of_pattern(matrix), matrix.values()),
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        );
        factors
    }

    fn permutation(&self) -> PermRef<'_, usize> {
        PermRef::new_checked(&self.forward, &self.inverse, self.forward.len())
    }

    /// Solves A X = B in place, for all columns at once.
    pub fn solve(&self, mut right: MatMut<'_, f64>) {
        let symbolic = &self.pattern.symbolic;
        let scratch = symbolic.solve_in_place_scratch::<f64>(right.ncols(), Par::Seq);
        IntranodeLbltRef::new(symbolic, &self.values, &self.below, self.permutation())
            .solve_in_place_with_conj(
                Conj::No,
                right.as_mut(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::new(scratch)),
            );
    }

    /// The number of negative eigenvalues of the matrix: that of B (Sylvester's law of inertia). `None` if a pivot is zero
    /// or not finite, so that it has no sign.
    #[must_use]
    pub fn negative(&self) -> Option<usize> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.pattern.symbolic.raw() else {
            unreachable!("the pattern asks for supernodes");
        };
        let factors = SupernodalIntranodeLbltRef::new(
            symbolic,
            &self.values,
            &self.below,
            self.permutation(),
        );
        (0..symbolic.n_supernodes())
            .map(|supernode| {
                let supernode = factors.supernode(supernode);
                let (block, start) = (supernode.val(), supernode.start());
                negative(block.ncols(), |at| block[(at, at)], |at| self.below[start + at])
            })
            .sum()
    }
}

/// The number of negative eigenvalues of a matrix of 1 × 1 and 2 × 2 pivots, from its diagonal and the entries below it, of
/// which one that is not zero makes a pivot of two rows. `None` if a pivot is zero or not finite.
pub fn negative(
    order: usize,
    diagonal: impl Fn(usize) -> f64,
    below: impl Fn(usize) -> f64,
) -> Option<usize> {
    let (mut at, mut count) = (0, 0);
    while at < order {
        let is_pair = below(at) != 0.0;
        let determinant = if is_pair {
            diagonal(at) * diagonal(at + 1) - below(at) * below(at)
        } else {
            diagonal(at)
        };
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        count += match (determinant < 0.0, is_pair) {
            (true, _) => 1,
            (false, true) if diagonal(at) < 0.0 => 2,
            (false, _) => 0,
        };
        at += if is_pair { 2 } else { 1 };
    }
    Some(count)
}

fn of_pattern(matrix: &Sparse) -> SymbolicSparseColMatRef<'_, usize> {
    let order = matrix.rows();
    SymbolicSparseColMatRef::new_checked(order, order, matrix.starts(), None, matrix.indices())
}
