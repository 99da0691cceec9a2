//! The symbolic part of the factorisation of P(λ), done once for all λ.

use super::Quadratic;
use crate::dissection;
use amontons::Error;
use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use std::ops::Range;

/// How supernodes are merged: up to a number of columns, with at most this part of zeros. More zeros make fronts larger and
/// fewer, which dense kernels like.
const RELAX: &[(usize, f64)] = &[(8, 1.0), (24, 0.6), (64, 0.2), (usize::MAX, 0.05)];

/// A set of adjacent columns that are eliminated together, in the order of elimination.
#[derive(Debug)]
pub(super) struct Supernode {
    /// Its columns.
    pub(super) columns: Range<usize>,
    /// The rows below the block on the diagonal, ascending.
    pub(super) below: Vec<usize>,
    /// The supernodes whose updates it takes in.
    pub(super) children: Vec<usize>,
    /// Where its values begin: the panel of its columns, (columns + below) × columns, then columns × below, both by column.
    pub(super) offset: usize,
}

impl Supernode {
    /// The number of its columns.
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// The place at which the part of its rows right of its columns begins.
    pub(super) fn right(&self) -> usize {
        self.offset + (self.width() + self.below.len()) * self.width()
    }

    /// The number of multiplications of its elimination.
    fn operations(&self) -> f64 {
        let (width, below) = (self.width() as f64, self.below.len() as f64);
        width * (width * width / 3.0 + width * below + below * below)
    }

    /// The place behind its values.
    fn end(&self) -> usize {
        self.right() + self.width() * self.below.len()
    }
}

/// An entry of the union of the patterns of M, C and K, in the order of elimination.
#[derive(Debug)]
pub(super) struct Term {
    pub(super) row: usize,
    pub(super) column: usize,
    /// Its place in the values of the factors.
    pub(super) target: usize,
    /// The entries of M, C and K.
    pub(super) coefficients: [f64; 3],
}

/// The order of elimination and the pattern of the factors of P(λ).
#[derive(Debug)]
pub(super) struct Analysis {
    /// The original index of each place in the order of elimination.
    pub(super) order: Vec<usize>,
    /// The supernodes, children before parents.
    pub(super) supernodes: Vec<Supernode>,
    /// The entries of P.
    pub(super) terms: Vec<Term>,
    /// The number of values of the factors.
    pub(super) size: usize,
}

impl Analysis {
    /// Analyses the pattern of P.
    pub(super) fn new(problem: &Quadratic) -> Result<Self, Error> {
        let union = union(problem);
        let (order, mut supernodes) = supernodes(problem.size(), &union)?;
        let mut size = 0;
        let mut owner = vec![0; order.len()];
        for (number, supernode) in supernodes.iter_mut().enumerate() {
            supernode.offset = size;
            size = supernode.end();
            owner[supernode.columns.clone()].fill(number);
        }
        // The update of each goes to the supernode that eliminates the first row below it, which comes later.
        for number in 0..supernodes.len() {
            if let Some(&first) = supernodes[number].below.first() {
                supernodes[owner[first]].children.push(number);
            }
        }
        let mut place = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            place[old] = new;
        }
        let terms = union
            .into_iter()
            .map(|(row, column, coefficients)| {
                let (row, column) = (place[row], place[column]);
                let supernode = &supernodes[owner[row.min(column)]];
                let target = target(supernode, row, column);
                Term { row, column, target, coefficients }
            })
            .collect();
        Ok(Self { order, supernodes, terms, size })
    }
}

/// The place of an entry in the values of the supernode that eliminates its row or its column.
fn target(supernode: &Supernode, row: usize, column: usize) -> usize {
    let (begin, width) = (supernode.columns.start, supernode.width());
    let below = |row| {
        supernode.below.binary_search(&row).expect("the pattern of the factors holds all entries")
    };
    if column >= supernode.columns.end {
        return supernode.right() + below(column) * width + (row - begin);
    }
    let local = if row < supernode.columns.end { row - begin } else { width + below(row) };
    supernode.offset + (column - begin) * (width + supernode.below.len()) + local
}

