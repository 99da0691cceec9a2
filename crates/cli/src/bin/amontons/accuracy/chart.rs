//! The picture of `amontons accuracy`.

use super::AccuracyReport;
use amontons::decimal::to_significant;
use amontons::scene::Method;
use amontons_analysis::accuracy::{Errors, StepCandidate};
use amontons_pictures::picture::{Chart, Panel, Series, Style, prefixed};

impl AccuracyReport<'_> {
    /// Error against time, both logarithmic, with the reference's own error as a dashed line.
    pub(super) fn chart(&self) -> Chart {
        let chaotic = self.study.is_chaotic();
        let pick = |errors: &Errors| if chaotic { errors.amplitude } else { errors.rms };
        let shown = self.rows.iter().filter_map(|timed| {
            Some((timed.row.candidate, [1e3 * timed.seconds?, pick(&timed.row.errors)?]))
        });
        let shown: Vec<(StepCandidate, [f64; 2])> = shown.collect();
        let curve = |method, label: &str, colour| {
            let rows = shown.iter().filter(|(candidate, _)| candidate.method == method);
            Series {
                label: Some(label.to_owned()),
                points: rows.clone().map(|(_, point)| *point).collect(),
                labels: rows
                    .map(|(candidate, _)| prefixed(to_significant(candidate.step, 4), "s"))
                    .collect(),
                colour,
                ..Series::default()
            }
        };
        let times = shown.iter().map(|(_, [time, _])| *time);
        let ends = [times.clone().fold(f64::INFINITY, f64::min), times.fold(0.0, f64::max)];
        let floor = pick(&self.study.floor()).map(|floor| Series {
            label: Some("the reference's own error".to_owned()),
            points: ends.map(|time| [time, floor]).to_vec(),
            colour: 6,
            style: Style::Dashed,
            ..Series::default()
        });
        let curves = [
            curve(Method::ForwardIncrement, "forward increment, by step", 0),
            curve(Method::EventDriven, "event-driven, by step", 1),
        ];
        let curves = curves.into_iter().filter(|series| !series.points.is_empty());
        let error = if chaotic { "Error of the amplitude" } else { "Relative rms error" };
        Chart {
            title: self.study.title(),
            x_label: "Computing time of a simulated second [ms]".to_owned(),
            panels: vec![Panel {
                y_label: format!("{error} [–]"),
                series: floor.into_iter().chain(curves).collect(),
                ..Panel::default()
            }],
            logarithmic: true,
        }
    }
}
