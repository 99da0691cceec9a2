//! `amontons-stability map`.

use crate::arguments::{Map as Arguments, Values};
use crate::{configured, progress};
use amontons::Error;
use amontons::picture::{Class, Map};
use amontons::simulation::assign;
use amontons::stability::map::{Verdict, map};

/// Places in the palette that belong to the verdicts, in their order.
const COLOURS: [usize; 4] = [5, 4, 1, 6];

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let scene = configured(&arguments.common, None)?;
    let (x_name, Values(x)) = &arguments.x;
    let (y_name, Values(y)) = &arguments.y;
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
    println!("{}: {} points of {x_name} and {y_name}", scene.name, x.len() * y.len());
    for verdict in Verdict::ALL {
        println!("  {:14} {}", verdict.to_string(), share(verdict));
    }
    // Points become the middles of cells.
    let edges = |values: &[f64]| {
        let half = 0.5 * (values[1] - values[0]);
        [values[0] - half, values[values.len() - 1] + half]
    };
    let place = |v: &Verdict| Verdict::ALL.iter().position(|o| o == v).expect("one of all");
    Map {
        title: format!("{}: uniform sliding", scene.name),
        x_label: x_name.clone(),
        y_label: y_name.clone(),
        x: edges(x),
        y: edges(y),
        cells: found.iter().map(|row| row.iter().map(place).collect()).collect(),
        classes: Verdict::ALL
            .iter()
            .zip(COLOURS)
            .map(|(verdict, colour)| Class { name: verdict.to_string(), colour })
            .collect(),
    }
    .write(&arguments.plot)
}
