//! One run of a scene: how one of its outputs grows and decays, at which frequencies, in which contact states.
//!
//! | file | contents |
//! | --- | --- |
//! | `linear` | growth and decay mode by mode while no contact changes its state |
//! | `rows` | the rows of a run by stretches without a change of state or an edge of a signal |
//! | `trace` | the growth or decay of one mode, on over edges |
//! | `curve` | one mode over such a stretch of time |
//! | `growth` | growth and decay in a history, by its bands and its envelope |
//! | `bands` | the strongest lines, each followed over time by itself |
//! | `straight` | straight pieces of a curve |
//! | `shares` | the contact states of a span of time, and their eigenvalues |
//! | `open` | questions that a run leaves open, and the runs that would answer them |
//! | `stretches` | states of each contact over time |

mod bands;
mod curve;
mod growth;
mod linear;
mod open;
mod rows;
mod shares;
mod straight;
mod stretches;
mod trace;

pub use bands::{Band, Combination};
pub use growth::{Growth, Phase, growth};
pub use open::OpenQuestion;
pub use stretches::{StateInterval, StateTimeline};

use super::basis::scheme_step;
use super::observation::{ROWS_A_PERIOD, displacements, frequencies, output};
use super::{Watch, unit};
use crate::record::record_rows;
use crate::spectral::Spectrogram;
use crate::stability::Linearised;
use crate::statistics::{place_of_largest, variance};
use amontons::Error;
use amontons::contact::ContactState;
use amontons::error::Short;
use amontons::model::LumpedModel;
use amontons::scene::{Experiment, Scene};
use amontons::simulation::catalogue::Quantity;
use amontons::simulation::{Simulation, Variable, dof_of};
use amontons::stability::highest_frequency;
use linear::{Follower, Observed};
use serde::Serialize;
use shares::Shares;
use std::f64::consts::TAU;

/// The most values that are kept of a run.
const MOST_KEPT: f64 = 2e7;
/// Highest frequency of a spectrogram in parts of the highest natural frequency, its largest number of windows, and
/// their length in parts of that of the bands' windows.
const ABOVE_HIGHEST: f64 = 1.5;
const SPECTRA: usize = 400;
const LONGER: f64 = 2.0;

/// An eigenvalue of a contact state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Eigenvalue {
    /// Growth rate, 1/s.
    pub rate: f64,
    /// Frequency, Hz.
    pub frequency: f64,
}

/// The states that all contacts have together for a part of a stretch of time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateShare {
    /// The states contact by contact, such as `Sl-St`.
    pub states: String,
    /// The part of the time, from 0 to 1.
    pub share: f64,
    /// The one of the states' eigenvalues that is nearest in the complex plane to the growth or decay that was found;
    /// `None` if they have none that oscillates, or none that does not, as the found one does.
    pub eigenvalue: Option<Eigenvalue>,
}

/// A growth or decay beside the eigenvalues that may explain it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The growth or decay that was found.
    #[serde(flatten)]
    pub phase: Phase,
    /// The nearest eigenvalue in the state in which the scene is at rest, which is uniform sliding where the slider
    /// moves.
    pub resting: Option<Eigenvalue>,
    /// The states in which the contacts were, longest first.
    pub taken: Vec<StateShare>,
}

/// The growth and decay of one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Transient {
    /// The output's name.
    pub output: String,
    /// Unit of the output.
    pub unit: &'static str,
    /// Time between two values, s.
    pub interval: f64,
    /// Time at which the run ended, s.
    pub end: f64,
    /// `true` if the run reached its end.
    pub complete: bool,
    /// The reason why the run did not reach its end, unless the watch ended it.
    #[serde(skip)]
    pub failure: Option<Error>,
    /// The output's values, one each `interval`, from 0 s on.
    #[serde(skip)]
    pub history: Vec<f64>,
    /// The contacts' states at the same times: contact by contact.
    #[serde(skip)]
    pub states: Vec<Vec<ContactState>>,
    /// Lines, bands and envelope.
    #[serde(flatten)]
    pub growth: Growth,
    /// Each of `growth.phases` beside eigenvalues.
    pub findings: Vec<Finding>,
    /// Questions that the run is too short to answer.
    pub open: Vec<OpenQuestion>,
    /// Features of the scene that the eigenvalues leave out: sentences.
    pub left_out: Vec<String>,
    /// The states that each contact takes over time.
    pub courses: Vec<StateTimeline>,
    /// Spectrogram of the output.
    #[serde(skip)]
    pub spectrogram: Spectrogram,
}

