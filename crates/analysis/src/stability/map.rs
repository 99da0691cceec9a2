//! Maps of stability over two parameters.

use super::linearised::Linearised;
use super::parallel;
use super::state_energy::state_energy;
use super::states::{MAX_CONTACTS, StateClasses};
use crate::journal::Journal;
use crate::regions::trace;
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
    /// There is no equilibrium in uniform sliding (jamming, a load that pulls the structure off its contacts, a slider
    /// that stands still).
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
    // A contact that is open at rest lands before it sticks.
    let sticks = |state, at_rest| state == ContactState::Stick && at_rest != ContactState::Detached;
    let mut found = Verdict::Stable;
    for states in &StateClasses::of(here.model())?.representatives {
        let only_sticks = states
            .iter()
            .zip(&uniform)
            .all(|(state, sliding)| state == sliding || sticks(*state, *sliding));
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

/// Points that are one piece of work.
const PIECE: usize = 16;

/// Verdicts on a grid of scenes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Map {
    /// Row by row, each with a verdict for each column.
    pub verdicts: Vec<Vec<Verdict>>,
    /// Number of verdicts that are not computed but filled in from those of other points.
    pub filled_in: usize,
}

/// Verdicts on a grid of scenes, on all cores. With `islands` only those are computed that the boundaries need, and
/// islands of this width and height, in points, are found wherever they lie. `None` if the watch ended it: finished
/// pieces are in the journal, which continues with the same islands.
///
/// # Errors
/// Returns the first error of `scene_at` or of a verdict, or that the journal cannot be written.
pub fn map(
    size: [usize; 2],
    islands: Option<[usize; 2]>,
    scene_at: &(dyn Fn(usize, usize) -> Result<Scene, Error> + Sync),
    journal: &Journal,
    watch: Watch<'_>,
) -> Result<Option<Map>, Error> {
    let [columns, rows] = size;
    let mut known = vec![None; columns * rows];
    let mut compute = |round: i32, places: &[usize], [from, to]: [f64; 2]| {
        let pieces: Vec<&[usize]> = places.chunks(PIECE).collect();
        let point = |place: &usize| {
            if watch.is_over() {
                return Ok(None);
            }
            verdict(&scene_at(place % columns, place / columns)?).map(Some)
        };
        let piece = |i: usize| {
            let (places, count) = (pieces[i], pieces[i].len());
            let key = format!("round {round}, {} to {}, {count}", places[0], places[count - 1]);
            journal.piece(&key, || {
                places.iter().map(point).collect::<Result<Option<Vec<Verdict>>, Error>>()
            })
        };
        #[allow(clippy::cast_precision_loss)]
        let done = |done: usize| {
            (watch.progress)(from + (to - from) * done as f64 / pieces.len() as f64);
        };
        let found = parallel::collect(pieces.len(), &piece, &done)?;
        let Some(found) = found.into_iter().collect::<Option<Vec<_>>>() else { return Ok(None) };
        for (place, verdict) in places.iter().zip(found.into_iter().flatten()) {
            known[*place] = Some(Some(verdict));
        }
        Ok(Some(known.clone()))
    };
    let filled = if let Some(islands) = islands {
        let mut round = 0;
        trace(size, islands, &mut |places| {
            round += 1;
            // Any round may be the last; each takes half of the work that is left.
            compute(round, places, [round - 1, round].map(|round| 1.0 - 0.5_f64.powi(round)))
        })?
    } else {
        let all: Vec<usize> = (0..columns * rows).collect();
        compute(1, &all, [0.0, 1.0])?.map(|_| vec![None; all.len()])
    };
    let Some(filled) = filled else { return Ok(None) };
    let filled_in = known.iter().filter(|known| known.is_none()).count();
    let verdicts = known.into_iter().zip(filled);
    let verdicts: Vec<Verdict> =
        verdicts.filter_map(|(known, filled)| known.flatten().or(filled)).collect();
    let verdicts = verdicts.chunks(columns.max(1)).map(<[Verdict]>::to_vec).collect();
    Ok(Some(Map { verdicts, filled_in }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assign::assign;
    use amontons::scene::builtin;

    fn at(name: &str, mu: f64) -> Scene {
        let mut scene = builtin(name).unwrap().scene();
        scene.friction_coefficient = mu;
        scene
    }

    fn of(
        size: [usize; 2],
        islands: Option<[usize; 2]>,
        scene_at: &(dyn Fn(usize, usize) -> Result<Scene, Error> + Sync),
    ) -> Map {
        map(size, islands, scene_at, &Journal::forgotten(), Watch::IDLE).unwrap().unwrap()
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
        let found = of([3, 2], None, &scene_at);
        use Verdict::{Candidate, Stable, Unstable};
        let verdicts = [[Stable, Unstable, Unstable], [Stable, Candidate, Candidate]];
        assert_eq!(
            (&found.verdicts[..], found.filled_in),
            (&verdicts.map(|row| row.to_vec())[..], 0)
        );
    }

    #[test]
    fn a_traced_map_is_the_map_of_all_points() {
        let scene_at = |column: usize, row: usize| {
            let mut scene = at("set2", 0.05 * column as f64);
            assign(&mut scene, "module[1].k6", 2e5 + 2.5e3 * row as f64)?;
            Ok(scene)
        };
        let [every, traced] = [None, Some([8, 8])].map(|islands| of([61, 41], islands, &scene_at));
        assert_eq!(traced.verdicts, every.verdicts);
        assert_eq!(every.filled_in, 0);
        assert!(traced.filled_in > 61 * 41 * 4 / 5, "{}", traced.filled_in);
    }
}
