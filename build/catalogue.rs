//! The catalogue of FMI variables (`modelDescription/*.toml`) as typed Rust tables.

use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Catalogue {
    variable: Vec<Variable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Variable {
    name: String,
    quantity: String,
    #[serde(default = "first")]
    component: usize,
    per: Option<String>,
    causality: String,
    variability: String,
    #[serde(rename = "type", default = "real")]
    kind: String,
    unit: Option<String>,
    min: Option<f64>,
    description: String,
}

fn first() -> usize {
    1
}

fn real() -> String {
    "Real".to_owned()
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Units {
    unit: BTreeMap<String, BTreeMap<String, i32>>,
    enumeration: BTreeMap<String, Enumeration>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Enumeration {
    description: String,
    items: Vec<Item>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Item {
    name: String,
    description: String,
}

fn read(name: &str) -> String {
    let path = Path::new("modelDescription").join(name);
    fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()))
}

pub fn write(out: &Path) {
    let variables: Catalogue = toml::from_str(&read("variables.toml"))
        .expect("variables.toml has the form of a catalogue");
    let units: Units =
        toml::from_str(&read("units.toml")).expect("units.toml has the form of a list of units");
    let mut code = String::new();

    let quantities: BTreeSet<&str> =
        variables.variable.iter().map(|variable| variable.quantity.as_str()).collect();
    code.push_str("/// Quantity of the model that a variable reads or writes.\n");
    code.push_str("#[derive(Clone, Copy, Debug, PartialEq, Eq)]\n#[allow(missing_docs)]\n");
    writeln!(code, "pub enum Quantity {{ {} }}\n", Vec::from_iter(quantities).join(", ")).unwrap();

    write_patterns(&mut code, &variables.variable);

    code.push_str("/// All templates, in the order in which an FMU lists its variables.\n");
    code.push_str("pub static TEMPLATES: &[Template] = &[\n");
    for variable in &variables.variable {
        let kind = match variable.kind.as_str() {
            "Real" => {
                let unit = variable.unit.as_deref().expect("a Real has a unit");
                assert!(
                    units.unit.contains_key(unit),
                    "{}: units.toml does not declare the unit {unit}",
                    variable.name
                );
                format!("Kind::Real {{ unit: {unit:?}, min: {:?} }}", variable.min)
            }
            "Integer" => "Kind::Integer".to_owned(),
            "Boolean" => "Kind::Boolean".to_owned(),
            name => {
                assert!(
                    units.enumeration.contains_key(name),
                    "{}: units.toml does not declare the type {name}",
                    variable.name
                );
                format!("Kind::Enumeration {{ name: {name:?} }}")
            }
        };
        writeln!(
            code,
            "    Template {{ name: {:?}, quantity: Quantity::{}, component: {}, per: Per::{}, \
             causality: Causality::{}, variability: Variability::{}, kind: {kind}, \
             description: {:?} }},",
            variable.name,
            variable.quantity,
            variable.component.checked_sub(1).expect("components count from 1"),
            variant(variable.per.as_deref().unwrap_or("scene")),
            variant(&variable.causality),
            variant(&variable.variability),
            variable.description,
        )
        .unwrap();
    }
    code.push_str("];\n\n");

    code.push_str("/// All units, each with its exponents of the SI base units.\n");
    code.push_str("pub static UNITS: &[Unit] = &[\n");
    for (name, exponents) in &units.unit {
        let exponents: Vec<_> = exponents.iter().collect();
        writeln!(code, "    Unit {{ name: {name:?}, exponents: &{exponents:?} }},").unwrap();
    }
    code.push_str("];\n\n");

    code.push_str("/// All enumerations.\n");
    code.push_str("pub static ENUMERATIONS: &[Enumeration] = &[\n");
    for (name, Enumeration { description, items }) in &units.enumeration {
        let items: Vec<_> = items.iter().map(|item| (&item.name, &item.description)).collect();
        writeln!(
            code,
            "    Enumeration {{ name: {name:?}, description: {description:?}, items: &{items:?} }},"
        )
        .unwrap();
    }
    code.push_str("];\n");
    fs::write(out.join("catalogue.rs"), code).expect("OUT_DIR is writable");
}

/// Writes the patterns `output!()` and `parameter_or_input!()` for a match on a quantity. With them the compiler asks for
/// an arm for each new quantity.
fn write_patterns(code: &mut String, variables: &[Variable]) {
    let of = |is_output: bool| -> BTreeSet<String> {
        let are = variables.iter().filter(|one| (one.causality == "output") == is_output);
        are.map(|variable| format!("Quantity::{}", variable.quantity)).collect()
    };
    let (outputs, others) = (of(true), of(false));
    assert!(outputs.is_disjoint(&others), "a quantity is an output, or else a parameter or input");
    for (name, quantities) in [("output", outputs), ("parameter_or_input", others)] {
        let pattern = Vec::from_iter(quantities).join(" | ");
        writeln!(code, "macro_rules! {name} {{ () => {{ {pattern} }} }}\n").unwrap();
    }
}

/// Name of the Rust variant for a word of the catalogue.
fn variant(word: &str) -> String {
    let (first, rest) = word.split_at(1);
    first.to_uppercase() + rest
}
