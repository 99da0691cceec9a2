//! The crate fmi-rs: an FMU alone by its `simulate`, and two that are coupled by a loop of one's own.
//!
//! ```text
//! cargo run --release --example fmi_rs -- set1.fmu --drive drive.fmu
//! ```

use clap::Parser;
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi2::{CS, FMU2};
use fmi_rs::model_description::fmi2::{Causality, ModelDescription, VariableType};
use fmi_rs::sim::fmi2::cs::simulate;
use fmi_rs::sim::fmi2::recorder::Recorder;
use fmi_rs::sim::fmi2::{SimulationSettings, Trajectories};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The output of the drive and the input of the scene that it goes into, and the way back.
const VELOCITY: [&str; 2] = ["contact.guide.slip_velocity", "slider.velocity"];
const REACTION: [&str; 2] = ["slider.tangential_reaction", "mass.table.fx"];

/// Simulates an FMU alone, or coupled to a drive.
#[derive(Parser)]
pub struct Arguments {
    /// An FMU with contacts on a slider, set1.fmu
    scene: PathBuf,
    /// An FMU that moves the slider and takes the reaction, drive.fmu
    #[arg(long)]
    drive: Option<PathBuf>,
    /// End of the run, s
    #[arg(long, default_value_t = 0.1)]
    stop_time: f64,
    /// Time between communication points, s
    #[arg(long, default_value_t = 1e-4)]
    interval: f64,
    /// A start value of the scene; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = start_value)]
    set: Vec<(String, String)>,
    /// The same run without an importer, a CSV file
    #[arg(long)]
    compare: Option<PathBuf>,
}

fn start_value(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("must be NAME=VALUE")?;
    Ok((name.to_owned(), value.to_owned()))
}

/// Values over time, one column a name.
#[derive(Default)]
struct Run {
    /// Times of the rows, s.
    times: Vec<f64>,
    /// Values of all rows.
    columns: BTreeMap<String, Vec<f64>>,
}

fn alone(arguments: &Arguments) -> Result<Run, Box<dyn Error>> {
    let FMU2Builder { unzipdir, model_description, .. } = FMU2Builder::new(&arguments.scene)?;
    let description = Arc::new(model_description);
    let variables = description.modelVariables.iter().enumerate();
    let outputs = variables.filter(|(_, variable)| variable.causality == Causality::Output);
    let (indices, names): (Vec<usize>, Vec<String>) =
        outputs.map(|(index, variable)| (index, variable.name.clone())).unzip();
    let settings = SimulationSettings {
        unzipdir: unzipdir.path().to_owned(),
        model_description: description.clone(),
        start_time: 0.0,
        stop_time: arguments.stop_time,
        logging_on: false,
        set_stop_time: true,
        output_interval: arguments.interval,
        log_time_scale: false,
        tolerance: 1e-9,
        set_tolerance: false,
        start_values: arguments.set.clone(),
        log_fmi_calls: false,
        input_file: None,
        early_return_allowed: false,
        event_mode_used: false,
        log_file: None,
        initial_fmu_state_file: None,
        final_fmu_state_file: None,
    };
    // fmi-rs asks for an Arc of what cannot be shared.
    #[allow(clippy::arc_with_non_send_sync)]
    let recorder = Arc::new(Recorder::new(Trajectories::new(description, indices)));
    simulate(&settings, None, recorder.clone())?;
    let recorded = Arc::into_inner(recorder).ok_or("fmi-rs kept its recorder")?.into_trajectories();
    let mut run = Run { times: recorded.time, columns: BTreeMap::new() };
    for row in &recorded.rows {
        for (name, value) in names.iter().zip(row) {
            let value = value.to_f64().ok_or("an output is no number")?;
            run.columns.entry(name.clone()).or_default().push(value);
        }
    }
    Ok(run)
}

/// What FMI answers, as Rust says it.
fn call(status: fmi2Status) -> Result<(), Box<dyn Error>> {
    if status == fmi2Status::Ok {
        Ok(())
    } else {
        Err(format!("a call ended with {status:?}").into())
    }
}

/// An instance whose variables are known by name.
struct Part {
    prefix: &'static str,
    // Before the folder that its library is in: fields are dropped in this order.
    instance: Arc<FMU2<CS>>,
    builder: FMU2Builder,
}

impl Part {
    fn new(file: &Path, prefix: &'static str) -> Result<Self, Box<dyn Error>> {
        let builder = FMU2Builder::new(&file)?;
        let instance = builder.instantiate_cs(prefix)?;
        Ok(Self { prefix, instance, builder })
    }

    fn description(&self) -> &ModelDescription {
        &self.builder.model_description
    }

    fn reference(&self, name: &str) -> Result<u32, Box<dyn Error>> {
        let index = self.description().variable_index_by_name(name)?;
        Ok(self.description().modelVariables[index].valueReference)
    }

    fn set(&self, name: &str, value: f64) -> Result<(), Box<dyn Error>> {
        call(self.instance.setReal(&[self.reference(name)?], &[value]))
    }

    fn get(&self, name: &str) -> Result<f64, Box<dyn Error>> {
        let mut value = [0.0];
        call(self.instance.getReal(&[self.reference(name)?], &mut value))?;
        Ok(value[0])
    }

