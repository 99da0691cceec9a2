//! The ways out of uniform sliding: its growing modes or, where none grows, candidates.

use super::super::confirm::{direction, pushes};
use crate::stability::candidates::{Candidate, candidates_at};
use crate::stability::{Linearised, MAX_CONTACTS, Mode, modes};
use crate::watch::Watch;
use amontons::Error;
use amontons::contact::{ContactState, JoinedStates};
use amontons::scene::Scene;
use nalgebra::Complex;
use serde::Serialize;
use std::f64::consts::TAU;

/// Eigenvalues this near, in parts of themselves, are one.
const EQUAL: f64 = 1e-6;

/// The kind of a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WayKind {
    /// A growing mode of uniform sliding.
    Mode,
    /// A growing mode of another contact state, while uniform sliding is stable.
    Candidate,
}

/// A way out of uniform sliding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Way {
    /// The kind of the way.
    pub kind: WayKind,
    /// The number of the mode among all modes of uniform sliding, from 1; or that of the candidate, those that need the least
    /// energy first.
    pub number: usize,
    /// The contact states in which the mode grows, as `Sl-St`.
    pub states: String,
    /// Frequency of the mode, Hz; 0 if it does not oscillate.
    pub frequency: f64,
    /// Growth rate of the mode, 1/s.
    pub growth_rate: f64,
    /// Number of waves of the mode around a ring of equal modules.
    pub waves: Option<usize>,
    /// Number of modes of one eigenvalue for which a candidate stands; 1 for a growing mode, each of which is a way of its own.
    pub copies: usize,
    #[serde(skip)]
    pub(super) contact_states: Vec<ContactState>,
    #[serde(skip)]
    pub(super) source: Source,
}

/// The parts that make a start.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Source {
    /// λ, 1/s, and the shape of the mode, with the angular frequency, rad/s, of the slowest mode that oscillates.
    Mode(Complex<f64>, Vec<Complex<f64>>, f64),
    Candidate(Candidate),
}

/// Ways that are left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Unexamined {
    /// Candidates are sought among all contact states, and this number of contacts has too many.
    Contacts(usize),
    /// Number of candidates beyond the limit; these need more energy than those that are examined.
    Candidates(usize),
}

/// The ways out of the uniform sliding of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Ways {
    /// `true` if modes of uniform sliding grow, and the ways are these modes.
    pub grows: bool,
    /// Modes by their numbers, or candidates by the energy that they need.
    pub ways: Vec<Way>,
    /// Ways that are left out.
    pub unexamined: Option<Unexamined>,
}

/// One start.
pub(super) struct Start {
    /// Displacements from the equilibrium, m.
    pub displacement: Vec<f64>,
    /// Velocities, m/s.
    pub velocity: Vec<f64>,
    /// The largest velocity, m/s.
    pub push: f64,
}

/// Refuses a scene with signals, in which no motion starts from uniform sliding under a constant drive.
///
/// # Errors
/// Returns an error that says what would be right.
pub fn check_undriven(scene: &Scene) -> Result<(), Error> {
    if scene.signals.is_empty() {
        return Ok(());
    }
    Err(Error::argument(format!(
        "{} has signals; the loudness of modes is that of motions which start from uniform sliding under a constant drive: \
         take the signals out of the scene, or follow its one run with `amontons study transient`",
        scene.name
    )))
}

