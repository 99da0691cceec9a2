//! `amontons-stability modes`.

use crate::arguments::Modes as ModesArguments;
use crate::labels::significant;
use crate::{Failure, configured, friction, state};
use amontons_analysis::patterns::in_words;
use amontons_analysis::stability::{Linearised, modes};
use amontons_pictures::picture::{self, ModeShape, ModeShapes};
use nalgebra::Complex;
use std::io::{self, Write};

/// Names of the degrees of freedom, in their order in a module.
const DOFS: [&str; 4] = ["x1", "x2", "x3", "x4"];

pub fn run(arguments: &ModesArguments, out: &mut dyn Write) -> Result<(), Failure> {
    arguments.plot.as_deref().map_or(Ok(()), picture::check_name)?;
    let given = configured(&arguments.common, arguments.point.friction, &[])?;
    let scene = &given.scene;
    if arguments.plot.is_some() {
        scene.require_ring("moving mode shapes are drawn")?;
    }
    let here = Linearised::of(scene);
    let states = state(arguments.point.state.as_deref(), scene, &here)?;
    let found = modes(here.linear()?, &states)?;
    let state = in_words(&states, scene);
    let title = format!("{}: state {state}, {}", scene.name, friction(scene));
    writeln!(out, "{title}")?;
    write!(out, "{}", given.head())?;
    for (i, mode) in found.all().enumerate() {
        writeln!(
            out,
            "\nmode {}: {:.4} Hz, growth rate {} 1/s, damping ratio {}, residual {:.0e}{}",
            i + 1,
            mode.frequency_hz(),
            significant(mode.growth_rate(), 5),
            significant(mode.damping_ratio(), 4),
            mode.residual,
            waves(mode.waves),
        )?;
        match scene.network() {
            None => print_modules(&mode.shape, out)?,
            Some(_) => print_dofs(&scene.dof_names(), &mode.shape, out)?,
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
    let picture = ModeShapes { title, angle: scene.slider.angle, modes: picture.collect() };
    Ok(picture.write(path)?)
}

/// Text that states the number of waves of a shape around a ring of equal modules.
fn waves(count: Option<usize>) -> String {
    match count {
        None => String::new(),
        Some(1) => ", 1 wave around the ring".into(),
        Some(count) => format!(", {count} waves around the ring"),
    }
}

/// Prints one line for each module, with its four degrees of freedom side by side.
fn print_modules(shape: &[Complex<f64>], out: &mut dyn Write) -> io::Result<()> {
    let head = DOFS.map(|dof| format!("{dof:>8} {:>8}", "phase")).join("  ");
    writeln!(out, "  {:>9}  {head}", "")?;
    for (module, shape) in shape.chunks(DOFS.len()).enumerate() {
        let values: Vec<String> = shape.iter().map(amplitude_and_phase).collect();
        writeln!(out, "  module[{}]  {}", module + 1, values.join("  "))?;
    }
    Ok(())
}

/// Prints one line for each degree of freedom.
fn print_dofs(names: &[String], shape: &[Complex<f64>], out: &mut dyn Write) -> io::Result<()> {
    let width = names.iter().map(String::len).max().unwrap_or(0);
    for (name, x) in names.iter().zip(shape) {
        writeln!(out, "  {name:width$}  {}", amplitude_and_phase(x))?;
    }
    Ok(())
}

fn amplitude_and_phase(x: &Complex<f64>) -> String {
    // −180° and 180° are one, as are −0 and 0.
    let phase = if x.norm() < 1e-9 { 0.0 } else { x.arg().to_degrees() };
    let phase = if phase < -179.95 { phase + 360.0 } else { phase };
    let phase = if phase.abs() < 0.05 { 0.0 } else { phase };
    format!("{:8.4} {phase:7.1}°", x.norm())
}
