//! Ranks by growth and by loudness, and where they disagree.

use super::super::long_term::Kind;
use super::super::observation::ObservationSettings;
use super::{FoundMotion, Loudness, Row, WayKind};
use amontons::error::Short;

/// Growth rates and velocities nearer than this, in parts of them, have one rank.
const EQUAL: f64 = 1e-6;

/// Gives rows their ranks. The loudness of a motion is the root mean square of the speed of its fastest point.
pub(super) fn rank(rows: &mut [Row], motions: &[FoundMotion]) {
    let rates: Vec<f64> = rows.iter().map(|row| row.way.growth_rate).collect();
    let velocity = |motion: &FoundMotion| Some(motion.measured.as_ref()?.loudest().rms);
    let loud: Vec<Option<f64>> = motions.iter().map(velocity).collect();
    let all: Vec<f64> = loud.iter().flatten().copied().collect();
    for row in rows {
        row.growth_rank = place(row.way.growth_rate, &rates);
        let motion = row.attempt().motion;
        row.loudness_rank = motion.and_then(|motion| loud[motion]).map(|own| place(own, &all));
    }
}

/// The place of a value among all, the largest first, from 1.
fn place(value: f64, all: &[f64]) -> usize {
    1 + all.iter().filter(|other| **other > value * (1.0 + EQUAL)).count()
}

