//! `amontons export`.

mod accuracy;
mod written;

use crate::arguments::Export;
use crate::scenes;
use crate::study::orbit;
use amontons::Error;
use amontons::model::{Equilibrium, LumpedModel};
use amontons::scene::{Method, Scene, Selection, Structure};
use amontons::simulation::Simulation;
use amontons::simulation::catalogue::{Causality, fmu_variables};
use amontons::stability::critical_step;
use amontons_analysis::output::{self, check_folder, check_inputs_stay};
use amontons_cli::say;
use amontons_export::documentation::{Subject, counted, documentation, normal_forces, size};
use amontons_export::package::{self, Library};
use amontons_export::scene;
use std::path::{Path, PathBuf};

pub fn run(arguments: &Export) -> Result<(), Box<dyn std::error::Error>> {
    let (mut scene, mut source) = scene::find(&arguments.scene)?;
    if let Some(orbit) = &arguments.from {
        orbit::begin(orbit, &mut scene)?;
        scene::set_initial(&mut source, &mut scene)?;
    }
    let given = (scene.selection, scene.method, scene.step);
    arguments.integrator.choice().apply(&mut scene)?;
    let path =
        arguments.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.fmu", scene.name)));
    // Before the work: errors of writing and of running the scene.
    check_folder(&path)?;
    let files = [Some(Path::new(&arguments.scene)), arguments.from.as_deref()];
    check_inputs_stay(&path, &files.into_iter().flatten().collect::<Vec<_>>())?;
    scenes::check(&scene)?;
    let page = arguments.with_accuracy.then(|| accuracy::page(&scene)).transpose()?;
    if (scene.selection, scene.method, scene.step) != given {
        match scene.selection {
            Selection::Preset(preset) => scene::set_preset(&mut source, preset)?,
            _ => scene::set_integrator(&mut source, scene.method, scene.step)?,
        }
    }
    let simulation = scenes::start(&scene)?;
    let run = written::run(&scene)?;
    let subject = Subject { scene: &scene, source: &source, start: &simulation, run: &run };
    let libraries = libraries(&arguments.platform);
    let documentation = documentation(subject, page)?;
    let fmu = package::fmu(&scene, &source, Some(&documentation), &libraries)?;
    let check = arguments.with_reference.then(|| written::check(&scene)).transpose()?;
    output::write(&path, &fmu)?;
    let beside = check.as_ref().map_or_else(Vec::new, |check| written::files(check, &path));
    for (path, text) in &beside {
        output::write(path, text.as_bytes())?;
    }
    let colon = if scene.description.is_empty() { "" } else { ": " };
    say!("{}{colon}{}", scene.name, scene.description);
    print_contents(&scene, &simulation)?;
    say!("  platform       {}", platforms(&libraries));
    print_equilibrium(&scene, simulation.reference());
    for (name, bytes) in &source.binaries {
        say!("  matrices       resources/{name} ({})", size(bytes.len()));
    }
    say!("  FMU            {} ({})", path.display(), size(fmu.len()));
    let mut label = "reference";
    for (path, text) in &beside {
        say!("  {label:13}  {} ({})", path.display(), size(text.len()));
        label = "";
    }
    if let Some(left_out @ 1..) = check.map(|check| check.left_out) {
        eprintln!(
            "note: the reference run leaves out the last {}, because the size of its file is limited",
            counted(left_out, "output", "outputs")
        );
    }
    Ok(())
}

/// Returns the libraries of the platforms asked for, or of all; the order does not depend on the command line.
fn libraries(asked: &[Library]) -> Vec<Library> {
    Library::carried()
        .iter()
        .filter(|library| asked.is_empty() || asked.contains(library))
        .copied()
        .collect()
}

/// Names of the platforms, separated by commas.
pub fn platforms(libraries: &[Library]) -> String {
    libraries.iter().map(|library| library.platform).collect::<Vec<_>>().join(", ")
}

/// Prints the contents of the FMU: structure, variables, critical step of the values that hold at the start.
fn print_contents(scene: &Scene, simulation: &Simulation) -> Result<(), Error> {
    let effective = simulation.scene();
    let model = LumpedModel::from(effective);
    let kind = match &scene.structure {
        Structure::Ring(modules) => format!("ring of {} modules", modules.len()),
        Structure::Network(network) => {
            let masses = counted(network.masses.len(), "mass", "masses");
            let superelements =
                counted(network.superelements.len(), "superelement", "superelements");
            match (network.masses.is_empty(), network.superelements.is_empty()) {
                (_, true) => format!("network of {masses}"),
                (true, false) => format!("network of {superelements}"),
                (false, false) => format!("network of {masses} and {superelements}"),
            }
        }
    };
    say!(
        "  structure      {kind}: {}, {}",
        counted(model.dofs(), "degree of freedom", "degrees of freedom"),
        counted(model.contacts.len(), "contact", "contacts")
    );
    let variables = fmu_variables(scene);
    let count = |causality| variables.iter().filter(|v| v.causality == causality).count();
    say!(
        "  variables      {}, {}, {}",
        counted(count(Causality::Input), "input", "inputs"),
        counted(count(Causality::Output), "output", "outputs"),
        counted(count(Causality::Parameter), "parameter", "parameters")
    );
    if let Some(selected) = simulation.selected() {
        say!("  chosen by      integrator.{}: {selected}", scene.selection);
    }
    say!("  step           {:e} s", effective.step);
    match effective.method {
        Method::ForwardIncrement => {
            say!("  critical step  {}", critical_step(&model)?);
        }
        Method::EventDriven => {
            say!("  integrator     event-driven, exact between changes of contact state");
        }
    }
    if !scene.signals.is_empty() {
        say!("  signals        {}", scene.signals.len());
    }
    Ok(())
}

/// Prints the normal forces of the first closed contacts at the start of the run, and how many are open.
fn print_equilibrium(scene: &Scene, equilibrium: &Equilibrium) {
    const MOST: usize = 4;
    let forces = normal_forces(scene, equilibrium, MOST);
    if !forces.is_empty() {
        say!("  equilibrium    {forces}");
    }
}
