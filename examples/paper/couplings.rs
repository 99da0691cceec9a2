//! The coupling of modes in uniform sliding as µ rises, and the onset of growth (Fig. 2a and b).

use super::claims::{claim, half_digit, is_about};
use super::eigenvalues::FRICTION;
use amontons::Error;
use amontons::scene::Scene;
use amontons_analysis::stability::Linearised;
use amontons_analysis::stability::locus::{
    ALL_FREQUENCIES, Coalescence, Crossing, Locus, Root, locus,
};
use amontons_pictures::picture::{Chart, Mark, Panel, Series};
use amontons_pictures::report::Claim;
use std::f64::consts::TAU;

/// Numbers of the modes that couple, from 1.
const LOWER: [usize; 2] = [3, 4];
const UPPER: [usize; 2] = [5, 6];

/// The locus of uniform sliding over µ, as in Fig. 2.
///
/// # Errors
/// Returns an error if the scene is invalid.
pub fn uniform(scene: &Scene) -> Result<Locus, Error> {
    let at = |mu: f64| Linearised::of(&Scene { friction_coefficient: mu, ..scene.clone() });
    let states = at(0.0).uniform_sliding()?;
    let values: Vec<f64> = (0..=700).map(|i| 0.005 * f64::from(i)).collect();
    locus(&|mu| Ok(at(mu)), &states, &values, ALL_FREQUENCIES, &|_, _| {})
}

/// Friction coefficient and frequency (Hz) at which two modes (from 1) merge.
fn merging(locus: &Locus, modes: [usize; 2]) -> Option<[f64; 2]> {
    let is_it = |event: &&Coalescence| event.merge && event.modes.map(|mode| mode + 1) == modes;
    locus.coalescences.iter().find(is_it).map(|event| [event.value, event.frequency_hz])
}

/// Friction coefficient and frequency (Hz) at which one of two modes (from 1) begins to grow.
fn onset(locus: &Locus, modes: [usize; 2]) -> Option<[f64; 2]> {
    let is_it = |event: &&Crossing| event.becomes_unstable && modes.contains(&(event.mode + 1));
    locus.crossings.iter().find(is_it).map(|event| [event.value, event.frequency_hz])
}

/// Numbers of the modes (from 1) that grow at this friction coefficient.
fn grows(locus: &Locus, friction: f64) -> Vec<usize> {
    let place = locus.values.partition_point(|value| *value < friction - 1e-9);
    let modes = 0..locus.branches.len();
    modes.filter(|mode| locus.branches[*mode][place].lambda.re > 0.0).map(|mode| mode + 1).collect()
}

/// Formats numbers of modes as a list.
fn listed(modes: &[usize]) -> String {
    let modes: Vec<String> = modes.iter().map(ToString::to_string).collect();
    if modes.is_empty() { "none".to_owned() } else { modes.join(", ") }
}

