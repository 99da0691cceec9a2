//! One scene over the values of one of its parameters or inputs: what each run ends in.
//!
//! Each value has the run that it would have by itself, to the last bit ([`Batch`]).

pub mod range;

use crate::Error;
use crate::accuracy::{Cycle, half_range};
use crate::integrator::Width;
use crate::scene::{Experiment, Scene};
use crate::simulation::catalogue::Kind;
use crate::simulation::{Batch, Simulation, assign, attempt, variables};
use crate::stability::parallel::collect;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

/// A parameter's name with its unit, for an axis.
#[must_use]
pub fn axis(scene: &Scene, name: &str) -> String {
    if name == FRICTION {
        return "friction coefficient µ".into();
    }
    let known = variables(scene).into_iter().find(|variable| variable.name == name);
    match known.map(|variable| variable.template.kind) {
        Some(Kind::Real { unit, .. }) if unit != "1" => format!("{name} [{unit}]"),
        _ => name.to_owned(),
    }
}

/// The name of µ among the parameters.
pub const FRICTION: &str = "friction.coefficient";

/// The values of a parameter that leave no contact with less static than kinetic friction, and a note on the others, if
/// there are any. Each analysis over a range leaves those out in this way.
///
/// # Errors
/// A name that is no parameter or input, a value that it cannot have, or fewer than two values that are left.
pub fn possible_values(
    scene: &Scene,
    name: &str,
    values: &[f64],
) -> Result<(Vec<f64>, Option<String>), Error> {
    let is_possible = |value: &f64| {
        let mut scene = scene.clone();
        assign(&mut scene, name, *value)?;
        Ok(!scene.has_static_below_kinetic_friction())
    };
    let kept: Vec<bool> = values.iter().map(is_possible).collect::<Result<_, Error>>()?;
    let with = |kept_or_not: bool| {
        let all = values.iter().zip(&kept).filter(move |(_, kept)| **kept == kept_or_not);
        all.map(|(value, _)| *value).collect::<Vec<f64>>()
    };
    let (possible, left_out) = (with(true), with(false));
    let reason = "there static friction would be below kinetic friction";
    let note = match left_out[..] {
        [] => None,
        [one] => Some(format!("{name} = {one} is left out: {reason}")),
        [first, .., last] => Some(format!(
            "{name} from {first} to {last} is left out ({} values): {reason}",
            left_out.len()
        )),
    };
    match note {
        Some(note) if possible.len() < 2 => {
            Err(Error::argument(format!("too few values are left: {note}")))
        }
        note => Ok((possible, note)),
    }
}

/// What to look at.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Degrees of freedom, from 0.
    pub dofs: Vec<usize>,
    /// How long before the end of a run one looks, s.
    pub window: f64,
}

impl View {
    /// The earliest time that one looks at, s.
    fn begin(&self, experiment: &Experiment) -> f64 {
        experiment.stop_time - self.window - 1e-9 * experiment.output_interval
    }
}

/// What a run ends in: its rows in the window, which are the rows of `simulate`.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Half of what lies between the smallest and the largest value of each degree of freedom, turns between
    /// the rows included, m.
    pub amplitudes: Vec<f64>,
    /// Of the one with the largest amplitude, Hz; `None` if it does not oscillate, or for fewer than
    /// [`FEWEST_PERIODS`].
    pub frequency: Option<f64>,
    /// How much of the time contacts are in each state, all contacts together, in the order of
    /// [`ContactState::ALL`](crate::contact::ContactState::ALL).
    pub shares: [f64; 4],
}

/// A window with fewer periods of an oscillation does not tell its frequency.
pub const FEWEST_PERIODS: f64 = 3.0;

