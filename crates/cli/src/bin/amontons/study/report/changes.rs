//! Changes of the most effective parameters, with the growth rate that derivatives predict and the one that eigenvalues have.

use amontons::Error;
use amontons::scene::Scene;
use amontons_analysis::assign::assign;
use amontons_analysis::robustness::{Verdict, verdict};
use amontons_analysis::stability::{CriticalFriction, ModeSensitivity, Sensitivities};
use amontons_analysis::watch::Watch;
use amontons_cli::words::digits;
use amontons_cli::words::sensitivity::{
    CHANGE, Effect, by_growth, critical_effects, merging_effects, mode_effects, without_derivatives,
};
use serde::Serialize;
use std::cmp::Ordering;
use std::fmt;

/// Changes of one parameter that the answers name, and the one of all at once.
pub const MOST_NAMED: usize = 4;
/// Number of parameters that are changed.
const CHANGED: usize = 4;
/// Changes, in parts of a parameter.
const PARTS: [f64; 2] = [0.05, 0.10];
/// Values of µ that differ by a smaller part of themselves are equal: a critical µ at which modes merge is known no better.
pub const EQUAL_FRICTION: f64 = 1e-6;

/// A change of one parameter, or of several at once.
#[derive(Clone, Debug, Serialize)]
pub struct Change {
    /// Each parameter with its change, in parts of the size of its value.
    pub parameters: Vec<(String, f64)>,
    /// The value of each before and after the change.
    pub values: Vec<[f64; 2]>,
    /// The growth rate that the derivatives of the leading mode predict, 1/s; `None` if they are not known, or hold only for much
    /// smaller changes.
    pub predicted: Option<f64>,
    /// The largest growth rate of all modes after the change, 1/s; `None` if there is no equilibrium.
    pub computed: Option<f64>,
    /// The number of modes that grow after the change.
    pub growing: usize,
    /// The µ at which growth begins after the change: below the scene's µ if a mode grows there, else above it.
    pub onset: Onset,
    /// `true` if the scene is better after the change, by what changes are ordered by.
    pub improves: bool,
}

/// The scene before changes.
pub struct Before {
    /// The number of modes that grow.
    pub growing: usize,
    /// The largest growth rate of all modes, 1/s.
    pub growth: f64,
    /// The part of the growth rate that may be rounding, 1/s.
    pub rounding: f64,
    /// The µ at which growth begins, as after changes.
    pub onset: Onset,
}

/// The µ at which growth begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Onset {
    /// It is not known.
    NotSought,
    /// This µ.
    At(f64),
    /// Outside of this range, which begins at the µ of the (changed) scene: no mode grows in it.
    Outside([f64; 2]),
}

impl Before {
    /// `true` if the scene is better after a change: where a mode grows, a lower growth rate or fewer modes that grow; where none
    /// grows, a larger µ at which growth begins or, if that is unknown or outside of the range, a faster decay.
    fn is_improved_by(&self, change: &Change) -> bool {
        let Some(computed) = change.computed else { return false };
        let is_lower = computed < self.growth - self.rounding;
        if self.growing > 0 {
            let is_higher = computed > self.growth + self.rounding;
            return is_lower || (change.growing < self.growing && !is_higher);
        }
        let [before, after] = [self.onset, change.onset].map(Onset::order);
        let is_known = self.onset != Onset::NotSought && change.onset != Onset::NotSought;
        let rounding = EQUAL_FRICTION * before.abs();
        change.growing == 0
            && match self.onset {
                _ if !is_known => is_lower,
                Onset::Outside(_) => after >= before - rounding && is_lower,
                _ => after > before + rounding,
            }
    }
}

impl Onset {
    /// A value by which onsets have an order.
    pub fn order(self) -> f64 {
        match self {
            Self::NotSought => f64::NEG_INFINITY,
            // Growth at this µ at most, or in all of the range not.
            Self::At(value) | Self::Outside([_, value]) => value,
        }
    }
}

impl fmt::Display for Onset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotSought => f.write_str("–"),
            Self::At(value) => f.write_str(&digits(*value, 4)),
            Self::Outside([from, to]) => {
                write!(f, "not from {} to {}", digits(*from, 4), digits(*to, 4))
            }
        }
    }
}

impl Change {
    /// The scene after the change.
    ///
    /// # Errors
    /// Returns an error if it is impossible.
    pub fn scene(&self, scene: &Scene) -> Result<Scene, Error> {
        let mut scene = scene.clone();
        for ((name, _), [_, after]) in self.parameters.iter().zip(&self.values) {
            assign(&mut scene, name, *after)?;
        }
        scene.check()?;
        Ok(scene)
    }

    /// The change in words: `mass.disc.mass −5 %`.
    pub fn name(&self) -> String {
        let one = |((name, part), values): (&(String, f64), &[f64; 2])| {
            let [before, after] = values.map(|value| digits(value, 4).replace('-', "−"));
            let by = format!("{:+} %", (100.0 * part).round()).replace('-', "−");
            // Ten per cent more of a negative value might be either.
            if values[0] < 0.0 {
                format!("{name} from {before} to {after}")
            } else {
                format!("{name} {by}")
            }
        };
        let all: Vec<String> = self.parameters.iter().zip(&self.values).map(one).collect();
        all.join(", ")
    }

