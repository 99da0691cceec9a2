//! `amontons-stability map`.

use crate::arguments::{Map as Arguments, Values};
use crate::labels::axis;
use crate::{Failure, configured, progress};
use amontons::picture::{self, Class, Map};
use amontons::simulation::assign;
use amontons::stability::map::{Verdict, map};
use std::io::Write;

/// The most points of a map.
const MAX_POINTS: usize = 1_000_000;

/// Places in the palette that belong to the verdicts, in their order.
const COLOURS: [usize; 4] = [5, 4, 1, 6];

pub fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<(), Failure> {
    picture::check_name(&arguments.plot)?;
    let scene = configured(&arguments.common, None)?;
    let (x_name, Values(x)) = &arguments.x;
    let (y_name, Values(y)) = &arguments.y;
    let points = x.len() * y.len();
    if points > MAX_POINTS {
        return Err(Failure::Usage(format!(
            "{} × {} points are too many; a map has at most {MAX_POINTS}",
            x.len(),
            y.len()
        )));
    }
    if x_name == y_name {
        return Err(Failure::Usage(format!(
            "--x and --y both are {x_name}; a map needs two parameters"
        )));
    }
    let scene_at = |column: usize, row: usize| {
        let mut scene = scene.clone();
        assign(&mut scene, x_name, x[column])?;
        assign(&mut scene, y_name, y[row])?;
        Ok(scene)
    };
    let bar = progress(y.len());
    let found = map(x.len(), y.len(), &scene_at, &|done| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    let share = |verdict: Verdict| found.iter().flatten().filter(|v| **v == verdict).count();
    writeln!(out, "{}: {points} points of {x_name} and {y_name}", scene.name)?;
    for verdict in Verdict::ALL {
        writeln!(out, "  {:14} {}", verdict.to_string(), share(verdict))?;
    }
    // The legend has only what is there.
    let classes: Vec<(Verdict, usize)> =
        Verdict::ALL.into_iter().zip(COLOURS).filter(|(verdict, _)| share(*verdict) > 0).collect();
    let place = |v: &Verdict| {
        classes.iter().position(|(verdict, _)| verdict == v).expect("every verdict found is there")
    };
    let picture = Map {
        title: format!("{}: uniform sliding", scene.name),
        x_label: axis(&scene, x_name),
        y_label: axis(&scene, y_name),
        x: [x[0], x[x.len() - 1]],
        y: [y[0], y[y.len() - 1]],
        cells: found.iter().map(|row| row.iter().map(place).collect()).collect(),
        classes: classes
            .iter()
            .map(|&(verdict, colour)| Class { name: verdict.to_string(), colour })
            .collect(),
    };
    Ok(picture.write(&arguments.plot)?)
}
