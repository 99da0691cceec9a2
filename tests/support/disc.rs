//! Pads on one disc, so that all contacts share its mass.

use amontons::scene::{Scene, parse};
use std::f64::consts::TAU;

/// Pads around a disc on springs, each with a velocity of its own: they bounce until they lie on it.
#[must_use]
pub fn disc(pads: u32) -> Scene {
    let mut text = "slider = { velocity = 0.2, angle = 0.0 }\n\
                    friction = { coefficient = 0.4, static = 0.6 }\n\
                    integrator = { method = \"event-driven\", step = 1e-5 }\n\
                    effects = { energy = true }\n\
                    mass = [{ name = \"disc\", mass = 2.0 }"
        .to_owned();
    let (mut springs, mut contacts, mut initial) = (String::new(), String::new(), String::new());
    for direction in ["x", "y"] {
        springs += &format!(
            "{{ name = \"d{direction}\", between = [\"disc\", \"ground\"], direction = \"{direction}\", stiffness = 1e6 }},"
        );
    }
    for i in 0..pads {
        let angle = TAU * f64::from(i) / f64::from(pads);
        // Parts of one that no two pads share.
        let part = |ratio: f64| (ratio * f64::from(i)).fract();
        let (mass, force) = (0.2 + 0.1 * part(0.618), -100.0 - 30.0 * part(0.414));
        text += &format!(
            ", {{ name = \"p{i}\", mass = {mass:?}, angle = {angle:?}, force = [0.0, {force:?}] }}"
        );
        for (name, direction, stiffness) in [("t", angle, 2e5), ("n", angle + 1.2, 3e5)] {
            springs += &format!(
                "{{ name = \"{name}{i}\", between = [\"p{i}\", \"ground\"], direction = {direction:?}, stiffness = {stiffness:?} }},"
            );
        }
        contacts +=
            &format!("{{ name = \"c{i}\", mass = \"p{i}\", on = \"disc\", angle = {angle:?} }},");
        let [vx, vy] = [0.25 * part(0.732), 0.12 * part(0.236)];
        initial += &format!("{{ mass = \"p{i}\", vx = {vx:?}, vy = {vy:?} }},");
    }
    text += &format!("]\nspring = [{springs}]\ncontact = [{contacts}]\ninitial = [{initial}]\n");
    parse("disc", &text).expect("it is a scene")
}
