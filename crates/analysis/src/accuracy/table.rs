//! The table of a study in words, without times: for the command line, and for the page in an FMU.

use super::{ConvergenceStudy, Errors, Row};
use amontons::decimal::to_significant;
use amontons::integrator::Statistics;
use amontons::scene::Scene;

/// Headings of the columns.
pub const COLUMNS: [&str; 10] = [
    "method",
    "step [s]",
    "steps",
    "events",
    "touch-downs",
    "rms error",
    "amplitude",
    "frequency",
    "times [s]",
    "order",
];

/// Meaning of the columns.
pub const LEGEND: &str = "rms error: error of all displacements, divided by their standard deviation. \
amplitude, frequency: relative errors\nof the cycle above. ≤: below the reference's own error. order: order of \
convergence from the row before; a few\nevents hide it. events: changes of contact state (difference from the \
reference). times: rms error of the times\nof events, if each contact goes through the same states.";

/// A number to four digits, without zeros at its end.
#[must_use]
pub fn short(value: f64) -> String {
    format!("{:e}", to_significant(value, 4))
}

/// An error; one at the floor is not larger than that.
fn cell(error: Option<f64>, floor: Option<f64>) -> String {
    match error {
        None => "-".to_owned(),
        Some(error) if Some(error) == floor => format!("≤{error:.1e}"),
        Some(error) => format!("{error:.1e}"),
    }
}

impl ConvergenceStudy {
    /// One line on the subject of the table.
    #[must_use]
    pub fn title(&self) -> String {
        let Scene { name, experiment, .. } = &self.scene;
        format!("{name}: what accuracy costs over {} s", experiment.stop_time)
    }

    /// The reference that the rows are compared with, as pairs of a word and a text.
    #[must_use]
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let statistics = self.reference.statistics;
        let reference = format!(
            "event-driven, step {} s: {} changes of contact state, {} touch-downs",
            short(self.reference_step),
            statistics.state_changes(),
            statistics.touch_downs
        );
        let mut facts = vec![("reference", reference)];
        if self.floor.rms.is_some() {
            let Errors { rms, amplitude, frequency, event_time, .. } = self.floor;
            let of = |what: &str, error: Option<f64>, unit: &str| {
                error.map(|error| format!("{what} {error:.1e}{unit}"))
            };
            let all = [
                of("rms", rms, ""),
                of("amplitude", amplitude, ""),
                of("frequency", frequency, ""),
                of("event times", event_time, " s"),
            ];
            let all = all.into_iter().flatten().collect::<Vec<_>>().join(", ");
            facts.push((
                "its own error",
                format!("{all} (difference from the same run with twice the step)"),
            ));
        }
        if let Some(amplitude) = self.cycle.amplitude.filter(|_| self.scale.is_some()) {
            let dof = &self.scene.dof_names()[self.dof];
            let at = self.cycle.frequency.map_or_else(String::new, |hz| format!(" at {hz:.2} Hz"));
            facts.push((
                "cycle",
                format!("{dof}: ±{amplitude:.4e} m{at}, over the last half of the run"),
            ));
        }
        facts
    }

    /// The cells of a row under [`COLUMNS`]; `order` is that from the row before.
    #[must_use]
    pub fn cells(&self, row: &Row, order: Option<f64>) -> [String; COLUMNS.len()] {
        let Row { candidate, statistics, events_more, errors } = row;
        let floor = self.floor;
        [
            candidate.method.to_string(),
            short(candidate.step),
            statistics.steps.to_string(),
            match events_more {
                0 => statistics.state_changes().to_string(),
                more => format!("{} ({more:+})", statistics.state_changes()),
            },
            statistics.touch_downs.to_string(),
            match row.is_out_of_phase() {
                true => "out of phase".to_owned(),
                false => cell(errors.rms, floor.rms),
            },
            cell(errors.amplitude, floor.amplitude),
            cell(errors.frequency, floor.frequency),
            cell(errors.event_time, floor.event_time),
            order.map_or_else(|| "-".to_owned(), |order| format!("{order:.2}")),
        ]
    }

    /// Notes on facts that the rows do not show.
    #[must_use]
    pub fn notes(&self, rows: &[Row]) -> Vec<String> {
        let mut notes = Vec::new();
        match &self.critical {
            Ok(critical) if critical.step < self.scene.experiment.output_interval => {
                notes.push(format!(
                    "the paper's scheme runs only with steps up to its critical step, {critical}"
                ));
            }
            Ok(_) => {}
            Err(error) => notes.push(format!("the paper's scheme is left out: {error}")),
        }
        if self.scale.is_none() {
            notes.push(
                "the scene does not move, so there is no amplitude to compare the errors with; give it an \
                 [[initial]] velocity, or a [[signal]]"
                    .to_owned(),
            );
        } else if self.cycle.amplitude.is_none() {
            notes.push(format!(
                "{} does not move over the last half of the run, so it has no amplitude and no frequency to compare",
                self.scene.dof_names()[self.dof]
            ));
        }
        if self.is_chaotic() {
            notes.push(format!(
                "the rms error of the reference is {:.0e}, as in a chaotic motion, which amplifies small \
                 differences: compare amplitude and frequency, or use a shorter --stop-time to compare \
                 the rms error too",
                self.floor.rms.unwrap_or(0.0)
            ));
        } else if rows.iter().any(Row::is_out_of_phase) {
            notes.push(
                "out of phase: the rms error is at least half of the displacements' standard deviation; compare \
                 amplitude and frequency instead"
                    .to_owned(),
            );
        }
        let ended = |statistics: &Statistics| statistics.ended_hops;
        let reference = ended(&self.reference.statistics);
        let most = rows.iter().map(|row| ended(&row.statistics)).fold(reference, u64::max);
        if most > 0 {
            notes.push(format!(
                "event-driven runs ended at most {most} hops of contacts that land many times within a step \
                 (reference: {reference}); the errors in the table include the effect of this"
            ));
        }
        notes
    }
}
