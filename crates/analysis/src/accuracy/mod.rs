//! The cost of accuracy: the distance of each method, at each step of a ladder, from a reference.
//!
//! The reference is the event-driven integrator at a step that none of the ladder has, halved until two
//! runs agree. How far those two are apart is the reference's own error, the *floor*: no error below it is
//! claimed. Nothing here looks at a clock, so the same scene gives the same numbers at each run; who wants
//! times takes them over the same [`Grid`].
//!
//! | file | contents |
//! | --- | --- |
//! | `grid` | the times at which a run is observed, and the steps that go with them |
//! | `run` | one run: displacements over the window, changes of state with their times |
//! | `cycle` | amplitude and frequency of the motion that a run ends in |
//! | `table` | the table in words |

mod cycle;
mod grid;
mod run;
mod table;

use crate::watch::Watch;
pub use cycle::Cycle;
pub(crate) use cycle::half_range;
pub use grid::{Grid, StepCandidate};
pub use run::StateChange;
pub use table::{COLUMNS, LEGEND, short};

use amontons::Error;
use amontons::integrator::Statistics;
use amontons::model::LumpedModel;
use amontons::numerics::max_norm;
use amontons::scene::{Method, Scene, did_you_mean};
use amontons::simulation::Simulation;
use amontons::stability::{CriticalStep, critical_step};
use run::AccuracyRun;

/// Two runs that agree this well, in parts of the amplitude, need no shorter step.
const CONVERGED: f64 = 1e-10;
/// A step halved that leaves more than this of the difference gains nothing: rounding, or chaos.
const NO_GAIN: f64 = 0.7;
/// The most work of a run of the reference: steps times degrees of freedom.
const MOST_WORK: f64 = 4e6;
/// A displacement is none if it is below this part of the one that the load makes: rounding.
const REST: f64 = 1e-13;
/// From this error on two motions of the same size are out of phase; at √2 they have nothing in common.
const OUT_OF_PHASE: f64 = 0.5;
/// Errors closer to the floor than this give no order.
const ABOVE_FLOOR: f64 = 10.0;

/// Differences between two runs; `None` where there is nothing to compare.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Root mean square error of all displacements together over the window, in parts of the reference's root mean
    /// square about its mean. `None` for a scene that does not move.
    pub rms: Option<f64>,
    /// Relative error of the amplitude of the cycle.
    pub amplitude: Option<f64>,
    /// Relative error of the frequency of the cycle.
    pub frequency: Option<f64>,
    /// Root mean square error of the times at which contacts change their state, s. Only where each contact goes
    /// through the same states.
    pub event_time: Option<f64>,
    /// The largest error of such a time, s.
    pub largest_event_time: Option<f64>,
}

/// Result of one method with one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The method and its step.
    pub candidate: StepCandidate,
    /// The counts of the run.
    pub statistics: Statistics,
    /// Changes of state, less those of the reference.
    pub events_more: i64,
    /// Errors of the run, none smaller than the floor: an error that equals it is not larger.
    pub errors: Errors,
}

impl Row {
    /// `true` if the motion is out of phase with the reference, so that only amplitude and frequency are left to
    /// judge it by.
    #[must_use]
    pub fn is_out_of_phase(&self) -> bool {
        self.errors.rms.is_some_and(|rms| rms >= OUT_OF_PHASE)
    }
}

/// The degree of freedom of that name, `module[1].x1` or `mass.pad.x`.
///
/// # Errors
/// Returns an error if there is none; it gives the nearest name, or all names.
pub fn dof_named(scene: &Scene, name: &str) -> Result<usize, Error> {
    let names = scene.dof_names();
    names.iter().position(|known| known == name).ok_or_else(|| {
        let example = || match names.first() {
            Some(first) => format!("displacements have names such as {first}"),
            None => "the scene has no displacements".to_owned(),
        };
        let help = did_you_mean(name, names.iter().map(|name| &**name)).unwrap_or_else(example);
        Error::argument(format!("{} has no displacement {name}; {help}", scene.name))
    })
}

/// Gives a parameter or input of a scene that is to be studied another value.
///
/// # Errors
/// Returns an error if the name is that of the step, which a study varies itself, or if
/// [`assign`](crate::assign::assign) refuses it.
pub fn assign(scene: &mut Scene, name: &str, value: f64) -> Result<(), Error> {
    if name == "integrator.step" {
        return Err(Error::argument(
            "integrator.step cannot be set here: each method is run with a ladder of steps",
        ));
    }
    crate::assign::assign(scene, name, value)
}

/// A run, and the one with twice its step.
struct Converged {
    coarser: AccuracyRun,
    reference: AccuracyRun,
    step: f64,
    /// Root mean square of the displacements about their means, m, if there is any motion.
    scale: Option<f64>,
}

