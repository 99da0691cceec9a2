//! `amontons study limit-cycle`.

use super::arguments::{ObservationOptions, StudyArguments};
use super::folder::{Folder, quoted};
use super::{heading, over, prepared, prepared_again};
use amontons::contact::ContactState;
use amontons::scene::Scene;
use amontons_analysis::assign::assign;
use amontons_analysis::study::{
    Kind, LongTermMotion, MotionBracket, ObservationSettings, Outcome, Push, Question, limit_cycles,
};
use amontons_analysis::sweep::Possible;
use amontons_analysis::sweep::range::{self, number};
use amontons_cli::arguments::Values;
use amontons_cli::charts::limit_cycle::{Results, changes};
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use clap::Args;
use serde_json::json;
use std::error::Error;
use std::io::{Write, stdout};

#[derive(Args)]
pub struct LimitCycle {
    #[command(flatten)]
    pub common: StudyArguments,
    /// Parameter or input with its values from A to B, in steps of STEP or as N values, or with one value [default:
    /// the slider's velocity, with the value of the scene]
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N|VALUE", value_parser = named_values)]
    pub parameter: Option<(String, Values)>,
    #[command(flatten)]
    pub options: ObservationOptions,
    #[command(flatten)]
    pub shared: ShardArguments,
    /// Accuracy of the values at which the motion changes, as a part of the distance between two values
    #[arg(long, value_name = "PART", default_value = "1e-3", value_parser = part, allow_hyphen_values = true)]
    pub resolution: f64,
    /// Draw the phase portraits of the motion at this value of the parameter; may be repeated [default: one value in
    /// the middle of each regime]
    #[arg(long, value_name = "VALUE", value_parser = number, allow_hyphen_values = true)]
    pub portrait: Vec<f64>,
    /// Number of contacts in the phase portraits, counted from the first
    #[arg(long, value_name = "N", default_value = "2")]
    pub contacts: usize,
}

/// Parses a parameter with a range of values or with one value.
fn named_values(text: &str) -> Result<(String, Values), String> {
    range::named(text, |values| {
        let is_range = values.contains([':', '/']);
        if is_range { range::steps(values) } else { Ok(vec![number(values)?]) }.map(Values)
    })
}

fn part(text: &str) -> Result<f64, String> {
    match number(text)? {
        part if part > 0.0 && part <= 1.0 => Ok(part),
        _ => Err("must be above 0 and at most 1, such as 1e-3".to_owned()),
    }
}

/// The velocity of the slider in the scene, or that of the first contact if each contact has its own.
fn as_it_is(scene: &Scene) -> (String, Values) {
    let contacts = scene.network().map_or(&[][..], |network| &network.contacts);
    let own = contacts.first().filter(|_| !scene.has_common_velocity());
    let own =
        own.and_then(|first| Some((format!("contact.{}.velocity", first.name), first.velocity?)));
    let (name, value) =
        own.unwrap_or_else(|| ("slider.velocity".to_owned(), scene.slider.velocity));
    (name, Values(vec![value]))
}

pub fn run(arguments: &LimitCycle) -> Result<(), Box<dyn Error>> {
    let LimitCycle { common, shared, parameter, options, .. } = arguments;
    let (scene, source, observation) = prepared(common, options)?;
    let (name, Values(values)) = &parameter.clone().unwrap_or_else(|| as_it_is(&scene));
    // The values are checked before the folder is created.
    let possible = Possible::of(&scene, name, values)?;
    if let Some(note) = possible.note(name) {
        eprintln!("note: {note}");
    }
    let values = possible.values;
    let mut first = scene.clone();
    assign(&mut first, name, values[0])?;
    if parameter.is_some() && common.set.iter().any(|(set, _)| set == name) {
        eprintln!("note: {name} takes the values of --parameter, not that of --set");
    }
    if let Some(push) = Push::of_resting(&first) {
        eprintln!(
            "note: {} starts at rest in its equilibrium; to start a motion, {} gets an initial velocity, {:?} m/s at \
             {name} = {:?}",
            scene.name,
            scene.dof_names()[push.dof],
            push.velocity,
            values[0]
        );
    }
    let mut drawn = arguments.portrait.clone();
    drawn.sort_by(f64::total_cmp);
    drawn.dedup();
    let question = Question {
        name: name.clone(),
        values,
        resolution: arguments.resolution,
        portraits: (!drawn.is_empty()).then_some(drawn),
        contacts: arguments.contacts,
    };
    let prepare = |scene: &mut Scene| prepared_again(scene, common, options);
    let mut runs = Vec::with_capacity(question.values.len());
    for value in &question.values {
        let mut scene = scene.clone();
        assign(&mut scene, name, *value)?;
        let observation = prepare(&mut scene)?;
        runs.push((scene, observation));
    }
    // Each value derives its step anew unless it is chosen.
    let settings = (&observation, options, &common.integrator);
    let mut folder =
        Folder::open_shared(common, *shared, "limit-cycle", (&scene, &source), settings)?;
    let found =
        folder.found(|journal, watch| limit_cycles(&scene, &prepare, &question, journal, watch))?;
    let Some(found) = found else { return Ok(()) };
    let results =
        Results { scene: &scene, of: &observation.of, question: &question, found: &found };
    folder.write_csv(&head(&results), rows(&results))?;
    folder.write_json(json!({ "question": question, "found": found }))?;
    folder.draw("limit-cycle", &results.chart())?;
    // Portraits show the motion of contacts.
    for portrait in found.portraits.iter().filter(|_| scene.contact_count() > 0) {
        for direction in ["tangential", "normal"] {
            let name = format!("portrait-{:?}-{direction}", portrait.value);
            folder.draw(&name, &results.portrait(portrait, direction))?;
        }
    }
    print(&results, &runs, &mut stdout().lock())?;
    say!("{} has results.csv, study.json and pictures", folder.path().display());
    Ok(())
}

