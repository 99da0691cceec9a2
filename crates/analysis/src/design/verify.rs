//! Verification of a design: eigenvalues on a finer grid, equilibria, candidates, runs after pushes.

use super::limits::Found;
use super::search::OverRange;
use super::study::{DesignQuestion, Reached};
use super::vary::scene_at;
use crate::journal::Journal;
use crate::robustness::{Pushes, Squeals, squeals};
use crate::stability::candidates::{bistability, candidates_at};
use crate::stability::{Linearised, MAX_CONTACTS};
use crate::watch::Watch;
use amontons::Error;
use amontons::contact::JoinedStates;
use amontons::scene::Scene;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The mode that grows fastest over a range of friction coefficients.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// Its growth rate, 1/s.
    pub growth: f64,
    /// Its frequency, Hz; 0 if it does not oscillate.
    pub frequency: f64,
    /// The friction coefficient.
    pub friction: f64,
    /// The contact state, as `Sl-St`.
    pub states: String,
}

/// A mode of a state that was not among the chosen ones and grows while uniform sliding is stable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Remaining {
    /// The contact state, as `Sl-St`.
    pub states: String,
    /// The range of friction coefficients in which the mode grows.
    pub range: [f64; 2],
    /// The frequency of the mode at the end of the range, Hz.
    pub frequency: f64,
    /// Its growth rate there, 1/s.
    pub growth: f64,
}

/// The verification of a design.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Checked {
    /// Number of friction coefficients at which the eigenvalues of the chosen states were computed.
    pub frictions: usize,
    /// The least friction coefficient without an equilibrium, and the reason; `None` if each has one.
    pub no_equilibrium: Option<(f64, String)>,
    /// Candidates for a second motion that are left; `None` if a mode grows, if the equilibrium is not in uniform sliding, or if there are
    /// too many contacts to look at all states.
    pub remaining: Option<Vec<Remaining>>,
    /// Runs after pushes: at random friction coefficients of the range, and at its end; none if none were asked for.
    pub runs: Vec<PushedRuns>,
}

/// Runs of the scene and of the design after the same pushes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PushedRuns {
    /// The friction coefficient; `None` if each run has another one of the range.
    pub friction: Option<f64>,
    /// Those of the scene.
    pub scene: Squeals,
    /// Those of the design.
    pub design: Squeals,
}

impl Worst {
    pub(super) fn of(over: &OverRange<'_>, found: &Found) -> Self {
        let Found { place, eigenvalue } = found;
        Self {
            growth: eigenvalue.re,
            frequency: eigenvalue.im / TAU,
            friction: place.friction,
            states: JoinedStates(&over.structure.patterns[place.pattern]).to_string(),
        }
    }
}

/// The verification of a design: eigenvalues, equilibria, candidates, and the runs that the question asks for. `None` if the watch
/// ended the work.
///
/// # Errors
/// Returns an error if the design cannot be analysed, or if the journal cannot be written.
pub(super) fn verified(
    question: &DesignQuestion<'_>,
    over: &OverRange<'_>,
    design: &Reached,
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Checked>, Error> {
    let part = |from: f64, width: f64| move |part: f64| (watch.progress)(from + width * part);
    let (of_first, of_second, of_last) = (part(0.0, 0.4), part(0.4, 0.4), part(0.8, 0.2));
    let designed = scene_at(question.scene, question.varied, &design.changes)?;
    let mut runs = Vec::new();
    if let Some(pushes) = &question.pushes {
        let [from, to] = question.range;
        let both = |at: Option<f64>, progress: &(dyn Fn(f64) + Sync)| {
            let parameters = if at.is_some() { &[] } else { pushes.parameters };
            let place = if from < to && at.is_some() { " at the end" } else { "" };
            let run = |scene: &Scene, of: &str| {
                let scene = match at {
                    Some(friction_coefficient) => Scene { friction_coefficient, ..scene.clone() },
                    None => scene.clone(),
                };
                let name = format!("run of the {of}{place}");
                let pushes = Pushes { scene: &scene, parameters, name: &name, ..*pushes };
                squeals(&pushes, journal, Watch { progress, ..watch })
            };
            let before = run(question.scene, "scene")?;
            let after = if design.size > 0.0 { run(&designed, "design")? } else { before.clone() };
            let found = before.zip(after);
            Ok::<_, Error>(found.map(|(scene, design)| PushedRuns { friction: at, scene, design }))
        };
        let anywhere = if from < to { Some(both(None, &of_first)?) } else { None };
        let at_end = both(Some(to), &of_second)?;
        // Workers share the runs in one round.
        let all: Option<Vec<PushedRuns>> = anywhere.into_iter().chain([at_end]).collect();
        let Some(all) = all else { return Ok(None) };
        runs = all;
    }
    let looked = over.finer();
    let no_equilibrium = no_equilibrium(over, &design.changes, &looked)?;
    // Candidates are those of ranges in which uniform sliding is stable.
    let is_stable = design.worst.growth <= 0.0;
    let remaining = match no_equilibrium {
        None if is_stable => {
            remaining(&designed, question.range, Watch { progress: &of_last, ..watch })?
        }
        _ => None,
    };
    Ok(Some(Checked { frictions: looked.len(), no_equilibrium, remaining, runs }))
}

/// The first of these friction coefficients at which there is no equilibrium, with the reason. For uniform sliding there is one at
/// each: eigenvalues need it, and are there.
fn no_equilibrium(
    over: &OverRange<'_>,
    changes: &[f64],
    frictions: &[f64],
) -> Result<Option<(f64, String)>, Error> {
    let unseen = if over.structure.is_uniform { &[] } else { frictions };
    for friction in unseen {
        let here: Linearised = over.structure.model(changes, *friction)?;
        if let Err(error) = here.equilibrium() {
            if !error.is_equilibrium() {
                return Err(error);
            }
            return Ok(Some((*friction, error.to_string())));
        }
    }
    Ok(None)
}

/// The candidates for a second motion of a scene over a range; `None` if there are too many contacts, or no equilibrium.
fn remaining(
    scene: &Scene,
    range: [f64; 2],
    watch: Watch<'_>,
) -> Result<Option<Vec<Remaining>>, Error> {
    let middle = Scene { friction_coefficient: 0.5 * (range[0] + range[1]), ..scene.clone() };
    if scene.contact_count() > MAX_CONTACTS || Linearised::of(&middle).uniform_sliding().is_err() {
        return Ok(None);
    }
    let found = if range[0] == range[1] {
        let scene = Scene { friction_coefficient: range[0], ..scene.clone() };
        candidates_at(&scene, watch)
    } else {
        bistability(scene, range, watch).map(|found| found.candidates)
    };
    let found = match found {
        Err(error) if error.is_equilibrium() => return Ok(None),
        found => found?,
    };
    let remaining = found.iter().map(|one| Remaining {
        states: JoinedStates(&one.states).to_string(),
        range: one.range,
        frequency: one.at_end[0],
        growth: one.at_end[1],
    });
    Ok(Some(remaining.collect()))
}
