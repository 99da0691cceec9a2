//! Uniform sliding: its modes, its modes over µ, and the derivatives of those that grow.

use super::changes::{Before, Change, EQUAL_FRICTION, Onset, changes};
use super::numbers::numbers;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::decimal::to_significant;
use amontons::scene::Scene;
use amontons_analysis::assign::{FRICTION, assign};
use amontons_analysis::patterns::in_words;
use amontons_analysis::stability::candidates::equilibrium_ranges;
use amontons_analysis::stability::locus::{ALL_FREQUENCIES, Locus, Root, is_growing, locus};
use amontons_analysis::stability::{
    CriticalFriction, Linearised, Mode, Modes, Sensitivities, critical_at, modes, sensitivities,
};
use amontons_analysis::watch::Watch;
use amontons_cli::words::sensitivity::critical_effects;
use serde_json::{Value, json};

/// Number of steps of a locus; a critical µ is located between two of its values.
const STEPS: u32 = 200;
/// End of a locus in parts of the scene's µ.
const BEYOND: f64 = 1.5;
/// The most degrees of freedom of which modes are followed over µ.
const MOST_FOLLOWED: usize = 200;
/// The most modes that are followed over µ for each change of a parameter.
const MOST_CHANGED: usize = 40;
/// Parts of the work up to the ends of the derivatives and of the modes over µ.
const ENDS: [f64; 2] = [0.1, 0.4];
/// Modes whose frequencies are this near, in parts of themselves, belong to the bounds that were asked for.
const ROUNDING: f64 = 1e-9;

/// Uniform sliding of a scene.
pub struct Sliding {
    /// The contact states, in words.
    pub state: String,
    /// The modes and what follows from them; the reason if there is no equilibrium, or modes are not found.
    pub found: Result<Found, String>,
    pub over_friction: Result<OverFriction, String>,
}

/// The modes of uniform sliding.
pub struct Found {
    pub modes: Modes,
    /// The modes that grow, or the least stable one, with their derivatives.
    pub sensitivities: Result<Sensitivities, String>,
    /// Changes of the most effective parameters, or the reason why they are unknown.
    pub changes: Result<Vec<Change>, String>,
}

/// The modes over the common µ.
pub struct OverFriction {
    pub locus: Locus,
    /// The number of each branch: that of its mode at the scene's µ.
    pub numbers: Vec<usize>,
    pub critical: Vec<CriticalFriction>,
    /// The scene's µ.
    own: f64,
    /// The last value of µ.
    pub end: f64,
    /// `true` if larger values are impossible, or have no equilibrium.
    pub is_cut: bool,
}

impl Found {
    /// The modes with their numbers, from 1.
    pub fn numbered(&self) -> impl Iterator<Item = (usize, &Mode)> {
        (1..).zip(self.modes.all())
    }

    /// The modes that grow, the fastest first.
    pub fn growing(&self) -> Vec<(usize, &Mode)> {
        let mut growing: Vec<_> =
            self.numbered().filter(|(_, mode)| is_growing(mode.eigenvalue)).collect();
        growing.sort_by(|a, b| b.1.growth_rate().total_cmp(&a.1.growth_rate()));
        growing
    }

    /// The mode that grows fastest, or decays most slowly.
    pub fn leading(&self) -> Option<(usize, &Mode)> {
        self.numbered().max_by(|a, b| a.1.growth_rate().total_cmp(&b.1.growth_rate()))
    }
}

impl OverFriction {
    /// The critical µ next above the scene's, at which a mode begins to grow; of equal ones, as a merging has them, one that
    /// parameters have an effect on.
    pub fn next(&self) -> Option<&CriticalFriction> {
        next(&self.critical, self.own)
    }

    /// Where growth begins at the scene's µ or, if no mode grows there, beyond it.
    pub fn growth(&self) -> Growth {
        Growth::over(&self.locus, self.own)
    }

    /// The eigenvalue of each branch at the scene's µ, between those of the two values beside it, 1/s.
    fn own_roots(&self) -> Vec<nalgebra::Complex<f64>> {
        let values = &self.locus.values;
        let after = values.partition_point(|value| *value < self.own).clamp(1, values.len() - 1);
        let part = (self.own - values[after - 1]) / (values[after] - values[after - 1]);
        let at = |branch: &Vec<Root>| {
            let [from, to] = [branch[after - 1].lambda, branch[after].lambda];
            from + (to - from) * part
        };
        self.locus.branches.iter().map(at).collect()
    }

