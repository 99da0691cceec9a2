//! Comparison of endings: this module tells which endings are the same motion.

use super::long_term::{Kind, LongTermMotion};

/// Amplitudes of one cycle differ by less than this, relative: ten times what a settled one may still change.
const SAME_AMPLITUDE: f64 = 2e-2;
/// Amplitudes of one irregular motion differ by less than this, relative.
const SAME_IRREGULAR: f64 = 0.25;
/// Frequencies of one cycle differ by less than this, relative.
const SAME_FREQUENCY: f64 = 1e-3;

/// `true` if the endings are one motion. All rest is one motion, and so is all growth without bound; cycles are one
/// if they agree in the extents of all displacements and in their periods or strongest frequencies; motions without a
/// period are one if they agree in about these extents. A motion that has not settled equals no other.
///
/// Cycles that are each other's mirror image, or the same wave running the other way round a ring, agree in all of this
/// and count as one.
#[must_use]
pub fn is_same(a: &LongTermMotion, b: &LongTermMotion) -> bool {
    let near = |a: f64, b: f64, part: f64| (a - b).abs() <= part * a.abs().max(b.abs());
    // If two lines are equally strong, either may be the first.
    let has = |ending: &LongTermMotion, other: &LongTermMotion| {
        other.frequency.is_none_or(|frequency| {
            ending.lines.iter().any(|[line, _]| near(*line, frequency, SAME_FREQUENCY))
        })
    };
    let has_extents = |part: f64| {
        let margin = part * a.largest_extent().max(b.largest_extent());
        a.extents.len() == b.extents.len()
            && a.extents.iter().zip(&b.extents).all(|(a, b)| (a - b).abs() <= margin)
    };
    match [a.kind, b.kind] {
        [Kind::Equilibrium, Kind::Equilibrium] | [Kind::Unbounded, Kind::Unbounded] => true,
        [Kind::Irregular, Kind::Irregular] => has_extents(SAME_IRREGULAR),
        [Kind::Periodic, Kind::Periodic] => {
            let periods = a.period.zip(b.period);
            has_extents(SAME_AMPLITUDE)
                && periods
                    .map_or_else(|| has(a, b) && has(b, a), |(a, b)| near(a, b, SAME_FREQUENCY))
        }
        // A cycle at the limit of two kinds may be called either.
        [a_kind, b_kind] if a_kind.is_cycle() && b_kind.is_cycle() => {
            has_extents(SAME_AMPLITUDE) && has(a, b) && has(b, a)
        }
        _ => false,
    }
}

/// The motions that endings are: one ending of each, rest first, then cycles by amplitude; and for each ending the
/// place of its motion among them, `None` where it has none.
pub fn attractors<'a>(
    endings: impl IntoIterator<Item = Option<&'a LongTermMotion>>,
) -> (Vec<LongTermMotion>, Vec<Option<usize>>) {
    // A linear motion that nothing damps is one motion at every size.
    let is_motion = |ending: &&LongTermMotion| ending.kind != Kind::Unsettled && ending.is_known();
    let endings: Vec<Option<&LongTermMotion>> =
        endings.into_iter().map(|ending| ending.filter(is_motion)).collect();
    // Places of the endings of each motion. What is the same as endings of two motions makes them one, so that the
    // order of the endings does not matter.
    let mut motions: Vec<Vec<usize>> = Vec::new();
    for (place, ending) in endings.iter().enumerate() {
        let Some(ending) = ending else { continue };
        let is_of = |motion: &mut Vec<usize>| {
            motion.iter().filter_map(|&other| endings[other]).any(|other| is_same(other, ending))
        };
        let mut one: Vec<usize> = motions.extract_if(.., is_of).flatten().collect();
        one.push(place);
        motions.push(one);
    }
    let mut found: Vec<(&LongTermMotion, Vec<usize>)> = motions
        .into_iter()
        .filter_map(|places| Some((endings[*places.iter().min()?]?, places)))
        .collect();
    let size =
        |ending: &LongTermMotion| if ending.kind.is_cycle() { ending.amplitude } else { -1.0 };
    found.sort_by(|(a, _), (b, _)| size(a).total_cmp(&size(b)));
    let mut ranks = vec![None; endings.len()];
    for (rank, (_, places)) in found.iter().enumerate() {
        places.iter().for_each(|place| ranks[*place] = Some(rank));
    }
    (found.into_iter().map(|(ending, _)| ending.clone()).collect(), ranks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn ending(kind: Kind, amplitude: f64, lines: &[[f64; 2]]) -> LongTermMotion {
        let ending = json!({
            "kind": kind,
            "amplitude": amplitude,
            "extents": [amplitude],
            "frequency": lines.first().map(|line| line[0]),
            "lines": lines,
            "shares": [1.0, 0.0, 0.0, 0.0],
            "taken": [true, false, true, false],
            "time": 8.0,
            "rate": 0.0,
        });
        serde_json::from_value(ending).unwrap()
    }

    #[test]
    fn motions_are_told_apart_by_size_and_frequency_and_rest_comes_first() {
        let cycle = ending(Kind::Periodic, 1e-3, &[[100.0, 1e-3]]);
        let other = |kind, amplitude, frequency| ending(kind, amplitude, &[[frequency, amplitude]]);
        assert!(is_same(&cycle, &other(Kind::Periodic, 1.001e-3, 100.01)));
        assert!(!is_same(&cycle, &other(Kind::Periodic, 1.1e-3, 100.0)));
        assert!(!is_same(&cycle, &other(Kind::Periodic, 1e-3, 101.0)));
        assert!(is_same(&cycle, &other(Kind::QuasiPeriodic, 1e-3, 100.0)));
        assert!(!is_same(&cycle, &other(Kind::Equilibrium, 1e-3, 100.0)));
        let irregular = |amplitude| other(Kind::Irregular, amplitude, 100.0 * amplitude);
        assert!(is_same(&irregular(1e-3), &irregular(1.2e-3)));
        assert!(!is_same(&irregular(1e-3), &irregular(1.5e-3)));
        let unsettled = other(Kind::Unsettled, 1e-3, 100.0);
        assert!(!is_same(&unsettled, &unsettled));
        // Two lines of one strength, in either order.
        let two = [[100.0, 1e-3], [130.0, 1e-3]];
        let turned = [two[1], two[0]];
        let beating = |lines: &[[f64; 2]]| ending(Kind::QuasiPeriodic, 2e-3, lines);
        assert!(is_same(&beating(&two), &beating(&turned)));

        let rest = |left| ending(Kind::Equilibrium, left, &[]);
        let small = other(Kind::Periodic, 1e-4, 100.0);
        let [near, far] = [1e-9, 1e-5].map(rest);
        let all = [&cycle, &near, &unsettled, &small, &far, &cycle].map(Some);
        let (found, places) = attractors(all.into_iter().chain([None]));
        assert_eq!(found, [rest(1e-9), small.clone(), cycle.clone()]);
        assert_eq!(places, [Some(2), Some(0), None, Some(1), Some(0), Some(2), None]);
        // The middle one is the same as both of its neighbours, whichever comes first.
        let [low, middle, high] =
            [1e-3, 1.015e-3, 1.03e-3].map(|amplitude| other(Kind::Periodic, amplitude, 100.0));
        for order in [[&low, &middle, &high], [&low, &high, &middle], [&high, &middle, &low]] {
            assert_eq!(attractors(order.map(Some)).1, [Some(0); 3]);
        }
    }
}
