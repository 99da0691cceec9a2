//! The paper's aim: ranges of µ that can be bi-stable, because uniform sliding is stable there while
//! another contact state, into which a push can bring the system, is not.

use super::growth::growth;
use super::linearised::Linearised;
use super::locus::{ALL_FREQUENCIES, Crossing, Locus, Root, all_roots, locus};
use super::parallel;
use super::state_energy::{StateEnergy, state_energy};
use super::states::StateClasses;
use crate::watch::Watch;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::{Contact, LumpedModel};
use amontons::numerics::bisect;
use amontons::scene::Scene;
use std::f64::consts::TAU;

/// Bi-stability over a range of µ.
#[derive(Clone, Debug, PartialEq)]
pub struct Bistability {
    /// The range that was analysed: the range that was asked for, up to the static friction.
    pub range: [f64; 2],
    /// Ranges of µ in which there is an equilibrium in uniform sliding, in the same contact state as at the first value.
    pub equilibrium: Vec<[f64; 2]>,
    /// The least µ of those looked at with an equilibrium in another contact state, and that state: other contacts are
    /// closed there, and the analysis leaves it out.
    pub other: Option<(f64, Vec<ContactState>)>,
    /// Values of µ at which modes of uniform sliding begin or cease to grow in the ranges, by µ.
    pub uniform: Vec<Crossing>,
    /// Ranges of µ in which there is an equilibrium that no mode leaves.
    pub stable: Vec<[f64; 2]>,
    /// Modes of other states that grow inside a stable range, by what a motion needs to reach the state, then by µ.
    pub candidates: Vec<Candidate>,
    /// The widest step in µ from look to look at a state. What grows over less of µ is found where two modes come near each
    /// other, or where one diverges; else it may be missed.
    pub widest: f64,
}

/// A mode of another state that grows while uniform sliding is stable: a candidate for a bi-stable
/// range, which only a transient can confirm.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The contact state; symmetry of masses and stiffnesses makes the modes of `alike` states equal, itself included. Where
    /// loads are not symmetric, too, this is the one that needs least.
    pub states: Vec<ContactState>,
    /// Number of states that symmetry makes equal to this one, itself included.
    pub alike: usize,
    /// Range of µ in which the mode grows while uniform sliding does not.
    pub range: [f64; 2],
    /// `true` if the mode begins to grow at the range's start; `false` if it grew before.
    pub begins: bool,
    /// The mode's frequency at the range's start, Hz.
    pub frequency_hz: f64,
    /// Frequency, Hz, and growth rate, 1/s, at the range's end.
    pub at_end: [f64; 2],
    /// The least that a motion has had before the contacts were in this state, at the end of the range where that is
    /// less; `None` where no motion can reach it.
    pub reach: Option<StateEnergy>,
}

/// The one state in which a model with all contacts closed can be at rest in its own frame: each contact slides by the
/// sign of its velocity, the slider's or its own, and sticks where that is zero.
#[must_use]
pub fn closed_at_rest(model: &LumpedModel) -> Vec<ContactState> {
    model.contacts.iter().map(Contact::resting_state).collect()
}

/// The widest step in µ over which uniform sliding is followed.
const STEP: f64 = 0.01;
/// The fewest steps in a range.
const FEWEST_STEPS: f64 = 200.0;
/// Number of analyses of contact states to aim at, all classes and values of µ together, besides those that locate
/// where modes begin and cease to grow: half a minute of work for a ring of eight modules, which has 4435 classes.
const LOOKS: f64 = 200_000.0;
/// The fewest steps of a class, whatever the number of classes.
const FEWEST_STEPS_OF_A_CLASS: f64 = 40.0;