    /// `true` if it is the largest change.
    pub fn is_large(&self) -> bool {
        self.parameters.iter().all(|(_, part)| part.abs() == PARTS[1])
    }
}

/// A parameter that may be changed, with the way in which the mode's growth rate falls.
struct Lever {
    name: String,
    value: f64,
    /// 1 or −1.
    way: f64,
    /// The change of the growth rate for this change by one part of the parameter, 1/s.
    slope: Option<f64>,
}

impl Lever {
    /// The value after a change by a part of its size.
    fn after(&self, part: f64) -> f64 {
        self.value + self.way * part * self.value.abs()
    }
}

/// Finds the µ at which a mode of a scene begins to grow.
type OnsetOf<'a> = dyn Fn(&Scene) -> Onset + 'a;

/// Changes of the parameters that are most effective for the leading mode or, where there is one, for a critical µ that is to be
/// raised: each alone by 5 and by 10 %, then all at once.
///
/// # Errors
/// Returns the reason if effects are unknown, a changed scene cannot be analysed, or the watch ended the work.
#[allow(clippy::cast_precision_loss)]
pub fn changes(
    scene: &Scene,
    found: &Sensitivities,
    critical: Option<&CriticalFriction>,
    onset: &OnsetOf<'_>,
    before: &Before,
    watch: Watch<'_>,
) -> Result<Vec<Change>, String> {
    let Some(&leading) = by_growth(found).first() else { return Ok(Vec::new()) };
    if let Some(reason) = unknown(leading, critical) {
        return Err(reason);
    }
    let words = |error: Error| error.to_string();
    let levers: Vec<Lever> = levers(found, leading, critical)
        .into_iter()
        .filter(|lever| PARTS.iter().all(|part| changed(scene, &[(lever, *part)]).is_ok()))
        .take(CHANGED)
        .collect();
    let mut wanted: Vec<Vec<(&Lever, f64)>> = Vec::new();
    wanted.extend(levers.iter().flat_map(|lever| PARTS.map(|part| vec![(lever, part)])));
    if levers.len() > 1 {
        let together = PARTS.map(|part| levers.iter().map(|lever| (lever, part)).collect());
        wanted.extend(together.into_iter().filter(|all: &Vec<_>| changed(scene, all).is_ok()));
    }
    let mut all = Vec::new();
    for (number, levers) in (1_u32..).zip(&wanted) {
        watch.check().map_err(words)?;
        let mut change = change(scene, leading, levers, onset).map_err(words)?;
        change.improves = before.is_improved_by(&change);
        all.push(change);
        (watch.progress)(f64::from(number) / wanted.len() as f64);
    }
    Ok(all)
}

/// The reason why the order of parameters by their effect is unknown.
fn unknown(mode: &ModeSensitivity, critical: Option<&CriticalFriction>) -> Option<String> {
    match critical {
        Some(critical) => {
            let reason = critical.derivatives.as_ref().err()?;
            Some(format!(
                "effects on the µ at which a mode begins to grow are not known, since {reason}"
            ))
        }
        None if mode.merging.is_none() && mode.derivatives.is_none() => Some(format!(
            "the mode that grows fastest, or decays most slowly, is {}",
            without_derivatives(mode)
        )),
        None => None,
    }
}

/// The places of the largest changes of one parameter each that improve the scene, the most helpful first: those after which no mode
/// grows by the µ at which one begins to, then by the largest growth rate.
pub fn best(changes: &[Change]) -> Vec<usize> {
    let is_wanted =
        |change: &Change| change.improves && change.is_large() && change.parameters.len() == 1;
    let mut places: Vec<usize> = (0..changes.len()).filter(|i| is_wanted(&changes[*i])).collect();
    let order = |place: usize| {
        let change = &changes[place];
        let computed = change.computed.unwrap_or(f64::INFINITY);
        match change.onset {
            // The largest growth rate tells little of changes after which no mode grows.
            onset if onset != Onset::NotSought && change.growing == 0 => {
                [0.0, -onset.order(), computed]
            }
            _ => [1.0, computed, 0.0],
        }
    };
    places.sort_by(|a, b| order(*a).into_iter().partial_cmp(order(*b)).unwrap_or(Ordering::Equal));
    places
}

/// The place of the largest change of all these parameters at once, if it improves the scene.
pub fn together(changes: &[Change]) -> Option<usize> {
    changes.iter().position(|one| one.improves && one.is_large() && one.parameters.len() > 1)
}

