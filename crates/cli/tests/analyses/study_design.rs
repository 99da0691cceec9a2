//! Designs: they keep their limit, no smaller change does, and they remove squeal.

use crate::program::{assert_refused, folder, run, text};
use crate::study_robustness::{K1, K2, K3, critical, hoffmann};
use amontons::contact::ContactState::Slide;
use amontons::scene::{Scene, builtin, parse};
use amontons::stability::Spectrum;
use amontons_analysis::design::{
    DesignQuestion, FoundDesign, Varied, Vary, design, scene_at, varied,
};
use amontons_analysis::stability::candidates::candidates_at;
use amontons_analysis::stability::{Linearised, critical_friction, on_this_thread};
use amontons_analysis::study::{Journal, Watch};
use std::fs;
use std::path::Path;
use std::process::Output;

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

fn varying(scene: &Scene, given: &[&str], together: bool) -> Vec<Varied> {
    let given: Vec<Vary> = given.iter().map(|text| Vary::parse(text).unwrap()).collect();
    varied(scene, &given, together, &[]).unwrap()
}

/// The design for uniform sliding.
fn of(scene: &Scene, varied: &[Varied], range: [f64; 2], margin: f64) -> FoundDesign {
    let states = vec![Linearised::of(scene).uniform_sliding().unwrap()];
    let question = DesignQuestion {
        scene,
        varied,
        patterns: &states,
        is_uniform: true,
        range,
        margin,
        starts: 3,
        seed: 1,
        points: 3,
        pushes: None,
    };
    design(&question, &Journal::forgotten(), Watch::IDLE).unwrap().unwrap()
}

#[test]
fn hoffmanns_model_needs_the_change_of_one_spring_that_its_closed_form_says() {
    let scene = hoffmann();
    let varied = varying(&scene, &["spring.k3.stiffness=±40%"], false);
    let found = of(&scene, &varied, [0.0, 0.3], 0.0);
    // Of the two directions the design takes the one with the smaller change.
    let reaches = |change: f64| critical([K1, K2, K3 * (1.0 + change)]) >= 0.3;
    let steps = (1..40_000).map(|i| f64::from(i) * 1e-5);
    let expected = steps.flat_map(|size| [size, -size]).find(|change| reaches(*change)).unwrap();
    assert!(found.is_kept && (found.design.changes[0] - expected).abs() < 5e-5, "{found:?}");
}

/// Scans all directions of the changes of three springs.
#[test]
fn no_smaller_change_of_three_springs_keeps_hoffmanns_model_from_growing() {
    let scene = hoffmann();
    let varied = varying(&scene, &["spring.*.stiffness=±20%"], false);
    let found = of(&scene, &varied, [0.0, 0.4], 0.0);
    assert!(found.is_kept, "{found:?}");
    let mut least = f64::INFINITY;
    for i in 0..180 {
        for j in 0..360 {
            let (polar, azimuth) = (f64::from(i).to_radians(), f64::from(j).to_radians());
            let direction = [polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()];
            let springs = |size: f64| {
                let at = |k: f64, part: f64| k * (1.0 + size * part);
                [at(K1, direction[0]), at(K2, direction[1]), at(K3, direction[2])]
            };
            let sizes = (1..400).map(|i| f64::from(i) * 0.0005);
            let first = sizes.take_while(|size| *size < least).find(|size| {
                let is_within = direction.iter().all(|part| (size * part).abs() <= 0.2);
                is_within && critical(springs(*size)) >= 0.4
            });
            least = least.min(first.unwrap_or(f64::INFINITY));
        }
    }
    let size = found.design.size;
    assert!((size - least).abs() < 0.01 * least, "{size} {least}");
    let design = found.design.changes;
    let springs = [K1 * (1.0 + design[0]), K2 * (1.0 + design[1]), K3 * (1.0 + design[2])];
    assert!(critical(springs) >= 0.4 * (1.0 - 1e-8), "{}", critical(springs));
}

