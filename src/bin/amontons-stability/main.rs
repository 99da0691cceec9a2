//! The stability analyser's command line: arguments in, tables and pictures out; the work is the
//! library's.

mod arguments;
mod bistable;
mod labels;
mod locus;
mod map;
mod modes;
mod states;

use amontons::Error;
use amontons::contact::{ContactState, Friction, parse_states};
use amontons::model::{Equilibrium, LumpedModel, equilibrium};
use amontons::scene::{self, Scene};
use amontons::simulation::assign;
use amontons::stability::candidates::uniform_sliding;
use arguments::{Arguments, Command, Common};
use clap::Parser;
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

/// Why a command ended early.
enum Failure {
    /// The command line makes no sense: what would be right.
    Usage(String),
    Analysis(Error),
    Output(io::Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Analysis(error)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

fn main() -> ExitCode {
    let mut out = BufWriter::new(io::stdout().lock());
    let result = match Arguments::parse().command {
        Command::States(arguments) => states::run(&arguments, &mut out),
        Command::Locus(arguments) => locus::run(&arguments, &mut out),
        Command::Modes(arguments) => modes::run(&arguments, &mut out),
        Command::Bistable(arguments) => bistable::run(&arguments, &mut out),
        Command::Map(arguments) => map::run(&arguments, &mut out),
    };
    let flushed = out.flush().map_err(Failure::Output);
    match result.and(flushed) {
        Ok(()) => ExitCode::SUCCESS,
        // Who reads has read enough.
        Err(Failure::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(Failure::Output(error)) => {
            eprintln!("error: cannot print: {error}");
            ExitCode::from(1)
        }
        Err(Failure::Usage(wish)) => {
            eprintln!("error: {wish}");
            ExitCode::from(2)
        }
        Err(Failure::Analysis(error)) => {
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
    if let Some(friction) = friction {
        assign(&mut scene, "friction.coefficient", friction)?;
    }
    scene.check()?;
    Ok(scene)
}

/// The scene's model, linearised about its equilibrium.
fn linearised(scene: &Scene) -> (LumpedModel, Result<Equilibrium, Error>) {
    let mut model = LumpedModel::from(scene);
    let equilibrium = equilibrium(scene, &model);
    if let Ok(equilibrium) = &equilibrium {
        model.linearise(equilibrium);
    }
    (model, equilibrium)
}

/// µ as the heading of a table says it.
fn friction(scene: &Scene) -> String {
    let about = scene.contact_law().friction.about();
    let Friction { kinetic, static_, .. } = scene.friction();
    if about.is_constant() {
        format!("µ = {kinetic}")
    } else {
        format!("µ = {static_} to {kinetic} ({}), linearised at the slider's velocity", about.name)
    }
}

/// Refuses an analysis that varies µ as one number where the law has none.
fn require_constant_friction(scene: &Scene) -> Result<(), Failure> {
    let about = scene.contact_law().friction.about();
    if about.is_constant() {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "{} has the law \"{}\", by which µ is another at each slip velocity: this analysis follows one µ; \
         look at the scene's own values with `states` and `modes`, or at a `map` of two of its parameters",
        scene.name, about.name
    )))
}

/// Refuses a parameter of which nothing depends that an analysis looks at.
fn check_effect<T: PartialEq>(
    name: &str,
    [first, last]: [f64; 2],
    seen: impl Fn(f64) -> Result<T, Error>,
    wish: &str,
) -> Result<(), Failure> {
    if seen(first)? != seen(last)? {
        return Ok(());
    }
    Err(Failure::Usage(format!("nothing here depends on {name}; {wish}")))
}

/// The scene with another value of a parameter.
fn with(scene: &Scene, name: &str, value: f64) -> Result<Scene, Error> {
    let mut scene = scene.clone();
    assign(&mut scene, name, value)?;
    scene.check()?;
    Ok(scene)
}

/// The contact state that a command is to look at: the one named, or uniform sliding.
fn state(
    name: Option<&str>,
    scene: &Scene,
    model: &LumpedModel,
) -> Result<Vec<ContactState>, Error> {
    match name {
        Some(name) => parse_states(name, model.contacts.len()),
        None => uniform_sliding(model, scene.slider.velocity),
    }
}
