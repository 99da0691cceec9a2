//! `amontons scenes`, and the check and start of scenes for all commands.

use crate::arguments::Scenes;
use amontons::Error;
use amontons::scene::{BUILTIN, Builtin, Scene, named};
use amontons::simulation::Simulation;
use amontons_analysis::warning::warnings;
use amontons_export::scene;
use amontons_pictures::picture::{self, Structure};
use std::error;
use std::io::{Write, stdout};

pub fn run(command: Option<&Scenes>) -> Result<(), Box<dyn error::Error>> {
    let mut out = stdout().lock();
    match command {
        None => {
            let width = BUILTIN.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
            for scene in BUILTIN.iter().map(Builtin::scene) {
                writeln!(out, "{:width$}  {}", scene.name, scene.description)?;
            }
        }
        Some(Scenes::Show { name }) => {
            let scene = named(name)?;
            out.write_all(scene.text.as_bytes())?;
        }
        Some(Scenes::Draw { scene, output }) => {
            picture::check_name(output)?;
            let (scene, _) = scene::find(scene)?;
            Structure::from(&scene).write(output)?;
        }
        Some(Scenes::Schema) => out.write_all(scene::schema().as_bytes())?,
    }
    Ok(())
}

/// Refuses a scene that cannot be run, before longer work on it.
pub fn check(scene: &Scene) -> Result<(), Error> {
    Simulation::new(scene.clone(), 0.0).map(|_| ())
}

/// Starts a simulation of the scene before anything is written; warns of values that are probably mistakes.
pub fn start(scene: &Scene) -> Result<Simulation, Error> {
    let simulation = Simulation::new(scene.clone(), 0.0)?;
    for warning in warnings(&simulation) {
        eprintln!("warning: {warning}");
    }
    Ok(simulation)
}