    /// The µ at which growth of a changed scene begins, in the same range or in the part of it that has an equilibrium.
    fn onset(&self, scene: &Scene, states: &[ContactState], watch: Watch<'_>) -> Onset {
        if self.locus.branches.len() > MOST_CHANGED {
            return Onset::NotSought;
        }
        let here = |value: f64| Ok(Linearised::of(&with_friction(scene, value, watch)?));
        let over = |values: &[f64]| locus(&here, states, values, ALL_FREQUENCIES, &|_, _| {}).ok();
        let smaller = || over(&equilibrium_values(scene, states, self.end, watch).ok()?);
        let found = over(&self.locus.values).or_else(smaller);
        found.map_or(Onset::NotSought, |found| Onset::of(&found, scene.friction_coefficient))
    }
}

impl Onset {
    /// Of a locus over µ, seen from the scene's µ.
    fn of(locus: &Locus, own: f64) -> Self {
        let end = locus.values[locus.values.len() - 1];
        match Growth::over(locus, own) {
            Growth::Since(value) | Growth::From(value) => Self::At(value),
            Growth::Never if own < end => Self::Outside([own, end]),
            Growth::Throughout | Growth::Never => Self::NotSought,
        }
    }
}

/// The critical µ next above a value, at which a mode begins to grow. Where modes merge, rounding makes several of one: the first
/// that parameters have an effect on counts.
fn next(critical: &[CriticalFriction], own: f64) -> Option<&CriticalFriction> {
    let above = || critical.iter().filter(|one| one.becomes_unstable && one.value > own);
    let first = above().next()?;
    let is_equal = |one: &&CriticalFriction| {
        (one.value - first.value).abs() <= EQUAL_FRICTION * first.value.abs()
    };
    let is_moved = |one: &&CriticalFriction| {
        let effects = critical_effects(one);
        effects.iter().any(|effect| !effect.is_by_unit() && effect.largest()[0] != 0.0)
    };
    above().filter(is_equal).find(is_moved).or(Some(first))
}

/// Where modes grow in a range of µ, seen from one of its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Growth {
    /// At the value, since this µ below it.
    Since(f64),
    /// At the value, and at all smaller ones of the range.
    Throughout,
    /// Not at the value, but from this µ above it on.
    From(f64),
    /// Neither at the value nor above it.
    Never,
}

impl Growth {
    /// Of a locus over µ.
    fn over(locus: &Locus, own: f64) -> Self {
        let first = (0..locus.branches.len()).filter(|mode| locus.grows_at_first(*mode)).count();
        let turns = locus.turns().map(|one| (one.value, one.becomes_unstable, 1));
        Self::of(first, turns, own)
    }

    /// Of the number of modes that grow at the first µ, and of the values at which some number of modes begins (`true`) or ceases
    /// to grow.
    fn of(first: usize, turns: impl Iterator<Item = (f64, bool, usize)>, own: f64) -> Self {
        let mut turns: Vec<(f64, bool, usize)> = turns.collect();
        turns.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut growing, mut since) = (first, None);
        for &(value, begins, count) in turns.iter().filter(|turn| turn.0 <= own) {
            if begins && growing == 0 {
                since = Some(value);
            }
            growing = if begins { growing + count } else { growing.saturating_sub(count) };
        }
        let next = turns.iter().find(|turn| turn.1 && turn.0 > own);
        match (growing, since, next) {
            (0, _, None) => Self::Never,
            (0, _, Some(next)) => Self::From(next.0),
            (_, Some(since), _) => Self::Since(since),
            (_, None, _) => Self::Throughout,
        }
    }
}

impl Sliding {
    /// `None` if the watch ended the work.
    ///
    /// # Errors
    /// Returns an error if no surface moves.
    pub fn of(scene: &Scene, watch: Watch<'_>) -> Result<Option<Self>, Error> {
        let here = Linearised::of(scene);
        let states = here.uniform_sliding()?;
        let words = |error: Error| error.to_string();
        let mut found = found(&here, &states, watch).map_err(words);
        if watch.ends_after(ENDS[0]) {
            return Ok(None);
        }
        let mut over_friction = over_friction(scene, &states, watch);
        if watch.ends_after(ENDS[1]) {
            return Ok(None);
        }
        if let Ok(found) = &mut found {
            if let Ok(over) = &mut over_friction {
                let own: Vec<_> = found.modes.all().map(|mode| mode.eigenvalue).collect();
                over.numbers = numbers(&over.own_roots(), &own);
            }
            found.changes = changed(scene, &states, found, over_friction.as_ref().ok(), watch);
        }
        Ok((!watch.is_over()).then(|| Self {
            state: in_words(&states, scene),
            found,
            over_friction,
        }))
    }

