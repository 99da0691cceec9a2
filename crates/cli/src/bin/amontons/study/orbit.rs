//! `amontons study orbit`.

use super::arguments::{ObservationOptions, StudyArguments};
use super::folder::Folder;
use super::{heading, prepared, watched};
use amontons::integrator::Event;
use amontons::scene::Scene;
use amontons_analysis::orbit::{Orbit, OrbitEnergy, OrbitEvent, OrbitStart, check_signals};
use amontons_analysis::output;
use amontons_analysis::study::{FoundOrbit, From, Unfound, orbit};
use amontons_analysis::sweep::range;
use amontons_cli::say;
use amontons_export::documentation::counted;
use clap::Args;
use serde::Serialize;
use serde_json::json;
use std::error::Error;
use std::path::{Path, PathBuf};

/// File of the orbit, from which other commands start.
const FILE: &str = "orbit.json";
/// File of the motion at which Newton's method ended, where it found no orbit.
const BEST: &str = "best.json";

#[derive(Args)]
pub struct OrbitArguments {
    #[command(flatten)]
    common: StudyArguments,
    #[command(flatten)]
    options: ObservationOptions,
    /// Start from an orbit that this study has found before, perhaps with other values
    #[arg(long, value_name = "ORBIT.JSON", conflicts_with = "between")]
    from: Option<PathBuf>,
    /// Start from the boundary between the motions that two values of an initial value end in: unstable orbits are there
    #[arg(long, value_name = "NAME=A:B", value_parser = named_ends)]
    between: Option<(String, [f64; 2])>,
    /// Start in this oscillating mode of uniform sliding, counted by frequency from 1, a little above the amplitude at which
    /// a contact leaves sliding
    #[arg(long, value_name = "N", conflicts_with_all = ["from", "between"])]
    mode: Option<usize>,
}

/// Parses a name with two values.
pub fn named_ends(text: &str) -> Result<(String, [f64; 2]), String> {
    range::named(text, |values| {
        let (a, b) = values.split_once(':').ok_or("must be NAME=A:B, with two values")?;
        Ok([range::number(a)?, range::number(b)?])
    })
}

pub fn run(arguments: &OrbitArguments) -> Result<(), Box<dyn Error>> {
    let OrbitArguments { common, options, from, between, mode } = arguments;
    let (scene, source, observation) = prepared(common, options)?;
    let start = match (from, between) {
        (Some(path), _) => From::Orbit(Box::new(read(path, &scene)?)),
        (None, Some((name, ends))) => From::boundary(&scene, name, *ends)?,
        (None, None) => mode.map_or(From::Run, From::Mode),
    };
    let known = match &start {
        From::Orbit(orbit) => Some(orbit),
        From::Run | From::Boundary(_) | From::Mode(_) => None,
    };
    let settings = json!({ "look": observation, "between": between, "from": known, "mode": mode });
    let folder = Folder::open(common, "orbit", (&scene, &source), settings)?;
    let found = watched(|watch| orbit(&scene, &observation, &start, folder.journal(), watch));
    let found = match found {
        Ok(found) => found,
        Err(unfound) => return Err(with_best(unfound, folder.path())?.into()),
    };
    let Some(found) = found else { return Err(folder.interrupted()) };
    // That of an earlier study in the same folder.
    let _ = std::fs::remove_file(folder.path().join(BEST));
    folder.write_csv(
        &["time", "phase", "contact", "event", "states"],
        rows(&scene, &found.orbit).iter().flatten(),
    )?;
    folder.write_json(json!({
        "orbit": found.orbit,
        "stable": found.orbit.is_stable(),
        "ending": found.ending,
        "boundary": found.boundary,
    }))?;
    write(&folder.path().join(FILE), &found.orbit)?;
    say!("{}", heading(&[(&scene, &observation)]));
    print(&scene, &found);
    say!("\n{} has results.csv, study.json and {FILE}", folder.path().display());
    Ok(())
}

/// Saves the motion at which Newton's method ended, and returns the error, which then names its file.
fn with_best(unfound: Unfound, folder: &Path) -> Result<amontons::Error, Box<dyn Error>> {
    let Unfound { error, best: Some(best) } = &unfound else { return Ok(unfound.error) };
    let path = folder.join(BEST);
    write(&path, best)?;
    Ok(error.in_words(format!(
        "{error}; {} has the motion with this gap, from which --from of `study orbit` starts",
        path.display()
    )))
}

/// Reads an orbit, or a motion that is nearly one, that belongs to the scene.
pub fn read(path: &Path, scene: &Scene) -> Result<OrbitStart, amontons::Error> {
    let text =
        std::fs::read_to_string(path).map_err(|error| amontons::Error::file(path, &error))?;
    let wrong = |why: String| amontons::Error::file(path, &std::io::Error::other(why));
    let orbit: OrbitStart = serde_json::from_str(&text)
        .map_err(|error| wrong(format!("this is no orbit of `amontons study orbit`: {error}")))?;
    orbit.check(scene).map_err(|error| wrong(error.to_string()))?;
    Ok(orbit)
}

