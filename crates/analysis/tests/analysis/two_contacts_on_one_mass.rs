//! The analyser on a mass that rubs in two places, against closed forms.
//!
//! A mass of 2 kg in a corner: it slides on a floor (contact 1: normal y, tangent x) and along a wall
//! to its left (contact 2: normal x, tangent −y). A spring at 45° couples its directions, so that
//! with the floor alone M̃⁻¹ K̃ = (k_xx − s µ k_xy) / m: the test direction of a sliding force along
//! n + s µ t is the one at right angles to it.

use amontons::contact::ContactState::{self, Detached, ReverseSlide, Slide, Stick};
use amontons::contact::{ContactLaw, all_states};
use amontons::model::{Contact, Damping, Direction, LumpedModel, SparseMatrix};
use amontons::stability::Spectrum;
use amontons_analysis::stability::{StateClasses, modes};

const MASS: f64 = 2.0;
const K_XX: f64 = 900.0;
const K_XY: f64 = 400.0;
const K_YY: f64 = 500.0;

fn corner(mu: f64) -> LumpedModel {
    let stiffness = vec![(0, 0, K_XX), (0, 1, K_XY), (1, 0, K_XY), (1, 1, K_YY)];
    LumpedModel {
        mass: SparseMatrix::diagonal(&[MASS, MASS]),
        stiffness: SparseMatrix::from_entries(2, stiffness),
        damping: Damping::default(),
        dampers: SparseMatrix::zero(2),
        load: vec![0.0; 2],
        contacts: vec![
            Contact::new(Direction::unit(1), Direction::unit(0)),
            Contact::new(Direction::unit(0), Direction(vec![(1, -1.0)])),
        ],
        law: ContactLaw::default(),
    }
    .with_friction(mu)
}

/// σ of the one motion that a state leaves, if it leaves one.
fn expected(states: [ContactState; 2], mu: f64) -> Option<f64> {
    let direction = |state: ContactState| state.sliding_direction();
    match states {
        // On the floor alone x is free, along the wall alone y is; −µ is what turns with the sense.
        [floor, Detached] => direction(floor).map(|s| (K_XX - s * mu * K_XY) / MASS),
        [Detached, wall] => direction(wall).map(|s| (K_YY + s * mu * K_XY) / MASS),
        _ => None,
    }
}

#[test]
fn every_state_has_the_eigenvalue_of_its_closed_form() {
    for mu in [0.0, 0.5, 2.0] {
        let model = corner(mu);
        for states in all_states(2) {
            let states: [ContactState; 2] = states.try_into().unwrap();
            let found = Spectrum::of(model.linear().unwrap(), &states).unwrap();
            let name = format!("{states:?} at µ = {mu}");
            match expected(states, mu) {
                Some(sigma) if sigma > 0.0 => {
                    assert_eq!((found.oscillating.len(), found.real.len()), (1, 0), "{name}");
                    let lambda = found.oscillating[0];
                    assert!(lambda.re == 0.0 && (lambda.im - sigma.sqrt()).abs() < 1e-12, "{name}");
                }
                Some(sigma) => {
                    assert_eq!((found.oscillating.len(), found.real.len()), (0, 2), "{name}");
                    let misses = found.real.iter().map(|v| (v.abs() - (-sigma).sqrt()).abs());
                    assert!(misses.fold(0.0, f64::max) < 1e-12, "{name}");
                }
                None if states == [Detached, Detached] => {
                    assert_eq!(found.oscillating.len(), 2, "{name}");
                    // Sum and product of the squares are trace and determinant of M⁻¹ K.
                    let square = [0, 1].map(|i: usize| found.oscillating[i].im.powi(2));
                    assert!((square[0] + square[1] - (K_XX + K_YY) / MASS).abs() < 1e-9);
                    let determinant = (K_XX * K_YY - K_XY * K_XY) / (MASS * MASS);
                    assert!((square[0] * square[1] - determinant).abs() < 1e-9 * determinant);
                }
                None => assert_eq!(found, Spectrum::default(), "{name}: nothing can move"),
            }
        }
    }
}

#[test]
fn past_its_critical_friction_a_contact_diverges_without_oscillating() {
    // k_xx = µ k_xy at µ = 2.25: from there on the floor draws the mass along.
    let states = [Slide, Detached];
    for (mu, grows) in [(2.2499, false), (2.2501, true)] {
        let found = modes(corner(mu).linear().unwrap(), &states).unwrap();
        assert_eq!((found.unstable(), found.real.len()), (grows, if grows { 2 } else { 0 }));
    }
    let growth = Spectrum::of(corner(3.0).linear().unwrap(), &states).unwrap().growth_rate();
    assert!((growth - ((3.0 * K_XY - K_XX) / MASS).sqrt()).abs() < 1e-12);
    let backwards = Spectrum::of(corner(3.0).linear().unwrap(), &[ReverseSlide, Detached]);
    assert!(!backwards.unwrap().unstable());
}

#[test]
fn two_contacts_in_one_place_count_once_unless_their_friction_differs() {
    let mut model = corner(0.5);
    model.contacts[1] = model.contacts[0].clone();
    let free = |states: [ContactState; 2]| {
        let found = Spectrum::of(model.linear().unwrap(), &states).unwrap();
        found.oscillating.len()
    };
    assert_eq!([[Slide, Slide], [Stick, Stick], [Stick, Slide]].map(free), [1, 0, 0]);
    // Sl and R-Sl at one place contradict each other: no motion, and no force, is determined.
    assert_eq!(free([Slide, ReverseSlide]), 0);
    assert_eq!(StateClasses::of(&model).unwrap().representatives.len(), 16);
}
