//! A part of a motion that is small beside the others belongs to the state that comes back, or does not.

use crate::kinds_of_motion::observed;
use amontons::scene::parse;
use amontons_analysis::study::{Kind, LongTermMotion, ObservationRequest};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// A mass that lies damped on a belt, so that there is a contact.
const IDLE: &str = "slider = { velocity = 0.1, angle = 0.0 }\nfriction = { coefficient = 0.3 }\n\
    [[contact]]\nname = \"c\"\nmass = \"idle\"\n[[mass]]\nname = \"idle\"\nmass = 1.0\nforce = [0.0, -1.0]\n\
    [[spring]]\nname = \"hold\"\nbetween = [\"idle\", \"ground\"]\ndirection = \"x\"\nstiffness = 39.5\n\
    [[damper]]\nname = \"calm\"\nbetween = [\"idle\", \"ground\"]\ndirection = \"x\"\ndamping = 3.0\n";

/// The end of the motion of oscillators that nothing joins, each with a frequency (Hz) and an amplitude (m).
fn oscillators(parts: &[[f64; 2]], besides: &str) -> LongTermMotion {
    let mut tables = String::new();
    for (i, [frequency, amplitude]) in parts.iter().enumerate() {
        let stiffness = (TAU * frequency).powi(2);
        tables += &format!(
            "[[mass]]\nname = \"o{i}\"\nmass = 1.0\nlocked = [\"y\"]\n\
             [[spring]]\nname = \"k{i}\"\nbetween = [\"o{i}\", \"ground\"]\ndirection = \"x\"\n\
             stiffness = {stiffness:?}\n[[initial]]\nmass = \"o{i}\"\nx = {amplitude:?}\n"
        );
    }
    let head = "integrator = { method = \"event-driven\", step = 1e-3 }\n";
    let scene = parse("oscillators", &format!("{head}{besides}{tables}")).unwrap();
    observed(&scene, &ObservationRequest::default())
}

fn assert_period(ending: &LongTermMotion, period: f64) {
    assert_eq!(ending.kind, Kind::Periodic, "{ending:?}");
    let found = ending.period.unwrap();
    assert!((found / period - 1.0).abs() < 1e-8, "{found} in place of {period}");
}

/// After each period of the large oscillator all but a small part of the state is back. Multiples were tried up to the
/// fourth, and a time that was late for the small part's sake was multiplied with them.
#[test]
fn the_period_is_that_of_a_small_part_too() {
    assert_period(&oscillators(&[[1.0, 1.0], [0.5, 1e-3]], IDLE), 2.0);
    assert_period(&oscillators(&[[1.0, 1.0], [0.2, 1e-3]], IDLE), 5.0);
    assert_period(&oscillators(&[[1.0, 1.0], [3.0 / 7.0, 3e-4]], IDLE), 7.0);
    assert_period(&oscillators(&[[6.0, 1.0], [3.0, 3e-4], [2.0, 1e-5]], IDLE), 1.0);
}

/// Copies of the large oscillator change nothing about the smallest part that counts.
#[test]
fn the_period_is_the_same_with_copies_of_a_part() {
    for copies in [1, 16] {
        let mut parts = vec![[1.0, 1.0]; copies];
        parts.push([0.5, 3e-6]);
        assert_period(&oscillators(&parts, IDLE), 2.0);
    }
}

/// Without a contact no neighbour of a motion was made, for it was thought to have been made in these contact states
/// before. So a motion of two frequencies was left undecided.
#[test]
fn a_motion_without_contacts_can_be_quasi_periodic() {
    for besides in ["", IDLE] {
        let ending = oscillators(&[[1.0, 0.1], [1.0, 1.0], [FRAC_1_SQRT_2, 0.5]], besides);
        assert_eq!(ending.kind, Kind::QuasiPeriodic, "{ending:?}");
    }
}

/// A block sticks, slips and never comes back beside a mass on which a sine of the same frequency pulls, so that its own
/// motion is a fiftieth or less of the whole. Its returns to within 2e-3 of the whole are random: they came nearer over
/// four windows by chance, and the motion was called periodic. In a motion near an unstable periodic one they last for
/// a while only.
#[test]
fn a_small_irregular_part_does_not_come_back_by_chance() {
    let scene = |pull: f64| {
        let text = format!(
            "slider = {{ velocity = 0.21, angle = 0.0 }}\nfriction = {{ coefficient = 0.31, static = 0.47 }}\n\
             integrator = {{ method = \"event-driven\", step = 1e-4 }}\n\
             [[mass]]\nname = \"block\"\nmass = 2.3\nforce = [0.0, -85.0]\n\
             [[spring]]\nname = \"k\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\nstiffness = 1450.0\n\
             [[damper]]\nname = \"d\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\ndamping = 3.1\n\
             [[contact]]\nname = \"belt\"\nmass = \"block\"\n[[initial]]\nmass = \"block\"\nvx = 0.12\n\
             [[mass]]\nname = \"quiet\"\nmass = 2.0\nlocked = [\"y\"]\n\
             [[spring]]\nname = \"q\"\nbetween = [\"quiet\", \"ground\"]\ndirection = \"x\"\nstiffness = 900.0\n\
             [[damper]]\nname = \"e\"\nbetween = [\"quiet\", \"ground\"]\ndirection = \"x\"\ndamping = 8.0\n\
             [[signal]]\ninput = \"mass.block.fx\"\nsine = {{ amplitude = 12.0, frequency = 2.6 }}\n\
             [[signal]]\ninput = \"mass.quiet.fx\"\nsine = {{ amplitude = {pull:?}, frequency = 2.6 }}\n"
        );
        parse("irregular", &text).unwrap()
    };
    for pull in [450.0, 1500.0, 4500.0] {
        for window in [8.0, 10.0] {
            let request =
                ObservationRequest { window: Some(window), ..ObservationRequest::default() };
            let ending = observed(&scene(pull), &request);
            assert_eq!(ending.kind, Kind::Irregular, "{pull} {window}: {ending:?}");
        }
    }
}
