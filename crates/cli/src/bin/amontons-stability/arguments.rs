//! The arguments of `amontons-stability`.

use amontons::Error;
use amontons_analysis::sweep::range::{self, assignment, ends};
use amontons_cli::arguments::{Format, Values, islands, named_grid, named_steps, steps};
use amontons_cli::shards::ShardArguments;
use amontons_matrices::Location;
use clap::{Args, Parser, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Complex eigenvalues of a scene in its contact states: unstable modes and their critical friction coefficients
#[derive(Parser)]
#[command(name = "amontons-stability", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct StabilityArguments {
    #[command(subcommand)]
    pub command: StabilityCommand,
}

const EXIT_CODES: &str = "For runs, studies of motions and FMUs see the first program: `amontons --help`; `amontons \
                          scenes` lists the built-in \
                          scenes.\n\nExit codes: 0 success, 1 a file could not be read or written, 2 the command line \
                          is wrong (for example an unknown option, variable or contact state), 3 the scene is invalid \
                          or cannot be analysed, 4 modes are missing or it \
                          was not shown that none is (matrices), 5 pieces of a shared map are missing (merge), 130 interrupted";

/// The exit code that belongs to an error.
pub fn exit_code(error: &Error) -> u8 {
    match error {
        error if error.is_argument() => 2,
        error if error.is_picture() || error.is_file() => 1,
        _ => 3,
    }
}

#[derive(Subcommand)]
pub enum StabilityCommand {
    /// Eigenvalues of all contact states (the paper's Tables 2 and 3)
    States(States),
    /// Modes over the friction coefficient or any other parameter (Fig. 2a and b)
    Locus(Locus),
    /// Mode shapes of one contact state (Fig. 2c)
    Modes(Modes),
    /// Derivatives of growth rates, frequencies and critical friction coefficients by every parameter
    Sensitivity(Sensitivity),
    /// Ranges of the friction coefficient that can be bi-stable
    Bistable(Bistable),
    /// Stability map over two parameters: stable, candidate for bi-stability, unstable
    Map(Map),
    /// Modes of matrices from files, without contacts: all in a rectangle of growth rates and frequencies, none missed
    Matrices(Matrices),
    /// Put the pieces of all workers of a map together (--shard), tell what is missing, or write the map
    ///
    /// It may be run at any time and any number of times, while workers run or after they were killed, in the folder in
    /// which they were started. If pieces are missing, it tells how many and what to do next (exit code 5). If none is,
    /// it writes results.csv, as `map --csv` prints it, and the picture.
    Merge(Merge),
}

#[derive(Args)]
pub struct Merge {
    /// The folder that the workers were given with -o
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

#[derive(Args)]
pub struct SceneArguments {
    /// A scene file (TOML), or the name of a built-in scene
    pub scene: String,
    /// Give a parameter or input another value; the names are those of the FMU
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, f64)>,
    /// Instant at which the signals of the scene are evaluated, s; the eigenvalues hold for this instant [default: 0]
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true)]
    pub at: Option<f64>,
}

/// One friction coefficient, one contact state.
#[derive(Args)]
pub struct Point {
    /// Friction coefficient [default: the scene's]
    #[arg(long, value_name = "MU", allow_hyphen_values = true)]
    pub friction: Option<f64>,
    /// Contact state: Sl (slip velocity v − ẋ above 0), R-Sl (below 0), St (sticks) or Dt (detached), one for all
    /// contacts, or one for each, such as Sl-St; by names of contacts and sets of contacts with * for all others, such as
    /// pad=St,*=Sl; or `equilibrium` [default: all contact states of up to 8 contacts for `states`, uniform sliding for
    /// `modes` and `sensitivity`]
    #[arg(long, value_name = "STATE")]
    pub state: Option<String>,
}

