//! Facts of a scene, in words.

use super::Subject;
use amontons::decimal::to_significant;
use amontons::error::Short;
use amontons::model::{Equilibrium, LumpedModel};
use amontons::scene::{Method, Scene, Structure};
use amontons::simulation::catalogue::{Causality, fmu_variables};
use amontons::stability::{CriticalStep, critical_step};

/// The most contacts of which the normal force is given.
const MOST_FORCES: usize = 12;

/// A size in bytes as text, rounded up to kB.
#[must_use]
pub fn size(bytes: usize) -> String {
    format!("{} kB", bytes.div_ceil(1000))
}

/// Pairs of a word and a text.
pub(super) fn facts(subject: Subject<'_>) -> Vec<(&'static str, String)> {
    let (scene, start) = (subject.scene, subject.start);
    let effective = start.scene();
    let model = LumpedModel::from(effective);
    let mut facts = vec![("Structure", structure(scene, &model))];
    if scene.contact_count() > 0 {
        facts.push(("Contact", contact(scene)));
        // Friction of uniform sliding is in them.
        let forces = normal_forces(scene, start.reference(), MOST_FORCES);
        facts.push(("Normal forces in the equilibrium", forces));
    }
    facts.push(("Method", method(subject)));
    if effective.method == Method::ForwardIncrement {
        let critical = critical_step(&model);
        let told = |critical: CriticalStep| match scene.contact_count() {
            0 => format!("{:.4e} s", critical.step),
            _ => critical.to_string(),
        };
        let critical = critical.map_or_else(|error| error.to_string(), told);
        facts.push(("Critical step", critical));
    }
    if !scene.signals.is_empty() {
        let mut inputs: Vec<&str> = scene.signals.iter().map(|signal| &*signal.input).collect();
        inputs.dedup();
        let text = format!(
            "the scene itself drives {}; values that an importer sets are added",
            inputs.join(", ")
        );
        facts.push(("Signals", text));
    }
    let experiment = scene.experiment;
    let default = format!(
        "from 0 to {} s, outputs every {} s",
        experiment.stop_time, experiment.output_interval
    );
    facts.push(("Default experiment", default));
    let variables = fmu_variables(scene);
    let of = |causality| variables.iter().filter(|v| v.causality == causality).count();
    let counts = format!(
        "{}, {}, {}; SI units throughout",
        counted(of(Causality::Input), "input", "inputs"),
        counted(of(Causality::Output), "output", "outputs"),
        counted(of(Causality::Parameter), "parameter", "parameters")
    );
    facts.push(("Variables", counts));
    facts
}

/// Sentences on the parts of a scene, and on its contacts.
#[must_use]
pub fn contents(scene: &Scene) -> Vec<String> {
    let mut told = vec![format!("The scene is {}.", structure(scene, &LumpedModel::from(scene)))];
    if scene.contact_count() > 0 {
        told.push(format!("Contacts have {}.", contact(scene)));
    }
    told
}

/// A number of things: "1 spring", "2 springs".
#[must_use]
pub fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

fn structure(scene: &Scene, model: &LumpedModel) -> String {
    let parts = match &scene.structure {
        Structure::Ring(modules) => {
            format!("a ring of {}", counted(modules.len(), "module", "modules"))
        }
        Structure::Network(network) => {
            let mut parts = Vec::new();
            if !network.masses.is_empty() || network.superelements.is_empty() {
                parts.push(counted(network.masses.len(), "mass", "masses"));
            }
            if !network.superelements.is_empty() {
                let count = network.superelements.len();
                parts.push(counted(count, "superelement", "superelements"));
            }
            if !network.springs.is_empty() {
                parts.push(counted(network.springs.len(), "spring", "springs"));
            }
            if !network.dampers.is_empty() {
                parts.push(counted(network.dampers.len(), "damper", "dampers"));
            }
            format!("a network of {}", parts.join(", "))
        }
    };
    format!(
        "{parts}: {}, {}",
        counted(model.dofs(), "degree of freedom", "degrees of freedom"),
        counted(model.contacts.len(), "contact", "contacts")
    )
}

