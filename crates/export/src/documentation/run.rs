//! A run of the scene: its own experiment, as far as an export may take.

use super::can_squeal;
use amontons::Error;
use amontons::model::LumpedModel;
use amontons::numerics::range;
use amontons::scene::{Experiment, Scene};
use amontons::selection::Cost;
use amontons::simulation::catalogue::{Causality, Quantity};
use amontons::simulation::{Simulation, Variable, variables};
use amontons_analysis::record::record_rows;
use amontons_analysis::watch::Watch;

/// The operations, as [`Cost`] counts them, that a run in an export may take: some tenths of a second, with exact
/// motion of few parts one or two. They are counted and not timed, so that an FMU is the same on each machine.
const MOST_OPERATIONS: f64 = 5e8;
/// Factor by which a ledger of energy, which [`Cost`] does not count, prolongs a run at the most (7.2 for rings of 63
/// modules).
const LEDGER: f64 = 8.0;
/// The rows that it may have.
const MOST_ROWS: f64 = 1e5;
/// The most displacements among which the one that moves most is chosen.
const CANDIDATES: usize = 32;

/// Rows of outputs over time.
#[derive(Clone, Debug)]
pub struct ReferenceRun {
    /// The experiment that was run: the scene's, or its beginning.
    pub experiment: Experiment,
    /// `true` if the whole experiment was run.
    pub whole: bool,
    /// The recorded variables: the displacement that moves most, forces of the first contact.
    pub variables: Vec<Variable>,
    /// Time, s, and the values of the variables in SI units, from the start on.
    pub rows: Vec<(f64, Vec<f64>)>,
    /// The error that ended the run early, if one did.
    pub failure: Option<Error>,
}

/// Runs a scene as `amontons simulate` does, without inputs, from the start; `None` if `watch`, to which the
/// completed part is reported, has ended it.
///
/// # Errors
/// Returns an error if a start is impossible.
pub fn reference_run(scene: &Scene, watch: Watch<'_>) -> Result<Option<ReferenceRun>, Error> {
    let mut simulation = Simulation::new(scene.clone(), 0.0)?;
    let (experiment, whole) = affordable(simulation.scene(), scene.experiment);
    let outputs = outputs(scene);
    let mut rows = vec![(0.0, read(&mut simulation, &outputs)?)];
    let recorded = record_rows(&mut simulation, experiment, watch, |simulation, time, _| {
        rows.push((time, read(simulation, &outputs)?));
        Ok(())
    });
    let failure = match recorded {
        Ok(true) => None,
        Ok(false) => return Ok(None),
        Err(error) => Some(error),
    };
    let (variables, rows) = shown(&outputs, &rows);
    Ok(Some(ReferenceRun { experiment, whole, variables, rows, failure }))
}

/// The part of the experiment that an export may run, and `true` if that is the whole.
fn affordable(scene: &Scene, experiment: Experiment) -> (Experiment, bool) {
    let Experiment { stop_time, output_interval } = experiment;
    let second = Cost::of(&LumpedModel::from(scene)).run(scene.method, scene.step, 1.0, 0.0);
    let ledger = if scene.effects.energy { LEDGER } else { 1.0 };
    let time = MOST_OPERATIONS / (ledger * second);
    let intervals = (time / output_interval).floor().clamp(1.0, MOST_ROWS);
    // Whole intervals, so that the rows are those of the whole experiment.
    let end = intervals * output_interval;
    if end < stop_time {
        (Experiment { stop_time: end, ..experiment }, false)
    } else {
        (experiment, true)
    }
}

/// Displacements, then forces of the first contact; where there is none, velocities.
fn outputs(scene: &Scene) -> Vec<Variable> {
    let all = variables(scene);
    let of = |quantity: Quantity| {
        let is_it = move |v: &&Variable| {
            v.causality == Causality::Output && v.template.quantity == quantity
        };
        all.iter().filter(is_it).cloned()
    };
    let mut outputs: Vec<Variable> = of(Quantity::Displacement).take(CANDIDATES).collect();
    if scene.contact_count() == 0 {
        let moving = outputs.len();
        outputs.extend(of(Quantity::Velocity).take(moving));
    } else {
        outputs.extend(of(Quantity::NormalForce).take(1));
        if can_squeal(scene) {
            outputs.extend(of(Quantity::FrictionForce).take(1));
        }
    }
    outputs
}

fn read(simulation: &mut Simulation, outputs: &[Variable]) -> Result<Vec<f64>, Error> {
    outputs.iter().map(|variable| simulation.read(variable)).collect()
}

/// The variables to show and their rows: the displacement that moves most, and the other variables of it or of a
/// contact.
fn shown(outputs: &[Variable], rows: &[(f64, Vec<f64>)]) -> (Vec<Variable>, Vec<(f64, Vec<f64>)>) {
    let is = |quantity: Quantity| move |v: &Variable| v.template.quantity == quantity;
    let displacements = outputs.iter().filter(|v| is(Quantity::Displacement)(v)).count();
    let span = |column: usize| {
        let [low, high] = range(rows.iter().map(|(_, values)| values[column]));
        high - low
    };
    let spans: Vec<f64> = (0..displacements).map(span).collect();
    let most = (1..displacements).fold(0, |most, i| if spans[i] > spans[most] { i } else { most });
    let velocities = outputs.iter().filter(|v| is(Quantity::Velocity)(v)).count();
    let kept: Vec<usize> = if velocities > 0 {
        vec![most, displacements + most]
    } else {
        let rest = displacements..outputs.len();
        (0..displacements).filter(|i| *i == most).chain(rest).collect()
    };
    let pick = |values: &Vec<f64>| kept.iter().map(|&column| values[column]).collect();
    let rows = rows.iter().map(|(time, values)| (*time, pick(values))).collect();
    (kept.iter().map(|&column| outputs[column].clone()).collect(), rows)
}
