//! The paper's aim: ranges of µ that can be bi-stable, because uniform sliding is stable there while
//! another contact state, into which a push can bring the system, is not.

use super::locus::{Crossing, Locus, Root, locus, roots};
use super::parallel;
use super::states::StateClasses;
use crate::Error;
use crate::contact::ContactState;
use crate::model::{Contact, LumpedModel};
use std::f64::consts::TAU;

/// What a range of µ holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Bistability {
    /// Where modes of uniform sliding begin or cease to grow, by µ.
    pub uniform: Vec<Crossing>,
    /// Ranges of µ in which uniform sliding is stable.
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

/// The state of uniform sliding at this slider velocity, or at a contact's own.
#[must_use]
pub fn uniform_sliding(model: &LumpedModel, slider_velocity: f64) -> Vec<ContactState> {
    let state = |contact: &Contact| match contact.velocity(slider_velocity) {
        velocity if velocity < 0.0 => ContactState::ReverseSlide,
        _ => ContactState::Slide,
    };
    model.contacts.iter().map(state).collect()
}

/// Looks through all states over ascending values of µ, on all cores; `done` hears how many are done.
///
/// # Errors
/// A slider that stands still, too many contacts, or a state that cannot be analysed.
pub fn bistability(
    model: &LumpedModel,
    slider_velocity: f64,
    values: &[f64],
    done: &(dyn Fn(usize) + Sync),
) -> Result<Bistability, Error> {
    if slider_velocity == 0.0 {
        return Err(Error::analysis(
            "the slider stands still, so nothing slides: give slider.velocity another value",
        ));
    }
    let follow = |states: &[ContactState]| -> Result<Locus, Error> {
        locus(&|mu| roots(model, states, mu), values)
    };
    let uniform_state = uniform_sliding(model, slider_velocity);
    let uniform = follow(&uniform_state)?;
    let mut growing: Vec<[f64; 2]> =
        (0..uniform.branches.len()).flat_map(|mode| growing_ranges(&uniform, mode)).collect();
    growing.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let stable = gaps(&growing, values[0], values[values.len() - 1]);
    let classes = StateClasses::of(model)?;
    let loci = parallel::collect(
        classes.representatives.len(),
        &|class| {
            let states = &classes.representatives[class];
            // Contacts that contradict each other leave modes only at µ = 0.
            let count = |mu| Ok::<_, Error>(roots(model, states, mu)?.len());
            let is_possible = count(values[0])? == count(values[values.len() - 1])?;
            is_possible.then(|| follow(states)).transpose()
        },
        done,
    )?;
    let mut candidates = Vec::new();
    for (class, (states, other)) in classes.representatives.iter().zip(&loci).enumerate() {
        let Some(other) = other.as_ref().filter(|_| *states != uniform_state) else { continue };
        let alike = classes.size(class);
        for mode in 0..other.branches.len() {
            for range in growing_ranges(other, mode) {
                for stable in &stable {
                    let common = [range[0].max(stable[0]), range[1].min(stable[1])];
                    if common[0] < common[1] {
                        let at = |mu: f64| root_of(model, states, other, mode, mu);
                        let (start, end) = (at(common[0])?, at(common[1])?);
                        candidates.push(Candidate {
                            states: states.clone(),
                            alike,
                            range: common,
                            begins: range[0] > values[0] && common[0] == range[0],
                            frequency_hz: start.lambda.im / TAU,
                            at_end: [end.lambda.im / TAU, end.lambda.re],
                        });
                    }
                }
            }
        }
    }
    candidates.sort_by(|a, b| a.range[0].total_cmp(&b.range[0]));
    let mut crossings = uniform.crossings;
    crossings.sort_by(|a, b| a.value.total_cmp(&b.value));
    Ok(Bistability { uniform: crossings, stable, candidates })
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

/// The root at `mu` of a mode that is known on the locus's values: the nearest to the line between
/// its neighbours.
fn root_of(
    model: &LumpedModel,
    states: &[ContactState],
    locus: &Locus,
    mode: usize,
    mu: f64,
) -> Result<Root, Error> {
    let after = locus.values.partition_point(|value| *value < mu).clamp(1, locus.values.len() - 1);
    let (low, high) = (locus.values[after - 1], locus.values[after]);
    let (from, to) = (locus.branches[mode][after - 1].sigma, locus.branches[mode][after].sigma);
    let expected = from + (to - from) * ((mu - low) / (high - low));
    let distance = |root: &Root| (root.sigma - expected).norm();
    let found = roots(model, states, mu)?;
    let nearest = found.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.ok_or_else(|| Error::analysis("the state has no modes"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;
    use crate::stability::Spectrum;

    #[test]
    fn what_is_left_between_ranges() {
        assert_eq!(gaps(&[], 0.0, 1.0), [[0.0, 1.0]]);
        assert_eq!(gaps(&[[0.2, 0.5], [0.3, 0.4], [0.7, 1.0]], 0.0, 1.0), [[0.0, 0.2], [0.5, 0.7]]);
    }

    /// The largest growth rate over a state, by another route than following its modes.
    fn growth(model: &LumpedModel, states: &[ContactState], mu: f64) -> f64 {
        Spectrum::of(model, states, mu).unwrap().growth_rate()
    }

    #[test]
    fn every_onset_of_set_2_is_a_change_of_sign_of_the_largest_growth_rate() {
        let model = LumpedModel::from(&builtin("set2").unwrap().scene());
        let values: Vec<f64> = (0..=250).map(|i| 0.01 * f64::from(i)).collect();
        let found = bistability(&model, 0.025, &values, &|_| {}).unwrap();
        let names: Vec<String> = found
            .candidates
            .iter()
            .map(|c| crate::contact::Joined(&c.states).to_string())
            .collect();
        assert!(names.contains(&"Sl-St".to_owned()), "{names:?}");
        let uniform = uniform_sliding(&model, 0.025);
        let turn = found.uniform[0].value;
        assert!(growth(&model, &uniform, turn - 1e-9) < 0.0);
        assert!(growth(&model, &uniform, turn + 1e-9) > 0.0);
        assert_eq!(found.stable, [[0.0, turn]]);
        let mut firsts = std::collections::HashMap::new();
        for candidate in &found.candidates {
            firsts.entry(&candidate.states).or_insert(candidate);
            assert!(growth(&model, &candidate.states, candidate.range[0] + 1e-9) > 0.0);
        }
        for (states, first) in firsts {
            assert!(first.begins && growth(&model, states, first.range[0] - 1e-9) < 0.0);
        }
    }
}
