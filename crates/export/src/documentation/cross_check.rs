//! A reference run as the FMI project's cross-check of tools exchanges it (FMI Cross-Check Rules 4.1, section 9.1.4
//! and appendix B): a CSV of outputs, the options that lead to it, and a CSV of inputs.

use amontons::Error;
use amontons::decimal::one_two_five;
use amontons::scene::{Experiment, Scene, Selection};
use amontons::simulation::catalogue::{Causality, Kind};
use amontons::simulation::{Parameters, Simulation, Variable, variables};
use amontons_analysis::record::record_rows;
use amontons_analysis::watch::Watch;
use std::fmt::Write as _;

/// The largest CSV that the rules allow, bytes.
const MOST_BYTES: usize = 1_000_000;
/// The most characters of a number, its comma included: a sign, 17 digits, a point, an exponent of five.
const NUMBER: usize = 25;
/// The least number of rows, enough to show a course; below it outputs are left out instead.
const FEWEST_ROWS: usize = 101;
/// Tolerance for tools without another wish: that of the rules.
const TOLERANCE: f64 = 1e-4;

/// The files, beside an FMU of the same name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CrossCheck {
    /// `_ref.csv`: time and outputs, each the shortest decimal that reads back as its double.
    pub reference: String,
    /// `_ref.opt`: what an importer is to be told.
    pub options: String,
    /// `_in.csv`: inputs, held at their start values; `None` where the scene has none.
    pub inputs: Option<String>,
    /// Number of outputs that were left out for the size that the rules allow.
    pub left_out: usize,
}

/// Runs the scene's experiment with inputs held at their start values. Rows are one, two, five, ten … output
/// intervals apart, so that the file keeps to the size that the rules allow. Returns `None` if `watch`, to which the
/// completed part is reported, has ended it.
///
/// # Errors
/// Returns an error if a start is impossible, or if a step fails.
pub fn cross_check(scene: &Scene, watch: Watch<'_>) -> Result<Option<CrossCheck>, Error> {
    let all = variables(scene);
    let of = |causality| all.iter().filter(move |v| v.causality == causality);
    let mut outputs: Vec<&Variable> = of(Causality::Output).collect();
    let shown = outputs.len().min(MOST_BYTES / FEWEST_ROWS / NUMBER - 2);
    let left_out = outputs.len() - shown;
    outputs.truncate(shown);
    let experiment = spread(scene.experiment, outputs.len());

    let mut reference = header(&outputs);
    let mut simulation = Simulation::new(scene.clone(), 0.0)?;
    row(&mut simulation, 0.0, &outputs, &mut reference)?;
    let is_whole = record_rows(&mut simulation, experiment, watch, |simulation, time, _| {
        row(simulation, time, &outputs, &mut reference)
    })?;
    if !is_whole {
        return Ok(None);
    }
    let inputs: Vec<&Variable> = of(Causality::Input).collect();
    let inputs = (!inputs.is_empty()).then(|| held(scene, &inputs));
    Ok(Some(CrossCheck { reference, options: options(scene, experiment), inputs, left_out }))
}

/// The experiment with so long an interval that its rows fit.
#[allow(clippy::cast_precision_loss)]
fn spread(experiment: Experiment, outputs: usize) -> Experiment {
    let most = (MOST_BYTES / (NUMBER * (outputs + 1))) as f64 - 3.0;
    let intervals = experiment.stop_time / experiment.output_interval;
    let factor = one_two_five().find(|factor| intervals / factor <= most);
    let factor = factor.expect("factors have no end");
    Experiment { output_interval: factor * experiment.output_interval, ..experiment }
}

fn header(variables: &[&Variable]) -> String {
    let mut line = String::from("\"time\"");
    for variable in variables {
        add(&mut line, format_args!(",\"{}\"", variable.name));
    }
    line + "\n"
}

fn row(
    simulation: &mut Simulation,
    time: f64,
    outputs: &[&Variable],
    out: &mut String,
) -> Result<(), Error> {
    add(out, format_args!("{time:?}"));
    for variable in outputs {
        let value = simulation.read(variable)?;
        match variable.template.kind {
            Kind::Real { .. } => add(out, format_args!(",{value:?}")),
            Kind::Integer | Kind::Boolean | Kind::Enumeration { .. } => {
                add(out, format_args!(",{value}"));
            }
        }
    }
    out.push('\n');
    Ok(())
}

/// Inputs in one row, which importers hold. Between two rows they weigh both, and w u + (1 − w) u is not u to the last
/// bit.
fn held(scene: &Scene, inputs: &[&Variable]) -> String {
    let mut text = header(inputs);
    text.push_str("0.0");
    let parameters = Parameters::of(scene.clone());
    for variable in inputs {
        add(&mut text, format_args!(",{:?}", parameters.get(variable).unwrap_or(0.0)));
    }
    text + "\n"
}

fn options(scene: &Scene, experiment: Experiment) -> String {
    let Experiment { stop_time, output_interval } = experiment;
    let tolerance = match scene.selection {
        Selection::Auto { tolerance } => tolerance,
        Selection::Given | Selection::Preset(_) => TOLERANCE,
    };
    let step = output_interval.min(stop_time);
    format!(
        "StartTime, 0.0\nStopTime, {stop_time:?}\nStepSize, {step:?}\nRelTol, {tolerance:?}\n\
         SolverType, FixedStep\nOutputIntervalLength, {output_interval:?}\n"
    )
}

/// A string takes all that is written to it.
fn add(text: &mut String, what: std::fmt::Arguments<'_>) {
    text.write_fmt(what).expect("a string takes all");
}
