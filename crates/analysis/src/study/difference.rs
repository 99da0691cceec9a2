//! This module tells how different two motions are, as far as endings show it. Their distance is
//!
//! ```text
//! D = s + 2.5 p + k
//! ```
//!
//! | part | value |
//! | --- | --- |
//! | s | the largest \|ln\| of the ratio of two extents, or of the two sizes |
//! | s, if one is irregular | 0.2 \|ln\| of the ratio of the sizes |
//! | s, if both are undecided | 0.05 / max(0.05, 2 (scatter + scatter)) times \|ln\| of the ratio of the sizes |
//! | p | \|ln\| of the ratio of the strongest line of one and the nearest line of the other, the larger of both ways, at most 1; 0 if one is undecided and the other undecided or irregular |
//! | k | 0.04 if both kinds are known and different |
//!
//! Two motions with D above 0.05 are two, or above 0.005 if both are periodic to 1e-6. D is 10 if one of two motions
//! rests or grows without bound, and 0 if both do.

use super::long_term::{Kind, LongTermMotion};
use super::recurrence::CLOSED;

/// Extents that differ by more than this part, from one value to the next or between the ways, may be of different
/// motions.
pub(super) const OTHER_EXTENT: f64 = 0.05;
/// Extents of two periodic motions that differ by more than this part are of different ones, where both states come
/// back to within [`CLOSED`].
const SAME_EXTENT: f64 = 5e-3;
/// Sizes of irregular motions may belong to different motions if they differ by more than this part.
const OTHER_IRREGULAR: f64 = 0.25;
/// Sizes of undecided motions may belong to different motions if they differ by more than this many times their own
/// scatter.
const OTHER_SCATTER: f64 = 2.0;
/// Frequencies may belong to different motions if they differ by more than this part.
const OTHER_FREQUENCY: f64 = 0.02;
/// Another kind adds this to the distance of two motions. Alone it does not make them different, since a second
/// frequency may come and go gently.
const OTHER_KIND: f64 = 0.8 * OTHER_EXTENT;
/// Displacements whose extents are both less than this part of the largest extent do not tell motions apart.
const SEEN: f64 = 1e-2;

/// `true` if two motions are known to be of different kinds.
pub(super) fn have_other_kinds(a: &LongTermMotion, b: &LongTermMotion) -> bool {
    let is_open =
        |ending: &LongTermMotion| matches!(ending.kind, Kind::Undecided | Kind::Unsettled);
    a.kind != b.kind && !is_open(a) && !is_open(b)
}

/// `true` if a motion is known so exactly that a small difference tells it from another one.
pub(super) fn is_exact(ending: &LongTermMotion) -> bool {
    ending.kind == Kind::Periodic && ending.closure.is_some_and(|closure| closure <= CLOSED)
}

/// `true` if these are two motions, compared as closely as they are known. Both are at the same value of a parameter,
/// or at values that hardly differ.
pub(super) fn are_two(a: &LongTermMotion, b: &LongTermMotion) -> bool {
    distance(a, b) > if is_exact(a) && is_exact(b) { SAME_EXTENT } else { OTHER_EXTENT }
}

