//! The arguments of `amontons`.

use crate::export::platforms;
use crate::study::arguments::Study;
use amontons::scene::{IntegratorChoice, Method, Preset};
use amontons_analysis::sweep::range::assignment;
use amontons_cli::arguments::{Format, Values, named_grid};
use amontons_cli::shards::ShardArguments;
use amontons_export::package::Library;
use amontons_matrices::Location;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use serde::Serialize;
use std::fs;
use std::path::PathBuf;

/// Friction contact dynamics as FMUs: will it squeal?
#[derive(Parser)]
#[command(name = "amontons", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Start with `amontons scenes`, which lists the built-in scenes. For complex eigenvalues \
                          (unstable modes and the friction coefficients at which they become unstable) see the second \
                          program: `amontons-stability \
                          --help`.\n\nExit codes: 0 success, 1 a file could not be read or written, or a picture \
                          could not be drawn, 2 the command line is wrong (for example an unknown option or \
                          variable), 3 the scene is invalid (its file, a value, no equilibrium, a step above the \
                          critical step), 4 the run failed, or \
                          reduce could not show that no mode is missing, 5 pieces of a shared \
                          study are missing (study merge), 130 interrupted (simulate keeps its rows in \
                          FILE.csv.partial, accuracy and --sweep print the finished rows, studies keep the finished \
                          pieces and continue from them, export writes nothing)";

#[derive(Subcommand)]
pub enum Command {
    /// Package a scene as an FMI 2.0 co-simulation FMU
    Export(Export),
    /// Run a scene without an importer and write its outputs as CSV
    Simulate(Simulate),
    /// Measure the cost of accuracy: errors and computing times of each method and step, against a converged reference
    Accuracy(Accuracy),
    /// List all effects, on or off in a scene: equation, additional variables, computing time per step
    Effects(Effects),
    /// Study the long-term motion of a scene: limit cycles over a parameter, growth of a transient, perturbations,
    /// branches over µ, basins of attraction
    Study {
        #[command(subcommand)]
        command: Study,
    },
    /// Reduce the matrices of a finite-element model to a superelement, with a certificate of its frequencies
    Reduce(Reduce),
    /// Check an FMI 2.0 co-simulation FMU from any tool: archive, model description, libraries, a run
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
    /// Path of the FMU [default: the scene's name with .fmu, in the current folder]
    #[arg(short, long, value_name = "FILE.fmu")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub integrator: Integrator,
    /// Begin on an orbit that `amontons study orbit` has found with the scene's values: the FMU's initial values are the
    /// orbit's
    #[arg(long, value_name = "ORBIT.JSON")]
    pub from: Option<PathBuf>,
    /// Put the table of `amontons accuracy` into the FMU's documentation, without times
    #[arg(long)]
    pub with_accuracy: bool,
    /// Write a reference run beside the FMU in the format of the FMI
    /// cross-check: NAME_ref.csv, NAME_ref.opt, NAME_in.csv
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
    /// Begin on an orbit that `amontons study orbit` has found with the same values
    #[arg(long, value_name = "ORBIT.JSON")]
    pub from: Option<PathBuf>,
    /// Inputs over time: a CSV file with a column `time` (s) and columns named after the FMU's inputs; values are
    /// interpolated linearly between rows, set before each output interval and held over it, as importers do
    #[arg(long, value_name = "FILE.csv")]
    pub input: Option<PathBuf>,
    /// Run the scene with values of a parameter or input from A to B, in steps of STEP or as N values, on all cores;
    /// the CSV then has one row per value: amplitude of each displacement (m, half of peak to peak), frequency of the
    /// displacement that moves most (Hz), and share of time in each contact state. For the time history of one value
    /// use --set NAME=VALUE
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N", value_parser = named_grid, conflicts_with = "input")]
    pub sweep: Option<(String, Values)>,
    /// Displacement whose amplitude and frequency a sweep evaluates [default: all displacements]
    #[arg(long, value_name = "NAME", requires = "sweep")]
    pub of: Option<String>,
    /// Length of the window at the end of each run that a sweep evaluates, s [default: a quarter of the run]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true,
        requires = "sweep")]
    pub window: Option<f64>,
    /// Path of the CSV file [default: standard output]; with --shard the folder of all workers
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
    /// Write the contact states that the run goes through, each with its share of the time and how often it was entered,
    /// the longest first; `amontons-stability states --patterns` gives their eigenvalues
    #[arg(long, value_name = "FILE.csv", conflicts_with = "sweep")]
    pub patterns: Option<PathBuf>,
    #[command(flatten)]
    pub shared: ShardArguments,
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
    /// End of the run, s [default: the scene's]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub stop_time: Option<f64>,
    /// Give a parameter or input another value; the names are those of the FMU
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, f64)>,
    /// Displacement whose amplitude and frequency are compared [default: the one that moves most]
    #[arg(long, value_name = "NAME")]
    pub of: Option<String>,
    /// Format of the output
    #[arg(long, value_enum, default_value = "table")]
    pub format: Format,
    /// Draw the error over the computing time
    #[arg(long, value_name = "FILE.svg|png")]
    pub plot: Option<PathBuf>,
}

