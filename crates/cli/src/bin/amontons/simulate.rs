//! `amontons simulate`.

use crate::arguments::Simulate;
use crate::study::orbit;
use crate::{scenes, sweep};
use amontons::error::Short;
use amontons::scene::{Experiment, Scene, Source};
use amontons::simulation::catalogue::{Causality, Kind};
use amontons::simulation::{Simulation, Variable, broken_assumptions, variables};
use amontons_analysis::assign::assign;
use amontons_analysis::inputs::{Inputs, is_close};
use amontons_analysis::output::{AtomicFile, check_folder, check_inputs_stay};
use amontons_analysis::patterns;
use amontons_analysis::sweep::range::check_once;
use amontons_cli::interrupt::{self, Interrupted};
use amontons_cli::progress::Progress;
use amontons_export::scene;
use std::error::Error;
use std::io::{BufWriter, ErrorKind, Write, stdout};
use std::ops::ControlFlow::{Break, Continue};
use std::path::Path;

pub fn run(arguments: &Simulate) -> Result<(), Box<dyn Error>> {
    let (mut scene, source, experiment) = configured(arguments)?;
    for output in arguments.output.iter().chain(&arguments.patterns) {
        let files = [Some(Path::new(&arguments.scene)), arguments.input.as_deref()];
        check_inputs_stay(output, &files.into_iter().flatten().collect::<Vec<_>>())?;
    }
    if arguments.patterns.is_some() && arguments.patterns == arguments.output {
        return Err(amontons::Error::argument(
            "--patterns and -o name one file: give each a name of its own",
        )
        .into());
    }
    if let Some((name, values)) = &arguments.sweep {
        return sweep::run(arguments, (scene, &source), experiment, name, &values.0);
    }
    if arguments.shared.is_part() {
        return Err(amontons::Error::argument(
            "--shard needs --sweep: the workers share its values; one run has one worker",
        )
        .into());
    }
    let input = arguments.input.as_ref();
    let inputs = input.map(|path| Inputs::read(path, &scene)).transpose()?;
    if let Some(inputs) = &inputs {
        let is_set = |name: &&str| arguments.set.iter().any(|(set, _)| set == name);
        for name in inputs.names().filter(is_set) {
            eprintln!("note: {name} follows the file of --input, not --set");
        }
        inputs.assign(&mut scene, 0.0)?;
    }
    let mut simulation = scenes::start(&scene)?;
    if let Some(path) = &arguments.patterns {
        check_folder(path)?;
        simulation.record_visits()?;
    }
    if let Some(selected) = simulation.selected() {
        eprintln!("{}: {selected}", scene.name);
        if experiment.stop_time > scene.experiment.stop_time {
            eprintln!(
                "note: this choice is for the scene's stop time, {} s; to choose for {} s, set stop_time in its \
                 [experiment]",
                Short(scene.experiment.stop_time),
                Short(experiment.stop_time)
            );
        }
    }
    let mut run = Run { simulation, inputs };
    let result = write_output(arguments, &mut run, &scene, experiment);
    for warning in broken_assumptions(&run.simulation) {
        eprintln!("warning: {warning}");
    }
    if let (Some(path), Some(log)) = (&arguments.patterns, run.simulation.visits()) {
        patterns::write(path, &scene, log)?;
        if let Some(left_out) = patterns::left_out(log) {
            eprintln!("note: {left_out}");
        }
    }
    result
}

