//! `amontons effects` as its user meets it.

use crate::program::{assert_refused, folder, run, text};
use amontons::scene::{BUILTIN, builtin};
use std::process::Output;

fn effects(scene: &str) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder().path(), &["effects", scene])
}

/// Effects of Set 1, on and off in its file, with what is said of their variables.
const OF_SET1: [(&str, &str, &str); 12] = [
    ("coulomb", "on", "friction.coefficient"),
    ("static", "off", "friction.static"),
    ("stribeck", "off", "friction.static, friction.stribeck_velocity"),
    ("sticking", "on", ""),
    ("detachment", "on", ""),
    ("damping by mass", "off", "damping.alpha"),
    ("damping by stiffness", "on", "damping.beta"),
    ("links", "on", "module[1].k1, module[1].k2, module[2].k1, module[2].k2"),
    ("preload", "on", "module[1].preload, module[2].preload"),
    (
        "forces",
        "on",
        "module[1].f1, module[1].f2, module[1].f3, module[1].f4, \
         module[2].f1, module[2].f2, module[2].f3, module[2].f4",
    ),
    (
        "energy",
        "off",
        "energy.kinetic, energy.elastic, energy.damping, energy.friction, \
         energy.impact, energy.slider, energy.forces, energy.residual",
    ),
    ("stability", "off", "stability.growth_rate, stability.frequency, stability.modes"),
];

#[test]
fn every_effect_is_listed_with_its_state_its_cost_and_its_variables() {
    let output = effects("set1");
    let printed = text(&output.stdout);
    assert!(output.status.success() && printed.starts_with("set1: a step of 1e-6 s takes "));
    let (_, table) = printed.split_once("cannot have\n\n").unwrap();
    let mut lines = table.lines().peekable();
    for (name, state, variables) in OF_SET1 {
        let line = lines.next().unwrap();
        let rest = line.strip_prefix(name).unwrap_or_else(|| panic!("{name} is not in: {line}"));
        let mut words = rest.split_whitespace();
        assert_eq!(words.next(), Some(state), "{line}");
        // A cost in percent, then the equation.
        assert!(words.next().unwrap().parse::<f64>().is_ok_and(f64::is_finite), "{line}");
        assert!(words.next() == Some("%") && words.next().is_some(), "{line}");
        let listed = lines.next_if(|line| line.starts_with(' ')).unwrap_or("");
        assert_eq!(listed.trim(), variables, "{name}");
    }
    assert_eq!(lines.next(), None);
}

#[test]
fn every_built_in_scene_has_its_effects_listed() {
    for builtin in BUILTIN {
        let output = effects(builtin.name);
        let printed = text(&output.stdout);
        assert!(output.status.success(), "{}: {}", builtin.name, text(&output.stderr));
        for name in ["damping by stiffness", "forces", "energy", "stability"] {
            assert!(printed.contains(&format!("\n{name} ")), "{name} is not in:\n{printed}");
        }
    }
}

#[test]
fn a_wrong_scene_is_refused_with_what_is_wrong() {
    let folder = folder();
    let set1 = builtin("set1").unwrap().text;
    let wrong = set1.replacen("[friction]\n", "[friction]\nlaw = \"stribek\"\n", 1);
    std::fs::write(folder.path().join("mine.toml"), wrong).unwrap();
    let output = run(env!("CARGO_BIN_EXE_amontons"), folder.path(), &["effects", "mine.toml"]);
    assert_refused(&output, 3, &["friction.law = \"stribek\"", "did you mean \"stribeck\"?"]);
    assert_refused(&effects("nothing"), 1, &["no file nothing", "set1"]);
}