/// The parameters by their effect on a mode, the largest first. Of a mode that is near a merging the µ of that counts.
fn levers(
    found: &Sensitivities,
    mode: &ModeSensitivity,
    critical: Option<&CriticalFriction>,
) -> Vec<Lever> {
    let effects: Vec<(Effect<'_>, bool)> = match (critical, &mode.merging) {
        (Some(critical), _) => {
            critical_effects(critical).into_iter().map(|effect| (effect, true)).collect()
        }
        (None, Some(merging)) => {
            merging_effects(found, merging).into_iter().map(|effect| (effect, true)).collect()
        }
        (None, None) => {
            mode_effects(found, mode).into_iter().map(|effect| (effect, false)).collect()
        }
    };
    let lever = |(effect, is_of_friction): &(Effect<'_>, bool)| {
        let change = effect.largest()[0];
        if effect.is_by_unit() || change == 0.0 {
            return None;
        }
        // A merging, or a beginning of growth, at a larger µ is farther away.
        let way = if *is_of_friction { change.signum() } else { -change.signum() };
        let rates = effect.changes.iter().map(|one| way * one[0] / CHANGE);
        let slope = (!is_of_friction).then(|| rates.fold(f64::NEG_INFINITY, f64::max));
        let parameter = effect.parameter;
        Some(Lever { name: parameter.name.clone(), value: parameter.value, way, slope })
    };
    effects.iter().filter_map(lever).collect()
}

/// The scene after changes by parts.
fn changed(scene: &Scene, levers: &[(&Lever, f64)]) -> Result<Scene, Error> {
    let mut scene = scene.clone();
    for (lever, part) in levers {
        assign(&mut scene, &lever.name, lever.after(*part))?;
    }
    scene.check()?;
    Ok(scene)
}

fn change(
    scene: &Scene,
    mode: &ModeSensitivity,
    levers: &[(&Lever, f64)],
    onset: &OnsetOf<'_>,
) -> Result<Change, Error> {
    let changed = changed(scene, levers)?;
    let Verdict { growth, growing } = verdict(&changed, None)?;
    let slopes = levers.iter().map(|(lever, part)| Some(lever.slope? * part));
    let predicted = slopes.sum::<Option<f64>>().map(|change| mode.growth_rate() + change);
    Ok(Change {
        parameters: levers
            .iter()
            .map(|(lever, part)| (lever.name.clone(), lever.way * part))
            .collect(),
        values: levers.iter().map(|(lever, part)| [lever.value, lever.after(*part)]).collect(),
        predicted,
        computed: growth,
        growing: growing.len(),
        onset: onset(&changed),
        improves: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;
    use amontons_analysis::stability::{Linearised, sensitivities};

    /// An eigenvalue that has merged with another one has no derivatives. That is not an effect of zero.
    #[test]
    fn effects_on_a_mode_without_derivatives_are_unknown_and_not_zero() {
        let scene = builtin("disc_brake").unwrap().scene();
        let here = Linearised::of(&scene);
        let states = here.uniform_sliding().unwrap();
        let mut found = sensitivities(&here, &states, [0.0, 1e4], &|_, _| {}).unwrap();
        let of = |found: &Sensitivities| {
            let (growing, growth) = (1, f64::INFINITY);
            let before = Before { growing, growth, rounding: 0.0, onset: Onset::NotSought };
            changes(&scene, found, None, &|_| Onset::NotSought, &before, Watch::IDLE)
        };
        assert!(!of(&found).unwrap().is_empty());
        found.modes.iter_mut().for_each(|mode| (mode.derivatives, mode.merging) = (None, None));
        let reason = of(&found).unwrap_err();
        assert!(reason.contains("equal to another mode with the same shape"), "{reason}");
    }

    #[test]
    fn a_change_helps_if_growth_falls_or_begins_at_a_larger_friction() {
        let after = |growth: f64, growing: usize, onset: Onset| Change {
            parameters: vec![("mass.disc.mass".to_owned(), 0.1)],
            values: vec![[1.0, 1.1]],
            predicted: None,
            computed: Some(growth),
            growing,
            onset,
            improves: false,
        };
        let grows = Before { growing: 2, growth: 5.0, rounding: 1e-6, onset: Onset::At(0.3) };
        assert!(grows.is_improved_by(&after(4.0, 2, Onset::At(0.2))));
        assert!(grows.is_improved_by(&after(5.0, 1, Onset::NotSought)));
        assert!(!grows.is_improved_by(&after(5.0, 2, Onset::At(0.4))));
        assert!(!grows.is_improved_by(&after(6.0, 1, Onset::At(0.4))));
        let quiet = Before { growing: 0, growth: -5.0, rounding: 1e-6, onset: Onset::At(0.5) };
        assert!(quiet.is_improved_by(&after(-4.0, 0, Onset::At(0.6))));
        assert!(quiet.is_improved_by(&after(-4.0, 0, Onset::Outside([0.4, 0.7]))));
        assert!(!quiet.is_improved_by(&after(-6.0, 0, Onset::At(0.5 + 1e-9))));
        assert!(!quiet.is_improved_by(&after(1.0, 1, Onset::At(0.6))));
        let far = Before { onset: Onset::Outside([0.4, 0.7]), ..quiet };
        assert!(far.is_improved_by(&after(-6.0, 0, Onset::Outside([0.4, 0.7]))));
        assert!(!far.is_improved_by(&after(-6.0, 0, Onset::At(0.6))));
        assert!(!far.is_improved_by(&after(-5.0, 0, Onset::Outside([0.4, 0.7]))));
    }
}
