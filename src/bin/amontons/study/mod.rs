//! `amontons study`: each kind of study in a file of its own; what they share stands here.

pub mod arguments;
mod attractor;
mod basin;
pub mod continuation;
mod folder;
pub mod limit_cycle;
pub mod perturbation;
pub mod transient;

use crate::interrupt::{self, Interrupted};
use amontons::integrator::select;
use amontons::progress::Progress;
use amontons::scene::{self, Method, Scene, Selection, Source};
use amontons::simulation::assign;
use amontons::study::{Look, Watch, Wish, pace};
use arguments::{Common, Looking, Study};
use folder::Folder;
use std::error::Error;

pub fn run(command: &Study) -> Result<(), Box<dyn Error>> {
    interrupt::listen();
    match command {
        Study::Continuation(arguments) => continuation::run(arguments),
        Study::LimitCycle(arguments) => limit_cycle::run(arguments),
        Study::Transient(arguments) => transient::run(arguments),
        Study::Basin(arguments) => basin::run(arguments),
        Study::Perturbation(arguments) => perturbation::run(arguments),
    }
}

/// The scene with the values of the command line, and its files.
fn found(common: &Common) -> Result<(Scene, Source), amontons::Error> {
    let (mut scene, source) = scene::find(&common.scene)?;
    for (name, value) in &common.set {
        assign(&mut scene, name, *value)?;
    }
    scene.check()?;
    Ok((scene, source))
}

/// The same with the method and step of the study, and how it is looked at.
fn prepared(common: &Common, looking: &Looking) -> Result<(Scene, Source, Look), amontons::Error> {
    prepared_with(common, looking, pace)
}

/// The same with another method and step for a scene whose command line gives none.
fn prepared_with(
    common: &Common,
    looking: &Looking,
    default: fn(&mut Scene, &Look),
) -> Result<(Scene, Source, Look), amontons::Error> {
    let (mut scene, source) = found(common)?;
    let Looking { of, window, interval, longest } = looking;
    let wish = Wish { of: of.as_deref(), interval: *interval, window: *window, longest: *longest };
    let look = Look::of(&scene, &wish)?;
    set_pace(&mut scene, common, &look, default)?;
    Ok((scene, source, look))
}

/// Gives a scene the method and step of a study.
fn set_pace(
    scene: &mut Scene,
    common: &Common,
    look: &Look,
    default: fn(&mut Scene, &Look),
) -> Result<(), amontons::Error> {
    let given = &common.integrator;
    match (given.integrator, given.step, given.preset) {
        (None, None, None) => default(scene, look),
        (Some(Method::EventDriven), None, None) => {
            scene.set_integrator(given.integrator, Some(look.interval))?;
        }
        _ => given.apply(scene)?,
    }
    // A tolerance chooses once, for the scene as it is given: so all runs have the same step.
    if let Some(tolerance) = scene.selection.tolerance() {
        let selected = select(scene, tolerance);
        eprintln!("{}: {selected}", scene.name);
        (scene.method, scene.step, scene.selection) =
            (selected.method, selected.step, Selection::Given);
    }
    Ok(())
}

/// Method and step, and how motions are looked at, as the heading of a table says it.
fn heading(scene: &Scene, look: &Look) -> String {
    let method = match scene.method {
        Method::EventDriven => "exact motion between events",
        Method::ForwardIncrement => "the paper's scheme",
    };
    let Look { of, interval, window, longest } = look;
    format!(
        "{method}, step {} s; {of} every {interval} s, windows of {window} s, up to {longest} s",
        scene.step
    )
}

/// Does a study's work under a bar that shows the time left, until it is done or a person ends it.
fn watched<T>(
    work: impl FnOnce(Watch<'_>) -> Result<T, amontons::Error>,
) -> Result<T, amontons::Error> {
    let bar = Progress::in_parts("the study");
    let progress = |part: f64| bar.set_part(part);
    let result = work(Watch { go_on: &interrupt::stopped, progress: &progress });
    bar.finish();
    result
}

/// What a person is told who has ended a study.
fn interrupted(folder: &Folder) -> Box<dyn Error> {
    eprintln!(
        "note: {} finished pieces are kept in {}; the same command goes on from there",
        folder.journal().len(),
        folder.journal_path().display()
    );
    Box::new(Interrupted)
}