/// The ways out of the uniform sliding of a scene at its µ; at most `most` candidates.
///
/// # Errors
/// Returns an error if there is no equilibrium or no uniform sliding, if modes are not found, or if the watch ended the work.
pub fn ways(scene: &Scene, most: usize, watch: Watch<'_>) -> Result<Ways, Error> {
    let here = Linearised::of(scene);
    let states = here.uniform_sliding()?;
    here.equilibrium()?;
    let found = modes(here.linear()?, &states)?;
    let slowest = found.oscillating.first().map_or(0.0, |mode| mode.eigenvalue.im);
    let growing = found.all().enumerate().filter(|(_, mode)| mode.growth_rate() > 0.0);
    let growing: Vec<Way> =
        growing.map(|(place, mode)| of_mode(place, mode, &states, slowest)).collect();
    if !growing.is_empty() {
        return Ok(Ways { grows: true, ways: growing, unexamined: None });
    }
    let contacts = states.len();
    if contacts > MAX_CONTACTS {
        let unexamined = Some(Unexamined::Contacts(contacts));
        return Ok(Ways { grows: false, ways: Vec::new(), unexamined });
    }
    let mut candidates = candidates_at(scene, watch)?;
    // What no motion can reach is no way.
    candidates.retain(|candidate| candidate.reach.is_some());
    let candidates = joined(candidates);
    let left = candidates.len().saturating_sub(most);
    let ways = candidates.into_iter().take(most).enumerate();
    let ways = ways.map(|(place, (candidate, copies))| Way {
        kind: WayKind::Candidate,
        number: place + 1,
        states: JoinedStates(&candidate.states).to_string(),
        frequency: candidate.at_end[0],
        growth_rate: candidate.at_end[1],
        waves: None,
        copies,
        contact_states: candidate.states.clone(),
        source: Source::Candidate(candidate),
    });
    let unexamined = (left > 0).then_some(Unexamined::Candidates(left));
    Ok(Ways { grows: false, ways: ways.collect(), unexamined })
}

/// Candidates, each with the number of modes of its eigenvalue: pushes along these are one push, since their shapes are any
/// two of one plane.
fn joined(candidates: Vec<Candidate>) -> Vec<(Candidate, usize)> {
    let mut joined: Vec<(Candidate, usize)> = Vec::new();
    for candidate in candidates {
        let is_same = |other: &Candidate| {
            let [frequency, rate] = candidate.at_end;
            let near = EQUAL * (TAU * frequency).hypot(rate);
            other.states == candidate.states
                && TAU * (other.at_end[0] - frequency).abs() <= near
                && (other.at_end[1] - rate).abs() <= near
        };
        match joined.iter_mut().find(|(known, _)| is_same(known)) {
            Some((_, copies)) => *copies += 1,
            None => joined.push((candidate, 1)),
        }
    }
    joined
}

fn of_mode(place: usize, mode: &Mode, states: &[ContactState], slowest: f64) -> Way {
    Way {
        kind: WayKind::Mode,
        number: place + 1,
        states: JoinedStates(states).to_string(),
        frequency: mode.frequency_hz(),
        growth_rate: mode.growth_rate(),
        waves: mode.waves,
        copies: 1,
        contact_states: states.to_vec(),
        source: Source::Mode(mode.eigenvalue, mode.shape.clone(), slowest),
    }
}

impl Way {
    /// The name: `mode 3`, `candidate 1`.
    #[must_use]
    pub fn name(&self) -> String {
        match self.kind {
            WayKind::Mode => format!("mode {}", self.number),
            WayKind::Candidate => format!("candidate {}", self.number),
        }
    }

    /// The key of its pieces in a journal. Candidates are renumbered where others are left out, states are not.
    pub(super) fn key(&self) -> String {
        match self.kind {
            WayKind::Mode => self.name(),
            WayKind::Candidate => {
                format!("candidate {} {:?} Hz {:?}", self.states, self.frequency, self.growth_rate)
            }
        }
    }

    /// The starts along the way. A growing mode has one, with this largest velocity (m/s); a candidate those of
    /// [`confirm`](super::super::confirm).
    pub(super) fn starts(&self, scene: &Scene, push: f64) -> Result<Vec<Start>, Error> {
        match &self.source {
            Source::Mode(lambda, shape, slowest) => Ok(vec![along(*lambda, shape, *slowest, push)]),
            Source::Candidate(candidate) => {
                let (Some(reach), Some(along)) = (candidate.reach, direction(scene, candidate)?)
                else {
                    return Ok(Vec::new());
                };
                let start = |push: f64| Start {
                    displacement: vec![0.0; along.len()],
                    velocity: along.iter().map(|part| push * part).collect(),
                    push,
                };
                Ok(pushes(reach.push, scene).into_iter().map(start).collect())
            }
        }
    }
}