/// Distance between two motions: 0 for the same motion; the largest possible where one rests or grows without bound
/// and the other does not.
pub(super) fn distance(a: &LongTermMotion, b: &LongTermMotion) -> f64 {
    const FAR: f64 = 10.0;
    let is_unbounded = |ending: &LongTermMotion| ending.kind == Kind::Unbounded;
    // Nothing is known of two motions that have not settled, and so no jump between them.
    if [a, b].iter().all(|ending| ending.kind == Kind::Unsettled && !ending.is_known()) {
        return 0.0;
    }
    // An undamped motion in which no contact changes its state has any size, that of rest among them.
    let is_neutral = |ending: &LongTermMotion| ending.kind.is_cycle() && ending.linear;
    if (a.rests() || is_neutral(a)) && (b.rests() || is_neutral(b)) {
        return 0.0;
    }
    if a.rests() != b.rests() || is_unbounded(a) != is_unbounded(b) {
        return FAR;
    }
    if is_unbounded(a) {
        return 0.0;
    }
    let seen = SEEN * a.largest_extent().max(b.largest_extent());
    let log = |a: f64, b: f64| if a > 0.0 && b > 0.0 { libm::log(a / b).abs() } else { 0.0 };
    let extents = a.extents.iter().zip(&b.extents).filter(|(a, b)| a.max(**b) >= seen);
    let extents = extents.map(|(a, b)| log(*a, *b)).fold(0.0, f64::max);
    let size = match [a.kind, b.kind] {
        // Over a window the extents of a motion without a period vary.
        [Kind::Irregular, _] | [_, Kind::Irregular] => {
            log(a.size, b.size) * OTHER_EXTENT / OTHER_IRREGULAR
        }
        [Kind::Undecided, Kind::Undecided] => {
            let scatter = OTHER_SCATTER * (a.scatter + b.scatter);
            log(a.size, b.size) * OTHER_EXTENT / scatter.max(OTHER_EXTENT)
        }
        _ => extents.max(log(a.size, b.size)),
    };
    // If two lines are equally strong, either may be the first.
    let pitch = |a: &LongTermMotion, b: &LongTermMotion| match (&a.lines[..], &b.lines[..]) {
        ([[a, _], ..], [_, ..]) => b.lines.iter().map(|line| log(*a, line[0])).fold(1.0, f64::min),
        ([], []) => 0.0,
        _ => 1.0,
    };
    // The lines of a motion that may have no period wander from window to window.
    let wanders =
        |ending: &LongTermMotion| matches!(ending.kind, Kind::Undecided | Kind::Irregular);
    let is_open = [a, b].iter().any(|ending| ending.kind == Kind::Undecided);
    let pitch =
        if is_open && wanders(a) && wanders(b) { 0.0 } else { pitch(a, b).max(pitch(b, a)) };
    // Frequencies change less than extents where motions are the same.
    let kind = if have_other_kinds(a, b) { OTHER_KIND } else { 0.0 };
    size + pitch * OTHER_EXTENT / OTHER_FREQUENCY + kind
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A motion of an undecided kind, of one displacement.
    pub(in crate::study) fn undecided(size: f64, scatter: f64, line: f64) -> LongTermMotion {
        LongTermMotion {
            kind: Kind::Undecided,
            amplitude: size,
            frequency: Some(line),
            period: None,
            closure: None,
            two_frequencies: false,
            follows: false,
            fading: [false; 4],
            longest_step: None,
            parting: None,
            lines: vec![[line, size]],
            shares: [1.0, 0.0, 0.0, 0.0],
            taken: [true, false, true, false],
            time: 1.0,
            rate: 0.0,
            linear: false,
            size,
            scatter,
            extents: vec![size],
        }
    }

    #[test]
    fn periodic_motions_are_told_apart_as_closely_as_they_are_known() {
        let periodic = |extent, closure| LongTermMotion {
            kind: Kind::Periodic,
            closure: Some(closure),
            ..undecided(extent, 0.0, 168.0)
        };
        let one = periodic(1e-4, 1e-9);
        assert!(!are_two(&one, &periodic(1.004e-4, 1e-9)));
        assert!(are_two(&one, &periodic(1.014e-4, 1e-9)));
        assert!(!are_two(&one, &periodic(1.014e-4, 2e-6)));
        assert!(are_two(&one, &periodic(1.06e-4, 2e-6)));
    }

    #[test]
    fn undecided_motions_are_two_only_where_they_differ_beyond_their_scatter() {
        let differ = |a: &LongTermMotion, b: &LongTermMotion| distance(a, b) > OTHER_EXTENT;
        let one = undecided(1e-4, 1e-3, 168.0);
        // The strongest of its lines is another one in each window.
        assert!(!differ(&one, &undecided(1.01e-4, 1e-3, 219.0)));
        assert!(differ(&one, &undecided(1.2e-4, 1e-3, 168.0)));
        assert!(!differ(&one, &undecided(1.2e-4, 0.1, 168.0)));
        assert!(differ(&undecided(1e-4, 0.1, 168.0), &undecided(2e-4, 0.1, 168.0)));
        // A cycle has lines that stay.
        let cycle = LongTermMotion { kind: Kind::Periodic, ..one };
        assert!(differ(
            &cycle,
            &LongTermMotion { kind: Kind::Periodic, ..undecided(1e-4, 0.0, 219.0) }
        ));
        assert!(differ(&cycle, &undecided(1e-4, 1e-3, 219.0)));
    }
}
