//! One run of a scene as arrays.

use crate::array::reals;
use crate::errors::raised;
use crate::scene::Scene;
use amontons::Error;
use amontons::scene::{Experiment, did_you_mean};
use amontons::simulation::catalogue::{Causality, Kind};
use amontons::simulation::{Simulation, Variable, broken_assumptions, variables};
use pyo3::prelude::*;
use std::ops::ControlFlow;

/// Rows between two looks at Ctrl-C.
const ROWS_AT_ONCE: usize = 256;

/// Times (s), and for each output its name, its values and `true` if these are whole numbers; warnings of assumptions
/// that the run has broken.
type Rows<'py> = (Bound<'py, PyAny>, Vec<(String, Bound<'py, PyAny>, bool)>, Vec<String>);

/// Runs a scene to its stop time.
#[pyfunction]
#[pyo3(signature = (scene, stop_time=None, output_interval=None, outputs=None, progress=None))]
#[allow(clippy::needless_pass_by_value)]
pub fn run<'py>(
    py: Python<'py>,
    scene: &Scene,
    stop_time: Option<f64>,
    output_interval: Option<f64>,
    outputs: Option<Vec<String>>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Rows<'py>> {
    let experiment = Experiment {
        stop_time: stop_time.unwrap_or(scene.scene.experiment.stop_time),
        output_interval: output_interval.unwrap_or(scene.scene.experiment.output_interval),
    };
    let checked = amontons::scene::Scene { experiment, ..scene.scene.clone() };
    checked.check().map_err(raised)?;
    let outputs = outputs_of(&scene.scene, outputs.as_deref()).map_err(raised)?;
    let progress = progress.map(Bound::unbind);
    let heard = |part: f64| {
        Python::attach(|py| {
            py.check_signals()?;
            progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (part,)).map(|_| ()))
        })
    };
    let (times, columns, warnings) =
        py.detach(|| rows(&scene.scene, experiment, &outputs, &heard))?;
    let columns = outputs.iter().zip(columns).map(|(output, column)| {
        let is_whole = !matches!(output.template.kind, Kind::Real { .. });
        Ok((output.name.clone(), reals(py, column.into_iter())?, is_whole))
    });
    Ok((reals(py, times.into_iter())?, columns.collect::<PyResult<_>>()?, warnings))
}

/// The variables of these names, or all outputs.
fn outputs_of(
    scene: &amontons::scene::Scene,
    names: Option<&[String]>,
) -> Result<Vec<Variable>, Error> {
    let known = variables(scene);
    let Some(names) = names else {
        let is_output = |variable: &Variable| variable.causality == Causality::Output;
        return Ok(known.into_iter().filter(is_output).collect());
    };
    let named = |name: &String| {
        let found = known.iter().find(|variable| variable.name == *name).cloned();
        found.ok_or_else(|| no_variable(name, known.iter().map(|variable| &*variable.name)))
    };
    names.iter().map(named).collect()
}

/// The error of a name that no variable has, with the nearest one.
pub fn no_variable<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Error {
    let help = did_you_mean(name, known);
    let help = help.unwrap_or_else(|| "`scene.variables` lists all names".to_owned());
    Error::argument(format!("there is no variable {name}; {help}"))
}

/// Times, a column for each output, and warnings.
type Table = (Vec<f64>, Vec<Vec<f64>>, Vec<String>);

fn rows(
    scene: &amontons::scene::Scene,
    experiment: Experiment,
    outputs: &[Variable],
    heard: &dyn Fn(f64) -> PyResult<()>,
) -> PyResult<Table> {
    let mut simulation = Simulation::new(scene.clone(), 0.0).map_err(raised)?;
    let (mut times, mut columns) = (Vec::new(), vec![Vec::new(); outputs.len()]);
    let mut note = |simulation: &mut Simulation, time: f64| -> Result<(), Error> {
        times.push(time);
        for (column, output) in columns.iter_mut().zip(outputs) {
            column.push(simulation.read(output)?);
        }
        Ok(())
    };
    note(&mut simulation, 0.0).map_err(raised)?;
    for (row, (time, _)) in experiment.row_times().enumerate() {
        if row.is_multiple_of(ROWS_AT_ONCE) {
            heard(simulation.time() / experiment.stop_time)?;
        }
        let mut ended = None;
        let go_on = || match heard(time / experiment.stop_time) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                ended = Some(error);
                ControlFlow::Break(())
            }
        };
        let _ = simulation.advance_while(time, go_on).map_err(raised)?;
        if let Some(error) = ended {
            return Err(error);
        }
        note(&mut simulation, time).map_err(raised)?;
    }
    heard(1.0)?;
    Ok((times, columns, broken_assumptions(&simulation)))
}
