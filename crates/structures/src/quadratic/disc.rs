//! Modes in a disc about a shift, with their errors.

use super::arnoldi::{Nearest, Pair, Wish, nearest};
use super::shifted::{Shifted, norm};
use super::{Mode, Quadratic};
use amontons::Error;
use amontons_analysis::watch::Watch;
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

/// The nearness of two eigenvalues, relative to their distance from the shift, from which on they are looked at together.
/// That of a defective pair is the root of the rounding, and more for bad conditions.
const NEAR: f64 = 1e-5;
/// A pair with a larger backward error is no mode.
const BACKWARD: f64 = 1e-12;
/// A shift that is nearer to an eigenvalue, relative to the distance of another, hides that other one by rounding.
const HIDING: f64 = 1e-4;
/// So does one that is nearer to an eigenvalue than this part of the wanted radius.
const CLOSE: f64 = 1e-6;

/// The rounding of a distance from a shift, relative to it.
const ROUNDING: f64 = 1e-8;

/// The view from one shift.
#[derive(Clone)]
pub(super) struct Disc {
    pub(super) centre: c64,
    /// All eigenvalues in this distance are among the modes, as far as the method can see.
    pub(super) radius: f64,
    /// Up to this distance there are no others: the radius, or half of the way to the nearest Ritz value, if it is rough.
    pub(super) empty: f64,
    /// By distance from the centre, with a non-negative imaginary part; that of a real one is 0.
    pub(super) modes: Vec<Mode>,
    /// Rough places of eigenvalues farther away.
    pub(super) rough: Vec<c64>,
    /// `true` if the shift is so near to an eigenvalue that rounding hides others.
    pub(super) hides: bool,
    /// The number of solutions with the factors.
    pub(super) solves: usize,
}

/// How far apart computed values of one eigenvalue in a disc can be.
pub(super) fn nearness(centre: c64, eigenvalue: c64) -> f64 {
    NEAR * (eigenvalue - centre).norm()
}

/// Looks for modes about a shift. `bounds` tells to compute the left vectors as well, for bounds of the errors.
///
/// # Errors
/// Returns an error if the work has been ended, or if a small eigenvalue problem cannot be solved.
pub(super) fn look(
    shifted: &Shifted,
    wish: &Wish,
    bounds: bool,
    watch: Watch,
) -> Result<Disc, Error> {
    let centre = shifted.shift;
    let found = nearest(shifted, wish, watch)?;
    let mut solves = found.solves;
    let left = if bounds {
        let wish =
            Wish { transposed: true, radius: wish.radius.min(found.radius), known: &[], ..*wish };
        let left = nearest(shifted, &wish, watch)?;
        solves += left.solves;
        left.pairs
    } else {
        vec![]
    };
    let Nearest { pairs, mut radius, mut rough, .. } = found;
    let distance = |place: c64| (place - centre).norm();
    let hides = pairs.first().is_some_and(|pair| {
        let away = distance(pair.eigenvalue);
        let hidden = |&next: &c64| away < HIDING * distance(next);
        wish.radius.is_finite() && away < CLOSE * wish.radius
            || radius < wish.radius && rough.first().is_none_or(hidden)
    });
    let errors = bounds_of(shifted, &pairs, &left);
    let modes = pairs.into_iter().zip(errors).map(|(pair, bound)| {
        let backward = backward(shifted.problem, &pair);
        Mode { eigenvalue: pair.eigenvalue, vector: pair.vector, backward, bound }
    });
    let (modes, wrong): (Vec<Mode>, Vec<Mode>) =
        modes.partition(|mode: &Mode| mode.backward <= BACKWARD);
    if let Some(first) = wrong.first() {
        let below = modes.iter().map(|mode| distance(mode.eigenvalue));
        let end = radius.min(distance(first.eigenvalue));
        radius = below.filter(|&away| away < end).fold(0.0, f64::max);
        rough.extend(wrong.iter().map(|mode| mode.eigenvalue));
        rough.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    }
    let (modes, radius) = fold(centre, radius, modes);
    let nearest = rough.first().map_or(0.0, |&place| distance(place));
    let empty = radius.max(0.5 * nearest);
    Ok(Disc { centre, radius, empty, modes, rough, hides, solves })
}

