//! What to change: effects of parameters, and changes of the most effective ones computed anew.

use super::super::Report;
use super::super::answers::unstable_after;
use super::super::changes::Change;
use super::super::sliding::Found;
use super::super::{number as four, per_cent};
use super::{cell, figure, scene_words, table};
use amontons::decimal::to_significant;
use amontons_analysis::assign::FRICTION;
use amontons_analysis::stability::{CriticalFriction, ModeSensitivity, Sensitivities};
use amontons_cli::words::sensitivity::{
    Effect, bars, by_growth, critical_effects, mode_effects, place, signed, value,
    without_derivatives,
};
use amontons_cli::words::{at_frequency, digits};
use amontons_pictures::report::{Cell, Content, Section, Table};

pub const HEADING: &str = "What to change?";

/// Parameters that are told of each mode and each critical µ.
const FIRST: usize = 8;
/// Modes that have a table, those that grow fastest first.
const MOST_MODES: usize = 4;

pub fn section(report: &Report<'_>) -> Section {
    let mut section = Section { heading: HEADING.to_owned(), ..Section::default() };
    let found = match &report.sliding.found {
        Ok(found) => found,
        Err(reason) => {
            section.text.push(format!("Effects of parameters are not known: {reason}."));
            return section;
        }
    };
    let sensitivities = match &found.sensitivities {
        Ok(sensitivities) => sensitivities,
        Err(reason) => {
            section.text.push(format!("Effects of parameters are not known: {reason}."));
            return section;
        }
    };
    section.text.extend(about(report, found));
    let critical: &[CriticalFriction] =
        report.sliding.over_friction.as_ref().map_or(&[], |over| &over.critical);
    let modes = by_growth(sensitivities);
    let title = format!("{}: the most effective parameters", report.scene.name);
    let drawn = bars(title, sensitivities, modes.iter().copied().take(MOST_MODES), critical, FIRST);
    match &found.changes {
        Ok(changes) if changes.is_empty() => {
            section.text.push(
                "No parameter that may be changed by 5 and 10 % has an effect on these modes and critical µ."
                    .to_owned(),
            );
        }
        Ok(changes) => {
            section.key_tables.push(computed(report, changes));
            section.text.push(of_scatter(report));
            add_design(report, changes, &mut section);
        }
        Err(reason) => {
            section.text.push(format!("Changes that help most are not known: {reason}."));
        }
    }
    let caption = "The most effective parameters: what +1 % of each changes. Bars to the left lower a growth rate, which is better; \
                   bars to the right raise a critical µ, which is better.";
    if !drawn.groups.is_empty() {
        section.figures.push(figure(caption, Content::Bars(drawn)));
    }
    for mode in modes.into_iter().take(MOST_MODES) {
        section.tables.extend(of_mode(sensitivities, mode));
        section.text.extend(notes(mode));
    }
    for one in critical {
        section.tables.extend(of_critical(one));
        if let Err(reason) = &one.derivatives {
            section.text.push(format!(
                "Effects on the critical µ = {} are not known: {reason}.",
                digits(one.value, 6)
            ));
        }
    }
    section
}

fn about(report: &Report<'_>, found: &Found) -> Vec<String> {
    let mut said = vec![
        "Derivatives tell what a small change of one parameter does. The first table changes the most effective ones by 5 and 10 % and \
         computes all eigenvalues anew, since derivatives hold for small changes only."
            .to_owned(),
    ];
    if found.growing().is_empty() {
        said.push(
            "No mode grows here. Effects are those on the least stable mode and on critical µ: they tell what keeps uniform sliding stable, \
             and not what prevents a motion that a push leads to."
                .to_owned(),
        );
    }
    let loud = report.loudness.as_ref().ok();
    if loud.is_some_and(|loud| loud.found.grows) {
        said.push("A change that stops all growth leaves it open if a push still leads to a lasting motion.".to_owned());
    }
    said
}

/// Limits of the derivatives of a mode, in words.
fn notes(mode: &ModeSensitivity) -> Option<String> {
    let hz = format!("The mode at {:.2} Hz", mode.frequency_hz());
    if let Some(merging) = &mode.merging {
        return Some(format!("{hz} {}: effects are those on this µ.", place(merging)));
    }
    if mode.derivatives.is_none() {
        return Some(format!("{hz}: {}.", without_derivatives(mode)));
    }
    (mode.holds_within < 0.05).then(|| {
        format!(
            "{hz} is near another one: its derivatives may hold only for changes below {} of a parameter.",
            digits(mode.holds_within, 2)
        )
    })
}

/// The sentence on probabilities after changes.
fn of_scatter(report: &Report<'_>) -> String {
    let after = &report.after;
    if let Some(reason) = after.unstable.iter().find_map(|(_, found)| found.as_ref().err()) {
        return format!(
            "The probability that a changed scene is unstable is not known for all changes: {reason}."
        );
    }
    if after.unstable.is_empty() {
        return "The probability that a changed scene is unstable was not computed, since it takes long for this scene: amontons study \
                robustness with --set computes it."
            .to_owned();
    }
    "P(unstable) is that of the changed scene, with an interval of 95 %: its parameters scatter as those of the scene do. It is computed \
     for the changes that the beginning of this page names."
        .to_owned()
}

/// The part of the scene's µ up to which a design is sought.
const BEYOND: f64 = 1.2;

