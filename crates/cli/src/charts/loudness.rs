//! The picture of growth beside loudness.

use amontons::scene::Scene;
use amontons_analysis::study::loudness::{FoundMotion, Loudness, Row};
use amontons_pictures::picture::{Chart, Mark, Marker, Panel, Series, Style};

/// Root mean square of the speed of a motion's fastest point, m/s; `None` of a motion that was not measured.
#[must_use]
pub fn speed(motion: &FoundMotion) -> Option<f64> {
    Some(motion.measured.as_ref()?.loudest().rms)
}

/// Speed over growth rate, one point for each way, one colour for each motion. What comes to rest has no speed; what has
/// no measured motion is not drawn.
#[must_use]
pub fn chart(scene: &Scene, found: &Loudness) -> Chart {
    let of_motion = |(place, motion): (usize, &FoundMotion)| {
        let speed = if motion.ending.rests() { Some(0.0) } else { speed(motion) };
        let rows: Vec<&Row> =
            found.rows.iter().filter(|row| row.attempt().motion == Some(place)).collect();
        let frequency = motion
            .ending
            .frequency
            .map_or_else(String::new, |frequency| format!(", {frequency:.2} Hz"));
        let kind = if motion.ending.rests() { "rest" } else { motion.ending.kind.name() };
        (!rows.is_empty()).then(|| Series {
            label: Some(format!("motion {}: {kind}{frequency}", place + 1)),
            points: rows.iter().filter_map(|row| Some([row.way.growth_rate, speed?])).collect(),
            labels: rows
                .iter()
                .filter(|_| speed.is_some())
                .map(|row| format!("{} ({:.0} Hz)", row.way.name(), row.way.frequency))
                .collect(),
            colour: place,
            style: Style::Dots,
            marker: Some(Marker::ALL[place % Marker::ALL.len()]),
        })
    };
    let series = found.motions.iter().enumerate().filter_map(of_motion);
    Chart {
        title: format!("{}: growth and loudness", scene.name),
        x_label: "Growth rate [1/s]".to_owned(),
        panels: vec![Panel {
            y_label: "Speed of the fastest point, rms [m/s]".to_owned(),
            series: series.filter(|series| !series.points.is_empty()).collect(),
            zero_line: true,
            marks: vec![Mark { x: 0.0, label: None }],
            ..Panel::default()
        }],
        logarithmic: false,
    }
}
