//! Growth that is more than rounding.
//!
//! Without single dampers a growth rate is zero exactly where σ is real and nothing damps it, so that every sign counts. With
//! them the eigenvalues of modes that the dampers hardly reach have growth rates of the size of rounding.

use super::Crossing;
use super::events::BranchPoint;
use nalgebra::Complex;

/// A growth rate up to this part of |λ| is the rounding of zero.
const NEUTRAL: f64 = 1e-9;

/// `true` for the eigenvalue λ of a mode that neither grows nor decays, but for rounding. A mode that diverges is none.
#[must_use]
pub fn is_neutral(eigenvalue: Complex<f64>) -> bool {
    eigenvalue.re.abs() <= NEUTRAL * eigenvalue.norm()
}

/// Those crossings of a branch, by their values, at which it begins to grow by more than rounding, or ceases to. Between two
/// crossings the growth rate is more than rounding if it is so at one point, or if there is no point.
pub(super) fn clear(crossings: Vec<Crossing>, trace: &[BranchPoint]) -> Vec<Crossing> {
    let Some(first) = crossings.first() else { return crossings };
    let is_clear = |from: f64, to: f64| {
        let mut inside = trace.iter().filter(|point| from < point.0 && point.0 < to).peekable();
        inside.peek().is_none() || inside.any(|point| !is_neutral(point.1.lambda))
    };
    // What is neutral at the first value does not grow there.
    let mut grows = !first.becomes_unstable && is_clear(f64::NEG_INFINITY, first.value);
    let mut kept = Vec::new();
    for (place, crossing) in crossings.iter().enumerate() {
        let next = crossings.get(place + 1).map_or(f64::INFINITY, |next| next.value);
        if crossing.becomes_unstable != grows && is_clear(crossing.value, next) {
            grows = crossing.becomes_unstable;
            kept.push(*crossing);
        }
    }
    kept
}
