//! The probability that a scene squeals after a push: runs of draws, each until its motion has settled.
//!
//! A run starts at rest in the equilibrium of its draw. The push is a velocity in a random [`direction`](super::direction),
//! in which the fastest mass or node has the velocity of the push. Draws of runs are independent, so shares have an exact interval.

use super::direction::direction;
use super::distribution::{Distribution, Draws};
use super::interval::{Estimate, of_share};
use super::sobol::random;
use super::uncertain::{Parameter, scene_with};
use crate::journal::Journal;
use crate::stability::parallel::collect;
use crate::study::{Kind, Prepare, run_to_steady_state};
use crate::watch::Watch;
use amontons::Error;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use serde::{Deserialize, Serialize};

/// Places of the numbers that a run draws.
const VALUES: u64 = 1;
const VELOCITY: u64 = 2;
/// The most runs: their ends are kept in memory.
const MOST_RUNS: u64 = 10_000_000;

/// Runs of a scene after pushes.
pub struct Pushes<'a> {
    /// The scene whose parameters scatter, without signals.
    pub scene: &'a Scene,
    /// The parameters that scatter; there may be none.
    pub parameters: &'a [Parameter],
    /// The velocity that a push gives the fastest mass or node, m/s.
    pub velocity: &'a Draws,
    /// Gives each draw its method and step, and the settings with which its motion is observed.
    pub prepare: Prepare<'a>,
    /// Number of runs, at least one.
    pub runs: u64,
    /// The seed of all draws.
    pub seed: u64,
    /// The name of a run, to which its number is added, among the pieces of work of the study.
    pub name: &'a str,
}

/// How a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// The motion rests or decays to rest.
    Rests,
    /// The motion goes on for ever, or grows without bound.
    Squeals,
    /// The motion had not settled, or is a linear one that nothing damps.
    NotSettled,
    /// There is no equilibrium in which the run could start.
    NoEquilibrium,
    /// The run failed.
    Failed,
}

impl End {
    /// Name of the end in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rests => "rests",
            Self::Squeals => "squeals",
            Self::NotSettled => "not settled",
            Self::NoEquilibrium => "no equilibrium",
            Self::Failed => "failed",
        }
    }
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PushedRun {
    /// The values of the parameters that scatter, in their order.
    pub values: Vec<f64>,
    /// The velocity of the fastest mass or node, m/s.
    pub push: f64,
    /// Its end.
    pub end: End,
    /// The kind of motion in which it ends.
    pub kind: Option<Kind>,
    /// The strongest frequency of a motion that goes on, Hz.
    pub frequency: Option<f64>,
    /// The reason of a failure.
    pub failure: Option<String>,
}

/// The ends of the runs after pushes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Squeals {
    /// The part of the runs that squeal; the interval has those runs whose end is unknown as squeals at its upper end, and
    /// not at its lower one.
    pub probability: Estimate,
    /// The part of the runs that squeal or whose end is unknown.
    pub at_most: f64,
    /// The runs in order.
    pub runs: Vec<PushedRun>,
}

impl Squeals {
    /// Number of runs with this end.
    #[must_use]
    pub fn count(&self, end: End) -> u64 {
        self.runs.iter().filter(|run| run.end == end).count() as u64
    }
}

/// Refuses runs of a scene with signals, and too few or too many.
///
/// # Errors
/// Returns an error that says what would be right.
pub fn check_runs(scene: &Scene, runs: u64) -> Result<(), Error> {
    if !scene.signals.is_empty() {
        return Err(Error::argument(format!(
            "{} has signals, which keep it in motion whether it squeals or not: leave out --pushes, or remove the \
             signals from the scene",
            scene.name
        )));
    }
    match runs {
        0 => Err(Error::argument("0 runs show nothing; give --runs 1 or more, such as 100")),
        1..=MOST_RUNS => Ok(()),
        _ => {
            Err(Error::argument(format!("{runs} runs are too many; give --runs up to {MOST_RUNS}")))
        }
    }
}

/// Draws of the velocity of pushes (m/s), which has no value in the scene.
///
/// # Errors
/// Returns an error if the distribution is a part of a scene's value, or has values below zero.
pub fn push_velocity(pushes: &Distribution) -> Result<Draws, Error> {
    let refused = |why: String| Error::argument(format!("{pushes} of --pushes {why}"));
    if pushes.is_relative() {
        return Err(refused(
            "is a part of a scene's value, which pushes do not have; give numbers, such as uniform(0,0.1)"
                .to_owned(),
        ));
    }
    pushes.draws(0.0, [0.0, f64::INFINITY]).map_err(refused)
}

