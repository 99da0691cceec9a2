//! `amontons scenes`, and how every command finds its scene.

use crate::arguments::Scenes;
use amontons::Error;
use amontons::scene::{self, BUILTIN, Scene, builtin, builtin_names};
use std::error;
use std::io::{Write, stdout};

pub fn run(command: Option<&Scenes>) -> Result<(), Box<dyn error::Error>> {
    let mut out = stdout().lock();
    match command {
        None => {
            for scene in BUILTIN.iter().map(scene::Builtin::scene) {
                writeln!(out, "{:8} {}", scene.name, scene.description)?;
            }
        }
        Some(Scenes::Show { name }) => {
            let scene = builtin(name)
                .ok_or_else(|| format!("no built-in scene {name}; {}", builtin_names()))?;
            out.write_all(scene.text.as_bytes())?;
        }
    }
    Ok(())
}

/// Refuses a scene that cannot be run, before anything is written.
pub fn check(scene: &Scene) -> Result<(), Error> {
    amontons::simulation::Simulation::new(scene.clone(), 0.0).map(drop)
}