/// Two changes of Set 1 in all directions: the boundary is found by bisection of the growth rate at the largest µ, and the
/// design lies on it where it is nearest.
#[test]
fn no_smaller_change_of_two_values_keeps_set_1_from_growing() {
    let scene = builtin("set1").unwrap().scene();
    let varied = varying(&scene, &["module[*].k5=±5%", "module[*].k6=±5%"], true);
    let found = of(&scene, &varied, [0.0, 1.4], 0.1);
    assert!(found.is_kept, "{found:?}");
    let growth = |changes: [f64; 2], friction: f64| {
        let mut scene = scene_at(&scene, &varied, &changes).unwrap();
        scene.friction_coefficient = friction;
        let here = Linearised::of(&scene);
        Spectrum::of(here.linear().unwrap(), &[Slide; 2]).unwrap().growth_rate()
    };
    let mut least = f64::INFINITY;
    for degree in 0..360 {
        let angle = f64::from(degree).to_radians();
        let at = |size: f64| [size * angle.cos(), size * angle.sin()];
        let keeps = |size: f64| growth(at(size), 1.4) <= -0.1;
        let (mut low, mut high) = (0.0, 0.05);
        if !keeps(high) {
            continue;
        }
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if keeps(middle) { high = middle } else { low = middle }
        }
        least = least.min(high);
    }
    // Both values stand in both modules; the design keeps a little more than the limit.
    let size = found.design.size;
    let expected = 2.0_f64.sqrt() * least;
    assert!(size >= 0.999 * expected && size < 1.004 * expected, "{size} {expected}");
    let [a, b] = found.design.changes[..] else { panic!("{found:?}") };
    for i in 0..=2000 {
        let friction = 1.4 * f64::from(i) / 2000.0;
        assert!(growth([a, b], friction) <= -0.1, "{friction}");
    }
}

/// A block between a floor and a wall, whose frictions feed it only where one coupling has changed its sign and the other one has
/// not: over 0.0006 of µ.
#[test]
fn growth_between_two_values_of_the_friction_coefficient_is_found_and_removed() {
    let mass = |name: &str, mass: f64, more: &str| {
        format!("[[mass]]\nname = \"{name}\"\nmass = {mass:?}\n{more}\n")
    };
    let spring = |name: &str, on: &str, direction: &str, stiffness: f64| {
        format!(
            "[[spring]]\nname = \"{name}\"\nbetween = [\"{on}\", \"ground\"]\ndirection = {direction}\n\
             stiffness = {stiffness:?}\n"
        )
    };
    let contact = |name: &str, on: &str, angle: f64, velocity: f64| {
        format!(
            "[[contact]]\nname = \"{name}\"\nmass = \"block\"\non = \"{on}\"\nangle = {angle:?}\n\
             velocity = {velocity:?}\n"
        )
    };
    let text = [
        "slider = { velocity = 0.1, angle = 0.0 }\nfriction = { coefficient = 0.3 }\n\
         integrator = { step = 1e-5 }\n"
            .to_owned(),
        mass("block", 0.99, "force = [-50.0, -50.0]"),
        mass("floor", 0.01, "locked = [\"x\"]"),
        mass("wall", 0.01, "locked = [\"y\"]"),
        spring("x", "block", "\"x\"", 3_000_000.0),
        spring("y", "block", "\"y\"", 2_997_583.595_513_22),
        spring("strut", "block", "0.7853981633974483", 2_000_000.0),
        spring("down", "floor", "\"y\"", 2_008_032.128_514_056_3),
        spring("across", "wall", "\"x\"", 2_005_615.724_027_276_5),
        contact("below", "floor", 0.0, -0.1),
        contact("beside", "wall", -std::f64::consts::FRAC_PI_2, 0.1),
    ];
    let scene = parse("corner", &text.concat()).unwrap();
    let states = Linearised::of(&scene).uniform_sliding().unwrap();
    let fastest = |scene: &Scene, [from, to]: [f64; 2]| {
        let rates = (0..=20_000).map(|i| {
            let friction = from + (to - from) * f64::from(i) / 20_000.0;
            let here = Linearised::of(&Scene { friction_coefficient: friction, ..scene.clone() });
            Spectrum::of(here.linear().unwrap(), &states).unwrap().growth_rate()
        });
        rates.fold(f64::NEG_INFINITY, f64::max)
    };
    let varied = varying(&scene, &["spring.*.stiffness=±5%"], false);
    let found = of(&scene, &varied, [0.0, 1.0], 0.0);
    let expected = fastest(&scene, [0.513, 0.515]);
    assert!(expected > 0.1 && (found.before.growth - expected).abs() < 1e-6, "{found:?}");
    let designed = scene_at(&scene, &varied, &found.design.changes).unwrap();
    assert!(found.is_kept && fastest(&designed, [0.0, 1.0]) <= 0.0, "{found:?}");
}

