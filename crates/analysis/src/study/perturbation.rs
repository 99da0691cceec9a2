//! The response to perturbations: the ending of a scene from each of many initial values, and the thresholds between.

use super::attractor::attractors;
use super::initial::{initial_value, starting_from};
use super::long_term::LongTermMotion;
use super::observation::ObservationSettings;
use super::settling::run_to_steady_state;
use super::{Journal, Watch};
use crate::stability::parallel::collect;
use crate::sweep::range::decimal;
use amontons::Error;
use amontons::numerics::max_norm;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A threshold is found relative to itself, or to this part of the largest perturbation: it may be at zero.
const SMALLEST: f64 = 1e-3;

/// The initial value that is varied, and its range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Direction {
    /// An initial value of the scene, in full.
    pub name: String,
    /// Amplitudes of the initial value, ascending; m or m/s.
    pub amplitudes: Vec<f64>,
    /// Thresholds are found to this part of themselves.
    pub resolution: f64,
}

/// The result of one perturbation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// The initial value, m or m/s.
    pub amplitude: f64,
    /// The ending of the motion; `None` if it failed.
    pub ending: Option<LongTermMotion>,
    /// The reason of a failure.
    pub failure: Option<String>,
    /// The attractor of the motion; `None` if it has not settled, or failed.
    pub attractor: Option<usize>,
}

/// A perturbation above which a scene ends in something else.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Threshold {
    /// Initial values between which the threshold lies.
    pub between: [f64; 2],
    /// The attractors below and above.
    pub attractors: [usize; 2],
}

/// The results of perturbations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Perturbations {
    /// One ending of each attractor: rest first, then cycles by amplitude.
    pub attractors: Vec<LongTermMotion>,
    /// Runs by amplitude; those that the thresholds were found with included.
    pub runs: Vec<Run>,
    /// Thresholds by amplitude.
    pub thresholds: Vec<Threshold>,
}

/// Runs the scene from each initial value until it is settled, and bisects between neighbours that end in different
/// attractors. The scene's other initial values stay as they are. `None` if the watch ended it: what was finished is
/// in the journal.
///
/// # Errors
/// Returns an error if there is no such initial value, one is impossible, or the journal cannot be written. A run
/// that fails is recorded in its place.
pub fn perturbation(
    scene: &Scene,
    direction: &Direction,
    observation: &ObservationSettings,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Perturbations>, Error> {
    let name = initial_value(scene, &direction.name)?;
    if !(1e-12..1.0).contains(&direction.resolution) {
        return Err(Error::argument(format!(
            "the relative resolution of thresholds cannot be {}; give a --resolution from 1e-12 to below 1, such as 1e-3",
            direction.resolution
        )));
    }
    for &amplitude in &direction.amplitudes {
        Simulation::new(starting_from(scene, &[(&name, amplitude)])?, 0.0)?;
    }
    let largest = max_norm(&direction.amplitudes);
    let width = |[a, b]: [f64; 2]| {
        direction.resolution * f64::max(a.abs(), b.abs()).max(SMALLEST * largest)
    };
    let done = AtomicUsize::new(0);
    let run = |amplitude: f64, all: usize| {
        let piece = journal.piece(&format!("{amplitude:?}"), || {
            let scene = starting_from(scene, &[(&name, amplitude)])?;
            match Simulation::new(scene, 0.0).and_then(|mut simulation| {
                run_to_steady_state(&mut simulation, observation, &|| watch.is_over())
            }) {
                Ok(ending) => Ok(ending.map(Ok)),
                Err(error) => Ok(Some(Err(error.to_string()))),
            }
        })?;
        #[allow(clippy::cast_precision_loss)]
        (watch.progress)((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / all as f64);
        Ok(piece.map(|ending: Result<LongTermMotion, String>| {
            let failure = ending.as_ref().err().cloned();
            Run { amplitude, ending: ending.ok(), failure, attractor: None }
        }))
    };
    let mut runs: Vec<Run> = Vec::new();
    let mut next = direction.amplitudes.clone();
    // A guess, until the first neighbours are known.
    let mut to_come = 10;
    while !next.is_empty() {
        let all = runs.len() + next.len().max(to_come);
        let made = collect(next.len(), &|i| run(next[i], all), &|_| {})?;
        let Some(made) = made.into_iter().collect::<Option<Vec<Run>>>() else { return Ok(None) };
        runs.extend(made);
        runs.sort_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
        let (_, places) = attractors(runs.iter().map(|run| run.ending.as_ref()));
        for (run, place) in runs.iter_mut().zip(places) {
            run.attractor = place;
        }
        let thresholds = thresholds(&runs);
        let open = thresholds.iter().map(|threshold| threshold.between);
        let open: Vec<[f64; 2]> = open.filter(|&[a, b]| b - a > width([a, b])).collect();
        to_come = open.iter().map(|&[a, b]| halvings(b - a, width([a, b]))).sum();
        next = open.iter().map(|[a, b]| decimal(0.5 * (a + b))).collect();
    }
    let (attractors, _) = attractors(runs.iter().map(|run| run.ending.as_ref()));
    Ok(Some(Perturbations { attractors, thresholds: thresholds(&runs), runs }))
}

/// Thresholds between neighbours that end in different attractors.
fn thresholds(runs: &[Run]) -> Vec<Threshold> {
    let threshold = |two: &[Run]| {
        let attractors = [two[0].attractor?, two[1].attractor?];
        let between = [two[0].amplitude, two[1].amplitude];
        (attractors[0] != attractors[1]).then_some(Threshold { between, attractors })
    };
    runs.windows(2).filter_map(threshold).collect()
}

/// Number of halvings that turn one width into another.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn halvings(from: f64, to: f64) -> usize {
    (from / to).log2().ceil().max(0.0) as usize
}
