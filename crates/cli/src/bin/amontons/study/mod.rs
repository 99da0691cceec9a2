//! `amontons study`: each kind of study has a module; this one holds the shared parts.

pub mod arguments;
mod attractor;
mod basin;
mod branches;
mod continuation;
mod design;
mod folder;
mod limit_cycle;
mod loudness;
mod merge;
pub mod orbit;
mod perturbation;
mod report;
mod robustness;
mod transient;

use amontons::error::Rounded;
use amontons::numerics::range;
use amontons::scene::{Method, Scene, Source};
use amontons_analysis::assign::assign;
use amontons_analysis::doubts::doubts_of;
use amontons_analysis::study::{self, ObservationSettings, Watch, derive_pace, pace};
use amontons_analysis::sweep::range::check_once;
use amontons_cli::interrupt;
use amontons_cli::progress::Progress;
use amontons_export::scene;
use arguments::{ObservationOptions, Study, StudyArguments};
use std::error::Error;

pub fn run(command: &Study) -> Result<(), Box<dyn Error>> {
    interrupt::listen();
    match command {
        Study::Continuation(arguments) => continuation::run(arguments),
        Study::LimitCycle(arguments) => limit_cycle::run(arguments),
        Study::Transient(arguments) => transient::run(arguments),
        Study::Basin(arguments) => basin::run(arguments),
        Study::Perturbation(arguments) => perturbation::run(arguments),
        Study::Loudness(arguments) => loudness::run(arguments),
        Study::Orbit(arguments) => orbit::run(arguments),
        Study::Branches(arguments) => branches::run(arguments),
        Study::Robustness(arguments) => robustness::run(arguments),
        Study::Design(arguments) => design::run(arguments),
        Study::Report(arguments) => report::run(arguments),
        Study::Merge(arguments) => merge::run(arguments),
    }
}

/// Returns the scene with the values of the command line, and its source.
fn found(common: &StudyArguments) -> Result<(Scene, Source), amontons::Error> {
    let (mut scene, source) = scene::find(&common.scene)?;
    check_once(&common.set)?;
    for (name, value) in &common.set {
        assign(&mut scene, name, *value)?;
    }
    scene.check()?;
    for doubt in doubts_of(&scene) {
        eprintln!("warning: {doubt}");
    }
    Ok((scene, source))
}

/// Returns the scene with the values of the command line and the method and step of a study, its source, and the
/// observation settings.
fn prepared(
    common: &StudyArguments,
    options: &ObservationOptions,
) -> Result<(Scene, Source, ObservationSettings), amontons::Error> {
    prepared_with(common, options, pace)
}

/// Prepares the scene as [`prepared`] does; if the command line gives no method and step, `default` sets them.
fn prepared_with(
    common: &StudyArguments,
    options: &ObservationOptions,
    default: fn(&mut Scene, &ObservationSettings),
) -> Result<(Scene, Source, ObservationSettings), amontons::Error> {
    let (mut scene, source) = found(common)?;
    let observation = ObservationSettings::of(&scene, &options.request())?;
    set_pace(&mut scene, common, &observation, default)?;
    Ok((scene, source, observation))
}

/// Prepares the scene of a study again after a parameter has changed: the method and step of the command line stay,
/// those derived from the observation settings are derived again.
fn prepared_again(
    scene: &mut Scene,
    common: &StudyArguments,
    options: &ObservationOptions,
) -> Result<ObservationSettings, amontons::Error> {
    let observation = ObservationSettings::of(scene, &options.request())?;
    derive_pace(scene, &common.integrator.choice(), &observation, pace)?;
    Ok(observation)
}

/// Sets the method and step of a study.
fn set_pace(
    scene: &mut Scene,
    common: &StudyArguments,
    observation: &ObservationSettings,
    default: fn(&mut Scene, &ObservationSettings),
) -> Result<(), amontons::Error> {
    let choice = common.integrator.choice();
    if let Some(selected) = study::set_pace(scene, &choice, observation, default)? {
        eprintln!("{}: {selected}", scene.name);
    }
    Ok(())
}

/// Method, step and observation settings of all runs, for the heading of a table.
fn heading(runs: &[(&Scene, &ObservationSettings)]) -> String {
    let method = match runs[0].0.method {
        Method::EventDriven => "exact motion between events",
        Method::ForwardIncrement => "the paper's scheme",
    };
    format!(
        "{method}, step {} s; {} observed every {} s in windows of {} s, for at most {} s",
        over(runs.iter().map(|(scene, _)| scene.step)),
        runs[0].1.of,
        over(runs.iter().map(|(_, observation)| observation.interval)),
        over(runs.iter().map(|(_, observation)| observation.window)),
        over(runs.iter().map(|(_, observation)| observation.longest)),
    )
}

/// Formats the one value that all have, or the least and the largest: `0.5 to 50`.
fn over(values: impl Iterator<Item = f64>) -> String {
    let [least, most] = range(values).map(|value| Rounded(value).to_string());
    if least == most { least } else { format!("{least} to {most}") }
}

/// Runs the work of a study under a bar that shows the time left, until it is done or the user ends it.
fn watched<T>(work: impl FnOnce(Watch<'_>) -> T) -> T {
    interrupt::watched(&Progress::in_parts("the study"), work)
}

/// Runs the work of a study under a bar that shows its progress but no time left, because some pieces take many times
/// as long as others.
fn watched_unevenly<T>(
    work: impl FnOnce(Watch<'_>) -> Result<T, amontons::Error>,
) -> Result<T, amontons::Error> {
    interrupt::watched(&Progress::in_uneven_parts("the study"), work)
}
