//! How loud the motion becomes that each growing mode, or each candidate, leads to, beside its growth rate.
//!
//! | file | contents |
//! | --- | --- |
//! | `ways` | growing modes of uniform sliding or, where none grows, candidates |
//! | `points` | points whose motion is measured, and the normals of their contacts |
//! | `measure` | velocities, powers and contact states of a motion that has settled |
//! | `shares` | modes of uniform sliding in that motion |
//! | `runs` | the progress of runs that take long |
//! | `ranks` | ranks by growth and by loudness, and where they disagree |
//!
//! Each motion starts in the equilibrium with a small motion along one mode, and is followed until it has settled. For
//! candidates the starts are the pushes of [`confirm`](super::confirm). Endings that are the same motion
//! ([`is_same`](super::is_same)) count as one motion with several ways into it.

mod measure;
mod points;
mod ranks;
mod runs;
mod shares;
mod ways;

pub use measure::{ContactPower, Measured, PointMotion, Power, TakenStates};
pub(crate) use points::translations;
pub use points::{MeasuredPoint, measured_points};
pub use ranks::disagreements;
pub use shares::ModeShare;
pub use ways::{Unexamined, Way, WayKind, Ways, check_undriven, ways};

use super::attractor::attractors;
use super::long_term::{Kind, LongTermMotion};
use super::observation::ObservationSettings;
use super::settling::run_and_tell;
use super::visit::visited;
use super::{Journal, Watch};
use crate::stability::Linearised;
use crate::stability::parallel::collect;
use amontons::Error;
use amontons::integrator::Motion;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use runs::Runs;
use serde::{Deserialize, Serialize};
use shares::ModalShares;
use ways::Start;

/// The size of the starts, and the points that are measured.
#[derive(Clone, Debug)]
pub struct LoudnessQuestion {
    /// The largest velocity that a start along a growing mode has, m/s.
    pub push: f64,
    /// The points whose motion is measured, at least one.
    pub points: Vec<MeasuredPoint>,
}

/// One start and the ending of its motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attempt {
    /// The largest velocity of the start, m/s.
    pub push: f64,
    /// The ending of the motion; `None` if it failed.
    pub ending: Option<LongTermMotion>,
    /// The reason of a failure.
    pub failure: Option<String>,
    /// `true` if contacts take the states of the candidate together in that motion; `None` for growing modes.
    pub meets: Option<bool>,
    /// The motion in [`Loudness::motions`]; `None` if it has not settled, or failed.
    pub motion: Option<usize>,
}

/// A growing mode or a candidate, and the motion that it leads to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The mode or candidate.
    pub way: Way,
    /// All starts, by size.
    pub attempts: Vec<Attempt>,
    /// The attempt that stands for all: the first with the loudest motion, else the first that moves, else the first that is
    /// decided, else the first.
    pub chosen: usize,
    /// Place among all rows by growth rate, from 1; rows of equal growth have one place.
    pub growth_rank: usize,
    /// Place among all motions by loudness, from 1; `None` of what has no measured motion.
    pub loudness_rank: Option<usize>,
}

impl Row {
    /// The attempt that stands for all.
    #[must_use]
    pub fn attempt(&self) -> &Attempt {
        &self.attempts[self.chosen]
    }
}

/// A motion that ways lead to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundMotion {
    /// Its kind, size and frequency.
    pub ending: LongTermMotion,
    /// Velocities, powers and contact states; `None` of rest and of unbounded growth.
    pub measured: Option<Measured>,
    /// The mode of uniform sliding whose frequency is nearest to that of the motion, with its share of the kinetic energy.
    pub nearest: Option<ModeShare>,
}

impl FoundMotion {
    /// The mode with the largest share of the kinetic energy, where that is another one than the nearest.
    #[must_use]
    pub fn strongest(&self) -> Option<&ModeShare> {
        let strongest = self.measured.as_ref()?.shares.first()?;
        let is_other =
            self.nearest.as_ref().is_some_and(|nearest| nearest.modes != strongest.modes);
        is_other.then_some(strongest)
    }
}

/// The results of the study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Loudness {
    /// `true` if modes of uniform sliding grow: the rows are these modes, otherwise they are candidates.
    pub grows: bool,
    /// Rows in the order of the ways.
    pub rows: Vec<Row>,
    /// Motions: rest first, then by amplitude.
    pub motions: Vec<FoundMotion>,
    /// Candidates that were left out, and why.
    pub unexamined: Option<Unexamined>,
    /// Sentences that say where the ranks disagree.
    pub findings: Vec<String>,
}

/// The results of one run, as the journal keeps them.
#[derive(Clone, Serialize, Deserialize)]
struct Run {
    ending: LongTermMotion,
    measured: Option<Measured>,
    nearest: Option<ModeShare>,
    meets: Option<bool>,
}

