//! `amontons study robustness`.

use super::arguments::{ObservationOptions, StudyArguments, only_of_runs};
use super::folder::{Folder, quoted};
use super::{found, prepared_again, set_pace};
use amontons::Error;
use amontons::error::{Rounded, Short};
use amontons::scene::Scene;
use amontons::simulation::at_instant;
use amontons_analysis::instant::signals_left_out;
use amontons_analysis::robustness::{
    Both as Found, Design, Distribution, Estimate, Index, Parameter, Pushes, Squeals, Uncertain,
    both, check_runs, check_size, parameters, push_velocity, verdict,
};
use amontons_analysis::study::ObservationSettings;
use amontons_analysis::sweep::range::ends;
use amontons_cli::charts::robustness::{histogram, indices};
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use amontons_cli::words::robustness as words;
use clap::Args;
use serde_json::{Value, json};

#[derive(Args)]
pub struct RobustnessArguments {
    #[command(flatten)]
    pub common: StudyArguments,
    #[command(flatten)]
    pub shared: ShardArguments,
    #[command(flatten)]
    pub scatter: Scatter,
    /// Contact state, one for all contacts (Sl), one for each (Sl-St), by names (pad=St,*=Sl), or `equilibrium` [default:
    /// uniform sliding]
    #[arg(long, value_name = "STATE")]
    pub state: Option<String>,
    /// Number of draws in each scrambling, a power of two; more make intervals narrower
    #[arg(long, value_name = "N", default_value_t = 1024)]
    pub points: u64,
    /// Number of independent scramblings, whose differences give the intervals
    #[arg(long, value_name = "R", default_value_t = 16)]
    pub scramblings: u64,
    /// Ranges of frequencies, Hz, in each of which the probability of growth is told [default: the families of frequencies in
    /// which modes grow]
    #[arg(long, value_name = "A:B,...", value_parser = ends, value_delimiter = ',')]
    pub bands: Vec<[f64; 2]>,
    /// Compute no Sobol indices, which take two and one more evaluation for each parameter with each draw
    #[arg(long)]
    pub no_indices: bool,
    #[command(flatten)]
    pub options: ObservationOptions,
}

/// The parameters that scatter, and the runs of draws.
#[derive(Args)]
pub struct Scatter {
    /// A parameter that scatters, with its distribution: uniform(A,B), triangular(A,MODE,B), normal(MEAN,SD),
    /// lognormal(MEDIAN,SIGMA), with bounds as normal(MEAN,SD,MIN:MAX), or as a part of the scene's value, such as
    /// normal(±10%). `*` in NAME stands for any part, and each parameter has draws of its own; after the word together, as in
    /// 'mass.*.mass=together normal(±5%)', all change by the same part. May be repeated
    #[arg(long, value_name = "NAME=DISTRIBUTION", value_parser = Uncertain::parse)]
    pub uncertain: Vec<Uncertain>,
    /// Seed of all draws; other seeds give independent results
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Run draws too, each after a push in a random direction out of its equilibrium, and tell how probable it is that the scene
    /// squeals: the distribution of the push's largest velocity, m/s, such as uniform(0,0.1)
    #[arg(long, value_name = "DISTRIBUTION", value_parser = Distribution::parse)]
    pub pushes: Option<Distribution>,
    /// Number of runs after pushes
    #[arg(long, value_name = "N", default_value_t = 100, requires = "pushes")]
    pub runs: u64,
}

