//! `amontons study basin`.

use super::arguments::{ObservationOptions, StudyArguments};
use super::attractor::{self, number};
use super::folder::Folder;
use super::{heading, prepared_with};
use amontons::scene::Scene;
use amontons_analysis::regions::usual_islands;
use amontons_analysis::study::basin::{
    Axis, Basin as Found, Cell, Coverage, SHORT_WINDOWS, basin, check_points,
};
use amontons_analysis::study::{ObservationSettings, initial_value};
use amontons_cli::arguments::{Values, islands, named_grid};
use amontons_cli::charts::attractor::{unit_of, words};
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use amontons_pictures::picture::{Class, Map};
use clap::Args;
use serde_json::json;
use std::error::Error;

#[derive(Args)]
pub struct Basin {
    #[command(flatten)]
    common: StudyArguments,
    #[command(flatten)]
    shared: ShardArguments,
    #[command(flatten)]
    options: ObservationOptions,
    /// Initial value on the horizontal axis, such as module[1].v2, from A to B in steps of STEP or as N values;
    /// initial values on no axis are those of the scene or of --set
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N", value_parser = named_grid)]
    x: (String, Values),
    /// Initial value on the vertical axis, from A to B in steps of STEP or as N values
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N", value_parser = named_grid)]
    y: (String, Values),
    /// Find islands of N by N points wherever they lie, and run the points that show where basins meet; others are
    /// filled in. At least one point in N² is run [default: 8, and fewer along an axis of less than 49 points]
    #[arg(long, value_name = "N", value_parser = islands)]
    islands: Option<usize>,
    /// Run every point
    #[arg(long, conflicts_with = "islands")]
    every_point: bool,
}

pub fn run(arguments: &Basin) -> Result<(), Box<dyn Error>> {
    let Basin { common, shared, options, x, y, islands, every_point } = arguments;
    let (scene, source, observation) = prepared_with(common, options, |_, _| {})?;
    let axis = |(name, values): &(String, Values)| {
        Ok::<_, amontons::Error>(Axis {
            name: initial_value(&scene, name)?,
            values: values.0.clone(),
        })
    };
    let (x, y) = (axis(x)?, axis(y)?);
    check_points([&x, &y])?;
    for axis in [&x, &y] {
        if common.set.iter().any(|(set, _)| *set == axis.name) {
            eprintln!("note: {} takes the values of its axis, not that of --set", axis.name);
        }
    }
    let usual = usual_islands([&x, &y].map(|axis| axis.values.len()));
    let islands = (!every_point).then(|| islands.map_or(usual, |side| [side; 2]));
    let coverage = islands.map_or(Coverage::EveryPoint, Coverage::Traced);
    let settings = json!({ "x": x, "y": y, "look": observation, "islands": islands });
    let mut folder = Folder::open_shared(common, *shared, "basin", (&scene, &source), settings)?;
    let found = folder
        .found(|journal, watch| basin(&scene, [&x, &y], &observation, coverage, journal, watch))?;
    let Some(found) = found else { return Ok(()) };
    let points = y.values.iter().zip(&found.rows);
    let points = points.flat_map(|(y, row)| x.values.iter().zip(row).map(move |(x, c)| (x, y, c)));
    folder.write_csv(
        &["x", "y", "attractor", "kind", "decided"],
        points.map(|(x, y, cell)| {
            let kind = class(&found, cell);
            let decided = match cell {
                Cell { run: false, .. } => "filled in",
                Cell { early: true, .. } => "early",
                Cell { attractor: Some(_), .. } => "settled",
                Cell { .. } => "no",
            };
            let [x, y] = [x, y].map(|value| format!("{value:?}"));
            [x, y, number(cell.attractor), kind.to_owned(), decided.to_owned()]
        }),
    )?;
    // The table holds the attractor of each point.
    let [run, filled_in] = [true, false].map(|run| count(&found, |cell| cell.run == run));
    let points = json!({ "run": run, "filled_in": filled_in });
    folder.write_json(json!({ "attractors": found.attractors, "points": points }))?;
    print(&scene, [&x, &y], &observation, &found);
    if let (Some([columns, rows]), 1..) = (islands, filled_in) {
        say!(
            "{filled_in} points were not run but filled in; an island of less than {columns} by {rows} points can be \
             missed, which a smaller --islands or --every-point finds"
        );
    }
    let map = map(&scene, [&x, &y], &observation, &found);
    map.write(&folder.picture("basin"))?;
    say!("\nresults and pictures are in {}", folder.path().display());
    Ok(())
}

/// Number of points of the plane for which `is_such` holds.
fn count(found: &Found, is_such: impl Fn(&Cell) -> bool) -> usize {
    found.rows.iter().flatten().filter(|cell| is_such(cell)).count()
}

/// The kind of motion in which the run of a point ends, or the reason why it has none.
fn class(found: &Found, cell: &Cell) -> &'static str {
    match (cell.attractor, &cell.failure) {
        (Some(place), _) => found.attractors[place].kind.name(),
        (None, None) => "unsettled",
        (None, Some(_)) => "failed",
    }
}

fn print(scene: &Scene, [x, y]: [&Axis; 2], observation: &ObservationSettings, found: &Found) {
    let units = [x, y].map(|axis| unit_of(scene, &axis.name));
    say!("{}: {}, {}, and {}, {}", scene.name, x.name, units[0], y.name, units[1]);
    say!("{}", heading(&[(scene, observation)]));
    attractor::print(&found.attractors, &observation.of, unit_of(scene, &observation.of));
    say!("\npoints  end in");
    for place in 0..found.attractors.len() {
        say!("{:>6}  {}", count(found, |cell| cell.attractor == Some(place)), place + 1);
    }
    for rest in ["unsettled", "failed"] {
        let number = count(found, |cell| class(found, cell) == rest);
        if number > 0 {
            say!("{number:>6}  {rest}");
        }
    }
    say!(
        "{} of {} runs were decided early, with windows of {} s",
        count(found, |cell| cell.early),
        count(found, |cell| cell.run),
        observation.window / f64::from(SHORT_WINDOWS)
    );
    if let Some(failure) = found.rows.iter().flatten().find_map(|cell| cell.failure.as_ref()) {
        eprintln!("note: the first failed run: {failure}");
    }
}

fn map(scene: &Scene, [x, y]: [&Axis; 2], observation: &ObservationSettings, found: &Found) -> Map {
    let unit = unit_of(scene, &observation.of);
    let mut names: Vec<String> =
        found.attractors.iter().map(|ending| words(ending, unit)).collect();
    let attractors = names.len();
    let is_any = |name: &str| found.rows.iter().flatten().any(|cell| class(found, cell) == name);
    names
        .extend(["unsettled", "failed"].into_iter().filter(|name| is_any(name)).map(str::to_owned));
    let place = |cell: &Cell| {
        cell.attractor.unwrap_or_else(|| {
            let other = class(found, cell);
            attractors + usize::from(other == "failed" && names[attractors] != "failed")
        })
    };
    let cells = found.rows.iter().map(|row| row.iter().map(place).collect()).collect();
    let classes = names
        .iter()
        .enumerate()
        .map(|(place, name)| Class::numbered(name.clone(), place))
        .collect();
    let ends = |axis: &Axis| [axis.values[0], axis.values[axis.values.len() - 1]];
    let label = |axis: &Axis| format!("{} [{}]", axis.name, unit_of(scene, &axis.name));
    Map {
        title: format!("{}: basins of attraction", scene.name),
        x_label: label(x),
        y_label: label(y),
        x: ends(x),
        y: ends(y),
        cells,
        classes,
    }
}
