//! Maps of stability over two parameters.

use super::linearised::Linearised;
use super::parallel;
use super::state_energy::state_energy;
use super::states::{MAX_CONTACTS, StateClasses};
use crate::journal::Journal;
use crate::watch::Watch;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use amontons::stability::Spectrum;
use serde::{Deserialize, Serialize};

/// The stability of uniform sliding for one scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// No contact state grows; with more than [`MAX_CONTACTS`] contacts uniform sliding does not, and
    /// the others are not looked at.
    Stable,
    /// Uniform sliding does not grow; a contact state does that contacts take by sticking alone, as they do when a
    /// swing's speed meets the surface's.
    Candidate,
    /// Uniform sliding does not grow; of the contact states that do, each needs a contact that has opened or slides the
    /// other way, which asks for a larger motion.
    FarCandidate,
    /// Uniform sliding itself grows.
    Unstable,
    /// There is no equilibrium in uniform sliding (jamming, a contact that opens, a slider that
    /// stands still).
    NoEquilibrium,
    /// The scene cannot be: its static friction is below its kinetic friction.
    Impossible,
}

impl Verdict {
    /// All of them, in the order of the numbers that stand for them.
    pub const ALL: [Self; 6] = [
        Self::Stable,
        Self::Candidate,
        Self::FarCandidate,
        Self::Unstable,
        Self::NoEquilibrium,
        Self::Impossible,
    ];
}

/// The verdict in words.
impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Stable => "stable",
            Self::Candidate => "candidate",
            Self::FarCandidate => "candidate if a contact opens or reverses",
            Self::Unstable => "unstable",
            Self::NoEquilibrium => "no equilibrium in sliding",
            Self::Impossible => "static below kinetic friction",
        })
    }
}

/// The verdict on a scene.
///
/// # Errors
/// Returns an error if values are impossible, or if a state cannot be analysed.
pub fn verdict(scene: &Scene) -> Result<Verdict, Error> {
    if scene.has_static_below_kinetic_friction() {
        return Ok(Verdict::Impossible);
    }
    scene.check()?;
    let here = Linearised::of(scene);
    match here.equilibrium() {
        Ok(_) => {}
        Err(error) if error.is_equilibrium() => return Ok(Verdict::NoEquilibrium),
        Err(error) => return Err(error),
    }
    let model = here.linear()?;
    let Ok(uniform) = here.uniform_sliding() else { return Ok(Verdict::NoEquilibrium) };
    if Spectrum::of(model, &uniform)?.unstable() {
        return Ok(Verdict::Unstable);
    }
    if here.model().contacts.len() > MAX_CONTACTS {
        return Ok(Verdict::Stable);
    }
    let mut found = Verdict::Stable;
    for states in &StateClasses::of(here.model())?.representatives {
        let only_sticks = states
            .iter()
            .zip(&uniform)
            .all(|(state, sliding)| state == sliding || *state == ContactState::Stick);
        // A far state tells nothing new after another one.
        let asks = only_sticks || found == Verdict::Stable;
        if asks && Spectrum::of(model, states)?.unstable() && state_energy(&here, states)?.is_some()
        {
            if only_sticks {
                return Ok(Verdict::Candidate);
            }
            found = Verdict::FarCandidate;
        }
    }
    Ok(found)
}

/// Verdicts on a grid of scenes, row by row, on all cores. `None` if the watch ended it: finished rows are in the
/// journal.
///
/// # Errors
/// Returns the first error of `scene_at` or of a verdict, or that the journal cannot be written.
pub fn map(
    columns: usize,
    rows: usize,
    scene_at: &(dyn Fn(usize, usize) -> Result<Scene, Error> + Sync),
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Vec<Vec<Verdict>>>, Error> {
    let point = |column: usize, row: usize| {
        if watch.is_over() { Ok(None) } else { verdict(&scene_at(column, row)?).map(Some) }
    };
    let row = |row: usize| {
        journal.piece(&format!("row {row}"), || {
            (0..columns).map(|column| point(column, row)).collect::<Result<Option<Vec<_>>, _>>()
        })
    };
    #[allow(clippy::cast_precision_loss)]
    let done = |done: usize| (watch.progress)(done as f64 / rows as f64);
    Ok(parallel::collect(rows, &row, &done)?.into_iter().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    fn at(name: &str, mu: f64) -> Scene {
        let mut scene = builtin(name).unwrap().scene();
        scene.friction_coefficient = mu;
        scene
    }

    #[test]
    fn the_papers_own_points_have_the_papers_verdicts() {
        // Set 1 is unstable at 1.5 and 1.96 (Figs. 3, 4); Set 2 at 1.96 is stable in uniform sliding
        // and unstable with one contact stuck (Fig. 5, Table 3).
        assert_eq!(verdict(&at("set1", 1.5)), Ok(Verdict::Unstable));
        assert_eq!(verdict(&at("set1", 1.96)), Ok(Verdict::Unstable));
        assert_eq!(verdict(&at("set2", 1.96)), Ok(Verdict::Candidate));
        assert_eq!(verdict(&at("set2", 0.0)), Ok(Verdict::Stable));
    }

    #[test]
    fn a_map_has_every_point_at_its_place() {
        let scene_at =
            |column: usize, row: usize| Ok(at(["set1", "set2"][row], [0.0, 1.96, 1.96][column]));
        let found = map(3, 2, &scene_at, &Journal::forgotten(), Watch::IDLE).unwrap().unwrap();
        use Verdict::{Candidate, Stable, Unstable};
        assert_eq!(found, [[Stable, Unstable, Unstable], [Stable, Candidate, Candidate]]);
    }
}
