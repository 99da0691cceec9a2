//! `amontons-stability modes`.

use crate::arguments::Modes as Arguments;
use crate::configured;
use amontons::Error;
use amontons::contact::Joined;
use amontons::model::LumpedModel;
use amontons::picture::{ModeShape, ModeShapes};
use amontons::stability::modes;

/// Degrees of freedom by name, in their order in a module.
pub const DOFS: [&str; 4] = ["x1", "x2", "x3", "x4"];

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let scene = configured(&arguments.common, arguments.friction)?;
    let model = LumpedModel::from(&scene);
    let states = arguments.common.state(arguments.state.as_deref(), &scene, &model)?;
    let found = modes(&model, &states, scene.friction_coefficient)?;
    let state = Joined(&states);
    println!("{}: state {state}, µ = {}", scene.name, scene.friction_coefficient);
    for (i, mode) in found.all().enumerate() {
        println!(
            "\nmode {}: {:.4} Hz, growth rate {:.4} 1/s, damping ratio {:.5}, residual {:.0e}",
            i + 1,
            mode.frequency_hz(),
            mode.growth_rate(),
            mode.damping_ratio(),
            mode.residual
        );
        println!("  {:>9}  {}", "", DOFS.map(|dof| format!("{dof:>8} {:>8}", "phase")).join("  "));
        for (module, shape) in mode.shape.chunks(DOFS.len()).enumerate() {
            let values = shape.iter().map(|x| {
                let phase = if x.norm() < 1e-9 { 0.0 } else { x.arg().to_degrees() };
                format!("{:8.4} {phase:7.1}°", x.norm())
            });
            println!("  module[{}]  {}", module + 1, values.collect::<Vec<_>>().join("  "));
        }
    }
    let Some(path) = &arguments.plot else { return Ok(()) };
    let picture = found.all().enumerate().map(|(i, mode)| ModeShape {
        title: format!(
            "Mode {}: {:.2} Hz, growth {:+.2} 1/s",
            i + 1,
            mode.frequency_hz(),
            mode.growth_rate()
        ),
        shape: mode.shape.clone(),
    });
    ModeShapes {
        title: format!("{}: state {state}, µ = {}", scene.name, scene.friction_coefficient),
        angle: scene.slider.angle,
        modes: picture.collect(),
    }
    .write(path)
}
