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
