//! The endings of a scene over the values of a parameter (the paper's Fig. 3): amplitude, frequency and contact
//! states of each limit cycle, and the values from which on contacts take a state or no longer do.

use super::long_term::{Kind, LongTermMotion};
use super::portrait::{Portrait, portrait};
use super::push::Push;
use super::settling::run_to_steady_state;
use super::{Journal, ObservationSettings, Prepare, Watch};
use crate::assign::assign;
use crate::stability::parallel::collect;
use crate::sweep::range::decimal;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Input of a study of limit cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Question {
    /// The parameter or input, by its name in the FMU.
    pub name: String,
    /// Values of the parameter, ascending.
    pub values: Vec<f64>,
    /// Thresholds are known to this part of the distance between the values beside them.
    pub resolution: f64,
    /// Values whose cycles are drawn; `None` for one in the middle of each regime.
    pub portraits: Option<Vec<f64>>,
    /// Number of contacts that a portrait shows, the first ones.
    pub contacts: usize,
}

/// The ending of the motion with one value, or the reason why there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// The ending of the motion, settled or not.
    Ending(LongTermMotion),
    /// The scene has no equilibrium, the step is above its critical one, or a step fails: the message of the error.
    Failure(String),
}

impl Outcome {
    /// The ending of the motion, if it has settled.
    #[must_use]
    pub fn settled(&self) -> Option<&LongTermMotion> {
        match self {
            Self::Ending(ending) if ending.kind != Kind::Unsettled => Some(ending),
            _ => None,
        }
    }

    /// `true` if the motion persists, as does one that was left on its way out of the equilibrium. `None` where that
    /// is not known.
    fn moves(&self) -> Option<bool> {
        match self {
            Self::Ending(ending) if ending.rests() => Some(false),
            Self::Ending(ending) => {
                let leaves = ending.kind == Kind::Unsettled && ending.rate > 0.0 && ending.linear;
                (ending.kind.is_cycle() || ending.kind == Kind::Unbounded || leaves).then_some(true)
            }
            Self::Failure(_) => None,
        }
    }

    /// The states that contacts take in the end, where they are known.
    fn taken(&self) -> Option<[bool; 4]> {
        match self {
            Self::Ending(ending) if ending.kind != Kind::Unsettled || ending.rests() => {
                Some(ending.taken)
            }
            _ => None,
        }
    }

    /// The regime of the motion: `true` if it persists, and the states that contacts take.
    fn regime(&self) -> Option<(bool, [bool; 4])> {
        self.moves().zip(self.taken())
    }
}

/// A change beyond a threshold, as the parameter rises.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// The motion comes to rest below the threshold and persists above it.
    RestEnds,
    /// The motion persists below the threshold and comes to rest above it.
    RestBegins,
    /// Contacts take this state above the threshold and not below.
    Appears(ContactState),
    /// Contacts take this state below the threshold and not above.
    Vanishes(ContactState),
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RestEnds => f.write_str("rest ends"),
            Self::RestBegins => f.write_str("rest begins"),
            Self::Appears(state) => write!(f, "{state} appears"),
            Self::Vanishes(state) => write!(f, "{state} vanishes"),
        }
    }
}

/// Two values between which the motion changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionBracket {
    /// The last value below the change, and the first above.
    pub between: [f64; 2],
    /// The changes at the threshold.
    pub changes: Vec<Change>,
    /// A value between them that does not settle, or has no motion, where the search ended.
    pub unknown: Option<f64>,
}

/// Neighbouring values whose motions are alike.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Regime {
    /// The places of its first and last value.
    pub places: [usize; 2],
    /// `true` if the motion persists for ever.
    pub is_cycle: bool,
    /// The states that contacts take, in the order of [`ContactState::ALL`].
    pub taken: [bool; 4],
}

/// Results of a study of limit cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitCycles {
    /// One outcome for each value.
    pub outcomes: Vec<Outcome>,
    /// Runs of values with settled motions that are alike.
    pub regimes: Vec<Regime>,
    /// Thresholds between neighbouring values that both have settled, by value.
    pub thresholds: Vec<MotionBracket>,
    /// Portraits by value; motions that rest have none.
    pub portraits: Vec<Portrait>,
}

