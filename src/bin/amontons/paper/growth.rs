//! Section 3: Fig. 4.

use super::claims::{claim, is_about};
use super::scene;
use crate::study::transient::chart;
use amontons::Error;
use amontons::report::{Claim, Content, Figure, Section, Table};
use amontons::scene::Experiment;
use amontons::spectral::lines;
use amontons::study::Watch;
use amontons::study::transient::{Eigenvalue, Finding, Transient, transient};

/// A fitted rate and the eigenvalue's differ by less than this part where they are of one growth.
const SAME_RATE: f64 = 0.01;

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let (scene, look) = scene("set1", &[])?;
    let experiment = Experiment { output_interval: look.interval, ..scene.experiment };
    let found = transient(&scene, experiment, Some("module[1].x1"), watch)?;
    if let Some(failure) = found.failure {
        return Err(failure);
    }
    if !found.complete {
        return Ok(None);
    }
    let figure = Figure {
        caption: "Fig. 4: a small perturbation of Set 1 at µ = 1.96: time history, amplitudes band by band with the \
                  growth that was found, spectrogram, and the contacts' states"
            .to_owned(),
        command: Some("amontons study transient set1 --of 'module[1].x1'".to_owned()),
        content: Content::Chart(chart::chart(&scene, &found)),
    };
    Ok(Some(Section {
        claims: claims(&found),
        figures: vec![figure],
        tables: vec![table(&found)],
        ..Section::default()
    }))
}

/// Growths that are no combination of others, in order of their beginning.
fn growths(found: &Transient) -> impl Iterator<Item = &Finding> {
    let grows =
        |finding: &&Finding| finding.phase.rate > 0.0 && finding.phase.combination.is_none();
    found.findings.iter().filter(grows)
}

fn claims(found: &Transient) -> Vec<Claim> {
    let near = |hz: f64| growths(found).find(move |finding| is_about(finding.phase.frequency, hz));
    let (first, second) = (near(220.0), near(180.0));
    let told = |finding: Option<&Finding>| {
        finding.map_or("no such growth was found".to_owned(), |Finding { phase, .. }| {
            format!(
                "growth at {:.2} Hz with {:+.2} 1/s from {:.2} to {:.2} s",
                phase.frequency, phase.rate, phase.span[0], phase.span[1]
            )
        })
    };
    let eigenvalue = first.and_then(|finding| finding.resting);
    let ratio = first
        .zip(eigenvalue)
        .map(|(finding, eigenvalue)| finding.phase.rate / eigenvalue.rate - 1.0);
    let stuck = second.and_then(|finding| {
        finding.taken.iter().find(|taken| {
            taken.states.contains("St") && taken.eigenvalue.is_some_and(|value| value.rate > 0.0)
        })
    });
    vec![
        claim(
            "A small perturbation grows exponentially at about 220 Hz, by the growing mode of uniform sliding.",
            format!(
                "{}; the eigenvalue has {} (holds if rates agree to {} %)",
                told(first),
                eigenvalue.map_or("–".to_owned(), |Eigenvalue { rate, frequency }| {
                    format!("{frequency:.2} Hz and {rate:+.2} 1/s")
                }),
                100.0 * SAME_RATE
            ),
            ratio.is_some_and(|ratio| ratio.abs() <= SAME_RATE),
            None,
        ),
        claim(
            "It reaches a first orbit at about 1 s.",
            format!(
                "the first growth ends at {:.2} s, with a push of 1e-7 m/s, which is that of set1",
                first.map_or(f64::NAN, |finding| finding.phase.span[1])
            ),
            first.is_some_and(|finding| is_about(finding.phase.span[1], 1.0)),
            Some("the time depends on how small the push is, which the paper does not print"),
        ),
        claim(
            "A second band, at about 180 Hz, increases between 1 and 3 s.",
            format!("{} (holds if it begins after the first has ended, and covers 1.1 to 2.9 s)", told(second)),
            second.zip(first).is_some_and(|(second, first)| {
                second.phase.span[0] >= first.phase.span[1]
                    && second.phase.span[0] <= 1.1
                    && second.phase.span[1] >= 2.9
            }),
            None,
        ),
        claim(
            "It comes from the state with one contact stuck, which has unstable modes at about 168 and 217 Hz.",
            stuck.map_or("no growing mode of such a state is near it".to_owned(), |taken| {
                format!(
                    "contacts are in {} for {:.0} % of that time, where the nearest eigenvalue has {} (holds if it grows \
                     and has about that frequency; the growth found is slower, as other states take turns)",
                    taken.states,
                    100.0 * taken.share,
                    taken.eigenvalue.map_or(String::new(), |value| {
                        format!("{:.2} Hz and {:+.2} 1/s", value.frequency, value.rate)
                    })
                )
            }),
            stuck.and_then(|taken| taken.eigenvalue).is_some_and(|value| is_about(value.frequency, 168.0)),
            None,
        ),
        both_frequencies(found),
    ]
}

/// The lines of the last second.
fn both_frequencies(found: &Transient) -> Claim {
    let rows = (1.0 / found.interval).round() as usize;
    let last = &found.history[found.history.len().saturating_sub(rows)..];
    let lines = lines(last, found.interval, 0.01).lines;
    let told: Vec<String> = lines
        .iter()
        .take(4)
        .map(|line| format!("{:.2} Hz (±{:.2e} m)", line.frequency, line.amplitude))
        .collect();
    let has = |hz: f64| lines.iter().any(|line| is_about(line.frequency, hz));
    claim(
        "In the end frequencies of about 170 and 215 Hz are there together.",
        format!("strongest lines of the last second: {}", told.join(", ")),
        has(170.0) && has(215.0),
        None,
    )
}

/// All growth and decay that was found.
fn table(found: &Transient) -> Table {
    let rows = found.findings.iter().map(|finding| {
        let phase = &finding.phase;
        let states: Vec<String> = finding
            .taken
            .iter()
            .map(|taken| format!("{} {:.0} %", taken.states, 100.0 * taken.share))
            .collect();
        vec![
            format!("{:.2} to {:.2}", phase.span[0], phase.span[1]).into(),
            format!("{:.2}", phase.frequency).into(),
            format!("{:+.3} ± {:.1e}", phase.rate, phase.rate_error).into(),
            finding
                .resting
                .map_or("–".to_owned(), |value| {
                    format!("{:+.3} at {:.2} Hz", value.rate, value.frequency)
                })
                .into(),
            states.join(", ").into(),
        ]
    });
    Table {
        caption: "Growth and decay found in the run, beside the nearest eigenvalue of uniform sliding, and the contact \
                  states of that time"
            .to_owned(),
        head: ["time [s]", "frequency [Hz]", "rate [1/s]", "uniform sliding [1/s]", "contact states"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    }
}
