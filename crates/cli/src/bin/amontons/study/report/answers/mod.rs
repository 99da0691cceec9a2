//! The answers at the start of the page: a few sentences, each with its numbers.
//!
//! | file | contents |
//! | --- | --- |
//! | `change` | the answer on changes, and what follows from them |

mod change;

pub use change::unstable_after;

use super::Report;
use super::number as four;
use super::sections::{self, sentence};
use super::sliding::{Found, Growth};
use amontons_analysis::robustness::{Estimate, Index, Parameter};
use amontons_analysis::stability::locus::is_neutral;
use amontons_analysis::stability::{CriticalFriction, Mode};
use amontons_analysis::study::loudness::{Attempt, FoundMotion, Loudness, Measured};
use amontons_analysis::study::{Kind, LongTermMotion};
use amontons_cli::words::robustness as words;
use amontons_cli::words::{at_frequency, digits};
use amontons_export::documentation::counted;
use amontons_pictures::picture::prefixed;
use amontons_pictures::report::Answer;

/// Growing modes that are named.
const NAMED: usize = 4;
/// A scene is at the limit of growth if its µ is within this part of itself of it.
const NEAR: f64 = 0.01;
/// A motion has the frequency of a mode if the two differ by less than this part.
const ALIKE: f64 = 0.05;
/// Findings on motions that are told where none was measured.
const MOST_FINDINGS: usize = 3;

pub fn answers(report: &Report<'_>) -> Vec<Answer> {
    let answer = |question: &str, text: Vec<String>, section: &str| Answer {
        question: question.to_owned(),
        text,
        section: section.to_owned(),
    };
    vec![
        answer(sections::SQUEAL, squeal(report), sections::SQUEAL),
        answer(sections::LOUD, loud(report), sections::LOUD),
        answer(sections::PROBABLE, probable(report), sections::PROBABLE),
        answer(sections::CHANGE, change::change(report), sections::CHANGE),
    ]
}

fn squeal(report: &Report<'_>) -> Vec<String> {
    let found = match &report.sliding.found {
        Ok(found) => found,
        Err(reason) => return vec![format!("Unknown: {reason}.")],
    };
    let growing = found.growing();
    let mut said = if growing.is_empty() { quiet(report, found) } else { vec![grows(&growing)] };
    if let Ok(over) = &report.sliding.over_friction {
        let own = report.still.friction_coefficient;
        let told = |value: f64| digits(value, 4);
        let below = |one: &&CriticalFriction| !one.becomes_unstable && one.value <= own;
        if let Some(one) = over.critical.iter().rev().find(below).filter(|_| growing.is_empty()) {
            said.push(format!(
                "At smaller µ a mode grows: it ceases to at µ = {}.",
                told(one.value)
            ));
        }
        said.push(match over.growth() {
            Growth::Since(value) => {
                format!("Growth begins at µ = {}; the scene has µ = {}.", told(value), told(own))
            }
            Growth::From(value) => {
                let at = over.next().map(|one| format!(" ({})", at_frequency(one.frequency_hz)));
                let limit = if value - own < NEAR * own {
                    " It is at the limit of growth: less than 1 % more friction passes it."
                } else {
                    ""
                };
                format!(
                    "A mode begins to grow at µ = {}{}; the scene has µ = {}.{limit}",
                    told(value),
                    at.unwrap_or_default(),
                    told(own)
                )
            }
            Growth::Never => {
                format!(
                    "No mode grows from µ = {}, that of the scene, to {}.",
                    told(own),
                    told(over.end)
                )
            }
            Growth::Throughout => {
                let ceases = |one: &&CriticalFriction| !one.becomes_unstable && one.value > own;
                let end = over.critical.iter().find(ceases);
                let end = end.map_or_else(String::new, |end| {
                    format!("; a mode ceases to grow at µ = {}", told(end.value))
                });
                format!(
                    "The scene has µ = {}. A mode grows from µ = {} on{end}.",
                    told(own),
                    told(over.locus.values[0])
                )
            }
        });
    }
    said
}

/// The frequency of a mode, or that it has none.
fn oscillation(mode: &Mode) -> String {
    match (mode.frequency_hz(), mode.growth_rate()) {
        (0.0, rate) if rate > 0.0 => "without oscillating (divergence)".to_owned(),
        (0.0, rate) if rate < 0.0 => "without oscillating (overdamped)".to_owned(),
        (0.0, _) => "without oscillating (a free motion)".to_owned(),
        (frequency, _) => at_frequency(frequency),
    }
}

