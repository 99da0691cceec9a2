//! `amontons study continuation`: what a scene ends in over µ, upwards and downwards.

use super::arguments::{Common, Looking};
use super::folder::{Folder, quoted};
use super::{heading, interrupted, prepared, watched};
use amontons::contact::Joined;
use amontons::picture::{Band, Chart, Mark, Panel, Series, Style};
use amontons::scene::Scene;
use amontons::simulation::{at_instant, require_undriven, signals_left_out};
use amontons::stability::candidates::{Bistability, Candidate, bistability};
use amontons::study::{
    Bistable, Continuation, Ending, Fold, Kind, Look, Plan, Point, Push, Way, continuation,
};
use amontons::sweep::{FRICTION, range};
use clap::Args;
use serde_json::json;
use std::error::Error;

#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    pub common: Common,
    #[command(flatten)]
    pub looking: Looking,
    /// Values of the friction coefficient, followed upwards from A and downwards from B
    #[arg(long, value_name = "A:B:STEP", value_parser = values, allow_hyphen_values = true)]
    pub friction: Values,
    /// How near the bounds of a fold are brought together, in µ [default: a hundredth of STEP]
    #[arg(long, value_name = "µ", value_parser = resolution, allow_hyphen_values = true)]
    pub resolution: Option<f64>,
}

#[derive(Clone)]
pub struct Values(Vec<f64>);

fn values(text: &str) -> Result<Values, String> {
    range::steps(text).map(Values)
}

fn resolution(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("must be a number above zero".to_owned()),
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let Arguments { common, looking, friction: Values(values), resolution } = arguments;
    let (scene, source, look) = prepared(common, looking)?;
    let resolution = resolution.unwrap_or(0.01 * (values[1] - values[0]));
    let push = Push::of(&scene);
    // Each value starts where the one before has ended, so a piece depends on them all.
    let settings = json!({ "look": look, "push": push, "values": values });
    let folder = Folder::open(common, "continuation", (&scene, &source), settings)?;
    let plan = Plan { scene: &scene, look: &look, values, resolution, push };
    let Some(found) = watched(|watch| continuation(&plan, folder.journal(), watch))? else {
        return Err(interrupted(&folder));
    };
    let known = eigenvalues(&scene, [values[0], values[values.len() - 1]]);
    write(&folder, &scene, &look, &found, known.as_ref().ok())?;
    print(&scene, &look, &found);
    print_eigenvalues(&scene, &found, known.as_ref());
    let rests = |point: &Point| point.ending.as_ref().is_ok_and(Ending::rests);
    if found.falling.last().is_some_and(rests) {
        eprintln!(
            "note: downwards it starts at rest too, so a cycle beside rest is not found: end --friction where sliding is \
             unstable, or give a start that leads to the cycle with --set"
        );
    }
    println!("\n{}", folder.path().display());
    Ok(())
}

fn write(
    folder: &Folder,
    scene: &Scene,
    look: &Look,
    found: &Continuation,
    known: Option<&Bistability>,
) -> Result<(), Box<dyn Error>> {
    let head = [
        "way",
        FRICTION,
        "kind",
        "amplitude",
        "frequency",
        "share.slide",
        "share.reverse_slide",
        "share.stick",
        "share.detached",
        "time",
        "failure",
    ];
    let ways = Way::ALL.into_iter().zip([&found.rising, &found.falling]);
    let rows = ways.flat_map(|(way, points)| points.iter().map(move |point| row(way, point)));
    folder.write_csv(&head, rows)?;
    let candidates: Vec<_> = known
        .map_or(&[][..], |known| &known.candidates)
        .iter()
        .map(|candidate| {
            json!({
                "state": Joined(&candidate.states).to_string(),
                "range": candidate.range,
                "frequency": candidate.frequency_hz,
                "confirmed": confirmed(candidate, found),
            })
        })
        .collect();
    folder.write_json(json!({ "branches": found, "candidates": candidates }))?;
    Ok(folder.draw("continuation", &chart(scene, look, found, known))?)
}

fn row(way: Way, Point { friction, ending }: &Point) -> Vec<String> {
    let mut row = vec![way.name().to_owned(), format!("{friction:?}")];
    match ending {
        Ok(ending) => {
            row.extend([ending.kind.name().to_owned(), format!("{:?}", ending.amplitude)]);
            row.push(
                ending.frequency.map_or_else(String::new, |frequency| format!("{frequency:?}")),
            );
            row.extend(ending.shares.map(|share| format!("{share:?}")));
            row.extend([format!("{:?}", ending.time), String::new()]);
        }
        Err(failure) => {
            row.extend(std::iter::repeat_n(String::new(), 8));
            row.push(quoted(failure));
        }
    }
    row
}