/// Follows the motion from each start until it has settled, and measures it; on all cores. `None` if the watch ended it:
/// what was finished is in the journal. The scene is at rest and has no signals.
///
/// # Errors
/// Returns an error if the scene cannot be run, or the journal cannot be written. A run that fails is recorded in its
/// place.
pub fn loudness(
    scene: &Scene,
    found: &Ways,
    question: &LoudnessQuestion,
    observation: &ObservationSettings,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Loudness>, Error> {
    let here = Linearised::of(scene);
    let modal = ModalShares::of(&here)?;
    let mut starts: Vec<(usize, Start)> = Vec::new();
    for (place, way) in found.ways.iter().enumerate() {
        starts.extend(way.starts(scene, question.push)?.into_iter().map(|start| (place, start)));
    }
    let runs = Runs::of(watch, starts.len());
    let work = |i: usize| {
        let (place, start) = &starts[i];
        let way = &found.ways[*place];
        journal.piece(&format!("{}, push {:?}", way.key(), start.push), || {
            let reached = |part: f64| runs.reached(i, part);
            match run(scene, way, start, question, (observation, modal.as_ref()), (watch, &reached))
            {
                Ok(run) => Ok(run.map(Ok)),
                Err(error) => Ok(Some(Err(error.to_string()))),
            }
        })
    };
    let work = |i: usize| {
        let made = work(i);
        runs.reached(i, 1.0);
        made
    };
    let made = collect(starts.len(), &work, &|_| {})?;
    let made: Option<Vec<Result<Run, String>>> = made.into_iter().collect();
    Ok(made.map(|made| results(found, &starts, &made, observation)))
}

/// The motion from one start; `None` if the watch ended it.
fn run(
    scene: &Scene,
    way: &Way,
    start: &Start,
    question: &LoudnessQuestion,
    (observation, modal): (&ObservationSettings, Option<&ModalShares>),
    (watch, reached): (Watch<'_>, &dyn Fn(f64)),
) -> Result<Option<Run>, Error> {
    let mut simulation = Simulation::new(scene.clone(), 0.0)?;
    let states = simulation.contact_states().to_vec();
    simulation.go_on_from(&Motion::new(start.displacement.clone(), start.velocity.clone(), states));
    let ending = run_and_tell(&mut simulation, observation, &|| watch.is_over(), reached)?;
    let Some(ending) = ending else { return Ok(None) };
    let is_steady = ending.kind.is_cycle() && ending.is_known();
    let met = || Ok(visited(&simulation, observation, ending.period)?.has(&way.contact_states));
    let meets = match way.kind {
        WayKind::Mode => None,
        WayKind::Candidate if is_steady => Some(met()?),
        WayKind::Candidate => Some(false),
    };
    let (mut measured, mut nearest) = (None, None);
    if is_steady {
        let found = measure::measure(&simulation, &question.points, observation, &ending, modal)?;
        nearest = shares::nearest(&found.1, ending.frequency, observation.window);
        measured = Some(found.0);
    }
    Ok(Some(Run { ending, measured, nearest, meets }))
}

/// The results of all runs, in the order of their starts.
fn results(
    found: &Ways,
    starts: &[(usize, Start)],
    made: &[Result<Run, String>],
    observation: &ObservationSettings,
) -> Loudness {
    let ending = |run: &Result<Run, String>| run.as_ref().ok().map(|run| run.ending.clone());
    let endings: Vec<Option<LongTermMotion>> = made.iter().map(ending).collect();
    let (endings, places) = attractors(endings.iter().map(Option::as_ref));
    let of_motion = |place: usize| {
        let runs = made.iter().zip(&places).filter(move |(_, other)| **other == Some(place));
        runs.filter_map(|(run, _)| run.as_ref().ok())
    };
    let motions: Vec<FoundMotion> = endings
        .into_iter()
        .enumerate()
        .map(|(place, ending)| {
            let run = of_motion(place).find(|run| run.measured.is_some());
            FoundMotion {
                ending,
                measured: run.and_then(|run| run.measured.clone()),
                nearest: run.and_then(|run| run.nearest.clone()),
            }
        })
        .collect();
    let attempt = |i: usize| Attempt {
        push: starts[i].1.push,
        ending: made[i].as_ref().ok().map(|run| run.ending.clone()),
        failure: made[i].as_ref().err().cloned(),
        meets: made[i].as_ref().ok().and_then(|run| run.meets),
        motion: places[i],
    };
    let rows = found.ways.iter().enumerate().map(|(place, way)| {
        let own = (0..starts.len()).filter(|i| starts[*i].0 == place);
        let attempts: Vec<Attempt> = own.map(attempt).collect();
        let chosen = chosen(&attempts, &motions);
        Row { way: way.clone(), attempts, chosen, growth_rank: 0, loudness_rank: None }
    });
    let mut rows: Vec<Row> = rows.filter(|row| !row.attempts.is_empty()).collect();
    ranks::rank(&mut rows, &motions);
    let mut loudness = Loudness {
        grows: found.grows,
        rows,
        motions,
        unexamined: found.unexamined.clone(),
        findings: Vec::new(),
    };
    loudness.findings = disagreements(&loudness, observation);
    loudness
}

/// The attempt that stands for all ([`Row::chosen`]).
fn chosen(attempts: &[Attempt], motions: &[FoundMotion]) -> usize {
    let loudness = |attempt: &Attempt| {
        let measured = motions[attempt.motion?].measured.as_ref()?;
        Some(measured.loudest().rms)
    };
    let loudest = attempts.iter().filter_map(loudness).fold(0.0, f64::max);
    let first = |is_such: &dyn Fn(&Attempt) -> bool| attempts.iter().position(is_such);
    let moves = |attempt: &Attempt| {
        attempt.motion.is_some_and(|motion| motions[motion].ending.kind != Kind::Equilibrium)
    };
    // Attempts that lead to one motion have the loudness of that motion.
    first(&|attempt| loudness(attempt).is_some_and(|own| own == loudest))
        .or_else(|| first(&moves))
        .or_else(|| first(&|attempt| attempt.motion.is_some()))
        .unwrap_or(0)
}