pub fn run(arguments: &RobustnessArguments) -> Result<(), Box<dyn std::error::Error>> {
    let RobustnessArguments { common, shared, options, scatter, .. } = arguments;
    let Scatter { seed, pushes, .. } = scatter;
    let (scene, source) = found(common)?;
    let parameters = parameters(&scene, &scatter.uncertain)?;
    check(arguments, &scene, &parameters)?;
    let mut scene = at_instant(&scene, 0.0)?;
    scene.check()?;
    let velocity = pushes.as_ref().map(push_velocity).transpose()?;
    if velocity.is_some() {
        let observation = ObservationSettings::of(&scene, &options.request())?;
        set_pace(&mut scene, common, &observation, amontons_analysis::study::pace)?;
    }
    // Said before the folder is made.
    verdict(&scene, arguments.state.as_deref())?;
    let pushes = scatter.described(common, options);
    let described: Vec<_> = parameters.iter().map(Parameter::described).collect();
    // Other numbers of points, scramblings, bands or runs take over the pieces that are there.
    let settings = json!({
        "uncertain": described,
        "state": arguments.state,
        "seed": seed,
        "indices": !arguments.no_indices,
        "pushes": pushes,
    });
    let mut folder =
        Folder::open_shared(common, *shared, "robustness", (&scene, &source), settings)?;
    let design = Design {
        scene: &scene,
        parameters: &parameters,
        state: arguments.state.as_deref(),
        scramblings: arguments.scramblings,
        points: arguments.points,
        seed: *seed,
        has_indices: !arguments.no_indices,
    };
    let prepare = |scene: &mut Scene| prepared_again(scene, common, options);
    let pushes = velocity.as_ref().map(|velocity| Pushes {
        scene: &scene,
        parameters: &parameters,
        velocity,
        prepare: &prepare,
        runs: scatter.runs,
        seed: *seed,
        name: "run",
    });
    let bands = (!arguments.bands.is_empty()).then_some(&arguments.bands[..]);
    let Some(found) =
        folder.found(|journal, watch| both(&design, bands, pushes.as_ref(), journal, watch))?
    else {
        return Ok(());
    };
    write(&folder, &parameters, arguments, &found)?;
    print(&scene, &parameters, arguments, &found);
    if let Some(eigenvalues) = &found.eigenvalues {
        folder.draw("growth", &histogram(&scene, eigenvalues))?;
        if let Some(chart) = indices(&scene, &parameters, eigenvalues) {
            folder.draw("indices", &chart)?;
        }
    }
    say!("\nresults and pictures are in {}", folder.path().display());
    Ok(())
}

/// Refuses a study that would have nothing to vary, or whose numbers make no sense; notes what a person may not expect.
fn check(
    arguments: &RobustnessArguments,
    scene: &Scene,
    parameters: &[Parameter],
) -> Result<(), Error> {
    if parameters.is_empty() && arguments.scatter.pushes.is_none() {
        return Err(Error::argument(
            "nothing varies: give --uncertain NAME=DISTRIBUTION, such as \
             --uncertain 'friction.coefficient=normal(±10%)', or --pushes",
        ));
    }
    check_size(arguments.scramblings, arguments.points)?;
    check_options(arguments)?;
    arguments.scatter.check(scene)?;
    tell_notes(&arguments.common, scene, parameters);
    Ok(())
}

impl Scatter {
    /// Refuses runs that are impossible in a scene.
    pub fn check(&self, scene: &Scene) -> Result<(), Error> {
        if self.pushes.is_some() { check_runs(scene, self.runs) } else { Ok(()) }
    }

    /// All that runs depend on, as a journal identifies it; `None` without pushes.
    pub fn described(
        &self,
        common: &StudyArguments,
        options: &ObservationOptions,
    ) -> Option<Value> {
        let pushes = self.pushes.as_ref();
        // Each draw derives its step anew unless it is chosen.
        pushes.map(|pushes| json!({ "pushes": pushes.to_string(), "look": options, "integrator": common.integrator }))
    }
}

/// Notes what a person may not expect of draws.
pub fn tell_notes(common: &StudyArguments, scene: &Scene, parameters: &[Parameter]) {
    for parameter in parameters {
        let is_set = common.set.iter().any(|(name, _)| name == parameter.name());
        if is_set && !parameter.is_relative {
            eprintln!(
                "note: {} takes the values of --uncertain, not that of --set",
                parameter.name()
            );
        }
        if let Some(note) = parameter.note() {
            eprintln!("note: {note}");
        }
    }
    if let Some(left_out) = signals_left_out(scene, 0.0) {
        eprintln!("note: {left_out}");
    }
}

