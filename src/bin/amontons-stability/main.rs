//! The stability analyser's command line: arguments in, tables and pictures out; the work is the
//! library's.

mod arguments;
mod bistable;
mod locus;
mod map;
mod modes;
mod states;

use amontons::Error;
use amontons::scene::{self, Scene};
use amontons::simulation::{assign, step_warning};
use arguments::{Arguments, Command, Common};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use std::process::ExitCode;

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::States(arguments) => states::run(&arguments),
        Command::Locus(arguments) => locus::run(&arguments),
        Command::Modes(arguments) => modes::run(&arguments),
        Command::Bistable(arguments) => bistable::run(&arguments),
        Command::Map(arguments) => map::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(arguments::exit_code(&error))
        }
    }
}

/// The scene with the values of the command line.
fn configured(common: &Common, friction: Option<f64>) -> Result<Scene, Error> {
    let (mut scene, _) = scene::find(&common.scene)?;
    for (name, value) in &common.set {
        assign(&mut scene, name, *value)?;
    }
    scene.friction_coefficient = friction.unwrap_or(scene.friction_coefficient);
    scene.check()?;
    if let Some(warning) = step_warning(&scene) {
        eprintln!("warning: {warning}");
    }
    Ok(scene)
}

/// A bar on standard error, shown only to a person.
fn progress(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len}  {eta} left");
    ProgressBar::new(length as u64).with_style(style.expect("the template is fixed"))
}
