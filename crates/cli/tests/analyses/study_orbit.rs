//! Tests of the commands for periodic motions and their branches.

use crate::program::{assert_refused, folder, run, text};
use amontons::scene::parse;
use amontons::simulation::Simulation;
use std::io::Read;
use std::path::Path;
use std::process::Output;

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

/// The rows of a CSV file below its head.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// The motion between rest and squeal, from a boundary, is where the branch of another command begins; that branch passes
/// both folds of Set 2.
#[test]
fn an_unstable_orbit_from_a_boundary_begins_the_branch_that_joins_both_folds() {
    let folder = folder();
    let here = folder.path();
    let found =
        amontons(here, &["study", "orbit", "set2", "--between", "module[1].v2=0.1:0.5", "-o", "u"]);
    let told = text(&found.stdout);
    assert!(found.status.success(), "{}", text(&found.stderr));
    assert!(told.contains("unstable; largest multiplier 1.018840"), "{told}");
    assert_eq!(rows(&here.join("u/results.csv")).len(), 4);
    let arguments = [
        "study",
        "branches",
        "set2",
        "--from",
        "u/orbit.json",
        "--parameter",
        "friction.coefficient=1.9:2.2",
        "-o",
        "b",
    ];
    let found = amontons(here, &arguments);
    let told = text(&found.stdout);
    assert!(found.status.success(), "{}", text(&found.stderr));
    for part in ["2.0749417244", "1.93188033109", "neutral cycles"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let specials = rows(&here.join("b/specials.csv"));
    assert_eq!(specials.iter().filter(|row| row[2] == "\"fold\"").count(), 2);
    assert!(here.join("b/branches.svg").exists());
    let defects = rows(&here.join("b/results.csv"));
    assert!(defects.len() > 20);
    for row in defects {
        let defect: f64 = row[7].parse().unwrap();
        assert!(defect < 1e-9, "{row:?}");
    }
    // The same command reads the finished branch from its journal.
    assert_eq!(text(&amontons(here, &arguments).stdout), told);
}

/// The mode that begins to grow at 2.0626 leads to the branch that begins there.
#[test]
fn a_mode_of_sliding_just_above_its_critical_value_leads_to_the_branch_that_begins_there() {
    let folder = folder();
    let arguments = [
        "study",
        "branches",
        "set2",
        "--set",
        "friction.coefficient=2.064",
        "--mode",
        "4",
        "--parameter",
        "friction.coefficient=2.0:2.08",
        "-o",
        "m",
    ];
    let found = amontons(folder.path(), &arguments);
    let told = text(&found.stdout);
    assert!(found.status.success(), "{}", text(&found.stderr));
    for part in ["begins at 2.0625655", "2.0749417244", "neutral cycles"] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn starts_and_parameters_that_make_no_sense_are_refused_with_what_would() {
    let folder = folder();
    let here = folder.path();
    std::fs::write(here.join("no.json"), "{}").unwrap();
    let refused = |arguments: &[&str], code: i32, words: &[&str]| {
        let mut all = vec!["study"];
        all.extend(arguments);
        assert_refused(&amontons(here, &all), code, words);
    };
    refused(&["orbit", "set2", "--from", "no.json"], 1, &["no orbit"]);
    refused(&["orbit", "set2", "--mode", "9"], 2, &["6 oscillating modes", "no mode 9"]);
    let initial = "initial.module[1].v2=0:1";
    refused(&["branches", "set2", "--parameter", initial], 2, &["do not depend on initial values"]);
    refused(&["branches", "set2", "--parameter", "friction.coeficient=1:2"], 2, &["did you mean"]);
    refused(&["branches", "set2", "--parameter", "friction.coefficient=2:1"], 2, &["below"]);
    refused(
        &["branches", "set2", "--parameter", "friction.coefficient=1:2", "--of", "module[1].v1"],
        2,
        &["no displacement"],
    );
    refused(
        &["orbit", "set2", "--integrator", "forward-increment", "--step", "1e-6"],
        3,
        &["event-driven"],
    );
}

/// A run that begins on an orbit is back after each period, on an unstable one until rounding has grown.
#[test]
fn a_run_begins_on_an_orbit_and_comes_back_after_each_period() {
    let folder = folder();
    let here = folder.path();
    let found =
        amontons(here, &["study", "orbit", "set2", "--between", "module[1].v2=0.1:0.5", "-o", "u"]);
    assert!(found.status.success(), "{}", text(&found.stderr));
    let orbit = std::fs::read_to_string(here.join("u/orbit.json")).unwrap();
    let orbit: serde_json::Value = serde_json::from_str(&orbit).unwrap();
    let period = orbit["period"].as_f64().unwrap();
    let [interval, stop] = [period, 20.0 * period].map(|time| format!("{time:?}"));
    let arguments = [
        "simulate",
        "set2",
        "--from",
        "u/orbit.json",
        "--integrator",
        "event-driven",
        "--step",
        "2e-4",
        "--output-interval",
        &interval,
        "--stop-time",
        &stop,
        "-o",
        "run.csv",
    ];
    let run = amontons(here, &arguments);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let rows = rows(&here.join("run.csv"));
    assert_eq!(rows.len(), 21);
    let first = orbit["displacement"][0].as_f64().unwrap();
    for row in rows {
        let x: f64 = row[1].parse().unwrap();
        assert!((x - first).abs() < 1e-9 * first.abs(), "{row:?}");
    }
}

/// The scene in an FMU.
fn scene_of(fmu: &Path) -> String {
    let mut archive = zip::ZipArchive::new(std::fs::File::open(fmu).unwrap()).unwrap();
    let mut text = String::new();
    archive.by_name("resources/scene.toml").unwrap().read_to_string(&mut text).unwrap();
    text
}

/// An FMU that is exported from an orbit is back after each period, free or driven, and keeps to its own initial values. An
/// orbit of other values is refused by the export and by a run.
#[test]
fn an_exported_orbit_comes_back_and_one_of_other_values_is_refused() {
    let folder = folder();
    let here = folder.path();
    let found = |scene: &str, set: &[&str], to: &str| {
        let of = amontons(here, &[&["study", "orbit", scene, "-o", to], set].concat());
        assert!(of.status.success(), "{}", text(&of.stderr));
        let orbit = std::fs::read_to_string(here.join(to).join("orbit.json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&orbit).unwrap()
    };
    let unstable = ["--between", "module[1].v2=0.1:0.5"];
    let squeal = ["--set", "initial.module[1].v2=0.5"];
    for (scene, set) in [("set2", &unstable[..]), ("set2", &squeal), ("den_hartog", &[])] {
        let orbit = found(scene, set, "known");
        std::fs::rename(here.join("known/orbit.json"), here.join("orbit.json")).unwrap();
        std::fs::remove_dir_all(here.join("known")).unwrap();
        let export = ["export", scene, "--from", "orbit.json", "-o", "on.fmu"];
        let exact = ["--integrator", "event-driven", "--step", "1e-4"];
        let export = amontons(here, &[&export[..], &exact].concat());
        assert!(export.status.success(), "{}", text(&export.stderr));
        let mut simulation =
            Simulation::new(parse(scene, &scene_of(&here.join("on.fmu"))).unwrap(), 0.0).unwrap();
        let numbers = |key: &str| -> Vec<f64> {
            let all = orbit[key].as_array().unwrap();
            all.iter().map(|number| number.as_f64().unwrap()).collect()
        };
        let (first, size) = (numbers("displacement"), numbers("extents")[0]);
        for period in 1..=5 {
            let time = f64::from(period) * orbit["period"].as_f64().unwrap();
            simulation.advance_to(time).unwrap();
            for (x, first) in simulation.displacement().iter().zip(&first) {
                assert!((x - first).abs() < 1e-9 * size, "{scene}, period {period}: {x}, {first}");
            }
        }
    }
    found("set2", &[&squeal[..], &["--set", "friction.coefficient=2"]].concat(), "other");
    for command in ["export", "simulate"] {
        let refused = amontons(here, &[command, "set2", "--from", "other/orbit.json", "-o", "no"]);
        assert_refused(&refused, 1, &["no motion of set2 as it is", "study.json"]);
    }
    assert!(!here.join("no").exists());
}

/// Under a sine that begins at 5 s an orbit is found, but a run from 0 s is not on it, and no branch follows it. Both
/// refusals tell the sine that is the same from 0 s on, and with it the run stays on the orbit.
#[test]
fn a_sine_that_begins_later_is_named_with_the_one_that_would_be_right() {
    let folder = folder();
    let here = folder.path();
    let shown = amontons(here, &["scenes", "show", "den_hartog"]);
    let scene = text(&shown.stdout);
    let sine = "amplitude = 10.0, frequency = 2.5";
    assert!(scene.contains(sine));
    let with = |more: &str| scene.replace(sine, &format!("{sine}, {more}"));
    std::fs::write(here.join("late.toml"), with("start = 5.3, phase = 0.2")).unwrap();
    let found = amontons(here, &["study", "orbit", "late.toml", "-o", "known"]);
    assert!(found.status.success(), "{}", text(&found.stderr));
    let exact = ["--integrator", "event-driven", "--step", "1e-2", "--stop-time", "2"];
    let run = |scene: &str| {
        let from = ["simulate", scene, "--from", "known/orbit.json", "-o", "run.csv"];
        amontons(here, &[&from[..], &exact].concat())
    };
    let named = "signal[1] on mass.block.fx is a sine that begins at 5.3 s";
    let refused = run("late.toml");
    assert_refused(&refused, 1, &["known/orbit.json", "the run begins at 0 s", named]);
    let parameter = ["--parameter", "friction.coefficient=0.2:0.4"];
    let branches = [&["study", "branches", "late.toml", "-o", "no"], &parameter[..]].concat();
    assert_refused(&amontons(here, &branches), 3, &[named, "start = 0.0 and phase = "]);
    let message = text(&refused.stderr);
    let (_, right) = message.split_once("start = 0.0 and ").unwrap();
    let (right, _) = right.split_once(" in its place").unwrap();
    std::fs::write(here.join("right.toml"), with(right)).unwrap();
    let on_orbit = run("right.toml");
    assert!(on_orbit.status.success(), "{}", text(&on_orbit.stderr));
}

/// The quasi-static ways of the same scene are laid behind its branches; those of another scene, other values, another
/// parameter or another output are refused.
#[test]
fn the_quasi_static_ways_are_laid_behind_the_branches_of_the_same_scene_alone() {
    let folder = folder();
    let here = folder.path();
    let friction = ["--friction", "2.1:2.2:0.1", "--resolution", "0.05", "-o", "ways"];
    let ways = amontons(here, &[&["study", "continuation", "set2"], &friction[..]].concat());
    assert!(ways.status.success(), "{}", text(&ways.stderr));
    let branches = |scene: &str, parameter: &str, more: &[&str]| {
        let over = ["--parameter", parameter, "--over", "ways", "-o", "laid"];
        amontons(here, &[&["study", "branches", scene], &over[..], more].concat())
    };
    let friction = "friction.coefficient=2.05:2.25";
    let laid = branches("set2", friction, &["--set", "initial.module[1].v2=0.5"]);
    assert!(laid.status.success(), "{}", text(&laid.stderr));
    let picture = std::fs::read_to_string(here.join("laid/branches.svg")).unwrap();
    for way in ["quasi-static, rising", "quasi-static, falling"] {
        assert!(picture.contains(way), "{way}");
    }
    let refused = |scene: &str, parameter: &str, more: &[&str], words: &[&str]| {
        assert_refused(&branches(scene, parameter, more), 1, words);
    };
    refused("set1", friction, &[], &["of another scene"]);
    refused("set2", friction, &["--set", "slider.velocity=0.03"], &["other values"]);
    refused("set2", friction, &["--of", "module[1].x2"], &["module[1].x1", "--of"]);
    refused("set2", "slider.velocity=0.01:0.05", &[], &["over slider.velocity"]);
    let no_ways = ["study", "branches", "set2", "--parameter", friction, "--over", "laid"];
    assert_refused(&amontons(here, &no_ways), 1, &["study continuation"]);
}

/// A run that begins with an orbit, or with a motion that is nearly one, needs gaps of exactly zero.
#[test]
fn the_motion_at_which_newtons_method_ended_is_saved_and_is_a_start() {
    let folder = folder();
    let here = folder.path();
    let squeal = ["study", "orbit", "set2", "--set", "initial.module[1].v2=0.5", "-o", "squeal"];
    let found = amontons(here, &squeal);
    assert!(found.status.success(), "{}", text(&found.stderr));
    assert!(!text(&found.stdout).contains("in one period"), "{}", text(&found.stdout));
    assert!(!here.join("squeal/best.json").exists());
    // The branch of this motion turns back at 1.93188.
    let from = "squeal/orbit.json";
    let below =
        ["study", "orbit", "set2", "--from", from, "--set", "friction.coefficient=1.9", "-o", "no"];
    let best = Path::new("no").join("best.json").display().to_string();
    assert_refused(&amontons(here, &below), 3, &["Newton's method ended", &best, "--from"]);
    let found = amontons(here, &["study", "orbit", "set2", "--from", &best, "-o", "back"]);
    assert!(found.status.success(), "{}", text(&found.stderr));
    // A run begins on an orbit only.
    let run = |start: &str| {
        let arguments = ["--stop-time", "0.01", "--integrator", "event-driven", "--step", "2e-4"];
        amontons(
            here,
            &[&["simulate", "set2", "--from", start, "-o", "run.csv"], &arguments[..]].concat(),
        )
    };
    assert_refused(&run(&best), 1, &["no motion of set2 as it is"]);
    let found = run("back/orbit.json");
    assert!(found.status.success(), "{}", text(&found.stderr));
}

/// In one period of stick and slip the block slips as far as the belt moves, and the belt does all the work.
#[test]
fn a_scene_with_a_ledger_has_the_energy_of_one_period() {
    let folder = folder();
    let here = folder.path();
    let shown = amontons(here, &["scenes", "show", "stick_slip"]);
    let scene = format!("{}\n[effects]\nenergy = true\n", text(&shown.stdout));
    std::fs::write(here.join("energy.toml"), scene).unwrap();
    let found = amontons(here, &["study", "orbit", "energy.toml", "-o", "e"]);
    let told = text(&found.stdout);
    assert!(found.status.success(), "{}", text(&found.stderr));
    for part in [
        "in one period [J]",
        "work of sliders           3.227555",
        "work of forces            0.0",
        "lost in damping           0.0",
        "lost in friction          3.227555",
        "lost in impacts           0.0",
        "losses less work",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let orbit = std::fs::read_to_string(here.join("e/orbit.json")).unwrap();
    let orbit: serde_json::Value = serde_json::from_str(&orbit).unwrap();
    let friction = orbit["energy"]["friction"].as_f64().unwrap();
    let wanted = 0.4 * 10.0 * 0.1 * orbit["period"].as_f64().unwrap();
    assert!((friction / wanted - 1.0).abs() < 1e-11, "{friction} {wanted}");
}