/// The run of each value, in their order: its summary or why it has none; `None` for runs that the watch
/// ended, which is told how much of the work is done, from 0 to 1, by all cores.
///
/// # Errors
/// A name that is no parameter or input, a value that it cannot have, or a window without two rows.
pub fn sweep(
    scene: &Scene,
    name: &str,
    values: &[f64],
    view: &View,
    watch: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
) -> Result<Vec<Option<Result<Summary, Error>>>, Error> {
    let begin = view.begin(&scene.experiment);
    let rows = scene.experiment.row_times().filter(|(time, is_whole)| *is_whole && *time >= begin);
    if rows.count() < 2 {
        return Err(Error::argument(format!(
            "a window of {} s has no two rows, which are {} s apart; a longer --window or --stop-time has",
            view.window, scene.experiment.output_interval
        )));
    }
    let with = |value: &f64| {
        let mut scene = scene.clone();
        assign(&mut scene, name, *value)?;
        Ok(scene)
    };
    let scenes: Vec<Scene> = values.iter().map(with).collect::<Result<_, Error>>()?;
    let width = Width::available().into_iter().next();
    let start = |scene: &Scene| Simulation::new(scene.clone(), 0.0);
    let first = scenes.iter().find_map(|scene| start(scene).ok());
    let size = first.map_or(1, |simulation| Batch::size(&simulation, width));
    let groups: Vec<&[Scene]> = scenes.chunks(size).collect();
    let (done, all) = (AtomicU64::new(0), groups.len() * scene.experiment.row_times().count());
    #[allow(clippy::cast_precision_loss)]
    let watch = || watch(done.fetch_add(1, Ordering::Relaxed) as f64 / all as f64);
    let runs = |i: usize| {
        let simulations = groups[i].iter().map(start).collect();
        Ok(run(simulations, &scene.experiment, width, view, &watch))
    };
    Ok(collect(groups.len(), &runs, &|_| {})?.into_iter().flatten().collect())
}

/// Runs a few simulations together, as far as they can start; none if the watch ended them.
fn run(
    starts: Vec<Result<Simulation, Error>>,
    experiment: &Experiment,
    width: Option<Width>,
    view: &View,
    watch: &dyn Fn() -> ControlFlow<()>,
) -> Vec<Option<Result<Summary, Error>>> {
    let (count, mut simulations, mut failures) = (starts.len(), Vec::new(), Vec::new());
    for start in starts {
        match start {
            Ok(simulation) => {
                simulations.push(simulation);
                failures.push(None);
            }
            Err(error) => failures.push(Some(error)),
        }
    }
    let mut records = vec![Record::new(view); simulations.len()];
    let mut batch = Batch::new(simulations, width);
    let begin = view.begin(experiment);
    for (time, is_whole) in experiment.row_times() {
        if watch().is_break() {
            return vec![None; count];
        }
        batch.advance_to(time);
        // A row at the end that closes no whole interval would be out of step with the others.
        if is_whole && time >= begin {
            for (simulation, record) in batch.simulations().iter_mut().zip(&mut records) {
                attempt(simulation, |simulation| record.note(simulation, view));
            }
        }
    }
    let summary = |(simulation, record): (Result<Simulation, Error>, Record)| {
        simulation.map(|_| record.summary(experiment.output_interval))
    };
    let mut ends = batch.into_simulations().into_iter().zip(records).map(summary);
    let outcome =
        |failure: Option<Error>| failure.map_or_else(|| ends.next(), |error| Some(Err(error)));
    failures.into_iter().map(outcome).collect()
}

/// What is kept of a run.
#[derive(Clone)]
struct Record {
    /// One history a degree of freedom, m.
    histories: Vec<Vec<f64>>,
    /// How often contacts were in each state.
    states: [u64; 4],
}

impl Record {
    fn new(view: &View) -> Self {
        Self { histories: vec![Vec::new(); view.dofs.len()], states: [0; 4] }
    }

    /// Takes note of a row.
    fn note(&mut self, simulation: &mut Simulation, view: &View) -> Result<(), Error> {
        for (history, &dof) in self.histories.iter_mut().zip(&view.dofs) {
            history.push(simulation.displacement()[dof]);
        }
        for force in simulation.contact_forces()? {
            self.states[force.state as usize - 1] += 1;
        }
        Ok(())
    }

    #[allow(clippy::cast_precision_loss)]
    fn summary(&self, interval: f64) -> Summary {
        let amplitudes: Vec<f64> =
            self.histories.iter().map(|history| half_range(history)).collect();
        let largest =
            (0..amplitudes.len()).rev().max_by(|&a, &b| amplitudes[a].total_cmp(&amplitudes[b]));
        let cycle = largest.map(|i| Cycle::over(&self.histories[i], interval));
        let all = self.states.iter().sum::<u64>().max(1);
        let window = self.histories.first().map_or(0.0, |history| history.len() as f64 * interval);
        let is_clear = |frequency: &f64| frequency * window >= FEWEST_PERIODS;
        Summary {
            amplitudes,
            frequency: cycle.and_then(|cycle| cycle.frequency).filter(is_clear),
            shares: self.states.map(|count| count as f64 / all as f64),
        }
    }
}
