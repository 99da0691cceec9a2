//! `amontons study continuation`: the motions in which a scene ends over µ, upwards and downwards.

use super::arguments::{ObservationOptions, StudyArguments};
use super::folder::{Folder, quoted};
use super::{heading, prepared, watched_unevenly};
use amontons::contact::JoinedStates;
use amontons::scene::Scene;
use amontons::simulation::at_instant;
use amontons_analysis::instant::{require_undriven, signals_left_out};
use amontons_analysis::stability::candidates::{Bistability, bistability};
use amontons_analysis::study::{
    Bistable, Continuation, Jump, Kind, LongTermMotion, ObservationSettings, Plan, Point, Push,
    RestAndMotion, SweepDirection, ThirdMotion, continuation,
};
use amontons_analysis::sweep::{FRICTION, Possible};
use amontons_analysis::watch::Watch;
use amontons_cli::arguments::{Values, steps};
use amontons_cli::charts::continuation::{chart, describe, turn};
use amontons_cli::progress::Progress;
use amontons_cli::say;
use clap::Args;
use serde_json::json;
use std::error::Error;

#[derive(Args)]
pub struct ContinuationArguments {
    #[command(flatten)]
    pub common: StudyArguments,
    #[command(flatten)]
    pub options: ObservationOptions,
    /// Values of the friction coefficient from A to B, in steps of STEP or as N values, followed upwards from A and
    /// downwards from B
    #[arg(long, value_name = "A:B:STEP|A:B/N", value_parser = steps, allow_hyphen_values = true)]
    pub friction: Values,
    /// Distance in µ to which the bounds of a jump are narrowed; a motion is followed only if it survives a change of
    /// µ of this size [default: a hundredth of the step]
    #[arg(long, value_name = "µ", value_parser = resolution, allow_hyphen_values = true)]
    pub resolution: Option<f64>,
}

fn resolution(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("must be a number above zero".to_owned()),
    }
}

pub fn run(arguments: &ContinuationArguments) -> Result<(), Box<dyn Error>> {
    let ContinuationArguments { common, options, friction: Values(values), resolution } = arguments;
    let (scene, source, observation) = prepared(common, options)?;
    if common.set.iter().any(|(set, _)| set == FRICTION) {
        eprintln!("note: {FRICTION} takes the values of --friction, not that of --set");
    }
    let possible = Possible::of(&scene, FRICTION, values)?;
    if let Some(note) = possible.note(FRICTION) {
        eprintln!("note: {note}");
    }
    let values = &possible.values;
    let [first, .., last] = values[..] else {
        return Err(format!(
            "only the value {} of --friction is possible; a continuation needs at least two values",
            values[0]
        )
        .into());
    };
    let resolution = resolution.unwrap_or(0.01 * (values[1] - values[0]));
    let push = Push::of(&scene);
    // The results of the eigenvalue analysis.
    let known = eigenvalues(&scene, [first, last]);
    let candidates = known.as_ref().map_or(&[][..], |known| &known.candidates);
    // Each value starts from the state in which the one before has ended, so a piece depends on all values.
    let settings =
        json!({ "look": observation, "push": push, "values": values, "resolution": resolution });
    let folder = Folder::open(common, "continuation", (&scene, &source), settings)?;
    let plan =
        Plan { scene: &scene, observation: &observation, values, resolution, push, candidates };
    let Some(found) = watched_unevenly(|watch| continuation(&plan, folder.journal(), watch))?
    else {
        return Err(folder.interrupted());
    };
    let known = known.as_ref();
    write(&folder, &scene, &observation, &found, known.ok())?;
    print(&scene, &observation, resolution, &found);
    print_eigenvalues(&scene, &found, known);
    if only_rests(&found) {
        eprintln!(
            "note: the downward pass also starts at rest, so it cannot find a limit cycle that coexists with rest: \
             extend --friction to a value at which sliding is unstable, or give an initial value that leads to the \
             cycle at one of the values, as --set initial.NAME=VALUE; `amontons study perturbation` looks for such \
             initial values"
        );
    }
    say!("\n{}", folder.path().display());
    Ok(())
}

