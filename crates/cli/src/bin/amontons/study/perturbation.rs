//! `amontons study perturbation`.

use super::arguments::{Common, Looking};
use super::attractor::{self, four_digits, number, unit_of, words};
use super::folder::Folder;
use super::{heading, interrupted, prepared, watched};
use crate::arguments::{Values, values};
use crate::say::say;
use amontons::numerics::range;
use amontons::scene::Scene;
use amontons_analysis::study::perturbation::{
    Direction, Perturbations, Run, Threshold, perturbation,
};
use amontons_analysis::study::{Look, history, initial_value};
use amontons_pictures::picture::{Chart, Mark, Marker, Panel, Series, Style};
use clap::Args;
use serde_json::json;
use std::error::Error;

#[derive(Args)]
pub struct Perturbation {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    looking: Looking,
    /// The initial value that is varied, such as module[1].v2; the others stay as the scene or --set has them
    #[arg(long, value_name = "NAME")]
    direction: String,
    /// Its values from A to B, in steps or N of them
    #[arg(long, value_name = "A:B:STEP|A:B/N", value_parser = values, allow_hyphen_values = true)]
    amplitude: Values,
    /// How closely thresholds are found: to this part of themselves
    #[arg(long, value_name = "PART", default_value_t = 1e-3, allow_hyphen_values = true)]
    resolution: f64,
}

pub fn run(arguments: &Perturbation) -> Result<(), Box<dyn Error>> {
    let Perturbation { common, looking, direction: name, amplitude, resolution } = arguments;
    let (scene, source, look) = prepared(common, looking)?;
    let direction = Direction {
        name: initial_value(&scene, name)?,
        amplitudes: amplitude.0.clone(),
        resolution: *resolution,
    };
    if common.set.iter().any(|(set, _)| *set == direction.name) {
        eprintln!("note: {} takes the values of --amplitude, not that of --set", direction.name);
    }
    // Neither the range nor the resolution changes what a run ends in: either may be widened later.
    let settings = json!({ "direction": direction.name, "look": look });
    let folder = Folder::open(common, "perturbation", (&scene, &source), settings)?;
    let found = watched(|watch| perturbation(&scene, &direction, &look, folder.journal(), watch))?;
    let Some(found) = found else { return Err(interrupted(&folder)) };
    folder.write_csv(
        &["amplitude", "kind", "attractor", "final_amplitude", "frequency", "time"],
        found.runs.iter().map(row),
    )?;
    folder.write_json(json!({ "direction": direction, "found": found }))?;
    print(&scene, &direction, &look, &found);
    folder.draw("perturbation", &endings(&scene, &direction, &look, &found))?;
    if let Some(threshold) = found.thresholds.first() {
        match watched(|watch| {
            histories(&scene, &direction, &look, (&found, threshold), &|| watch.is_over())
        })? {
            Some(chart) => folder.draw("histories", &chart)?,
            None => return Err(interrupted(&folder)),
        }
    }
    say!("\nresults and pictures are in {}", folder.path().display());
    Ok(())
}

fn row(run: &Run) -> [String; 6] {
    let Run { amplitude, ending, attractor, .. } = run;
    let value = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:?}"));
    let ending = ending.as_ref();
    [
        format!("{amplitude:?}"),
        ending.map_or("failed", |ending| ending.kind.name()).to_owned(),
        number(*attractor),
        value(ending.map(|ending| ending.amplitude)),
        value(ending.and_then(|ending| ending.frequency)),
        value(ending.map(|ending| ending.time)),
    ]
}

fn print(scene: &Scene, direction: &Direction, look: &Look, found: &Perturbations) {
    let unit = unit_of(scene, &direction.name);
    say!("{}: {}, {unit}", scene.name, direction.name);
    say!("{}", heading(&[(scene, look)]));
    attractor::print(&found.attractors, &look.of, unit_of(scene, &look.of));
    say!("\n{:<27}  runs  end in", direction.name);
    for same in found.runs.chunk_by(|a, b| class(a) == class(b)) {
        let [first, last] = [&same[0], &same[same.len() - 1]].map(|run| run.amplitude);
        let range = if same.len() == 1 { format!("{first}") } else { format!("{first} to {last}") };
        say!("{range:<27}  {:>4}  {}", same.len(), class(&same[0]));
    }
    if let Some(failure) = found.runs.iter().find_map(|run| run.failure.as_ref()) {
        eprintln!("note: the first that failed: {failure}");
    }
    say!("\nthresholds, to {:e} of themselves", direction.resolution);
    for Threshold { between: [below, above], attractors: [from, to] } in &found.thresholds {
        say!("  between {below} and {above} {unit}: below {}, above {}", from + 1, to + 1);
    }
    let left = found.runs.iter().filter(|run| run.attractor.is_none()).count();
    if found.thresholds.is_empty() && left < found.runs.len() {
        say!("  none between neighbours that both end in an attractor");
    }
    if found.runs.len() > 1 {
        say!(
            "  changes that come and go between two neighbouring amplitudes are not seen; a smaller step of --amplitude shows \
             them"
        );
    }
    if left > 0 {
        say!("  unknown beside the runs that have not ended in an attractor, {left} of them");
    }
}

/// What a run ends in: the number of its attractor, or why it has none.
fn class(run: &Run) -> String {
    match (run.attractor, &run.ending) {
        (Some(place), _) => (place + 1).to_string(),
        (None, Some(ending)) => ending.kind.name().to_owned(),
        (None, None) => "failed".to_owned(),
    }
}

/// Final amplitude over the perturbation.
pub fn endings(scene: &Scene, direction: &Direction, look: &Look, found: &Perturbations) -> Chart {
    let unit = unit_of(scene, &look.of);
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
        title: format!("{}: what perturbations end in", scene.name),
        x_label: format!("{} [{perturbed}]", direction.name),
        panels: vec![Panel {
            y_label: format!("Final amplitude of {} [{unit}]", look.of),
            series,
            marks: marks.collect(),
            zero_line: true,
            ..Panel::default()
        }],
        logarithmic: false,
    }
}

/// The runs on both sides of a threshold over time; `None` if they were ended.
pub fn histories(
    scene: &Scene,
    direction: &Direction,
    look: &Look,
    (found, threshold): (&Perturbations, &Threshold),
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Chart>, amontons::Error> {
    let ends = threshold.attractors.map(|place| &found.attractors[place]);
    let settled = |amplitude: &f64| {
        let run = found.runs.iter().find(|run| run.amplitude == *amplitude);
        run.and_then(|run| run.ending.as_ref()).map_or(look.window, |ending| ending.time)
    };
    let duration = threshold.between.iter().map(settled).fold(0.0, f64::max);
    let mut curves = Vec::new();
    for amplitude in threshold.between {
        let rows = history(scene, (&direction.name, amplitude), look, duration, is_over)?;
        let Some(rows) = rows else { return Ok(None) };
        curves.push(thinned(&rows, look.interval));
    }
    // A motion is followed long after one sees where it goes.
    let shown = 1.5 * curves.iter().map(|curve| seen_to_settle(curve)).fold(0.0, f64::max);
    let unit = unit_of(scene, &look.of);
    let panel = |(place, curve): (usize, Vec<[f64; 2]>)| {
        let what = words(ends[place], unit);
        let start = four_digits(threshold.between[place], unit_of(scene, &direction.name));
        Panel {
            y_label: format!("{} [{unit}]", look.of),
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

/// A history as a picture can show it: of each of some thousand stretches its smallest value and then its largest.
#[allow(clippy::cast_precision_loss)]
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
