//! One periodic motion of a scene, from a run, from the boundary between two motions, or from a known orbit.

use super::initial::{initial_value, starting_from};
use super::long_term::{Kind, LongTermMotion};
use super::observation::ObservationSettings;
use super::perturbation::{Direction, perturbation};
use super::recurrence::CLOSED;
use super::settling::run_to_steady_state;
use super::{Journal, Push, Watch, drive, strobe};
use crate::orbit::{
    Chain, Flow, NoOrbit, Orbit, OrbitEnergy, OrbitStart, Start, check_method, search,
};
use crate::stability::{Linearised, linearity_limit, modes};
use amontons::Error;
use amontons::integrator::Motion;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use std::f64::consts::TAU;

/// The motion from which an orbit is looked for.
#[derive(Clone, Debug)]
pub enum From {
    /// The motion that a run of the scene settles into; a scene that starts at rest gets a small push.
    Run,
    /// A run from the boundary between two motions, over the values of one initial value: it stays near an unstable
    /// orbit for a while.
    Boundary(Direction),
    /// A known orbit of this scene, perhaps with other values, or a motion that nearly comes back.
    Orbit(Box<OrbitStart>),
    /// An oscillating mode of uniform sliding, by its place in the order of frequencies, from 1: just above the amplitude
    /// at which a contact leaves sliding. Where the mode begins to grow, branches begin there.
    Mode(usize),
}

/// Relative accuracy of a boundary: a run from it stays near the orbit until this part has grown.
const BOUNDARY: f64 = 1e-12;

impl From {
    /// The boundary between the motions that two values of an initial value (m or m/s) end in.
    ///
    /// # Errors
    /// Returns an error if the scene has no such initial value.
    pub fn boundary(scene: &Scene, name: &str, [a, b]: [f64; 2]) -> Result<Self, Error> {
        let name = initial_value(scene, name)?;
        let amplitudes = vec![a.min(b), a.max(b)];
        Ok(Self::Boundary(Direction { name, amplitudes, resolution: BOUNDARY }))
    }
}

/// The result of a search for an orbit.
#[derive(Clone, Debug)]
pub struct FoundOrbit {
    /// The orbit.
    pub orbit: Orbit,
    /// The ending of the run that it was found from.
    pub ending: Option<LongTermMotion>,
    /// The boundary that it was found from, in the unit of the initial value.
    pub boundary: Option<[f64; 2]>,
}

/// The reason why no orbit was found.
#[derive(Clone, Debug)]
pub struct Unfound {
    /// The reason.
    pub error: Error,
    /// The motion at which Newton's method ended, if that is the reason ([`NoOrbit::NotConverged`]).
    pub best: Option<Box<OrbitStart>>,
}

impl std::convert::From<Error> for Unfound {
    fn from(error: Error) -> Self {
        Self { error, best: None }
    }
}

/// The part of the work before the search itself.
const SETTLED: f64 = 0.9;
/// Amplitude with which a mode is begun, relative to the one at which a contact leaves sliding.
const ABOVE_LINEAR: f64 = 1.05;
/// Windows of a run from a boundary in which the nearest return is looked for.
const WINDOWS_NEAR: f64 = 1.0;

