//! The amplitude at which a mode makes a contact leave sliding, against the transient.
#![cfg(feature = "tools")]

use amontons::contact::ContactState;
use amontons::integrator::{Drive, Integrator, Motion, RingForwardIncrement, Statistics};
use amontons::model::{self, LumpedModel};
use amontons::scene::builtin;
use amontons::stability::{Departure, departure, modes};
use nalgebra::Complex;

/// Runs a mode at an amplitude over three of its cycles; the states that its contacts were in.
fn states_met(mu: f64, velocity: f64, mode: usize, scale: f64) -> (Departure, Vec<ContactState>) {
    let mut scene = builtin("set1").unwrap().scene();
    (scene.friction_coefficient, scene.slider.velocity) = (mu, velocity);
    let model = LumpedModel::from(&scene);
    let equilibrium = model::equilibrium(&scene, &model).unwrap();
    let sliding = [ContactState::Slide; 2];
    let mode = &modes(&model, &sliding, mu).unwrap().oscillating[mode];
    let found = departure(&model, &equilibrium, mu, velocity, mode).unwrap();
    let start = |factor: Complex<f64>| -> Vec<f64> {
        mode.shape.iter().map(|x| scale * found.amplitude * (x * factor).re).collect()
    };
    let mut motion = Motion {
        displacement: start(Complex::new(1.0, 0.0)),
        velocity: start(mode.eigenvalue),
        contacts: sliding.to_vec(),
        statistics: Statistics::default(),
    };
    let mut drive = Drive::uniform(vec![0.0; 8], 2, velocity, mu);
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
        met.extend(motion.contacts.iter().copied().filter(|s| *s != ContactState::Slide));
    }
    (found, met)
}

#[test]
fn a_mode_leaves_sliding_at_the_amplitude_found_and_not_below() {
    // Weakly damped modes at slow and fast sliders: some stick, some detach.
    let mut kinds = Vec::new();
    for (mode, velocity) in [(0, 0.025), (2, 0.025), (3, 0.025), (0, 5.0), (3, 5.0), (5, 5.0)] {
        let (_, below) = states_met(0.3, velocity, mode, 0.97);
        assert!(below.is_empty(), "mode {mode} at {velocity} m/s: {:?}", below[0]);
        let (found, above) = states_met(0.3, velocity, mode, 1.12);
        assert_eq!(above.first(), Some(&found.into), "mode {mode} at {velocity} m/s");
        kinds.push(found.into);
    }
    assert!(kinds.contains(&ContactState::Stick) && kinds.contains(&ContactState::Detached));
}