#[derive(Args)]
pub struct Reduce {
    /// Stiffness matrix; NAME chooses one of a file that holds several (brake.mat#K)
    #[arg(long, value_name = "FILE[#NAME]")]
    pub stiffness: Location,
    /// Mass matrix
    #[arg(long, value_name = "FILE[#NAME]")]
    pub mass: Location,
    /// Another matrix of the structure, such as its damping, that is reduced with the same shapes to LABEL.mtx; it need not
    /// be symmetric
    #[arg(long, value_name = "LABEL=FILE[#NAME]", value_parser = labelled)]
    pub also: Vec<(String, Location)>,
    /// Node and direction of each row, if the matrices do not tell: a CSV file with the columns node,direction
    #[arg(long, value_name = "FILE.csv")]
    pub freedoms: Option<PathBuf>,
    /// Nodes of the contacts, retained in all directions: a list such as 12,15,20:30, or @FILE with one in it
    #[arg(long, value_name = "NODES", value_parser = nodes)]
    pub contacts: Nodes,
    /// Further nodes that are retained: those of loads, springs, outputs
    #[arg(long, value_name = "NODES", value_parser = nodes)]
    pub retain: Option<Nodes>,
    /// Frequency up to which the superelement is to hold, Hz; all frequencies are in the inverse of the unit of time of the files, kHz
    /// if that is the millisecond
    #[arg(long, value_name = "HZ", value_parser = above_zero, allow_hyphen_values = true)]
    pub frequency: f64,
    /// Keep the modes that the structure has while the retained nodes are held up to this frequency, Hz [default: twice
    /// --frequency]
    #[arg(long, value_name = "HZ", value_parser = above_zero, allow_hyphen_values = true)]
    pub modes_to: Option<f64>,
    /// Memory for factors and vectors, GB
    #[arg(long, value_name = "GB", value_parser = above_zero, default_value = "8")]
    pub memory: f64,
    /// Also write the motion of all rows for a unit of each coordinate, shapes.npy, and node and direction of these rows,
    /// shapes.csv
    #[arg(long)]
    pub shapes: bool,
    /// Mesh of the model, an input file of Abaqus or CalculiX, for --vtk and --picture
    #[arg(long, value_name = "FILE.inp")]
    pub mesh: Option<PathBuf>,
    /// Write the modes of the free superelement up to --frequency on the mesh, as a folder of files for ParaView
    #[arg(long, value_name = "DIR", requires = "mesh")]
    pub vtk: Option<PathBuf>,
    /// Draw the first 12 of these modes that are not at 0 Hz
    #[arg(long, value_name = "FILE.png|svg", requires = "mesh")]
    pub picture: Option<PathBuf>,
    /// Folder of the results: stiffness.mtx, mass.mtx, freedoms.csv, certificate.json
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Numbers of nodes.
#[derive(Clone, Debug)]
pub struct Nodes(pub Vec<u64>);

/// Parses `12,15,20:30` or `@FILE`, in which lines separate too.
fn nodes(text: &str) -> Result<Nodes, String> {
    let list = match text.strip_prefix('@') {
        Some(path) => {
            fs::read_to_string(path).map_err(|error| format!("cannot read {path}: {error}"))?
        }
        None => text.to_owned(),
    };
    let mut nodes = Vec::new();
    for word in list.split([',', ' ', '\t', '\r', '\n']).filter(|word| !word.is_empty()) {
        let (first, last) = word.split_once(':').unwrap_or((word, word));
        match (first.parse::<u64>(), last.parse::<u64>()) {
            (Ok(first), Ok(last)) if first <= last && last - first < MOST_NODES => {
                nodes.extend(first..=last);
            }
            _ => {
                return Err(format!(
                    "`{word}` is neither the number of a node nor a range such as 20:30"
                ));
            }
        }
    }
    if nodes.is_empty() { Err("names no node".into()) } else { Ok(Nodes(nodes)) }
}

/// The most nodes of a range; superelements of more would be no smaller than the structure.
const MOST_NODES: u64 = 100_000;

fn labelled(text: &str) -> Result<(String, Location), String> {
    let (label, location) = text.split_once('=').ok_or("must be LABEL=FILE")?;
    let is_name = !label.is_empty()
        && label.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if !is_name || ["stiffness", "mass"].contains(&label) {
        return Err(format!(
            "`{label}` cannot name a file of the results; use letters and digits, and not stiffness or mass"
        ));
    }
    let Ok(location) = location.parse();
    Ok((label.to_owned(), location))
}

fn above_zero(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("must be a number above zero".to_owned()),
    }
}

