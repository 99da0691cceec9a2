//! `amontons-stability modes`.

use crate::arguments::Modes as Arguments;
use crate::configured;
use amontons::Error;
use amontons::contact::Joined;
use amontons::model::LumpedModel;
use amontons::picture::{ModeShape, ModeShapes};
use amontons::stability::modes;
use nalgebra::Complex;

/// Degrees of freedom by name, in their order in a module.
const DOFS: [&str; 4] = ["x1", "x2", "x3", "x4"];

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
        match scene.network() {
            None => print_modules(&mode.shape),
            Some(_) => print_dofs(&scene.dof_names(), &mode.shape),
        }
    }
    let Some(path) = &arguments.plot else { return Ok(()) };
    scene.require_ring("moving mode shapes are drawn")?;
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

/// One line a module, its four degrees of freedom side by side.
fn print_modules(shape: &[Complex<f64>]) {
    println!("  {:>9}  {}", "", DOFS.map(|dof| format!("{dof:>8} {:>8}", "phase")).join("  "));
    for (module, shape) in shape.chunks(DOFS.len()).enumerate() {
        let values: Vec<String> = shape.iter().map(amplitude_and_phase).collect();
        println!("  module[{}]  {}", module + 1, values.join("  "));
    }
}

/// One line a degree of freedom.
fn print_dofs(names: &[String], shape: &[Complex<f64>]) {
    let width = names.iter().map(String::len).max().unwrap_or(0);
    for (name, x) in names.iter().zip(shape) {
        println!("  {name:width$}  {}", amplitude_and_phase(x));
    }
}

fn amplitude_and_phase(x: &Complex<f64>) -> String {
    let phase = if x.norm() < 1e-9 { 0.0 } else { x.arg().to_degrees() };
    format!("{:8.4} {phase:7.1}°", x.norm())
}