fn write(
    folder: &Folder,
    scene: &Scene,
    observation: &ObservationSettings,
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
    let ways = SweepDirection::ALL.into_iter().zip([&found.rising, &found.falling]);
    let rows = ways.flat_map(|(way, points)| points.iter().map(move |point| row(way, point)));
    folder.write_csv(&head, rows)?;
    let candidates: Vec<_> = known
        .map_or(&[][..], |known| &known.candidates)
        .iter()
        .zip(&found.compared)
        .map(|(candidate, compared)| {
            json!({
                "state": JoinedStates(&candidate.states).to_string(),
                "range": candidate.range,
                "frequency": candidate.frequency_hz,
                "confirmed": met(compared),
            })
        })
        .collect();
    folder.write_json(json!({ "branches": found, "candidates": candidates }))?;
    Ok(folder.draw("continuation", &chart(scene, observation, found, known))?)
}

fn row(way: SweepDirection, Point { friction, ending }: &Point) -> Vec<String> {
    let mut row = vec![way.name().to_owned(), format!("{friction:?}")];
    match ending {
        Ok(ending) => {
            let amplitude = match ending.kind {
                Kind::Unbounded => String::new(),
                _ => format!("{:?}", ending.amplitude),
            };
            row.extend([ending.kind.name().to_owned(), amplitude]);
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

/// Values of µ in a candidate's range at which both rest and a cycle were met in which the contacts take the
/// candidate's states at the same time.
fn met(compared: &[RestAndMotion]) -> Vec<f64> {
    let is_met = |both: &&RestAndMotion| both.takes.contains(&true);
    looked_at(compared.iter().filter(is_met))
}

/// Values of µ of motions other than rest, each once; a value may have several motions.
fn looked_at<'a>(compared: impl Iterator<Item = &'a RestAndMotion>) -> Vec<f64> {
    let mut values: Vec<f64> = compared.map(|both| both.friction).collect();
    values.dedup();
    values
}

/// Formats two bounds with enough decimals to distinguish them.
fn bracket([from, to]: &[f64; 2]) -> [String; 2] {
    let written = |decimals| [from, to].map(|value| format!("{value:.decimals$}"));
    (6..15).map(written).find(|[from, to]| from != to).unwrap_or_else(|| written(15))
}

fn print(scene: &Scene, observation: &ObservationSettings, resolution: f64, found: &Continuation) {
    say!("{}: motions over µ\n{}\n", scene.name, heading(&[(scene, observation)]));
    for (way, points) in SweepDirection::ALL.into_iter().zip([&found.rising, &found.falling]) {
        say!("µ {}", way.name());
        for run in points.chunk_by(|a, b| kind(a) == kind(b)) {
            let (first, last) = (&run[0], &run[run.len() - 1]);
            say!("  {} to {}: {}", first.friction, last.friction, described(first, last));
            if let Ok(ending) = &first.ending
                && ending.kind == Kind::Undecided
                && let Some(evidence) = ending.evidence()
            {
                say!("    {evidence}");
            }
        }
    }
    say!("\nJumps: values of µ at which one motion gives way to another");
    if found.jumps.is_empty() {
        say!("  none");
    }
    for Jump { way, between, endings: [before, after], .. } in &found.jumps {
        let (before, after) = (describe_motion(before), describe_motion(after));
        let [from, to] = bracket(between);
        say!("  {:8} {from} to {to}  {before} becomes {after}", way.name());
    }
    say!("\nRanges with two motions");
    for both in &found.bistable {
        let Bistable { range, bounded, third, .. } = both;
        let open = |is_bounded: &bool| if *is_bounded { "" } else { " (limit of the search)" };
        let [from, to] = bracket(range);
        say!("  {from}{} to {to}{}: {}", open(&bounded[0]), open(&bounded[1]), both.words());
        if let Some(ThirdMotion { friction, ending }) = third {
            say!("    and a third motion: at {friction:.6} {}", describe_motion(ending));
        }
    }
    for range in &found.unknown {
        let [from, to] = bracket(range);
        say!(
            "  {from} to {to}: unknown, because a motion there had not settled (a larger --longest may decide) or \
             could not be followed"
        );
    }
    if found.bistable.is_empty() && found.unknown.is_empty() {
        say!("  {}", none(found, resolution));
    }
    if found.more {
        say!(
            "  Not all motions were followed to the ends of their ranges, because that takes too long: ranges may be \
             wider. A narrower --friction follows them further."
        );
    }
    say!(
        "  The study finds only motions reached from rest, from the scene's own initial state, or from the end of one \
         of these; others may exist."
    );
}

/// `true` if the way downwards, too, has begun at rest and no other motion was met beside the first.
fn only_rests(found: &Continuation) -> bool {
    let rests = |point: &Point| point.ending.as_ref().is_ok_and(LongTermMotion::rests);
    found.bistable.is_empty() && found.falling.last().is_some_and(rests)
}

/// Text on second motions if both ways have ended in the same motion at every compared value.
fn none(found: &Continuation, resolution: f64) -> String {
    if only_rests(found) {
        "unknown: the downward pass also started at rest; a motion that no initial state led to may coexist with rest"
            .to_owned()
    } else {
        format!(
            "none wider than two resolutions, {:.1e}, was found: wherever motions were compared, they are the same",
            2.0 * resolution
        )
    }
}

/// Eigenvalue analysis of the scene at t = 0 over a range of µ.
fn eigenvalues(scene: &Scene, range: [f64; 2]) -> Result<Bistability, amontons::Error> {
    require_undriven(scene, FRICTION)?;
    let progress = Progress::new("eigenvalues of the contact states", 0);
    let found = bistability(&at_instant(scene, 0.0)?, range, Watch::IDLE);
    progress.finish();
    found
}

fn print_eigenvalues(
    scene: &Scene,
    found: &Continuation,
    known: Result<&Bistability, &amontons::Error>,
) {
    say!("\nEigenvalues");
    if let Some(left_out) = signals_left_out(scene, 0.0) {
        say!("  {left_out}");
    }
    let known = match known {
        Ok(known) => known,
        Err(error) => {
            say!("  unknown: {error}");
            return;
        }
    };
    if known.uniform.is_empty() {
        for [from, to] in &known.equilibrium {
            let is_stable =
                known.stable.iter().any(|stable| stable[0] <= *from && *to <= stable[1]);
            let verb =
                if is_stable { "no mode of sliding grows" } else { "a mode of sliding grows" };
            say!("  {verb} for µ from {from} to {to}");
        }
    }
    for crossing in &known.uniform {
        say!("  {} at {:.6}", turn(crossing.becomes_unstable), crossing.value);
    }
    for (candidate, compared) in known.candidates.iter().zip(&found.compared) {
        let [from, to] = candidate.range;
        let met = met(compared);
        let found = match (&met[..], compared.is_empty()) {
            ([], true) => {
                "unknown: no limit cycle that coexists with rest was found in this range".to_owned()
            }
            ([], false) => format!(
                "not visited by the limit cycles that were followed beside rest, at µ = {}; another limit cycle may \
                 visit it",
                listed(looked_at(compared.iter()).into_iter())
            ),
            (values, _) => {
                let values = listed(values.iter().copied());
                format!("visited by a limit cycle that coexists with rest, at µ = {values}")
            }
        };
        let states = JoinedStates(&candidate.states);
        let hz = candidate.frequency_hz;
        say!("  candidate {states} ({hz:.2} Hz) from {from:.4} to {to:.4}: {found}");
    }
}

/// Values of µ as a list.
fn listed(values: impl Iterator<Item = f64>) -> String {
    values.map(|friction| format!("{friction:.4}")).collect::<Vec<_>>().join(", ")
}

/// Describes a motion with its amplitude; for a motion that has not settled, it is the last one observed.
fn describe_motion(ending: &LongTermMotion) -> String {
    match ending.kind {
        Kind::Unbounded => "growth without bound".to_owned(),
        Kind::Equilibrium => "rest".to_owned(),
        Kind::Unsettled => {
            format!("{} ({} at the end of the run)", describe(ending), metres(ending.amplitude))
        }
        _ => format!("{} of {}", describe(ending), metres(ending.amplitude)),
    }
}

fn kind(point: &Point) -> Option<Kind> {
    point.ending.as_ref().ok().map(|ending| ending.kind)
}

fn described(first: &Point, last: &Point) -> String {
    match (&first.ending, &last.ending) {
        (Ok(a), Ok(_)) if a.rests() => a.kind.name().to_owned(),
        (Ok(a), Ok(_)) if a.kind == Kind::Unbounded => "grows without bound".to_owned(),
        (Ok(a), Ok(b)) => {
            format!("{}, {} to {}", a.kind.name(), metres(a.amplitude), metres(b.amplitude))
        }
        (Err(failure), _) | (_, Err(failure)) => failure.clone(),
    }
}

fn metres(amplitude: f64) -> String {
    format!("{amplitude:.4e}")
}

#[cfg(test)]
mod tests {
    use super::bracket;

    #[test]
    fn bounds_that_differ_are_printed_so_that_they_differ() {
        assert_eq!(bracket(&[2.0625, 2.062_578]), ["2.062500", "2.062578"]);
        assert_eq!(bracket(&[0.449_800_12, 0.449_800_14]), ["0.44980012", "0.44980014"]);
    }
}
