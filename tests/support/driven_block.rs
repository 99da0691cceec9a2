//! A block on a belt that a sine drives.

use amontons::scene::{Scene, parse};

/// A block of 1 kg, pressed with 10 N on a belt that moves with 0.1 m/s, and held by a spring and a damper (100 N/m,
/// 0.4 N s/m), under a sine with this amplitude, N, and frequency, Hz.
#[must_use]
pub fn driven_block(amplitude: f64, frequency: f64) -> Scene {
    let text = format!(
        r#"
        slider = {{ velocity = 0.1, angle = 0.0 }}
        friction = {{ coefficient = 0.4, static = 0.6 }}
        integrator = {{ method = "event-driven", step = 1.0e-3 }}
        experiment = {{ stop_time = 20.0, output_interval = 0.01 }}
        [[mass]]
        name = "p"
        mass = 1.0
        force = [0.0, -10.0]
        [[spring]]
        name = "s"
        between = ["p", "ground"]
        direction = "x"
        stiffness = 100.0
        [[damper]]
        name = "d"
        between = ["p", "ground"]
        direction = "x"
        damping = 0.4
        [[contact]]
        name = "c"
        mass = "p"
        [[signal]]
        input = "mass.p.fx"
        sine = {{ amplitude = {amplitude:?}, frequency = {frequency:?} }}
        "#
    );
    parse("driven", &text).expect("it is a scene")
}