/// The probability that a scene squeals after a push. `None` if the watch ended the work: finished runs are in the
/// journal.
///
/// # Errors
/// Returns an error if a draw is impossible, if closed contacts hold every direction of motion, or if the journal cannot be
/// written. A run that fails is counted as such.
#[allow(clippy::cast_precision_loss)]
pub fn squeals(
    pushes: &Pushes<'_>,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Squeals>, Error> {
    direction(pushes.scene, pushes.seed, 0)?;
    let work = |place: usize| {
        let number = place as u64;
        journal.piece(&format!("{} {}", pushes.name, number + 1), || pushes.run(number, watch))
    };
    let count = usize::try_from(pushes.runs).unwrap_or(usize::MAX);
    let found = collect(count, &work, &watch.parts(count))?;
    let Some(runs) = found.into_iter().collect::<Option<Vec<PushedRun>>>() else { return Ok(None) };
    let all = runs.len() as u64;
    let count = |ends: &[End]| runs.iter().filter(|run| ends.contains(&run.end)).count() as u64;
    let least = of_share(count(&[End::Squeals]), all);
    let most = of_share(count(&[End::Squeals, End::NotSettled, End::Failed]), all);
    let probability = Estimate { high: most.high, ..least };
    Ok(Some(Squeals { probability, at_most: most.value, runs }))
}

impl Pushes<'_> {
    fn run(&self, number: u64, watch: Watch<'_>) -> Result<Option<PushedRun>, Error> {
        let draw = |what: u64, place: u64| random(self.seed, &[number, what, place]);
        let values = self.parameters.iter().zip(0..);
        let values: Vec<f64> =
            values.map(|(parameter, place)| parameter.at(draw(VALUES, place))).collect();
        let push = self.velocity.at(draw(VELOCITY, 0));
        let mut scene = scene_with(self.scene, self.parameters, &values)?;
        scene.rest();
        let along = direction(&scene, self.seed, number)?;
        let ending = (|| {
            let observation = (self.prepare)(&mut scene)?;
            let mut simulation = Simulation::new(scene, 0.0)?;
            for (dof, part) in along.iter().enumerate().filter(|(_, part)| **part != 0.0) {
                simulation.push(dof, push * part);
            }
            run_to_steady_state(&mut simulation, &observation, &|| watch.is_over())
        })();
        let none = PushedRun {
            values,
            push,
            end: End::Failed,
            kind: None,
            frequency: None,
            failure: None,
        };
        Ok(match ending {
            Ok(None) => None,
            Ok(Some(ending)) => Some(PushedRun {
                end: match ending.kind {
                    _ if ending.rests() => End::Rests,
                    Kind::Unsettled => End::NotSettled,
                    _ if !ending.is_known() => End::NotSettled,
                    _ => End::Squeals,
                },
                kind: Some(ending.kind),
                frequency: ending.frequency.filter(|_| !ending.rests()),
                ..none
            }),
            Err(error) if error.is_equilibrium() => {
                Some(PushedRun { end: End::NoEquilibrium, ..none })
            }
            Err(error) => Some(PushedRun { failure: Some(error.to_string()), ..none }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Distribution;
    use super::*;
    use crate::study::{ObservationRequest, ObservationSettings};
    use amontons::scene::builtin;

    fn found(scene: &Scene, velocity: &str, runs: u64) -> Squeals {
        let velocity = Distribution::parse(velocity).unwrap();
        let velocity = velocity.draws(0.0, [0.0, f64::INFINITY]).unwrap();
        let prepare =
            |scene: &mut Scene| ObservationSettings::paced(scene, &ObservationRequest::default());
        let pushes = Pushes {
            scene,
            parameters: &[],
            velocity: &velocity,
            prepare: &prepare,
            runs,
            seed: 1,
            name: "run",
        };
        squeals(&pushes, &Journal::forgotten(), Watch::IDLE).unwrap().unwrap()
    }

    /// Set 2 at µ = 1.96 is stable in sliding, and has a limit cycle beside rest (the paper's Figs. 5 to 7).
    #[test]
    fn a_scene_that_is_stable_in_sliding_squeals_after_large_pushes_alone() {
        let mut scene = builtin("set2").unwrap().scene();
        scene.friction_coefficient = 1.96;
        let small = found(&scene, "uniform(0,1e-4)", 4);
        assert_eq!(small.count(End::Rests), 4, "{small:?}");
        let large = found(&scene, "uniform(0.2,0.6)", 8);
        assert!(large.count(End::Squeals) > 0, "{large:?}");
        let Estimate { low, value, high } = large.probability;
        assert!(low <= value && value <= large.at_most && large.at_most <= high);
    }
}