/// Halves the event-driven integrator's step until two runs agree, or agree no better, or are too much work;
/// displacements below `rest` (m) are none. `None` if the watch ended it.
#[allow(clippy::cast_precision_loss)]
fn converge(
    scene: &Scene,
    grid: Grid,
    rest: f64,
    watch: Watch<'_>,
) -> Result<Option<Converged>, Error> {
    let (mut before, mut failure, mut last) = (None, None, f64::INFINITY);
    for halvings in 0.. {
        // None of the ladder is three times shorter than another.
        let candidate = grid.candidate(Method::EventDriven, 3 << halvings);
        let steps = (candidate.steps * grid.intervals) as f64;
        let is_last = 2.0 * steps * scene.external_forces().count() as f64 > MOST_WORK;
        match AccuracyRun::of(scene, grid, candidate, watch) {
            Ok(None) => return Ok(None),
            Ok(Some(reference)) => {
                if let Some(coarser) = before.take() {
                    let deviation = reference.deviation();
                    let scale = (deviation > rest).then_some(deviation);
                    let apart = scale.map_or(0.0, |scale| reference.distance(&coarser) / scale);
                    if apart <= CONVERGED || apart > NO_GAIN * last || is_last {
                        let step = candidate.step;
                        return Ok(Some(Converged { coarser, reference, step, scale }));
                    }
                    last = apart;
                }
                before = Some(reference);
            }
            // A shorter step may lead past what made it fail.
            Err(error) => {
                failure.get_or_insert(error);
                before = None;
            }
        }
        if is_last && halvings > 0 {
            break;
        }
    }
    Err(failure
        .unwrap_or_else(|| Error::step("the reference does not converge as its step is halved")))
}

/// A scene with its reference.
pub struct ConvergenceStudy {
    scene: Scene,
    grid: Grid,
    critical: Result<CriticalStep, Error>,
    dof: usize,
    reference: AccuracyRun,
    reference_step: f64,
    cycle: Cycle,
    scale: Option<f64>,
    floor: Errors,
}

impl ConvergenceStudy {
    /// Makes the reference of a scene: `None` if the watch ended it. The cycle is that of degree of freedom
    /// `dof`, or else of the one that moves most.
    ///
    /// # Errors
    /// Returns an error if the scene is invalid, a run fails or the window is too long to keep.
    pub fn new(scene: &Scene, dof: Option<usize>, watch: Watch<'_>) -> Result<Option<Self>, Error> {
        let law = scene.contact_law();
        if !law.friction.info().is_constant() || law.follows_size() {
            return Err(Error::scene(format!(
                "the errors of {} cannot be computed: the reference is a run of the event-driven integrator, which \
                 supports neither friction that falls with the slip velocity nor contacts that stick and cannot \
                 open; compare runs with different steps instead",
                scene.name
            )));
        }
        let interval = scene.experiment.output_interval;
        let start = Simulation::new(scene.with_integrator(Method::EventDriven, interval), 0.0)?;
        let effective = start.scene();
        let model = LumpedModel::from(effective);
        let critical = critical_step(&model);
        let grid = Grid::of(scene, critical.as_ref().ok().map(|critical| critical.step))?;
        let size = max_norm(&start.reference().displacement);
        let found = converge(scene, grid, REST * size, watch)?;
        let Some(Converged { coarser, reference, step, scale }) = found else { return Ok(None) };
        let dof = dof.unwrap_or_else(|| reference.most_moving());
        let mut study = Self {
            scene: scene.clone(),
            grid,
            critical,
            dof,
            cycle: Cycle::of(&reference.history(dof), grid.interval),
            reference_step: step,
            reference,
            scale,
            floor: Errors::default(),
        };
        study.floor = study.floor_from(&coarser);
        Ok(Some(study))
    }

    /// The reference's own errors, from the run with twice its step.
    fn floor_from(&self, coarser: &AccuracyRun) -> Errors {
        let apart = self.errors_of(coarser);
        let Cycle { amplitude_error, frequency_error, .. } = self.cycle;
        let resolution = AccuracyRun::resolution(self.reference_step);
        Errors {
            rms: apart.rms.map(|rms| rms.max(f64::EPSILON)),
            amplitude: apart.amplitude.map(|error| error.max(amplitude_error)),
            frequency: apart.frequency.map(|error| error.max(frequency_error)),
            event_time: apart.event_time.map(|error| error.max(resolution)),
            largest_event_time: apart.largest_event_time.map(|error| error.max(resolution)),
        }
    }