/// Refuses options that would change nothing: those of runs without pushes, and those of draws without parameters that scatter.
fn check_options(arguments: &RobustnessArguments) -> Result<(), Error> {
    let of_draws = [
        ("--state", arguments.state.is_some()),
        ("--bands", !arguments.bands.is_empty()),
        ("--no-indices", arguments.no_indices),
    ];
    let of_runs = only_of_runs(&arguments.common, &arguments.options);
    if let Some(name) = of_runs.filter(|_| arguments.scatter.pushes.is_none()) {
        return Err(Error::argument(format!(
            "{name} is for runs after pushes, and eigenvalues do not depend on it: leave it out, or give --pushes"
        )));
    }
    let of_draws = of_draws.into_iter().find(|(_, is_given)| *is_given).map(|(name, _)| name);
    if let Some(name) = of_draws.filter(|_| arguments.scatter.uncertain.is_empty()) {
        return Err(Error::argument(format!(
            "{name} is for eigenvalues of draws, and no parameter scatters: leave it out, or give --uncertain"
        )));
    }
    Ok(())
}

/// Rows of results.csv: probabilities and indices.
fn rows(parameters: &[Parameter], found: &Found) -> Vec<[String; 7]> {
    let mut rows = Vec::new();
    let mut row = |quantity: &str, of: String, [from, to]: [String; 2], estimate: &Estimate| {
        let Estimate { value, low, high } = estimate;
        let [value, low, high] = [value, low, high].map(|value| format!("{value:?}"));
        rows.push([quantity.to_owned(), of, from, to, value, low, high]);
    };
    let none = || [String::new(), String::new()];
    if let Some(found) = &found.eigenvalues {
        row("probability", "unstable".to_owned(), none(), &found.unstable);
        row("probability", "stable".to_owned(), none(), &found.stable);
        row("probability", "no equilibrium".to_owned(), none(), &found.no_equilibrium);
        for band in &found.bands {
            let ends = band.frequencies.map(|end| format!("{end:?}"));
            row("probability", "growth in band".to_owned(), ends, &band.unstable);
        }
        for (what, indices) in
            [("growth rate", &found.of_growth), ("instability", &found.of_instability)]
        {
            for (parameter, Index { first, total }) in
                parameters.iter().zip(indices.iter().flatten())
            {
                let of = quoted(parameter.name());
                row(&format!("first-order index of {what}"), of.clone(), none(), first);
                row(&format!("total index of {what}"), of, none(), total);
            }
        }
    }
    if let Some(runs) = &found.runs {
        row("probability", "squeals".to_owned(), none(), &runs.probability);
    }
    rows
}

fn write(
    folder: &Folder,
    parameters: &[Parameter],
    arguments: &RobustnessArguments,
    found: &Found,
) -> Result<(), Box<dyn std::error::Error>> {
    let head = ["quantity", "of", "from", "to", "value", "low", "high"];
    folder.write_csv(&head, rows(parameters, found))?;
    if let Some(found) = &found.eigenvalues {
        let class = found.histogram.iter().map(|class| {
            let [from, to] = class.ends;
            [format!("{from:?}"), format!("{to:?}"), class.count.to_string()]
        });
        folder.write_table("histogram", &["growth_from", "growth_to", "draws"], class)?;
    }
    if let Some(runs) = &found.runs {
        // Names of parameters may have commas.
        let names: Vec<String> = parameters.iter().map(|one| quoted(one.name())).collect();
        let head = ["push", "end", "kind", "frequency", "failure"];
        let head: Vec<&str> = head.into_iter().chain(names.iter().map(String::as_str)).collect();
        let row = runs.runs.iter().map(|run| {
            let kind = run.kind.map_or("", |kind| kind.name()).to_owned();
            let frequency = run.frequency.map_or_else(String::new, |value| format!("{value:?}"));
            let failure = run.failure.as_deref().map_or_else(String::new, quoted);
            let mut row = vec![
                format!("{:?}", run.push),
                run.end.name().to_owned(),
                kind,
                frequency,
                failure,
            ];
            row.extend(run.values.iter().map(|value| format!("{value:?}")));
            row
        });
        folder.write_table("runs", &head, row)?;
    }
    folder.write_json(json!({
        "scramblings": arguments.scramblings,
        "points": arguments.points,
        "eigenvalues": found.eigenvalues,
        "runs": found.runs,
    }))
}

