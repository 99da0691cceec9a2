//! Stability at the start, in words, by eigenvalues.

use super::locus::followed;
use super::{NAMED, can_squeal, markup};
use amontons::Error;
use amontons::contact::{ContactState, JoinedStates};
use amontons::model::{Equilibrium, Uniqueness};
use amontons::scene::Scene;
use amontons::stability::Spectrum;
use amontons_analysis::stability::Linearised;
use amontons_analysis::stability::locus::is_neutral;
use amontons_pictures::picture::significant;
use std::f64::consts::TAU;

/// The most degrees of freedom of which eigenvalues are found in an export: a second of work.
const MOST_DOFS: usize = 256;

/// # Errors
/// Returns an error if the chart cannot be drawn.
pub(super) fn section(effective: &Scene, reference: &Equilibrium) -> Result<String, Error> {
    let mut html = String::new();
    let here = Linearised::about(effective, reference);
    let states = here.resting_state();
    markup::paragraphs(&mut html, &verdict(effective, &here, &states));
    if let Some(words) = others(effective, &here, reference) {
        markup::paragraphs(&mut html, &[words]);
    }
    match followed(effective, here.model(), &states) {
        Err(why) => markup::paragraphs(&mut html, &[why]),
        Ok(found) => {
            let chart = found.chart(effective, &states);
            markup::paragraphs(&mut html, &found.words());
            markup::figure(&mut html, "locus", &chart.svg()?, found.caption());
        }
    }
    Ok(html)
}

/// A sentence on other equilibria; `None` where all contacts are closed in the only one.
fn others(scene: &Scene, here: &Linearised, reference: &Equilibrium) -> Option<String> {
    let has_open = reference.gap.iter().any(|gap| *gap > 0.0);
    match here.model().uniqueness(reference) {
        Uniqueness::One if !has_open => None,
        Uniqueness::One => Some("There is no other equilibrium at these values.".into()),
        Uniqueness::Unknown if !has_open => None,
        Uniqueness::Unknown => {
            Some("Whether there is another equilibrium at these values is unknown.".into())
        }
        Uniqueness::Several(other) => {
            let differ = (0..reference.gap.len())
                .filter(|i| reference.is_closed(*i) != other.is_closed(*i))
                .map(|i| {
                    let is = if reference.is_closed(i) { "open" } else { "closed" };
                    format!("{} {is}", scene.contact_name(i))
                })
                .collect::<Vec<_>>();
            Some(format!(
                "Friction allows another equilibrium at these values, with {}.",
                differ.join(", ")
            ))
        }
    }
}

/// The behaviour of small disturbances at the start, in words.
fn verdict(scene: &Scene, here: &Linearised, states: &[ContactState]) -> Vec<String> {
    let model = here.model();
    let mut words = vec![situation(scene, states)];
    if model.dofs() > MOST_DOFS {
        words.push(format!(
            "With {} degrees of freedom the eigenvalues are not computed during an export; `amontons-stability \
             states` computes them.",
            model.dofs()
        ));
        return words;
    }
    words.push(match here.linear().and_then(|linear| Spectrum::of(linear, states)) {
        Err(error) => format!("The eigenvalues are unknown: {error}."),
        Ok(spectrum) => growth(&spectrum, states, can_squeal(scene)),
    });
    words
}

/// The state of the contacts at the start, in words.
fn situation(scene: &Scene, states: &[ContactState]) -> String {
    let count = states.len();
    if count == 0 {
        return "The scene has no contacts, so nothing can squeal.".into();
    }
    let sliding = states.iter().filter(|state| state.sliding_direction().is_some()).count();
    let open = states.iter().filter(|state| **state == ContactState::Detached).count();
    let named = match count {
        0..=NAMED => format!(" (state {})", JoinedStates(states)),
        _ => String::new(),
    };
    let them = match (count, sliding) {
        (1, _) if open == 1 => "the contact is open".to_owned(),
        _ if open > 0 => {
            let is = if open == 1 { "is" } else { "are" };
            let others = if sliding + open < count {
                ", and the surfaces under the others stand still"
            } else {
                ""
            };
            format!("{open} of {count} contacts {is} open, {sliding} slide{others}")
        }
        (1, 1) => "the contact slides".to_owned(),
        (1, _) => "the surface under the contact stands still".to_owned(),
        (2, 2) => "both contacts slide".to_owned(),
        (_, all) if all == count => format!("all {count} contacts slide"),
        (_, 0) => "the surfaces under the contacts stand still".to_owned(),
        _ => format!(
            "{sliding} of {count} contacts slide, and the surfaces under the others stand still"
        ),
    };
    if can_squeal(scene) {
        format!("At the start values {them}{named}.")
    } else {
        format!("At the start values {them}{named}, without friction: the scene cannot squeal.")
    }
}

/// The eigenvalue that grows fastest, in words.
fn growth(spectrum: &Spectrum, states: &[ContactState], can_squeal: bool) -> String {
    let Some(fastest) = spectrum.fastest_growing() else {
        return "In this state no degree of freedom can move.".into();
    };
    let (rate, frequency) = (fastest.re, fastest.im / TAU);
    let number = |value: f64| significant(value, 5).replace('-', "−");
    let how = match frequency {
        0.0 => "without oscillating".to_owned(),
        _ => format!("at {} Hz", number(frequency)),
    };
    let uniform = states.iter().all(|state| state.sliding_direction().is_some());
    let warned = match can_squeal && uniform {
        true => {
            " A large disturbance may still lead to another motion; `amontons-stability bistable` looks for candidates."
        }
        false => "",
    };
    if is_neutral(fastest) {
        return format!(
            "Small disturbances of this state neither grow nor decay: no damping acts on the motion {how}.{warned}"
        );
    }
    if rate < 0.0 {
        return format!(
            "Small disturbances of this state decay, the slowest by {} 1/s, {how}.{warned}",
            number(-rate)
        );
    }
    let verdict = match (frequency == 0.0, can_squeal) {
        (true, _) => "The scene leaves this state",
        (false, true) => "Yes, it squeals",
        (false, false) => "The scene does not stay at rest",
    };
    format!(
        "{verdict}: small disturbances of this state grow, the fastest by {} 1/s, {how}.",
        number(rate)
    )
}
