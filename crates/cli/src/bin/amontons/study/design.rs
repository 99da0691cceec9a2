//! `amontons study design`.

use super::arguments::{ObservationOptions, StudyArguments, only_of_runs};
use super::folder::{Folder, quoted};
use super::{found, prepared_again, set_pace};
use amontons::Error;
use amontons::decimal::to_significant;
use amontons::error::Short;
use amontons::scene::Scene;
use amontons_analysis::design::{
    DesignQuestion, DesignRequest, FoundDesign, ReadyDesign, Vary, Worst, design,
};
use amontons_analysis::instant::signals_left_out;
use amontons_analysis::robustness::{Distribution, End, Estimate, Squeals};
use amontons_analysis::study::ObservationSettings;
use amontons_analysis::sweep::range::{assignment, ends, number};
use amontons_cli::charts::design::{growth, trade_off};
use amontons_cli::say;
use amontons_cli::shards::ShardArguments;
use amontons_export::documentation::counted;
use clap::Args;
use serde_json::json;

#[derive(Args)]
pub struct DesignArguments {
    #[command(flatten)]
    pub common: StudyArguments,
    #[command(flatten)]
    pub shared: ShardArguments,
    /// A value that may change, with its range: NAME=±20%, NAME=-10%:30% or NAME=A:B. `*` in NAME stands for any part, and each
    /// changes by itself; may be repeated
    #[arg(long, value_name = "NAME=RANGE", value_parser = Vary::parse)]
    pub vary: Vec<Vary>,
    /// Range of the friction coefficient in which no mode may grow, or one value
    #[arg(long, value_name = "A:B", value_parser = friction, allow_hyphen_values = true)]
    pub friction: [f64; 2],
    /// A contact state in which no mode may grow: one for all contacts (Sl), one for each (Sl-St), by names (pad=St,*=Sl), or
    /// `all`; may be repeated [default: uniform sliding]
    #[arg(long, value_name = "STATE")]
    pub state: Vec<String>,
    /// Growth rate, 1/s, by which all modes stay below zero [default: a tenth of the slowest decay without friction]
    #[arg(long, value_name = "1/S", allow_hyphen_values = true)]
    pub margin: Option<f64>,
    /// The factor by which changes of a name count in the size of a change; may be repeated [default: 1]
    #[arg(long, value_name = "NAME=FACTOR", value_parser = assignment)]
    pub cost: Vec<(String, f64)>,
    /// Change all parts that a `*` stands for by the same percentage, as those of equal modules
    #[arg(long)]
    pub together: bool,
    /// Number of starts of the search: the scene itself, all values at their lower and at their upper bounds, random changes
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub starts: usize,
    /// Seed of the starts and of the pushes
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Number of points of the trade-off between growth rate and change
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub points: usize,
    /// Largest velocity of the pushes that verify the design, m/s, as a distribution [default: uniform from 0 to the velocity
    /// of the fastest surface]
    #[arg(long, value_name = "DISTRIBUTION", value_parser = Distribution::parse)]
    pub pushes: Option<Distribution>,
    /// Number of runs after pushes at random friction coefficients of the range, and at its end, of the scene and of the
    /// design each; 0 leaves them out
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub runs: u64,
    #[command(flatten)]
    pub options: ObservationOptions,
}

/// A range of friction coefficients, or one value.
fn friction(text: &str) -> Result<[f64; 2], String> {
    if text.contains(':') { ends(text) } else { Ok([number(text)?; 2]) }
}

pub fn run(arguments: &DesignArguments) -> Result<(), Box<dyn std::error::Error>> {
    let DesignArguments { common, shared, options, .. } = arguments;
    let (scene, source) = found(common)?;
    check_options(arguments)?;
    let asked = arguments.request();
    let mut ready = asked.ready(&scene)?;
    if let Some(left_out) = signals_left_out(&scene, 0.0) {
        eprintln!("note: {left_out}");
    }
    if asked.has_runs() {
        let observation = ObservationSettings::of(&ready.scene, &options.request())?;
        set_pace(&mut ready.scene, common, &observation, amontons_analysis::study::pace)?;
    }
    let look = asked.has_runs().then(
        || json!({ "pushes": ready.pushes.to_string(), "look": options, "integrator": common.integrator }),
    );
    let settings = json!({
        "vary": ready.varied,
        "friction": asked.friction,
        "states": ready.states(),
        // An equilibrium in this state is asked for only where no state is named.
        "uniform": asked.states.is_empty(),
        "margin": ready.margin,
        "starts": asked.starts,
        "seed": asked.seed,
        "points": asked.points,
        "runs": look,
    });
    let mut folder =
        Folder::open_shared(common, *shared, "design", (&ready.scene, &source), settings)?;
    let prepare = |scene: &mut Scene| prepared_again(scene, common, options);
    let question = ready.question(&prepare);
    let Some(found) = folder.found(|journal, watch| design(&question, journal, watch))? else {
        return Ok(());
    };
    write(&folder, &ready, &found)?;
    print(&ready, &question, &found);
    if found.starts.is_empty() {
        say!("\nresults are in {}", folder.path().display());
        return Ok(());
    }
    if found.growth.len() > 1 {
        folder.draw("growth", &growth(&ready.scene, &found))?;
    }
    folder.draw("trade-off", &trade_off(&ready.scene, &found))?;
    say!("\nresults and pictures are in {}", folder.path().display());
    Ok(())
}