/// The backward error of a pair.
fn backward(problem: &Quadratic, pair: &Pair) -> f64 {
    norm(&problem.apply(pair.eigenvalue, false, &pair.vector)) / problem.norm(pair.eigenvalue)
}

/// Bounds of the errors of the eigenvalues, to first order, for those that have as many left vectors as right ones.
///
/// Of one eigenvalue it is ‖y‖ ‖r‖ / |yᵀ P′ x|; of several near each other the numbers become the matrices of their vectors.
fn bounds_of(shifted: &Shifted, right: &[Pair], left: &[Pair]) -> Vec<Option<f64>> {
    let mut bounds = vec![None; right.len()];
    let near = |a: c64, b: c64| (a - b).norm() <= nearness(shifted.shift, a);
    for (number, pair) in right.iter().enumerate() {
        let close = |other: &&Pair| near(pair.eigenvalue, other.eigenvalue);
        let rights: Vec<&Pair> = right.iter().filter(close).collect();
        let lefts: Vec<&Pair> = left.iter().filter(close).collect();
        if rights.len() == lefts.len() {
            bounds[number] = Some(bound(shifted.problem, &rights, &lefts));
        }
    }
    bounds
}

/// The bound ‖(Yᵀ P′ X)⁻¹‖ ‖Y‖ ‖R‖ in Frobenius norms, with the columns x, y and P x.
fn bound(problem: &Quadratic, right: &[&Pair], left: &[&Pair]) -> f64 {
    let count = right.len();
    let mut residual = 0.0;
    let mut coupling = Mat::zeros(count, count);
    for (column, x) in right.iter().enumerate() {
        // A residual below the rounding of its own computing is not known.
        let rounding = f64::EPSILON * problem.norm(x.eigenvalue);
        residual += norm(&problem.apply(x.eigenvalue, false, &x.vector)).max(rounding).powi(2);
        let change = problem.derivative(x.eigenvalue, &x.vector);
        for (row, y) in left.iter().enumerate() {
            coupling[(row, column)] = y.vector.iter().zip(&change).map(|(y, x)| y * x).sum::<c64>();
        }
    }
    let inverse = coupling.partial_piv_lu().solve(Mat::<c64>::identity(count, count));
    let bound = inverse.norm_l2() * ((count as f64) * residual).sqrt();
    if bound.is_nan() { f64::INFINITY } else { bound }
}

/// Leaves out the lower one of each pair of conjugates and makes the others real that are next to the real axis: since the
/// matrices are real, an eigenvalue without a conjugate is real. The radius becomes smaller if a conjugate can be just outside
/// it.
fn fold(centre: c64, radius: f64, modes: Vec<Mode>) -> (Vec<Mode>, f64) {
    let eigenvalues: Vec<c64> = modes.iter().map(|mode| mode.eigenvalue).collect();
    let away = |value: c64| nearness(centre, value);
    let mut lower = vec![false; modes.len()];
    let mut upper: Vec<bool> = eigenvalues.iter().map(|&value| value.im > away(value)).collect();
    for (number, &eigenvalue) in eigenvalues.iter().enumerate() {
        if eigenvalue.im < -away(eigenvalue) {
            lower[number] = true;
        } else if eigenvalue.im > 0.0 && !upper[number] {
            let distance = |other: usize| (eigenvalues[other] - eigenvalue.conj()).norm();
            let partner = (0..modes.len())
                .filter(|&other| eigenvalues[other].im < 0.0 && !lower[other])
                .min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
            if let Some(partner) = partner.filter(|&other| distance(other) < 0.5 * eigenvalue.im) {
                (upper[number], lower[partner]) = (true, true);
            }
        }
    }
    let mut folded = vec![];
    let mut trusted = radius;
    for (number, mut mode) in modes.into_iter().enumerate() {
        if !upper[number] && !lower[number] {
            if (mode.eigenvalue.conj() - centre).norm() > radius * (1.0 + ROUNDING) {
                trusted = trusted.min((1.0 - NEAR) * (mode.eigenvalue - centre).norm());
            }
            mode.eigenvalue.im = 0.0;
        }
        if !lower[number] {
            folded.push(mode);
        }
    }
    folded.retain(|mode| (mode.eigenvalue - centre).norm() <= trusted * (1.0 + ROUNDING));
    (folded, trusted)
}