#[test]
fn set_1_squeals_only_with_a_fifth_more_friction_after_changes_of_five_percent_at_most() {
    let scene = builtin("set1").unwrap().scene();
    let mut given: Vec<String> = (1..=6).map(|spring| format!("module[*].k{spring}=±5%")).collect();
    given.extend(
        ["module[*].m1=±5%", "module[*].m2=±5%", "damping.beta=3e-5:6e-5"].map(str::to_owned),
    );
    let given: Vec<&str> = given.iter().map(String::as_str).collect();
    let varied = varying(&scene, &given, false);
    let onset = |scene: &Scene| {
        let found = critical_friction(scene, &[Slide; 2], [0.5, 2.0], [0.0, 1e4], &|_, _| {});
        found.unwrap().iter().map(|it| it.value).fold(f64::INFINITY, f64::min)
    };
    let before = onset(&scene);
    assert!((before - 1.1836).abs() < 1e-4, "{before}");
    let found = of(&scene, &varied, [0.0, 1.2 * before], 0.0685);
    assert!(found.is_kept && found.agreeing == [3, 3], "{found:?}");
    let designed = scene_at(&scene, &varied, &found.design.changes).unwrap();
    assert!(onset(&designed) >= 1.2 * before, "{}", onset(&designed));
    // Equal modules stay equal, and one percent of the stiffness is enough.
    for pair in found.design.changes[..16].chunks(2) {
        assert!((pair[0] - pair[1]).abs() < 1e-4 && pair[0].abs() < 0.01, "{pair:?}");
    }
}

