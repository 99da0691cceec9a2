//! The arguments of `amontons`.

use crate::export::platforms;
use crate::study::arguments::Study;
use amontons::Error;
use amontons::scene::{Method, Preset, Scene, Selection};
use amontons_analysis::sweep::range::{self, assignment};
use amontons_export::package::Library;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Friction contact dynamics as FMUs: will it squeal?
#[derive(Parser)]
#[command(name = "amontons", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Start with `amontons scenes`, which lists scenes to begin from. Eigenvalues (which modes \
grow, from which friction on) are the second program's: `amontons-stability --help`.\n\nExit codes: 0 done, 1 a file could not be read or written or a picture not \
drawn, 2 the command line makes no sense (an unknown option or variable), 3 the \
scene is impossible (its file, a value, no equilibrium, a step above the critical one), 4 the run \
failed, 130 interrupted (simulate leaves its rows in FILE.csv.partial, accuracy and --sweep print what is done, studies keep it and continue from it, export writes nothing)";

#[derive(Subcommand)]
pub enum Command {
    /// Package a scene as an FMI 2.0 co-simulation FMU
    Export(Export),
    /// Run a scene without an importer and write its outputs as CSV
    Simulate(Simulate),
    /// Show what accuracy costs: errors and times of each method and step, against a proven reference
    Accuracy(Accuracy),
    /// List every effect, on or off in a scene: its equation, the variables it brings, what it costs a step
    Effects(Effects),
    /// What a scene ends in: limit cycles over a parameter, growth of a transient, perturbations, branches over µ, basins
    Study {
        #[command(subcommand)]
        command: Study,
    },
    /// Examine an FMI 2.0 co-simulation FMU, whoever made it: archive, description, libraries, a run
    Check(fmu_check::command::Arguments),
    /// Run the library of an unpacked FMU; `check` calls this
    #[command(name = fmu_check::COMMAND, hide = true)]
    RunLibrary(fmu_check::command::LibraryRun),
    /// List the built-in scenes, show one to start from, draw any, or print the schema of scene files
    Scenes {
        #[command(subcommand)]
        command: Option<Scenes>,
    },
}

#[derive(Args)]
pub struct Export {
    /// A scene file (TOML), or the name of a built-in scene
    pub scene: String,
    /// Where to write the FMU [default: the scene's name with .fmu, here]
    #[arg(short, long, value_name = "FILE.fmu")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub integrator: Integrator,
    /// Put the table of `amontons accuracy` into the FMU's documentation, without times
    #[arg(long)]
    pub with_accuracy: bool,
    /// Write a reference run beside the FMU, as the FMI cross-check has it: NAME_ref.csv, NAME_ref.opt, NAME_in.csv
    #[arg(long)]
    pub with_reference: bool,
    #[arg(long, value_name = "PLATFORM,…", value_delimiter = ',', value_parser = Library::of, help = platforms_help())]
    pub platform: Vec<Library>,
}

#[derive(Args)]
pub struct Simulate {
    /// A scene file (TOML), or the name of a built-in scene
    pub scene: String,
    /// End of the run, s [default: the scene's]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub stop_time: Option<f64>,
    /// Time between two rows, s [default: the scene's]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub output_interval: Option<f64>,
    #[command(flatten)]
    pub integrator: Integrator,
    /// Give a parameter or input another value; the names are those of the FMU
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, f64)>,
    /// Inputs over time: a CSV file with a column `time` (s) and others named as the FMU's inputs, set
    /// before each output interval and held over it, as importers do; linear between rows
    #[arg(long, value_name = "FILE.csv")]
    pub input: Option<PathBuf>,
    /// Run the values from A to B of a parameter or input, in steps or N of them, on all cores; the CSV then has a
    /// row a value: amplitude of each displacement (m, half of peak to peak), frequency of the one that moves most (Hz), and how
    /// much of the time contacts are in each state. The course of a value is that of --set NAME=VALUE
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N", value_parser = named_values, conflicts_with = "input")]
    pub sweep: Option<(String, Values)>,
    /// The only displacement whose amplitude and frequency a sweep looks at [default: all]
    #[arg(long, value_name = "NAME", requires = "sweep")]
    pub of: Option<String>,
    /// How long before the end of a run a sweep looks at it, s [default: the last quarter]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true,
        requires = "sweep")]
    pub window: Option<f64>,
    /// Where to write the CSV [default: standard output]
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
}

