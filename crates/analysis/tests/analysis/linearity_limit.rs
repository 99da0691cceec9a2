//! The amplitude at which a mode makes a contact leave sliding, against the transient.

use amontons::assembly;
use amontons::contact::ContactState;
use amontons::integrator::{Inputs, Integrator, Motion, RingForwardIncrement};
use amontons::model::LumpedModel;
use amontons::scene::{builtin, parse};
use amontons_analysis::stability::candidates::closed_at_rest;
use amontons_analysis::stability::{LinearityLimit, linearity_limit, modes};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Set 1, undamped unless it grows, so that a mode neither decays nor grows over its cycle.
#[derive(Clone, Copy)]
struct Case {
    mu: f64,
    velocity: f64,
    mode: usize,
    damped: bool,
}

/// The departure found, and the states other than sliding that contacts are in over one cycle of a
/// mode which starts at `part` of its amplitude.
fn states_met(case: Case, part: f64) -> (LinearityLimit, Vec<ContactState>) {
    let Case { mu, velocity, mode, damped } = case;
    let mut scene = builtin("set1").unwrap().scene();
    (scene.friction_coefficient, scene.slider.velocity) = (mu, velocity);
    scene.damping.beta *= f64::from(u8::from(damped));
    let model = LumpedModel::from(&scene);
    let equilibrium = assembly::equilibrium(&scene, &model).unwrap();
    let sliding = closed_at_rest(&model);
    let linear = model.linear().unwrap();
    let mode = &modes(linear, &sliding).unwrap().oscillating[mode];
    let found = linearity_limit(linear, &equilibrium, mode).unwrap();
    let start = |factor: Complex<f64>| -> Vec<f64> {
        mode.shape.iter().map(|x| part * found.amplitude * (x * factor).re).collect()
    };
    let mut motion =
        Motion::new(start(Complex::new(1.0, 0.0)), start(mode.eigenvalue), sliding.clone());
    let mut drive = Inputs::uniform(vec![0.0; 8], 2, velocity, mu);
    for (i, contact) in model.contacts.iter().enumerate() {
        motion.displacement[4 * i + 3] = 0.0;
        motion.velocity[4 * i + 3] = 0.0;
        contact.normal.add_to(&mut drive.force, -equilibrium.normal_force[i]);
        contact.tangent.add_to(&mut drive.force, -equilibrium.friction_force[i]);
    }
    let step = 1e-7;
    let mut integrator = RingForwardIncrement::new(&model).unwrap();
    let mut met = Vec::new();
    for _ in 0..(1.0 / mode.frequency_hz() / step) as u64 {
        integrator.advance(&mut motion, &drive, step, 1).unwrap();
        met.extend(motion.contacts.iter().copied().filter(|state| *state != sliding[0]));
    }
    (found, met)
}

/// A mass that nothing joins to the one on the belt moves alone in its mode. Rounding of that mode's shape was told as a way
/// into an open contact, at some 1e12 m.
#[test]
fn a_mode_that_does_not_reach_a_contact_makes_it_leave_nothing() {
    let text = "[slider]\nvelocity = 0.5\nangle = 0.0\n[friction]\ncoefficient = 0.5\n\
                [[mass]]\nname = \"a\"\nmass = 1.0\nforce = [0.0, -50.0]\n\
                [[mass]]\nname = \"alone\"\nmass = 0.5\nlocked = [\"y\"]\n\
                [[spring]]\nname = \"k1\"\nbetween = [\"a\", \"ground\"]\ndirection = 0.5\nstiffness = 1.1e5\n\
                [[spring]]\nname = \"k2\"\nbetween = [\"a\", \"ground\"]\ndirection = 2.3\nstiffness = 2.2e5\n\
                [[spring]]\nname = \"k3\"\nbetween = [\"alone\", \"ground\"]\ndirection = \"x\"\nstiffness = 8e4\n\
                [[damper]]\nname = \"d\"\nbetween = [\"a\", \"ground\"]\ndirection = \"x\"\ndamping = 4.0\n\
                [[contact]]\nname = \"c\"\nmass = \"a\"\n\
                [integrator]\nstep = 1e-6\n[experiment]\nstop_time = 1.0\n";
    let scene = parse("alone", text).unwrap();
    let model = LumpedModel::from(&scene);
    let equilibrium = assembly::equilibrium(&scene, &model).unwrap();
    let sliding = closed_at_rest(&model);
    let linear = model.linear().unwrap();
    let found = modes(linear, &sliding).unwrap().oscillating;
    assert_eq!(found.len(), 2);
    for mode in &found {
        let alone = (mode.frequency_hz() - (8e4_f64 / 0.5).sqrt() / TAU).abs() < 1e-6;
        let leaves = linearity_limit(linear, &equilibrium, mode).is_some();
        assert_eq!(leaves, !alone, "{} Hz", mode.frequency_hz());
    }
}

/// The state that a mode's contact enters, at the amplitude found and not below; a growing mode
/// grows by less than `growth` over its cycle.
fn state_entered(case: Case, growth: f64) -> ContactState {
    let (found, below) = states_met(case, 0.998 / growth);
    assert!(below.is_empty(), "mode {} at {} m/s: {:?}", case.mode, case.velocity, below[0]);
    let (_, above) = states_met(case, 1.002);
    assert_eq!(above.first(), Some(&found.into), "mode {} at {} m/s", case.mode, case.velocity);
    found.into
}

#[test]
fn a_mode_leaves_sliding_at_the_amplitude_found_and_not_below() {
    // Slow and fast sliders: some stick, some detach.
    let kinds: Vec<ContactState> =
        [(0, 0.025), (2, 0.025), (3, 0.025), (0, 5.0), (3, 5.0), (5, 5.0)]
            .into_iter()
            .map(|(mode, velocity)| {
                state_entered(Case { mu: 0.3, velocity, mode, damped: false }, 1.0)
            })
            .collect();
    assert!(kinds.contains(&ContactState::Stick) && kinds.contains(&ContactState::Detached));
}

#[test]
fn a_slider_that_moves_back_is_left_alike() {
    for (mode, velocity, into) in
        [(1, -0.025, ContactState::Stick), (0, -5.0, ContactState::Detached)]
    {
        let case = Case { mu: 0.3, velocity, mode, damped: false };
        assert_eq!(state_entered(case, 1.0), into);
    }
}

#[test]
fn without_friction_a_contact_slides_on_the_other_way() {
    for (velocity, into) in [(0.025, ContactState::ReverseSlide), (-0.025, ContactState::Slide)] {
        let case = Case { mu: 0.0, velocity, mode: 3, damped: false };
        assert_eq!(state_entered(case, 1.0), into);
    }
}

#[test]
fn the_growing_mode_of_set_1_leaves_sliding_at_the_amplitude_found() {
    // 2.68 Hz against 219 Hz (Table 2): a factor exp(2π 2.68 / 219.38) = 1.08 over a cycle.
    let case = Case { mu: 1.96, velocity: 0.025, mode: 5, damped: true };
    assert_eq!(state_entered(case, 1.08), ContactState::Stick);
}
