//! Confirmation of candidates: pushes along the mode of a candidate, followed to their ends, show whether a motion
//! takes the candidate's contact state and stays.

use super::Watch;
use super::held::{Held, ROUNDING};
use super::long_term::{Kind, LongTermMotion};
use super::observation::{ObservationRequest, ObservationSettings};
use super::push::closed_normals;
use super::settling::run_to_steady_state;
use super::visit::{Visited, visited};
use crate::stability::candidates::Candidate;
use crate::stability::parallel::collect;
use crate::stability::{Linearised, modes};
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::{Contact, LumpedModel};
use amontons::numerics::max_norm;
use amontons::scene::Scene;
use amontons::simulation::Simulation;

/// The fewest pushes: up to a hundred times the least one that a candidate's state asks for.
const FEWEST_PUSHES: usize = 5;
/// Pushes go on until one is this many times as fast as the fastest surface.
const FAST: f64 = 10.0;
/// Places in the candidate's range of µ, from its end, where the mode grows most, to its start.
pub const PLACES: [f64; 3] = [0.98, 0.6, 0.2];

/// A push and the ending of its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// µ.
    pub friction: f64,
    /// The largest velocity that it gave a degree of freedom, m/s.
    pub push: f64,
    /// The ending of the motion, or the reason of its failure.
    pub ending: Result<LongTermMotion, String>,
    /// The states that contacts took together in that motion; `None` for a motion that rests or has not settled.
    pub visited: Option<Visited>,
}

impl Attempt {
    /// `true` where the motion has settled and does not come to rest.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.ending.as_ref().is_ok_and(|ending| ending.kind.is_cycle())
    }

    /// `true` where the motion is one at a µ of the candidate's range, does not come to rest, and contacts take the
    /// candidate's states in it.
    #[must_use]
    pub fn meets(&self, candidate: &Candidate) -> bool {
        let [from, to] = candidate.range;
        (from..=to).contains(&self.friction)
            && self.visited.as_ref().is_some_and(|visited| visited.has(&candidate.states))
    }
}

/// The pushes that were tried for a candidate. They end with the first one that met it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Attempts in the order in which they were made.
    pub attempts: Vec<Attempt>,
    /// The push that met the candidate: one of its own or, where none of those did, one of another candidate.
    pub met: Option<Attempt>,
    /// The longest time that a motion may take to settle, s.
    pub longest: f64,
    /// The output whose amplitude is given.
    pub of: String,
}

impl Tried {
    /// Number of attempts that ended in rest, that ended in another motion, that had not settled, and that failed.
    #[must_use]
    pub fn count(&self) -> [usize; 4] {
        let mut count = [0; 4];
        for attempt in &self.attempts {
            count[match &attempt.ending {
                Ok(ending) if ending.rests() => 0,
                Ok(ending) if ending.kind == Kind::Unsettled => 2,
                Ok(_) => 1,
                Err(_) => 3,
            }] += 1;
        }
        count
    }
}

/// Pushes the scene along each candidate's mode, at a few µ of its range, out of the equilibrium; on all cores. `None`
/// if the watch ended it. The scene has no signals.
///
/// # Errors
/// Returns an error if the scene cannot be observed.
pub fn confirm(
    scene: &Scene,
    candidates: &[&Candidate],
    watch: Watch<'_>,
) -> Result<Option<Vec<Tried>>, Error> {
    #[allow(clippy::cast_precision_loss)]
    let done = |done: usize| (watch.progress)(done as f64 / candidates.len() as f64);
    let found = collect(candidates.len(), &|i| tried(scene, candidates[i], watch), &done)?;
    let Some(mut found) = found.into_iter().collect::<Option<Vec<Tried>>>() else {
        return Ok(None);
    };
    let all: Vec<Attempt> = found.iter().flat_map(|tried| tried.attempts.clone()).collect();
    for (tried, candidate) in found.iter_mut().zip(candidates) {
        if tried.met.is_none() {
            tried.met = all.iter().find(|attempt| attempt.meets(candidate)).cloned();
        }
    }
    Ok(Some(found))
}

fn tried(scene: &Scene, candidate: &Candidate, watch: Watch<'_>) -> Result<Option<Tried>, Error> {
    let mut found = Tried { attempts: Vec::new(), met: None, longest: 0.0, of: String::new() };
    let Some(reach) = candidate.reach else { return Ok(Some(found)) };
    let [from, to] = candidate.range;
    for place in PLACES {
        let friction = from + (to - from) * place;
        let mut scene = Scene { friction_coefficient: friction, ..scene.clone() };
        scene.rest();
        let observation = ObservationSettings::paced(&mut scene, &ObservationRequest::default())?;
        (found.longest, found.of) =
            (found.longest.max(observation.longest), observation.of.clone());
        let Some(along) = direction(&scene, candidate)? else { continue };
        for push in pushes(reach.push, &scene) {
            let attempt = match run(&scene, &along, push, &observation, watch) {
                Ok(None) => return Ok(None),
                Ok(Some((ending, visited))) => {
                    Attempt { friction, push, ending: Ok(ending), visited }
                }
                Err(error) => {
                    Attempt { friction, push, ending: Err(error.to_string()), visited: None }
                }
            };
            found.met = attempt.meets(candidate).then(|| attempt.clone());
            found.attempts.push(attempt);
            if found.met.is_some() {
                return Ok(Some(found));
            }
        }
    }
    Ok(Some(found))
}

