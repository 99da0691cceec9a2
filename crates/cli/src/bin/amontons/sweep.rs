//! `amontons simulate --sweep`.

use crate::arguments::Simulate;
use crate::simulate::is_broken_pipe;
use amontons::scene::{Experiment, Scene, Source};
use amontons::selection::resolve;
use amontons::simulation::dof_of;
use amontons_analysis::journal::Journal;
use amontons_analysis::output::AtomicFile;
use amontons_analysis::sweep::observed::{displacements, output};
use amontons_analysis::sweep::{ENERGIES, Possible, Summary, UnsettledReason, View, sweep};
use amontons_analysis::watch::Watch;
use amontons_cli::interrupt::{Interrupted, watched};
use amontons_cli::progress::Progress;
use amontons_cli::shards::{Pieces, Program, identity};
use amontons_export::documentation::counted;
use serde_json::{Value, json};
use std::error::Error;
use std::fs;
use std::io::{BufWriter, Write, stdout};
use std::path::PathBuf;

pub fn run(
    arguments: &Simulate,
    (mut scene, source): (Scene, &Source),
    experiment: Experiment,
    name: &str,
    values: &[f64],
) -> Result<(), Box<dyn Error>> {
    // A tolerance chooses the step once, for the scene as it is given, so all values have the same step.
    if let Some(selected) = resolve(&mut scene) {
        eprintln!("{}: {selected}", scene.name);
    }
    scene.experiment = experiment;
    let scene = &scene;
    let possible = Possible::of(scene, name, values)?;
    if let Some(note) = possible.note(name) {
        eprintln!("note: {note}");
    }
    let values = &possible.values;
    if arguments.set.iter().any(|(set, _)| set == name) {
        eprintln!("note: {name} takes the values of --sweep, not that of --set");
    }
    let outputs = match &arguments.of {
        Some(name) => vec![output(scene, name)?],
        None => {
            let mut shown = displacements(scene)?;
            shown.sort_by_key(|variable| dof_of(scene, variable));
            shown
        }
    };
    let names: Vec<String> = outputs.iter().map(|output| output.name.clone()).collect();
    let window = arguments.window.unwrap_or(scene.experiment.stop_time / 4.0);
    let view = View { outputs, window };
    let work =
        |journal: &Journal, watch: Watch<'_>| sweep(scene, name, values, &view, journal, watch);
    let (outcomes, mut file) = if arguments.shared.is_part() {
        let folder = arguments.shared.folder(arguments.output.as_deref())?;
        let study = identity("sweep", (scene, source), &arguments.set, settings(arguments, &view)?);
        let mut pieces = Pieces::open(folder, Program::Amontons, arguments.shared, &study, false)?;
        let all = |journal: &Journal, watch: Watch<'_>| {
            Ok(work(journal, watch)?.into_iter().collect::<Option<Vec<_>>>())
        };
        let Some(outcomes) = pieces.found("the runs", all)? else { return Ok(()) };
        let file = AtomicFile::create(&folder.join("results.csv"))?;
        (outcomes.into_iter().map(Some).collect(), Some(file))
    } else {
        let file = arguments.output.as_deref().map(AtomicFile::create).transpose()?;
        let bar = Progress::in_parts("the runs");
        (watched(&bar, |watch| work(&Journal::forgotten(), watch))?, file)
    };
    let is_complete = outcomes.iter().all(Option::is_some);
    if let Some(Err(error)) = outcomes[0].as_ref().filter(|_| outcomes.iter().all(has_failed)) {
        return Err(error.clone().into());
    }
    let mut rows = Vec::new();
    for (value, outcome) in values.iter().zip(outcomes) {
        match outcome {
            Some(Ok(summary)) => rows.push((*value, summary)),
            Some(Err(error)) => eprintln!("note: {name} = {value:?} is left out: {error}"),
            None => {}
        }
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    match &mut file {
        Some(file) => write(file, name, &names, &rows)?,
        None => match write(&mut BufWriter::new(stdout().lock()), name, &names, &rows) {
            // The reader of standard output has closed it (`| head`).
            Err(error) if is_broken_pipe(&*error) => {}
            result => result?,
        },
    }
    tell_doubts(name, &rows);
    if !is_complete {
        eprintln!("note: interrupted after {} of {} values", rows.len(), values.len());
        if let Some(partial) = file.as_ref().and_then(AtomicFile::partial) {
            eprintln!("the finished rows are in {}", partial.display());
        }
        return Err(Box::new(Interrupted));
    }
    file.map_or(Ok(()), |file| Ok(file.complete()?))
}

/// All settings on which the run of a value depends besides the scene and its values.
fn settings(arguments: &Simulate, view: &View) -> Result<Value, amontons::Error> {
    let read = |path: &PathBuf| {
        fs::read_to_string(path).map_err(|error| amontons::Error::file(path, &error))
    };
    Ok(json!({
        "stop_time": arguments.stop_time,
        "output_interval": arguments.output_interval,
        "of": arguments.of,
        "window": view.window,
        "from": arguments.from.as_ref().map(read).transpose()?,
    }))
}

/// Prints the reasons why `settled` is unknown, each once; for windows that are too short, with the longest that is
/// needed.
fn tell_doubts(name: &str, rows: &[(f64, Summary)]) {
    let doubts = rows.iter().filter_map(|(value, summary)| Some((*value, summary.settled.err()?)));
    let kind = |doubt: &UnsettledReason| std::mem::discriminant(doubt);
    let needed = |doubt: &UnsettledReason| {
        if let UnsettledReason::Short(window) = doubt { *window } else { 0.0 }
    };
    let mut told: Vec<(f64, usize, UnsettledReason)> = Vec::new();
    for (value, doubt) in doubts {
        match told.iter_mut().find(|(_, _, known)| kind(known) == kind(&doubt)) {
            Some((_, count, known)) => {
                *count += 1;
                if needed(&doubt) > needed(known) {
                    *known = doubt;
                }
            }
            None => told.push((value, 1, doubt)),
        }
    }
    for (first, count, doubt) in told {
        let values = counted(count, "value", "values");
        eprintln!(
            "note: settled is unknown for {values}, the first at {name} = {first:?}: {doubt}"
        );
    }
}

fn has_failed<T, E>(outcome: &Option<Result<T, E>>) -> bool {
    matches!(outcome, Some(Err(_)))
}

fn write(
    out: &mut dyn Write,
    name: &str,
    outputs: &[&str],
    rows: &[(f64, Summary)],
) -> Result<(), Box<dyn Error>> {
    write!(out, "{name}")?;
    for output in outputs {
        write!(out, ",amplitude.{output}")?;
    }
    write!(out, ",frequency,settled,share.slide,share.reverse_slide,share.stick,share.detached")?;
    if rows.first().is_some_and(|(_, summary)| !summary.energies.is_empty()) {
        for energy in ENERGIES {
            write!(out, ",energy.{energy}")?;
        }
    }
    writeln!(out)?;
    for (value, Summary { amplitudes, frequency, settled, shares, energies }) in rows {
        write!(out, "{value:?}")?;
        for amplitude in amplitudes {
            write!(out, ",{amplitude:?}")?;
        }
        write!(
            out,
            ",{}",
            frequency.map_or_else(String::new, |frequency| format!("{frequency:?}"))
        )?;
        let settled = match settled {
            Ok(true) => "yes",
            Ok(false) => "no",
            Err(_) => "unknown",
        };
        write!(out, ",{settled}")?;
        for value in shares.iter().chain(energies) {
            write!(out, ",{value:?}")?;
        }
        writeln!(out)?;
    }
    out.flush()?;
    Ok(())
}
