//! Import of FMUs by the crate fmi-rs: one FMU alone by its `simulate`, and two coupled by a loop of the example's own.
//!
//! ```text
//! cargo run --release -- set1.fmu --drive drive.fmu
//! ```

use clap::Parser;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi2::{CS, FMU2};
use fmi_rs::model_description::fmi2::{Causality, ScalarVariable, VariableType};
use fmi_rs::sim::fmi2::cs::simulate;
use fmi_rs::sim::fmi2::recorder::Recorder;
use fmi_rs::sim::fmi2::{SimulationSettings, Trajectories, VariableValue};
use shared::{Fmu, Run};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

mod shared;

/// The output of the drive and the input of the scene to which it is connected, and the connection in the other
/// direction.
const VELOCITY: [&str; 2] = ["contact.guide.slip_velocity", "slider.velocity"];
const REACTION: [&str; 2] = ["slider.tangential_reaction", "mass.table.fx"];

/// Simulates an FMU alone, or coupled to a drive.
#[derive(Parser)]
struct Arguments {
    /// The FMU, set1.fmu
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
    /// Start value of a variable of the scene; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = start_value)]
    set: Vec<(String, f64)>,
    /// CSV file of the same run without an importer
    #[arg(long)]
    compare: Option<PathBuf>,
}

fn start_value(text: &str) -> Result<(String, f64), String> {
    let number = text.split_once('=').and_then(|(name, value)| Some((name, value.parse().ok()?)));
    let (name, value) = number.ok_or("write it as NAME=VALUE, with a number")?;
    Ok((name.to_owned(), value))
}

fn alone(arguments: &Arguments, scene: Fmu) -> Result<Run, Box<dyn Error>> {
    let (description, file) = (Arc::new(scene.builder.model_description), scene.file);
    let variables = description.modelVariables.iter().enumerate();
    let outputs = variables.filter(|(_, variable)| variable.causality == Causality::Output);
    let (indices, names): (Vec<usize>, Vec<String>) =
        outputs.map(|(index, variable)| (index, variable.name.clone())).unzip();
    let values = arguments.set.iter().map(|(name, value)| (name.clone(), format!("{value:?}")));
    let settings = SimulationSettings {
        unzipdir: scene.builder.unzipdir.path().to_owned(),
        model_description: description.clone(),
        start_time: 0.0,
        stop_time: arguments.stop_time,
        logging_on: false,
        set_stop_time: true,
        output_interval: arguments.interval,
        log_time_scale: false,
        tolerance: 1e-9,
        set_tolerance: false,
        start_values: values.collect(),
        log_fmi_calls: false,
        input_file: None,
        early_return_allowed: false,
        event_mode_used: false,
        log_file: None,
        initial_fmu_state_file: None,
        final_fmu_state_file: None,
    };
    // fmi-rs requires an Arc of a type that cannot be shared between threads.
    #[allow(clippy::arc_with_non_send_sync)]
    let recorder = Arc::new(Recorder::new(Trajectories::new(description, indices)));
    // fmi-rs prints the messages of the FMU.
    simulate(&settings, None, recorder.clone())
        .map_err(|error| format!("{}: {error}", file.display()))?;
    let recorded = Arc::into_inner(recorder).ok_or("fmi-rs kept its recorder")?.into_trajectories();
    let value = |value: &_| -> Result<f64, _> {
        VariableValue::to_f64(value).ok_or("an output is no number")
    };
    let rows = recorded.rows.iter().map(|row| row.iter().map(value).collect());
    Ok(Run { times: recorded.time, names, rows: rows.collect::<Result<_, _>>()? })
}

/// An instance whose variables are accessed by name.
struct Part {
    // Fields are dropped in this order: the instance before the folder with its library.
    instance: Arc<FMU2<CS>>,
    fmu: Fmu,
}

impl Part {
    fn new(fmu: Fmu, name: &str) -> Result<Self, Box<dyn Error>> {
        let instance = fmu.builder.instantiate_cs(name);
        let instance = instance.map_err(|error| format!("{}: {error}", fmu.file.display()))?;
        Ok(Self { instance, fmu })
    }

    /// Converts the status of an FMI function into a result; fmi-rs prints the messages of the FMU.
    fn call(&self, function: &str, status: fmi2Status) -> Result<(), String> {
        match status {
            fmi2Status::Ok | fmi2Status::Warning => Ok(()),
            _ => Err(format!("{}: {function} failed", self.fmu.file.display())),
        }
    }

    fn reference(&self, name: &str) -> Result<u32, Box<dyn Error>> {
        let description = &self.fmu.builder.model_description;
        let index = description.variable_index_by_name(name)?;
        Ok(description.modelVariables[index].valueReference)
    }

    fn set(&self, name: &str, value: f64) -> Result<(), Box<dyn Error>> {
        let reference = [self.reference(name)?];
        Ok(self.call("fmi2SetReal", self.instance.setReal(&reference, &[value]))?)
    }

    fn get(&self, name: &str) -> Result<f64, Box<dyn Error>> {
        let (reference, mut value) = ([self.reference(name)?], [0.0]);
        self.call("fmi2GetReal", self.instance.getReal(&reference, &mut value))?;
        Ok(value[0])
    }

