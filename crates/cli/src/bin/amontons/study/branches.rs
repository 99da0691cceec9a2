//! `amontons study branches`.

use super::arguments::{ObservationOptions, StudyArguments};
use super::folder::{Folder, STUDY, quoted};
use super::orbit::{named_ends, read, words};
use super::{heading, prepared, watched_unevenly};
use amontons::scene::{Scene, Source};
use amontons::simulation::dof_of;
use amontons_analysis::orbit::{Branch, BranchEnd, BranchPoint, SpecialKind, SpecialPoint};
use amontons_analysis::study::{
    BranchQuestion, Branches, Continuation, From, RestBranch, branches, initial_value,
};
use amontons_analysis::sweep::observed::{displacements, first_displacement};
use amontons_analysis::sweep::{FRICTION, range};
use amontons_cli::charts::branches::{chart, kind};
use amontons_cli::say;
use amontons_cli::shards::matrices;
use amontons_export::documentation::counted;
use clap::Args;
use serde_json::{Map, Value, json};
use std::error::Error;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct BranchesArguments {
    #[command(flatten)]
    common: StudyArguments,
    #[command(flatten)]
    options: ObservationOptions,
    /// Parameter or input with its range, or a value of a signal, such as signal[1].frequency
    #[arg(long, value_name = "NAME=A:B", value_parser = parameter, allow_hyphen_values = true)]
    parameter: (String, [f64; 2]),
    /// Begin a branch with an orbit that `amontons study orbit` has found; may be repeated. Without any start a branch
    /// begins with what the scene settles into
    #[arg(long, value_name = "ORBIT.JSON")]
    from: Vec<PathBuf>,
    /// Begin a branch at the boundary between the motions that two values of an initial value end in; may be repeated
    #[arg(long, value_name = "NAME=A:B", value_parser = named_ends)]
    between: Vec<(String, [f64; 2])>,
    /// Begin a branch in this oscillating mode of uniform sliding, counted by frequency from 1; may be repeated
    #[arg(long, value_name = "N")]
    mode: Vec<usize>,
    /// Begin a branch with what the scene settles into, beside other starts
    #[arg(long)]
    run: bool,
    /// Lay the ways upwards and downwards of a `study continuation` of the same scene behind the branches in the picture:
    /// the folder of that study
    #[arg(long, value_name = "DIR")]
    over: Option<PathBuf>,
    /// Most points of a branch to either side of its start
    #[arg(long, value_name = "N", default_value_t = 500)]
    points: usize,
}

/// Parses a name with a range.
fn parameter(text: &str) -> Result<(String, [f64; 2]), String> {
    range::named(text, range::ends)
}

pub fn run(arguments: &BranchesArguments) -> Result<(), Box<dyn Error>> {
    let BranchesArguments { common, options, parameter: (name, range), .. } = arguments;
    let (scene, source, observation) = prepared(common, options)?;
    let shown = displacements(&scene)?;
    let of = shown.iter().find(|shown| shown.name == observation.of);
    let Some(dof) = of.and_then(|shown| dof_of(&scene, shown)) else {
        return Err(amontons::Error::argument(format!(
            "{} is no displacement; the amplitude of a branch is that of a displacement, such as {}",
            observation.of,
            first_displacement(&scene)?
        ))
        .into());
    };
    if name.starts_with("initial.") {
        let message = format!(
            "periodic motions do not depend on initial values such as {name}; choose a parameter, such as \
             friction.coefficient or slider.velocity"
        );
        return Err(amontons::Error::argument(message).into());
    }
    let over = arguments.over.as_deref();
    let over = over.map(|over| quasi_static(over, common, &source, &observation.of, name));
    let over = over.transpose()?;
    let mut starts = Vec::new();
    for path in &arguments.from {
        starts.push((path.display().to_string(), From::Orbit(Box::new(read(path, &scene)?))));
    }
    for (name, [a, b]) in &arguments.between {
        let start = From::boundary(&scene, name, [*a, *b])?;
        let name = initial_value(&scene, name)?;
        starts.push((format!("the boundary of {name} from {a:?} to {b:?}"), start));
    }
    for number in &arguments.mode {
        starts.push((format!("mode {number}"), From::Mode(*number)));
    }
    if starts.is_empty() || arguments.run {
        starts.insert(0, ("a run".to_owned(), From::Run));
    }
    let labels: Vec<String> = starts.iter().map(|(label, _)| label.clone()).collect();
    let orbits: Vec<_> = starts
        .iter()
        .filter_map(|(_, start)| match start {
            From::Orbit(orbit) => Some(orbit),
            From::Run | From::Boundary(_) | From::Mode(_) => None,
        })
        .collect();
    let settings = json!({
        "from": orbits, "look": observation, "parameter": name, "range": range, "points": arguments.points,
    });
    let folder = Folder::open(common, "branches", (&scene, &source), settings)?;
    let question =
        BranchQuestion { name: name.clone(), range: *range, starts, most_points: arguments.points };
    let found = watched_unevenly(|watch| {
        branches(&scene, &observation, &question, folder.journal(), watch)
    })?;
    let Some(found) = found else { return Err(folder.interrupted()) };
    if let (Some(Err(why)), true) =
        (found.branches.first(), found.branches.iter().all(Result::is_err))
    {
        return Err(amontons::Error::analysis(why.clone()).into());
    }
    write(&folder, name, dof, &found)?;
    folder.write_json(json!({ "starts": labels, "found": found }))?;
    folder.draw("branches", &chart(&scene, (name, *range), dof, &found, over.as_ref()))?;
    say!("{}", heading(&[(&scene, &observation)]));
    print(&scene, (name, dof), &labels, &found);
    say!("\n{} has results.csv, specials.csv, study.json and a picture", folder.path().display());
    Ok(())
}

