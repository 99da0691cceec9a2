//! One scene over the values of one of its parameters or inputs: what each run ends in.
//!
//! Each value has the run that it would have by itself, to the last bit.

pub mod observed;
pub(crate) mod passage;
mod possible;
mod quarters;
pub mod range;
pub(crate) mod steady;

pub use possible::Possible;

use crate::accuracy::Cycle;
use crate::assign::assign;
use crate::journal::Journal;
use crate::stability::parallel::collect;
use crate::statistics::place_of_largest;
use crate::watch::Watch;
use amontons::Error;
use amontons::numerics::max_norm;
use amontons::scene::{Experiment, Scene};
use amontons::simulation::catalogue::Kind;
use amontons::simulation::{Simulation, Variable, variables};
use observed::{frequencies_in_motion, interval};
use passage::Passage;
use quarters::Quarters;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use steady::ROUNDING;

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
pub use crate::assign::FRICTION;

/// The outputs to observe, and the window.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The outputs whose amplitudes are observed ([`observed::output`]).
    pub outputs: Vec<Variable>,
    /// Length of the window before the end of a run, s.
    pub window: f64,
}

impl View {
    /// The beginning of the window, s.
    fn begin(&self, experiment: &Experiment) -> f64 {
        experiment.stop_time - self.window - 1e-9 * experiment.output_interval
    }
}

/// Summary of the end of a run: its motion in the window, in rows that are as near to each other as the fastest mode
/// asks for ([`observed::interval`]), whatever the output interval is, and refined where it turns or contacts change
/// their states.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Half of the difference between the largest and the smallest value of each output, wherever the rows are, in its
    /// unit; 0 where everything rests but for rounding.
    pub amplitudes: Vec<f64>,
    /// `true` if everything rests, or the size of each displacement stays over the four quarters of the window; `false` if
    /// those that do not all grow, or all decay, from each quarter to the next; else why that is not known.
    pub settled: Result<bool, UnsettledReason>,
    /// Energies at the end, J, in the order of [`ENERGIES`]; empty unless the scene asks for them.
    pub energies: Vec<f64>,
    /// Frequency of the output with the largest amplitude, Hz; `None` if it does not oscillate, or for fewer than
    /// [`FEWEST_PERIODS`].
    pub frequency: Option<f64>,
    /// The part of the time that contacts are in each state, all contacts together, in the order of
    /// [`ContactState::ALL`](amontons::contact::ContactState::ALL).
    pub shares: [f64; 4],
}

/// The reason why it is not known if a motion has settled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum UnsettledReason {
    /// A quarter of the window has fewer than five periods of the slowest mode; the window that has them, s.
    Short(f64),
    /// Sizes neither stay, nor do all that change grow, or all decay, from each quarter to the next.
    Mixed,
    /// No mode oscillates, so the necessary length of a quarter is unknown.
    NoMode,
}

impl fmt::Display for UnsettledReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short(window) => write!(
                f,
                "a window of {window:.4} s or more is needed, which has {PERIODS_TO_SETTLE} periods of the slowest mode in \
                 each quarter"
            ),
            Self::Mixed => f.write_str(
                "from quarter to quarter of the window, the displacements neither keep their size nor all grow or all decay, \
                 as in a beat or a slow decay; a longer --window that begins later may decide",
            ),
            Self::NoMode => f.write_str(
                "no mode oscillates, so the necessary length of the window is unknown; `amontons study` may decide",
            ),
        }
    }
}

/// Names of the energies, as outputs have them.
pub const ENERGIES: [&str; 8] =
    ["kinetic", "elastic", "damping", "friction", "impact", "slider", "forces", "residual"];

/// The least number of periods of the slowest mode in a quarter of a window: with fewer the size of the motion in it
/// says nothing.
const PERIODS_TO_SETTLE: f64 = 5.0;

/// A window with fewer periods of an oscillation does not tell its frequency.
pub const FEWEST_PERIODS: f64 = 3.0;

