//! The paper's aim: ranges of µ that can be bi-stable, because uniform sliding is stable there while
//! another contact state, into which a push can bring the system, is not.

use super::locus::{Crossing, Locus, Root, between, locus, on_branch, roots};
use super::parallel;
use super::states::StateClasses;
use super::symmetry::{Part, all_stiffness_eigenvalues};
use crate::Error;
use crate::contact::ContactState;
use crate::model::{Contact, LumpedModel};
use crate::scene::Scene;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// What a range of µ holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Bistability {
    /// Ranges of µ in which there is an equilibrium in uniform sliding.
    pub equilibrium: Vec<[f64; 2]>,
    /// Where modes of uniform sliding begin or cease to grow in them, by µ.
    pub uniform: Vec<Crossing>,
    /// Ranges of µ in which there is an equilibrium that no mode leaves.
    pub stable: Vec<[f64; 2]>,
    /// Modes of other states that grow inside a stable range, by µ.
    pub candidates: Vec<Candidate>,
}

/// A mode of another state that grows while uniform sliding is stable: a candidate for a bi-stable
/// range, which only a transient can confirm.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The contact state; symmetry makes `alike` states equal to it, itself included.
    pub states: Vec<ContactState>,
    /// How many states symmetry makes equal to this one.
    pub alike: usize,
    /// From which µ on, and up to which, the mode grows while uniform sliding does not.
    pub range: [f64; 2],
    /// Does the mode begin to grow at the range's start (or did it grow before)?
    pub begins: bool,
    /// The mode's frequency at the range's start, Hz.
    pub frequency_hz: f64,
    /// Frequency, Hz, and growth rate, 1/s, at the range's end.
    pub at_end: [f64; 2],
}

/// The one state in which a model can be at rest in its own frame: each contact slides by the sign of
/// its velocity, the slider's or its own, and sticks where that is zero.
#[must_use]
pub fn resting_state(model: &LumpedModel, slider_velocity: f64) -> Vec<ContactState> {
    let state = |contact: &Contact| match contact.velocity(slider_velocity) {
        v if v > 0.0 => ContactState::Slide,
        v if v < 0.0 => ContactState::ReverseSlide,
        _ => ContactState::Stick,
    };
    model.contacts.iter().map(state).collect()
}

/// The state of uniform sliding: the resting state, where that has every contact sliding.
///
/// # Errors
/// What a contact rubs on stands still.
pub fn uniform_sliding(
    model: &LumpedModel,
    slider_velocity: f64,
) -> Result<Vec<ContactState>, Error> {
    let states = resting_state(model, slider_velocity);
    let Some(stuck) = states.iter().position(|state| *state == ContactState::Stick) else {
        return Ok(states);
    };
    let problem = match model.contacts[stuck].own.slider_velocity {
        None => {
            "the slider stands still, so nothing slides: give slider.velocity another value".into()
        }
        Some(_) => format!(
            "what contact {} rubs on stands still, so it does not slide: give it another velocity",
            stuck + 1
        ),
    };
    Err(Error::analysis(format!(
        "{problem}, or name a contact state with --state where a command has it"
    )))
}

/// The widest step in µ over which modes are followed; a mode that grows only in a range narrower
/// than this may be missed.
const STEP: f64 = 0.01;
/// The fewest steps in a range.
const FEWEST_STEPS: f64 = 200.0;