#[derive(Args)]
pub struct States {
    #[command(flatten)]
    pub common: SceneArguments,
    #[command(flatten)]
    pub point: Point,
    /// The contact states that a run went through: a file that `amontons simulate --patterns` has written for this scene
    #[arg(long, value_name = "FILE.csv", conflicts_with = "state")]
    pub patterns: Option<PathBuf>,
    /// Number of the contact states of --patterns that are examined, the longest first
    #[arg(long, value_name = "N", default_value_t = 20, requires = "patterns")]
    pub first: usize,
    /// Format of the output
    #[arg(long, value_enum, default_value = "table")]
    pub format: Format,
}

#[derive(Args)]
pub struct Locus {
    #[command(flatten)]
    pub common: SceneArguments,
    /// Friction coefficients from A to B, in steps of STEP or as N values
    #[arg(long, value_name = "A:B:STEP|A:B/N", value_parser = steps, allow_hyphen_values = true,
        required_unless_present = "parameter")]
    pub friction: Option<Values>,
    /// Another parameter and its values; with --friction, one locus over µ for each of them
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N", value_parser = named_steps)]
    pub parameter: Option<(String, Values)>,
    /// Contact state, one for all contacts (Sl), one for each (Sl-St), by names (pad=St,*=Sl), or `equilibrium` [default:
    /// uniform sliding]
    #[arg(long, value_name = "STATE")]
    pub state: Option<String>,
    /// Only modes whose frequency lies between A and B, Hz; modes that do not oscillate have 0 [default: all, which takes minutes
    /// for a hundred modes or more]
    #[arg(long, value_name = "A:B", value_parser = ends, allow_hyphen_values = true)]
    pub frequencies: Option<[f64; 2]>,
    /// Print the points of all branches as CSV instead of the events
    #[arg(long)]
    pub csv: bool,
    /// Draw the locus
    #[arg(long, value_name = "FILE.svg|png")]
    pub plot: Option<PathBuf>,
}

#[derive(Args)]
pub struct Modes {
    #[command(flatten)]
    pub common: SceneArguments,
    #[command(flatten)]
    pub point: Point,
    /// Print, draw and write only modes with frequencies from A to B, Hz
    #[arg(long, value_name = "A:B", value_parser = ends, allow_hyphen_values = true)]
    pub frequencies: Option<[f64; 2]>,
    /// Mesh of a superelement, an input file of Abaqus or CalculiX, for --vtk and --plot; may be given for several superelements
    #[arg(long, value_name = "NAME=FILE.inp", value_parser = mesh)]
    pub mesh: Vec<(String, PathBuf)>,
    /// Write the modes that oscillate on the meshes, as a folder of files for ParaView
    #[arg(long, value_name = "DIR", requires = "mesh")]
    pub vtk: Option<PathBuf>,
    /// Draw the mode shapes: all of a ring, where an SVG is animated, or on the meshes up to 12 that oscillate, growing ones first
    #[arg(long, value_name = "FILE.svg|png")]
    pub plot: Option<PathBuf>,
}

#[derive(Args)]
pub struct Sensitivity {
    #[command(flatten)]
    pub common: SceneArguments,
    #[command(flatten)]
    pub point: Point,
    /// Only modes whose frequency lies between A and B, Hz [default: all]
    #[arg(long, value_name = "A:B", value_parser = ends, allow_hyphen_values = true)]
    pub frequencies: Option<[f64; 2]>,
    /// Find the friction coefficients from A to B at which modes begin or cease to grow, and their derivatives too
    #[arg(long, value_name = "A:B", value_parser = ends, allow_hyphen_values = true)]
    pub critical: Option<[f64; 2]>,
    /// Number of parameters that the table and the picture show of each mode, the most effective first
    #[arg(long, value_name = "N", default_value = "8")]
    pub first: NonZeroUsize,
    /// Format of the output; JSON and CSV have all parameters
    #[arg(long, value_enum, default_value = "table")]
    pub format: Format,
    /// Draw the changes of the growth rates of up to 6 modes, the fastest growing first, and of the critical friction
    /// coefficients, as bars
    #[arg(long, value_name = "FILE.svg|png")]
    pub plot: Option<PathBuf>,
}

