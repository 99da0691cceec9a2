//! `amontons export`.

use crate::arguments::Export;
use crate::scenes;
use amontons::Error;
use amontons::model::{Equilibrium, LumpedModel};
use amontons::output::Pending;
use amontons::package;
use amontons::scene::{self, Method, Scene, Structure};
use amontons::simulation::catalogue::Causality;
use amontons::simulation::variables;
use amontons::stability::critical_step;
use std::io::Write;
use std::path::PathBuf;

pub fn run(arguments: &Export) -> Result<(), Error> {
    let (mut scene, mut source) = scene::find(&arguments.scene)?;
    let (method, step) = (scene.method, scene.step);
    arguments.integrator.apply(&mut scene);
    if (scene.method, scene.step) != (method, step) {
        source.set_integrator(scene.method, scene.step)?;
    }
    let simulation = scenes::start(&scene)?;
    let fmu = package::fmu(&scene, &source)?;
    let path =
        arguments.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.fmu", scene.name)));
    let mut file = Pending::create(&path)?;
    file.write_all(&fmu).map_err(|error| Error::file(&path, &error))?;
    file.complete()?;
    println!("{}: {}", scene.name, scene.description);
    print_contents(&scene, simulation.acting())?;
    print_equilibrium(&scene, simulation.reference());
    println!("  FMU            {} ({} kB)", path.display(), fmu.len().div_ceil(1000));
    Ok(())
}

/// What went in: structure, variables, critical step of the values that act at the start.
fn print_contents(scene: &Scene, acting: &Scene) -> Result<(), Error> {
    let model = LumpedModel::from(acting);
    let kind = match &scene.structure {
        Structure::Ring(modules) => format!("ring of {} modules", modules.len()),
        Structure::Network(network) => format!("network of {} masses", network.masses.len()),
    };
    println!(
        "  structure      {kind}: {}, {}",
        counted(model.dofs(), "degree of freedom", "degrees of freedom"),
        counted(model.contacts.len(), "contact", "contacts")
    );
    let variables = variables(scene);
    let count = |causality| variables.iter().filter(|v| v.template.causality == causality).count();
    println!(
        "  variables      {} inputs, {} outputs, {} parameters",
        count(Causality::Input),
        count(Causality::Output),
        count(Causality::Parameter)
    );
    println!("  step           {:e} s", scene.step);
    match scene.method {
        Method::ForwardIncrement => {
            println!("  critical step  {}", critical_step(&model, acting.friction_coefficient)?);
        }
        Method::EventDriven => {
            println!("  integrator     event-driven, exact between changes of contact state");
        }
    }
    if !scene.signals.is_empty() {
        println!("  signals        {}", scene.signals.len());
    }
    println!("  platform       {}", package::PLATFORM);
    Ok(())
}

fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// The normal forces that the run starts with, of the first contacts.
fn print_equilibrium(scene: &Scene, equilibrium: &Equilibrium) {
    const MOST: usize = 4;
    let forces = equilibrium.normal_force.iter().enumerate().take(MOST);
    let forces = forces.map(|(i, force)| format!("{force:.4} N at {}", scene.contact_name(i)));
    let more = if equilibrium.normal_force.len() > MOST { ", …" } else { "" };
    let forces = forces.collect::<Vec<_>>().join(", ");
    if !forces.is_empty() {
        println!("  equilibrium    {forces}{more}");
    }
}