/// The motion Re(a u e^{λt}) at t = 0, whose largest velocity |λ a u| is `push`; u is 1 at its largest. A mode that hardly moves on
/// by itself has no larger displacement than the slowest oscillation with this velocity would have.
fn along(lambda: Complex<f64>, shape: &[Complex<f64>], slowest: f64, push: f64) -> Start {
    let size = push / lambda.norm().max(slowest).max(f64::MIN_POSITIVE);
    Start {
        displacement: shape.iter().map(|part| size * part.re).collect(),
        velocity: shape.iter().map(|part| size * (lambda * part).re).collect(),
        push,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    #[test]
    fn the_growing_mode_of_set_1_is_a_way_and_the_stable_sliding_of_set_2_has_candidates() {
        let set1 = builtin("set1").unwrap().scene();
        let found = ways(&set1, 20, Watch::IDLE).unwrap();
        assert!(found.grows && !found.ways.is_empty());
        assert!(found.ways.iter().all(|way| way.growth_rate > 0.0 && way.states == "Sl-Sl"));
        let mut set2 = builtin("set2").unwrap().scene();
        set2.friction_coefficient = 1.96;
        let found = ways(&set2, 20, Watch::IDLE).unwrap();
        assert!(!found.grows && found.unexamined.is_none());
        assert!(found.ways.iter().any(|way| way.states.contains("St")));
        let all = found.ways.len();
        let first = ways(&set2, 1, Watch::IDLE).unwrap();
        assert_eq!(first.unexamined, Some(Unexamined::Candidates(all - 1)));
        set2.friction_coefficient = 0.0;
        assert_eq!(ways(&set2, 20, Watch::IDLE).unwrap().ways, []);
    }

    /// Equal parts of a structure that do not touch have their eigenvalues several times.
    #[test]
    fn candidates_of_one_eigenvalue_are_one_way_that_counts_them() {
        let mut set2 = builtin("set2").unwrap().scene();
        set2.friction_coefficient = 1.96;
        let mut all = candidates_at(&set2, Watch::IDLE).unwrap();
        assert!(all.len() > 1 && joined(all.clone()).iter().all(|(_, copies)| *copies == 1));
        // An eigenvalue that comes twice has the rounding of two computations.
        let mut again = all[0].clone();
        again.at_end[0] *= 1.0 + 1e-9;
        all.insert(1, again);
        // The same numbers in another state are another candidate.
        let mut other = all[0].clone();
        other.states.reverse();
        all.push(other);
        let found = joined(all.clone());
        assert_eq!(found.len(), all.len() - 1);
        assert_eq!(found[0], (all[0].clone(), 2));
        assert!(found[1..].iter().all(|(_, copies)| *copies == 1));
    }

    #[test]
    fn a_start_is_a_motion_of_its_mode_with_the_velocity_that_was_asked_for() {
        let (lambda, shape) =
            (Complex::new(3.0, 40.0), [Complex::new(1.0, 0.0), Complex::new(0.2, -0.5)]);
        let start = along(lambda, &shape, 10.0, 2e-3);
        let a = 2e-3 / lambda.norm();
        assert!((start.displacement[0] - a).abs() < 1e-18);
        // Re(λ u) of the second one is 3·0.2 + 40·0.5.
        assert!((start.velocity[1] - a * (0.6 + 20.0)).abs() < 1e-15);
        let slow = along(Complex::new(1e-9, 0.0), &shape, 10.0, 2e-3);
        assert!((slow.displacement[0] - 2e-4).abs() < 1e-16);
    }
}