fn print(scene: &Scene, parameters: &[Parameter], arguments: &RobustnessArguments, found: &Found) {
    let state = arguments.state.as_deref().unwrap_or("uniform sliding");
    let counted = match parameters.len() {
        0 => "no parameter scatters".to_owned(),
        1 => "1 parameter scatters".to_owned(),
        count => format!("{count} parameters scatter"),
    };
    say!("{}: {counted}; seed {}", scene.name, arguments.scatter.seed);
    let widest = parameters.iter().map(|parameter| parameter.name().len()).max().unwrap_or(0);
    for parameter in parameters {
        say!(
            "  {:<widest$}  {}, in the scene {}",
            parameter.name(),
            parameter.distribution,
            Short(parameter.nominal)
        );
    }
    if let Some(found) = &found.eigenvalues {
        say!(
            "\nstability of {state} in {} draws, {} scramblings of {} points; intervals of 95 %",
            found.draws,
            arguments.scramblings,
            arguments.points
        );
        let nominal = match found.nominal_growth {
            Some(growth) => format!("the largest growth rate is {} 1/s", Rounded(growth)),
            None => "there is no equilibrium in sliding".to_owned(),
        };
        say!("  with the scene's own values {nominal}");
        for (name, estimate) in words::probabilities(found) {
            say!("  {name:<17}  {}", words::percent(&estimate));
        }
        if !arguments.no_indices {
            let why = words::growth_without_indices(found);
            print_indices("the largest growth rate", parameters, found.of_growth.as_deref(), why);
            let why = words::INSTABILITY_WITHOUT_INDICES;
            print_indices("instability", parameters, found.of_instability.as_deref(), why);
        }
    }
    if let Some(runs) = &found.runs {
        print_runs(arguments, runs);
    }
}

/// Prints the indices of each parameter, or why there are none.
fn print_indices(of: &str, parameters: &[Parameter], indices: Option<&[Index]>, why: &str) {
    let Some(indices) = indices else {
        say!("\nno Sobol indices of {of}: {why}");
        return;
    };
    say!("\nSobol indices of {of}, parts of its variance");
    let widest = parameters.iter().map(|parameter| parameter.name().len()).max().unwrap_or(0);
    say!("  {:<widest$}  {:<27}  with all others", "", "by itself");
    for (parameter, Index { first, total }) in parameters.iter().zip(indices) {
        say!("  {:<widest$}  {:<27}  {}", parameter.name(), words::part(first), words::part(total));
    }
}

fn print_runs(arguments: &RobustnessArguments, runs: &Squeals) {
    let pushes = arguments.scatter.pushes.as_ref().map(ToString::to_string).unwrap_or_default();
    say!("\n{} runs after pushes of {pushes} m/s in random directions", runs.runs.len());
    for (count, end) in words::ends(runs) {
        say!("  {count:>6}  {end}");
    }
    say!("  P(squeals)  {}", words::squeal(runs));
    if let Some(failure) = runs.runs.iter().find_map(|run| run.failure.as_ref()) {
        eprintln!("note: the first failed run: {failure}");
    }
}
