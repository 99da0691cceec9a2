//! Two coupled scenes: each runs for a communication step, then they exchange values.
//!
//! A *drive* gives the velocity of the slider of another scene and takes the reaction of that scene's contacts:
//!
//! ```text
//! cargo run --release --example coupled -- set1 drive -o coupled.csv
//! ```
//!
//! A co-simulation tool that couples the two FMUs computes the same doubles. The example shows how to couple a
//! simulation with other code: set inputs, advance, read outputs.

use amontons::scene::{Experiment, Scene};
use amontons::simulation::catalogue::{Causality, Kind};
use amontons::simulation::{Simulation, Variable, variables};
use amontons_analysis::assign::assign;
use amontons_analysis::output::AtomicFile;
use amontons_export::scene::find;
use clap::Parser;
use std::error::Error;
use std::io::{BufWriter, Write, stdout};
use std::path::PathBuf;

/// The output of the drive, and the input of the scene to which it is connected.
pub const VELOCITY: [&str; 2] = ["contact.guide.slip_velocity", "slider.velocity"];
/// The output of the scene, and the input of the drive to which it is connected.
pub const REACTION: [&str; 2] = ["slider.tangential_reaction", "mass.table.fx"];

/// Couples a scene to a drive, which gives the slider's velocity and takes the reaction.
#[derive(Parser)]
pub struct Arguments {
    /// Scene file, or name of a built-in scene, with contacts on a slider
    scene: String,
    /// Scene file, or name of a built-in scene, of the drive
    drive: String,
    /// End of the run, s
    #[arg(long, default_value_t = 0.1)]
    stop_time: f64,
    /// Communication step, s
    #[arg(long, default_value_t = 1e-4)]
    interval: f64,
    /// Start value of a variable of the scene; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = start_value)]
    set: Vec<(String, f64)>,
    /// Exchange rates of change too: held values lose the inertia of masses that stick
    #[arg(long)]
    rates: bool,
    /// Instant at which outputs are read
    #[arg(long, value_enum, default_value_t = Rows::Before)]
    rows: Rows,
    /// Path of the CSV file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Outputs that follow inputs at once, as the slip velocity of a contact follows the slider's, are not the same before
/// and after the inputs of the next step are given. Importers differ in which they show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Rows {
    /// With the inputs of the step that has ended.
    Before,
    /// With the inputs of the step that begins.
    After,
}

fn start_value(text: &str) -> Result<(String, f64), String> {
    let number = text.split_once('=').and_then(|(name, value)| Some((name, value.parse().ok()?)));
    let (name, value) = number.ok_or("write it as NAME=VALUE, with a number")?;
    Ok((name.to_owned(), value))
}

/// A simulation with one coupled input and one coupled output.
struct Part {
    simulation: Simulation,
    input: Variable,
    output: Variable,
}

impl Part {
    fn new(scene: Scene, [output, input]: [&str; 2]) -> Result<Self, Box<dyn Error>> {
        let named = |name: &str| {
            let found = variables(&scene).into_iter().find(|variable| variable.name == name);
            found.ok_or_else(|| format!("{} has no variable {name}", scene.name))
        };
        let (input, output) = (named(input)?, named(output)?);
        Ok(Self { simulation: Simulation::new(scene, 0.0)?, input, output })
    }

    fn give(&mut self, value: f64) -> Result<(), amontons::Error> {
        self.simulation.write(&self.input, value)
    }

    fn read(&mut self) -> Result<f64, amontons::Error> {
        self.simulation.read(&self.output)
    }

    /// Sets the rate at which the input changes over the next step, per second.
    fn give_rate(&mut self, rate: f64) -> Result<(), amontons::Error> {
        self.simulation.set_rate(&self.input, rate)
    }

    /// The present rate of change of the output, per second.
    fn rate(&mut self) -> Result<f64, amontons::Error> {
        Ok(self.simulation.rates(&[&self.output])?[0])
    }
}

/// A scene and its drive, coupled.
pub struct Coupled {
    scene: Part,
    drive: Part,
}