/// The run of each value, in their order: its summary or the reason why it has none; `None` for runs that the watch
/// ended, or that another worker computes. The watch receives the completed part of the work, from 0 to 1, of all cores.
///
/// # Errors
/// Returns an error if a name is no parameter or input, a value is impossible, the window has fewer than two rows, or
/// the journal cannot be written.
pub fn sweep(
    scene: &Scene,
    name: &str,
    values: &[f64],
    view: &View,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Vec<Option<Result<Summary, Error>>>, Error> {
    let with = |value: &f64| {
        let mut scene = scene.clone();
        assign(&mut scene, name, *value)?;
        Ok(scene)
    };
    let scenes: Vec<Scene> = values.iter().map(with).collect::<Result<_, Error>>()?;
    // Each value has the rows that it would have by itself.
    let observed = |mut scene: Scene| {
        scene.experiment.output_interval = interval(&scene, scene.experiment.output_interval);
        scene
    };
    let scenes: Vec<Scene> = scenes.into_iter().map(observed).collect();
    for Scene { experiment, .. } in &scenes {
        let begin = view.begin(experiment);
        let rows = experiment.row_times().filter(|(time, is_whole)| *is_whole && *time >= begin);
        if rows.take(2).count() < 2 {
            return Err(Error::argument(format!(
                "a window of {} s has fewer than two rows, which are {} s apart; give a longer --window or --stop-time",
                view.window, experiment.output_interval
            )));
        }
    }
    let count = |scene: &Scene| scene.experiment.row_times().count();
    let (done, all) = (AtomicU64::new(0), scenes.iter().map(count).sum::<usize>());
    #[allow(clippy::cast_precision_loss)]
    let row_ends = || watch.ends_after(done.fetch_add(1, Ordering::Relaxed) as f64 / all as f64);
    let outcome = |i: usize| {
        journal.piece(&format!("{name} = {:?}", values[i]), || {
            Ok(run(&scenes[i], view, &row_ends).transpose())
        })
    };
    collect(scenes.len(), &outcome, &|_| {})
}

/// Runs a scene to its stop time; `None` if the run `is_over` before, which is asked before each row.
fn run(scene: &Scene, view: &View, is_over: &dyn Fn() -> bool) -> Result<Option<Summary>, Error> {
    let mut simulation = Simulation::new(scene.clone(), 0.0)?;
    let experiment = &scene.experiment;
    let begin = view.begin(experiment);
    // A row at the end that closes no whole interval would be out of step with the others.
    let is_seen = |(time, is_whole): &(f64, bool)| *is_whole && *time >= begin;
    let rows = experiment.row_times().filter(is_seen).count();
    let mut record = RunRecord::new(view, rows, simulation.scene());
    for row in experiment.row_times() {
        if is_over() {
            return Ok(None);
        }
        simulation.advance_to(row.0)?;
        if is_seen(&row) {
            record.note(&mut simulation, view)?;
        }
    }
    Ok(Some(record.summary(&simulation, experiment.output_interval)))
}

/// The size of a motion, m, below which rounding moves what rests.
fn smallest(simulation: &Simulation) -> f64 {
    ROUNDING * max_norm(&simulation.reference().displacement)
}

/// Recorded data of a run.
struct RunRecord {
    /// One history for each output, in its unit.
    histories: Vec<Vec<f64>>,
    passage: Passage,
    displacements: Quarters,
    /// Frequency of the slowest mode, Hz; `None` where nothing oscillates.
    slowest: Option<f64>,
}

impl RunRecord {
    fn new(view: &View, rows: usize, scene: &Scene) -> Self {
        let histories = vec![Vec::new(); view.outputs.len()];
        let passage = Passage::new(scene, &view.outputs);
        let slowest = frequencies_in_motion(scene).map(|both| both[0]);
        Self { histories, passage, displacements: Quarters::new(rows), slowest }
    }

    /// Takes note of a row.
    fn note(&mut self, simulation: &mut Simulation, view: &View) -> Result<(), Error> {
        for (history, output) in self.histories.iter_mut().zip(&view.outputs) {
            history.push(simulation.read(output)?);
        }
        self.displacements.note(simulation.displacement());
        self.passage.note(simulation)
    }

    #[allow(clippy::cast_precision_loss)]
    fn summary(&self, simulation: &Simulation, interval: f64) -> Summary {
        let least = smallest(simulation);
        let rests = self.displacements.rest(least);
        let size = |amplitude: f64| if rests { 0.0 } else { amplitude };
        let amplitudes: Vec<f64> = self.passage.amplitudes().map(size).collect();
        let cycle =
            place_of_largest(&amplitudes).map(|i| Cycle::over(&self.histories[i], interval));
        let rows = self.histories.first().map_or(0, Vec::len);
        let window = rows as f64 * interval;
        let is_clear = |frequency: &f64| !rests && frequency * window >= FEWEST_PERIODS;
        Summary {
            amplitudes,
            settled: if rests { Ok(true) } else { self.settled(interval, least) },
            frequency: cycle.and_then(|cycle| cycle.frequency).filter(is_clear),
            shares: self.passage.shares(),
            energies: simulation.energy().map_or_else(Vec::new, |energy| energy.parts().to_vec()),
        }
    }

    /// Computes [`Summary::settled`] of what moves. A displacement that moves by less than `least` (m) rests.
    #[allow(clippy::cast_precision_loss)]
    fn settled(&self, interval: f64, least: f64) -> Result<bool, UnsettledReason> {
        let quarter = self.displacements.rows() as f64 * interval;
        let slowest = self.slowest.ok_or(UnsettledReason::NoMode)?;
        if slowest * quarter < PERIODS_TO_SETTLE {
            // A window consists of four such quarters, and of the rows that no quarter has.
            return Err(UnsettledReason::Short(4.0 * (PERIODS_TO_SETTLE / slowest + interval)));
        }
        self.displacements.settled(least).ok_or(UnsettledReason::Mixed)
    }
}