/// The claims on Fig. 2(a) and (b).
pub fn claims(set1: &Locus, set2: &Locus) -> Vec<Claim> {
    let both = [set1, set2];
    let told = |found: &Option<[f64; 2]>| {
        found.map_or("nowhere".to_owned(), |[mu, hz]| format!("at µ = {mu:.4} ({hz:.1} Hz)"))
    };
    let [low1, low2] = both.map(|locus| merging(locus, LOWER));
    let [high1, high2] = both.map(|locus| merging(locus, UPPER));
    let mu = |merge: &Option<[f64; 2]>| merge.map_or(f64::NAN, |merge| merge[0]);
    let merges = |locus: &Locus| locus.coalescences.iter().filter(|event| event.merge).count();
    let frequency = |modes: [usize; 2], printed: &str, reason| {
        let onsets = both.map(|locus| onset(locus, modes));
        let [first, second] = modes;
        claim(
            &format!(
                "The coupling of modes {first} and {second} gives, in both sets, an unstable mode at approximately {printed} Hz."
            ),
            format!(
                "one of them begins to grow {} in Set 1, {} in Set 2 (holds if both frequencies are within {} Hz of \
                 {printed} Hz)",
                told(&onsets[0]),
                told(&onsets[1]),
                half_digit(printed)
            ),
            onsets.iter().all(|onset| onset.is_some_and(|[_, hz]| is_about(hz, printed))),
            reason,
        )
    };
    vec![
        claim(
            "Both sets have two modal couplings for 0 ≤ µ ≤ 3.5: of modes 3 and 4, and of modes 5 and 6.",
            format!(
                "Set 1: {} couplings, modes 3 and 4 {}, 5 and 6 {}; Set 2: {} couplings, {} and {}",
                merges(set1),
                told(&low1),
                told(&high1),
                merges(set2),
                told(&low2),
                told(&high2)
            ),
            both.iter().all(|locus| merges(locus) == 2)
                && [low1, low2, high1, high2].iter().all(Option::is_some),
            None,
        ),
        frequency(LOWER, "170", None),
        frequency(
            UPPER,
            "215",
            Some(
                "it holds for Set 2 alone; the paper's own Table 2 has 219.38 Hz for the growing mode of Set 1, and its text \
                 “about 219 Hz”",
            ),
        ),
        claim(
            "In Set 1 modes 5 and 6 merge at a lower µ than modes 3 and 4, in Set 2 at a higher one.",
            format!(
                "Set 1: {:.4} against {:.4}; Set 2: {:.4} against {:.4}",
                mu(&high1),
                mu(&low1),
                mu(&high2),
                mu(&low2)
            ),
            mu(&high1) < mu(&low1) && mu(&high2) > mu(&low2),
            None,
        ),
        claim(
            "Modes 5 and 6 merge at a higher µ in Set 2 than in Set 1.",
            format!("{:.4} in Set 2, {:.4} in Set 1", mu(&high2), mu(&high1)),
            mu(&high2) > mu(&high1),
            None,
        ),
        claim(
            "At µ = 1.5 uniform sliding of Set 1 is unstable, by mode 6.",
            format!("modes that grow: {}", listed(&grows(set1, 1.5))),
            grows(set1, 1.5) == [6],
            None,
        ),
        claim(
            "At µ = 1.96 uniform sliding of Set 1 is unstable, that of Set 2 is stable.",
            format!(
                "modes that grow: {} in Set 1, {} in Set 2",
                listed(&grows(set1, FRICTION)),
                listed(&grows(set2, FRICTION))
            ),
            !grows(set1, FRICTION).is_empty() && grows(set2, FRICTION).is_empty(),
            None,
        ),
    ]
}

/// Growth rates and frequencies over µ.
pub fn chart(name: &str, locus: &Locus) -> Chart {
    let curves = |part: fn(&Root) -> f64| {
        let curve = |(mode, branch): (usize, &Vec<Root>)| Series {
            label: Some(format!("mode {}", mode + 1)),
            points: locus.values.iter().zip(branch).map(|(&mu, root)| [mu, part(root)]).collect(),
            colour: mode,
            ..Series::default()
        };
        locus.branches.iter().enumerate().map(curve).collect()
    };
    let mark = |x: f64| Mark { x, label: Some(format!("{x:.4}")) };
    let panel = |y_label: &str, series, marks, zero_line| Panel {
        y_label: y_label.to_owned(),
        series,
        marks,
        zero_line,
        ..Panel::default()
    };
    let crossings = locus.crossings.iter().map(|crossing| mark(crossing.value)).collect();
    let merging = locus.coalescences.iter().map(|merging| mark(merging.value)).collect();
    Chart {
        title: format!("{name}: eigenvalues in uniform sliding"),
        x_label: "Friction coefficient µ [–]".to_owned(),
        panels: vec![
            panel("Growth rate [1/s]", curves(|root| root.lambda.re), crossings, true),
            panel("Frequency [Hz]", curves(|root| root.lambda.im / TAU), merging, false),
        ],
        logarithmic: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    #[test]
    fn claims_on_couplings_fail_where_the_sets_are_exchanged_or_nothing_couples() {
        let [set1, set2] =
            ["set1", "set2"].map(|name| uniform(&scene(name, &[]).unwrap().0).unwrap());
        let held = |claims: Vec<Claim>| -> Vec<bool> {
            claims.iter().map(|claim| claim.verdict.holds()).collect()
        };
        assert_eq!(held(claims(&set1, &set2)), [true, true, false, true, true, true, true]);
        // The first three claims concern both sets equally.
        assert_eq!(held(claims(&set2, &set1))[3..], [false; 4]);
        let [mut none, mut alone] = [set2.clone(), set1];
        none.coalescences.clear();
        none.crossings.clear();
        assert_eq!(held(claims(&none, &none))[..6], [false; 6]);
        // The coupling of modes 3 and 4 is moved to another frequency.
        alone.crossings.iter_mut().for_each(|crossing| crossing.frequency_hz += 3.0);
        assert!(!held(claims(&alone, &set2))[1]);
        // In Set 2 the other coupling is at the paper's value.
        assert!(held(claims(&set2, &set2))[2]);
    }
}
