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
    let points = points_of(found, way);
    let mut curve: Vec<[f64; 2]> = points.iter().map(|point| shown(point, value)).collect();
    for jump in found.jumps.iter().filter(|jump| jump.among == Some(way)) {
        let [before, after] = &jump.endings;
        curve.push([jump.between[0], seen(before, value)]);
        curve.push([jump.at(), f64::NAN]);
        if !jump.is_end || after.rests() && rests_beyond(points, jump) {
            curve.push([jump.between[1], seen(after, value)]);
        }
    }
    curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
    curve
}

/// The amplitude along one way over µ, which has gaps at jumps, and a line for each jump at which the way goes on. The line
/// leads across the jump. If a motion at the jump has not settled, the line begins or ends at the nearest value of µ.
pub(super) fn way(
    found: &Continuation,
    way: SweepDirection,
) -> (Vec<[f64; 2]>, Vec<Vec<[f64; 2]>>) {
    let points = points_of(found, way);
    let goes_on = |jump: &&Jump| jump.among == Some(way) && !jump.is_end;
    let across = |jump: &Jump| {
        let x = jump.at();
        let [before, after] = jump.endings.each_ref().map(|ending| seen(ending, kinds::amplitude));
        let is_rising = jump.way == SweepDirection::Rising;
        let nearest =
            |is_above| nearest(points, x, is_above).map(|point| shown(point, kinds::amplitude));
        let mut line = Vec::new();
        line.extend(nearest(!is_rising).filter(|_| before.is_nan()));
        line.push([x, kinds::amplitude(&jump.endings[0])]);
        match nearest(is_rising).filter(|_| after.is_nan()) {
            Some(next) => line.extend([[x, next[1]], next]),
            None => line.push([x, after]),
        }
        line
    };
    let jumps = found.jumps.iter().filter(goes_on).map(across).collect();
    (curve(found, way, kinds::amplitude), jumps)
}

fn points_of(found: &Continuation, way: SweepDirection) -> &[Point] {
    match way {
        SweepDirection::Rising => &found.rising,
        SweepDirection::Falling => &found.falling,
    }
}

/// A value of µ with that of its motion; not a number where the picture shows none.
fn shown(point: &Point, value: fn(&LongTermMotion) -> f64) -> [f64; 2] {
    [point.friction, point.ending.as_ref().map_or(f64::NAN, |ending| seen(ending, value))]
}

/// The value of a motion; not a number where the picture shows none.
fn seen(ending: &LongTermMotion, value: fn(&LongTermMotion) -> f64) -> f64 {
    let is_seen =
        ending.kind != Kind::Unbounded && (ending.kind != Kind::Unsettled || ending.rests());
    if is_seen { value(ending) } else { f64::NAN }
}

/// The nearest value above a value of µ, or below it.
fn nearest(points: &[Point], friction: f64, is_above: bool) -> Option<&Point> {
    if is_above {
        points.iter().find(|point| point.friction > friction)
    } else {
        points.iter().rev().find(|point| point.friction < friction)
    }
}

/// `true` if the motion at the nearest value beyond a jump is rest.
fn rests_beyond(points: &[Point], jump: &Jump) -> bool {
    let nearest = nearest(points, jump.at(), jump.way == SweepDirection::Rising);
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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// A motion of this kind and amplitude.
    fn ending(kind: &str, amplitude: f64) -> Value {
        json!({
            "kind": kind, "amplitude": amplitude, "frequency": null, "period": null, "lines": [],
            "shares": [0, 0, 0, 0], "taken": [false, false, false, false], "time": 1.0, "rate": 1.0,
        })
    }

    #[test]
    fn a_line_across_a_jump_joins_motions_that_have_settled_and_else_the_nearest_value() {
        let rest = ending("equilibrium", 0.0);
        let points = [(1.0, &rest), (2.0, &rest), (3.0, &ending("periodic", 3.0))];
        let rising =
            points.map(|(value, ending)| json!({ "friction": value, "ending": { "Ok": ending } }));
        let jump = |before: Value, after: Value| {
            let jump = json!({
                "way": "rising", "among": "rising", "is_end": false, "between": [2.25, 2.75],
                "endings": [before, after],
            });
            let found = json!({
                "rising": rising, "falling": [], "jumps": [jump], "bistable": [], "unknown": [], "more": false,
                "compared": [],
            });
            let (curve, jumps) =
                way(&serde_json::from_value(found).unwrap(), SweepDirection::Rising);
            assert!(curve.iter().any(|[x, y]| *x == 2.5 && y.is_nan()), "{curve:?}");
            jumps.concat()
        };
        let settled = jump(rest.clone(), ending("periodic", 2.0));
        assert_eq!(settled, [[2.5, 0.0], [2.5, 2.0]]);
        let grows = jump(rest.clone(), ending("unsettled", 1e-6));
        assert_eq!(grows, [[2.5, 0.0], [2.5, 3.0], [3.0, 3.0]]);
        let fades = jump(ending("unsettled", 1.0), ending("periodic", 2.0));
        assert_eq!(fades, [[2.0, 0.0], [2.5, 1.0], [2.5, 2.0]]);
    }
}
