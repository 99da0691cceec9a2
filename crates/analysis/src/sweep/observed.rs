//! Observation of a run: outputs by their names, and rows near enough to each other for the scene's fastest mode.

use crate::stability::Linearised;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::{Scene, Signal, did_you_mean};
use amontons::simulation::catalogue::{Causality, Kind, Quantity};
use amontons::simulation::{Variable, dof_of, variables};
use amontons::stability::{Spectrum, highest_frequency};
use std::f64::consts::TAU;

/// Rows in a period of the fastest mode: a turn between them is then known to 1e-5 of the amplitude.
pub(crate) const ROWS_A_PERIOD: f64 = 20.0;
/// Rows of the paper's scheme are whole steps apart where that takes no more than this many times the rows that are
/// needed.
const MORE_ROWS: f64 = 4.0;

/// An output of a scene that can be followed: a displacement, a velocity, a force; no state and no count.
///
/// # Errors
/// Returns an error if there is no output of that name; it gives the nearest name, or all names.
pub fn output(scene: &Scene, name: &str) -> Result<Variable, Error> {
    let is_followed = |variable: &Variable| {
        variable.causality == Causality::Output
            && matches!(variable.template.kind, Kind::Real { .. })
    };
    let mut outputs: Vec<Variable> = variables(scene).into_iter().filter(is_followed).collect();
    if let Some(place) = outputs.iter().position(|output| output.name == name) {
        return Ok(outputs.swap_remove(place));
    }
    let meant = did_you_mean(name, outputs.iter().map(|output| &*output.name));
    let help =
        meant.unwrap_or_else(|| "`amontons simulate` writes the outputs as columns".to_owned());
    Err(Error::argument(format!("{} has no output {name}; {help}", scene.name)))
}

/// The displacements that are outputs, in the order of variables. Of a superelement only the nodes and modes that
/// `[outputs]` shows have some.
///
/// # Errors
/// Returns an error if the scene shows none.
pub fn displacements(scene: &Scene) -> Result<Vec<Variable>, Error> {
    let is_displacement =
        |variable: &Variable| variable.template.quantity == Quantity::Displacement;
    let found: Vec<Variable> = variables(scene).into_iter().filter(is_displacement).collect();
    if found.is_empty() {
        return Err(Error::scene(format!(
            "{} shows no displacement that can be followed: name nodes or modes in its [outputs], such as \
             nodes = [\"pad.17\"]",
            scene.name
        )));
    }
    Ok(found)
}

/// The name of the displacement with which the degrees of freedom that are shown begin.
///
/// # Errors
/// Returns the error of [`displacements`].
pub fn first_displacement(scene: &Scene) -> Result<String, Error> {
    let shown = displacements(scene)?;
    let first = shown.into_iter().min_by_key(|variable| dof_of(scene, variable));
    Ok(first.map(|variable| variable.name).unwrap_or_default())
}

/// The unit of an output.
#[must_use]
pub fn unit(output: &Variable) -> &'static str {
    match output.template.kind {
        Kind::Real { unit, .. } => unit,
        _ => "1",
    }
}

/// The frequencies of the slowest and the fastest mode or sine of a signal, Hz: of the state that the scene can rest in
/// and, where it is known, of all states. `None` where nothing oscillates.
pub(crate) fn frequencies(scene: &Scene) -> Option<[f64; 2]> {
    frequencies_in(scene, &Linearised::resting_state)
}

/// The frequencies of [`frequencies`]; where nothing oscillates at rest, as on a surface that stands still, those of sliding.
pub(crate) fn frequencies_in_motion(scene: &Scene) -> Option<[f64; 2]> {
    let sliding = |here: &Linearised| vec![ContactState::Slide; here.model().contacts.len()];
    frequencies(scene).or_else(|| frequencies_in(scene, &sliding))
}

fn frequencies_in(
    scene: &Scene,
    states: &dyn Fn(&Linearised) -> Vec<ContactState>,
) -> Option<[f64; 2]> {
    let here = Linearised::of(scene);
    let model = here.model();
    let linear = here.linear().unwrap_or_else(|_| model.with_greatest_friction());
    let spectrum = Spectrum::of(linear, &states(&here)).ok()?;
    let slowest = spectrum.oscillating.first()?.im / TAU;
    let fastest = spectrum.oscillating.last()?.im / TAU;
    let bound = highest_frequency(model).map_or(fastest, |bound| bound / TAU);
    // A motion follows what drives it, too.
    let sines = scene.signals.iter().filter_map(Signal::frequency);
    let range = [slowest, fastest.max(bound)];
    Some(sines.fold(range, |[low, high], frequency| [low.min(frequency), high.max(frequency)]))
}

/// Time between two observed rows of a run, s: the longest whole part (1/1, 1/2, 1/3, …) of an output interval of which
/// the period of the scene's fastest mode has 20; of a run in steps a whole number of steps where that is possible.
#[must_use]
pub fn interval(scene: &Scene, output_interval: f64) -> f64 {
    let longest = frequencies_in_motion(scene)
        .map_or(f64::INFINITY, |[_, fastest]| 1.0 / (ROWS_A_PERIOD * fastest));
    // A whole number but for rounding is that number.
    let fewest = (output_interval / longest * (1.0 - 1e-9)).ceil().max(1.0);
    let is_whole = |parts: &f64| {
        let steps = output_interval / parts / scene.step;
        steps >= 0.5 && (steps - steps.round()).abs() <= 1e-9 * steps
    };
    let mut parts = (0..).map(|more| fewest + f64::from(more));
    let parts = parts.by_ref().take_while(|parts| *parts <= MORE_ROWS * fewest).find(is_whole);
    output_interval / parts.unwrap_or(fewest)
}
