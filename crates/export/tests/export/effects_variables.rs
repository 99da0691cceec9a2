//! Tests of the variables of a scene: an effect that is off has none, and parts have the names of the scene.

use amontons::contact::Law;
use amontons::scene::{Scene, builtin, parse, read};
use amontons::simulation::catalogue::{Causality, Variability};
use amontons::simulation::{Simulation, Variable, fingerprint, variables};
use amontons_analysis::assign::assign;
use amontons_analysis::effects::effects;
use amontons_analysis::warning::warnings;
use amontons_export::package::model_description;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;

/// A ring that has nothing that may be left out, and µ and v as a ring needs them.
const RING: &str = "\
[slider]
velocity = 0.1
angle = 0.2
[integrator]
step = 1e-5
[friction]
coefficient = 0.3
# friction
[damping]
# damping
[inputs]
forces = \"none\"
# inputs
[ring]
modules = 2
m1 = 0.3
m2 = 0.7
k3 = 22e3
k4 = 60e3
k5 = 300e3
k6 = 250e3
# ring
";

const NETWORK: &str = "\
[slider]
velocity = 0.1
angle = 0.0
[integrator]
step = 1e-5
[friction]
coefficient = 0.3
# friction
[damping]
# damping
[inputs]
forces = \"none\"
# inputs
[[mass]]
name = \"a\"
mass = 1.0
force = [0.0, -10.0]
[[spring]]
name = \"k\"
between = [\"a\", \"ground\"]
direction = \"x\"
stiffness = 100.0
# spring
[[mass]]
name = \"b\"
mass = 1.0
force = [0.0, -10.0]
[[spring]]
name = \"other\"
between = [\"b\", \"ground\"]
direction = \"x\"
stiffness = 100.0
[[contact]]
name = \"other\"
mass = \"b\"
[[contact]]
name = \"c\"
mass = \"a\"
# contact
[[damper]]
name = \"d\"
between = [\"a\", \"ground\"]
direction = \"x\"
damping = 1.0
";

/// A line that switches an effect on, its place in a file, and the variables that it adds.
struct Switch {
    text: &'static str,
    place: &'static str,
    line: &'static str,
    variables: &'static [&'static str],
}

const fn of(
    text: &'static str,
    place: &'static str,
    line: &'static str,
    variables: &'static [&'static str],
) -> Switch {
    Switch { text, place, line, variables }
}

const SWITCHES: &[Switch] = &[
    of(RING, "# damping", "alpha = 0.0", &["damping.alpha"]),
    of(RING, "# damping", "beta = 0.0", &["damping.beta"]),
    of(RING, "# friction", "static = 0.4", &["friction.static"]),
    of(
        RING,
        "# ring",
        "k1 = 1.0\nk2 = [0.0, 2.0]",
        &["module[1].k1", "module[1].k2", "module[2].k1", "module[2].k2"],
    ),
    of(RING, "# ring", "preload = 0.0", &["module[1].preload", "module[2].preload"]),
    of(
        RING,
        "forces = \"none\"",
        "",
        &[
            "module[1].f1",
            "module[1].f2",
            "module[1].f3",
            "module[1].f4",
            "module[2].f1",
            "module[2].f2",
            "module[2].f3",
            "module[2].f4",
        ],
    ),
    of(NETWORK, "# damping", "alpha = 1.0", &["damping.alpha"]),
    of(NETWORK, "# damping", "beta = 1e-6", &["damping.beta"]),
    of(NETWORK, "# friction", "static = 0.3", &["friction.static"]),
    of(NETWORK, "# spring", "preload = 0.0", &["spring.k.preload"]),
    of(NETWORK, "# contact", "friction = 0.3", &["contact.c.friction"]),
    of(NETWORK, "# contact", "static_friction = 0.3", &["contact.c.static_friction"]),
    of(NETWORK, "# contact", "velocity = 0.3", &["contact.c.velocity"]),
    of(
        NETWORK,
        "forces = \"none\"",
        "forces = \"parameter\"",
        &["mass.a.fx", "mass.a.fy", "mass.b.fx", "mass.b.fy"],
    ),
];

fn scene(text: &str) -> Scene {
    parse("mine", text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn names(scene: &Scene) -> BTreeSet<String> {
    variables(scene).into_iter().map(|variable| variable.name).collect()
}

/// The names in the model description.
fn described(scene: &Scene, text: &str) -> BTreeSet<String> {
    let xml = model_description(scene, &text.into(), None);
    let names = xml.split("<ScalarVariable name=\"").skip(1);
    names.map(|rest| rest.split('"').next().unwrap().to_owned()).collect()
}

/// Bytes of a saved state carry the fingerprint of their FMU, and another FMU refuses them.
#[track_caller]
fn assert_no_shared_saved_states(one: &str, other: &str) {
    assert_ne!(fingerprint(&one.into()), fingerprint(&other.into()), "{other}");
}

#[test]
fn what_is_off_has_no_variable_and_what_is_on_has_its_own_and_no_other() {
    for Switch { text, place, line, variables: own } in SWITCHES {
        let with = text.replacen(place, line, 1);
        let (off, on) = (scene(text), scene(&with));
        let own: BTreeSet<String> = own.iter().map(|name| (*name).to_owned()).collect();
        let added = |with: BTreeSet<String>, without: &BTreeSet<String>| -> BTreeSet<String> {
            assert!(with.is_superset(without), "{line}");
            with.difference(without).cloned().collect()
        };
        assert_eq!(added(names(&on), &names(&off)), own, "{line}");
        assert_eq!(added(described(&on, &with), &described(&off, text)), own, "{line}");
        assert_no_shared_saved_states(text, &with);
        for name in &own {
            assign(&mut on.clone(), name, 0.5).unwrap();
            assert!(assign(&mut off.clone(), name, 0.5).unwrap_err().is_argument(), "{name}");
        }
    }
}

/// Contents of `[friction]`, each with the variables of its numbers.
const LAWS: [(&str, &[&str]); 4] = [
    ("law = \"none\"", &[]),
    ("coefficient = 0.3", &["friction.coefficient"]),
    ("coefficient = 0.3\nstatic = 0.4", &["friction.coefficient", "friction.static"]),
    (
        "coefficient = 0.3\nstatic = 0.4\nstribeck_velocity = 0.1",
        &["friction.coefficient", "friction.static", "friction.stribeck_velocity"],
    ),
];

#[test]
fn a_law_of_friction_has_the_variables_of_its_own_numbers_and_no_other() {
    for text in [RING, NETWORK] {
        let with = |friction: &str| text.replacen("coefficient = 0.3", friction, 1);
        let laws = LAWS.map(|(friction, _)| scene(&with(friction)).contact_law().friction);
        assert_eq!(laws, Law::ALL, "each law has a line of LAWS");
        let none = with(LAWS[0].0);
        for (place, (friction, own)) in LAWS.iter().enumerate() {
            let text = with(friction);
            let mut own: BTreeSet<String> = own.iter().map(|name| (*name).to_owned()).collect();
            // Without contacts a network has no variables of the reaction on its slider.
            if place > 0 && text.contains("[[mass]]") {
                own.extend(["tangential", "normal"].map(|part| format!("slider.{part}_reaction")));
            }
            for (all, rest) in [
                (names(&scene(&text)), names(&scene(&none))),
                (described(&scene(&text), &text), described(&scene(&none), &none)),
            ] {
                assert!(all.is_superset(&rest), "{friction}");
                assert_eq!(all.difference(&rest).cloned().collect::<BTreeSet<_>>(), own);
            }
            for (_, (line, _)) in LAWS.iter().enumerate().filter(|(other, _)| *other != place) {
                assert_no_shared_saved_states(&text, &with(line));
            }
        }
    }
}

/// Keys of `[effects]`, each with the outputs that come with it.
const OUTPUTS: [(&str, &[&str]); 4] = [
    ("sticking = false", &["statistics.reversed_slips"]),
    ("detachment = false", &["statistics.pulled_contacts"]),
    (
        "energy = true",
        &[
            "energy.damping",
            "energy.elastic",
            "energy.forces",
            "energy.friction",
            "energy.impact",
            "energy.kinetic",
            "energy.residual",
            "energy.slider",
        ],
    ),
    ("stability = true", &["stability.frequency", "stability.growth_rate", "stability.modes"]),
];

#[test]
fn a_key_of_the_effects_comes_with_its_own_outputs_and_no_other() {
    for text in [RING, NETWORK] {
        let off = scene(text);
        for (line, own) in OUTPUTS {
            let with = format!("{text}[effects]\n{line}\n");
            let on = scene(&with);
            let added: BTreeSet<_> = &described(&on, &with) - &described(&off, text);
            assert!(added.iter().eq(own), "{line}: {added:?}");
            assert!(described(&on, &with).is_superset(&described(&off, text)), "{line}");
            assert_no_shared_saved_states(text, &with);
            let of_it = |v: &Variable| own.contains(&&*v.name);
            let outputs: Vec<Variable> = variables(&on).into_iter().filter(of_it).collect();
            assert_eq!(outputs.len(), own.len(), "{line}");
            assert!(outputs.iter().all(|v| v.causality == Causality::Output), "{line}");
        }
    }
}

/// The scenes of single effects: what each shows at work, and what it shows to be left out.
const SHOWN: [(&str, &[&str], &[&str]); 11] = [
    ("coulomb", &["coulomb", "sticking"], &["static", "stribeck"]),
    ("damping", &["damping by mass", "damping by stiffness", "single dampers"], &[]),
    ("detachment", &[], &["detachment", "coulomb"]),
    ("energy", &["energy", "detachment"], &[]),
    ("links", &["links", "preload"], &["forces"]),
    ("modules", &["preload", "detachment", "sticking"], &["links", "forces"]),
    ("none", &[], &["coulomb", "static", "stribeck", "energy", "stability"]),
    ("stability", &["stability", "damping by mass"], &[]),
    ("static", &["static", "forces"], &["coulomb"]),
    ("sticking", &["coulomb"], &["sticking"]),
    ("stribeck", &["stribeck", "single dampers"], &["damping by mass"]),
];

/// Every scene of an effect, by the name of its file.
fn effect_scenes() -> BTreeMap<String, Scene> {
    let files = fs::read_dir("../../scenes/effects").unwrap().map(|entry| entry.unwrap().path());
    files
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| read(&path).unwrap_or_else(|error| panic!("{error}")).0)
        .map(|scene| (scene.name.clone(), scene))
        .collect()
}

#[test]
fn every_effect_that_there_is_has_a_scene_that_shows_it() {
    let scenes = effect_scenes();
    assert!(scenes.keys().eq(SHOWN.iter().map(|(file, ..)| file)), "{:?}", scenes.keys());
    let mut known = BTreeSet::new();
    for (file, on, off) in SHOWN {
        let all = effects(&scenes[file]);
        known.extend(all.iter().map(|effect| effect.name));
        for (names, is_on) in [(on, true), (off, false)] {
            for name in names {
                let effect = all.iter().find(|effect| effect.name == *name);
                assert_eq!(effect.map(|effect| effect.is_on), Some(is_on), "{name} in {file}");
            }
        }
    }
    let shown: BTreeSet<&str> = SHOWN.iter().flat_map(|(_, on, _)| on.iter().copied()).collect();
    assert_eq!(known, shown);
}

#[test]
fn the_variables_of_an_effect_are_described_with_it_and_not_without_it() {
    let mut scenes = effect_scenes();
    for name in ["set1", "disc_brake"] {
        scenes.insert(name.to_owned(), builtin(name).unwrap().scene());
    }
    // An idealisation counts how often it was one; the full law has nothing of its own.
    let counters =
        [("sticking", "statistics.reversed_slips"), ("detachment", "statistics.pulled_contacts")];
    for (file, scene) in &scenes {
        for effect in effects(scene) {
            let name = effect.name;
            let [with, without] = [&effect.with, &effect.without].map(|scene| described(scene, ""));
            let own: BTreeSet<String> = effect.variables().into_iter().collect();
            assert_eq!(&with - &without, own, "{name} in {file}");
            let lost: Vec<String> = (&without - &with).into_iter().collect();
            if let Some((_, counter)) = counters.iter().find(|(of, _)| *of == name) {
                // Without sticking there is no static friction either.
                assert!(own.iter().all(|name| name.ends_with("static")), "{name} in {file}");
                assert_eq!(lost, [*counter], "{name} in {file}");
            } else if effect.is_on || Law::named(name).is_none() {
                assert!(!own.is_empty() && lost.is_empty(), "{name} in {file}: {lost:?}");
            } else {
                // One law in place of another: what it has less.
                assert!(lost.iter().all(|name| name.starts_with("friction.")), "{lost:?}");
            }
        }
    }
}

#[test]
fn what_a_scene_goes_without_is_said_with_how_to_add_it() {
    let says = |text: &str, name: &str, expected: &str| {
        let error = assign(&mut scene(text), name, 0.0).unwrap_err().to_string();
        assert_eq!(error, expected);
    };
    says(
        RING,
        "damping.beta",
        "damping.beta cannot be set: the scene has no stiffness-proportional damping; write \
         `beta = 0.0` into its [damping] to add it",
    );
    let none = RING.replacen("coefficient = 0.3", "law = \"none\"", 1);
    for name in ["friction.coefficient", "friction.static", "friction.stribeck_velocity"] {
        let expected = format!(
            "{name} cannot be set: the scene has no friction; write `coefficient = …` in place of \
             `law = \"none\"` into its [friction]"
        );
        says(&none, name, &expected);
    }
    says(
        RING,
        "friction.stribeck_velocity",
        "friction.stribeck_velocity cannot be set: the friction of the scene does not depend on the slip \
         velocity; write `stribeck_velocity = …` beside `static` into the [friction] of the scene",
    );
    says(
        RING,
        "module[2].k1",
        "module[2].k1 cannot be set: no links join the modules; write `k1` and `k2` into its [ring]",
    );
    says(
        RING,
        "module[1].preload",
        "module[1].preload cannot be set: the ring has no preload; write `preload = 0.0` into its \
         [ring]",
    );
    says(
        NETWORK,
        "mass.a.fx",
        "mass.a.fx cannot be set: the scene has no external forces; write `forces = \"input\"` into \
         its [inputs]",
    );
    says(
        NETWORK,
        "spring.k.preload",
        "spring.k.preload cannot be set: spring k has no preload; write `preload = 0.0` into its \
         [[spring]] to add one",
    );
    // A module that is not there lacks more than a preload.
    let error = assign(&mut scene(RING), "module[3].preload", 0.0).unwrap_err().to_string();
    assert!(error.starts_with("there is no parameter or input module[3].preload"), "{error}");
}

#[test]
fn a_ring_without_preload_is_warned_of_once() {
    let warnings = warnings(&Simulation::new(scene(RING), 0.0).unwrap());
    assert!(warnings.len() == 1 && warnings[0].contains("no preload"), "{warnings:?}");
}

const ROLES: [(&str, &[&str]); 4] = [
    ("slider_velocity", &["slider.velocity", "contact.c.velocity"]),
    (
        "friction",
        &[
            "friction.coefficient",
            "friction.static",
            "contact.c.friction",
            "contact.c.static_friction",
        ],
    ),
    ("preload", &["spring.k.preload"]),
    ("forces", &["mass.a.fx", "mass.a.fy", "mass.b.fx", "mass.b.fy"]),
];

/// A network with all that has a role, under this line of `[inputs]`.
fn with_role(line: &str) -> String {
    let own = "velocity = 0.1\nfriction = 0.3\nstatic_friction = 0.4";
    [("# friction", "static = 0.4"), ("# spring", "preload = 0.0"), ("# contact", own)]
        .iter()
        .fold(NETWORK.replace("forces = \"none\"", line), |text, (place, line)| {
            text.replacen(place, line, 1)
        })
}

#[test]
fn each_key_of_the_inputs_turns_the_roles_of_its_own_variables_and_of_no_others() {
    let roles = |text: &str| -> Vec<(String, Causality, Variability)> {
        let of = |v: Variable| (v.name, v.causality, v.variability);
        variables(&scene(text)).into_iter().map(of).collect()
    };
    let usual = roles(&with_role(""));
    // Unless a scene says otherwise, the catalogue does.
    for variable in variables(&scene(&with_role(""))) {
        let template = (variable.template.causality, variable.template.variability);
        assert_eq!((variable.causality, variable.variability), template, "{}", variable.name);
    }
    for (key, own) in ROLES {
        for (role, expected) in [
            ("input", (Causality::Input, Variability::Continuous)),
            ("parameter", (Causality::Parameter, Variability::Tunable)),
        ] {
            let text = with_role(&format!("{key} = \"{role}\""));
            let scene = scene(&text);
            let xml = model_description(&scene, &(&*text).into(), None);
            for ((name, causality, variability), usual) in roles(&text).iter().zip(&usual) {
                let turned = (*causality, *variability);
                let wanted = if own.contains(&&**name) { expected } else { (usual.1, usual.2) };
                assert_eq!((turned, name), (wanted, &usual.0), "{key} = {role}");
                if !own.contains(&&**name) {
                    continue;
                }
                let tag = xml
                    .split("<ScalarVariable ")
                    .find(|tag| tag.starts_with(&format!("name=\"{name}\"")));
                let said = match role {
                    "input" => "causality=\"input\" variability=\"continuous\">",
                    _ => "causality=\"parameter\" variability=\"tunable\" initial=\"exact\">",
                };
                assert!(tag.unwrap().contains(said), "{tag:?}");
            }
            let mut inputs: Vec<String> = roles(&text)
                .into_iter()
                .filter(|(_, causality, _)| *causality == Causality::Input)
                .map(|(name, ..)| name)
                .collect();
            let mut known = scene.input_names();
            inputs.sort_unstable();
            known.sort_unstable();
            assert_eq!(inputs, known);
        }
    }
}

#[test]
fn a_value_set_between_steps_acts_alike_in_either_role() {
    let text = builtin("set1").unwrap().text;
    let turned = format!(
        "{text}\n[inputs]\nslider_velocity = \"parameter\"\nfriction = \"parameter\"\n\
         preload = \"input\"\nforces = \"parameter\"\n"
    );
    let ends = [text, &*turned].map(|text| {
        let mut simulation = Simulation::new(scene(text), 0.0).unwrap();
        for (i, (name, value)) in [
            ("friction.coefficient", 0.4),
            ("slider.velocity", -0.03),
            ("module[2].preload", 6e-3),
            ("module[1].f2", 40.0),
        ]
        .into_iter()
        .enumerate()
        {
            let before = simulation.displacement().to_vec();
            let all = variables(simulation.scene());
            simulation.write(all.iter().find(|v| v.name == name).unwrap(), value).unwrap();
            assert!(simulation.displacement() == before, "{name}");
            simulation.advance_to(0.01 * (i as f64 + 1.0)).unwrap();
        }
        assert!(simulation.statistics().state_changes() > 0);
        simulation.displacement().iter().map(|x| x.to_bits()).collect::<Vec<u64>>()
    });
    assert_eq!(ends[0], ends[1]);
}

#[test]
fn damping_that_is_given_as_zero_may_be_given_another_value_during_a_run() {
    let text =
        RING.replace("# damping", "alpha = 0.0\nbeta = 0.0").replace("# ring", "preload = 5e-3");
    for name in ["damping.alpha", "damping.beta"] {
        let scene = scene(&text);
        let variable = variables(&scene).into_iter().find(|v| v.name == name).unwrap();
        assert_eq!(variable.variability, Variability::Tunable);
        let speed = |value: f64| {
            let mut scene = scene.clone();
            scene.modules_mut()[0].velocity[0] = 0.01;
            let mut simulation = Simulation::new(scene, 0.0).unwrap();
            simulation.write(&variable, value).unwrap();
            simulation.advance_to(0.5).unwrap();
            simulation.velocity().iter().fold(0.0, |most: f64, v| most.max(v.abs()))
        };
        // exp(−20 · 0.5 / 2) is 1 in 148 at the least.
        let value = if name == "damping.alpha" { 20.0 } else { 1e-3 };
        assert!(speed(value) < 0.05 * speed(0.0), "{name}: {} {}", speed(value), speed(0.0));
    }
}
