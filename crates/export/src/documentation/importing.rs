//! Instructions for importers of the FMU.

use super::coupling::{coupling, moved_with_first};
use super::{Subject, can_squeal, markup};
use amontons::scene::{Scene, Selection};
use amontons::simulation::Parameters;
use amontons::simulation::catalogue::{Causality, Quantity, Variable, fmu_variables};

/// The most variables of each kind that are named.
const NAMED: usize = 4;

pub(super) fn section(subject: Subject<'_>) -> String {
    let scene = subject.scene;
    let mut html = String::from(
        "<p>This is an FMI 2.0 co-simulation FMU with an integrator of its own: an importer gives communication steps \
         of any length and needs no solver.</p>\n<h3>FMPy</h3>\n",
    );
    let experiment = scene.experiment;
    let (stop, interval) = (experiment.stop_time, experiment.output_interval);
    let file = file(scene);
    let variables = fmu_variables(scene);
    let outputs = outputs(scene, &variables);
    let plot = outputs.first().map_or("time", |variable| &*variable.name);
    let python = format!(
        "from fmpy import simulate_fmu\n\
         result = simulate_fmu(\"{file}\", stop_time={stop:?}, output_interval={interval:?})\n\
         print(result[\"time\"][-1], result[\"{plot}\"][-1])"
    );
    markup::listing(&mut html, "Python", &python);
    html.push_str("<p>Install FMPy with <code>pip install fmpy</code>. On the command line:</p>\n");
    let shell = format!(
        "fmpy validate {file}\n\
         fmpy simulate {file} --interface-type CoSimulation --stop-time {stop:?} \\\n    \
         --output-interval {interval:?} --output-file result.csv"
    );
    markup::listing(&mut html, "Command line", &shell);
    let mut words = vec![
        "In other tools, add it as an FMU for co-simulation and use the output interval as the communication step \
         (tested with FMPy, libcosim, ecos and fmi-rs). The FMU can save and restore its state, interpolates inputs \
         by their derivatives, and provides derivatives of outputs and directional derivatives."
            .to_owned(),
    ];
    if let Selection::Auto { tolerance } = scene.selection {
        words.push(format!(
            "The importer's tolerance determines method and step; the default tolerance is {tolerance:e}."
        ));
    }
    markup::paragraphs(&mut html, &words);
    html.push_str("<h3>Variables to try</h3>\n");
    let mut pairs = Vec::new();
    for (what, list) in [
        (
            "During a run",
            tried(
                scene,
                &variables,
                &[
                    Quantity::SliderVelocity,
                    Quantity::OwnVelocity,
                    Quantity::FrictionCoefficient,
                    Quantity::OwnFriction,
                    Quantity::ExternalForce,
                ],
            ),
        ),
        (
            "Before a run",
            tried(
                scene,
                &variables,
                &[
                    Quantity::InitialVelocity,
                    Quantity::Stiffness,
                    Quantity::DampingBeta,
                    Quantity::DamperDamping,
                    Quantity::IntegratorStep,
                ],
            ),
        ),
    ] {
        if !list.is_empty() {
            pairs.push((what, list.join(", ")));
        }
    }
    pairs.push((
        "Outputs to watch",
        outputs.iter().map(|v| v.name.clone()).collect::<Vec<_>>().join(", "),
    ));
    if let Some(text) = coupling(scene, subject.start.reference(), &variables) {
        pairs.push(("Coupling", text));
    }
    markup::facts(&mut html, &pairs);
    html
}

/// The FMU's name, unless that of the scene is none for Python and a shell.
fn file(scene: &Scene) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_.-".contains(c);
    let name = if scene.name.chars().all(plain) { &*scene.name } else { "FILE" };
    format!("{name}.fmu")
}

/// The first settable variable of each of these kinds that the scene has, with its value; of contacts whose surfaces one
/// body moves, all velocities.
fn tried(scene: &Scene, variables: &[Variable], kinds: &[Quantity]) -> Vec<String> {
    let parameters = Parameters::of(scene.clone());
    let now = |variable: &Variable| {
        let value = parameters.get(variable)?;
        Some(format!("{} (now {value:?})", variable.name))
    };
    let first = |quantity: &Quantity| {
        let of_it =
            || variables.iter().filter(|v| v.template.quantity == *quantity && v.is_settable());
        if *quantity != Quantity::OwnVelocity {
            return now(of_it().next()?);
        }
        // A body moves all of its surfaces.
        let together = moved_with_first(scene);
        let all = of_it().filter(|v| together.contains(&v.index)).filter_map(now);
        Some(all.collect::<Vec<_>>().join(" with ")).filter(|text| !text.is_empty())
    };
    kinds.iter().filter_map(first).take(NAMED).collect()
}

/// Outputs that tell most: a displacement, forces and the state of the first contact.
fn outputs<'a>(scene: &Scene, variables: &'a [Variable]) -> Vec<&'a Variable> {
    let kinds = [
        Quantity::Displacement,
        Quantity::Velocity,
        Quantity::NormalForce,
        Quantity::FrictionForce,
        Quantity::ContactState,
    ];
    let acts = |kind: &&Quantity| **kind != Quantity::FrictionForce || can_squeal(scene);
    let kinds = kinds.iter().filter(acts);
    kinds.filter_map(|&kind| first(variables, kind, Causality::Output)).collect()
}

/// The first variable of a kind and role.
pub(super) fn first(
    variables: &[Variable],
    quantity: Quantity,
    causality: Causality,
) -> Option<&Variable> {
    variables.iter().find(|v| v.template.quantity == quantity && v.causality == causality)
}
