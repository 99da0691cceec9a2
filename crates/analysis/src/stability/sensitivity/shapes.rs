//! Eigenvalues with their shapes, left and right.

use super::bordered::{Bordered, BorderedChange, Matrix};
use super::nullspace::null_space;
use crate::stability::parallel::collect;
use amontons::Error;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Eigenvalues that differ by less than this part of themselves are one in any structure.
const EQUAL: f64 = 1e-13;
/// Shapes of two eigenvalues that differ by less than this many times the rounding of either are mixtures of both: the two
/// are then treated as one eigenvalue that comes twice.
const MIXED: f64 = 100.0;
/// Rounding does not part equal eigenvalues by more than this part of themselves; it parts two that have merged by its root.
const MOST_ROUNDING: f64 = 1e-7;

/// An eigenvalue with its shapes as orthonormal columns.
#[derive(Clone, Debug)]
pub(super) struct Shaped {
    pub(super) eigenvalue: Complex<f64>,
    /// Number of shapes.
    pub(super) copies: usize,
    /// `true` if there are fewer shapes than eigenvalues: two or more have merged.
    pub(super) is_merged: bool,
    pub(super) left: Matrix,
    pub(super) right: Matrix,
    /// Yᵀ (∂Q/∂λ) Z; `None` where it is singular.
    weight: Option<Matrix>,
    /// An estimate of the rounding of the eigenvalue, 1/s.
    pub(super) error: f64,
    /// Its mean derivative by µ; zero if there is none.
    pub(super) by_friction: Complex<f64>,
}

/// The eigenvalues with their shapes; those that are equal but for rounding are one. `may_begin` is asked before each, and its error ends
/// the work.
pub(super) fn groups(
    matrices: &Bordered,
    eigenvalues: &[Complex<f64>],
    may_begin: &(dyn Fn() -> Result<(), Error> + Sync),
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<Vec<Shaped>, Error> {
    let mut apart: Vec<(Complex<f64>, usize)> = Vec::new();
    for &value in eigenvalues {
        let is_equal =
            |it: &&mut (Complex<f64>, usize)| (it.0 - value).norm() <= EQUAL * value.norm();
        match apart.iter_mut().find(is_equal) {
            Some(one) => one.1 += 1,
            None => apart.push((value, 1)),
        }
    }
    let shape = |i: usize| {
        may_begin()?;
        Shaped::of(matrices, apart[i].0, apart[i].1)
    };
    let found = collect(apart.len(), &shape, &|count| done(count, apart.len()))?;
    let mut together: Vec<Vec<usize>> = Vec::new();
    for i in 0..found.len() {
        let is_mixed = |group: &Vec<usize>| {
            group.iter().any(|&j| {
                let distance = (found[i].eigenvalue - found[j].eigenvalue).norm();
                distance <= MIXED * found[i].error.max(found[j].error)
            })
        };
        let (mixed, others): (Vec<_>, Vec<_>) = together.into_iter().partition(is_mixed);
        together = others;
        let mut joined: Vec<usize> = mixed.into_iter().flatten().collect();
        joined.push(i);
        together.push(joined);
    }
    together.sort_by_key(|group| group.iter().min().copied());
    let whole = |group: &Vec<usize>| match group[..] {
        [only] => Ok(found[only].clone()),
        _ => {
            let count: usize = group.iter().map(|&i| apart[i].1).sum();
            #[allow(clippy::cast_precision_loss)]
            let sum: Complex<f64> = group.iter().map(|&i| apart[i].0 * apart[i].1 as f64).sum();
            #[allow(clippy::cast_precision_loss)]
            Shaped::of(matrices, sum / count as f64, count)
        }
    };
    together.iter().map(whole).collect()
}

/// A size of eigenvalues, 1/s: that of the stiffest motion.
pub(super) fn size(matrices: &Bordered) -> f64 {
    let [stiffness, mass] = [&matrices.stiffness, &matrices.mass].map(|matrix| matrix.amax());
    if mass > 0.0 { 1e-3 * (stiffness / mass).sqrt() } else { 0.0 }
}

impl Shaped {
    /// The shapes of an eigenvalue that comes `count` times.
    fn of(matrices: &Bordered, eigenvalue: Complex<f64>, count: usize) -> Result<Self, Error> {
        let q = matrices.at(eigenvalue);
        let both = |count| Ok((null_space(&q, count)?, null_space(&q.transpose(), count)?));
        // Fewer shapes: two or more have merged.
        let (mut found, mut copies) = (None, count);
        while found.is_none() && copies > 0 {
            if let (Some(right), Some(left)) = both(copies)? {
                found = Some((right, left));
            } else {
                copies -= 1;
            }
        }
        let (right, left) = found.ok_or_else(|| {
            Error::analysis(format!(
                "the shapes of the mode at {:.6} Hz were not found; choose other modes with --frequencies",
                eigenvalue.im / TAU
            ))
        })?;
        let sloped = matrices.slope_times(eigenvalue, &right);
        let weight = left.tr_mul(&sloped);
        let least = weight.singular_values().min();
        #[allow(clippy::cast_precision_loss)]
        let rounding = f64::EPSILON * q.nrows() as f64 * largest(&q);
        let most = MOST_ROUNDING * eigenvalue.norm();
        let error = if least > 0.0 { (rounding / least).min(most) } else { most };
        let is_regular = copies == count && least > 1e-12 * sloped.norm();
        Ok(Self {
            eigenvalue,
            copies,
            is_merged: copies < count,
            left,
            right,
            weight: is_regular.then_some(weight),
            error,
            by_friction: Complex::ZERO,
        })
    }

    /// ∂λ/∂p of each copy, the largest real part first; `None` at a merging.
    pub(super) fn derivatives(&self, by: &BorderedChange) -> Option<Vec<Complex<f64>>> {
        let weight = self.weight.as_ref()?;
        let projected = self.left.tr_mul(&by.times(self.eigenvalue, &self.right));
        let mut found = super::eigenvalues(-weight.clone().lu().solve(&projected)?);
        found.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        Some(found)
    }

    /// The mean of the derivatives of all copies; zero at a merging.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn mean_derivative(&self, by: &BorderedChange) -> Complex<f64> {
        let all = self.derivatives(by).unwrap_or_default();
        all.iter().sum::<Complex<f64>>() / self.copies as f64
    }

    /// `true` if the eigenvalue has derivatives.
    pub(super) fn is_regular(&self) -> bool {
        self.weight.is_some()
    }
}

/// The largest entry of a matrix.
fn largest(matrix: &Matrix) -> f64 {
    matrix.iter().fold(0.0, |most, entry| most.max(entry.l1_norm()))
}