impl Coupled {
    /// Both simulations at 0 s in their initial positions, which are computed with each other's outputs.
    pub fn new(mut scene: Scene, mut drive: Scene) -> Result<Self, Box<dyn Error>> {
        let parts = |scene: &Scene, drive: &Scene| -> Result<_, Box<dyn Error>> {
            Ok(Self {
                scene: Part::new(scene.clone(), [REACTION[0], VELOCITY[1]])?,
                drive: Part::new(drive.clone(), [VELOCITY[0], REACTION[1]])?,
            })
        };
        let mut coupled = parts(&scene, &drive)?;
        // An output of one part at the start can change the output of the other: two exchanges, one for each part, as
        // importers do.
        for _ in 0..2 {
            assign(&mut scene, VELOCITY[1], coupled.drive.read()?)?;
            assign(&mut drive, REACTION[1], coupled.scene.read()?)?;
            coupled = parts(&scene, &drive)?;
        }
        Ok(coupled)
    }

    /// Sets the inputs of both parts to the other's outputs for the next step; they are held or, with `rates`,
    /// extrapolated by their rates of change. Both parts then advance from the same time (the parallel or Jacobi
    /// scheme).
    pub fn exchange(&mut self, rates: bool) -> Result<(), amontons::Error> {
        let Self { scene, drive } = self;
        let (velocity, reaction) = (drive.read()?, scene.read()?);
        scene.give(velocity)?;
        drive.give(reaction)?;
        if rates {
            scene.give_rate(drive.rate()?)?;
            drive.give_rate(scene.rate()?)?;
        }
        Ok(())
    }

    /// Makes one communication step to time `target` (s).
    pub fn advance_to(&mut self, target: f64) -> Result<(), amontons::Error> {
        self.scene.simulation.advance_to(target)?;
        self.drive.simulation.advance_to(target)
    }

    /// The present values of all outputs of both, in the order of [`Self::names`].
    pub fn values(&mut self) -> Result<Vec<f64>, amontons::Error> {
        let mut values = Vec::new();
        for part in [&mut self.scene, &mut self.drive] {
            for output in outputs(part.simulation.scene()) {
                values.push(part.simulation.read(&output)?);
            }
        }
        Ok(values)
    }

    /// Names of all outputs, with the prefix `scene.` or `drive.`; `true` for those that are whole numbers.
    pub fn names(&self) -> Vec<(String, bool)> {
        let parts = [("scene", &self.scene), ("drive", &self.drive)];
        let named = parts.into_iter().flat_map(|(prefix, part)| {
            outputs(part.simulation.scene()).into_iter().map(move |output| {
                let is_whole = !matches!(output.template.kind, Kind::Real { .. });
                (format!("{prefix}.{}", output.name), is_whole)
            })
        });
        named.collect()
    }
}

fn outputs(scene: &Scene) -> Vec<Variable> {
    let is_output = |variable: &Variable| variable.causality == Causality::Output;
    variables(scene).into_iter().filter(is_output).collect()
}

/// Makes the run that the command line describes.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let (mut scene, _) = find(&arguments.scene)?;
    for (name, value) in &arguments.set {
        assign(&mut scene, name, *value)?;
    }
    let experiment =
        Experiment { stop_time: arguments.stop_time, output_interval: arguments.interval };
    Scene { experiment, ..scene.clone() }.check()?;
    let (drive, _) = find(&arguments.drive)?;
    let mut coupled = Coupled::new(scene, drive)?;
    let times = std::iter::once(0.0).chain(experiment.row_times().map(|(time, _)| time));
    match &arguments.output {
        None => write_run(arguments, &mut coupled, times, &mut BufWriter::new(stdout().lock())),
        Some(path) => {
            let mut file = AtomicFile::create(path)?;
            write_run(arguments, &mut coupled, times, &mut file)?;
            Ok(file.complete()?)
        }
    }
}

/// Steps to all times (s) and writes a row for each.
fn write_run(
    arguments: &Arguments,
    coupled: &mut Coupled,
    times: impl Iterator<Item = f64>,
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    let names = coupled.names();
    write!(out, "time")?;
    for (name, _) in &names {
        write!(out, ",{name}")?;
    }
    writeln!(out)?;
    for time in times {
        coupled.advance_to(time)?;
        let before = coupled.values()?;
        coupled.exchange(arguments.rates)?;
        let row = if arguments.rows == Rows::Before { before } else { coupled.values()? };
        write!(out, "{time:?}")?;
        for (value, (_, is_whole)) in row.into_iter().zip(&names) {
            // The shortest decimals that read back as the same doubles.
            if *is_whole { write!(out, ",{value}")? } else { write!(out, ",{value:?}")? }
        }
        writeln!(out)?;
    }
    Ok(out.flush()?)
}

#[allow(dead_code, reason = "tests call `run` itself")]
fn main() {
    if let Err(error) = run(&Arguments::parse()) {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}