/// Lets a scene begin on the orbit in a file, with which it must have its other values in common.
///
/// # Errors
/// Returns an error if the file holds no orbit of this scene, or if a run from it is not back after the period.
pub fn begin(path: &Path, scene: &mut Scene) -> Result<(), amontons::Error> {
    let orbit = read(path, scene)?;
    orbit.give_start(scene)?;
    let (off, is_back) = orbit.comes_back(scene)?;
    if !is_back {
        let reason = match check_signals(scene, 0.0) {
            Err(signal) => format!(
                "the orbit belongs to the drive as it is later, but the run begins at 0 s: {signal}"
            ),
            Ok(()) => "give the scene the values with which the orbit was found (`set` in the study.json beside it)"
                .to_owned(),
        };
        let why = format!(
            "this is no motion of {} as it is: a run from it is not back after {:e} s, but off by {off:.1e} of the \
             motion's size; {reason}",
            scene.name, orbit.period
        );
        return Err(amontons::Error::file(path, &std::io::Error::other(why)));
    }
    Ok(())
}

fn write(path: &Path, orbit: &impl Serialize) -> Result<(), Box<dyn Error>> {
    let text = format!("{:#}\n", serde_json::to_value(orbit)?);
    Ok(output::write(path, text.as_bytes())?)
}

/// The rows of the table of events: one for each contact with an event, by time.
fn rows(scene: &Scene, orbit: &Orbit) -> Vec<Vec<[String; 5]>> {
    let of_instant = |instant: &OrbitEvent| {
        let states: Vec<String> = instant.states.iter().map(ToString::to_string).collect();
        let states = states.join("-");
        let row = |(contact, event): &(usize, Event)| {
            [
                format!("{:?}", instant.time),
                format!("{:?}", instant.time / orbit.period),
                scene.contact_name(*contact),
                words(*event).to_owned(),
                states.clone(),
            ]
        };
        instant.events.iter().map(row).collect()
    };
    orbit.events.iter().map(of_instant).collect()
}

/// What happens at an event.
pub fn words(event: Event) -> &'static str {
    match event {
        Event::Touch => "touches",
        Event::Lift => "lifts off",
        Event::Stop => "slip stops",
        Event::Slip(_) => "begins to slip",
        Event::Leave(_) => "is left by its surface",
        Event::Part => "parts",
    }
}

fn print(scene: &Scene, FoundOrbit { orbit, boundary, .. }: &FoundOrbit) {
    if let Some([low, high]) = boundary {
        say!("found from the boundary between {low} and {high}");
    }
    let changes = counted(orbit.events.len(), "change", "changes");
    say!(
        "\n{}: periodic motion, {:.12e} s ({:.6} Hz), {changes} of contact state",
        scene.name,
        orbit.period,
        1.0 / orbit.period
    );
    say!("defect {:.1e}, closure {:.1e} of the motion's size", orbit.defect, orbit.closure);
    let stability = match orbit.is_stable() {
        Some(true) => "stable",
        Some(false) => "unstable",
        None if orbit.ambiguous => {
            "stability unknown: events at one instant depend on their order for motions beside this one"
        }
        None => "at the limit of stability",
    };
    say!("{stability}; largest multiplier {:.6}", orbit.largest_multiplier());
    let list: Vec<String> = orbit.multipliers.iter().filter_map(multiplier).collect();
    say!("multipliers: {}", if list.is_empty() { "none".to_owned() } else { list.join(", ") });
    if let Some(along) = orbit.along {
        say!("along the motion: 1 {:+.0e}", along - 1.0);
    }
    say!("exactly zero: {}", orbit.zeros);
    say!("\n{:<24}  half peak to peak [m]", "displacement");
    let largest = orbit.extents.iter().copied().fold(0.0, f64::max);
    for (name, extent) in scene.dof_names().iter().zip(&orbit.extents) {
        // Rounding moves what contacts hold.
        let extent = if *extent < 1e-15 * largest { 0.0 } else { *extent };
        say!("{name:<24}  {extent:.9e}");
    }
    if let Some(energy) = &orbit.energy {
        print_energy(energy);
    }
    say!("\n{:>18}  {:>12}  {:<16}  {:<18}  then", "time [s]", "of a period", "contact", "event");
    for row in rows(scene, orbit).iter().flatten() {
        let [time, phase, contact, event, states] = row;
        let [time, phase]: [f64; 2] = [time, phase].map(|text| text.parse().unwrap_or(f64::NAN));
        say!("{time:>18.12e}  {phase:>12.9}  {contact:<16}  {event:<18}  {states}");
    }
}

fn print_energy(energy: &OrbitEnergy) {
    let OrbitEnergy { damping, friction, impact, slider, forces, residual } = energy;
    say!("\n{:<24}  in one period [J]", "energy");
    say!("{:<24}  {slider:.9e}", "work of sliders");
    say!("{:<24}  {forces:.9e}", "work of forces");
    say!("{:<24}  {damping:.9e}", "lost in damping");
    say!("{:<24}  {friction:.9e}", "lost in friction");
    say!("{:<24}  {impact:.9e}", "lost in impacts");
    say!("{:<24}  {residual:.0e}", "losses less work");
}

/// A multiplier in words; `None` of the second of a conjugate pair.
fn multiplier([re, im]: &[f64; 2]) -> Option<String> {
    /// Smaller ones are written with a power of ten.
    const SMALL: f64 = 1e-4;
    let number = |value: f64| {
        if value != 0.0 && value.abs() < SMALL {
            format!("{value:.1e}")
        } else {
            format!("{value:.6}")
        }
    };
    if *im == 0.0 {
        Some(number(*re))
    } else {
        (*im > 0.0).then(|| format!("{} ± {}i", number(*re), number(*im)))
    }
}
