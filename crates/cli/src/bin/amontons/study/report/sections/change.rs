//! What to change: effects of parameters, and changes of the most effective ones computed anew.

use super::super::Report;
use super::super::changes::Change;
use super::super::sliding::Found;
use super::{cell, figure, table};
use amontons_analysis::stability::{CriticalFriction, ModeSensitivity, Sensitivities};
use amontons_cli::words::sensitivity::{
    Effect, bars, by_growth, critical_effects, mode_effects, place, signed, value,
    without_derivatives,
};
use amontons_cli::words::{at_frequency, digits, four};
use amontons_pictures::report::{Content, Section, Table};

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
    if drawn.groups.is_empty() {
        section.text.push("No parameter has an effect on these modes.".to_owned());
        return section;
    }
    if !found.changes.is_empty() {
        section.key_tables.push(computed(&found.changes));
    }
    let caption = "The most effective parameters: what +1 % of each changes. Bars to the left lower a growth rate, which is better; \
                   bars to the right raise a critical µ, which is better.";
    section.figures.push(figure(caption, Content::Bars(drawn)));
    for mode in modes.into_iter().take(MOST_MODES) {
        section.tables.extend(of_mode(sensitivities, mode));
        section.text.extend(notes(mode));
    }
    section.tables.extend(critical.iter().filter_map(of_critical));
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

fn computed(changes: &[Change]) -> Table {
    let row = |change: &Change| {
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
        ]
    };
    table(
        "Changes of the most effective parameters: the growth rate that derivatives predict, and the largest one of all modes, computed \
         anew",
        &["Change", "Predicted [1/s]", "Computed [1/s]", "Result", "Growth begins at µ"],
        changes.iter().map(row).collect(),
    )
}

/// The changes of an effect, of equal modes all that differ.
fn several(effect: &Effect<'_>, part: usize) -> String {
    let mut all: Vec<String> = effect.changes.iter().map(|change| signed(change[part])).collect();
    all.dedup();
    all.join(" and ")
}

fn of_mode(found: &Sensitivities, mode: &ModeSensitivity) -> Option<Table> {
    mode.derivatives.as_ref()?;
    let effects = mode_effects(found, mode);
    let rows = effects.iter().take(FIRST).map(|effect| {
        let by = if effect.is_by_unit() { " for +1" } else { "" };
        vec![
            effect.parameter.name.clone().into(),
            value(effect.parameter).into(),
            (several(effect, 0) + by).into(),
            (several(effect, 1) + by).into(),
        ]
    });
    let caption = format!(
        "Mode at {:.2} Hz, growth rate {} 1/s: changes for +1 % of each parameter",
        mode.frequency_hz(),
        four(mode.growth_rate())
    );
    Some(table(
        caption,
        &["Parameter", "Value", "Growth rate [1/s]", "Frequency [Hz]"],
        rows.collect(),
    ))
}

fn of_critical(critical: &CriticalFriction) -> Option<Table> {
    let effects = critical_effects(critical);
    let rows: Vec<_> = effects
        .iter()
        .take(FIRST)
        .map(|effect| {
            vec![
                effect.parameter.name.clone().into(),
                value(effect.parameter).into(),
                several(effect, 0).into(),
            ]
        })
        .collect();
    let turn = if critical.becomes_unstable { "begins" } else { "ceases" };
    let caption = format!(
        "Critical µ = {}, where a mode {turn} to grow {}: changes of this µ for +1 % of each parameter",
        digits(critical.value, 6),
        at_frequency(critical.frequency_hz)
    );
    (!rows.is_empty()).then(|| table(caption, &["Parameter", "Value", "Change of µ"], rows))
}