/// 1st, 2nd, 3rd, 4th.
fn ordinal(place: usize) -> String {
    let ending = match (place % 10, place % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{place}{ending}")
}

/// Sentences that say where loudness disagrees with growth: motions that are those of other modes, ranks that differ, ways of
/// which nothing is known.
#[must_use]
pub fn disagreements(found: &Loudness, observation: &ObservationSettings) -> Vec<String> {
    let mut said: Vec<String> = Vec::new();
    for row in &found.rows {
        said.extend(other_mode(row, found));
        said.extend(not_met(row, found));
        said.extend(no_motion(row, found, observation));
    }
    said.extend(ranks(found));
    said
}

/// "mode 5 grows fastest".
fn grows(row: &Row, found: &Loudness) -> String {
    let name = row.way.name();
    match (row.growth_rank, found.rows.len()) {
        (_, 1) => format!("{name} alone grows"),
        (1, _) => format!("{name} grows fastest"),
        (2, 2) => format!("{name} grows more slowly"),
        (place, count) if place == count => format!("{name} grows most slowly"),
        (place, _) => format!("{name} grows {} fastest", ordinal(place)),
    }
}

/// The sentence on a mode whose motion is that of another mode.
fn other_mode(row: &Row, found: &Loudness) -> Option<String> {
    let motion = &found.motions[row.attempt().motion?];
    let nearest = motion.nearest.as_ref()?;
    let own = row.way.kind == WayKind::Mode && nearest.modes.contains(&row.way.number);
    if own || row.way.kind == WayKind::Candidate {
        return None;
    }
    let frequency = motion.ending.frequency?;
    Some(format!(
        "{}, but its motion has {frequency:.2} Hz, nearest to mode {} ({:.2} Hz, {:+.4} 1/s)",
        grows(row, found),
        numbers(&nearest.modes),
        nearest.frequency,
        nearest.growth_rate
    ))
}

/// The sentence on a candidate whose contact states no motion takes.
fn not_met(row: &Row, found: &Loudness) -> Option<String> {
    let attempt = row.attempt();
    let moves = found.motions[attempt.motion?].ending.kind.is_cycle();
    (moves && attempt.meets == Some(false)).then(|| {
        format!(
            "{}: pushes along it lead to a motion in which contacts never take the states {} together",
            row.way.name(),
            row.way.states
        )
    })
}

/// The sentence on a way without a motion of known size.
fn no_motion(row: &Row, found: &Loudness, observation: &ObservationSettings) -> Option<String> {
    let (name, attempt) = (row.way.name(), row.attempt());
    if let Some(failure) = &attempt.failure {
        return Some(format!("{name}: the run failed: {failure}"));
    }
    let Some(motion) = attempt.motion else {
        let ending = attempt.ending.as_ref()?;
        return Some(if ending.linear {
            format!("{name}: the motion has no size of its own, and its loudness is unknown")
        } else {
            format!(
                "{name}: the motion had not settled after {} s, so its loudness is unknown; a longer --longest may show it",
                Short(observation.longest)
            )
        });
    };
    match found.motions[motion].ending.kind {
        Kind::Equilibrium if row.way.kind == WayKind::Candidate => Some(format!(
            "{name}: every push came to rest; no loud motion was found here, which does not exclude one"
        )),
        Kind::Equilibrium => Some(format!("{}, but its motion comes to rest", grows(row, found))),
        Kind::Unbounded => Some(format!(
            "{name}: the motion grows without bound, since nothing in the scene limits it; it has no loudness"
        )),
        _ => None,
    }
}

/// The sentences on ranks.
fn ranks(found: &Loudness) -> Vec<String> {
    let ranked: Vec<&Row> = found.rows.iter().filter(|row| row.loudness_rank.is_some()).collect();
    let mut motions: Vec<usize> = ranked.iter().filter_map(|row| row.attempt().motion).collect();
    motions.sort_unstable();
    motions.dedup();
    match (ranked.len(), motions.len()) {
        (0 | 1, _) => return Vec::new(),
        (ways, 1) => {
            let kind = if found.grows { "growing modes" } else { "candidates" };
            return vec![format!(
                "all {ways} {kind} with a settled motion lead to the same one: their growth rates differ, its loudness does not"
            )];
        }
        _ => {}
    }
    let weakest = ranked.iter().filter_map(|row| row.loudness_rank).max().unwrap_or(1);
    let mut said = Vec::new();
    for row in &ranked {
        let Some(loud) = row.loudness_rank else { continue };
        let tells =
            row.growth_rank != loud && (row.growth_rank == 1 || loud == 1 || loud == weakest);
        if tells {
            let motion = match loud {
                1 => "the loudest".to_owned(),
                last if last == weakest => "the weakest".to_owned(),
                place => format!("only the {} loudest", ordinal(place)),
            };
            let but = if loud < row.growth_rank { "and yet" } else { "but" };
            said.push(format!("{}, {but} its motion is {motion}", grows(row, found)));
        }
    }
    if said.is_empty() {
        said.push("the ranks agree: what grows faster leads to a louder motion".to_owned());
    }
    said
}

/// "3", "3 and 4".
fn numbers(modes: &[usize]) -> String {
    let all: Vec<String> = modes.iter().map(ToString::to_string).collect();
    all.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::loudness::{Attempt, Measured, ModeShare, PointMotion, ways};
    use crate::study::{LongTermMotion, ObservationRequest, Watch};
    use amontons::scene::builtin;
    use serde_json::json;

    /// A motion of this frequency, Hz, and speed, m/s, that is nearest to a mode.
    fn motion(kind: Kind, frequency: f64, rms: f64, mode: usize) -> FoundMotion {
        let ending: LongTermMotion = serde_json::from_value(json!({
            "kind": kind, "amplitude": 1e-3, "frequency": frequency, "lines": [], "shares": [1.0, 0.0, 0.0, 0.0],
            "taken": [true, false, false, false], "time": 8.0, "rate": 0.0,
        }))
        .unwrap();
        let point = PointMotion {
            point: "pad".to_owned(),
            amplitude: 1e-3,
            rms,
            peak: 2.0 * rms,
            normal_rms: None,
            normal_peak: None,
        };
        let measured = Measured {
            span: 1.0,
            is_period: false,
            points: vec![point],
            rms_error: 0.0,
            power: None,
            states: Vec::new(),
            shares: Vec::new(),
        };
        let nearest = ModeShare { modes: vec![mode], frequency, growth_rate: 1.0, share: 0.9 };
        let moves = kind.is_cycle();
        FoundMotion {
            ending,
            measured: moves.then_some(measured),
            nearest: moves.then_some(nearest),
        }
    }

    /// Rows of modes with these numbers and growth rates, 1/s, each with the place of its motion.
    fn found(rows: &[(usize, f64, Option<usize>)], motions: Vec<FoundMotion>) -> Loudness {
        let way = ways(&builtin("set1").unwrap().scene(), 0, Watch::IDLE).unwrap().ways.remove(0);
        let row = |&(number, growth_rate, motion): &(usize, f64, Option<usize>)| {
            let mut way = way.clone();
            (way.number, way.growth_rate) = (number, growth_rate);
            let ending = motion.map_or_else(
                || self::motion(Kind::Unsettled, 1.0, 0.0, 1).ending,
                |motion| motions[motion].ending.clone(),
            );
            let ending = Some(ending);
            let attempts = vec![Attempt { push: 1e-3, ending, failure: None, meets: None, motion }];
            Row { way, attempts, chosen: 0, growth_rank: 0, loudness_rank: None }
        };
        let mut rows: Vec<Row> = rows.iter().map(row).collect();
        rank(&mut rows, &motions);
        Loudness { grows: true, rows, motions, unexamined: None, findings: Vec::new() }
    }

    fn said(found: &Loudness) -> Vec<String> {
        let scene = builtin("set1").unwrap().scene();
        let observation = ObservationSettings::of(&scene, &ObservationRequest::default()).unwrap();
        disagreements(found, &observation)
    }

    #[test]
    fn a_mode_that_grows_fastest_to_the_weakest_motion_is_told() {
        let motions = vec![
            motion(Kind::Periodic, 100.0, 0.1, 3),
            motion(Kind::Periodic, 200.0, 0.3, 5),
            motion(Kind::Periodic, 300.0, 0.2, 7),
        ];
        let found = found(&[(3, 9.0, Some(0)), (5, 1.0, Some(1)), (7, 4.0, Some(2))], motions);
        let ranks: Vec<_> =
            found.rows.iter().map(|row| (row.growth_rank, row.loudness_rank)).collect();
        assert_eq!(ranks, [(1, Some(3)), (3, Some(1)), (2, Some(2))]);
        assert_eq!(
            said(&found),
            [
                "mode 3 grows fastest, but its motion is the weakest",
                "mode 5 grows most slowly, and yet its motion is the loudest"
            ]
        );
    }

    #[test]
    fn a_motion_with_the_frequency_of_another_mode_is_told_and_so_is_one_motion_of_all() {
        let all = found(
            &[(3, 9.0, Some(0)), (5, 10.0, Some(0))],
            vec![motion(Kind::Periodic, 100.0, 0.1, 3)],
        );
        let told = said(&all);
        assert!(
            told[0].starts_with(
                "mode 5 grows fastest, but its motion has 100.00 Hz, nearest to mode 3"
            )
        );
        assert!(told.len() == 2 && told[1].contains("lead to the same one"), "{told:?}");
    }

    #[test]
    fn ranks_that_agree_and_motions_of_which_nothing_is_known_are_told() {
        let motions =
            vec![motion(Kind::Periodic, 100.0, 0.1, 3), motion(Kind::Periodic, 200.0, 0.3, 5)];
        let agree = found(&[(3, 1.0, Some(0)), (5, 9.0, Some(1))], motions);
        assert_eq!(said(&agree), ["the ranks agree: what grows faster leads to a louder motion"]);
        let rest = motion(Kind::Unbounded, 0.0, 0.0, 1);
        let unknown = found(&[(3, 1.0, None), (5, 9.0, Some(0))], vec![rest]);
        assert_eq!(unknown.rows.iter().filter_map(|row| row.loudness_rank).count(), 0);
        let told = said(&unknown);
        assert!(
            told[0].contains("had not settled after 120 s") && told[1].contains("without bound")
        );
    }

    #[test]
    fn places_are_counted_in_words() {
        let all = [1, 2, 3, 4, 11, 12, 13, 21, 102].map(ordinal);
        assert_eq!(all, ["1st", "2nd", "3rd", "4th", "11th", "12th", "13th", "21st", "102nd"]);
    }
}