/// In place of the scene's `[integrator]`.
#[derive(Args, Serialize)]
pub struct Integrator {
    /// Internal time step, s [default: the scene's; in event-driven studies the time between two observations]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub step: Option<f64>,
    /// Integration method [default: the scene's; in studies other than basins event-driven, if the scene allows it]
    #[arg(long, value_parser = methods())]
    pub integrator: Option<Method>,
    /// Choose integrator and step for an accepted relative error
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
        Preset::Preview => "1e-2: the error is not visible in a plot of the motion",
        Preset::Design => "1e-4: the error is below the uncertainty of masses and stiffnesses",
        Preset::Reference => "1e-9: for comparison with other results",
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
    /// The options as a command line has them; nothing where none is given.
    pub fn words(&self) -> String {
        let step = self.step.map_or_else(String::new, |step| format!(" --step {step}"));
        let method = self.integrator.map(|method| format!(" --integrator {}", method.name()));
        let preset = self.preset.map(|preset| format!(" --preset {}", preset.name()));
        step + &method.unwrap_or_default() + &preset.unwrap_or_default()
    }

    /// The settings of the command line.
    pub fn choice(&self) -> IntegratorChoice {
        IntegratorChoice { method: self.integrator, step: self.step, preset: self.preset }
    }
}

#[derive(Subcommand)]
pub enum Scenes {
    /// Print the file of a built-in scene
    Show {
        /// Name of the scene
        name: String,
    },
    /// Draw a scene's masses, springs, dampers and contacts (up to 40 masses)
    Draw {
        /// A scene file (TOML), or the name of a built-in scene
        scene: String,
        /// Path of the picture; the file extension sets the format
        #[arg(short, long, value_name = "FILE.svg|png")]
        output: PathBuf,
    },
    /// Print the JSON Schema of scene files, with which editors check and complete them
    Schema,
}

fn platforms_help() -> String {
    let carried = platforms(Library::carried());
    format!("Platforms on which the FMU runs [default: all platforms of this program: {carried}]")
}

pub fn positive(text: &str) -> Result<f64, String> {
    above_zero(text).map_err(|wish| format!("{wish}, in seconds"))
}