    /// Adds the present values of all outputs to the columns of a run.
    fn record(&self, run: &mut Run) -> Result<(), Box<dyn Error>> {
        let variables = self.description().modelVariables.iter();
        for variable in variables.filter(|variable| variable.causality == Causality::Output) {
            let (reference, mut whole) = ([variable.valueReference], [0]);
            let value = if matches!(variable.variableType, VariableType::Real { .. }) {
                self.get(&variable.name)?
            } else {
                call(self.instance.getInteger(&reference, &mut whole))?;
                f64::from(whole[0])
            };
            let name = format!("{}.{}", self.prefix, variable.name);
            run.columns.entry(name).or_default().push(value);
        }
        Ok(())
    }
}

/// Gives both the outputs of the other.
fn exchange(scene: &Part, drive: &Part) -> Result<(), Box<dyn Error>> {
    let (velocity, reaction) = (drive.get(VELOCITY[0])?, scene.get(REACTION[0])?);
    scene.set(VELOCITY[1], velocity)?;
    drive.set(REACTION[1], reaction)
}

/// Both go on at once, with each other's outputs of the step's beginning.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn coupled(arguments: &Arguments, drive: &Path) -> Result<Run, Box<dyn Error>> {
    let scene = Part::new(&arguments.scene, "scene")?;
    let drive = Part::new(drive, "drive")?;
    let parts = [&scene, &drive];
    for (name, value) in &arguments.set {
        scene.set(name, value.parse()?)?;
    }
    for part in parts {
        call(part.instance.setupExperiment(None, 0.0, None))?;
        call(part.instance.enterInitializationMode())?;
    }
    // What one gives the other at the start can change what that one gives.
    for _ in parts {
        exchange(&scene, &drive)?;
    }
    for part in parts {
        call(part.instance.exitInitializationMode())?;
    }
    let (mut run, interval) = (Run::default(), arguments.interval);
    let steps = (arguments.stop_time / interval).round() as u64;
    for step in 0..=steps {
        let time = step as f64 * interval;
        run.times.push(time);
        for part in parts {
            part.record(&mut run)?;
        }
        if step < steps {
            exchange(&scene, &drive)?;
            for part in parts {
                let size = (step + 1) as f64 * interval - time;
                call(part.instance.doStep(time, size, 1))?;
            }
        }
    }
    for part in parts {
        call(part.instance.terminate())?;
    }
    Ok(run)
}

/// Prints what a run shows.
fn show(arguments: &Arguments, run: &Run) {
    let range = |what: &str, unit: &str, suffix: &str| {
        let is_meant =
            |name: &str| name.ends_with(suffix) && !name.starts_with("drive.contact.guide.n");
        let columns = run.columns.iter().filter(|(name, _)| is_meant(name));
        let (low, high) = columns
            .flat_map(|(_, values)| values)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
                (value.min(low), value.max(high))
            });
        println!("  {what:18} {low:.6} to {high:.6} {unit}");
    };
    println!("{} through fmi-rs", arguments.scene.display());
    println!("  rows               {}", run.times.len());
    if arguments.drive.is_some() {
        range("slider velocity", "m/s", VELOCITY[0]);
    }
    range("reaction on slider", "N", REACTION[0]);
    range("normal forces", "N", ".normal_force");
    for (name, changes) in run.columns.iter().filter(|(name, _)| name.ends_with(".state_changes")) {
        println!("  {name}: {}", changes[changes.len() - 1]);
    }
}

/// What keeps a run from being equal to that of a CSV file to the last bit, a line each; empty where nothing does.
fn differences(run: &Run, file: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let mut reader = csv::Reader::from_path(file)?;
    let names: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    let mut found = Vec::new();
    if names.len() != run.columns.len() + 1 {
        found.push(format!("{} columns in place of {}", run.columns.len() + 1, names.len()));
    }
    let mut rows = 0;
    for (row, record) in reader.records().enumerate() {
        for (name, expected) in names.iter().zip(record?.iter()) {
            let expected: f64 = expected.parse()?;
            let column = if name == "time" { Some(&run.times) } else { run.columns.get(name) };
            let value = column.and_then(|column| column.get(row)).copied();
            let is_equal = value.is_some_and(|value| value.to_bits() == expected.to_bits());
            if !(is_equal && expected.is_finite()) {
                found.push(format!("row {row}: {name} is {value:?} in place of {expected:?}"));
            }
        }
        rows = row + 1;
    }
    if rows < 2 || rows != run.times.len() {
        found.push(format!("{} rows in place of {rows}", run.times.len()));
    }
    Ok(found)
}

/// Runs what the command line asks for. How many values are equal to those of the run that it is compared with; `None`
/// where one is not.
pub fn run(arguments: &Arguments) -> Result<Option<usize>, Box<dyn Error>> {
    let run = match &arguments.drive {
        Some(drive) => coupled(arguments, drive)?,
        None => alone(arguments)?,
    };
    show(arguments, &run);
    let values = run.times.len() * run.columns.len();
    let Some(file) = &arguments.compare else { return Ok(Some(values)) };
    let found = differences(&run, file)?;
    let verdict = if found.is_empty() { format!("yes, all {values} values") } else { "NO".into() };
    println!("  equal to {} to the last bit: {verdict}", file.display());
    for line in found.iter().take(10) {
        println!("    {line}");
    }
    Ok(found.is_empty().then_some(values))
}

#[allow(dead_code, reason = "tests call `run` itself")]
fn main() -> Result<(), Box<dyn Error>> {
    std::process::exit(i32::from(run(&Arguments::parse())?.is_none()))
}