    pub fn as_json(&self) -> Value {
        let mode = |(number, mode): (usize, &Mode)| {
            json!({
                "number": number,
                "frequency": mode.frequency_hz(),
                "growth_rate": mode.growth_rate(),
                "damping_ratio": mode.damping_ratio(),
            })
        };
        let found = self.found.as_ref();
        let critical = self.over_friction.as_ref().map(|over| {
            let each = over.critical.iter().map(|one| {
                json!({
                    "friction": one.value,
                    "frequency": one.frequency_hz,
                    "becomes_unstable": one.becomes_unstable,
                })
            });
            each.collect::<Vec<Value>>()
        });
        json!({
            "state": self.state,
            "modes": found.map(|found| found.numbered().map(mode).collect::<Vec<Value>>()).ok(),
            "unknown": found.err(),
            "critical": critical.ok(),
            "changes": found.ok().and_then(|found| found.changes.as_ref().ok()),
            "changes_unknown": found.ok().and_then(|found| found.changes.as_ref().err()),
        })
    }
}

/// Changes of the most effective parameters, with their progress.
fn changed(
    scene: &Scene,
    states: &[ContactState],
    found: &Found,
    over: Option<&OverFriction>,
    watch: Watch<'_>,
) -> Result<Vec<Change>, String> {
    let sensitivities = found.sensitivities.as_ref().map_err(String::clone)?;
    let next = over.filter(|_| !found.modes.unstable()).and_then(OverFriction::next);
    let onset = |scene: &Scene| over.map_or(Onset::NotSought, |it| it.onset(scene, states, watch));
    let own = scene.friction_coefficient;
    let before = Before {
        growing: found.growing().len(),
        growth: found.leading().map_or(0.0, |(_, mode)| mode.growth_rate()),
        rounding: found.leading().map_or(0.0, |(_, mode)| ROUNDING * mode.eigenvalue.norm()),
        onset: over.map_or(Onset::NotSought, |over| Onset::of(&over.locus, own)),
    };
    let progress = |part: f64| (watch.progress)(ENDS[1] + (1.0 - ENDS[1]) * part);
    changes(scene, sensitivities, next, &onset, &before, Watch { progress: &progress, ..watch })
}

fn found(here: &Linearised, states: &[ContactState], watch: Watch<'_>) -> Result<Found, Error> {
    here.equilibrium()?;
    let modes = modes(here.linear()?, states)?;
    let unknown = || Err(String::new());
    let mut found = Found { modes, sensitivities: unknown(), changes: Err(String::new()) };
    let leading = found.leading().ok_or_else(|| {
        Error::analysis("no motion is possible in uniform sliding, so it has no modes")
    })?;
    let of = match &found.growing()[..] {
        [] => vec![leading.1.frequency_hz()],
        growing => growing.iter().map(|(_, mode)| mode.frequency_hz()).collect(),
    };
    let [low, high] = amontons::numerics::range(of);
    let bounds = [low * (1.0 - ROUNDING), high * (1.0 + ROUNDING)];
    let done = |done: usize, all: usize| (watch.progress)(ENDS[0] * share(done, all));
    let sensitivities = sensitivities(here, states, bounds, &done);
    found.sensitivities = sensitivities.map_err(|error| error.to_string());
    Ok(found)
}

/// The modes from µ = 0 to one and a half times the scene's µ, or as far as uniform sliding has an equilibrium.
fn over_friction(
    scene: &Scene,
    states: &[ContactState],
    watch: Watch<'_>,
) -> Result<OverFriction, String> {
    if !scene.has_common_friction() {
        return Err(
            "no contact has the common friction coefficient, so that there is no single µ to vary"
                .into(),
        );
    }
    let dofs = Linearised::of(scene).model().dofs();
    if dofs > MOST_FOLLOWED {
        return Err(format!(
            "with {dofs} degrees of freedom the modes are not followed over µ here; `amontons-stability locus` does it"
        ));
    }
    let own = scene.friction_coefficient;
    // A round number is one that a command line can have.
    let last = if own == 0.0 { 1.0 } else { to_significant(BEYOND * own, 12) };
    let values = equilibrium_values(scene, states, last, watch)?;
    let end = values[values.len() - 1];
    let here = |value: f64| Ok(Linearised::of(&with_friction(scene, value, watch)?));
    let words = |error: Error| format!("the modes cannot be followed over µ: {error}");
    let done = |done: usize, all: usize| {
        (watch.progress)(ENDS[0] + (ENDS[1] - ENDS[0]) * share(done, all));
    };
    let locus = locus(&here, states, &values, ALL_FREQUENCIES, &done).map_err(words)?;
    let critical = critical_at(scene, states, &locus.crossings).map_err(words)?;
    let numbers = (1..=locus.branches.len()).collect();
    Ok(OverFriction { locus, numbers, critical, own, end, is_cut: end < last })
}

