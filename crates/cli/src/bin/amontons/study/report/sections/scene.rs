//! The scene: its drawing, its values, and the effects that it does not have.

use super::super::Report;
use super::{figure, table};
use amontons::scene::Scene;
use amontons::simulation::Parameters;
use amontons::simulation::catalogue::Kind;
use amontons_analysis::effects::effects;
use amontons_analysis::stability::Linearised;
use amontons_export::documentation::{contents, normal_forces};
use amontons_pictures::picture::{Structure, prefixed};
use amontons_pictures::report::{Cell, Content, Section};

/// Contacts whose normal force is told.
const MOST_FORCES: usize = 12;
/// Values that are told.
const MOST_VALUES: usize = 40;
/// The energy ledger and the like are outputs of a run, and no effects on the motion.
const LEDGERS: [&str; 2] = ["energy", "stability"];

pub fn section(report: &Report<'_>) -> Section {
    let scene = report.scene;
    let mut section =
        Section { heading: "The scene".to_owned(), text: contents(scene), ..Section::default() };
    if let Ok(equilibrium) = Linearised::of(report.still).equilibrium() {
        let forces = normal_forces(report.still, equilibrium, MOST_FORCES);
        section.text.push(format!("Normal forces in the equilibrium: {forces}."));
    }
    let has_superelements =
        scene.network().is_some_and(|network| !network.superelements.is_empty());
    let structure = Structure::from(scene);
    let forces: Vec<Vec<Cell>> = structure
        .forces
        .iter()
        .map(|one| vec![Cell::from(&*one.name), Cell::from(&*one.label)])
        .collect();
    if structure.masses.len() <= Structure::MOST_MASSES {
        let caption = if has_superelements {
            "Masses, springs, dampers and contacts; each superelement is drawn as one mass. The drawing is not to scale."
        } else {
            "Masses, springs, dampers and contacts. The drawing is not to scale."
        };
        section.figures.push(figure(caption, Content::Structure(structure)));
    } else {
        let most = Structure::MOST_MASSES;
        section.text.push(format!("There is no drawing: it would show more than {most} masses."));
    }
    let mut values = values(scene);
    values.extend(forces);
    let count = values.len();
    let shown: Vec<Vec<Cell>> = values.into_iter().take(MOST_VALUES).collect();
    let caption = match count {
        0..=MOST_VALUES => {
            "Values of the scene; forces and preloads of zero are left out".to_owned()
        }
        _ => format!("The first {MOST_VALUES} of {count} values of the scene"),
    };
    section.tables.push(table(caption, &["Name", "Value"], shown));
    let missing = effects(scene).into_iter().filter(|it| !it.is_on && !LEDGERS.contains(&it.name));
    let missing: Vec<&str> = missing.map(|effect| in_words(effect.name)).collect();
    section.points.push(format!("Effects that the scene does not use: {}.", missing.join("; ")));
    let parts = if has_superelements {
        "structures as matrices (superelements), masses, linear springs and dampers"
    } else {
        "masses, linear springs and dampers"
    };
    section.points.push(format!(
        "The model has {parts}, and rigid contacts with friction. Wear, heat, and friction that changes with temperature or time are not \
         part of it."
    ));
    section
}

/// An effect as an engineer says it.
fn in_words(effect: &'static str) -> &'static str {
    match effect {
        "static" => "friction that is larger at rest than in sliding",
        "stribeck" => "friction that falls with the slip velocity",
        "sticking" => "contacts that stick",
        "detachment" => "contacts that open",
        "damping by mass" => "damping in proportion to masses",
        "damping by stiffness" => "damping in proportion to stiffnesses",
        "links" => "springs between modules",
        "forces" => "external forces",
        other => other,
    }
}

/// Parameters and inputs with their values; initial values and the step do not count, and neither do forces and preloads of zero.
fn values(scene: &Scene) -> Vec<Vec<Cell>> {
    let parameters = Parameters::of(scene.clone());
    let is_told = |name: &str, value: f64| {
        let last = name.rsplit('.').next().unwrap_or(name);
        let is_load = last.starts_with('f') && last != "friction" || last == "preload";
        !["initial.", "integrator."].iter().any(|start| name.starts_with(start))
            && (value != 0.0 || !is_load)
    };
    let row = |(name, value, unit): (String, f64, &str)| {
        let text = match unit {
            "N/m" | "N" | "m" | "m/s" | "s" | "N.s/m" if value != 0.0 => {
                prefixed(value, &unit.replace('.', " "))
            }
            _ => format!("{value} {unit}").trim_end().to_owned(),
        };
        vec![Cell::from(name), Cell::from(text)]
    };
    let real = parameters.iter().filter_map(|(variable, value)| match variable.template.kind {
        Kind::Real { unit, .. } => {
            Some((variable.name.clone(), value, if unit == "1" { "" } else { unit }))
        }
        _ => None,
    });
    real.filter(|(name, value, _)| is_told(name, *value)).map(row).collect()
}