#[derive(Args)]
pub struct Effects {
    /// A scene file (TOML), or the name of a built-in scene
    pub scene: String,
}

#[derive(Args)]
pub struct Accuracy {
    /// A scene file (TOML), or the name of a built-in scene
    pub scene: String,
    /// End of the window, s [default: the scene's]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub stop_time: Option<f64>,
    /// Give a parameter or input another value; the names are those of the FMU
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, f64)>,
    /// The displacement whose amplitude and frequency are looked at [default: the one that moves most]
    #[arg(long, value_name = "NAME")]
    pub of: Option<String>,
    /// How to print
    #[arg(long, value_enum, default_value = "table")]
    pub format: Format,
    /// Draw error against time
    #[arg(long, value_name = "FILE.svg|png")]
    pub plot: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Table,
    Csv,
    Json,
}

/// In place of the scene's `[integrator]`.
#[derive(Args)]
pub struct Integrator {
    /// Internal time step, s [default: the scene's; a study's look at the motion]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub step: Option<f64>,
    /// How the motion is computed [default: the scene's; of studies other than basins event-driven, where the scene
    /// allows it]
    #[arg(long, value_parser = methods())]
    pub integrator: Option<Method>,
    /// Choose integrator and step by the relative error that is accepted
    #[arg(long, conflicts_with_all = ["step", "integrator"])]
    #[arg(value_parser = presets())]
    pub preset: Option<Preset>,
}

/// A parser of the methods' names, with a help text for each.
fn methods() -> impl TypedValueParser<Value = Method> {
    one_of(&Method::ALL, Method::name, |method| match method {
        Method::ForwardIncrement => {
            "The paper's scheme: forward increment Lagrange multipliers, of first order"
        }
        Method::EventDriven => "Exact motion from one change of contact state to the next",
    })
}

/// A parser of the presets' names, with a help text for each.
fn presets() -> impl TypedValueParser<Value = Preset> {
    one_of(&Preset::ALL, Preset::name, |preset| match preset {
        Preset::Preview => "1e-2: no difference is seen in a picture of the motion",
        Preset::Design => "1e-4: below what masses and stiffnesses are known to",
        Preset::Reference => "1e-9: to compare others with",
    })
}

/// A parser that takes the name of one of these values.
fn one_of<T: Copy + Send + Sync>(
    all: &'static [T],
    name: fn(T) -> &'static str,
    help: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let values = all.iter().map(|&value| PossibleValue::new(name(value)).help(help(value)));
    let named = move |word: String| all.iter().copied().find(|value| name(*value) == word);
    PossibleValuesParser::new(values).map(move |word| named(word).expect("it is one of them"))
}

impl Integrator {
    /// Applies the settings of the command line to the scene.
    ///
    /// # Errors
    /// Returns an error if a method is given without a step, or a step without a method, for a scene that chooses both.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), Error> {
        match self.preset {
            Some(preset) => scene.selection = Selection::Preset(preset),
            None => scene.set_integrator(self.integrator, self.step)?,
        }
        Ok(())
    }
}

#[derive(Subcommand)]
pub enum Scenes {
    /// Print the file of a built-in scene
    Show {
        /// Its name
        name: String,
    },
    /// Draw a scene's masses, springs, dampers and contacts (up to 40 masses)
    Draw {
        /// A scene file (TOML), or the name of a built-in scene
        scene: String,
        /// Where to write the picture; the ending says which kind
        #[arg(short, long, value_name = "FILE.svg|png")]
        output: PathBuf,
    },
    /// Print the JSON Schema of scene files, with which editors check and complete them
    Schema,
}

fn platforms_help() -> String {
    let carried = platforms(Library::carried());
    format!(
        "The platforms that the FMU is to run on [default: all that this program carries: {carried}]"
    )
}

pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("must be a number above zero, in seconds".to_owned()),
    }
}

/// Values of a parameter, ascending.
#[derive(Clone, Debug)]
pub struct Values(pub Vec<f64>);

pub fn values(text: &str) -> Result<Values, String> {
    range::grid(text).map(Values)
}

pub fn named_values(text: &str) -> Result<(String, Values), String> {
    range::named(text, values)
}
