//! The picture of a study over the friction coefficient, upwards and downwards.

use super::kinds;
use amontons::scene::Scene;
use amontons_analysis::stability::candidates::Bistability;
use amontons_analysis::study::{
    Bistable, Continuation, Jump, Kind, LongTermMotion, ObservationSettings, Point, SweepDirection,
};
use amontons_pictures::picture::{Band, Chart, Mark, Panel, Series, Style};

/// Colours of ranges with two motions: rest and a cycle, two cycles, then other pairs.
const BANDS: [usize; 6] = [2, 4, 5, 3, 6, 7];

/// Amplitude and frequency of both ways, with jumps as marks and ranges with two motions shaded.
#[must_use]
pub fn chart(
    scene: &Scene,
    observation: &ObservationSettings,
    found: &Continuation,
    known: Option<&Bistability>,
) -> Chart {
    let ways = [("µ rising", SweepDirection::Rising, 0), ("µ falling", SweepDirection::Falling, 1)];
    let series = |value: fn(&LongTermMotion) -> f64| {
        let curve = |(label, way, colour): &(&str, SweepDirection, usize)| Series {
            label: Some((*label).to_owned()),
            points: curve(found, *way, value),
            colour: *colour,
            style: if *way == SweepDirection::Rising { Style::Line } else { Style::Dashed },
            ..Series::default()
        };
        ways.iter().map(curve).collect::<Vec<Series>>()
    };
    let mut pairs = ["rest and a cycle", "two cycles"].map(str::to_owned).to_vec();
    let band = |both: &Bistable| {
        let words = both.words();
        let place = pairs.iter().position(|pair| *pair == words).unwrap_or_else(|| {
            pairs.push(words.clone());
            pairs.len() - 1
        });
        let [from, to] = both.range;
        Band { from, to, label: Some(words), colour: BANDS[place % BANDS.len()] }
    };
    let bands: Vec<Band> = found.bistable.iter().map(band).collect();
    let jumps = found.jumps.iter().map(|jump| Mark {
        x: jump.at(),
        label: Some(format!("{} {:.4}", jump.way.name(), jump.at())),
    });
    let onsets = known.into_iter().flat_map(|known| &known.uniform).map(|crossing| Mark {
        x: crossing.value,
        label: Some(format!("{} {:.4}", turn(crossing.becomes_unstable), crossing.value)),
    });
    let mut amplitude = series(kinds::amplitude);
    amplitude.extend(kinds::marks(&[endings(&found.rising), endings(&found.falling)]));
    let frequency = series(|ending| match ending.frequency {
        Some(frequency) if !ending.rests() => frequency,
        _ => f64::NAN,
    });
    let mut panels = vec![Panel {
        y_label: format!("Amplitude of {} [m]", observation.of),
        series: amplitude,
        marks: jumps.chain(onsets).collect(),
        bands: bands.clone(),
        zero_line: true,
        ..Panel::default()
    }];
    let is_seen = |series: &Series| series.points.iter().any(|[_, y]| y.is_finite());
    if frequency.iter().any(is_seen) {
        panels.push(Panel {
            y_label: "Strongest frequency [Hz]".to_owned(),
            series: frequency,
            bands,
            ..Panel::default()
        });
    }
    Chart {
        title: format!("{}: motions over µ", scene.name),
        x_label: "Friction coefficient µ [–]".to_owned(),
        panels,
        logarithmic: false,
    }
}

/// The values whose runs have not failed, with the motions in which they end.
fn endings(points: &[Point]) -> Vec<(f64, &LongTermMotion)> {
    points.iter().filter_map(|point| Some((point.friction, point.ending.as_ref().ok()?))).collect()
}

/// A value of one way over µ, with what was found at both bounds of its jumps. The curve is broken at jumps, where a
/// value has failed, and where a motion had not settled. Beyond the end of a motion that was followed no farther the way has
/// other motions, which no line joins to that end.
fn curve(
    found: &Continuation,
    way: SweepDirection,
    value: fn(&LongTermMotion) -> f64,
) -> Vec<[f64; 2]> {
    let points = match way {
        SweepDirection::Rising => &found.rising,
        SweepDirection::Falling => &found.falling,
    };
    let seen = |ending: &LongTermMotion| {
        let is_seen =
            ending.kind != Kind::Unbounded && (ending.kind != Kind::Unsettled || ending.rests());
        if is_seen { value(ending) } else { f64::NAN }
    };
    let at = |point: &Point| [point.friction, point.ending.as_ref().map_or(f64::NAN, seen)];
    let mut curve: Vec<[f64; 2]> = points.iter().map(at).collect();
    for jump in found.jumps.iter().filter(|jump| jump.among == Some(way)) {
        let [before, after] = &jump.endings;
        curve.push([jump.between[0], seen(before)]);
        curve.push([jump.at(), f64::NAN]);
        if !jump.is_end || after.rests() && rests_beyond(points, jump) {
            curve.push([jump.between[1], seen(after)]);
        }
    }
    curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
    curve
}

/// `true` if the motion at the nearest value beyond a jump is rest.
fn rests_beyond(points: &[Point], jump: &Jump) -> bool {
    let nearest = match jump.way {
        SweepDirection::Rising => points.iter().find(|point| point.friction > jump.at()),
        SweepDirection::Falling => points.iter().rev().find(|point| point.friction < jump.at()),
    };
    nearest.and_then(|point| point.ending.as_ref().ok()).is_some_and(LongTermMotion::rests)
}

/// The label of a crossing of uniform sliding.
#[must_use]
pub fn turn(becomes_unstable: bool) -> &'static str {
    if becomes_unstable {
        "a mode of sliding begins to grow"
    } else {
        "a mode of sliding ceases to grow"
    }
}

/// Describes the motion at a jump, which may not have settled.
#[must_use]
pub fn describe(ending: &LongTermMotion) -> &'static str {
    match ending.kind {
        Kind::Unsettled if ending.rests() => "decaying motion",
        Kind::Unsettled if ending.rate > 0.0 => "growing motion",
        kind => kind.name(),
    }
}
