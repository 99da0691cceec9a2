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
        said.extend(several(row));
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
    // Nearness in frequency is no proof.
    let strongest = motion.strongest().map_or_else(String::new, |strongest| {
        format!(
            "; mode {} ({:.2} Hz) has the largest share of the kinetic energy, {:.0} %",
            strongest.numbers(),
            strongest.frequency,
            100.0 * strongest.share
        )
    });
    Some(format!(
        "{}, but its motion has {frequency:.2} Hz, nearest to mode {} ({:.2} Hz, {:+.4} 1/s){strongest}",
        grows(row, found),
        nearest.numbers(),
        nearest.frequency,
        nearest.growth_rate
    ))
}

/// The sentence on a candidate that stands for several modes of one eigenvalue.
fn several(row: &Row) -> Option<String> {
    (row.way.copies > 1).then(|| {
        format!(
            "{} stands for {} modes of one eigenvalue, of which one was pushed; others may lead elsewhere",
            row.way.name(),
            row.way.copies
        )
    })
}

/// The sentence on a candidate whose contact states no motion takes.
fn not_met(row: &Row, found: &Loudness) -> Option<String> {
    let moves = found.motions[row.attempt().motion?].ending.kind.is_cycle();
    let is_met = row.attempts.iter().any(|attempt| attempt.meets == Some(true));
    let is_candidate = row.way.kind == WayKind::Candidate;
    (is_candidate && moves && !is_met).then(|| {
        format!(
            "{}: pushes along it lead to motions in which contacts were not seen to take the states {} together",
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
        return Some(if ending.rests() {
            format!("{}, but its motion decays to rest", grows(row, found))
        } else if ending.linear && ending.kind == Kind::Unsettled {
            format!(
                "{name}: the motion still grew after {} s, so its loudness is unknown; a longer --longest, or a larger --push of \
                 `amontons study loudness`, may show it",
                Short(observation.longest)
            )
        } else if ending.linear {
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
        Kind::Equilibrium => Some(format!("{}, but its motion decays to rest", grows(row, found))),
        Kind::Unbounded => Some(format!(
            "{name}: the motion grows without bound, since nothing in the scene limits it; it has no loudness"
        )),
        _ => None,
    }
}

/// The sentences on ranks: pairs of which one grows faster and leads to a quieter motion.
fn ranks(found: &Loudness) -> Vec<String> {
    let loudness = |row: &Row| {
        let measured = found.motions[row.attempt().motion?].measured.as_ref()?;
        Some((measured.loudest().rms, measured.rms_error.max(EQUAL)))
    };
    let ranked: Vec<(&Row, (f64, f64))> =
        found.rows.iter().filter_map(|row| Some((row, loudness(row)?))).collect();
    let moving = |motion: &usize| found.motions[*motion].measured.is_some();
    let reached = ranked.iter().flat_map(|(row, _)| &row.attempts);
    let mut motions: Vec<usize> =
        reached.filter_map(|attempt| attempt.motion).filter(moving).collect();
    motions.sort_unstable();
    motions.dedup();
    match (ranked.len(), motions.len()) {
        (0 | 1, _) => return Vec::new(),
        (ways, 1) => {
            let kind = if found.grows { "growing modes" } else { "candidates" };
            let rates: Vec<f64> = ranked.iter().map(|(row, _)| row.way.growth_rate).collect();
            let differ = rates.iter().any(|rate| place(*rate, &rates) > 1);
            let and =
                if differ { ": their growth rates differ, its loudness does not" } else { "" };
            return vec![format!(
                "all {ways} {kind} with a settled motion lead to the same one{and}"
            )];
        }
        _ => {}
    }
    let mut said = Vec::new();
    for (row, (own, error)) in &ranked {
        let is_louder = |other: &&(&Row, (f64, f64))| {
            let (way, (rms, other_error)) = **other;
            row.way.growth_rate > way.way.growth_rate * (1.0 + EQUAL)
                && *own < rms * (1.0 - error.max(other_error))
        };
        let louder: Vec<String> =
            ranked.iter().filter(is_louder).map(|(way, _)| way.way.name()).collect();
        if !louder.is_empty() {
            said.push(format!(
                "{} grows faster than {}, but leads to a quieter motion",
                row.way.name(),
                louder.join(" and ")
            ));
        }
    }
    if said.is_empty() {
        said.push(
            "growth and loudness agree: nothing that grows faster leads to a quieter motion"
                .to_owned(),
        );
    }
    said
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

    const AGREE: &str =
        "growth and loudness agree: nothing that grows faster leads to a quieter motion";

    /// Ranks by growth counted rows and ranks by loudness counted motions: their comparison told disagreements that were none,
    /// and overlooked one between two others.
    #[test]
    fn only_a_faster_mode_with_a_quieter_motion_disagrees() {
        let loud = |rms: f64, mode: usize| motion(Kind::Periodic, 100.0 * rms, rms, mode);
        // Two modes share the loudest motion.
        let shared = found(
            &[(3, 9.0, Some(0)), (5, 5.0, Some(0)), (7, 1.0, Some(1))],
            vec![loud(0.3, 3), loud(0.1, 7)],
        );
        assert_eq!(said(&shared)[1..], [AGREE]);
        // The fastest has not settled.
        let unknown = found(
            &[(3, 9.0, None), (5, 5.0, Some(0)), (7, 1.0, Some(1))],
            vec![loud(0.3, 5), loud(0.1, 7)],
        );
        assert_eq!(said(&unknown)[1..], [AGREE]);
        // Two of equal growth.
        let equal = found(
            &[(3, 5.0, Some(0)), (5, 5.0, Some(1)), (7, 1.0, Some(2))],
            vec![loud(0.2, 3), loud(0.3, 5), loud(0.1, 7)],
        );
        assert_eq!(said(&equal), [AGREE]);
        // The middle two have changed places.
        let middle = found(
            &[(1, 9.0, Some(0)), (2, 7.0, Some(1)), (3, 5.0, Some(2)), (4, 1.0, Some(3))],
            vec![loud(0.4, 1), loud(0.2, 2), loud(0.3, 3), loud(0.1, 4)],
        );
        assert_eq!(
            said(&middle),
            ["mode 2 grows faster than mode 3, but leads to a quieter motion"]
        );
        // A double mode with one motion.
        let double = found(&[(3, 5.0, Some(0)), (4, 5.0, Some(0))], vec![loud(0.2, 3)]);
        let last = said(&double).pop().unwrap();
        assert_eq!(last, "all 2 growing modes with a settled motion lead to the same one");
    }

    #[test]
    fn a_mode_with_more_of_the_kinetic_energy_is_named_beside_the_one_of_nearest_frequency() {
        let share = |mode: usize, frequency: f64, share: f64| ModeShare {
            modes: vec![mode],
            frequency,
            growth_rate: -1.0,
            share,
        };
        let mut one = motion(Kind::Periodic, 100.0, 0.1, 4);
        one.measured.as_mut().unwrap().shares = vec![share(4, 100.0, 0.6), share(6, 130.0, 0.4)];
        assert_eq!(one.strongest(), None);
        let told = said(&found(&[(6, 5.0, Some(0))], vec![one.clone()]));
        assert!(told[0].ends_with("nearest to mode 4 (100.00 Hz, +1.0000 1/s)"), "{told:?}");
        one.measured.as_mut().unwrap().shares.reverse();
        let told = said(&found(&[(5, 5.0, Some(0))], vec![one]));
        let expected = "; mode 6 (130.00 Hz) has the largest share of the kinetic energy, 40 %";
        assert!(told[0].ends_with(expected), "{told:?}");
    }

    #[test]
    fn a_candidate_of_several_modes_says_that_one_was_pushed() {
        let mut double = found(&[(1, 5.0, Some(0))], vec![motion(Kind::Periodic, 100.0, 0.1, 1)]);
        assert_eq!(said(&double), Vec::<String>::new());
        double.rows[0].way.copies = 2;
        let told = said(&double);
        assert!(told[0].contains("stands for 2 modes of one eigenvalue"), "{told:?}");
    }

    #[test]
    fn a_motion_that_still_grows_may_be_shown_by_a_longer_run() {
        let mut slow = found(&[(3, 0.05, None)], vec![]);
        let ending = slow.rows[0].attempts[0].ending.as_mut().unwrap();
        (ending.linear, ending.rate) = (true, 0.05);
        let told = said(&slow);
        assert!(
            told[0].contains("still grew after 120 s") && told[0].contains("--longest"),
            "{told:?}"
        );
        slow.rows[0].attempts[0].ending.as_mut().unwrap().rate = -0.05;
        assert!(said(&slow)[0].contains("decays to rest"));
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
                "mode 3 grows faster than mode 5 and mode 7, but leads to a quieter motion",
                "mode 7 grows faster than mode 5, but leads to a quieter motion"
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
        assert_eq!(said(&agree), [AGREE]);
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