/// The entries of the union of the patterns, by column and then by row.
fn union(problem: &Quadratic) -> Vec<(usize, usize, [f64; 3])> {
    let matrices = [problem.mass(), problem.damping(), problem.stiffness()];
    let mut entries = vec![];
    for column in 0..problem.size() {
        let begin = entries.len();
        for (kind, matrix) in matrices.into_iter().enumerate() {
            for (row, value) in matrix.column(column) {
                let mut coefficients = [0.0; 3];
                coefficients[kind] = value;
                entries.push((row, column, coefficients));
            }
        }
        entries[begin..].sort_by_key(|entry| entry.0);
        let mut last = begin;
        for next in begin + 1..entries.len() {
            if entries[next].0 == entries[last].0 {
                for kind in 0..3 {
                    entries[last].2[kind] += entries[next].2[kind];
                }
            } else {
                last += 1;
                entries[last] = entries[next];
            }
        }
        entries.truncate((last + 1).min(entries.len()));
    }
    entries
}

/// The order of elimination and the supernodes of the pattern of P + Pᵀ: of the minimum degree and nested dissection the
/// one with fewer operations.
fn supernodes(
    size: usize,
    union: &[(usize, usize, [f64; 3])],
) -> Result<(Vec<usize>, Vec<Supernode>), Error> {
    let mut pairs: Vec<(usize, usize)> = union
        .iter()
        .map(|&(row, column, _)| (row.max(column), row.min(column)))
        .chain((0..size).map(|index| (index, index)))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    let mut starts = vec![0; size + 1];
    for &(column, _) in &pairs {
        starts[column + 1] += 1;
    }
    for column in 0..size {
        starts[column + 1] += starts[column];
    }
    let rows: Vec<usize> = pairs.iter().map(|pair| pair.1).collect();
    let upper = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
    pairs.retain(|(column, row)| column != row);
    let order = dissection::order(size, &pairs);
    let mut inverse = vec![0; size];
    order.iter().enumerate().for_each(|(new, &old)| inverse[old] = new);
    let dissected = PermRef::new_checked(&order, &inverse, size);
    let first = symbolic(upper, SymmetricOrdering::Amd)?;
    let second = symbolic(upper, SymmetricOrdering::Custom(dissected))?;
    let operations = |(_, supernodes): &(Vec<usize>, Vec<Supernode>)| -> f64 {
        supernodes.iter().map(Supernode::operations).sum()
    };
    Ok(if operations(&second) < operations(&first) { second } else { first })
}

/// The supernodes of a pattern, given by its upper triangle, in an order of elimination.
fn symbolic(
    upper: SymbolicSparseColMatRef<'_, usize>,
    ordering: SymmetricOrdering<'_, usize>,
) -> Result<(Vec<usize>, Vec<Supernode>), Error> {
    let parameters = CholeskySymbolicParams {
        // Less than any ratio, also that of a diagonal matrix, which is 0.
        supernodal_flop_ratio_threshold: SupernodalThreshold(-1.0),
        supernodal_params: SymbolicSupernodalParams { relax: Some(RELAX) },
        ..Default::default()
    };
    let symbolic =
        factorize_symbolic_cholesky(upper, Side::Upper, ordering, parameters).map_err(|error| {
            Error::analysis(format!("the pattern of the matrices cannot be analysed: {error}"))
        })?;
    let SymbolicCholeskyRaw::Supernodal(factors) = symbolic.raw() else {
        unreachable!("the supernodal form was asked for")
    };
    let order = match symbolic.perm() {
        Some(permutation) => permutation.arrays().0.to_vec(),
        None => (0..upper.ncols()).collect(),
    };
    let supernodes = (0..factors.n_supernodes())
        .map(|number| {
            let mut below = factors.supernode(number).pattern().to_vec();
            below.sort_unstable();
            let columns = factors.supernode_begin()[number]..factors.supernode_end()[number];
            Supernode { columns, below, children: vec![], offset: 0 }
        })
        .collect();
    Ok((order, supernodes))
}