/// Analyses all states of a scene over a range of µ, that of `friction.coefficient` alone, on all cores. Values
/// above the static friction, which stays as it is, are left out. The watch receives the part of the classes of states
/// that are done, and can end the analysis.
///
/// # Errors
/// Returns an error if a surface stands still ([`Linearised::uniform_sliding`]), there is no equilibrium in the whole range, the
/// range is above the static friction, there are too many contacts, a state cannot be analysed, or the watch has ended
/// the analysis.
pub fn bistability(scene: &Scene, range: [f64; 2], watch: Watch<'_>) -> Result<Bistability, Error> {
    let [first, last] = possible_range(scene, range)?;
    let at = |mu: f64| Linearised::of(&Scene { friction_coefficient: mu, ..scene.clone() });
    let here = at(first);
    let uniform_state = here.uniform_sliding()?;
    let classes = StateClasses::of(here.model())?;
    let has_equilibrium = |mu: f64| at(mu).equilibrium_in(&uniform_state).map(|_| ());
    let steps = ((last - first) / STEP).ceil().max(FEWEST_STEPS);
    let values = spread([first, last], steps);
    let equilibrium = equilibrium_ranges(&has_equilibrium, &values);
    let other = values.iter().find_map(|&mu| {
        let there = at(mu);
        let states = there.equilibrium().ok()?.states(there.model());
        (states != uniform_state).then_some((mu, states))
    });
    if equilibrium.is_empty() {
        has_equilibrium(first)?;
    }
    let (mut uniform, mut stable) = (Vec::new(), Vec::new());
    for &[from, to] in equilibrium.iter().filter(|[from, to]| from < to) {
        let steps = ((to - from) / STEP).ceil().max(FEWEST_STEPS);
        let found = locus(
            &|mu| Ok(at(mu)),
            &uniform_state,
            &spread([from, to], steps),
            ALL_FREQUENCIES,
            &|_, _| {},
        )?;
        stable.extend(stable_ranges(&found));
        uniform.extend(found.crossings);
    }
    // Two ranges may touch but for rounding.
    stable.retain(|[from, to]| to - from > 1e-9 * to.abs());
    #[allow(clippy::cast_precision_loss)]
    let steps = (LOOKS / classes.representatives.len() as f64)
        .floor()
        .clamp(FEWEST_STEPS_OF_A_CLASS, FEWEST_STEPS);
    let loads_are_alike = loads_are_alike(&here);
    let look = |class: usize| {
        watch.check()?;
        let states = &classes.representatives[class];
        let members: Vec<&Vec<ContactState>> =
            if loads_are_alike { vec![states] } else { classes.members(class).collect() };
        let mut found = Vec::new();
        for &range in stable.iter().filter(|_| *states != uniform_state) {
            let modes = |mu: f64| all_roots(at(mu).linear()?, states);
            for growth in growth(&modes, &spread(range, steps))? {
                // A mode that two states share ceases to grow in the one where it begins to in the other, but for
                // rounding.
                let [from, to] = growth.range;
                if to - from > 1e-9 * to.abs() {
                    found.push((least_reach(&at, growth.range, &members)?, growth));
                }
            }
        }
        Ok(found)
    };
    let found = parallel::collect(
        classes.representatives.len(),
        &look,
        &watch.parts(classes.representatives.len()),
    )?;
    let mut candidates = Vec::new();
    for (class, found) in found.into_iter().enumerate() {
        let alike = classes.members(class).count();
        for ((states, reach), growth) in found {
            candidates.push(Candidate {
                states,
                alike,
                reach,
                range: growth.range,
                begins: growth.begins,
                frequency_hz: growth.frequency_hz(0),
                at_end: [growth.frequency_hz(1), growth.ends[1].lambda.re],
            });
        }
    }
    sort(&mut candidates);
    let widest = stable.iter().map(|[from, to]| (to - from) / steps).fold(0.0, f64::max);
    Ok(Bistability {
        range: [first, last],
        equilibrium,
        other,
        uniform,
        stable,
        candidates,
        widest,
    })
}

/// The candidates at the friction of a scene alone, as those of [`bistability`]: modes of other states that grow, each with a
/// range that has only this µ. No mode of uniform sliding grows here. The watch receives the part of the classes of states that
/// are done, and can end the analysis.
///
/// # Errors
/// Returns the errors of [`bistability`].
pub fn candidates_at(scene: &Scene, watch: Watch<'_>) -> Result<Vec<Candidate>, Error> {
    let mu = scene.friction_coefficient;
    let here = Linearised::of(scene);
    here.equilibrium()?;
    let uniform_state = here.uniform_sliding()?;
    let classes = StateClasses::of(here.model())?;
    let loads_are_alike = loads_are_alike(&here);
    let count = classes.representatives.len();
    let look = |class: usize| {
        watch.check()?;
        let states = &classes.representatives[class];
        if *states == uniform_state {
            return Ok(Vec::new());
        }
        let mut growing = all_roots(here.linear()?, states)?;
        growing.retain(|root| root.grows());
        if growing.is_empty() {
            return Ok(Vec::new());
        }
        let members: Vec<&Vec<ContactState>> =
            if loads_are_alike { vec![states] } else { classes.members(class).collect() };
        let (states, reach) = least_reach(&|_| here.clone(), [mu; 2], &members)?;
        let alike = classes.members(class).count();
        let of_root = |root: Root| {
            let frequency_hz = root.lambda.im / TAU;
            Candidate {
                states: states.clone(),
                alike,
                range: [mu; 2],
                begins: false,
                frequency_hz,
                at_end: [frequency_hz, root.lambda.re],
                reach,
            }
        };
        Ok(growing.into_iter().map(of_root).collect())
    };
    let found = parallel::collect(count, &look, &watch.parts(count))?;
    let mut candidates: Vec<Candidate> = found.into_iter().flatten().collect();
    sort(&mut candidates);
    Ok(candidates)
}

