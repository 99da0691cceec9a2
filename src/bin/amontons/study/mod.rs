//! `amontons study`: each kind of study in a file of its own; what they share stands here.

pub mod arguments;
mod continuation;
mod folder;
mod limit_cycle;

use crate::interrupt::{self, Interrupted};
use amontons::integrator::select;
use amontons::scene::{self, Method, Scene, Selection, Source};
use amontons::simulation::assign;
use amontons::study::{Look, Watch, Wish, pace};
use arguments::{Common, Looking, Study};
use folder::Folder;
use std::error::Error;

pub fn run(command: &Study) -> Result<(), Box<dyn Error>> {
    interrupt::listen();
    match command {
        Study::LimitCycle(arguments) => limit_cycle::run(arguments),
        Study::Continuation(arguments) => continuation::run(arguments),
    }
}

/// The scene with the values of the command line and the method and step of the study, its files, and how it is
/// looked at.
fn prepared(common: &Common, looking: &Looking) -> Result<(Scene, Source, Look), amontons::Error> {
    let (mut scene, source) = scene::find(&common.scene)?;
    for (name, value) in &common.set {
        assign(&mut scene, name, *value)?;
    }
    scene.check()?;
    let Looking { of, window, interval, longest } = looking;
    let wish = Wish { of: of.as_deref(), interval: *interval, window: *window, longest: *longest };
    let look = Look::of(&scene, &wish)?;
    let given = &common.integrator;
    match (given.integrator, given.step, given.preset) {
        (None, None, None) => pace(&mut scene, &look),
        (Some(Method::EventDriven), None, None) => {
            scene.set_integrator(given.integrator, Some(look.interval))?;
        }
        _ => given.apply(&mut scene)?,
    }
    // A tolerance chooses once, for the scene as it is given: so all runs have the same step.
    if let Some(tolerance) = scene.selection.tolerance() {
        let selected = select(&scene, tolerance);
        eprintln!("{}: {selected}", scene.name);
        (scene.method, scene.step, scene.selection) =
            (selected.method, selected.step, Selection::Given);
    }
    Ok((scene, source, look))
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
    let bar = interrupt::bar_with_time();
    let progress = |part: f64| interrupt::show(&bar, part);
    let result = work(Watch { go_on: &interrupt::stopped, progress: &progress });
    bar.finish_and_clear();
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
