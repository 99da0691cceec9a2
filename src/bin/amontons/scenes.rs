//! `amontons scenes`, and how every command finds its scene.

use crate::arguments::Scenes;
use amontons::Error;
use amontons::scene::{self, BUILTIN, Scene, builtin};
use std::error;
use std::io::{Write, stdout};
use std::path::Path;

pub fn run(command: Option<&Scenes>) -> Result<(), Box<dyn error::Error>> {
    let mut out = stdout().lock();
    match command {
        None => {
            for scene in BUILTIN.iter().map(scene::Builtin::scene) {
                writeln!(out, "{:8} {}", scene.name, scene.description)?;
            }
        }
        Some(Scenes::Show { name }) => {
            let scene =
                builtin(name).ok_or_else(|| format!("no built-in scene {name}; {}", names()))?;
            out.write_all(scene.text.as_bytes())?;
        }
    }
    Ok(())
}

/// The scene that a command line names, with its file's text: a path, or else a built-in name.
pub fn load(argument: &str) -> Result<(Scene, String), Box<dyn error::Error>> {
    let path = Path::new(argument);
    if path.exists() {
        return Ok(scene::read(path)?);
    }
    match builtin(argument) {
        Some(builtin) => Ok((builtin.scene(), builtin.text.to_owned())),
        None => {
            Err(format!("no file {argument} and no built-in scene of that name; {}", names())
                .into())
        }
    }
}

fn names() -> String {
    let names: Vec<&str> = BUILTIN.iter().map(|builtin| builtin.name).collect();
    format!("built in are {}", names.join(", "))
}

/// Refuses a scene that cannot be run, before anything is written.
pub fn check(scene: &Scene) -> Result<(), Error> {
    amontons::simulation::Simulation::new(scene.clone(), 0.0).map(drop)
}
