//! Two things are made before the crate is compiled:
//!
//! * the catalogue of FMI variables (`modelDescription/*.toml`) becomes typed Rust tables;
//! * with the feature `tools`, the library that goes into an FMU is built, so that the program
//!   can carry it. Cargo does not install a cdylib beside a binary, and cannot yet hand one to it.
//!   The library is this same crate without the feature, so the build does not recurse.

use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    write_catalogue(&out);
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=modelDescription");
    if env::var_os("CARGO_FEATURE_TOOLS").is_some() {
        build_library(&out);
    }
}

// ---- The catalogue ----

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
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn write_catalogue(out: &Path) {
    let variables: Catalogue = toml::from_str(&read("variables.toml")).expect("variables.toml");
    let units: Units = toml::from_str(&read("units.toml")).expect("units.toml");
    let mut code = String::new();

    let quantities: BTreeSet<&str> =
        variables.variable.iter().map(|variable| variable.quantity.as_str()).collect();
    code.push_str("/// What a variable is to the program.\n");
    code.push_str("#[derive(Clone, Copy, Debug, PartialEq, Eq)]\n#[allow(missing_docs)]\n");
    writeln!(code, "pub enum Quantity {{ {} }}\n", Vec::from_iter(quantities).join(", ")).unwrap();

    code.push_str("/// All templates, in the order in which an FMU lists its variables.\n");
    code.push_str("pub static TEMPLATES: &[Template] = &[\n");
    for variable in &variables.variable {
        let kind = match variable.kind.as_str() {
            "Real" => {
                let unit = variable.unit.as_deref().expect("a Real has a unit");
                assert!(units.unit.contains_key(unit), "{}: undeclared unit", variable.name);
                format!("Kind::Real {{ unit: {unit:?}, min: {:?} }}", variable.min)
            }
            "Integer" => "Kind::Integer".to_owned(),
            "Boolean" => "Kind::Boolean".to_owned(),
            name => {
                assert!(units.enumeration.contains_key(name), "{}: no such type", variable.name);
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

    code.push_str("/// All units, with their exponents of the SI base units.\n");
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

/// The name of a Rust variant for a word of the catalogue.
fn variant(word: &str) -> String {
    let (first, rest) = word.split_at(1);
    first.to_uppercase() + rest
}

// ---- The library inside an FMU ----

fn build_library(out: &Path) {
    // What is fuzzed is linked, not carried; and the flags that watch it leave symbols for its program to define.
    if env::var_os("CARGO_CFG_FUZZING").is_some() {
        let none = out.join("none");
        fs::write(&none, []).expect("OUT_DIR is writable");
        println!("cargo::rustc-env=AMONTONS_FMU_LIBRARY={}", none.display());
        return;
    }
    for path in [
        "Cargo.toml",
        "Cargo.lock",
        "src/lib.rs",
        "src/error.rs",
        "src/scene",
        "src/contact",
        "src/model",
        "src/stability",
        "src/integrator",
        "src/simulation",
        "src/fmi2",
        "scenes",
    ] {
        println!("cargo::rerun-if-changed={path}");
    }
    let target = env::var("TARGET").expect("cargo sets it");
    assert!(
        target.starts_with("x86_64-") && target.contains("-linux-"),
        "FMUs are made for x86_64 Linux so far, not for {target}; \
         build with --no-default-features to have the library alone"
    );
    let target_dir = out.join("fmu");
    let mut cargo = Command::new(env::var_os("CARGO").expect("cargo sets it"));
    cargo
        .args(["rustc", "--lib", "--crate-type", "cdylib", "--profile", "fmu"])
        .args(["--no-default-features", "--locked", "--target", &target, "--target-dir"])
        .arg(&target_dir);
    // Set by `cargo clippy` for its own run; the library is compiled, not linted.
    cargo.env_remove("RUSTC_WORKSPACE_WRAPPER");
    // Describes the outer build; the inner one gets its own.
    for (name, _) in env::vars_os() {
        let inherited = name.to_string_lossy();
        if inherited.starts_with("CARGO_FEATURE_") || inherited.starts_with("CARGO_CFG_") {
            cargo.env_remove(name);
        }
    }
    // An undefined symbol fails here, not in an importer.
    let mut flags: Vec<String> = env::var("CARGO_ENCODED_RUSTFLAGS")
        .unwrap_or_default()
        .split('\x1f')
        .filter(|flag| !flag.is_empty())
        .map(str::to_owned)
        .collect();
    flags.push("-Clink-arg=-Wl,-z,defs".to_owned());
    // Messages of panics name source files; where this machine keeps them is not for an FMU to tell.
    let home = |name: &str| env::var_os("HOME").map(|home| Path::new(&home).join(name));
    let cargo_home = env::var_os("CARGO_HOME").map(PathBuf::from).or_else(|| home(".cargo"));
    let sources = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    for (path, name) in
        [(cargo_home, "cargo"), (sources, "amontons"), (Some(target_dir.clone()), "target")]
    {
        flags.extend(path.map(|path| format!("--remap-path-prefix={}={name}", path.display())));
    }
    cargo.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f"));
    let status = cargo.status().expect("cargo can be started");
    assert!(status.success(), "the library that goes into an FMU does not compile");

    let library = target_dir.join(&target).join("fmu").join("libamontons.so");
    println!("cargo::rustc-env=AMONTONS_FMU_LIBRARY={}", library.display());
}