fn grows(growing: &[(usize, &Mode)]) -> String {
    let one = |(number, mode): &(usize, &Mode)| {
        format!(
            "mode {number} {}, by {} 1/s (tenfold in {})",
            oscillation(mode),
            four(mode.growth_rate()),
            prefixed(three(std::f64::consts::LN_10 / mode.growth_rate()), "s")
        )
    };
    let named: Vec<String> = growing.iter().take(NAMED).map(one).collect();
    let more = match growing.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    let count = counted(growing.len(), "mode grows", "modes grow");
    format!("Yes. Uniform sliding is unstable: {count}, {}{more}.", named.join("; "))
}

/// The answer where no mode grows: a push may lead to a motion, or none was found.
fn quiet(report: &Report<'_>, found: &Found) -> Vec<String> {
    let slowest = found.leading().map_or_else(String::new, |(number, mode)| {
        let at = oscillation(mode);
        let rate = -mode.growth_rate();
        // Damping that rounding alone makes is none.
        if is_neutral(mode.eigenvalue) {
            format!("the least stable one, mode {number} {at}, neither grows nor decays, since nothing damps it")
        } else {
            format!("the least stable one, mode {number} {at}, decays by {} 1/s", four(rate))
        }
    });
    let stable = format!("No mode of uniform sliding grows; {slowest}.");
    let Ok(loud) = &report.loudness else {
        return vec![format!(
            "Not by itself. {stable} It is unknown if a push starts a lasting motion."
        )];
    };
    let loud = &loud.found;
    if let Some(least) = least_push(loud) {
        let smaller = smaller_push(loud, least).map_or_else(String::new, |smaller| {
            format!(", and one of {} m/s in the same direction came to rest", four(smaller))
        });
        return vec![
            format!("A push can make it squeal. {stable}"),
            format!(
                "A push along a candidate led to a lasting motion; the smallest one of those tried that did has {} m/s{smaller}. \
                 Others between these, and other directions, may do so too.",
                four(least)
            ),
        ];
    }
    let is_unknown = |one: &Attempt| one.motion.is_none() && !rests(one);
    let unknown = loud.rows.iter().any(|row| row.attempts.iter().any(is_unknown));
    let tried = match (loud.rows.len(), unknown) {
        (0, _) if loud.unexamined.is_some() => {
            "Candidates for a second motion were not looked for, so it is unknown if a push starts one.".to_owned()
        }
        (0, _) => "No candidate for a second motion was found.".to_owned(),
        (count, false) => format!(
            "Pushes along {} came to rest, which does not exclude a lasting motion.",
            counted(count, "candidate", "candidates")
        ),
        (_, true) => "Some runs after pushes had not settled or failed, so it is unknown if their motions last.".to_owned(),
    };
    vec![format!("No squeal was found with the scene's own values. {stable}"), tried]
}

/// `true` if a motion came to rest.
fn rests(attempt: &Attempt) -> bool {
    attempt.ending.as_ref().is_some_and(LongTermMotion::rests)
}

/// The largest push, m/s, below the smallest that led to a motion which lasts, and along the same candidate, that came to rest.
fn smaller_push(loud: &Loudness, least: f64) -> Option<f64> {
    let row = loud.rows.iter().find(|row| row.attempts.iter().any(|one| one.push == least))?;
    let smaller = row.attempts.iter().filter(|one| one.push < least && rests(one));
    smaller.map(|one| one.push).max_by(f64::total_cmp)
}

/// The smallest push, m/s, that led to a motion which lasts.
fn least_push(loud: &Loudness) -> Option<f64> {
    let moves = |motion: usize| loud.motions[motion].ending.kind != Kind::Equilibrium;
    let attempts = loud.rows.iter().flat_map(|row| &row.attempts);
    let moving = attempts.filter(|attempt| attempt.motion.is_some_and(moves));
    moving.map(|attempt| attempt.push).min_by(f64::total_cmp)
}