/// The motion with each value until it is settled: from the scene's own start, with a push where that is at rest
/// ([`Push::of_resting`]), prepared for itself; then the thresholds by bisection and the portraits, on all cores. `None` where the watch ended
/// it.
///
/// # Errors
/// Returns an error if there is no such parameter, it cannot have a value, the scene cannot start with any value, or
/// the journal cannot be written.
pub fn limit_cycles(
    scene: &Scene,
    prepare: Prepare<'_>,
    question: &Question,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<LimitCycles>, Error> {
    let Question { name, values, resolution, portraits, contacts } = question;
    let runs = Runs { scene, prepare, name, journal, watch };
    runs.check(values)?;
    for value in portraits.iter().flatten() {
        runs.with(*value)?;
    }
    let [first, second] = parts(question);
    let progress = |from: f64, to: f64, of: usize| {
        #[allow(clippy::cast_precision_loss)]
        move |done: usize| (watch.progress)(from + (to - from) * done as f64 / of as f64)
    };
    let outcomes =
        collect(values.len(), &|i| runs.outcome(values[i]), &progress(0.0, first, values.len()))?;
    let Some(outcomes) = whole(outcomes) else { return Ok(None) };
    let is_change = |i: &usize| !changes(&outcomes[*i], &outcomes[i + 1]).is_empty();
    let changing: Vec<usize> = (0..values.len().saturating_sub(1)).filter(is_change).collect();
    let thresholds = collect(
        changing.len(),
        &|place| {
            let i = changing[place];
            let pairs = [i, i + 1].map(|i| (values[i], outcomes[i].clone()));
            runs.thresholds(&pairs, *resolution)
        },
        &progress(first, second, changing.len()),
    )?;
    let Some(thresholds) = whole(thresholds) else { return Ok(None) };
    let regimes = regimes(&outcomes);
    let drawn = portraits.clone().unwrap_or_else(|| {
        let cycles = regimes.iter().filter(|regime| regime.is_cycle);
        cycles.map(|regime| values[usize::midpoint(regime.places[0], regime.places[1])]).collect()
    });
    let portraits = collect(
        drawn.len(),
        &|i| runs.portrait(drawn[i], *contacts),
        &progress(second, 1.0, drawn.len()),
    )?;
    let Some(portraits) = whole(portraits) else { return Ok(None) };
    let thresholds = thresholds.into_iter().flatten().collect();
    let portraits = portraits.into_iter().flatten().collect();
    Ok(Some(LimitCycles { outcomes, regimes, thresholds, portraits }))
}

/// Everything, if nothing was ended.
fn whole<T>(pieces: Vec<Option<T>>) -> Option<Vec<T>> {
    pieces.into_iter().collect()
}

/// The part of the work that is done after the values and after the thresholds, of which there may be two.
#[allow(clippy::cast_precision_loss)]
fn parts(question: &Question) -> [f64; 2] {
    let values = question.values.len() as f64;
    let thresholds = 2.0 * (-question.resolution.log2()).ceil().max(0.0);
    let portraits = question.portraits.as_ref().map_or(3, Vec::len) as f64;
    let all = values + thresholds + portraits;
    [values / all, (values + thresholds) / all]
}

/// Changes from one motion to the next, as far as both are known.
fn changes(before: &Outcome, after: &Outcome) -> Vec<Change> {
    let cycle = match (before.moves(), after.moves()) {
        (Some(false), Some(true)) => Some(Change::RestEnds),
        (Some(true), Some(false)) => Some(Change::RestBegins),
        _ => None,
    };
    let (took, takes) = before.taken().zip(after.taken()).unwrap_or_default();
    let state = |(place, state): (usize, ContactState)| match (took[place], takes[place]) {
        (false, true) => Some(Change::Appears(state)),
        (true, false) => Some(Change::Vanishes(state)),
        _ => None,
    };
    cycle.into_iter().chain(ContactState::ALL.into_iter().enumerate().filter_map(state)).collect()
}

/// Runs of settled motions that are alike.
fn regimes(outcomes: &[Outcome]) -> Vec<Regime> {
    let mut regimes: Vec<Regime> = Vec::new();
    for (place, outcome) in outcomes.iter().enumerate() {
        let Some((is_cycle, taken)) = outcome.regime() else { continue };
        match regimes.last_mut() {
            Some(last)
                if last.places[1] + 1 == place
                    && (last.is_cycle, last.taken) == (is_cycle, taken) =>
            {
                last.places[1] = place;
            }
            _ => regimes.push(Regime { places: [place; 2], is_cycle, taken }),
        }
    }
    regimes
}

/// Runs a scene with its own method and step until its motion has settled: from its own start, with a push where that is
/// at rest ([`Push::of_resting`]). Returns the simulation at the end, and the ending; `None` if the watch ended the run.
///
/// # Errors
/// Returns an error if the scene cannot start, or if a step fails.
pub fn settled_motion(
    scene: Scene,
    observation: &ObservationSettings,
    watch: Watch<'_>,
) -> Result<Option<(Simulation, LongTermMotion)>, Error> {
    let push = Push::of_resting(&scene);
    let mut simulation = Simulation::new(scene, 0.0)?;
    if let Some(push) = push {
        push.give(&mut simulation);
    }
    let ending = run_to_steady_state(&mut simulation, observation, &|| watch.is_over())?;
    Ok(ending.map(|ending| (simulation, ending)))
}

/// Data shared by all runs.
struct Runs<'a> {
    scene: &'a Scene,
    prepare: Prepare<'a>,
    name: &'a str,
    journal: &'a Journal,
    watch: Watch<'a>,
}