/// `true` if all contacts carry the same load at rest: states whose modes are alike then need the same.
fn loads_are_alike(here: &Linearised) -> bool {
    here.equilibrium().is_ok_and(|equilibrium| {
        let forces = &equilibrium.normal_force;
        forces.iter().all(|force| (force - forces[0]).abs() <= 1e-9 * forces[0].abs())
    })
}

/// Sorts candidates by what a motion needs to reach them, then by µ.
fn sort(candidates: &mut [Candidate]) {
    let need = |candidate: &Candidate| candidate.reach.map_or(f64::INFINITY, |reach| reach.energy);
    candidates.sort_by(|a, b| need(a).total_cmp(&need(b)).then(a.range[0].total_cmp(&b.range[0])));
}

/// Finds the state that is easiest to reach, at the end of a range of µ where that is easiest, and what a motion needs to
/// reach it.
fn least_reach(
    at: &dyn Fn(f64) -> Linearised,
    range: [f64; 2],
    members: &[&Vec<ContactState>],
) -> Result<(Vec<ContactState>, Option<StateEnergy>), Error> {
    let mut least: (&Vec<ContactState>, Option<StateEnergy>) = (members[0], None);
    for here in range.map(at) {
        for states in members {
            let found = state_energy(&here, states)?;
            let energy =
                |reach: Option<StateEnergy>| reach.map_or(f64::INFINITY, |reach| reach.energy);
            // States that symmetry makes equal differ by rounding.
            if energy(found) < energy(least.1) * (1.0 - 1e-9) {
                least = (states, found);
            }
        }
    }
    Ok((least.0.clone(), least.1))
}

/// The part of a range of µ that the scene's static friction leaves possible.
///
/// # Errors
/// Returns an error if there is none.
fn possible_range(scene: &Scene, [first, last]: [f64; 2]) -> Result<[f64; 2], Error> {
    match scene.greatest_friction() {
        Some(greatest) if first >= greatest => Err(Error::argument(format!(
            "the range of friction.coefficient begins at {first}, which is not below the static friction, {greatest}: \
             begin the range below {greatest}"
        ))),
        greatest => Ok([first, greatest.map_or(last, |greatest| last.min(greatest))]),
    }
}

/// Values from one to another in this many steps.
pub(crate) fn spread([first, last]: [f64; 2], steps: f64) -> Vec<f64> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let count = steps as u32;
    let at =
        |i: u32| if i == count { last } else { first + (last - first) * (f64::from(i) / steps) };
    (0..=count).map(at).collect()
}

/// The ranges of a parameter, of which there are ascending values, in which there is an equilibrium;
/// their ends are bisected.
pub fn equilibrium_ranges(
    has_equilibrium: &dyn Fn(f64) -> Result<(), Error>,
    values: &[f64],
) -> Vec<[f64; 2]> {
    let is_there: Vec<bool> = values.iter().map(|&value| has_equilibrium(value).is_ok()).collect();
    let mut ranges = Vec::new();
    let mut start = is_there[0].then_some(values[0]);
    for (pair, there) in values.windows(2).zip(is_there.windows(2)) {
        if there[0] == there[1] {
            continue;
        }
        let is_as_below = |value| has_equilibrium(value).is_ok() == there[0];
        let [low, high] = bisect(pair[0], pair[1], is_as_below);
        match start.take() {
            Some(start) => ranges.push([start, low]),
            None => start = Some(high),
        }
    }
    ranges.extend(start.map(|start| [start, values[values.len() - 1]]));
    ranges
}

/// The ranges of a locus in which no mode grows.
pub(crate) fn stable_ranges(locus: &Locus) -> Vec<[f64; 2]> {
    let mut growing: Vec<[f64; 2]> =
        (0..locus.branches.len()).flat_map(|mode| growing_ranges(locus, mode)).collect();
    growing.sort_by(|a, b| a[0].total_cmp(&b[0]));
    gaps(&growing, locus.values[0], locus.values[locus.values.len() - 1])
}

