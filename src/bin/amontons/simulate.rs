//! `amontons simulate`.

use crate::arguments::Simulate;
use crate::scenes;
use amontons::output::Pending;
use amontons::scene::{self, Scene};
use amontons::simulation::catalogue::{Causality, Kind};
use amontons::simulation::{Inputs, Simulation, Variable, assign, is_close, variables};
use indicatif::{ProgressBar, ProgressStyle};
use std::error::Error;
use std::io::{BufWriter, ErrorKind, Write, stdout};

pub fn run(arguments: &Simulate) -> Result<(), Box<dyn Error>> {
    let mut scene = configured(arguments)?;
    let input = arguments.input.as_ref();
    let inputs = input.map(|path| Inputs::read(path, &scene)).transpose()?;
    if let Some(inputs) = &inputs {
        inputs.assign(&mut scene, 0.0)?;
    }
    let simulation = scenes::start(&scene)?;
    let mut run = Run { simulation, inputs };
    match &arguments.output {
        None => match write_run(&mut run, &scene, &mut BufWriter::new(stdout().lock())) {
            // Whoever reads has read enough (`| head`).
            Err(error) if is_broken_pipe(&*error) => Ok(()),
            result => result,
        },
        Some(path) => {
            let mut file = Pending::create(path)?;
            if let Err(error) = write_run(&mut run, &scene, &mut file) {
                if let Some(partial) = file.partial() {
                    eprintln!("the rows up to the failure are in {}", partial.display());
                }
                return Err(error);
            }
            file.complete()?;
            let statistics = run.simulation.statistics();
            eprintln!(
                "{}: {} s in {} steps, {} changes of contact state, {} touch-downs",
                path.display(),
                run.simulation.time(),
                statistics.steps,
                statistics.state_changes,
                statistics.touch_downs
            );
            Ok(())
        }
    }
}

/// The scene with the values of the command line.
fn configured(arguments: &Simulate) -> Result<Scene, Box<dyn Error>> {
    let (mut scene, _) = scene::find(&arguments.scene)?;
    for (name, value) in &arguments.set {
        assign(&mut scene, name, *value)?;
    }
    scene.experiment.stop_time = arguments.stop_time.unwrap_or(scene.experiment.stop_time);
    scene.experiment.output_interval =
        arguments.output_interval.unwrap_or(scene.experiment.output_interval);
    scene.step = arguments.step.unwrap_or(scene.step);
    Ok(scene)
}

/// A simulation, and what changes its inputs.
struct Run {
    simulation: Simulation,
    inputs: Option<Inputs>,
}

impl Run {
    /// Moves on to time `target` (s), the inputs held from here, or from where they jump.
    fn advance_to(&mut self, target: f64) -> Result<(), amontons::Error> {
        let Self { simulation, inputs: Some(inputs) } = self else {
            return self.simulation.advance_to(target);
        };
        loop {
            let time = simulation.time();
            inputs.write(simulation, time)?;
            let jump = inputs.next_jump(time);
            if jump >= target || is_close(jump, target) {
                return simulation.advance_to(target);
            }
            simulation.advance_to(jump)?;
        }
    }
}

/// One row at the start, one every interval, one at the end.
fn write_run(run: &mut Run, scene: &Scene, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let outputs: Vec<Variable> = variables(scene)
        .into_iter()
        .filter(|variable| variable.template.causality == Causality::Output)
        .collect();
    write!(out, "time")?;
    for variable in &outputs {
        write!(out, ",{}", variable.name)?;
    }
    writeln!(out)?;

    let stop = scene.experiment.stop_time;
    let interval = scene.experiment.output_interval;
    let progress = progress_bar(stop);
    let mut row = 0_u64;
    loop {
        #[allow(clippy::cast_precision_loss)]
        let planned = row as f64 * interval;
        // The stop time may be a whole number of intervals but for rounding.
        let last = planned >= stop - 1e-9 * interval;
        let time = if last { stop } else { planned };
        // The first row is the start as it is; its inputs have been set.
        if time > run.simulation.time() {
            run.advance_to(time)?;
        }
        write_row(&mut run.simulation, time, &outputs, out)?;
        if last {
            break;
        }
        row += 1;
        if row.is_multiple_of(64) {
            progress.set_position(ticks(time));
        }
    }
    progress.finish_and_clear();
    out.flush()?;
    Ok(())
}

fn write_row(
    simulation: &mut Simulation,
    time: f64,
    outputs: &[Variable],
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    write!(out, "{time:?}")?;
    for variable in outputs {
        let value = simulation.read(variable)?;
        match variable.template.kind {
            // The shortest decimal that reads back as the same double.
            Kind::Real { .. } => write!(out, ",{value:?}")?,
            Kind::Integer | Kind::Enumeration { .. } => write!(out, ",{value}")?,
        }
    }
    writeln!(out)?;
    Ok(())
}

/// Simulated milliseconds on standard error, shown only to a person and only on longer runs.
fn progress_bar(stop: f64) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left")
        .expect("the template is fixed");
    ProgressBar::new(ticks(stop)).with_style(style)
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn ticks(time: f64) -> u64 {
    (1e3 * time).ceil() as u64
}

fn is_broken_pipe(error: &(dyn Error + 'static)) -> bool {
    error.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == ErrorKind::BrokenPipe)
}