/// The scene with another µ.
fn with_friction(scene: &Scene, value: f64, watch: Watch<'_>) -> Result<Scene, Error> {
    watch.check()?;
    let mut scene = scene.clone();
    assign(&mut scene, FRICTION, value)?;
    scene.check()?;
    Ok(scene)
}

/// Values of µ from 0 to a last one, in the part of this range about the scene's µ in which uniform sliding has an equilibrium.
fn equilibrium_values(
    scene: &Scene,
    states: &[ContactState],
    last: f64,
    watch: Watch<'_>,
) -> Result<Vec<f64>, String> {
    let is_possible = |value: f64| {
        let scene = with_friction(scene, value, watch)?;
        Linearised::of(&scene).equilibrium_in(states).map(|_| ())
    };
    let ranges = equilibrium_ranges(&is_possible, &values(0.0, last));
    let own = scene.friction_coefficient;
    let holds_own = |range: &&[f64; 2]| range[0] <= own && own <= range[1];
    match ranges.iter().find(holds_own) {
        None => Err("uniform sliding has no equilibrium at the scene's µ".into()),
        Some([from, to]) if to <= from => {
            Err("uniform sliding has an equilibrium at the scene's µ alone".into())
        }
        Some(&[from, to]) => Ok(values(from, to)),
    }
}

/// A number of pieces as a part of all.
#[allow(clippy::cast_precision_loss)]
fn share(done: usize, all: usize) -> f64 {
    done as f64 / all.max(1) as f64
}

/// Values of µ as a critical µ is sought among.
fn values(from: f64, to: f64) -> Vec<f64> {
    let part = |i: u32| f64::from(i) / f64::from(STEPS);
    (0..=STEPS).map(|i| from + (to - from) * part(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    /// Where modes merge, rounding makes several critical µ of one, and the first may have derivatives of zero, or none.
    #[test]
    fn of_equal_critical_friction_the_next_is_one_that_parameters_have_an_effect_on() {
        let scene = builtin("disc_brake").unwrap().scene();
        let states = Linearised::of(&scene).uniform_sliding().unwrap();
        let critical = over_friction(&scene, &states, Watch::IDLE).unwrap().critical;
        let moved = critical.into_iter().find(|one| one.becomes_unstable).unwrap();
        let mut still = CriticalFriction { value: moved.value * (1.0 - 1e-10), ..moved.clone() };
        still.derivatives.iter_mut().flatten().for_each(|it| it.1.fill(0.0));
        let mut unknown = still.clone();
        unknown.derivatives = Err(Error::analysis("modes are equal"));
        for first in [&still, &unknown] {
            assert_eq!(next(&[first.clone(), moved.clone()], 0.1), Some(&moved));
            assert_eq!(next(std::slice::from_ref(first), 0.1), Some(first));
        }
        let apart = CriticalFriction { value: 0.9 * moved.value, ..still };
        assert_eq!(next(&[apart.clone(), moved.clone()], 0.1), Some(&apart));
        assert_eq!(next(&[moved], 0.9), None);
    }

    #[test]
    fn growth_is_told_from_where_no_mode_grows() {
        // One mode grows from 1 to 4, another one from 2 to 3, a third one from 5 on.
        let turns =
            [(1.0, true, 1), (2.0, true, 1), (3.0, false, 1), (4.0, false, 1), (5.0, true, 2)];
        let of = |first: usize, own: f64| Growth::of(first, turns.into_iter(), own);
        assert_eq!(of(0, 0.5), Growth::From(1.0));
        for own in [1.5, 2.5, 3.5] {
            assert_eq!(of(0, own), Growth::Since(1.0));
        }
        assert_eq!(of(0, 4.5), Growth::From(5.0));
        assert_eq!(of(0, 6.0), Growth::Since(5.0));
        assert_eq!(of(1, 6.0), Growth::Throughout);
        assert_eq!(Growth::of(1, [(1.0, false, 1)].into_iter(), 2.0), Growth::Never);
    }
}
