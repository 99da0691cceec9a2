//! `amontons-stability states`.

use crate::arguments::{Format, States};
use crate::{configured, progress};
use amontons::Error;
use amontons::contact::{ContactState, Joined, all_states};
use amontons::model::{self, Equilibrium, LumpedModel};
use amontons::scene::Scene;
use amontons::stability::candidates::uniform_sliding;
use amontons::stability::{
    Departure, MAX_CONTACTS, Spectrum, StateClasses, Symmetry, departure, modes,
    uniform_ring_spectrum,
};
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;

/// A state and what was found of it.
struct Row<'a> {
    states: Vec<ContactState>,
    spectrum: &'a Spectrum,
    has_equilibrium: bool,
}

pub fn run(arguments: &States) -> Result<(), Error> {
    let scene = configured(&arguments.common, arguments.friction)?;
    let model = LumpedModel::from(&scene);
    let equilibrium = model::equilibrium(&scene, &model);
    let resting = resting_state(&scene, &model);
    let row = |states: Vec<ContactState>, spectrum| Row {
        has_equilibrium: equilibrium.is_ok() && states == resting,
        states,
        spectrum,
    };
    let mu = scene.friction_coefficient;
    let one = match &arguments.state {
        Some(name) => Some(arguments.common.state(Some(name), &scene, &model)?),
        None if model.contacts.len() > MAX_CONTACTS => {
            eprintln!(
                "{} contacts: only uniform sliding is looked at; name another state with --state",
                model.contacts.len()
            );
            Some(uniform_sliding(&model, scene.slider.velocity))
        }
        None => None,
    };
    if let Some(states) = one {
        let spectrum = spectrum_of(&model, &states, mu)?;
        print(
            &scene,
            &model,
            &[row(states, &spectrum)],
            equilibrium.as_ref().ok(),
            arguments.format,
        );
        return Ok(());
    }
    let classes = StateClasses::of(&model)?;
    let bar = progress(classes.representatives.len());
    let spectra = classes.spectra(&model, mu, &|done| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    eprintln!("{} states, {} solved", classes.class_of.len(), spectra.len());
    let contacts = u32::try_from(model.contacts.len()).expect("few");
    let rows: Vec<Row> = all_states(contacts)
        .zip(&classes.class_of)
        .map(|(states, &class)| row(states, &spectra[class]))
        .collect();
    print(&scene, &model, &rows, equilibrium.as_ref().ok(), arguments.format);
    Ok(())
}

/// The one state in which a scene can be at rest in its own frame: uniform sliding, or all stuck
/// where the slider stands still.
fn resting_state(scene: &Scene, model: &LumpedModel) -> Vec<ContactState> {
    if scene.slider.velocity == 0.0 {
        vec![ContactState::Stick; model.contacts.len()]
    } else {
        uniform_sliding(model, scene.slider.velocity)
    }
}

/// Equal modules in equal states are solved wave by wave.
fn spectrum_of(model: &LumpedModel, states: &[ContactState], mu: f64) -> Result<Spectrum, Error> {
    let uniform = states.iter().all(|state| *state == states[0]);
    if uniform && !states.is_empty() && Symmetry::of(model) == Symmetry::Ring {
        return uniform_ring_spectrum(model, states[0], mu);
    }
    Spectrum::of(model, states, mu)
}

fn print(
    scene: &Scene,
    model: &LumpedModel,
    rows: &[Row],
    equilibrium: Option<&Equilibrium>,
    format: Format,
) {
    match format {
        Format::Json => println!("{:#}", as_json(scene, rows)),
        Format::Csv => print_csv(rows),
        Format::Table => {
            println!(
                "{}: eigenvalues / 2π [Hz] at µ = {}; * grows\n",
                scene.name, scene.friction_coefficient
            );
            if rows.len() == 16 && scene.network().is_none() {
                print_paper_table(rows);
            } else {
                print_list(rows);
            }
            print_departures(scene, model, equilibrium);
        }
    }
}

fn as_json(scene: &Scene, rows: &[Row]) -> Value {
    let states: Map<String, Value> = rows
        .iter()
        .map(|row| {
            let hz = |v: &f64| v / TAU;
            let oscillating = row.spectrum.oscillating.iter().map(|v| [v.re / TAU, v.im / TAU]);
            let value = json!({
                "eigenvalues_hz": oscillating.collect::<Vec<_>>(),
                "real_hz": row.spectrum.real.iter().map(hz).collect::<Vec<_>>(),
                "unstable": row.spectrum.unstable(),
                "has_equilibrium": row.has_equilibrium,
            });
            (Joined(&row.states).to_string(), value)
        })
        .collect();
    json!({ "scene": scene.name, "friction": scene.friction_coefficient, "states": states })
}

fn print_csv(rows: &[Row]) {
    println!("state,kind,real_hz,imaginary_hz,growth_rate,unstable");
    for row in rows {
        let name = Joined(&row.states);
        for v in &row.spectrum.oscillating {
            let (re, im) = (v.re / TAU, v.im / TAU);
            println!("{name},oscillating,{re:?},{im:?},{:?},{}", v.re, v.re > 0.0);
        }
        for v in &row.spectrum.real {
            println!("{name},real,{:?},0.0,{v:?},{}", v / TAU, *v > 0.0);
        }
    }
}

/// The eigenvalues of a state as the paper prints them.
fn cells(spectrum: &Spectrum) -> Vec<String> {
    let mark = |growth: f64| if growth > 0.0 { '*' } else { ' ' };
    let oscillating = spectrum
        .oscillating
        .iter()
        .map(|v| format!("{}{:.2} ± {:.2}i", mark(v.re), v.re / TAU, v.im / TAU));
    let real = spectrum.real.iter().map(|v| format!("{}{:.2} (real)", mark(*v), v / TAU));
    oscillating.chain(real).collect()
}

/// Two contacts: module 1 across, module 2 down, as in Tables 2 and 3.
fn print_paper_table(rows: &[Row]) {
    const WIDTH: usize = 22;
    let cell = |first: ContactState, second: ContactState| {
        let row = rows.iter().find(|row| row.states == [first, second]).expect("all states");
        cells(row.spectrum)
    };
    print!("{:9}", "Module 1");
    for first in ContactState::ALL {
        print!("{:>WIDTH$}", first.to_string());
    }
    println!("\nModule 2");
    for second in ContactState::ALL {
        let columns = ContactState::ALL.map(|first| cell(first, second));
        let lines = columns.iter().map(Vec::len).max().unwrap_or(0);
        for line in 0..lines {
            let name = if line == 0 { second.to_string() } else { String::new() };
            print!("{name:9}");
            for column in &columns {
                print!("{:>WIDTH$}", column.get(line).map_or("-", |cell| cell));
            }
            println!();
        }
        println!();
    }
}

fn print_list(rows: &[Row]) {
    for row in rows {
        let note = if row.has_equilibrium { " (equilibrium)" } else { "" };
        println!("{}{note}", Joined(&row.states));
        for cell in cells(row.spectrum) {
            println!("  {cell}");
        }
    }
    println!();
}

/// The way from the linear answer to the non-linear one.
fn print_departures(scene: &Scene, model: &LumpedModel, equilibrium: Option<&Equilibrium>) {
    let mu = scene.friction_coefficient;
    let Some(equilibrium) = equilibrium.filter(|_| model.contacts.len() <= MAX_CONTACTS) else {
        return;
    };
    let sliding = uniform_sliding(model, scene.slider.velocity);
    let Ok(found) = modes(model, &sliding, mu) else { return };
    println!("Uniform sliding: how large each mode may become before a contact leaves sliding");
    let names = scene.dof_names();
    for mode in &found.oscillating {
        let first = departure(model, equilibrium, mu, scene.slider.velocity, mode);
        let Some(Departure { contact, into, amplitude, dof }) = first else { continue };
        println!(
            "  {:8.2} Hz  {:.3e} m of {} ({:.3e} m/s): {} into {into}",
            mode.frequency_hz(),
            amplitude,
            names[dof],
            amplitude * mode.eigenvalue.norm(),
            scene.contact_name(contact),
        );
    }
}