fn head<'a>(results: &Results<'a>) -> [&'a str; 13] {
    [
        &results.question.name,
        "kind",
        "amplitude",
        "frequency",
        "share.slide",
        "share.reverse_slide",
        "share.stick",
        "share.detached",
        "taken",
        "time",
        "period",
        "closure",
        "failure",
    ]
}

fn rows(results: &Results<'_>) -> impl Iterator<Item = Vec<String>> {
    results.outcomes().map(|(value, outcome)| {
        let mut row = vec![format!("{value:?}")];
        match outcome {
            Outcome::Ending(ending) => {
                let amplitude = match ending.kind {
                    Kind::Unbounded => String::new(),
                    _ => format!("{:?}", ending.amplitude),
                };
                row.extend([ending.kind.name().to_owned(), amplitude]);
                row.push(ending.frequency.map_or_else(String::new, |hz| format!("{hz:?}")));
                row.extend(ending.shares.map(|share| format!("{share:?}")));
                row.extend([taken(&ending.taken), format!("{:?}", ending.time)]);
                let number = |value: Option<f64>| {
                    value.map_or_else(String::new, |value| format!("{value:?}"))
                };
                row.extend([number(ending.period), number(ending.closure), String::new()]);
            }
            Outcome::Failure(failure) => {
                row.push("failed".to_owned());
                row.extend(vec![String::new(); 10]);
                row.push(quoted(failure));
            }
        }
        row
    })
}

