//! `amontons study`: each kind of study in a file of its own; what they share stands here.

pub mod arguments;
mod folder;

use crate::interrupt::{self, Interrupted};
use amontons::scene::{self, Scene, Source};
use amontons::simulation::assign;
use amontons::study::Watch;
use arguments::{Common, Study};
use folder::Folder;
use std::error::Error;

pub fn run(command: &Study) -> Result<(), Box<dyn Error>> {
    interrupt::listen();
    match *command {}
}

/// The scene with the values of the command line, and its files.
fn configured(common: &Common) -> Result<(Scene, Source), amontons::Error> {
    let (mut scene, source) = scene::find(&common.scene)?;
    for (name, value) in &common.set {
        assign(&mut scene, name, *value)?;
    }
    scene.check()?;
    Ok((scene, source))
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
