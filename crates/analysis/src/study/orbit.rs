//! One periodic motion of a scene, from a run, from the boundary between two motions, or from a known orbit.

use super::long_term::{Kind, LongTermMotion};
use super::observation::ObservationSettings;
use super::perturbation::{Direction, perturbation};
use super::settling::run_to_steady_state;
use super::{Journal, Push, Watch, drive};
use crate::orbit::{Flow, NoOrbit, Orbit, Start, search};
use amontons::Error;
use amontons::integrator::Motion;
use amontons::scene::Scene;
use amontons::simulation::Simulation;

use super::initial::starting_from;

/// The motion from which an orbit is looked for.
#[derive(Clone, Debug)]
pub enum From {
    /// What the scene settles into from its own start, with a push where that is at rest.
    Run,
    /// A run from the boundary between two motions, over the values of one initial value: it stays near an unstable
    /// orbit for a while.
    Boundary(Direction),
    /// A known orbit of this scene, perhaps with other values.
    Orbit(Box<Orbit>),
}

/// What a search for an orbit has found.
#[derive(Clone, Debug)]
pub struct FoundOrbit {
    /// The orbit.
    pub orbit: Orbit,
    /// The ending of the run that it was found from.
    pub ending: Option<LongTermMotion>,
    /// The boundary that it was found from, in the unit of the initial value.
    pub boundary: Option<[f64; 2]>,
}

/// Parts of the work before the search itself.
const SETTLED: f64 = 0.9;
/// Windows of a run from a boundary in which the nearest return is looked for.
const WINDOWS_NEAR: f64 = 1.0;

/// Finds one periodic motion. `None` if the watch ended it.
///
/// # Errors
/// Returns an error if a run fails, if the scene settles into a motion that is not periodic, or if no orbit is found.
pub fn orbit(
    scene: &Scene,
    observation: &ObservationSettings,
    from: &From,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<FoundOrbit>, Error> {
    let (mut ending, mut boundary) = (None, None);
    let (mut simulation, start) = match from {
        From::Run => {
            let mut simulation = Simulation::new(scene.clone(), 0.0)?;
            if let Some(push) = Push::of_resting(scene) {
                push.give(&mut simulation);
            }
            let Some(found) =
                run_to_steady_state(&mut simulation, observation, &|| watch.is_over())?
            else {
                return Ok(None);
            };
            let period = period_of(&found).ok_or_else(|| no_period(scene, &found))?;
            ending = Some(found);
            // An orbit under a drive begins where the drive does.
            if let Some(drive) = drive::period(&simulation) {
                simulation.advance_to((simulation.time() / drive).ceil() * drive)?;
            }
            let start = Start {
                motion: simulation.motion().clone(),
                period: Some(period),
                longest: period,
            };
            (simulation, start)
        }
        From::Boundary(direction) => {
            let part = |done: f64| (watch.progress)(SETTLED * done);
            let inner = Watch { progress: &part, ..watch };
            let Some(found) = perturbation(scene, direction, observation, journal, inner)? else {
                return Ok(None);
            };
            let threshold = found.thresholds.first().ok_or_else(|| {
                Error::argument(format!(
                    "all motions from {} = {:?} to {:?} end alike, so there is no boundary between them; give a wider \
                     range",
                    direction.name,
                    direction.amplitudes.first().unwrap_or(&0.0),
                    direction.amplitudes.last().unwrap_or(&0.0)
                ))
            })?;
            let [low, high] = threshold.between;
            boundary = Some(threshold.between);
            let value = f64::midpoint(low, high);
            let simulation =
                Simulation::new(starting_from(scene, &[(&direction.name, value)])?, 0.0)?;
            let start = Start {
                motion: simulation.motion().clone(),
                period: drive::period(&simulation),
                longest: WINDOWS_NEAR * observation.window,
            };
            (simulation, start)
        }
        From::Orbit(known) => {
            let simulation = Simulation::new(scene.clone(), 0.0)?;
            let motion = Motion::new(
                known.displacement.clone(),
                known.velocity.clone(),
                known.states.clone(),
            );
            let period = match drive::period(&simulation) {
                // An orbit may take several periods of the drive, whose frequency may have changed.
                Some(drive) => drive * (known.period / drive).round().max(1.0),
                None => known.period,
            };
            let start = Start { motion, period: Some(period), longest: period };
            (simulation, start)
        }
    };
    if watch.ends_after(SETTLED) {
        return Ok(None);
    }
    let mut flow = Flow::of(&mut simulation)?;
    let found = search(&mut flow, &start, &|| !watch.is_over());
    let found = found.map_err(|why| Error::scene(refusal(scene, &why)))?;
    Ok(found.map(|(orbit, _)| FoundOrbit { orbit, ending, boundary }))
}

/// The period of a motion that comes back.
fn period_of(ending: &LongTermMotion) -> Option<f64> {
    ending.period.filter(|_| ending.kind == Kind::Periodic)
}

fn no_period(scene: &Scene, ending: &LongTermMotion) -> Error {
    let name = &scene.name;
    let what = match ending.kind {
        Kind::Equilibrium => "it comes to rest",
        Kind::Unbounded => "it grows without bound",
        Kind::Unsettled => "it has not settled; a larger --longest may show what it becomes",
        Kind::QuasiPeriodic => "it is quasi-periodic: it never comes back",
        Kind::Irregular => "it is irregular: it never comes back",
        Kind::Periodic | Kind::Undecided => "its period is not known",
    };
    Error::scene(format!(
        "the motion of {name} from its start is not periodic: {what}. Other starts: --set initial.NAME=VALUE, a known orbit \
         with --from, or the boundary between two motions with --between"
    ))
}

fn refusal(scene: &Scene, why: &NoOrbit) -> String {
    format!("no periodic motion of {} was found near the start: {why}", scene.name)
}