/// The ranges of the parameter in which a mode grows.
fn growing_ranges(locus: &Locus, mode: usize) -> Vec<[f64; 2]> {
    let (first, last) = (locus.values[0], locus.values[locus.values.len() - 1]);
    let mut start = locus.grows_at_first(mode).then_some(first);
    let mut ranges = Vec::new();
    for crossing in locus.turns().filter(|crossing| crossing.mode == mode) {
        if crossing.becomes_unstable {
            start = Some(crossing.value);
        } else if let Some(start) = start.take() {
            ranges.push([start, crossing.value]);
        }
    }
    ranges.extend(start.map(|start| [start, last]));
    ranges
}

/// The parts of an interval that ranges, sorted by their starts, leave uncovered.
fn gaps(ranges: &[[f64; 2]], first: f64, last: f64) -> Vec<[f64; 2]> {
    let (mut gaps, mut from) = (Vec::new(), first);
    for range in ranges {
        if range[0] > from {
            gaps.push([from, range[0]]);
        }
        from = from.max(range[1]);
    }
    if from < last {
        gaps.push([from, last]);
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::builtin;

    #[test]
    fn what_is_left_between_ranges() {
        assert_eq!(gaps(&[], 0.0, 1.0), [[0.0, 1.0]]);
        assert_eq!(gaps(&[[0.2, 0.5], [0.3, 0.4], [0.7, 1.0]], 0.0, 1.0), [[0.0, 0.2], [0.5, 0.7]]);
    }

    #[test]
    fn nothing_is_stable_where_there_is_no_equilibrium() {
        // On a slider that slopes the other way friction draws the masses into it, until they jam.
        let mut scene = builtin("set2").unwrap().scene();
        scene.slider.angle = -0.5;
        let found = bistability(&scene, [0.0, 6.0], Watch::IDLE).unwrap();
        let [[from, to]] = found.equilibrium[..] else { panic!("{:?}", found.equilibrium) };
        assert!(from == 0.0 && to < 6.0);
        let exists = |mu: f64| {
            let scene = Scene { friction_coefficient: mu, ..scene.clone() };
            amontons::assembly::equilibrium(&scene, &LumpedModel::from(&scene)).is_ok()
        };
        assert!(exists(to) && !exists(to + 1e-9));
        for range in found.stable.iter().chain(found.candidates.iter().map(|c| &c.range)) {
            assert!(range[1] <= to);
        }
        let nowhere = bistability(&scene, [to + 0.1, 6.0], Watch::IDLE).unwrap_err();
        assert!(nowhere.is_equilibrium(), "{nowhere}");
    }

    /// Without friction the load opens contact 2; the slider's drag closes it.
    #[test]
    fn an_equilibrium_with_other_contacts_closed_is_left_out_and_told() {
        let mut scene = builtin("set1").unwrap().scene();
        scene.slider.angle = -0.5;
        scene.modules_mut()[1].preload = -2e-3;
        let found = bistability(&scene, [0.0, 1.96], Watch::IDLE).unwrap();
        let [[from, to]] = found.equilibrium[..] else { panic!("{:?}", found.equilibrium) };
        let (other, states) = found.other.unwrap();
        assert_eq!(states, [ContactState::Slide; 2]);
        assert!(from == 0.0 && to <= other && other - to < 0.01, "{to} {other}");
        let gap = |mu: f64| {
            let scene = Scene { friction_coefficient: mu, ..scene.clone() };
            amontons::assembly::equilibrium(&scene, &LumpedModel::from(&scene)).unwrap().gap[1]
        };
        assert!(gap(to) > 0.0 && gap(to + 1e-9) == 0.0);
        assert!(found.candidates.iter().all(|candidate| candidate.range[1] <= to));
    }

    /// Equal modules of which one is pressed on less: what a push needs does not depend on which of them it is.
    #[test]
    fn a_loose_contact_of_a_ring_is_a_candidate_wherever_it_stands() {
        let needs = |loose: usize| {
            let mut scene = builtin("set1").unwrap().scene();
            scene.modules_mut().extend_from_within(..);
            scene.slider.velocity = 0.1;
            scene.modules_mut()[loose].preload = -1e-3;
            let found = bistability(&scene, [0.9, 1.18], Watch::IDLE).unwrap();
            let needs = found.candidates.iter().map(|candidate| candidate.reach.unwrap().energy);
            needs.collect::<Vec<_>>()
        };
        let first = needs(0);
        // It opens at almost no load, and does so in one of its states at least.
        assert!(first[0] < 1e-6 && first.last().unwrap() > &1e-3, "{first:?}");
        for loose in 1..4 {
            let other = needs(loose);
            assert_eq!(other.len(), first.len());
            for (a, b) in first.iter().zip(&other) {
                assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
            }
        }
    }
}