/// Pushes, m/s: 1, 3, 10, 30, … times the least one.
pub(super) fn pushes(least: f64, scene: &Scene) -> Vec<f64> {
    let model = LumpedModel::from(scene);
    let speed = |contact: &Contact| contact.surface_velocity.abs();
    let fastest = model.contacts.iter().map(speed).fold(0.0, f64::max);
    let mut pushes = vec![least];
    while pushes.len() < FEWEST_PUSHES || least > 0.0 && pushes[pushes.len() - 1] < FAST * fastest {
        let factor = if pushes.len() % 2 == 1 { 3.0 } else { 10.0 };
        let before = pushes[(pushes.len() - 1) / 2 * 2];
        pushes.push(factor * before);
    }
    pushes
}

/// The velocities of the candidate's growing mode, the largest 1, in the sense that brings contacts into the state: along
/// the surface's velocity where they are to stick, off the surface where they are to open, and towards it where those that
/// are open at rest are to close. `None` where the mode does not grow here.
pub(super) fn direction(scene: &Scene, candidate: &Candidate) -> Result<Option<Vec<f64>>, Error> {
    let here = Linearised::of(scene);
    let found = modes(here.linear()?, &candidate.states)?;
    let miss = |frequency: f64| (frequency - candidate.frequency_hz).abs();
    let mode = found
        .all()
        .filter(|mode| mode.growth_rate() > 0.0)
        .min_by(|a, b| miss(a.frequency_hz()).total_cmp(&miss(b.frequency_hz())));
    let Some(mode) = mode else { return Ok(None) };
    let mut along: Vec<f64> = mode.shape.iter().map(|part| part.re).collect();
    let resting = here.resting_state();
    let contacts = || here.model().contacts.iter().zip(&resting).zip(&candidate.states);
    let inwards: f64 = contacts()
        .map(|((contact, at_rest), state)| match (at_rest, state) {
            (ContactState::Detached, ContactState::Detached) => 0.0,
            (ContactState::Detached, _) => -contact.normal.dot(&along),
            (_, ContactState::Detached) => contact.normal.dot(&along),
            _ => contact.tangent.dot(&along) * contact.surface_velocity.signum(),
        })
        .sum();
    if inwards < 0.0 {
        along.iter_mut().for_each(|part| *part = -*part);
    }
    let fastest = max_norm(&along);
    let along = off_surfaces(&here, &along)?;
    let largest = max_norm(&along);
    // All that is left of a push into surfaces that hold every motion is rounding.
    let is_push = largest > ROUNDING * fastest;
    Ok(is_push.then(|| along.iter().map(|part| part / largest).collect()))
}

/// The velocity that is left of another one where surfaces of closed contacts hold what leads into them, the most inward first: off one
/// surface it may lead into another that was free before. Along normals it may lead off surfaces.
fn off_surfaces(here: &Linearised, velocity: &[f64]) -> Result<Vec<f64>, Error> {
    let mut held = Held::none(&here.model().mass)?;
    let mut free = closed_normals(here);
    let mut along = velocity.to_vec();
    loop {
        let inwards = free.iter().map(|normal| normal.dot(&along)).enumerate();
        match inwards.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((place, most)) if most < 0.0 => held.hold(free.swap_remove(place)),
            _ => return Ok(along),
        }
        along = held.nearest(velocity);
    }
}