fn write_output(
    arguments: &Simulate,
    run: &mut Run,
    scene: &Scene,
    experiment: Experiment,
) -> Result<(), Box<dyn Error>> {
    match &arguments.output {
        None => write_run(run, scene, experiment, &mut BufWriter::new(stdout().lock())),
        Some(path) => {
            let mut file = AtomicFile::create(path)?;
            interrupt::listen();
            if let Err(error) = write_run(run, scene, experiment, &mut file) {
                let mut rows = "the rows up to the failure";
                if error.is::<Interrupted>() {
                    let [time, stop] = [run.simulation.time(), experiment.stop_time].map(Short);
                    eprintln!("note: interrupted at {time} s of {stop} s");
                    rows = "the rows up to then";
                }
                if let Some(partial) = file.partial() {
                    eprintln!("{rows} are in {}", partial.display());
                }
                return Err(error);
            }
            file.complete()?;
            let statistics = run.simulation.statistics();
            let ended = match statistics.ended_hops {
                0 => String::new(),
                1 => ", 1 hop ended".to_owned(),
                count => format!(", {count} hops ended"),
            };
            eprintln!(
                "{}: {} s in {} steps, {} changes of contact state, {} touch-downs{ended}",
                path.display(),
                Short(run.simulation.time()),
                statistics.steps,
                statistics.state_changes(),
                statistics.touch_downs
            );
            Ok(())
        }
    }
}

/// The scene with the values of the command line, its source, and the experiment to be run. A tolerance applies to the scene's own
/// experiment, as in the FMU, also if the run is shorter.
fn configured(arguments: &Simulate) -> Result<(Scene, Source, Experiment), Box<dyn Error>> {
    let (mut scene, source) = scene::find(&arguments.scene)?;
    check_once(&arguments.set)?;
    for (name, value) in &arguments.set {
        assign(&mut scene, name, *value)?;
    }
    if let Some(path) = &arguments.from {
        orbit::begin(path, &mut scene)?;
    }
    let experiment = Experiment {
        stop_time: arguments.stop_time.unwrap_or(scene.experiment.stop_time),
        output_interval: arguments.output_interval.unwrap_or(scene.experiment.output_interval),
    };
    arguments.integrator.choice().apply(&mut scene)?;
    Scene { experiment, ..scene.clone() }.check()?;
    Ok((scene, source, experiment))
}

/// A simulation and the changes of its inputs.
struct Run {
    simulation: Simulation,
    inputs: Option<Inputs>,
}

impl Run {
    /// Advances to time `target` (s) with inputs held, or only to the next jump of an input before it. Returns the time
    /// reached.
    fn advance_towards(&mut self, target: f64) -> Result<f64, Box<dyn Error>> {
        let Self { simulation, inputs } = self;
        let mut time = target;
        if let Some(inputs) = inputs {
            inputs.write(simulation, simulation.time())?;
            let jump = inputs.next_jump(simulation.time());
            if jump < target && !is_close(jump, target) {
                time = jump;
            }
        }
        match simulation.advance_while(time, interrupt::stopped)? {
            Continue(()) => Ok(time),
            Break(()) => Err(Box::new(Interrupted)),
        }
    }
}

/// Writes one row at the start, one for each interval, one at the end, and one at each jump of an input, as FMPy does.
fn write_run(
    run: &mut Run,
    scene: &Scene,
    experiment: Experiment,
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    let outputs: Vec<Variable> = variables(scene)
        .into_iter()
        .filter(|variable| variable.causality == Causality::Output)
        .collect();
    write!(out, "time")?;
    for variable in &outputs {
        write!(out, ",{}", variable.name)?;
    }
    writeln!(out)?;

    let progress = Progress::in_parts("the run");
    let mut time = run.simulation.time();
    write_row(&mut run.simulation, time, &outputs, out)?;
    for (intervals, (target, _)) in experiment.row_times().enumerate() {
        while time < target {
            if interrupt::stopped().is_break() {
                return Err(Box::new(Interrupted));
            }
            time = run.advance_towards(target)?;
            write_row(&mut run.simulation, time, &outputs, out)?;
        }
        if intervals.is_multiple_of(64) {
            progress.set_part(time / experiment.stop_time);
        }
    }
    progress.finish();
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
            Kind::Integer | Kind::Boolean | Kind::Enumeration { .. } => write!(out, ",{value}")?,
        }
    }
    writeln!(out)?;
    Ok(())
}

pub fn is_broken_pipe(error: &(dyn Error + 'static)) -> bool {
    error.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == ErrorKind::BrokenPipe)
}