/// The continuation in a folder, if it is one of this scene over this parameter and shows this output.
fn quasi_static(
    folder: &Path,
    common: &StudyArguments,
    source: &Source,
    of: &str,
    name: &str,
) -> Result<Continuation, amontons::Error> {
    let path = folder.join(STUDY);
    let text =
        std::fs::read_to_string(&path).map_err(|error| amontons::Error::file(&path, &error))?;
    let wrong = |why: String| amontons::Error::file(&path, &std::io::Error::other(why));
    let mut study: Value = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if study["study"] != "continuation" {
        return Err(wrong(
            "--over names the folder of an `amontons study continuation`".to_owned(),
        ));
    }
    if name != FRICTION {
        return Err(wrong(format!(
            "a continuation is over {FRICTION}, but these branches over {name}"
        )));
    }
    let shown = study["settings"]["look"]["of"].as_str().unwrap_or_default();
    if shown != of {
        return Err(wrong(format!(
            "this continuation shows {shown}, but these branches {of}: choose with --of"
        )));
    }
    // The parameter has its range, and branches do not depend on initial values.
    let is_kept = |name: &str| name != FRICTION && !name.starts_with("initial.");
    let here: Map<String, Value> =
        common.set.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
    let kept = |set: &Map<String, Value>| -> Map<String, Value> {
        let all = set.iter().filter(|(name, _)| is_kept(name));
        all.map(|(name, value)| (name.clone(), value.clone())).collect()
    };
    let there = study["set"].as_object().cloned().unwrap_or_default();
    let has_matrices = study.get("matrices").is_some() || !source.binaries.is_empty();
    let is_same = study["file"] == source.text
        && study["tables"] == json!(source.tables)
        && (!has_matrices || study["matrices"] == matrices(source));
    if !is_same || kept(&there) != kept(&here) {
        return Err(wrong(
            "this continuation is of another scene, or of one with other values: make it again with the same scene file \
             and --set"
                .to_owned(),
        ));
    }
    serde_json::from_value(study["results"]["branches"].take())
        .map_err(|error| wrong(format!("these are no results of a continuation: {error}")))
}

fn write(folder: &Folder, name: &str, dof: usize, found: &Branches) -> Result<(), Box<dyn Error>> {
    let known = || {
        let branches = found.branches.iter().enumerate();
        branches.filter_map(|(place, branch)| Some((place + 1, branch.as_ref().ok()?)))
    };
    let points = known().flat_map(|(number, branch)| {
        branch.points.iter().map(move |BranchPoint { parameter, orbit }| {
            [
                number.to_string(),
                format!("{parameter:?}"),
                format!("{:?}", orbit.period),
                format!("{:?}", orbit.extents[dof]),
                stability(orbit.is_stable()).to_owned(),
                format!("{:?}", orbit.largest_multiplier()),
                orbit.events.len().to_string(),
                format!("{:?}", orbit.defect),
            ]
        })
    });
    let head = ["branch", name, "period", "amplitude", "stable", "multiplier", "events", "defect"];
    folder.write_csv(&head, points)?;
    let specials = known().flat_map(|(number, branch)| {
        branch.specials.iter().map(move |special| {
            [
                number.to_string(),
                format!("{:?}", special.parameter),
                quoted(kind(&special.kind)),
                format!("{:?}", special.orbit.period),
                format!("{:?}", special.orbit.extents[dof]),
            ]
        })
    });
    folder.write_table("specials", &["branch", name, "kind", "period", "amplitude"], specials)
}

