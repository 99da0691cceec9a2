//! The variables of an FMU: by kind, so that those of many equal parts are read at once, and one by one.

use amontons::fmi2::STRICT;
use amontons::scene::Scene;
use amontons::simulation::Parameters;
use amontons::simulation::catalogue::{
    Causality, ENUMERATIONS, Enumeration, Kind, Per, Variability, Variable, fmu_variables,
};
use amontons_pictures::report::{add, plain_table, text};

/// The most parts of a network whose names are written out.
const NAMED: usize = 6;

pub(super) fn section(scene: &Scene) -> String {
    let variables = fmu_variables(scene);
    let mut html = String::from(
        "<p>One row for each kind of variable. Inputs and tunable parameters may be set during a run, other \
         parameters only before it; displacements are measured from the equilibrium.</p>\n<div class=\"words\">\n",
    );
    let head = ["name", "unit", "variability", "start", "minimum", "description"];
    for (causality, id, heading) in [
        (Causality::Input, "inputs", "Inputs"),
        (Causality::Parameter, "parameters", "Parameters"),
        (Causality::Output, "outputs", "Outputs"),
    ] {
        let kinds = kinds(&variables, causality);
        let count: usize = kinds.iter().map(Vec::len).sum();
        if count == 0 {
            add(&mut html, format_args!("<p>{heading}: none.</p>\n"));
            continue;
        }
        let rows = kinds.iter().map(|kind| {
            let first = kind[0];
            row(scene, text(&names(scene, kind)), kind, first.template.description)
        });
        let caption = format!("{heading}: {count}");
        plain_table(&mut html, id, &caption, &head.map(str::to_owned), rows);
    }
    for enumeration in ENUMERATIONS {
        let kind = Kind::Enumeration { name: enumeration.name };
        if variables.iter().any(|variable| variable.template.kind == kind) {
            meanings(&mut html, enumeration);
        }
    }
    add(
        &mut html,
        format_args!(
            "<details>\n<summary>All {} variables one by one</summary>\n",
            variables.len()
        ),
    );
    let head = [
        "name",
        "reference",
        "causality",
        "unit",
        "variability",
        "start",
        "minimum",
        "description",
    ];
    let rows = variables.iter().enumerate().map(|(reference, variable)| {
        let mut cells: Vec<String> =
            row(scene, text(&variable.name), &[variable], variable.template.description).collect();
        cells.splice(1..1, [reference.to_string(), causality(variable.causality).to_owned()]);
        cells.into_iter()
    });
    plain_table(
        &mut html,
        "all-variables",
        "In the order of the model description",
        &head.map(str::to_owned),
        rows,
    );
    html + "</details>\n</div>\n"
}

/// Meanings of the numbers of an enumeration.
fn meanings(html: &mut String, enumeration: &Enumeration) {
    let items: Vec<String> = (enumeration.items.iter().zip(1..))
        .map(|((name, description), number)| format!("{number} {name} ({description})"))
        .collect();
    let meanings = format!("{}: {}.", enumeration.name, items.join(", "));
    add(html, format_args!("<p>{}</p>\n", text(&meanings)));
}

/// The variables of a causality, those of one template together.
fn kinds(variables: &[Variable], causality: Causality) -> Vec<Vec<&Variable>> {
    let mut kinds: Vec<Vec<&Variable>> = Vec::new();
    for variable in variables.iter().filter(|variable| variable.causality == causality) {
        let same = |kind: &&mut Vec<&Variable>| std::ptr::eq(kind[0].template, variable.template);
        match kinds.iter_mut().find(same) {
            Some(kind) => kind.push(variable),
            None => kinds.push(vec![variable]),
        }
    }
    kinds
}

/// `module[1 … 12].x1`, `mass.{a, b}.x`, or the name of a single variable.
fn names(scene: &Scene, kind: &[&Variable]) -> String {
    let template = kind[0].template;
    if kind.len() == 1 {
        return kind[0].name.clone();
    }
    let numbered = scene.network().is_none() || template.per == Per::Scene;
    if numbered {
        let [first, last] = [kind[0], kind[kind.len() - 1]].map(|variable| variable.index + 1);
        return template.name.replace("{i}", &format!("[{first} … {last}]"));
    }
    // The part that `{i}` stands for is the rest of each name.
    let (before, after) = template.name.split_once("{i}").unwrap_or((template.name, ""));
    let own = |variable: &&Variable| {
        let rest = variable.name.strip_prefix(before).and_then(|rest| rest.strip_suffix(after));
        rest.unwrap_or(&variable.name).trim_start_matches('.').to_owned()
    };
    let mut parts: Vec<String> = kind.iter().take(NAMED).map(own).collect();
    if kind.len() > NAMED {
        parts.push(format!("… {} in all", kind.len()));
    }
    format!("{before}.{{{}}}{after}", parts.join(", "))
}

/// The cells of a row, as HTML.
fn row(
    scene: &Scene,
    name: String,
    kind: &[&Variable],
    description: &str,
) -> std::vec::IntoIter<String> {
    let variable = kind[0];
    let (unit, least) = match variable.template.kind {
        Kind::Real { unit, min } => (unit.to_owned(), min.map(|min| format!("{min:?}"))),
        Kind::Integer => ("integer".to_owned(), None),
        Kind::Boolean => ("Boolean".to_owned(), None),
        Kind::Enumeration { name } => (name.to_owned(), None),
    };
    let when = match variable.variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    };
    let cells = [
        name,
        text(&unit),
        when.to_owned(),
        starts(scene, kind),
        least.unwrap_or_default(),
        text(description),
    ];
    Vec::from(cells).into_iter()
}

/// The value that all have at the start, or from the least to the largest.
fn starts(scene: &Scene, kind: &[&Variable]) -> String {
    let parameters = Parameters::of(scene.clone());
    let values = kind.iter().filter_map(|variable| parameters.get(variable));
    let reach = values.fold(None, |reach: Option<[f64; 2]>, value| {
        let [low, high] = reach.unwrap_or([value; 2]);
        Some([low.min(value), high.max(value)])
    });
    match reach {
        // The one that no scene has.
        None if kind[0].template.kind == Kind::Boolean => STRICT.to_string(),
        None => String::new(),
        Some([low, high]) if low == high => format!("{low:?}"),
        Some([low, high]) => format!("{low:?} to {high:?}"),
    }
}

fn causality(causality: Causality) -> &'static str {
    match causality {
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Parameter => "parameter",
    }
}
