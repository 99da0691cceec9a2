//! `amontons-stability map`.

use crate::arguments::Map as MapArguments;
use crate::{Failure, check_effect, configured};
use amontons::Error;
use amontons::model::Contact;
use amontons_analysis::assign::assign;
use amontons_analysis::journal::Journal;
use amontons_analysis::output::AtomicFile;
use amontons_analysis::stability::map::{Map as Found, Verdict, map};
use amontons_analysis::stability::{Linearised, MAX_CONTACTS};
use amontons_analysis::sweep::axis;
use amontons_analysis::sweep::range::MAX_VALUES;
use amontons_analysis::watch::Watch;
use amontons_cli::arguments::Values;
use amontons_cli::interrupt::{Interrupted, watched};
use amontons_cli::progress::Progress;
use amontons_cli::shards::{Pieces, Program, identity};
use amontons_pictures::picture::{self, Class, Map};
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Indices in the palette of the colours for the verdicts, in their order.
const COLOURS: [usize; 6] = [5, 4, 3, 1, 6, 7];

pub fn run(arguments: &MapArguments, out: &mut dyn Write) -> Result<(), Failure> {
    arguments.plot.as_deref().map_or(Ok(()), picture::check_name)?;
    let given = configured(&arguments.common, None, &[&*arguments.x.0, &*arguments.y.0])?;
    let scene = &given.scene;
    let (x_name, Values(x)) = &arguments.x;
    let (y_name, Values(y)) = &arguments.y;
    let points = x.len() * y.len();
    if points as f64 > MAX_VALUES {
        return Err(Failure::Usage(format!(
            "{} × {} points are too many; a map has at most {MAX_VALUES:e}",
            x.len(),
            y.len()
        )));
    }
    if x_name == y_name {
        return Err(Failure::Usage(format!(
            "--x and --y both are {x_name}; a map needs two parameters"
        )));
    }
    for (name, values) in [&arguments.x, &arguments.y] {
        let seen = |value: f64| {
            let mut scene = scene.clone();
            assign(&mut scene, name, value)?;
            let mut model = Linearised::of(&scene).model().clone();
            if model.law.friction.info().is_constant() {
                // The verdict then depends on the directions of the surface velocities alone.
                let turn =
                    |contact: &mut Contact| contact.surface_velocity = contact.sliding_sign();
                model.contacts.iter_mut().for_each(turn);
            }
            Ok(model)
        };
        let wish = "the verdict depends on masses, stiffnesses, damping, preload, slider.angle, \
                    friction.coefficient and the sign of slider.velocity";
        check_effect(name, &values.0, seen, wish)?;
    }
    let contacts = scene.contact_count();
    if contacts > MAX_CONTACTS {
        eprintln!("note: {contacts} contacts: only uniform sliding is examined");
    }
    let scene_at = |column: usize, row: usize| {
        let mut scene = scene.clone();
        assign(&mut scene, x_name, x[column])?;
        assign(&mut scene, y_name, y[row])?;
        Ok(scene)
    };
    let islands = arguments.islands.map(|side| [side; 2]);
    let work = |journal: &Journal, watch: Watch<'_>| {
        map([x.len(), y.len()], islands, &scene_at, journal, watch)
    };
    let folder = folder(arguments)?;
    let Found { verdicts: found, filled_in } = if let Some(folder) = folder {
        let settings =
            json!({ "at": given.at, "x": [x_name, x], "y": [y_name, y], "islands": islands });
        let (set, shared) = (&arguments.common.set, arguments.shared);
        let study = identity("map", (scene, &given.source), set, settings);
        let mut pieces = Pieces::open(folder, Program::Stability, shared, &study, false)?;
        let Some(found) = pieces.found("the map", work)? else { return Ok(()) };
        let path = folder.join("results.csv");
        let mut file = AtomicFile::create(&path)?;
        write_points(&mut file, [(x_name, x), (y_name, y)], &found.verdicts)
            .map_err(|error| Error::file(&path, &error))?;
        file.complete()?;
        found
    } else {
        let bar = Progress::in_parts("the map");
        let found = watched(&bar, |watch| work(&Journal::forgotten(), watch))?;
        found.ok_or_else(|| Failure::Unfinished(Box::new(Interrupted)))?
    };
    if let (Some([columns, rows]), 1..) = (islands, filled_in) {
        eprintln!(
            "note: {filled_in} of {points} verdicts were not computed but filled in; an island of less than {columns} \
             by {rows} points can be missed, which a smaller --islands or a map without it finds"
        );
    }
    let share = |verdict: Verdict| found.iter().flatten().filter(|v| **v == verdict).count();
    if arguments.csv && folder.is_none() {
        write_points(out, [(x_name, x), (y_name, y)], &found)?;
    } else {
        writeln!(out, "{}: {points} points of {x_name} and {y_name}", scene.name)?;
        write!(out, "{}", given.head())?;
        let is_told = |verdict: &Verdict| *verdict != Verdict::Impossible || share(*verdict) > 0;
        for verdict in Verdict::ALL.into_iter().filter(is_told) {
            writeln!(out, "  {:40} {}", verdict.to_string(), share(verdict))?;
        }
    }
    let Some(path) = &arguments.plot else { return Ok(()) };
    // The legend lists only the verdicts that occur.
    let classes: Vec<(Verdict, usize)> =
        Verdict::ALL.into_iter().zip(COLOURS).filter(|(verdict, _)| share(*verdict) > 0).collect();
    let place = |v: &Verdict| {
        classes.iter().position(|(verdict, _)| verdict == v).expect("every verdict found is there")
    };
    let picture = Map {
        title: format!("{}: uniform sliding", scene.name),
        x_label: axis(scene, x_name),
        y_label: axis(scene, y_name),
        x: [x[0], x[x.len() - 1]],
        y: [y[0], y[y.len() - 1]],
        cells: found.iter().map(|row| row.iter().map(place).collect()).collect(),
        classes: classes
            .iter()
            .map(|&(verdict, colour)| Class::plain(verdict.to_string(), colour))
            .collect(),
    };
    Ok(picture.write(&folder.map_or_else(|| path.clone(), |folder| folder.join(path)))?)
}

/// The folder of all workers; `None` for a map of one machine.
fn folder(arguments: &MapArguments) -> Result<Option<&Path>, Failure> {
    let (shared, output) = (arguments.shared, arguments.output.as_deref());
    match output {
        Some(_) if !shared.is_part() => Err(Failure::Usage(
            "-o names the folder of the workers of a map, so it needs --shard I/N; without it --csv prints the points \
             and --plot FILE draws them"
                .to_owned(),
        )),
        output if shared.is_part() => Ok(Some(shared.folder(output)?)),
        _ => Ok(None),
    }
}

/// Writes every point with its verdict as CSV.
fn write_points(
    out: &mut dyn Write,
    [(x_name, x), (y_name, y)]: [(&String, &Vec<f64>); 2],
    found: &[Vec<Verdict>],
) -> std::io::Result<()> {
    writeln!(out, "{x_name},{y_name},verdict")?;
    for (row, y) in found.iter().zip(y) {
        for (verdict, x) in row.iter().zip(x) {
            writeln!(out, "{x:?},{y:?},{verdict}")?;
        }
    }
    Ok(())
}