    /// The present values of all outputs.
    fn values(&self) -> Result<Vec<f64>, Box<dyn Error>> {
        let value = |variable: &ScalarVariable| {
            if matches!(variable.variableType, VariableType::Real { .. }) {
                return self.get(&variable.name);
            }
            let (reference, mut whole) = ([variable.valueReference], [0]);
            self.call("fmi2GetInteger", self.instance.getInteger(&reference, &mut whole))?;
            Ok(f64::from(whole[0]))
        };
        self.fmu.outputs().map(value).collect()
    }
}

/// Sets the inputs of both parts to the other's outputs.
fn exchange(scene: &Part, drive: &Part) -> Result<(), Box<dyn Error>> {
    let (velocity, reaction) = (drive.get(VELOCITY[0])?, scene.get(REACTION[0])?);
    scene.set(VELOCITY[1], velocity)?;
    drive.set(REACTION[1], reaction)
}

/// Advances both parts at the same time, each with the other's output at the beginning of the step.
#[allow(clippy::cast_precision_loss)]
fn coupled(
    arguments: &Arguments,
    steps: u64,
    scene: Fmu,
    drive: Fmu,
) -> Result<Run, Box<dyn Error>> {
    let (scene, drive) = (Part::new(scene, "scene")?, Part::new(drive, "drive")?);
    let parts = [&scene, &drive];
    for (name, value) in &arguments.set {
        scene.set(name, *value)?;
    }
    for part in parts {
        let fmu = &part.instance;
        part.call("fmi2SetupExperiment", fmu.setupExperiment(None, 0.0, None))?;
        part.call("fmi2EnterInitializationMode", fmu.enterInitializationMode())?;
    }
    // An output of one part at the start can change the output of the other.
    for _ in parts {
        exchange(&scene, &drive)?;
    }
    for part in parts {
        part.call("fmi2ExitInitializationMode", part.instance.exitInitializationMode())?;
    }
    let names = [("scene", &scene), ("drive", &drive)].into_iter().flat_map(|(prefix, part)| {
        part.fmu.outputs().map(move |output| format!("{prefix}.{}", output.name))
    });
    let mut run = Run { names: names.collect(), ..Run::default() };
    let interval = arguments.interval;
    for step in 0..=steps {
        let time = step as f64 * interval;
        run.times.push(time);
        run.rows.push([scene.values()?, drive.values()?].concat());
        if step < steps {
            exchange(&scene, &drive)?;
            for part in parts {
                let size = (step + 1) as f64 * interval - time;
                part.call("fmi2DoStep", part.instance.doStep(time, size, 1))?;
            }
        }
    }
    for part in parts {
        part.call("fmi2Terminate", part.instance.terminate())?;
    }
    Ok(run)
}

/// Number of intervals in the run.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn steps(&Arguments { stop_time, interval, .. }: &Arguments) -> Result<u64, String> {
    if !(interval > 0.0 && interval <= stop_time && stop_time.is_finite()) {
        return Err("--interval must be above 0, and --stop-time at least as long".into());
    }
    let steps = (stop_time / interval).round();
    if (steps * interval - stop_time).abs() > 1e-9 * stop_time {
        return Err(format!(
            "--stop-time {stop_time} is not a whole multiple of --interval {interval}"
        ));
    }
    Ok(steps as u64)
}

/// Makes the run that the command line describes. Returns `false` if a value differs from the run for comparison.
fn run(arguments: &Arguments) -> Result<bool, Box<dyn Error>> {
    let steps = steps(arguments)?;
    let scene = Fmu::open(&arguments.scene)?;
    for (name, _) in &arguments.set {
        scene.must_have(name, &[Causality::Parameter, Causality::Input])?;
    }
    let expected = arguments.compare.as_deref().map(Run::read).transpose()?;
    let (run, partner) = match &arguments.drive {
        None => (alone(arguments, scene)?, String::new()),
        Some(file) => {
            let drive = Fmu::open(file)?;
            for (fmu, output, into) in
                [(&scene, REACTION[0], VELOCITY[1]), (&drive, VELOCITY[0], REACTION[1])]
            {
                let hint = "a coupling needs the FMU of a scene with a slider first, and --drive drive.fmu";
                fmu.must_have(output, &[Causality::Output])
                    .and_then(|()| fmu.must_have(into, &[Causality::Input]))
                    .map_err(|error| format!("{error}; {hint}"))?;
            }
            (coupled(arguments, steps, scene, drive)?, format!(", coupled to {}", file.display()))
        }
    };
    println!("{} through fmi-rs 0.3{partner}", arguments.scene.display());
    let scene = if partner.is_empty() { "" } else { "scene." };
    run.show(scene, &format!("drive.{}", VELOCITY[0]), REACTION[0]);
    let (Some(expected), Some(file)) = (expected, &arguments.compare) else { return Ok(true) };
    let values = run.times.len() * run.names.len();
    let found = run.differences(&expected);
    let verdict = if found.is_empty() { format!("yes, all {values} values") } else { "NO".into() };
    println!("  equal to {} to the last bit: {verdict}", file.display());
    for line in found.iter().take(10) {
        println!("    {line}");
    }
    if found.len() > 10 {
        println!("    and {} more", found.len() - 10);
    }
    if !found.is_empty() {
        println!("  check that both runs used the same FMUs, --set, --stop-time and --interval");
    }
    Ok(found.is_empty())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
