//! The answer on changes: those that help most, with the growth rate, the probability of growth and the motion after them.

use super::super::Report;
use super::super::after::{ChangedMotion, Outcome};
use super::super::changes::{Change, MOST_NAMED, Onset, best, together};
use super::super::sliding::OverFriction;
use super::super::{number as four, per_cent};
use super::least_push;
use amontons_analysis::robustness::Estimate;
use amontons_cli::words::digits;
use std::cmp::Ordering::Equal;

pub(super) fn change(report: &Report<'_>) -> Vec<String> {
    let found = match &report.sliding.found {
        Ok(found) => found,
        Err(reason) => return vec![format!("Unknown: {reason}.")],
    };
    let changes = match &found.changes {
        Ok(changes) => changes,
        Err(reason) => return vec![format!("Unknown: {reason}.")],
    };
    let single = best(changes);
    let is_stable = found.growing().is_empty();
    let Some((_, leading)) = found.leading() else {
        return vec!["Unknown: uniform sliding has no mode.".to_owned()];
    };
    let next = report.sliding.over_friction.as_ref().ok().and_then(OverFriction::next);
    let next = next.filter(|_| is_stable);
    if changes.is_empty() {
        let of = next.map_or_else(
            || "the growth rate of the leading mode".to_owned(),
            |next| format!("the critical µ = {}", digits(next.value, 4)),
        );
        return vec![format!("No change of a single parameter by 10 % moves {of}.")];
    }
    // Without its µ at which growth begins a change is ordered by its growth rate.
    let next = next.filter(|_| changes.iter().any(|one| one.onset != Onset::NotSought));
    let now = four(leading.growth_rate());
    let result = |change: &Change| match change.computed {
        None => "there is no equilibrium".to_owned(),
        Some(rate) => {
            let grows = if change.growing == 0 { "no mode grows" } else { "a mode still grows" };
            let growth = format!("the largest growth rate is {} 1/s, {grows}", four(rate));
            match change.onset {
                Onset::NotSought => growth,
                Onset::At(onset) => {
                    format!("{growth}; growth begins at µ = {}", digits(onset, 4))
                }
                Onset::Outside([from, to]) => {
                    format!("{growth} from µ = {} to {}", digits(from, 4), digits(to, 4))
                }
            }
        }
    };
    let squeals = report.loudness.as_ref().is_ok_and(|loud| least_push(&loud.found).is_some());
    let stable = if squeals {
        "Uniform sliding is stable as it is. Which change prevents the motion after a push is unknown; what widens the margin of uniform \
         sliding is known."
    } else {
        "Nothing needs to change for uniform sliding to be stable."
    };
    let none = "No change of one parameter by 10 % that was computed improves this.";
    let mut said = vec![match (is_stable, next) {
        (false, _) if single.is_empty() => format!("The largest growth rate is {now} 1/s. {none}"),
        (false, _) => format!(
            "The largest growth rate is {now} 1/s. Of the changes of one parameter that were computed anew these help most:"
        ),
        (true, Some(next)) if single.is_empty() => {
            format!("{stable} A mode begins to grow at µ = {}. {none}", digits(next.value, 4))
        }
        (true, Some(next)) => format!(
            "{stable} A mode begins to grow at µ = {}; of the changes of one parameter that were computed anew these raise \
             this µ most:",
            digits(next.value, 4)
        ),
        (true, None) if single.is_empty() => {
            format!("{stable} The largest growth rate is {now} 1/s. {none}")
        }
        (true, None) => format!(
            "{stable} The largest growth rate is {now} 1/s; of the changes that were computed anew these help most:"
        ),
    }];
    let unstable = |place: usize| match unstable_after(report, place) {
        Some(Ok(found)) => {
            let [value, low, high] = per_cent(found);
            format!(
                "; P(unstable) with the same scatter {value} % (95 % interval {low} to {high} %)"
            )
        }
        _ => String::new(),
    };
    let told = |place: usize| {
        let change = &changes[place];
        format!("{}: {}{}", change.name(), result(change), unstable(place))
    };
    let mut named: Vec<usize> = single.iter().copied().take(MOST_NAMED - 1).collect();
    let probability = |place: &usize| {
        unstable_after(report, *place).and_then(|found| Some(found.as_ref().ok()?.value))
    };
    // Of several that help the one with the least probability of growth is told first.
    if named.iter().all(|place| probability(place).is_some()) {
        named.sort_by(|a, b| probability(a).partial_cmp(&probability(b)).unwrap_or(Equal));
    }
    said.extend(named.into_iter().map(told));
    said.extend(together(changes).map(|place| format!("All at once, {}.", told(place))));
    said.extend(report.after.motion.as_ref().map(|motion| motion_after(motion, changes)));
    said
}

/// The probability that the scene is unstable after a change; `None` if it was not computed.
pub fn unstable_after<'a>(
    report: &'a Report<'_>,
    change: usize,
) -> Option<&'a Result<Estimate, String>> {
    let of_change = report.after.unstable.iter().find(|(place, _)| *place == change);
    of_change.map(|(_, found)| found)
}

/// The sentence on the motion after a change.
fn motion_after(motion: &ChangedMotion, changes: &[Change]) -> String {
    let ChangedMotion { start, change, before, after } = motion;
    let name = changes[*change].name();
    let before = four(*before);
    match after {
        Ok(Outcome::Rests) => format!(
            "After {name} the motion from the same start, along {start}, comes to rest; before, its fastest point had {before} m/s rms. \
             Other starts may lead elsewhere."
        ),
        Ok(Outcome::Lasts(speed)) => format!(
            "After {name} the same start, along {start}, still leads to a lasting motion: its fastest point has {} m/s rms, and had {before} \
             m/s rms before.",
            four(*speed)
        ),
        Err(reason) => format!(
            "It is unknown if the start along {start} still squeals after {name}: {reason}."
        ),
    }
}
