//! `amontons-stability modes`.

use crate::arguments::Modes as ModesArguments;
use crate::labels::significant;
use crate::mesh::{Meshes, Numbered, superelements, superelements_of};
use crate::{Failure, configured, friction, state};
use amontons::Error;
use amontons::scene::Scene;
use amontons_analysis::patterns::in_words;
use amontons_analysis::stability::{Linearised, Mode, Modes, modes};
use amontons_pictures::picture::{self, ModeShape, ModeShapes};
use nalgebra::Complex;
use std::io::{self, Write};
use std::path::Path;

/// Names of the degrees of freedom, in their order in a module.
const DOFS: [&str; 4] = ["x1", "x2", "x3", "x4"];

pub fn run(arguments: &ModesArguments, out: &mut dyn Write) -> Result<(), Failure> {
    arguments.plot.as_deref().map_or(Ok(()), picture::check_name)?;
    let given = configured(&arguments.common, arguments.point.friction, &[])?;
    let scene = &given.scene;
    check_pictures(arguments, scene)?;
    let path = Path::new(&arguments.common.scene);
    let meshes = Meshes::open(&arguments.mesh, scene, path, &given.superelements)?;
    let here = Linearised::of(scene);
    let states = state(arguments.point.state.as_deref(), scene, &here)?;
    let found = modes(here.linear()?, &states)?;
    let state = in_words(&states, scene);
    let chosen = chosen(&found, arguments.frequencies, &state)?;
    let title = format!("{}: state {state}, {}", scene.name, friction(scene));
    // Before the text, whose reader may not take it to its end.
    if let Some(folder) = &arguments.vtk {
        meshes.write_vtk(folder, &chosen)?;
    }
    match &arguments.plot {
        Some(path) if scene.network().is_some() => meshes.draw(path, title.clone(), &chosen)?,
        Some(path) => ring(title.clone(), scene, &chosen).write(path)?,
        None => {}
    }
    writeln!(out, "{title}")?;
    write!(out, "{}", given.head())?;
    for &(number, mode) in &chosen {
        writeln!(
            out,
            "\nmode {number}: {:.4} Hz, growth rate {} 1/s, damping ratio {}, residual {:.0e}{}",
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
    Ok(())
}

/// The modes of a ring as a picture.
fn ring(title: String, scene: &Scene, chosen: &[Numbered<'_>]) -> ModeShapes {
    let modes = chosen
        .iter()
        .map(|one| ModeShape { title: name_of(*one), shape: one.1.shape.clone() })
        .collect();
    ModeShapes { title, angle: scene.slider.angle, modes }
}

/// The title of a mode in a picture.
pub fn name_of((number, mode): Numbered<'_>) -> String {
    let (frequency, growth) = (mode.frequency_hz(), mode.growth_rate());
    format!("Mode {number}: {frequency:.2} Hz, growth {growth:+.2} 1/s")
}

/// Refuses pictures that cannot be drawn, and meshes that nothing is done with.
fn check_pictures(arguments: &ModesArguments, scene: &Scene) -> Result<(), Failure> {
    let [has_mesh, has_plot] = [!arguments.mesh.is_empty(), arguments.plot.is_some()];
    if has_mesh && !has_plot && arguments.vtk.is_none() {
        return Err(Failure::Usage(
            "--mesh alone does nothing; give --vtk DIR or --plot FILE as well".into(),
        ));
    }
    if has_mesh || !has_plot {
        return Ok(());
    }
    if !superelements(scene).is_empty() {
        return Err(Failure::Usage(format!(
            "the modes of a network are drawn on meshes of its superelements; give --mesh NAME=FILE.inp as well ({})",
            superelements_of(scene)
        )));
    }
    scene.require_ring("moving mode shapes are drawn")?;
    Ok(())
}

/// The modes with frequencies in a range (Hz), with their numbers; all without one.
///
/// # Errors
/// Returns an error if there is no mode in the range; it names those next to it.
fn chosen<'a>(
    found: &'a Modes,
    range: Option<[f64; 2]>,
    state: &str,
) -> Result<Vec<Numbered<'a>>, Error> {
    let all = || (1..).zip(found.all());
    let Some([low, high]) = range else { return Ok(all().collect()) };
    let inside = |(_, mode): &(usize, &Mode)| (low..=high).contains(&mode.frequency_hz());
    let chosen: Vec<_> = all().filter(inside).collect();
    if !chosen.is_empty() {
        return Ok(chosen);
    }
    let by_frequency =
        |a: &Numbered<'a>, b: &Numbered<'a>| a.1.frequency_hz().total_cmp(&b.1.frequency_hz());
    let below = all().filter(|(_, mode)| mode.frequency_hz() < low).max_by(by_frequency);
    let above = all().filter(|(_, mode)| mode.frequency_hz() > high).min_by(by_frequency);
    let place =
        |(number, mode): Numbered<'a>| format!("mode {number} at {:.4} Hz", mode.frequency_hz());
    let nearest: Vec<String> = below.into_iter().chain(above).map(place).collect();
    let wish = match &*nearest {
        [] => "it has no mode at all".into(),
        nearest => format!("widen --frequencies to {}", nearest.join(" or ")),
    };
    Err(Error::argument(format!(
        "no mode of the state {state} has a frequency from {low} to {high} Hz; {wish}"
    )))
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