/// Runs a scene once, as long as `experiment` says, and analyses its output of that name, or else the displacement
/// that moves most, in rows as near as the output interval and [`interval()`] say. A run that fails or is ended by
/// the watch is analysed as far as it went.
///
/// # Errors
/// Returns an error if the scene is invalid, there is no such output or the run is too long to keep.
pub fn transient(
    scene: &Scene,
    experiment: Experiment,
    of: Option<&str>,
    watch: Watch<'_>,
) -> Result<Transient, Error> {
    let outputs = outputs(scene, of)?;
    let mut simulation = Simulation::new(scene.clone(), 0.0)?;
    let interval = interval(scene, experiment.output_interval);
    let experiment = Experiment { output_interval: interval, ..experiment };
    let kept = experiment.stop_time / interval * (outputs.len() + scene.contact_count()) as f64;
    if kept > MOST_KEPT {
        return Err(Error::argument(format!(
            "{} s with a row every {} s have {kept:.1e} values, more than the limit of {MOST_KEPT:e}; choose a shorter \
             --stop-time, a longer --output-interval, or a single output with --of",
            Short(experiment.stop_time),
            Short(interval)
        )));
    }
    let mut record = Record::of(outputs, &simulation, interval);
    let ended = record.run(&mut simulation, experiment, watch);
    let (output, history) = record.most_moving();
    let found = record.follower.found(observed(scene, &output));
    let states = record.states;
    let end = interval * history.len().saturating_sub(1) as f64;
    let rest = open::unexplained(&found.explained, end, growth::dominant(&history, interval));
    let growth = growth(&history, interval, &rest, found.phases);
    let open = open::questions(
        (found.slow, found.too_slow),
        &rest,
        &growth,
        (end, !scene.signals.is_empty()),
    );
    let mut shares = Shares::of(&record.linear, &states, interval);
    let findings = growth.phases.iter().map(|phase| shares.beside(phase)).collect();
    Ok(Transient {
        unit: unit(&output),
        output: output.name,
        interval,
        end,
        complete: matches!(ended, Ok(true)),
        failure: ended.err(),
        findings,
        open,
        left_out: leaves_out(&record.linear[0].1, scene),
        courses: stretches::courses(&contact_names(scene), &states, interval),
        spectrogram: spectrogram(&history, interval, growth.window, highest(scene)),
        growth,
        history,
        states,
    })
}

/// The output of that name, or all displacements.
fn outputs(scene: &Scene, of: Option<&str>) -> Result<Vec<Variable>, Error> {
    match of {
        Some(name) => Ok(vec![output(scene, name)?]),
        None => displacements(scene),
    }
}

/// Time between two values of a run, s: the longest whole part (1/1, 1/2, 1/3, …) of an output interval of which
/// the period of the scene's fastest mode has 20. Of the paper's scheme one that holds whole steps, a step at least; where
/// the output interval is no whole number of steps, the most steps that are no longer than that part of it.
#[must_use]
pub fn interval(scene: &Scene, output_interval: f64) -> f64 {
    let longest = highest(scene).map_or(f64::INFINITY, |highest| 1.0 / (ROWS_A_PERIOD * highest));
    // A whole number but for rounding is that number.
    let parts = (output_interval / longest * (1.0 - 1e-9)).ceil().max(1.0);
    // A row within a step would part it, and the steps of the scheme would not be of one length.
    let steps = scheme_step(scene).map_or(0.0, |step| output_interval / step);
    let whole = steps.round();
    if let Some(step) = scheme_step(scene).filter(|_| (steps - whole).abs() > 1e-9 * whole) {
        return (steps / parts).floor().max(1.0) * step;
    }
    if whole < 1.0 {
        return output_interval / parts;
    }
    let mut of_a_row = (whole / parts).floor().max(1.0);
    while whole % of_a_row != 0.0 {
        of_a_row -= 1.0;
    }
    output_interval / (whole / of_a_row)
}

/// The frequency of the fastest mode, Hz.
fn highest(scene: &Scene) -> Option<f64> {
    let of_modes = frequencies(scene).map(|[_, fastest]| fastest);
    // At rest nothing may oscillate that does in other states.
    of_modes.or_else(|| highest_frequency(&LumpedModel::from(scene)).map(|bound| bound / TAU))
}

/// The degree of freedom whose displacement or velocity an output is.
fn observed(scene: &Scene, output: &Variable) -> Option<Observed> {
    let is_velocity = output.template.quantity == Quantity::Velocity;
    Some(Observed { dof: dof_of(scene, output)?, is_velocity })
}