fn stability(is_stable: Option<bool>) -> &'static str {
    match is_stable {
        Some(true) => "yes",
        Some(false) => "no",
        None => "unknown",
    }
}

fn print(scene: &Scene, (name, dof): (&str, usize), labels: &[String], found: &Branches) {
    say!("{}: periodic motions over {name}", scene.name);
    for (place, (label, branch)) in labels.iter().zip(&found.branches).enumerate() {
        match branch {
            Ok(branch) => print_branch(scene, (place + 1, label), dof, branch),
            Err(why) => say!("\nbranch {}, from {label}: none: {why}", place + 1),
        }
    }
    match &found.rest {
        Ok(rest) => print_rest(scene, name, dof, rest),
        Err(why) => say!("\nuniform sliding: unknown: {why}"),
    }
}

fn print_branch(scene: &Scene, (number, label): (usize, &str), dof: usize, branch: &Branch) {
    let points = counted(branch.points.len(), "point", "points");
    say!("\nbranch {number}, from {label}: {points}");
    let place = |point: &BranchPoint| {
        format!("{:.12}, amplitude {:.6e} m", point.parameter, point.orbit.extents[dof])
    };
    let [first, last] = [0, branch.points.len() - 1].map(|i| &branch.points[i]);
    say!("  begins at {}: {}", place(first), end(scene, &branch.ends[0]));
    for special in &branch.specials {
        let SpecialPoint { parameter, kind: of, orbit, .. } = special;
        let by = match of {
            SpecialKind::Sequence(Some((contact, event)))
            | SpecialKind::SequenceFold(Some((contact, event))) => {
                format!(": {} {}", scene.contact_name(*contact), words(*event))
            }
            _ => String::new(),
        };
        say!("  {parameter:.12}  {}{by}, amplitude {:.6e} m", kind(of), orbit.extents[dof]);
    }
    say!("  ends at {}: {}", place(last), end(scene, &branch.ends[1]));
    let mut from = branch.points[0].parameter;
    for (place, two) in branch.points.windows(2).enumerate() {
        let [before, after] = [&two[0], &two[1]].map(|point| point.orbit.is_stable());
        if before == after {
            continue;
        }
        // The change is at the special point between them, where there is one.
        let special = branch.specials.iter().find(|special| special.place == place);
        let to = special.map_or(two[1].parameter, |special| special.parameter);
        say!("  {} from {from:.9} to {to:.9}", stable_words(before));
        from = to;
    }
    let is_stable = branch.points[branch.points.len() - 1].orbit.is_stable();
    say!("  {} from {from:.9} to {:.9}", stable_words(is_stable), last.parameter);
}

fn stable_words(is_stable: Option<bool>) -> &'static str {
    match is_stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "stability unknown",
    }
}

fn end(scene: &Scene, end: &BranchEnd) -> String {
    match end {
        BranchEnd::Range => "the end of the range".to_owned(),
        BranchEnd::Closed => "the branch is closed".to_owned(),
        BranchEnd::Grazing(contact, event) => format!(
            "there {} {} tangentially, and no motion is near beyond",
            scene.contact_name(*contact),
            words(*event)
        ),
        BranchEnd::Linear => {
            "there all contacts begin to slide all the time: the largest of the neutral cycles"
                .to_owned()
        }
        BranchEnd::Points => "as many points as --points allows".to_owned(),
        BranchEnd::NotConverged => "no next point was found".to_owned(),
    }
}

fn print_rest(scene: &Scene, name: &str, dof: usize, rest: &RestBranch) {
    say!("\nuniform sliding:");
    if rest.stable.is_empty() {
        say!("  unstable in the whole range");
    }
    for [from, to] in &rest.stable {
        say!("  no mode grows from {name} = {from:.9} to {to:.9}");
    }
    for crossing in &rest.crossings {
        let begins = if crossing.becomes_unstable { "begins" } else { "ceases" };
        let neutral = match crossing.neutral_up_to.as_ref().map(|all| all[dof]) {
            Some(top) => format!(
                "; neutral cycles of every size up to {top:.6e} m of {}",
                scene.dof_names()[dof]
            ),
            None => String::new(),
        };
        let how = if crossing.frequency_hz.abs() < 1e-6 {
            "without oscillation".to_owned()
        } else {
            format!("at {:.3} Hz", crossing.frequency_hz)
        };
        say!("  {:.12}  a mode {begins} to grow {how}{neutral}", crossing.parameter);
    }
}