fn print(
    results: &Results<'_>,
    runs: &[(Scene, ObservationSettings)],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let Results { scene, question, found, .. } = results;
    match &question.values[..] {
        [value] => {
            let is_driven = scene.signals.iter().any(|signal| signal.input == question.name);
            let added = if is_driven { ", to which a signal is added" } else { "" };
            writeln!(out, "{}: motion at {} = {value:?}{added}", scene.name, question.name)?;
        }
        _ => writeln!(out, "{}: limit cycles over {}", scene.name, question.name)?,
    }
    writeln!(
        out,
        "{}",
        heading(&runs.iter().map(|(scene, observation)| (scene, observation)).collect::<Vec<_>>())
    )?;
    writeln!(out)?;
    let width = question.name.chars().count();
    let amplitude = format!("amplitude{}", results.unit());
    writeln!(
        out,
        "{:>width$}  {:14}  {amplitude:>13}  {:>14}  {:>6}  {:>6}  {:>6}  {:>6}  {:>11}",
        question.name, "kind", "frequency [Hz]", "Sl", "R-Sl", "St", "Dt", "settled [s]"
    )?;
    for (value, outcome) in results.outcomes() {
        let value = format!("{value:?}");
        match outcome {
            Outcome::Ending(LongTermMotion {
                kind,
                amplitude,
                frequency,
                shares,
                taken,
                time,
                ..
            }) => {
                let is_cycle = !matches!(kind, Kind::Equilibrium | Kind::Unbounded);
                let frequency = frequency.filter(|_| is_cycle);
                let amplitude = match kind {
                    Kind::Unbounded => "-".to_owned(),
                    _ => format!("{amplitude:.4e}"),
                };
                let frequency = frequency.map_or_else(|| "-".to_owned(), |hz| format!("{hz:.3}"));
                write!(
                    out,
                    "{value:>width$}  {:14}  {amplitude:>13}  {frequency:>14}",
                    kind.name()
                )?;
                for (share, taken) in shares.iter().zip(taken) {
                    let share = if *taken { format!("{share:.4}") } else { "-".to_owned() };
                    write!(out, "  {share:>6}")?;
                }
                let time = match kind {
                    Kind::Unsettled => "not".to_owned(),
                    _ => format!("{time:.3}"),
                };
                writeln!(out, "  {time:>11}")?;
            }
            Outcome::Failure(failure) => writeln!(out, "{value:>width$}  failed: {failure}")?,
        }
    }
    writeln!(out)?;
    print_evidence(results, out)?;
    if !found.thresholds.is_empty() {
        writeln!(out, "as {} rises:", question.name)?;
    } else if question.values.len() > 1 {
        writeln!(out, "no thresholds between values whose motion has settled")?;
    }
    for threshold in &found.thresholds {
        let [low, high] = bounds(threshold);
        write!(out, "  between {low} and {high}: {}", changes(threshold))?;
        match threshold.unknown {
            Some(value) => {
                writeln!(out, " (not narrowed further: the motion at {value:?} has not settled)")?;
            }
            None => writeln!(out)?,
        }
    }
    if question.values.len() > 1 {
        writeln!(
            out,
            "changes that occur and revert between two neighbouring values are not detected; a smaller step of \
             --parameter shows them"
        )?;
    }
    let is_left = |outcome: &Outcome| matches!(outcome, Outcome::Ending(ending) if ending.kind == Kind::Unsettled);
    let left: Vec<(f64, &ObservationSettings)> = results
        .outcomes()
        .zip(runs)
        .filter(|((_, outcome), _)| is_left(outcome))
        .map(|((value, _), (_, observation))| (value, observation))
        .collect();
    if !left.is_empty() {
        let longest = over(left.iter().map(|(_, observation)| observation.longest));
        let values: Vec<String> = left.iter().map(|(value, _)| format!("{value:?}")).collect();
        writeln!(
            out,
            "not settled within {longest} s: {}; a larger --longest or, for a beat, a larger --window may decide",
            values.join(", ")
        )?;
    }
    let stands = |(value, outcome): (f64, &Outcome)| {
        let ending = outcome.settled().filter(|ending| ending.kind.is_cycle())?;
        (ending.amplitude == 0.0).then_some(value)
    };
    if let Some(value) = results.outcomes().find_map(stands) {
        writeln!(
            out,
            "{} does not move at {value:?}, although other outputs do: choose another output with --of",
            results.of
        )?;
    }
    Ok(())
}

/// Prints the evidence for the kinds of motion: for periodic and quasi-periodic motions in a row once, from the value
/// with the weakest evidence; for other kinds, for each value.
fn print_evidence(results: &Results<'_>, out: &mut dyn Write) -> std::io::Result<()> {
    let endings: Vec<(f64, &LongTermMotion)> = results
        .outcomes()
        .filter_map(|(value, outcome)| match outcome {
            Outcome::Ending(ending) => Some((value, ending)),
            Outcome::Failure(_) => None,
        })
        .collect();
    let is_alike = |a: &LongTermMotion, b: &LongTermMotion| {
        a.kind == b.kind
            && matches!(a.kind, Kind::Periodic | Kind::QuasiPeriodic)
            && (a.linear, a.follows, a.two_frequencies) == (b.linear, b.follows, b.two_frequencies)
    };
    for run in endings.chunk_by(|a, b| is_alike(a.1, b.1)) {
        let closure = |ending: &LongTermMotion| ending.closure.unwrap_or(0.0);
        let least = run.iter().max_by(|a, b| closure(a.1).total_cmp(&closure(b.1)));
        let Some((value, ending)) = least else { continue };
        let Some(evidence) = ending.evidence() else { continue };
        writeln!(out, "{} at {value:?}: {evidence}", ending.kind.name())?;
    }
    for run in endings.chunk_by(|a, b| a.1.fading == b.1.fading) {
        let states = taken(&run[0].1.fading);
        if states.is_empty() {
            continue;
        }
        let values = match [run[0].0, run[run.len() - 1].0] {
            [first, last] if first == last => format!("at {first:?}"),
            [first, last] => format!("from {first:?} to {last:?}"),
        };
        writeln!(
            out,
            "{values} contacts take {states} for ever shorter times and finally not at all; the table leaves these \
             states out"
        )?;
    }
    Ok(())
}

/// The contact states that were visited, formatted for a table.
fn taken(taken: &[bool; 4]) -> String {
    let states = ContactState::ALL.iter().zip(taken).filter(|(_, taken)| **taken);
    states.map(|(state, _)| state.to_string()).collect::<Vec<_>>().join(" ")
}

/// Formats both bounds with the digits in which they differ and one more.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn bounds(threshold: &MotionBracket) -> [String; 2] {
    let [low, high] = threshold.between;
    let decimals = (1.0 - (high - low).log10().floor()).clamp(0.0, 15.0) as usize;
    [low, high].map(|bound| format!("{bound:.decimals$}"))
}