/// Values of µ in a candidate's range at which one way ends in rest and the other in a cycle in which contacts take the
/// candidate's states: the first and the last.
fn confirmed(candidate: &Candidate, found: &Continuation) -> Option<[f64; 2]> {
    let [from, to] = candidate.range;
    let takes = |point: &Point| {
        point.ending.as_ref().is_ok_and(|ending| {
            let states = &candidate.states;
            ending.kind.is_cycle() && states.iter().all(|state| ending.taken[*state as usize - 1])
        })
    };
    let rests = |range: &&Bistable| range.rests;
    let inside = |mu: f64| {
        (from..=to).contains(&mu)
            && found.bistable.iter().filter(rests).any(|b| (b.range[0]..=b.range[1]).contains(&mu))
    };
    let points = found.rising.iter().chain(&found.falling);
    let values = points.filter(|point| inside(point.friction) && takes(point));
    let values: Vec<f64> = values.map(|point| point.friction).collect();
    let first = values.iter().copied().reduce(f64::min)?;
    Some([first, values.iter().copied().fold(first, f64::max)])
}

/// Amplitude and frequency of both ways, folds as marks, ranges with two motions shaded.
pub fn chart(
    scene: &Scene,
    look: &Look,
    found: &Continuation,
    known: Option<&Bistability>,
) -> Chart {
    let ways = [("µ rising", Way::Rising, 0), ("µ falling", Way::Falling, 1)];
    let series = |value: fn(&Ending) -> f64| {
        let curve = |(label, way, colour): &(&str, Way, usize)| Series {
            label: Some((*label).to_owned()),
            points: curve(found, *way, value),
            colour: *colour,
            style: if *way == Way::Rising { Style::Line } else { Style::Dashed },
            ..Series::default()
        };
        ways.iter().map(curve).collect::<Vec<Series>>()
    };
    let bands: Vec<Band> = found
        .bistable
        .iter()
        .map(|Bistable { range, rests, .. }| Band {
            from: range[0],
            to: range[1],
            label: Some(if *rests { "rest and a cycle" } else { "two cycles" }.to_owned()),
            colour: if *rests { 2 } else { 4 },
        })
        .collect();
    let folds = found.folds.iter().map(|fold| Mark {
        x: fold.at(),
        label: Some(format!("{} {:.4}", fold.way.name(), fold.at())),
    });
    let onsets = known.into_iter().flat_map(|known| &known.uniform).map(|crossing| Mark {
        x: crossing.value,
        label: Some(format!("{} {:.4}", turn(crossing.becomes_unstable), crossing.value)),
    });
    let amplitude = series(|ending| if ending.rests() { 0.0 } else { ending.amplitude });
    let frequency = series(|ending| match ending.frequency {
        Some(frequency) if !ending.rests() => frequency,
        _ => f64::NAN,
    });
    let mut panels = vec![Panel {
        y_label: format!("Amplitude of {} [m]", look.of),
        series: amplitude,
        marks: folds.chain(onsets).collect(),
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
        title: format!("{}: what it ends in over µ", scene.name),
        x_label: "Friction coefficient µ [–]".to_owned(),
        panels,
        logarithmic: false,
    }
}

/// A value of one way over µ, with what was found at both bounds of its folds, so that jumps stand where they are.
fn curve(found: &Continuation, way: Way, value: fn(&Ending) -> f64) -> Vec<[f64; 2]> {
    let points = match way {
        Way::Rising => &found.rising,
        Way::Falling => &found.falling,
    };
    let at = |point: &Point| [point.friction, point.ending.as_ref().map_or(f64::NAN, value)];
    let mut curve: Vec<[f64; 2]> = points.iter().map(at).collect();
    for fold in found.folds.iter().filter(|fold| fold.way == way) {
        let mut bounds = fold.between.iter().zip(&fold.endings);
        let settled =
            |(_, ending): &(&f64, &Ending)| ending.kind != Kind::Unsettled || ending.rests();
        curve.extend(
            bounds.clone().filter(settled).map(|(friction, ending)| [*friction, value(ending)]),
        );
        // What still grew there ends as the next value does.
        if let Some((friction, _)) = bounds.rfind(|bound| !settled(bound)) {
            let beyond = |point: &&Point| match way {
                Way::Rising => point.friction > *friction,
                Way::Falling => point.friction < *friction,
            };
            let next = match way {
                Way::Rising => points.iter().find(beyond),
                Way::Falling => points.iter().rev().find(beyond),
            };
            curve.extend(next.map(|point| [*friction, at(point)[1]]));
        }
    }
    curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
    curve
}

fn print(scene: &Scene, look: &Look, found: &Continuation) {
    println!("{}: what it ends in over µ\n{}\n", scene.name, heading(scene, look));
    for (way, points) in Way::ALL.into_iter().zip([&found.rising, &found.falling]) {
        println!("µ {}", way.name());
        for run in points.chunk_by(|a, b| kind(a) == kind(b)) {
            let (first, last) = (&run[0], &run[run.len() - 1]);
            println!("  {} to {}: {}", first.friction, last.friction, described(first, last));
        }
    }
    println!("\nFolds: where one motion gives way to another");
    if found.folds.is_empty() {
        println!("  none");
    }
    for Fold { way, between, endings: [before, after] } in &found.folds {
        println!(
            "  {:8} {:.6} to {:.6}  {} of {} becomes {} of {}",
            way.name(),
            between[0],
            between[1],
            describe(before),
            metres(before.amplitude),
            describe(after),
            metres(after.amplitude)
        );
    }
    println!("\nRanges with two motions");
    if found.bistable.is_empty() {
        println!("  none");
    }
    for Bistable { range: [from, to], bounded, rests } in &found.bistable {
        let open = |is_bounded: &bool| if *is_bounded { "" } else { " (as far as was looked)" };
        println!(
            "  {from:.6}{} to {to:.6}{}: {}",
            open(&bounded[0]),
            open(&bounded[1]),
            if *rests { "rest and a cycle" } else { "two cycles" }
        );
    }
}

/// The eigenvalues of the scene as it is at t = 0 over a range of µ.
fn eigenvalues(scene: &Scene, range: [f64; 2]) -> Result<Bistability, amontons::Error> {
    require_undriven(scene, FRICTION)?;
    bistability(&at_instant(scene, 0.0)?, range, &|_| {})
}

fn print_eigenvalues(
    scene: &Scene,
    found: &Continuation,
    known: Result<&Bistability, &amontons::Error>,
) {
    println!("\nWhat eigenvalues say");
    if let Some(left_out) = signals_left_out(scene, 0.0) {
        println!("  {left_out}");
    }
    let known = match known {
        Ok(known) => known,
        Err(error) => {
            println!("  unknown: {error}");
            return;
        }
    };
    if known.uniform.is_empty() {
        for [from, to] in &known.equilibrium {
            let is_stable =
                known.stable.iter().any(|stable| stable[0] <= *from && *to <= stable[1]);
            let verb =
                if is_stable { "no mode of sliding grows" } else { "a mode of sliding grows" };
            println!("  {verb} from {from} to {to}");
        }
    }
    for crossing in &known.uniform {
        println!("  {} at {:.6}", turn(crossing.becomes_unstable), crossing.value);
    }
    for candidate in &known.candidates {
        let [from, to] = candidate.range;
        let found = match confirmed(candidate, found) {
            None => "not met".to_owned(),
            Some([a, b]) if a == b => format!("met by a cycle beside rest at {a}"),
            Some([a, b]) => format!("met by a cycle beside rest from {a} to {b}"),
        };
        let states = Joined(&candidate.states);
        let hz = candidate.frequency_hz;
        println!("  candidate {states} ({hz:.2} Hz) from {from:.4} to {to:.4}: {found}");
    }
}

/// What a crossing of uniform sliding is called.
fn turn(becomes_unstable: bool) -> &'static str {
    if becomes_unstable {
        "a mode of sliding begins to grow"
    } else {
        "a mode of sliding ceases to grow"
    }
}

/// What a motion does at a fold, where it may take too long to settle.
pub fn describe(ending: &Ending) -> &'static str {
    match ending.kind {
        Kind::Unsettled if ending.rests() => "decaying motion",
        Kind::Unsettled if ending.rate > 0.0 => "growing motion",
        kind => kind.name(),
    }
}

fn kind(point: &Point) -> Option<Kind> {
    point.ending.as_ref().ok().map(|ending| ending.kind)
}

fn described(first: &Point, last: &Point) -> String {
    match (&first.ending, &last.ending) {
        (Ok(a), Ok(_)) if a.rests() => a.kind.name().to_owned(),
        (Ok(a), Ok(b)) => {
            format!("{}, {} to {}", a.kind.name(), metres(a.amplitude), metres(b.amplitude))
        }
        (Err(failure), _) | (_, Err(failure)) => failure.clone(),
    }
}

fn metres(amplitude: f64) -> String {
    format!("{amplitude:.4e}")
}