impl DesignArguments {
    fn request(&self) -> DesignRequest {
        DesignRequest {
            vary: self.vary.clone(),
            together: self.together,
            costs: self.cost.clone(),
            friction: self.friction,
            states: self.state.clone(),
            margin: self.margin,
            starts: self.starts,
            points: self.points,
            seed: self.seed,
            pushes: self.pushes.clone(),
            runs: self.runs,
        }
    }
}

/// Refuses options that would change nothing: those of runs, where there are none.
fn check_options(arguments: &DesignArguments) -> Result<(), Error> {
    let idle = only_of_runs(&arguments.common, &arguments.options);
    match idle.filter(|_| arguments.runs == 0) {
        Some(name) => Err(Error::argument(format!(
            "{name} is for runs that verify the design, and there are none: leave it out, or give --runs 1 or more"
        ))),
        None => Ok(()),
    }
}

fn write(
    folder: &Folder,
    ready: &ReadyDesign<'_>,
    found: &FoundDesign,
) -> Result<(), Box<dyn std::error::Error>> {
    let varied = &ready.varied;
    let head = ["name", "unit", "before", "after", "change", "from", "to", "cost"];
    let rows = varied.iter().zip(&found.design.changes).flat_map(|(one, change)| {
        one.parts.iter().map(move |part| {
            let [from, to] = part.values;
            [
                quoted(&part.name),
                part.unit.to_owned(),
                format!("{:?}", part.nominal),
                format!("{:?}", part.at(*change)),
                format!("{change:?}"),
                format!("{from:?}"),
                format!("{to:?}"),
                format!("{:?}", one.cost),
            ]
        })
    });
    folder.write_csv(&head, rows)?;
    let mut head = vec!["size", "growth_rate", "frequency", "friction", "states"];
    head.extend(varied.iter().map(|one| &*one.name));
    let head: Vec<String> = head
        .iter()
        .map(|name| if name.contains(['[', '*']) { quoted(name) } else { (*name).to_owned() })
        .collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let rows = found.trade_off.iter().map(|it| {
        let Worst { growth, frequency, friction, states } = &it.worst;
        let mut row = vec![
            format!("{:?}", it.size),
            format!("{growth:?}"),
            format!("{frequency:?}"),
            format!("{friction:?}"),
            states.clone(),
        ];
        row.extend(it.changes.iter().map(|change| format!("{change:?}")));
        row
    });
    folder.write_table("trade-off", &head, rows)?;
    let rows = found
        .growth
        .iter()
        .map(|at| [at.friction, at.before, at.after].map(|value| format!("{value:?}")));
    folder.write_table("growth", &["friction", "before", "after"], rows)?;
    folder.write_json(json!({ "margin": ready.margin, "found": found }))
}