fn loud(report: &Report<'_>) -> Vec<String> {
    let found = match &report.loudness {
        Ok(loud) => &loud.found,
        Err(reason) => return vec![format!("Unknown: {reason}.")],
    };
    if found.rows.is_empty() {
        return vec!["There is no motion whose loudness could be told.".to_owned()];
    }
    let Some((motion, measured)) = loudest(found) else {
        let mut said: Vec<String> = found.findings.iter().map(|said| sentence(said)).collect();
        said.truncate(MOST_FINDINGS);
        if said.is_empty() {
            said.push("No motion that lasts was found.".to_owned());
        }
        return said;
    };
    let point = measured.loudest();
    let at = motion.ending.frequency;
    let at = at.map_or_else(String::new, |frequency| format!(" at {frequency:.2} Hz"));
    let mut said = vec![format!(
        "The motion is {}{at}. {}, {}, moves with {} m/s rms and {} m/s at most, and an amplitude of {}.",
        motion.ending.kind.name(),
        match measured.points.len() {
            1 => "The measured point".to_owned(),
            count => format!("The fastest of {count} measured points"),
        },
        point.point,
        four(point.rms),
        four(point.peak),
        prefixed(three(point.amplitude), "m")
    )];
    if let Some(power) = &measured.power {
        said.push(format!("Friction feeds {} W into it.", four(power.friction)));
    }
    let undecided = found.rows.iter().filter(|row| {
        let attempt = row.attempt();
        let ending = attempt.ending.as_ref();
        !ending.is_some_and(LongTermMotion::rests)
            && (attempt.motion.is_none() || ending.is_some_and(|it| it.kind == Kind::Unbounded))
    });
    let undecided: Vec<String> = undecided.map(|row| row.way.name()).collect();
    if !undecided.is_empty() {
        said.push(format!(
            "It is unknown how loud the motion from {} becomes: its run failed, had not settled, or grows without bound.",
            undecided.join(", ")
        ));
    }
    let others = found.motions.iter().filter(|motion| motion.measured.is_some()).count() - 1;
    if others > 0 {
        said.push(format!(
            "{} besides {} quieter.",
            counted(others, "motion", "motions"),
            if others == 1 { "is" } else { "are" }
        ));
    }
    let of_modes = || report.sliding.found.as_ref().ok().map(Found::growing);
    if let (true, Some(nearest), Some(growing)) = (found.grows, &motion.nearest, of_modes())
        && !growing.iter().any(|(number, _)| nearest.modes.contains(number))
        && let Some(frequency) = motion.ending.frequency
        && (frequency - nearest.frequency).abs() < ALIKE * frequency
    {
        said.push(format!(
            "This is near mode {} ({:.2} Hz), which does not grow in uniform sliding, and not near a growing mode.",
            nearest.numbers(),
            nearest.frequency
        ));
    }
    said
}

/// The loudest motion that was measured.
pub fn loudest(found: &Loudness) -> Option<(&FoundMotion, &Measured)> {
    let measured = found.motions.iter().filter_map(|one| Some((one, one.measured.as_ref()?)));
    measured.max_by(|a, b| a.1.loudest().rms.total_cmp(&b.1.loudest().rms))
}

fn probable(report: &Report<'_>) -> Vec<String> {
    let mut said = Vec::new();
    let count = report.parameters.len();
    let scatter = if report.assumptions.is_assumed {
        let parts = match report.assumptions.has() {
            [true, true] if report.assumptions.has_friction_apart() => {
                "friction of each contact scatters by ±10 %, and masses and stiffnesses by ±5 %, all of one kind by the same part"
            }
            [true, true] if report.assumptions.is_together => {
                "friction scatters by ±10 %, and masses and stiffnesses by ±5 %, all of one kind by the same part"
            }
            [true, true] => "friction scatters by ±10 %, and each mass and stiffness by ±5 %",
            [true, false] => "friction scatters by ±10 %",
            _ => "each mass and stiffness scatters by ±5 %",
        };
        format!("If {parts} (assumed standard deviations)")
    } else {
        format!("With the scatter given for {}", counted(count, "parameter", "parameters"))
    };
    let both = match &report.robustness {
        Ok(both) => both,
        Err(reason) => return vec![format!("Unknown: {reason}.")],
    };
    if let Some(found) = &both.eigenvalues {
        let Estimate { value, low, high } = found.unstable;
        let [value, low, high] = [value, low, high].map(|part| 100.0 * part);
        let probability = if value == 0.0 {
            format!("in none of {} draws (95 % interval up to {high:.4} %)", found.draws)
        } else if value == 100.0 {
            format!("in all of {} draws (95 % interval from {low:.4} %)", found.draws)
        } else {
            format!("with a probability of {value:.1} % (95 % interval {low:.1} to {high:.1} %)")
        };
        said.push(format!("{scatter}, uniform sliding is unstable {probability}."));
        if found.no_equilibrium.value > 0.0 {
            said.push(format!(
                "{:.1} % of the draws have no equilibrium in sliding, and no modes that could grow.",
                100.0 * found.no_equilibrium.value
            ));
        }
        let indices = found.of_growth.as_deref().unwrap_or_default();
        said.extend(matters(&report.parameters.iter().zip(indices).collect::<Vec<_>>()));
    }
    if let Some(runs) = &both.runs {
        let pushes = report.arguments.scatter.pushes.as_ref();
        said.push(format!(
            "With this scatter it squeals after a random push of {} m/s with a probability of {} (95 % interval).",
            pushes.map(ToString::to_string).unwrap_or_default(),
            words::squeal(runs)
        ));
    }
    if said.is_empty() {
        said.push("Unknown: no parameter scatters.".to_owned());
    }
    said
}