#[derive(Args)]
pub struct Bistable {
    #[command(flatten)]
    pub common: SceneArguments,
    /// Friction coefficients from A to B
    #[arg(long, value_name = "A:B", value_parser = ends, allow_hyphen_values = true)]
    pub friction: [f64; 2],
    /// Push the scene along the mode of each candidate, and report which candidates a lasting motion visits
    #[arg(long)]
    pub confirm: bool,
}

#[derive(Args)]
pub struct Map {
    #[command(flatten)]
    pub common: SceneArguments,
    /// Parameter along x with its values from A to B, in steps of STEP or as N values
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N", value_parser = named_grid)]
    pub x: (String, Values),
    /// Parameter along y with its values from A to B, in steps of STEP or as N values
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N", value_parser = named_grid)]
    pub y: (String, Values),
    /// Compute only the verdicts that show where verdicts change, and find islands of N by N points wherever they lie;
    /// other points are filled in [default: every point is computed]
    #[arg(long, value_name = "N", value_parser = islands)]
    pub islands: Option<usize>,
    /// Print every point as CSV instead of the number of points with each verdict
    #[arg(long)]
    pub csv: bool,
    /// Draw the map; with --shard, FILE is in the folder of -o
    #[arg(long, value_name = "FILE.svg|png")]
    pub plot: Option<PathBuf>,
    /// With --shard, the folder of all workers, in which `merge` writes results.csv and the picture
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub shared: ShardArguments,
}

#[derive(Args)]
pub struct Matrices {
    /// A file (TOML) that says of which matrices the structure M q̈ + C q̇ + K q = 0 is made, and on which parameter they
    /// depend [default: the matrices of --mass, --damping and --stiffness]
    #[arg(value_name = "FILE.toml", conflicts_with_all = ["mass", "damping", "stiffness", "freedoms"])]
    pub description: Option<PathBuf>,
    /// A file of the mass matrix; NAME chooses one matrix of a file that holds several (brake.mat#M). Matrices of
    /// several --mass are added
    #[arg(long, value_name = "FILE[#NAME]")]
    pub mass: Vec<Location>,
    /// A file of what multiplies velocities: dampers, gyroscopic forces
    #[arg(long, value_name = "FILE[#NAME]")]
    pub damping: Vec<Location>,
    /// A file of what multiplies displacements: springs, friction, circulatory forces
    #[arg(long, value_name = "FILE[#NAME]")]
    pub stiffness: Vec<Location>,
    /// Node and direction of each row of files that do not tell: a CSV file with the columns node,direction
    #[arg(long, value_name = "FILE.csv")]
    pub freedoms: Option<PathBuf>,
    /// Other values of the description's parameter
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N", value_parser = named_steps, allow_hyphen_values = true)]
    pub parameter: Option<(String, Values)>,
    /// Growth rates between which modes are wanted, 1/s
    #[arg(long, value_name = "A:B", value_parser = ends, allow_hyphen_values = true)]
    pub growth: [f64; 2],
    /// Frequencies between which modes are wanted, Hz; from 0 includes modes that do not oscillate
    #[arg(long, value_name = "A:B", value_parser = ends, allow_hyphen_values = true)]
    pub frequency: [f64; 2],
    /// Format of the output
    #[arg(long, value_enum, default_value = "table")]
    pub format: Format,
    /// Draw growth rates and frequencies over the parameter, or growth rates over frequencies
    #[arg(long, value_name = "FILE.svg|png")]
    pub plot: Option<PathBuf>,
}

/// Parses `NAME=FILE.inp`.
fn mesh(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, file)) if !name.is_empty() && !file.is_empty() => {
            Ok((name.to_owned(), file.into()))
        }
        _ => {
            Err("write it as NAME=FILE.inp with the name of a superelement, such as pad=pad.inp"
                .into())
        }
    }
}

fn time(text: &str) -> Result<f64, String> {
    let time = range::number(text)?;
    if time >= 0.0 { Ok(time) } else { Err("must not be negative".into()) }
}
