//! `amontons-stability locus`.

use crate::arguments::{Locus as Arguments, Values};
use crate::configured;
use amontons::Error;
use amontons::contact::{ContactState, Joined};
use amontons::model::LumpedModel;
use amontons::picture::{Chart, Mark, Panel, Series, Style};
use amontons::scene::Scene;
use amontons::simulation::assign;
use amontons::stability::locus::{Locus, Root, locus, roots};
use std::f64::consts::TAU;
use std::path::Path;

/// The name of µ among the parameters.
const FRICTION: &str = "friction.coefficient";

/// A locus, and the value of the other parameter that it was made with.
struct Member {
    at: Option<f64>,
    locus: Locus,
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    let scene = configured(&arguments.common, None)?;
    let state = arguments.state.as_deref();
    let states = arguments.common.state(state, &scene, &LumpedModel::from(&scene))?;
    // One locus, or one over µ for each value of another parameter.
    let (name, Values(values), family) = match (&arguments.friction, &arguments.parameter) {
        (Some(friction), parameter) => (FRICTION, friction, parameter.as_ref()),
        (None, Some((name, values))) => (name.as_str(), values, None),
        (None, None) => unreachable!("the command line asks for one of them"),
    };
    let mut members = Vec::new();
    match family {
        None => members.push(Member { at: None, locus: over(&scene, &states, name, values)? }),
        Some((other, Values(others))) => {
            for &at in others {
                let mut scene = scene.clone();
                assign(&mut scene, other, at)?;
                scene.check()?;
                let locus = over(&scene, &states, name, values)?;
                members.push(Member { at: Some(at), locus });
            }
        }
    }
    let other = family.map(|(other, _)| other.as_str());
    if arguments.csv {
        print_csv(&members, name, other);
    } else {
        println!("{}: state {}, {name}", scene.name, Joined(&states));
        members.iter().for_each(|member| print_events(member, other));
    }
    match &arguments.plot {
        Some(path) => draw(&scene, &states, &members, name, path),
        None => Ok(()),
    }
}

/// The locus of a state over one parameter.
fn over(
    scene: &Scene,
    states: &[ContactState],
    name: &str,
    values: &[f64],
) -> Result<Locus, Error> {
    let evaluate = |value: f64| {
        let mut scene = scene.clone();
        assign(&mut scene, name, value)?;
        scene.check()?;
        roots(&LumpedModel::from(&scene), states, scene.friction_coefficient)
    };
    locus(&evaluate, values)
}

fn print_events(member: &Member, other: Option<&str>) {
    if let (Some(other), Some(at)) = (other, member.at) {
        println!("\n{other} = {at}");
    }
    let locus = &member.locus;
    println!("  modes merge or part, exactly, damped or not (C = α M + β K):");
    for event in &locus.coalescences {
        let [a, b] = event.modes.map(|mode| mode + 1);
        println!(
            "    {:.9}  modes {a} and {b} {} at {:.3} Hz",
            event.value,
            if event.merge { "merge" } else { "part" },
            event.frequency_hz,
        );
    }
    if locus.coalescences.is_empty() {
        println!("    none");
    }
    println!("  critical values:");
    for event in &locus.crossings {
        println!(
            "    {:.9}  mode {} {} at {:.3} Hz",
            event.value,
            event.mode + 1,
            if event.becomes_unstable { "begins to grow" } else { "ceases to grow" },
            event.frequency_hz,
        );
    }
    if locus.crossings.is_empty() {
        let grows = locus.branches.iter().any(|branch| branch[0].lambda.re > 0.0);
        println!("    none: {} throughout", if grows { "unstable" } else { "stable" });
    }
}

fn print_csv(members: &[Member], name: &str, other: Option<&str>) {
    let first = other.map_or_else(String::new, |other| format!("{other},"));
    println!("{first}{name},mode,growth_rate,real_hz,imaginary_hz");
    for Member { at, locus } in members {
        let first = at.map_or_else(String::new, |at| format!("{at:?},"));
        for (i, value) in locus.values.iter().enumerate() {
            for (mode, branch) in locus.branches.iter().enumerate() {
                let lambda = branch[i].lambda;
                println!(
                    "{first}{value:?},{},{:?},{:?},{:?}",
                    mode + 1,
                    lambda.re,
                    lambda.re / TAU,
                    lambda.im / TAU
                );
            }
        }
    }
}

/// Fig. 2(a) and (b): real and imaginary parts of λ/2π.
fn draw(
    scene: &Scene,
    states: &[ContactState],
    members: &[Member],
    name: &str,
    path: &Path,
) -> Result<(), Error> {
    let alone = members.len() == 1;
    let curves = |part: fn(&Root) -> f64| -> Vec<Series> {
        let branches = members.iter().flat_map(|member| {
            member.locus.branches.iter().enumerate().map(move |branch| (&member.locus, branch))
        });
        branches
            .map(|(locus, (mode, branch))| Series {
                label: Some(format!("mode {}", mode + 1)),
                points: locus.values.iter().zip(branch).map(|(&x, root)| [x, part(root)]).collect(),
                colour: mode,
                style: if alone { Style::Line } else { Style::Faint },
            })
            .collect()
    };
    let marks = |values: Vec<(f64, String)>| -> Vec<Mark> {
        let marks = values.into_iter().filter(|_| alone);
        marks.map(|(x, label)| Mark { x, label: Some(label) }).collect()
    };
    let first = &members[0].locus;
    let critical = first.crossings.iter().map(|c| (c.value, format!("{:.4}", c.value))).collect();
    let merging = first
        .coalescences
        .iter()
        .map(|c| (c.value, format!("{}–{}: {:.4}", c.modes[0] + 1, c.modes[1] + 1, c.value)))
        .collect();
    let panel = |y_label: &str, part, marks, zero_line| Panel {
        y_label: y_label.to_owned(),
        series: curves(part),
        marks,
        zero_line,
    };
    Chart {
        title: format!("{}: eigenvalues in state {}", scene.name, Joined(states)),
        x_label: if name == FRICTION { "friction coefficient µ".into() } else { name.to_owned() },
        panels: vec![
            panel("Re λ / 2π [Hz]", |root| root.lambda.re / TAU, marks(critical), true),
            panel("Im λ / 2π [Hz]", |root| root.lambda.im / TAU, marks(merging), false),
        ],
    }
    .write(path)
}