/// The parameter whose scatter matters most, with its interval; the two first ones where their intervals overlap, or the second has more
/// than half of the first one's part; nothing where one of two that overlap may not matter at all.
fn matters(indices: &[(&Parameter, &Index)]) -> Option<String> {
    let mut sorted = indices.to_vec();
    sorted.sort_by(|a, b| b.1.first.value.total_cmp(&a.1.first.value));
    let told = |(parameter, index): (&Parameter, &Index)| {
        let [value, low, high] = [index.first.value, index.first.low, index.first.high]
            .map(|part| 100.0 * part.clamp(0.0, 1.0));
        format!("{} by {value:.0} % (95 % interval {low:.0} to {high:.0} %)", parameter.name())
    };
    let first = *sorted.first().filter(|one| one.1.first.low > 0.0)?;
    let if_known = "if its value were known, the variance of the growth rate would be smaller:";
    match sorted.get(1).copied() {
        Some(second) if second.1.first.high >= first.1.first.low => (second.1.first.low > 0.0)
            .then(|| {
                format!(
                    "Two scatters matter most, and which of them more is open; {if_known} {}, {}.",
                    told(first),
                    told(second)
                )
            }),
        second => {
            let large = |one: &(&Parameter, &Index)| one.1.first.value > 0.5 * first.1.first.value;
            let next = second.filter(large).map(|one| format!("; the next one is {}", told(one)));
            let next = next.unwrap_or_default();
            Some(format!("One scatter matters most; {if_known} {}{next}.", told(first)))
        }
    }
}

/// A value to three digits.
fn three(value: f64) -> f64 {
    amontons::decimal::to_significant(value, 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;
    use amontons_analysis::robustness::{Uncertain, parameters};

    #[test]
    fn the_scatter_that_matters_most_is_told_with_its_interval_or_with_the_next_one() {
        let scene = builtin("set1").unwrap().scene();
        let uncertain = [Uncertain::parse("module[*].k6=normal(±5%)").unwrap()];
        let both = parameters(&scene, &uncertain).unwrap();
        let told = |first: [f64; 3], second: [f64; 3]| {
            let index = |[value, low, high]: [f64; 3]| {
                let estimate = Estimate { value, low, high };
                Index { first: estimate, total: estimate }
            };
            let indices = [first, second].map(index);
            matters(&both.iter().zip(&indices).collect::<Vec<_>>())
        };
        let apart = told([0.2, 0.15, 0.25], [0.6, 0.55, 0.65]).unwrap();
        assert!(apart.starts_with("One scatter matters most"), "{apart}");
        assert!(apart.contains(": module[2].k6 by 60 % (95 % interval 55 to 65 %)."), "{apart}");
        let half = told([0.4, 0.35, 0.45], [0.6, 0.55, 0.65]).unwrap();
        assert!(half.contains("; the next one is module[1].k6 by 40 %"), "{half}");
        let near = told([0.58, 0.5, 0.66], [0.6, 0.55, 0.65]).unwrap();
        assert!(
            near.starts_with("Two scatters matter most") && near.contains("module[1].k6 by 58 %")
        );
        // Neither index is known to be above zero, or the second one is not.
        assert_eq!(told([0.1, -0.1, 0.3], [0.05, -0.1, 0.2]), None);
        assert_eq!(told([0.1, 0.01, 0.3], [0.05, -0.1, 0.2]), None);
    }
}
