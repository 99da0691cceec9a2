//! Section 3: Fig. 4.

use super::growth_claims;
use super::scene;
use amontons::Error;
use amontons::scene::Experiment;
use amontons_analysis::study::Watch;
use amontons_analysis::study::transient::{Transient, transient};
use amontons_cli::charts::transient::chart;
use amontons_pictures::report::{Content, Figure, Section, Table};

pub fn section(watch: Watch<'_>) -> Result<Option<Section>, Error> {
    let (scene, observation) = scene("set1", &[])?;
    let experiment = Experiment { output_interval: observation.interval, ..scene.experiment };
    let found = transient(&scene, experiment, Some("module[1].x1"), watch)?;
    if let Some(failure) = found.failure {
        return Err(failure);
    }
    if !found.complete {
        return Ok(None);
    }
    let Some(claims) = growth_claims::claims(&scene, watch)? else { return Ok(None) };
    let figure = Figure {
        caption: "Fig. 4: a small perturbation of Set 1 at µ = 1.96: time history, amplitudes band by band with the \
                  growth that was found, spectrogram, and the contacts' states"
            .to_owned(),
        command: Some("amontons study transient set1 --of 'module[1].x1'".to_owned()),
        content: Content::Chart(chart(&scene, &found)),
    };
    Ok(Some(Section {
        claims,
        figures: vec![figure],
        tables: vec![table(&found)],
        ..Section::default()
    }))
}

/// A table of all growth and decay in the run.
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
        head: ["time [s]", "frequency [Hz]", "growth rate [1/s]", "uniform sliding [1/s]", "contact states"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    }
}
