//! The command line of the stability analyser: it reads arguments and writes tables and pictures; the library does the
//! analysis.

mod arguments;
mod bistable;
mod labels;
mod locus;
mod map;
mod matrices;
mod mesh;
mod modes;
mod sensitivity;
mod states;

use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::{Scene, Source, SuperelementFiles};
use amontons::simulation::at_instant;
use amontons_analysis::assign::assign;
use amontons_analysis::doubts::doubts_of;
use amontons_analysis::instant::{require_undriven, signals_left_out};
use amontons_analysis::stability::{Linearised, named_states};
use amontons_analysis::sweep::FRICTION;
use amontons_analysis::sweep::range::check_once;
use amontons_cli::exit;
use amontons_cli::shards::{Missing, Program, merging, tell_command};
use amontons_export::scene;
use amontons_export::superelement::RecordedFiles;
use arguments::{Merge, SceneArguments, StabilityArguments, StabilityCommand};
use clap::Parser;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::process::ExitCode;

/// Reasons for which a command ends early.
enum Failure {
    /// A wrong command line, with the form that would be right.
    Usage(String),
    Analysis(Error),
    Output(io::Error),
    /// The modes that were found are printed, but one may be missing.
    NotShown,
    /// The user has ended the command, or pieces of other workers are missing.
    Unfinished(Box<dyn std::error::Error>),
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

impl From<Box<dyn std::error::Error>> for Failure {
    fn from(error: Box<dyn std::error::Error>) -> Self {
        error.downcast().map_or_else(Self::Unfinished, |error| Self::Analysis(*error))
    }
}

fn main() -> ExitCode {
    let mut out = BufWriter::new(io::stdout().lock());
    let result = run(StabilityArguments::parse().command, &mut out);
    let flushed = out.flush().map_err(Failure::Output);
    match result.and(flushed) {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of standard output has closed it.
        Err(Failure::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(Failure::Output(error)) => {
            eprintln!("error: cannot write to standard output: {error}");
            ExitCode::from(1)
        }
        Err(Failure::Usage(wish)) => {
            eprintln!("error: {wish}");
            ExitCode::from(2)
        }
        Err(Failure::NotShown) => ExitCode::from(exit::NOT_SHOWN),
        // Which pieces are missing is told as a result.
        Err(Failure::Unfinished(error)) => {
            if !error.is::<Missing>() {
                eprintln!("error: {error}");
            }
            ExitCode::from(exit::code(&*error))
        }
        Err(Failure::Analysis(error)) => {
            eprintln!("error: {error}");
            ExitCode::from(arguments::exit_code(&error))
        }
    }
}

fn run(command: StabilityCommand, out: &mut dyn Write) -> Result<(), Failure> {
    match command {
        StabilityCommand::States(arguments) => states::run(&arguments, out),
        StabilityCommand::Locus(arguments) => locus::run(&arguments, out),
        StabilityCommand::Modes(arguments) => modes::run(&arguments, out),
        StabilityCommand::Sensitivity(arguments) => sensitivity::run(&arguments, out),
        StabilityCommand::Bistable(arguments) => bistable::run(&arguments, out),
        StabilityCommand::Map(arguments) => map::run(&arguments, out),
        StabilityCommand::Matrices(arguments) => matrices::run(&arguments, out),
        StabilityCommand::Merge(Merge { folder }) => merge(&folder, out),
    }
}

/// Puts the pieces of all workers in a folder together.
fn merge(folder: &Path, out: &mut dyn Write) -> Result<(), Failure> {
    let merge: StabilityArguments = merging(Program::Stability, folder)?;
    let merged = run(merge.command, out);
    if matches!(merged, Err(Failure::Analysis(_) | Failure::Usage(_))) {
        tell_command(folder);
    }
    merged
}

/// A scene as a command analyses it.
struct AnalysedScene {
    /// The scene at one instant, without signals.
    scene: Scene,
    /// The files of the scene.
    source: Source,
    /// The superelements whose matrices are in files of other programs.
    superelements: Vec<SuperelementFiles>,
    /// The instant, s; `None` for a scene without signals.
    at: Option<f64>,
    /// A note on the parts of the signals that the analysis leaves out.
    left_out: Option<String>,
}

impl AnalysedScene {
    /// The line under a heading that names the parts left out; empty if nothing is.
    fn head(&self) -> String {
        self.left_out.as_ref().map_or_else(String::new, |left_out| format!("{left_out}\n"))
    }
}

/// The scene with the values of the command line, at the instant that it states. `varied` are the parameters whose
/// values the command varies.
fn configured(
    common: &SceneArguments,
    friction: Option<f64>,
    varied: &[&str],
) -> Result<AnalysedScene, Error> {
    let files = RecordedFiles::default();
    let (mut scene, source) = scene::find_with(&common.scene, &files)?;
    check_once(&common.set)?;
    for (name, value) in &common.set {
        assign(&mut scene, name, *value)?;
    }
    if let Some(friction) = friction {
        if common.set.iter().any(|(set, _)| set == FRICTION) {
            eprintln!("note: {FRICTION} takes the value of --friction, not that of --set");
        }
        assign(&mut scene, FRICTION, friction)?;
    }
    scene.check()?;
    for doubt in doubts_of(&scene) {
        eprintln!("warning: {doubt}");
    }
    varied.iter().try_for_each(|name| require_undriven(&scene, name))?;
    let time = common.at.unwrap_or(0.0);
    let left_out = signals_left_out(&scene, time);
    match (&left_out, common.at) {
        (Some(left_out), None) => eprintln!("note: {left_out}; --at TIME selects another instant"),
        (Some(left_out), Some(_)) => eprintln!("note: {left_out}"),
        (None, Some(_)) => eprintln!("note: the scene has no signals, so --at changes nothing"),
        (None, None) => {}
    }
    let at = left_out.is_some().then_some(time);
    let scene = at_instant(&scene, time)?;
    scene.check()?;
    Ok(AnalysedScene { scene, source, superelements: files.into_tables(), at, left_out })
}

/// Friction coefficients for the heading of a table.
fn friction(scene: &Scene) -> String {
    let (law, friction) = (scene.contact_law().friction, scene.friction());
    let (about, kinetic) = (law.info(), friction.kinetic);
    if about.is_constant() {
        format!("µ = {}", of_contacts(scene).unwrap_or_else(|| kinetic.to_string()))
    } else {
        let greatest = law.greatest_in_slip(friction);
        format!("µ = {greatest} to {kinetic} ({}), linearised at the slider's velocity", about.name)
    }
}

/// Friction coefficient of each contact; `None` if no contact has a coefficient of its own.
fn of_contacts(scene: &Scene) -> Option<String> {
    let contacts = &scene.network()?.contacts;
    contacts.iter().find(|contact| contact.friction.is_some())?;
    let each = contacts.iter().map(|contact| {
        let friction = contact.friction.unwrap_or(scene.friction_coefficient);
        format!("{friction} (contact.{})", contact.name)
    });
    Some(each.collect::<Vec<_>>().join(", "))
}

/// Refuses a parameter on which no quantity of the analysis depends.
fn check_effect<T: PartialEq>(
    name: &str,
    values: &[f64],
    seen: impl Fn(f64) -> Result<T, Error>,
    wish: &str,
) -> Result<(), Failure> {
    if let Some((last, others)) = values.split_last() {
        let first = seen(*last)?;
        for value in others {
            if seen(*value)? != first {
                return Ok(());
            }
        }
    }
    Err(Failure::Usage(format!("{name} has no effect on this analysis: {wish}")))
}

/// Returns the scene with another value of a parameter.
fn with(scene: &Scene, name: &str, value: f64) -> Result<Scene, Error> {
    let mut scene = scene.clone();
    assign(&mut scene, name, value)?;
    scene.check()?;
    Ok(scene)
}

/// Returns the contact state that a command analyses: the state named on the command line, or uniform sliding.
fn state(name: Option<&str>, scene: &Scene, here: &Linearised) -> Result<Vec<ContactState>, Error> {
    match name {
        Some(name) => named_states(name, scene, here),
        None => here.uniform_sliding(),
    }
}