fn print(ready: &ReadyDesign<'_>, question: &DesignQuestion<'_>, found: &FoundDesign) {
    let ReadyDesign { scene, pushes, .. } = ready;
    let [from, to] = question.range;
    let range = if from == to {
        format!("µ = {}", Short(from))
    } else {
        format!("µ from {} to {}", Short(from), Short(to))
    };
    let states = ready.states();
    let more = match states.len().saturating_sub(4) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let first = &states[..states.len().min(4)];
    say!("{}: {range}, states {}{more}", scene.name, first.join(", "));
    say!("no mode may have a growth rate above {} 1/s", five(0.0 - question.margin));
    say!("\nthe scene       {}", told(&found.before));
    if found.starts.is_empty() {
        say!("the scene itself keeps the limit: nothing has to change");
        print_checked(pushes, found);
        return;
    }
    say!("the design      {}", told(&found.design.worst));
    if found.is_kept {
        let [kept, same] = found.agreeing;
        let all = found.starts.len();
        say!(
            "starts that keep the limit: {kept} of {all}; with a change of this size, to 1 %: {same}"
        );
    } else {
        say!(
            "NOT REACHED: of {} none keeps the limit within these ranges; the design is the change with the least growth rate. \
             This is no proof that there is none: give wider ranges, more --vary, a smaller --margin or more --starts",
            counted(found.starts.len(), "start", "starts")
        );
    }
    let costs =
        if question.varied.iter().any(|one| one.cost != 1.0) { ", with its costs" } else { "" };
    say!("\nsize of the change{costs} {} %", five(100.0 * found.design.size));
    let widest = question.varied.iter().map(|one| one.name.len()).max().unwrap_or(0);
    for (one, change) in question.varied.iter().zip(&found.design.changes) {
        let [low, high] = one.bounds;
        let bound = match *change {
            change if change <= low => ", its lower bound",
            change if change >= high => ", its upper bound",
            _ => "",
        };
        let values = match &one.parts[..] {
            [part] => {
                format!("{} to {} {}", Short(part.nominal), five(part.at(*change)), part.unit)
            }
            parts => counted(parts.len(), "value", "values"),
        };
        say!("  {:<widest$}  {:>+8.3} %{bound}  ({values})", one.name, 100.0 * change);
    }
    if found.trade_off.len() > 1 {
        say!("\ngrowth rate against change");
        say!("  {:>12}  {:>12}", "change [%]", "rate [1/s]");
        for it in &found.trade_off {
            say!("  {:>12.4}  {:>12.4}", 100.0 * it.size, it.worst.growth);
        }
    }
    print_checked(pushes, found);
    if found.design.size == 0.0 {
        say!("\nno change of these values was found to make a growth rate less");
    }
    let values = ready.values(&found.design.changes);
    let set: Vec<String> =
        values.iter().map(|(name, value)| format!("--set '{name}={value:?}'")).collect();
    if !set.is_empty() {
        say!("\nthe design, for any command: {}", set.join(" "));
    }
}

/// A number to five digits.
fn five(value: f64) -> Short {
    Short(to_significant(value, 5))
}

/// A mode with its growth rate and place.
fn told(worst: &Worst) -> String {
    format!(
        "largest growth rate {} 1/s, at {:.2} Hz, µ = {}, {}",
        five(worst.growth),
        worst.frequency,
        five(worst.friction),
        worst.states
    )
}

fn print_checked(pushes: &Distribution, found: &FoundDesign) {
    let checked = &found.checked;
    say!("\nverified");
    match checked.frictions {
        1 => say!("  eigenvalues at this friction coefficient"),
        count => say!("  eigenvalues at {count} friction coefficients, and at peaks between them"),
    }
    match &checked.no_equilibrium {
        Some((friction, why)) => {
            say!("  NO EQUILIBRIUM from µ = {} on: {why}", five(*friction));
        }
        None if checked.frictions == 1 => say!("  there is an equilibrium in sliding"),
        None => say!("  there is an equilibrium in sliding at all of them"),
    }
    match &checked.remaining {
        None if found.design.worst.growth > 0.0 => {
            say!("  candidates for a second motion were not looked for, since a mode grows");
        }
        None => say!("  candidates for a second motion were not looked for"),
        Some(remaining) if remaining.is_empty() => {
            say!("  no contact state has a growing mode while uniform sliding is stable");
        }
        Some(remaining) => {
            say!(
                "  {} for a second motion left:",
                counted(remaining.len(), "candidate", "candidates")
            );
            for one in remaining {
                let [from, to] = one.range;
                say!(
                    "    {} from µ = {} to {}, {:.2} Hz, {} 1/s",
                    one.states,
                    five(from),
                    five(to),
                    one.frequency,
                    five(one.growth)
                );
            }
        }
    }
    for runs in &checked.runs {
        let at = runs
            .friction
            .map_or_else(|| "random µ of the range".to_owned(), |mu| format!("µ = {}", five(mu)));
        say!("  {} runs after pushes of {pushes} m/s, at {at}", runs.scene.runs.len());
        say!("    scene   {}", ends_of(&runs.scene));
        if runs.design != runs.scene {
            say!("    design  {}", ends_of(&runs.design));
        }
    }
    if checked.runs.is_empty() {
        say!("not verified: no runs after pushes");
        return;
    }
    say!("not verified: larger pushes, and other friction coefficients");
}

/// The ends of runs in one line.
fn ends_of(runs: &Squeals) -> String {
    let all = [End::Rests, End::Squeals, End::NotSettled, End::NoEquilibrium, End::Failed];
    let counts = all.iter().filter(|end| runs.count(**end) > 0);
    let counts: Vec<String> =
        counts.map(|end| format!("{} {}", runs.count(*end), end.name())).collect();
    let Estimate { low, high, .. } = runs.probability;
    format!("{}; P(squeals) {:.1} to {:.1} %", counts.join(", "), 100.0 * low, 100.0 * high)
}