/// Adds the command that looks for the smallest change of these parameters after which no mode grows.
fn add_design(report: &Report<'_>, changes: &[Change], section: &mut Section) {
    let Ok(over) = &report.sliding.over_friction else { return };
    let is_stable = report.sliding.found.as_ref().is_ok_and(|found| found.growing().is_empty());
    let own = report.still.friction_coefficient;
    let first = over.locus.values[0];
    // Friction scatters: about half of all scenes like this one have more of it.
    let last = if is_stable { over.end } else { to_significant(BEYOND * own, 6).min(over.end) };
    if is_stable && over.next().is_none() || last <= first {
        return;
    }
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in changes.iter().flat_map(|change| &change.parameters) {
        if name != FRICTION && !names.contains(&&**name) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return;
    }
    let vary: String = names.iter().map(|name| format!(" --vary '{name}=±10%'")).collect();
    // Runs start from uniform sliding under a constant drive.
    let runs = if report.scene.signals.is_empty() { "" } else { " --runs 0" };
    section.text.push(format!(
        "The command below looks for the smallest change of these parameters, each by up to 10 %, after which no mode grows from µ = {} to \
         {}, and verifies it.",
        digits(first, 6),
        digits(last, 6)
    ));
    section.commands.push(format!(
        "amontons study design {}{vary} --friction {first}:{last}{runs}",
        scene_words(report)
    ));
}

fn computed(report: &Report<'_>, changes: &[Change]) -> Table {
    let row = |(place, change): (usize, &Change)| {
        let rate = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), four);
        let result = match (change.computed, change.growing) {
            (None, _) => "no equilibrium".to_owned(),
            (_, 0) => "no mode grows".to_owned(),
            (_, 1) => "1 mode grows".to_owned(),
            (_, count) => format!("{count} modes grow"),
        };
        let grows = change.growing > 0;
        vec![
            change.name().into(),
            rate(change.predicted).into(),
            rate(change.computed).into(),
            cell(result, grows),
            change.onset.to_string().into(),
            match unstable_after(report, place) {
                Some(Ok(found)) => {
                    let [value, low, high] = per_cent(found);
                    format!("{value} % ({low} to {high})")
                }
                Some(Err(_)) => "unknown".to_owned(),
                None => "–".to_owned(),
            }
            .into(),
        ]
    };
    table(
        "Changes of the most effective parameters: the growth rate that derivatives predict, and the largest one of all modes, computed \
         anew",
        &[
            "Change",
            "Predicted [1/s]",
            "Computed [1/s]",
            "Result",
            "Growth begins at µ",
            "P(unstable)",
        ],
        changes.iter().enumerate().map(row).collect(),
    )
}

/// The changes of an effect, of equal modes all that differ.
fn several(effect: &Effect<'_>, part: usize) -> String {
    let told = |change: &[f64; 2]| signed(change[part]).replace('-', "−");
    let mut all: Vec<String> = effect.changes.iter().map(told).collect();
    all.dedup();
    all.join(" and ")
}

fn of_mode(found: &Sensitivities, mode: &ModeSensitivity) -> Vec<Table> {
    if mode.derivatives.is_none() {
        return Vec::new();
    }
    let caption = format!(
        "Mode at {:.2} Hz, growth rate {} 1/s",
        mode.frequency_hz(),
        four(mode.growth_rate())
    );
    of_effects(&caption, &mode_effects(found, mode), &["Growth rate [1/s]", "Frequency [Hz]"])
}

fn of_critical(critical: &CriticalFriction) -> Vec<Table> {
    let turn = if critical.becomes_unstable { "begins" } else { "ceases" };
    let caption = format!(
        "Critical µ = {}, where a mode {turn} to grow {}",
        digits(critical.value, 6),
        at_frequency(critical.frequency_hz)
    );
    of_effects(&caption, &critical_effects(critical), &["Change of µ"])
}

/// The effects of +1 % of the parameters, and in a table of its own those of one unit of parameters that are zero.
fn of_effects(caption: &str, effects: &[Effect<'_>], quantities: &[&str]) -> Vec<Table> {
    let (by_unit, by_part): (Vec<_>, Vec<_>) =
        effects.iter().partition(|effect| effect.is_by_unit());
    let changes = |effect: &Effect<'_>| -> Vec<Cell> {
        (0..quantities.len()).map(|part| several(effect, part).into()).collect()
    };
    let rows = |effects: &[&Effect<'_>], second: &dyn Fn(&Effect<'_>) -> String| {
        let row = |effect: &&Effect<'_>| {
            let named = vec![effect.parameter.name.clone().into(), second(effect).into()];
            [named, changes(effect)].concat()
        };
        effects.iter().take(FIRST).map(row).collect::<Vec<Vec<Cell>>>()
    };
    let of_parts = rows(&by_part, &|effect| value(effect.parameter));
    let moves = |effect: &&Effect<'_>| effect.largest() != [0.0; 2];
    let by_unit: Vec<_> = by_unit.into_iter().filter(moves).collect();
    let of_units = rows(&by_unit, &|effect| match effect.parameter.unit {
        "" => "per 1".to_owned(),
        unit => format!("per {unit}"),
    });
    let head = |second: &'static str| [&["Parameter", second], quantities].concat();
    let told = |more: &str, second: &'static str, rows: Vec<Vec<Cell>>| {
        (!rows.is_empty()).then(|| table(format!("{caption}: {more}"), &head(second), rows))
    };
    let parts = told("changes for +1 % of each parameter", "Value", of_parts);
    let units = told("changes for one unit of parameters that are 0 here", "Change", of_units);
    parts.into_iter().chain(units).collect()
}