/// Finds one periodic motion, with its energy if the scene requests it. `None` if the watch ended it.
///
/// # Errors
/// Returns an error if a run fails, if the scene settles into a motion that is not periodic, or if no orbit is found.
pub fn orbit(
    scene: &Scene,
    observation: &ObservationSettings,
    from: &From,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<FoundOrbit>, Unfound> {
    let part = |done: f64| (watch.progress)(SETTLED * done);
    let inner = Watch { progress: &part, ..watch };
    let scene = &drive::without_silent_sines(scene, None);
    let found = solved(scene, observation, from, journal, inner)?;
    Ok(found.map(|(found, _)| found))
}

/// Finds one periodic motion, and its chain of segments.
pub(super) fn solved(
    scene: &Scene,
    observation: &ObservationSettings,
    from: &From,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<(FoundOrbit, Chain)>, Unfound> {
    check_method(scene)?;
    let begun = match from {
        From::Run => Begun::by_run(scene, observation, watch)?,
        From::Boundary(direction) => {
            Begun::at_boundary(scene, observation, direction, journal, watch)?
        }
        From::Orbit(known) => Some(Begun::at_orbit(scene, known)?),
        From::Mode(number) => Some(Begun::in_mode(scene, *number)?),
    };
    let Some(Begun { mut simulation, start, ending, boundary }) = begun else { return Ok(None) };
    let mut flow = Flow::of(&mut simulation)?;
    let found = search(&mut flow, &start, &|| !watch.is_over());
    let found = match ending.as_ref().filter(|ending| period_of(ending).is_none()) {
        Some(ending) => where_the_run_is(&simulation, ending, found)?,
        None => found.map_err(|why| unfound(&simulation, why))?,
    };
    let Some((mut orbit, chain)) = found else { return Ok(None) };
    if scene.effects.energy {
        orbit.energy = OrbitEnergy::of(&orbit, &mut simulation)?;
    }
    Ok(Some((FoundOrbit { orbit, ending, boundary }, chain)))
}

/// A simulation that is near a periodic motion.
struct Begun {
    simulation: Simulation,
    start: Start,
    ending: Option<LongTermMotion>,
    boundary: Option<[f64; 2]>,
}

impl Begun {
    /// Runs the scene until it settles, and begins there. Where the run does not show its period, a multiple of the drive's
    /// period is tried. Returns `None` if the watch ended it.
    fn by_run(
        scene: &Scene,
        observation: &ObservationSettings,
        watch: Watch<'_>,
    ) -> Result<Option<Self>, Error> {
        let mut simulation = Simulation::new(scene.clone(), 0.0)?;
        if let Some(push) = Push::of_resting(scene) {
            push.give(&mut simulation);
        }
        let settled = run_to_steady_state(&mut simulation, observation, &|| watch.is_over())?;
        let Some(ending) = settled else { return Ok(None) };
        let drive = drive::period(&simulation);
        // An orbit under a drive begins where the drive does.
        if let Some(drive) = drive {
            simulation.advance_to((simulation.time() / drive).ceil() * drive)?;
        }
        let period = match (period_of(&ending), drive) {
            (Some(period), Some(drive)) => multiple_of_drive(period, drive),
            (Some(period), None) => period,
            (None, Some(drive)) if may_follow(&ending) && drive <= observation.longest => {
                let longest = observation.longest;
                let period = strobe::nearest_return(&mut simulation, drive, longest, watch)?;
                let Some(period) = period else { return Ok(None) };
                period
            }
            _ => return Err(no_period(scene, &ending, None)),
        };
        let motion = simulation.motion().clone();
        let start = Start { motion, time: 0.0, period: Some(period), longest: period };
        Ok(Some(Self { simulation, start, ending: Some(ending), boundary: None }))
    }

    /// The start from the boundary between two motions.
    fn at_boundary(
        scene: &Scene,
        observation: &ObservationSettings,
        direction: &Direction,
        journal: &Journal,
        watch: Watch<'_>,
    ) -> Result<Option<Self>, Error> {
        let Some(found) = perturbation(scene, direction, observation, journal, watch)? else {
            return Ok(None);
        };
        let threshold = found.thresholds.first().ok_or_else(|| {
            Error::argument(format!(
                "all motions from {} = {:?} to {:?} end alike, so there is no boundary between them; give a wider range",
                direction.name,
                direction.amplitudes.first().unwrap_or(&0.0),
                direction.amplitudes.last().unwrap_or(&0.0)
            ))
        })?;
        let [low, high] = threshold.between;
        let value = f64::midpoint(low, high);
        let simulation = Simulation::new(starting_from(scene, &[(&direction.name, value)])?, 0.0)?;
        let start = Start {
            motion: simulation.motion().clone(),
            time: 0.0,
            period: drive::period(&simulation),
            longest: WINDOWS_NEAR * observation.window,
        };
        Ok(Some(Self { simulation, start, ending: None, boundary: Some(threshold.between) }))
    }

    /// A motion in a mode of uniform sliding, a little larger than what is linear.
    fn in_mode(scene: &Scene, number: usize) -> Result<Self, Error> {
        let linearised = Linearised::of(scene);
        let states = linearised.uniform_sliding()?;
        let linear = linearised.linear()?;
        let found = modes(linear, &states)?;
        let place = number.checked_sub(1).and_then(|place| found.oscillating.get(place));
        let mode = place.ok_or_else(|| {
            Error::argument(format!(
                "{} has {} oscillating modes of uniform sliding; there is no mode {number}",
                scene.name,
                found.oscillating.len()
            ))
        })?;
        let limit = linearity_limit(linear, linearised.equilibrium()?, mode).ok_or_else(|| {
            Error::analysis(format!(
                "mode {number} makes no contact leave sliding, however large it is"
            ))
        })?;
        let scale = ABOVE_LINEAR * limit.amplitude / mode.shape[limit.dof].norm();
        let simulation = Simulation::new(scene.clone(), 0.0)?;
        let displacement = mode.shape.iter().map(|part| scale * part.re).collect();
        let velocity = mode.shape.iter().map(|part| scale * (mode.eigenvalue * part).re).collect();
        let motion = Motion::new(displacement, velocity, states);
        let period = TAU / mode.eigenvalue.im;
        let start = Start { motion, time: 0.0, period: Some(period), longest: period };
        Ok(Self { simulation, start, ending: None, boundary: None })
    }

    /// The beginning of a known orbit.
    fn at_orbit(scene: &Scene, known: &OrbitStart) -> Result<Self, Error> {
        let simulation = Simulation::new(scene.clone(), 0.0)?;
        let period = match drive::period(&simulation) {
            // An orbit may take several periods of the drive, whose frequency may have changed.
            Some(drive) => drive * (known.period / drive).round().max(1.0),
            None => known.period,
        };
        let motion = known.motion();
        let start = Start { motion, time: 0.0, period: Some(period), longest: period };
        Ok(Self { simulation, start, ending: None, boundary: None })
    }
}

/// The period of a motion that comes back.
fn period_of(ending: &LongTermMotion) -> Option<f64> {
    ending.period.filter(|_| ending.kind == Kind::Periodic)
}

/// The multiple of the drive's period (s) that an observed period (s) is but for the accuracy of the observation; the
/// observed period where it is none, as of a motion that does not feel the drive.
fn multiple_of_drive(period: f64, drive: f64) -> f64 {
    let multiple = drive * (period / drive).round();
    if (multiple / period - 1.0).abs() <= CLOSED { multiple } else { period }
}

/// `true` if a motion whose period was not seen may still follow its drive.
fn may_follow(ending: &LongTermMotion) -> bool {
    matches!(ending.kind, Kind::Undecided | Kind::Unsettled) || ending.follows
}

/// The orbit that was looked for with a multiple of the drive's period, if it is the one that the run has come to.
#[allow(clippy::type_complexity)]
fn where_the_run_is(
    simulation: &Simulation,
    ending: &LongTermMotion,
    found: Result<Option<(Orbit, Chain)>, NoOrbit>,
) -> Result<Option<(Orbit, Chain)>, Unfound> {
    let refused = |why: &str| no_period(simulation.scene(), ending, Some(why));
    let (orbit, chain) = match found {
        Ok(Some(found)) => found,
        Ok(None) => return Ok(None),
        Err(why) => {
            let tried = format!("with whole periods of its drive, {}", why.words(simulation));
            let error = refused(&tried);
            return Err(Unfound { error, best: why.best() });
        }
    };
    let size = orbit.extents.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let off = orbit.start().distance(simulation.motion(), size);
    let but = if off > CLOSED {
        format!("the run is {off:.1e} of its size away from it")
    } else if orbit.is_stable() == Some(false) {
        "it is unstable, so the run does not stay on it".to_owned()
    } else {
        return Ok(Some((orbit, chain)));
    };
    let period = orbit.period;
    let why =
        format!("Newton's method finds a periodic motion of {period:.6e} s near it, but {but}");
    Err(refused(&why).into())
}

/// The error for a motion without a period; `tried` is the reason why a multiple of the drive's period is none either.
fn no_period(scene: &Scene, ending: &LongTermMotion, tried: Option<&str>) -> Error {
    let name = &scene.name;
    let what = match ending.kind {
        Kind::Equilibrium => "it comes to rest",
        Kind::Unbounded => "it grows without bound",
        Kind::Unsettled => {
            "it has not settled; a larger --longest or --window may show what it becomes"
        }
        Kind::QuasiPeriodic => "it is quasi-periodic: it never comes back",
        Kind::Irregular => "it is irregular: it never comes back",
        Kind::Periodic | Kind::Undecided => {
            "its period is not known; a longer --window, or a larger --longest, may show it"
        }
    };
    let tried = tried.map_or_else(String::new, |why| format!("; {why}"));
    Error::analysis(format!(
        "the motion of {name} from its start is not periodic: {what}{tried}. Other starts: --set initial.NAME=VALUE, a known orbit \
         with --from, the boundary between two motions with --between, or a mode with --mode"
    ))
}

fn unfound(simulation: &Simulation, why: NoOrbit) -> Unfound {
    let error = Error::analysis(format!(
        "no periodic motion of {} was found near the start: {}",
        simulation.scene().name,
        why.words(simulation)
    ));
    Unfound { error, best: why.best() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::ObservationRequest;
    use amontons::scene::builtin;

    /// A run may pass near an unstable orbit, or near one that it has not come to.
    #[test]
    fn an_orbit_of_the_drive_is_that_of_the_run_only_if_it_is_there_and_stays() {
        let mut scene = builtin("den_hartog").unwrap().scene();
        let observation = ObservationSettings::paced(&mut scene, &ObservationRequest::default());
        let begun = Begun::by_run(&scene, &observation.unwrap(), Watch::IDLE).unwrap().unwrap();
        let Begun { mut simulation, start, ending, .. } = begun;
        let ending = ending.unwrap();
        let found = search(&mut Flow::of(&mut simulation).unwrap(), &start, &|| true);
        let (mut orbit, chain) = found.unwrap().unwrap();
        let mut refusal = |orbit: &Orbit, later: f64| {
            simulation.advance_to(simulation.time() + later).unwrap();
            let found = Ok(Some((orbit.clone(), chain.clone())));
            let refused = where_the_run_is(&simulation, &ending, found).err();
            refused.map_or_else(String::new, |unfound| unfound.error.to_string())
        };
        assert_eq!(refusal(&orbit, 0.0), "");
        assert!(refusal(&orbit, 0.1).contains("of its size away from it"));
        assert!(refusal(&orbit, 0.3).is_empty());
        orbit.multipliers[0] = [1.5, 0.0];
        assert!(refusal(&orbit, 0.0).contains("it is unstable"));
    }
}
