//! Every number that `bistable` gives for the paper's Set 2, by a second method: the eigenvalues of
//! eqs. (4)–(6), which follow no mode and know no σ.

use crate::quadratic;
use amontons::contact::{ContactState, JoinedStates, all_states};
use amontons::model::LumpedModel;
use amontons::scene::{Scene, builtin};
use amontons_analysis::stability::candidates::{Bistability, Candidate, bistability};
use amontons_analysis::watch::Watch;
use nalgebra::Complex;
use std::f64::consts::TAU;

const RANGE: [f64; 2] = [0.0, 2.5];

fn set2() -> (Scene, LumpedModel) {
    let scene = builtin("set2").unwrap().scene();
    let model = LumpedModel::from(&scene);
    (scene, model)
}

fn found() -> Bistability {
    bistability(&set2().0, RANGE, Watch::IDLE).unwrap()
}

/// The modes of a state that grow, one of each pair.
fn growing(states: &[ContactState], mu: f64) -> Vec<Complex<f64>> {
    let values = quadratic::eigenvalues(&set2().1, states, mu);
    values.into_iter().filter(|value| value.re > 0.0 && value.im >= 0.0).collect()
}

/// The mode that begins to grow at µ, which must lie within 1e-8 of there.
fn onset(states: &[ContactState], mu: f64) -> Complex<f64> {
    let (before, after) = (growing(states, mu - 1e-8), growing(states, mu + 1e-8));
    assert_eq!(after.len(), before.len() + 1, "{} at {mu}", JoinedStates(states));
    after.into_iter().min_by(|a, b| a.re.total_cmp(&b.re)).unwrap()
}

#[test]
fn uniform_sliding_turns_where_it_is_said_to() {
    let found = found();
    let [turn] = found.uniform[..] else { panic!("{:?}", found.uniform) };
    assert!(turn.becomes_unstable);
    let mode = onset(&[ContactState::Slide; 2], turn.value);
    assert!((mode.im / TAU - turn.frequency_hz).abs() < 1e-5);
    assert!(growing(&[ContactState::Slide; 2], turn.value - 1e-8).is_empty());
    assert_eq!((found.equilibrium, found.stable), (vec![RANGE], vec![[0.0, turn.value]]));
}

#[test]
fn every_candidate_begins_to_grow_where_it_is_said_to_at_its_frequency() {
    let found = found();
    assert!(found.candidates.iter().any(|c| JoinedStates(&c.states).to_string() == "Sl-St"));
    for candidate in &found.candidates {
        let Candidate { states, range, begins, frequency_hz, at_end, .. } = candidate;
        assert!(begins, "Set 2 grows in no state without friction");
        let mode = onset(states, range[0]);
        assert!((mode.im / TAU - frequency_hz).abs() < 1e-5, "{mode} {frequency_hz} Hz");
        assert_eq!(range[1], found.stable[0][1]);
        let miss = |value: &Complex<f64>| {
            ((value.im / TAU - at_end[0]).abs() / at_end[0]).max((value.re / at_end[1] - 1.0).abs())
        };
        let nearest = growing(states, range[1]).iter().map(miss).fold(f64::MAX, f64::min);
        assert!(nearest < 1e-8, "{}: {nearest:e}", JoinedStates(states));
    }
}

/// The state that needs least is first; to stick a module needs the kinetic energy of m2 at the slider's speed.
#[test]
fn candidates_are_ranked_by_the_energy_of_masses_that_move_with_their_surface() {
    let (scene, model) = set2();
    let found = found();
    let energies: Vec<f64> = found.candidates.iter().map(|c| c.reach.unwrap().energy).collect();
    assert!(energies.is_sorted(), "{energies:?}");
    let first = &found.candidates[0];
    assert_eq!(JoinedStates(&first.states).to_string(), "Sl-St");
    let mass = model.mass.get(2, 2);
    let expected = 0.5 * mass * scene.slider.velocity.powi(2);
    assert!((energies[0] / expected - 1.0).abs() < 1e-9, "{energies:?} {expected}");
}

/// No state that grows is left out: all sixteen, on a grid of µ, have as many growing modes as the
/// candidates say.
#[test]
fn no_state_grows_below_the_turn_but_the_candidates() {
    let found = found();
    for states in all_states(2) {
        let mirrored = [states[1], states[0]];
        let own: Vec<&Candidate> = found
            .candidates
            .iter()
            .filter(|c| c.states == states || c.states == mirrored)
            .collect();
        for i in 0..=250 {
            let mu = found.stable[0][1] * (f64::from(i) + 0.5) / 251.0;
            let expected = own.iter().filter(|c| c.range[0] < mu && mu < c.range[1]).count();
            assert_eq!(growing(&states, mu).len(), expected, "{} at {mu}", JoinedStates(&states));
        }
    }
}