impl Runs<'_> {
    /// The scene with a value, and the settings with which its motion is observed.
    fn with(&self, value: f64) -> Result<(Scene, ObservationSettings), Error> {
        let mut scene = self.scene.clone();
        assign(&mut scene, self.name, value)?;
        let observation = (self.prepare)(&mut scene)?;
        Ok((scene, observation))
    }

    /// Refuses values that the parameter cannot have, and a scene that can start with none of them.
    fn check(&self, values: &[f64]) -> Result<(), Error> {
        let runs: Vec<(Scene, ObservationSettings)> =
            values.iter().map(|value| self.with(*value)).collect::<Result<_, Error>>()?;
        let mut refused = None;
        for (scene, _) in runs {
            match Simulation::new(scene, 0.0) {
                Ok(_) => return Ok(()),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        refused.map_or(Ok(()), Err)
    }

    fn key(&self, value: f64) -> String {
        format!("{} = {value:?}", self.name)
    }

    /// The outcome of the motion with a value.
    fn outcome(&self, value: f64) -> Result<Option<Outcome>, Error> {
        let prepared = self.with(value)?;
        self.journal.piece(&self.key(value), || {
            Ok(match settled_motion(prepared.0, &prepared.1, self.watch) {
                Ok(found) => found.map(|(_, ending)| Outcome::Ending(ending)),
                Err(error) => Some(Outcome::Failure(error.to_string())),
            })
        })
    }

    /// Thresholds of all changes between two neighbouring values, by value.
    fn thresholds(
        &self,
        pairs: &[(f64, Outcome); 2],
        resolution: f64,
    ) -> Result<Option<Vec<MotionBracket>>, Error> {
        let near = resolution * (pairs[1].0 - pairs[0].0);
        let mut found: Vec<MotionBracket> = Vec::new();
        for change in changes(&pairs[0].1, &pairs[1].1) {
            let [mut low, mut high] = pairs.clone();
            let mut unknown = None;
            // Rounding may leave a little more than was asked for.
            while high.0 - low.0 > near * (1.0 + 1e-9) {
                let middle = decimal(f64::midpoint(low.0, high.0));
                if !(low.0 < middle && middle < high.0) {
                    break;
                }
                let Some(outcome) = self.outcome(middle)? else { return Ok(None) };
                let is_known = match change {
                    Change::RestEnds | Change::RestBegins => outcome.moves().is_some(),
                    Change::Appears(_) | Change::Vanishes(_) => outcome.taken().is_some(),
                };
                if !is_known {
                    unknown = Some(middle);
                    break;
                }
                let is_above = changes(&low.1, &outcome).contains(&change);
                *(if is_above { &mut high } else { &mut low }) = (middle, outcome);
            }
            let between = [low.0, high.0];
            match found.iter_mut().find(|known| known.between == between) {
                Some(known) => known.changes.push(change),
                None => found.push(MotionBracket { between, changes: vec![change], unknown }),
            }
        }
        found.sort_by(|a, b| a.between[0].total_cmp(&b.between[0]));
        Ok(Some(found))
    }

    /// The portrait of what the motion with a value ends in; none inside where there is no cycle.
    fn portrait(&self, value: f64, contacts: usize) -> Result<Option<Option<Portrait>>, Error> {
        let Some(outcome) = self.outcome(value)? else { return Ok(None) };
        if !matches!(&outcome, Outcome::Ending(ending) if !ending.rests()) {
            return Ok(Some(None));
        }
        let key = format!("{}, portrait of {contacts}", self.key(value));
        let draw = || {
            let (scene, observation) = self.with(value)?;
            let settled = settled_motion(scene, &observation, self.watch)?;
            let Some((mut simulation, ending)) = settled else {
                return Ok(None);
            };
            portrait(&mut simulation, value, &ending, contacts).map(Some)
        };
        Ok(self.journal.piece(&key, draw)?.map(Some))
    }
}