/// Looks through all states of a scene over a range of µ, on all cores; `done` hears how many
/// classes of states are done.
///
/// # Errors
/// As [`uniform_sliding`], no equilibrium in the whole range, too many contacts, or a state that
/// cannot be analysed.
pub fn bistability(
    scene: &Scene,
    [first, last]: [f64; 2],
    done: &(dyn Fn(usize) + Sync),
) -> Result<Bistability, Error> {
    let model = &LumpedModel::from(scene);
    let uniform_state = uniform_sliding(model, scene.slider.velocity)?;
    let classes = StateClasses::of(model)?;
    let steps = ((last - first) / STEP).ceil().max(FEWEST_STEPS);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let values: Vec<f64> =
        (0..=steps as u32).map(|i| first + (last - first) * (f64::from(i) / steps)).collect();
    let has_equilibrium = |mu: f64| {
        let scene = Scene { friction_coefficient: mu, ..scene.clone() };
        crate::model::equilibrium(&scene, model).map(|_| ())
    };
    let equilibrium = equilibrium_ranges(&has_equilibrium, &values);
    if equilibrium.is_empty() {
        has_equilibrium(first)?;
    }
    let follow = |states: &[ContactState]| -> Result<Locus, Error> {
        locus(&|mu| Ok((Cow::Borrowed(model), mu)), states, &values, &|_, _| {})
    };
    let uniform = follow(&uniform_state)?;
    let mut growing: Vec<[f64; 2]> =
        (0..uniform.branches.len()).flat_map(|mode| growing_ranges(&uniform, mode)).collect();
    growing.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let stable = common(&equilibrium, &gaps(&growing, first, last));
    let loci = parallel::collect(
        classes.representatives.len(),
        &|class| {
            let states = &classes.representatives[class];
            // Contacts that contradict each other leave modes only at µ = 0.
            let count = |mu| Ok::<_, Error>(all_stiffness_eigenvalues(model, states, mu)?.len());
            let is_possible = count(first)? == count(last)?;
            is_possible.then(|| follow(states)).transpose()
        },
        done,
    )?;
    let mut candidates = Vec::new();
    for (class, (states, other)) in classes.representatives.iter().zip(&loci).enumerate() {
        let Some(other) = other.as_ref().filter(|_| *states != uniform_state) else { continue };
        let alike = classes.size(class);
        for mode in 0..other.branches.len() {
            for growing in growing_ranges(other, mode) {
                for range in common(&[growing], &stable) {
                    let at = |mu: f64| root_of(model, states, other, mode, mu);
                    let (start, end) = (at(range[0])?, at(range[1])?);
                    candidates.push(Candidate {
                        states: states.clone(),
                        alike,
                        range,
                        begins: growing[0] > first && range[0] == growing[0],
                        frequency_hz: start.lambda.im / TAU,
                        at_end: [end.lambda.im / TAU, end.lambda.re],
                    });
                }
            }
        }
    }
    candidates.sort_by(|a, b| a.range[0].total_cmp(&b.range[0]));
    let exists = |mu: f64| equilibrium.iter().any(|[from, to]| (*from..=*to).contains(&mu));
    let uniform = uniform.crossings.into_iter().filter(|crossing| exists(crossing.value)).collect();
    Ok(Bistability { equilibrium, uniform, stable, candidates })
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
        let (mut low, mut high) = (pair[0], pair[1]);
        while let Some(middle) = between(low, high) {
            let side =
                if has_equilibrium(middle).is_ok() == there[0] { &mut low } else { &mut high };
            *side = middle;
        }
        match start.take() {
            Some(start) => ranges.push([start, low]),
            None => start = Some(high),
        }
    }
    ranges.extend(start.map(|start| [start, values[values.len() - 1]]));
    ranges
}

/// The ranges of the parameter in which a mode grows.
fn growing_ranges(locus: &Locus, mode: usize) -> Vec<[f64; 2]> {
    let (first, last) = (locus.values[0], locus.values[locus.values.len() - 1]);
    let mut start = (locus.branches[mode][0].lambda.re > 0.0).then_some(first);
    let mut ranges = Vec::new();
    for crossing in locus.crossings.iter().filter(|crossing| crossing.mode == mode) {
        if crossing.becomes_unstable {
            start = Some(crossing.value);
        } else if let Some(start) = start.take() {
            ranges.push([start, crossing.value]);
        }
    }
    ranges.extend(start.map(|start| [start, last]));
    ranges
}

/// What ranges, sorted by their starts, leave of an interval.
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

/// What two lists of ranges have in common.
fn common(a: &[[f64; 2]], b: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| [a[0].max(b[0]), a[1].min(b[1])]));
    // Where two states share a mode, its ranges end where they begin but for rounding.
    pairs.filter(|[from, to]| to - from > 1e-9 * to.abs()).collect()
}

/// The root at `mu` of a mode that is known on the locus's values.
fn root_of(
    model: &LumpedModel,
    states: &[ContactState],
    locus: &Locus,
    mode: usize,
    mu: f64,
) -> Result<Root, Error> {
    let after = locus.values.partition_point(|value| *value < mu).clamp(1, locus.values.len() - 1);
    let known = [after - 1, after].map(|i| (locus.values[i], locus.branches[mode][i]));
    let evaluate = |mu| roots(model, states, mu, Part::Whole);
    Ok(on_branch(&evaluate, known, mu)?.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn what_is_left_between_ranges() {
        assert_eq!(gaps(&[], 0.0, 1.0), [[0.0, 1.0]]);
        assert_eq!(gaps(&[[0.2, 0.5], [0.3, 0.4], [0.7, 1.0]], 0.0, 1.0), [[0.0, 0.2], [0.5, 0.7]]);
    }

    #[test]
    fn what_ranges_have_in_common() {
        assert_eq!(common(&[[0.0, 1.0]], &[[0.5, 2.0], [1.0, 3.0]]), [[0.5, 1.0]]);
    }

    #[test]
    fn nothing_is_stable_where_there_is_no_equilibrium() {
        // On a slider that slopes the other way friction draws the masses into it, until they jam.
        let mut scene = builtin("set2").unwrap().scene();
        scene.slider.angle = -0.5;
        let found = bistability(&scene, [0.0, 6.0], &|_| {}).unwrap();
        let [[from, to]] = found.equilibrium[..] else { panic!("{:?}", found.equilibrium) };
        assert!(from == 0.0 && to < 6.0);
        let exists = |mu: f64| {
            let scene = Scene { friction_coefficient: mu, ..scene.clone() };
            crate::model::equilibrium(&scene, &LumpedModel::from(&scene)).is_ok()
        };
        assert!(exists(to) && !exists(to + 1e-9));
        for range in found.stable.iter().chain(found.candidates.iter().map(|c| &c.range)) {
            assert!(range[1] <= to);
        }
        let nowhere = bistability(&scene, [to + 0.1, 6.0], &|_| {}).unwrap_err();
        assert!(nowhere.is_equilibrium(), "{nowhere}");
    }
}
