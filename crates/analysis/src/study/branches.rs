//! Branches of periodic motions over a parameter, from known motions, with the branch of uniform sliding.

use super::orbit::{From, solved};
use super::{Journal, ObservationSettings, Watch, drive};
use crate::assign::{assign, value_of};
use crate::orbit::{Branch, Continued, Flow, FlowAt, branch, check_signals};
use crate::stability::candidates::{spread, stable_ranges};
use crate::stability::locus::{ALL_FREQUENCIES, locus};
use crate::stability::{Linearised, linearity_limit, modes};
use amontons::Error;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use serde::{Deserialize, Serialize};

/// Values of the parameter at which uniform sliding is looked at.
const LOOKS: f64 = 200.0;
/// Points of one branch that count as all of its work for the progress.
const USUAL_POINTS: f64 = 150.0;

/// Input of a study of branches.
#[derive(Clone, Debug)]
pub struct BranchQuestion {
    /// The parameter, input or value of a signal ([`assign`]).
    pub name: String,
    /// Its range.
    pub range: [f64; 2],
    /// The motions from which branches begin, each with a label.
    pub starts: Vec<(String, From)>,
    /// Most points of a branch to either side of its start.
    pub most_points: usize,
}

/// A value at which a mode of uniform sliding begins or ceases to grow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RestCrossing {
    /// The value of the parameter.
    pub parameter: f64,
    /// Frequency of the mode, Hz; 0 where it diverges.
    pub frequency_hz: f64,
    /// `true` if the mode grows above the value.
    pub becomes_unstable: bool,
    /// Amplitudes of all degrees of freedom, m, in the largest neutral cycle there: the one in which a contact is about to
    /// leave sliding. `None` where no contact leaves sliding, the mode does not oscillate, or friction depends on the slip
    /// velocity.
    pub neutral_up_to: Option<Vec<f64>>,
}

/// The branch of rest: uniform sliding.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RestBranch {
    /// Ranges of the parameter in which no mode grows.
    pub stable: Vec<[f64; 2]>,
    /// The values at which modes begin or cease to grow.
    pub crossings: Vec<RestCrossing>,
}

/// Results of a study of branches.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Branches {
    /// The branches, one for each start; or the reason why a start has none.
    pub branches: Vec<Result<Branch, String>>,
    /// The branch of rest, or the reason why it is not known.
    pub rest: Result<RestBranch, String>,
}

/// Follows the branches of all starts over the range, and uniform sliding. `None` if the watch ended it.
///
/// # Errors
/// Returns an error if the parameter cannot have a value of the range, or the journal cannot be written.
#[allow(clippy::cast_precision_loss)]
pub fn branches(
    scene: &Scene,
    observation: &ObservationSettings,
    question: &BranchQuestion,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Branches>, Error> {
    let BranchQuestion { name, range, starts, most_points } = question;
    let scene = &drive::without_silent_sines(scene, Some(name));
    let scene_at = |value: f64| -> Result<Scene, Error> {
        let mut scene = scene.clone();
        assign(&mut scene, name, value)?;
        Ok(scene)
    };
    for value in range {
        scene_at(*value)?.check()?;
    }
    let here = value_of(scene, name)?.clamp(range[0], range[1]);
    // Each branch would be refused for it behind its first motion.
    check_signals(&scene_at(here)?, 0.0)?;
    let flow_at: &FlowAt<'_> = &|value| Flow::of(&mut Simulation::new(scene_at(value)?, 0.0)?);
    let mut found = Vec::new();
    for (place, (label, from)) in starts.iter().enumerate() {
        let done = |part: f64| (watch.progress)((place as f64 + part) / starts.len() as f64);
        let inner = Watch { progress: &|part| done(0.3 * part), ..watch };
        let piece = journal.piece(&format!("branch from {label}"), || {
            let first = match solved(&scene_at(here)?, observation, from, journal, inner) {
                Ok(Some(first)) => first,
                Ok(None) => return Ok(None),
                Err(unfound) => return Ok(Some(Err(unfound.error.to_string()))),
            };
            let (_, chain) = first;
            let continued = Continued {
                flow_at,
                range: *range,
                most_points: *most_points,
                goes_on: &|points| {
                    let part = points as f64 / (points as f64 + USUAL_POINTS);
                    !watch.is_over() && {
                        done(0.3 + 0.7 * part);
                        true
                    }
                },
            };
            Ok(match branch(&continued, &chain, here) {
                Ok(Some(branch)) => Some(Ok(branch)),
                Ok(None) => None,
                Err(error) => Some(Err(error.to_string())),
            })
        })?;
        let Some(piece) = piece else { return Ok(None) };
        found.push(piece);
    }
    let rest = rest_branch(&scene_at, *range).map_err(|error| error.to_string());
    Ok(Some(Branches { branches: found, rest }))
}

/// Uniform sliding over the range.
fn rest_branch(
    scene_at: &(dyn Fn(f64) -> Result<Scene, Error> + Sync),
    range: [f64; 2],
) -> Result<RestBranch, Error> {
    let model_at = |value: f64| Ok(Linearised::of(&scene_at(value)?));
    let first = model_at(range[0])?;
    let states = first.uniform_sliding()?;
    // Between the ends the pattern of closed contacts may change and come back.
    let looked_at = spread(range, LOOKS);
    for value in &looked_at {
        let there = model_at(*value)?;
        if there.equilibrium().is_ok() {
            there.equilibrium_in(&states)?;
        }
    }
    let found = locus(&model_at, &states, &looked_at, ALL_FREQUENCIES, &|_, _| {})?;
    let mut crossings = Vec::new();
    for crossing in &found.crossings {
        let there = model_at(crossing.value)?;
        let linear = there.linear()?;
        let all = modes(linear, &states)?;
        let pulsation = std::f64::consts::TAU * crossing.frequency_hz;
        let off = |value: f64| (value - pulsation).abs();
        let mode = all.all().min_by(|a, b| off(a.eigenvalue.im).total_cmp(&off(b.eigenvalue.im)));
        let has_family =
            crossing.frequency_hz > 0.0 && there.model().law.friction.info().is_constant();
        let neutral_up_to = mode.filter(|_| has_family).and_then(|mode| {
            let limit = linearity_limit(linear, there.equilibrium().ok()?, mode)?;
            let by_shape = limit.amplitude / mode.shape[limit.dof].norm();
            Some(mode.shape.iter().map(|part| by_shape * part.norm()).collect())
        });
        crossings.push(RestCrossing {
            parameter: crossing.value,
            frequency_hz: crossing.frequency_hz,
            becomes_unstable: crossing.becomes_unstable,
            neutral_up_to,
        });
    }
    Ok(RestBranch { stable: stable_ranges(&found), crossings })
}
