//! Does it squeal: the modes of uniform sliding, over µ too, and candidates where none grows.

use super::super::Report;
use super::super::number as four;
use super::super::sliding::{Found, OverFriction};
use super::{cell, figure, sentence, table};
use amontons_analysis::stability::Mode;
use amontons_analysis::stability::locus::is_growing;
use amontons_analysis::study::loudness::WayKind;
use amontons_cli::words::{at_frequency, digits};
use amontons_pictures::picture::{Mark, numbered_locus_chart};
use amontons_pictures::report::{Content, Section, Table};
use std::f64::consts::TAU;

pub const HEADING: &str = "Does it squeal?";

/// Modes that are told, those that grow fastest first.
const MOST_MODES: usize = 24;
/// Degrees of freedom of which the shape of the leading mode is told.
const MOST_DOFS: usize = 16;
/// Curves that have a name each.
const NAMED: usize = 12;

pub fn section(report: &Report<'_>) -> Section {
    let sliding = &report.sliding;
    let mut section = Section { heading: HEADING.to_owned(), ..Section::default() };
    section.text.push(format!(
        "In uniform sliding every closed contact slides (state {}) and the structure rests. A mode of it that grows turns a small motion into a \
         lasting one; a mode that decays lets it die out. Of contact states, Sl means sliding, R-Sl sliding the other way along the \
         contact's tangent, St sticking and Dt open.",
        sliding.state
    ));
    match &sliding.found {
        Err(reason) => section.text.push(format!("Modes are not known: {reason}.")),
        Ok(found) => {
            section.key_tables.push(modes(found));
            section.tables.extend(shape(report, found));
        }
    }
    match &sliding.over_friction {
        Err(reason) => section.text.push(format!("Modes over the friction coefficient: {reason}.")),
        Ok(over) => {
            section.text.extend(turns(over));
            let mut chart = numbered_locus_chart(
                format!("{}: modes of uniform sliding over friction", report.scene.name),
                "friction coefficient µ".to_owned(),
                &over.locus,
                &over.numbers,
            );
            let is_crowded = over.locus.branches.len() > NAMED;
            for series in chart.panels.iter_mut().flat_map(|panel| &mut panel.series) {
                series.label = series.label.take().filter(|_| !is_crowded);
            }
            if let Some(panel) = chart.panels.first_mut() {
                let own = report.still.friction_coefficient;
                panel.marks.push(Mark { x: own, label: Some("this scene".to_owned()) });
            }
            let caption = "Growth rate (above) and frequency (below) of each mode over the friction coefficient. A mode above the zero \
                           line grows. Marks show where one begins to grow, and where two merge. Modes have the numbers of the table, which \
                           are those at the scene's µ.";
            section.figures.push(figure(caption, Content::Chart(chart)));
        }
    }
    section.key_tables.extend(candidates(report));
    section
}

fn modes(found: &Found) -> Table {
    let mut all: Vec<(usize, &Mode)> = found.numbered().collect();
    let count = all.len();
    if count > MOST_MODES {
        all.sort_by(|a, b| b.1.growth_rate().total_cmp(&a.1.growth_rate()));
        all.truncate(MOST_MODES);
    }
    let row = |(number, mode): (usize, &Mode)| {
        let grows = is_growing(mode.eigenvalue);
        let texts = [
            format!("mode {number}"),
            format!("{:.2}", mode.frequency_hz()),
            four(mode.growth_rate()),
            damping_ratio(mode),
            turn(mode).to_owned(),
        ];
        texts.map(|text| cell(text, grows)).to_vec()
    };
    let caption = match count {
        0..=MOST_MODES => "Modes of uniform sliding".to_owned(),
        _ => format!("The {MOST_MODES} least stable of {count} modes of uniform sliding"),
    };
    let head = ["Mode", "Frequency [Hz]", "Growth rate [1/s]", "Damping ratio", ""];
    table(caption, &head, all.into_iter().map(row).collect())
}

/// The damping ratio in per cent; a motion that neither oscillates nor decays has none.
fn damping_ratio(mode: &Mode) -> String {
    let ratio = 100.0 * mode.damping_ratio();
    if !ratio.is_finite() {
        return "–".to_owned();
    }
    let told = format!("{ratio:.3} %");
    // Zero has no sign.
    if told == "-0.000 %" { told.replace('-', "") } else { told.replace('-', "−") }
}

/// `grows`, `decays`, or neither.
fn turn(mode: &Mode) -> &'static str {
    let rate = mode.growth_rate();
    if rate > 0.0 {
        "grows"
    } else if rate < 0.0 {
        "decays"
    } else {
        "neither grows nor decays"
    }
}

/// The shape of the leading mode: amplitudes, of which the largest is 1, and phases.
fn shape(report: &Report<'_>, found: &Found) -> Option<Table> {
    let (number, mode) = found.leading()?;
    let names = report.scene.dof_names();
    if names.len() != mode.shape.len() || names.len() > MOST_DOFS {
        return None;
    }
    let row = |(name, part): (&String, &nalgebra::Complex<f64>)| {
        let is_still = part.norm() < 1e-3;
        let phase = if is_still {
            "–".to_owned()
        } else {
            format!("{:.0}°", part.arg() / TAU * 360.0).replace('-', "−")
        };
        vec![name.clone().into(), format!("{:.3}", part.norm()).into(), phase.into()]
    };
    let caption =
        format!("Shape of mode {number}: amplitude as a part of the largest one, and phase");
    let rows = names.iter().zip(&mode.shape).map(row).collect();
    Some(table(caption, &["Displacement", "Amplitude", "Phase"], rows))
}

/// Where modes begin or cease to grow, in words.
pub fn turns(over: &OverFriction) -> Vec<String> {
    let first = over.locus.values[0];
    let range = format!("from µ = {} to {}", digits(first, 6), digits(over.end, 6));
    let one = |one: &amontons_analysis::stability::CriticalFriction| {
        let turns = if one.becomes_unstable { "begins" } else { "ceases" };
        format!(
            "µ = {}: a mode {turns} to grow {}",
            digits(one.value, 6),
            at_frequency(one.frequency_hz)
        )
    };
    let turns: Vec<String> = over.critical.iter().map(one).collect();
    let grows = over.locus.branches.iter().any(|branch| branch[0].lambda.re > 0.0);
    let mut said = vec![match (&turns[..], grows) {
        ([], false) => format!("No mode grows {range}."),
        ([], true) => format!("A mode grows everywhere {range}."),
        _ => format!("Critical values {range}: {}.", turns.join("; ")),
    }];
    if over.is_cut {
        said.push(
            "Larger µ is impossible in this scene: uniform sliding has no equilibrium there, or static friction would be below kinetic \
             friction."
                .to_owned(),
        );
    }
    said
}

/// The growing modes of other contact states, where none of uniform sliding grows.
fn candidates(report: &Report<'_>) -> Option<Table> {
    let loud = report.loudness.as_ref().ok()?;
    let ways = loud.ways.ways.iter().filter(|way| way.kind == WayKind::Candidate);
    let rows = ways.map(|way| {
        let texts = [
            way.name(),
            way.states.clone(),
            format!("{:.2}", way.frequency),
            four(way.growth_rate),
        ];
        texts.map(|text| cell(text, false)).to_vec()
    });
    let rows: Vec<_> = rows.collect();
    (!rows.is_empty()).then(|| {
        let caption = sentence(
            "candidates for a second motion: modes that grow in other contact states, into which only a push brings the contacts",
        );
        table(caption, &["Candidate", "Contact states", "Frequency [Hz]", "Growth rate [1/s]"], rows)
    })
}
