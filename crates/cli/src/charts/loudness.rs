//! The picture of growth beside loudness: over frequency, the growth rate of each mode above the speed of each motion.

use amontons::scene::Scene;
use amontons_analysis::study::loudness::{FoundMotion, Loudness};
use amontons_pictures::picture::{Chart, Marker, Panel, Series, Style};

/// The frequencies end at this many times the highest one, so that labels beside points have room.
const ROOM: f64 = 1.15;

/// A point over a frequency (Hz), with its label, and the place of its colour in the palette.
struct Stem {
    at: [f64; 2],
    label: String,
    colour: usize,
}

/// Growth rates over the frequencies of modes, and below them speeds over the frequencies of motions. A mode has the colour of
/// its motion; a mode without a measured motion is the last colour.
#[must_use]
pub fn chart(scene: &Scene, found: &Loudness) -> Chart {
    let none = found.motions.len();
    let modes = found.rows.iter().map(|row| Stem {
        at: [row.way.frequency, row.way.growth_rate],
        label: row.way.name(),
        colour: row.attempt().motion.unwrap_or(none),
    });
    let of_motion = |(place, motion): (usize, &FoundMotion)| {
        let speed = motion.measured.as_ref()?.loudest().rms;
        let label = format!("motion {}, {}", place + 1, motion.ending.kind.name());
        Some(Stem { at: [motion.ending.frequency?, speed], label, colour: place })
    };
    let (modes, motions): (Vec<Stem>, Vec<Stem>) =
        (modes.collect(), found.motions.iter().enumerate().filter_map(of_motion).collect());
    let highest = modes.iter().chain(&motions).map(|stem| stem.at[0]).fold(0.0, f64::max);
    let end = if highest > 0.0 { ROOM * highest } else { 1.0 };
    let panel = |y_label: &str, stems: &[Stem]| Panel {
        y_label: y_label.to_owned(),
        series: series(stems, end),
        zero_line: true,
        ..Panel::default()
    };
    let mut panels = vec![panel("Growth rate [1/s]", &modes)];
    if !motions.is_empty() {
        panels.push(panel("Speed of the fastest point, rms [m/s]", &motions));
    }
    Chart {
        title: format!("{}: growth rates of modes, and loudness of their motions", scene.name),
        x_label: "Frequency [Hz]".to_owned(),
        panels,
        logarithmic: false,
    }
}

/// The line of zero up to a frequency (Hz), and a line with a point at its upper end for each stem.
fn series(stems: &[Stem], end: f64) -> Vec<Series> {
    let zero =
        Series { points: vec![[0.0, 0.0], [end, 0.0]], style: Style::Muted, ..Series::default() };
    let lines = stems.iter().map(|Stem { at, colour, .. }| Series {
        points: vec![[at[0], 0.0], *at],
        colour: *colour,
        ..Series::default()
    });
    let points = stems.iter().map(|Stem { at, label, colour }| Series {
        points: vec![*at],
        labels: vec![label.clone()],
        colour: *colour,
        style: Style::Dots,
        marker: Some(Marker::Disc),
        ..Series::default()
    });
    [zero].into_iter().chain(lines).chain(points).collect()
}