/// Uniform sliding of Set 2 is stable at µ = 1.96, and pushes lead to squeal. The design has no growing mode in any contact state,
/// and pushes lead to rest.
#[test]
fn set_2_loses_its_second_motion_where_no_contact_state_has_a_growing_mode() {
    let folder = folder();
    let masses_and_springs: Vec<String> = ["m1", "m2", "k1", "k2", "k3", "k4", "k5", "k6"]
        .map(|name| format!("--vary=module[*].{name}=±20%"))
        .into();
    let mut arguments =
        vec!["study", "design", "set2", "--together", "--friction=1.96", "--state=all"];
    arguments.extend(masses_and_springs.iter().map(String::as_str));
    arguments.extend([
        "--vary=damping.beta=3e-5:9e-5",
        "--pushes=uniform(0,0.5)",
        "--runs=12",
        "--starts=2",
        "--points=1",
        "-o=out",
    ]);
    let output = amontons(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json = fs::read_to_string(folder.path().join("out/study.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let found = &json["results"]["found"];
    assert_eq!(found["is_kept"], true);
    assert_eq!(found["checked"]["remaining"], serde_json::json!([]));
    let share = |of: &str| found["checked"]["runs"][0][of]["probability"]["value"].as_f64();
    assert!(share("scene").unwrap() > 0.2, "{found}");
    assert_eq!(share("design"), Some(0.0));
    // The push of the scene's own file, after which Set 2 squeals for ever.
    let set = text(&output.stdout);
    let set = set.lines().find_map(|line| line.strip_prefix("the design, for any command: "));
    let set: Vec<&str> = set.unwrap().split_whitespace().map(|it| it.trim_matches('\'')).collect();
    let ends = |set: &[&str]| {
        let study = ["study", "limit-cycle", "set2", "--of=module[1].x1", "--anew", "-o=end"];
        let output = amontons(folder.path(), &[&study, set].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    assert!(ends(&[]).contains("periodic"), "{}", ends(&[]));
    let designed = ends(&set);
    assert!(designed.contains("equilibrium") && !designed.contains("periodic"), "{designed}");
}

#[test]
fn what_costs_more_changes_less() {
    let scene = builtin("set1").unwrap().scene();
    let given = ["module[*].k5=±5%", "module[*].k6=±5%"].map(|text| Vary::parse(text).unwrap());
    let changes = |costs: &[(String, f64)]| {
        let varied = varied(&scene, &given, true, costs).unwrap();
        of(&scene, &varied, [0.0, 1.3], 0.05).design.changes
    };
    let (same, dear) = (changes(&[]), changes(&[("module[*].k6".to_owned(), 3.0)]));
    assert!(dear[1].abs() < 0.3 * same[1].abs() && dear[0].abs() > 1.5 * same[0].abs());
}

#[test]
fn a_scene_that_keeps_the_limit_needs_no_change() {
    let scene = builtin("set1").unwrap().scene();
    let varied = varying(&scene, &["module[*].k6=±5%"], false);
    let found = of(&scene, &varied, [0.0, 1.18], 0.0);
    assert!(found.is_kept && found.starts.is_empty() && found.design.changes == [0.0; 2]);
}

#[test]
fn a_design_that_cannot_be_reached_is_told_as_such() {
    let scene = builtin("set1").unwrap().scene();
    let varied = varying(&scene, &["module[*].k6=±0.1%"], true);
    let found = of(&scene, &varied, [0.0, 1.4], 0.0);
    // The stiffest spring is the best there is.
    assert!(!found.is_kept && found.design.worst.growth > 0.0);
    assert_eq!(found.design.changes, [0.001]);
}

#[test]
fn designs_do_not_depend_on_the_number_of_threads() {
    let scene = builtin("set1").unwrap().scene();
    let varied = varying(&scene, &["module[*].k5=±5%", "module[*].k6=±5%"], false);
    let alone = on_this_thread(|| of(&scene, &varied, [0.0, 1.3], 0.05));
    assert_eq!(of(&scene, &varied, [0.0, 1.3], 0.05), alone);
}

#[test]
fn candidates_of_a_design_are_those_of_its_scene() {
    let scene = builtin("set2").unwrap().scene();
    let varied = varying(&scene, &["module[*].k6=±5%"], true);
    let found = of(&scene, &varied, [1.96; 2], 0.0);
    let remaining = found.checked.remaining.unwrap();
    let expected = candidates_at(&scene, Watch::IDLE).unwrap();
    assert_eq!(remaining.len(), expected.len());
}

#[test]
fn designs_that_make_no_sense_are_refused_with_what_would() {
    let folder = folder();
    let refused = |scene: &str, arguments: &[&str], words: &[&str]| {
        let all = [&["study", "design", scene, "-o", "none"], arguments].concat();
        assert_refused(&amontons(folder.path(), &all), 2, words);
        assert!(!folder.path().join("none").exists());
    };
    let (k6, mu) = ("--vary=module[*].k6=±5%", "--friction=0:1.4");
    refused("set1", &[mu], &["nothing may change", "--vary NAME=RANGE"]);
    refused("set1", &[k6], &["--friction"]);
    refused("set1", &[mu, "--vary=module[*].k6"], &["NAME=±20%"]);
    refused("set1", &[mu, "--vary=module[*].k6=5"], &["NAME=±20%"]);
    refused("set1", &[mu, "--vary=module[*].k9=±5%"], &["matches module[*].k9"]);
    refused("set1", &[mu, "--vary=module[1].k6=3:4"], &["does not contain the scene's own value"]);
    refused("set1", &[mu, "--vary=module[1].k6=±200%"], &["reaches -250000, which is impossible"]);
    refused("set1", &[mu, "--vary=friction.coefficient=±5%"], &["cannot be varied"]);
    refused("set1", &[mu, k6, "--vary=module[2].k6=±5%"], &["module[2].k6 is varied twice"]);
    refused("set1", &[mu, k6, "--cost=module[*].k5=2"], &["is not varied", "module[1].k6"]);
    refused("set1", &[mu, k6, "--cost=module[*].k6=0"], &["a factor from 0.001 to 1000"]);
    refused("set1", &[mu, k6, "--margin=-1"], &["--margin 0 or more"]);
    refused("set1", &[mu, k6, "--starts=0"], &["0 starts are not possible"]);
    refused("set1", &["--friction=1:0", k6], &["below the last"]);
    refused("set1", &["--friction=-1:1", k6], &["a friction coefficient of -1 is not possible"]);
    refused("ring12", &[mu, k6, "--state=all"], &["12 contacts", "name the states"]);
    refused(
        "den_hartog",
        &["--friction=0.1:0.2", "--vary=spring.*.stiffness=±5%"],
        &["den_hartog has signals", "--runs 0"],
    );
}