    /// The scene as it was given.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the times at which runs are observed.
    #[must_use]
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The largest step of the paper's scheme.
    ///
    /// # Errors
    /// Returns an error if none is known.
    pub fn critical_step(&self) -> Result<&CriticalStep, &Error> {
        self.critical.as_ref()
    }

    /// The degree of freedom whose cycle is observed.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// The reference's step, s.
    #[must_use]
    pub fn reference_step(&self) -> f64 {
        self.reference_step
    }

    /// Returns the counts of the reference run.
    #[must_use]
    pub fn reference_statistics(&self) -> Statistics {
        self.reference.statistics
    }

    /// Changes of contact states in the reference, in the order of time.
    #[must_use]
    pub fn reference_changes(&self) -> &[StateChange] {
        self.reference.changes()
    }

    /// The cycle in which the reference ends.
    #[must_use]
    pub fn cycle(&self) -> Cycle {
        self.cycle
    }

    /// The reference's deviation from its mean, root mean square over all displacements, m; `None` if the
    /// scene does not move.
    #[must_use]
    pub fn scale(&self) -> Option<f64> {
        self.scale
    }

    /// The reference's own errors: it against itself at twice its step.
    #[must_use]
    pub fn floor(&self) -> Errors {
        self.floor
    }

    /// `true` if the reference itself is known only by amplitude and frequency, as a chaotic motion is.
    #[must_use]
    pub fn is_chaotic(&self) -> bool {
        self.floor.rms.is_some_and(|rms| rms >= 0.1 * OUT_OF_PHASE)
    }

    /// The methods and steps that are worth looking at, longest steps first; none of the paper's scheme
    /// above the critical step, or where none is known.
    #[must_use]
    pub fn candidates(&self) -> Vec<StepCandidate> {
        let critical = self.critical.as_ref().ok().map(|critical| critical.step);
        self.grid.candidates(&self.scene, critical)
    }

    /// Runs one method with one step and returns its result; `None` if the watch ended it.
    ///
    /// # Errors
    /// Returns an error if the run fails: a step above the critical one, contact forces that do not converge.
    pub fn row(&self, candidate: StepCandidate, watch: Watch<'_>) -> Result<Option<Row>, Error> {
        let Some(run) = AccuracyRun::of(&self.scene, self.grid, candidate, watch)? else {
            return Ok(None);
        };
        let raised = |error: Option<f64>, floor: Option<f64>| {
            error.zip(floor).map(|(error, floor)| error.max(floor))
        };
        let errors = self.errors_of(&run);
        let floor = self.floor;
        let more =
            |run: &AccuracyRun| i64::try_from(run.statistics.state_changes()).unwrap_or(i64::MAX);
        let errors = Errors {
            rms: raised(errors.rms, floor.rms),
            amplitude: raised(errors.amplitude, floor.amplitude),
            frequency: raised(errors.frequency, floor.frequency),
            event_time: raised(errors.event_time, floor.event_time),
            largest_event_time: raised(errors.largest_event_time, floor.largest_event_time),
        };
        let events_more = more(&run) - more(&self.reference);
        Ok(Some(Row { candidate, statistics: run.statistics, events_more, errors }))
    }

    /// The differences between a run and the reference.
    fn errors_of(&self, run: &AccuracyRun) -> Errors {
        let cycle = Cycle::of(&run.history(self.dof), self.grid.interval);
        let relative = |value: Option<f64>, reference: Option<f64>| {
            value.zip(reference).map(|(value, reference)| (value / reference - 1.0).abs())
        };
        let times = self.reference.event_times_apart(run);
        let moving = self.scale.and(self.cycle.amplitude);
        Errors {
            rms: self.scale.map(|scale| self.reference.distance(run) / scale),
            amplitude: relative(cycle.amplitude, moving),
            frequency: relative(cycle.frequency, moving.and(self.cycle.frequency)),
            event_time: times.map(|[rms, _]| rms),
            largest_event_time: times.map(|[_, largest]| largest),
        }
    }

    /// The order of the error between a row and the one before it: how often the error halves where the
    /// step does. `None` for another method, out of phase, or at the floor.
    #[must_use]
    pub fn order(&self, before: &Row, row: &Row) -> Option<f64> {
        let floor = self.floor.rms?;
        let usable = |row: &Row| {
            row.errors.rms.filter(|rms| *rms > ABOVE_FLOOR * floor && !row.is_out_of_phase())
        };
        let (longer, shorter) = (usable(before)?, usable(row)?);
        let is_next = before.candidate.method == row.candidate.method
            && before.candidate.step > row.candidate.step;
        is_next.then(|| (longer / shorter).ln() / (before.candidate.step / row.candidate.step).ln())
    }
}
