//! The pictures of a study of perturbations: final amplitudes and histories.

use super::attractor::{four_digits, unit_of, words};
use amontons::numerics::range;
use amontons::scene::Scene;
use amontons_analysis::study::perturbation::{Direction, Perturbations, Run, Threshold};
use amontons_analysis::study::{ObservationSettings, history};
use amontons_pictures::picture::{Chart, Mark, Marker, Panel, Series, Style};

/// Final amplitude over the initial perturbation.
#[must_use]
pub fn endings(
    scene: &Scene,
    direction: &Direction,
    observation: &ObservationSettings,
    found: &Perturbations,
) -> Chart {
    let unit = unit_of(scene, &observation.of);
    let points = |attractor: Option<usize>| {
        let runs = found.runs.iter().filter(|run| run.attractor == attractor);
        let point = |run: &Run| Some([run.amplitude, run.ending.as_ref()?.amplitude]);
        runs.filter_map(point).collect::<Vec<_>>()
    };
    let mut series: Vec<Series> = found
        .attractors
        .iter()
        .enumerate()
        .map(|(place, ending)| Series {
            label: Some(words(ending, unit)),
            points: points(Some(place)),
            colour: place,
            style: Style::Dots,
            marker: Some(Marker::ALL[place % Marker::ALL.len()]),
            ..Series::default()
        })
        .collect();
    let unsettled = points(None);
    if !unsettled.is_empty() {
        series.push(Series {
            label: Some("unsettled".to_owned()),
            points: unsettled,
            colour: found.attractors.len(),
            style: Style::Dots,
            ..Series::default()
        });
    }
    let perturbed = unit_of(scene, &direction.name);
    let marks = found.thresholds.iter().map(|threshold| {
        let [a, b] = threshold.between;
        let middle = 0.5 * (a + b);
        Mark { x: middle, label: Some(format!("threshold {}", four_digits(middle, perturbed))) }
    });
    Chart {
        title: format!("{}: attractors reached from perturbations", scene.name),
        x_label: format!("{} [{perturbed}]", direction.name),
        panels: vec![Panel {
            y_label: format!("Final amplitude of {} [{unit}]", observation.of),
            series,
            marks: marks.collect(),
            zero_line: true,
            ..Panel::default()
        }],
        logarithmic: false,
    }
}

/// The runs on both sides of a threshold over time; `None` if the work was ended.
pub fn histories(
    scene: &Scene,
    direction: &Direction,
    observation: &ObservationSettings,
    (found, threshold): (&Perturbations, &Threshold),
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Chart>, amontons::Error> {
    let ends = threshold.attractors.map(|place| &found.attractors[place]);
    let settled = |amplitude: &f64| {
        let run = found.runs.iter().find(|run| run.amplitude == *amplitude);
        run.and_then(|run| run.ending.as_ref()).map_or(observation.window, |ending| ending.time)
    };
    let duration = threshold.between.iter().map(settled).fold(0.0, f64::max);
    let mut curves = Vec::new();
    for amplitude in threshold.between {
        let rows = history(scene, (&direction.name, amplitude), observation, duration, is_over)?;
        let Some(rows) = rows else { return Ok(None) };
        curves.push(thinned(&rows, observation.interval));
    }
    // The runs last much longer than it takes to see their end, so only the beginning is shown.
    let shown = 1.5 * curves.iter().map(|curve| seen_to_settle(curve)).fold(0.0, f64::max);
    let unit = unit_of(scene, &observation.of);
    let panel = |(place, curve): (usize, Vec<[f64; 2]>)| {
        let what = words(ends[place], unit);
        let start = four_digits(threshold.between[place], unit_of(scene, &direction.name));
        Panel {
            y_label: format!("{} [{unit}]", observation.of),
            series: vec![Series {
                label: Some(format!("just {} {start}: {what}", ["below", "above"][place])),
                points: curve.into_iter().filter(|[time, _]| *time <= shown).collect(),
                colour: threshold.attractors[place],
                ..Series::default()
            }],
            zero_line: true,
            ..Panel::default()
        }
    };
    Ok(Some(Chart {
        title: format!("{}: on both sides of a threshold of {}", scene.name, direction.name),
        x_label: "Time [s]".to_owned(),
        panels: curves.into_iter().enumerate().map(panel).collect(),
        logarithmic: false,
    }))
}

/// A history thinned for a picture: the smallest and then the largest value of each of some thousand stretches.
#[allow(clippy::cast_precision_loss)]
#[must_use]
pub fn thinned(rows: &[f64], interval: f64) -> Vec<[f64; 2]> {
    const STRETCHES: usize = 2000;
    let length = rows.len().div_ceil(STRETCHES);
    let stretches = rows.chunks_exact(length).enumerate().flat_map(|(place, stretch)| {
        let [low, high] = range(stretch.iter().copied());
        let time = |part: f64| ((place as f64 + part) * length as f64) * interval;
        [[time(0.0), low], [time(0.5), high]]
    });
    stretches.collect()
}

/// The last time, s, at which a thinned history is farther from its end than a twentieth of its largest value.
fn seen_to_settle(curve: &[[f64; 2]]) -> f64 {
    let [.., low, high] = curve else { return 0.0 };
    let near = 0.05 * curve.iter().fold(0.0, |most, [_, value]| f64::max(most, value.abs()));
    let differs =
        |two: &&[[f64; 2]]| (two[0][1] - low[1]).abs() > near || (two[1][1] - high[1]).abs() > near;
    curve.chunks(2).rfind(differs).map_or(0.0, |two| two[0][0])
}