/// Pushes the scene and follows the motion to its end. Returns that motion and, if it persists, the states that
/// contacts take together in it.
fn run(
    scene: &Scene,
    along: &[f64],
    push: f64,
    observation: &ObservationSettings,
    watch: Watch<'_>,
) -> Result<Option<(LongTermMotion, Option<Visited>)>, Error> {
    let mut simulation = Simulation::new(scene.clone(), 0.0)?;
    for (dof, part) in along.iter().enumerate().filter(|(_, part)| **part != 0.0) {
        simulation.push(dof, push * part);
    }
    let is_over = || watch.is_over();
    let Some(ending) = run_to_steady_state(&mut simulation, observation, &is_over)? else {
        return Ok(None);
    };
    let is_cycle = ending.kind.is_cycle();
    let visited = is_cycle.then(|| visited(&simulation, observation, ending.period)).transpose()?;
    Ok(Some((ending, visited)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::candidates::bistability;
    use amontons::scene::{builtin, parse};

    /// A ring of two modules that differ squeals with one contact stuck while the other slides.
    #[test]
    fn one_contact_that_sticks_while_the_other_slides_is_met_where_modules_differ() {
        let text = "[slider]\nvelocity = 0.03\nangle = 0.5\n[friction]\ncoefficient = 1.8\n\
                    [damping]\nbeta = 3e-5\n[ring]\nmodules = 2\nm1 = [0.3, 0.32]\nm2 = [0.7, 0.68]\n\
                    k1 = 55e3\nk2 = 53e3\nk3 = 22e3\nk4 = [60e3, 58e3]\nk5 = 300e3\nk6 = [250e3, 240e3]\n\
                    preload = [5e-3, 4.8e-3]\n[integrator]\nstep = 1e-6\n\
                    [experiment]\nstop_time = 2.0\noutput_interval = 2e-4\n";
        let scene = parse("unequal", text).unwrap();
        let found = bistability(&scene, [1.0, 1.8], Watch::IDLE).unwrap();
        let states = [ContactState::Slide, ContactState::Stick];
        let candidate = found.candidates.iter().find(|candidate| candidate.states == states);
        let candidate = candidate.unwrap();
        let [tried] = &confirm(&scene, &[candidate], Watch::IDLE).unwrap().unwrap()[..] else {
            panic!()
        };
        let met = tried.met.as_ref().unwrap_or_else(|| panic!("{tried:?}"));
        assert!(met.push >= candidate.reach.unwrap().push && met.friction > 1.0);
    }

    /// The modules of Set 2 are alike, and in its squeal beside rest (the paper's Figs. 6, 7) they stick together.
    #[test]
    fn the_squeal_of_set_2_has_both_contacts_stuck_and_meets_no_state_with_one() {
        let scene = builtin("set2").unwrap().scene();
        let found = bistability(&scene, [1.9, 2.06], Watch::IDLE).unwrap();
        let sticks = |candidate: &&Candidate| candidate.states.contains(&ContactState::Stick);
        let candidate = found.candidates.iter().find(sticks).unwrap();
        let [tried] = &confirm(&scene, &[candidate], Watch::IDLE).unwrap().unwrap()[..] else {
            panic!()
        };
        assert!(tried.met.is_none());
        let squeals = |attempt: &Attempt| {
            attempt.ending.as_ref().is_ok_and(|ending| ending.kind.is_cycle() && ending.taken[2])
        };
        assert!(tried.attempts.iter().any(squeals), "{tried:?}");
    }

    /// A block of 2 kg lies in a groove whose sides are inclined by 0.6 and −0.4 rad. A velocity that is taken off one side alone leads into
    /// the other. The nearest possible velocity is itself, or along a side, or none.
    #[test]
    fn a_push_into_a_groove_leads_into_neither_of_its_sides() {
        let text = "slider = { velocity = 0.5, angle = 0.0 }\nfriction = { coefficient = 0.1 }\n\
             integrator = { step = 1e-6 }\n\
             mass = [{ name = \"block\", mass = 2.0, force = [0.0, -50.0] }]\n\
             spring = [{ name = \"kx\", between = [\"block\", \"ground\"], direction = \"x\", stiffness = 100.0 },\n\
             { name = \"ky\", between = [\"block\", \"ground\"], direction = \"y\", stiffness = 100.0 }]\n\
             contact = [{ name = \"left\", mass = \"block\", angle = -0.4 }, { name = \"right\", mass = \"block\", angle = 0.6 }]\n";
        let here = Linearised::of(&parse("groove", text).unwrap());
        assert_eq!(closed_normals(&here).len(), 2);
        let along = |angle: f64, size: f64| [size * angle.cos(), size * angle.sin()];
        let into = |[x, y]: [f64; 2]| {
            [-0.4_f64, 0.6]
                .map(|angle| x * -angle.sin() + y * angle.cos())
                .into_iter()
                .fold(0.0, f64::min)
        };
        for degree in 0..360 {
            let push = along(f64::from(degree).to_radians(), 1.0);
            let apart = |it: &[f64; 2]| (it[0] - push[0]).hypot(it[1] - push[1]);
            let on_side = |angle: f64| along(angle, push[0] * angle.cos() + push[1] * angle.sin());
            let all = [push, on_side(-0.4), on_side(0.6), [0.0; 2]];
            let possible = all.into_iter().filter(|it| into(*it) > -1e-12);
            let expected = possible.min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
            let found = off_surfaces(&here, &push).unwrap();
            let miss = (found[0] - expected[0]).hypot(found[1] - expected[1]);
            assert!(miss < 1e-9, "{degree}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn pushes_go_on_until_they_are_fast_beside_the_surface() {
        // Its slider moves with 0.025 m/s.
        let scene = builtin("set2").unwrap().scene();
        let near = |found: Vec<f64>, wanted: &[f64]| {
            assert_eq!(found.len(), wanted.len(), "{found:?}");
            assert!(
                found.iter().zip(wanted).all(|(a, b)| (a / b - 1.0).abs() < 1e-12),
                "{found:?}"
            );
        };
        near(pushes(0.02, &scene), &[0.02, 0.06, 0.2, 0.6, 2.0]);
        near(pushes(1e-4, &scene), &[1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3]);
    }
}