fn contact(scene: &Scene) -> String {
    let law = scene.contact_law();
    let about = law.friction.info();
    let mut text = format!("friction \"{}\": {}", about.name, about.equation);
    if about.sticks && !law.sticking {
        text += "; contacts never stick";
    }
    text += if law.detachment { "; contacts detach" } else { "; contacts never detach" };
    text
}

/// Normal forces, N, of the first `most` closed contacts, with the contacts' names, and the number of open ones.
#[must_use]
pub fn normal_forces(scene: &Scene, equilibrium: &Equilibrium, most: usize) -> String {
    let all = equilibrium.normal_force.len();
    let closed: Vec<usize> = (0..all).filter(|i| equilibrium.is_closed(*i)).collect();
    let force = |i: &usize| {
        let newtons = Short(to_significant(equilibrium.normal_force[*i], 6));
        format!("{newtons} N at {}", scene.contact_name(*i))
    };
    let mut told: Vec<String> = closed.iter().take(most).map(force).collect();
    if closed.len() > most {
        told.push(format!("and {} more", closed.len() - most));
    }
    let open = match (all, all - closed.len()) {
        (_, 0) => return told.join(", "),
        (1, _) => "the contact is open".to_owned(),
        (_, open) if open == all => format!("all {all} contacts are open"),
        (_, 1) => format!("1 of {all} contacts is open"),
        (_, open) => format!("{open} of {all} contacts are open"),
    };
    if told.is_empty() { open } else { format!("{}; {open}", told.join(", ")) }
}

fn method(subject: Subject<'_>) -> String {
    let start = subject.start;
    let effective = start.scene();
    let text = match effective.method {
        Method::ForwardIncrement => {
            format!(
                "forward increment Lagrange multipliers, of first order, internal step {:e} s",
                effective.step
            )
        }
        Method::EventDriven => format!(
            "event-driven, exact between changes of contact state, internal step {:e} s",
            effective.step
        ),
    };
    match start.selected() {
        Some(selected) => {
            let by = subject.scene.selection;
            format!("{text}; chosen by {by} for a relative error of {:e}", selected.tolerance)
        }
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::parse;

    /// Blocks of their own on a belt, each with its load along y, N; upwards the load opens the contact.
    fn told(loads: &[f64], most: usize) -> String {
        let mut text = String::from(
            "[slider]\nvelocity = 1.0\nangle = 0.0\n[friction]\ncoefficient = 0.1\n\
             [integrator]\nmethod = \"event-driven\"\nstep = 1e-4\n",
        );
        for (i, load) in loads.iter().enumerate() {
            text += &format!(
                "[[mass]]\nname = \"m{i}\"\nmass = 1.0\nforce = [0.0, {load:?}]\n\
                 [[spring]]\nname = \"x{i}\"\nbetween = [\"m{i}\", \"ground\"]\ndirection = \"x\"\nstiffness = 1e4\n\
                 [[spring]]\nname = \"y{i}\"\nbetween = [\"m{i}\", \"ground\"]\ndirection = \"y\"\nstiffness = 1e4\n\
                 [[contact]]\nname = \"c{i}\"\nmass = \"m{i}\"\n"
            );
        }
        let scene = parse("blocks", &text).unwrap();
        let simulation = amontons::simulation::Simulation::new(scene.clone(), 0.0).unwrap();
        normal_forces(&scene, simulation.reference(), most)
    }

    #[test]
    fn open_contacts_are_counted_and_closed_ones_have_their_forces() {
        assert_eq!(told(&[-5.0, -4.0], 2), "5 N at contact.c0, 4 N at contact.c1");
        assert_eq!(
            told(&[1.0, -5.0, -4.0], 2),
            "5 N at contact.c1, 4 N at contact.c2; 1 of 3 contacts is open"
        );
        assert_eq!(
            told(&[1.0, -5.0, 2.0, -4.0], 1),
            "5 N at contact.c1, and 1 more; 2 of 4 contacts are open"
        );
        assert_eq!(told(&[1.0, 2.0], 4), "all 2 contacts are open");
        assert_eq!(told(&[1.0], 4), "the contact is open");
    }
}
