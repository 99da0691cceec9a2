//! `amontons study perturbation`.

use super::arguments::{ObservationOptions, StudyArguments};
use super::attractor::{self, number};
use super::folder::Folder;
use super::{heading, prepared, watched};
use amontons::scene::Scene;
use amontons_analysis::study::perturbation::{
    Direction, Perturbations, Run, Threshold, perturbation,
};
use amontons_analysis::study::{ObservationSettings, initial_value};
use amontons_cli::arguments::{Values, grid};
use amontons_cli::charts::attractor::unit_of;
use amontons_cli::charts::perturbation::{endings, histories};
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use amontons_export::documentation::counted;
use clap::Args;
use serde_json::json;
use std::error::Error;

#[derive(Args)]
pub struct Perturbation {
    #[command(flatten)]
    common: StudyArguments,
    #[command(flatten)]
    shared: ShardArguments,
    #[command(flatten)]
    options: ObservationOptions,
    /// Initial value to vary, such as module[1].v2; the other initial values are those of the scene or of --set
    #[arg(long, value_name = "NAME")]
    direction: String,
    /// Values of this initial value from A to B, in steps of STEP or as N values
    #[arg(long, value_name = "A:B:STEP|A:B/N", value_parser = grid, allow_hyphen_values = true)]
    amplitude: Values,
    /// Relative accuracy of the thresholds
    #[arg(long, value_name = "PART", default_value_t = 1e-3, allow_hyphen_values = true)]
    resolution: f64,
}

pub fn run(arguments: &Perturbation) -> Result<(), Box<dyn Error>> {
    let Perturbation { common, shared, options, direction: name, amplitude, resolution } =
        arguments;
    let (scene, source, observation) = prepared(common, options)?;
    let direction = Direction {
        name: initial_value(&scene, name)?,
        amplitudes: amplitude.0.clone(),
        resolution: *resolution,
    };
    if common.set.iter().any(|(set, _)| *set == direction.name) {
        eprintln!("note: {} takes the values of --amplitude, not that of --set", direction.name);
    }
    // Neither the range nor the resolution affects the end of a run, so both may be changed later.
    let settings = json!({ "direction": direction.name, "look": observation });
    let mut folder =
        Folder::open_shared(common, *shared, "perturbation", (&scene, &source), settings)?;
    let found = folder
        .found(|journal, watch| perturbation(&scene, &direction, &observation, journal, watch))?;
    let Some(found) = found else { return Ok(()) };
    folder.write_csv(
        &["amplitude", "kind", "attractor", "final_amplitude", "frequency", "time"],
        found.runs.iter().map(row),
    )?;
    folder.write_json(json!({ "direction": direction, "found": found }))?;
    print(&scene, &direction, &observation, &found);
    folder.draw("perturbation", &endings(&scene, &direction, &observation, &found))?;
    if let Some(threshold) = found.thresholds.first() {
        match watched(|watch| {
            histories(&scene, &direction, &observation, (&found, threshold), &|| watch.is_over())
        })? {
            Some(chart) => folder.draw("histories", &chart)?,
            None => return Err(folder.interrupted()),
        }
    }
    say!("\nresults and pictures are in {}", folder.path().display());
    Ok(())
}

fn row(run: &Run) -> [String; 6] {
    let Run { amplitude, ending, attractor, .. } = run;
    let value = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:?}"));
    let ending = ending.as_ref();
    [
        format!("{amplitude:?}"),
        ending.map_or("failed", |ending| ending.kind.name()).to_owned(),
        number(*attractor),
        value(ending.map(|ending| ending.amplitude)),
        value(ending.and_then(|ending| ending.frequency)),
        value(ending.map(|ending| ending.time)),
    ]
}

fn print(
    scene: &Scene,
    direction: &Direction,
    observation: &ObservationSettings,
    found: &Perturbations,
) {
    let unit = unit_of(scene, &direction.name);
    say!("{}: {}, {unit}", scene.name, direction.name);
    say!("{}", heading(&[(scene, observation)]));
    attractor::print(&found.attractors, &observation.of, unit_of(scene, &observation.of));
    say!("\n{:<27}  runs  end in", direction.name);
    for same in found.runs.chunk_by(|a, b| class(a) == class(b)) {
        let [first, last] = [&same[0], &same[same.len() - 1]].map(|run| run.amplitude);
        let range = if same.len() == 1 { format!("{first}") } else { format!("{first} to {last}") };
        say!("{range:<27}  {:>4}  {}", same.len(), class(&same[0]));
    }
    if let Some(failure) = found.runs.iter().find_map(|run| run.failure.as_ref()) {
        eprintln!("note: the first failed run: {failure}");
    }
    say!("\nthresholds, to a relative accuracy of {:e}", direction.resolution);
    for Threshold { between: [below, above], attractors: [from, to] } in &found.thresholds {
        say!("  between {below} and {above} {unit}: below {}, above {}", from + 1, to + 1);
    }
    let left = found.runs.iter().filter(|run| run.attractor.is_none()).count();
    if found.thresholds.is_empty() && left < found.runs.len() {
        say!("  none between neighbouring amplitudes that both end in an attractor");
    }
    if found.runs.len() > 1 {
        say!(
            "  changes that occur and revert between two neighbouring amplitudes are not detected; a smaller step of \
             --amplitude shows them"
        );
    }
    if left > 0 {
        let runs = counted(left, "run", "runs");
        say!("  unknown next to the {runs} that did not end in an attractor");
    }
}

/// The result of a run: the number of its attractor, or the reason why it has none.
fn class(run: &Run) -> String {
    match (run.attractor, &run.ending) {
        (Some(place), _) => (place + 1).to_string(),
        (None, Some(ending)) => ending.kind.name().to_owned(),
        (None, None) => "failed".to_owned(),
    }
}