/// The contacts as the FMU names them.
fn contact_names(scene: &Scene) -> Vec<String> {
    (0..scene.contact_count()).map(|contact| scene.contact_name(contact)).collect()
}

/// Says which effects act in the run and are not in the eigenvalues beside its findings.
fn leaves_out(here: &Linearised, scene: &Scene) -> Vec<String> {
    let mut found = Vec::new();
    if !scene.signals.is_empty() {
        found.push(
            "signals act in the run; the eigenvalues beside a growth or decay are those of the scene with the values \
             after the last jump or corner of a signal before it"
                .to_owned(),
        );
    }
    if let Some(step) = scheme_step(scene) {
        found.push(format!(
            "rates and frequencies are those of the paper's scheme, whose errors grow with its step of {} s: the \
             eigenvalues beside them are the scene's own; a smaller --step or, where the scene allows it, --integrator \
             event-driven comes closer to these",
            Short(step)
        ));
    }
    if here.linear().is_ok_and(|linear| linear.friction().any(|friction| friction.damping != 0.0)) {
        found.push(
            "friction depends on the slip velocity; the eigenvalues use its slope at the equilibrium, which is \
             valid for small motions"
                .to_owned(),
        );
    }
    found
}

/// Recorded data of a run.
struct Record {
    outputs: Vec<Variable>,
    histories: Vec<Vec<f64>>,
    states: Vec<Vec<ContactState>>,
    rows: usize,
    follower: Follower,
    /// The linearised scene from a row on: the first, and those beyond an edge of a signal.
    linear: Vec<(usize, Linearised)>,
}

impl Record {
    fn of(outputs: Vec<Variable>, simulation: &Simulation, interval: f64) -> Self {
        let (scene, here) = (simulation.scene(), Linearised::now(simulation));
        let equilibrium = &simulation.reference().displacement;
        Self {
            histories: vec![Vec::new(); outputs.len()],
            outputs,
            states: vec![Vec::new(); scene.contact_count()],
            rows: 0,
            follower: Follower::of(scene, here.clone(), equilibrium, interval),
            linear: vec![(0, here)],
        }
    }

    /// Records all rows until the end, a failure, or the end by the watch. Returns `true` if the run reached its end.
    fn run(
        &mut self,
        simulation: &mut Simulation,
        experiment: Experiment,
        watch: Watch<'_>,
    ) -> Result<bool, Error> {
        self.note(simulation)?;
        record_rows(simulation, experiment, watch, |simulation, _, is_whole| {
            // A last row that closes no whole interval would be out of step with the others.
            if is_whole { self.note(simulation) } else { Ok(()) }
        })
    }

    fn note(&mut self, simulation: &mut Simulation) -> Result<(), Error> {
        // Before anything is kept, so that a failure leaves whole rows.
        let states: Vec<ContactState> =
            simulation.contact_forces()?.iter().map(|force| force.state).collect();
        for (history, output) in self.histories.iter_mut().zip(&self.outputs) {
            history.push(simulation.read(output)?);
        }
        if self.follower.passes_edge(self.rows) {
            let here = Linearised::now(simulation);
            self.follower.renew(&here);
            self.linear.push((self.rows, here));
        }
        let changes = simulation.statistics().state_changes();
        let (displacement, velocity) = (simulation.displacement(), simulation.velocity());
        self.follower.row(self.rows, &states, changes, displacement, velocity);
        self.rows += 1;
        for (course, state) in self.states.iter_mut().zip(states) {
            course.push(state);
        }
        Ok(())
    }

    /// The output with the largest variance, of equal ones the first, and its history.
    fn most_moving(&mut self) -> (Variable, Vec<f64>) {
        let variances: Vec<f64> = self.histories.iter().map(|values| variance(values)).collect();
        let most = place_of_largest(&variances).expect("a scene has something that moves");
        (self.outputs.swap_remove(most), self.histories.swap_remove(most))
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn spectrogram(history: &[f64], interval: f64, window: f64, highest: Option<f64>) -> Spectrogram {
    let count = (LONGER * window / interval).round() as usize;
    if count == 0 || count > history.len() {
        return Spectrogram::default();
    }
    let hop = ((history.len() - count) / SPECTRA + 1).max(count / 16);
    let highest = highest.map_or(f64::INFINITY, |highest| ABOVE_HIGHEST * highest);
    Spectrogram::of(history, interval, count, hop, highest)
}
