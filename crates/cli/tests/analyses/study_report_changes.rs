//! Changes on the page of `study report`: what follows from them is that of the changed scene, and the command that finds a design runs.

use super::study_report::{amontons, cells, page, report, study};
use crate::program::{folder, text};
use serde_json::Value;

const QUICK: [&str; 2] = ["disc_brake", "--points=64"];

#[test]
fn a_changed_scene_is_as_probably_unstable_as_the_single_command_says() {
    let folder = folder();
    let told = report(folder.path(), &QUICK);
    let after = study(folder.path(), "out")["after_changes"].clone();
    let changes = study(folder.path(), "out")["sliding"]["changes"].clone();
    let all = after["unstable"].as_array().unwrap();
    assert_eq!(all.len(), 4);
    let place = usize::try_from(all[0]["change"].as_u64().unwrap()).unwrap();
    assert_eq!(changes[place]["parameters"], serde_json::json!([["mass.disc.mass", -0.1]]));
    assert_eq!(all[0]["unknown"], Value::Null);
    let found = &all[0]["probability"];
    let command = [
        "study",
        "robustness",
        "disc_brake",
        "--points=64",
        "--no-indices",
        "--set=mass.disc.mass=1.08",
        "--uncertain=friction.coefficient=normal(±10%)",
        "--uncertain=mass.*.mass=normal(±5%)",
        "--uncertain=spring.*.stiffness=normal(±5%)",
        "-o=changed",
    ];
    let output = amontons(folder.path(), &command);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(found, &study(folder.path(), "changed")["eigenvalues"]["unstable"]);
    assert!(told.contains("; P(unstable) with the same scatter "), "{told}");
    // A change that the beginning of the page does not name has none.
    let rows = cells(&page(folder.path()), "Changes of the most effective");
    assert!(rows[place][5].contains(" % (") && rows[0][5] == "–", "{rows:?}");
}

/// Ten per cent less of the disc's mass stops all growth, so that the small start along the mode dies out.
#[test]
fn the_motion_after_the_change_that_helps_most_is_followed_from_the_same_start() {
    let folder = folder();
    let told = report(folder.path(), &QUICK);
    let motion: Value = study(folder.path(), "out")["after_changes"]["motion"].clone();
    assert_eq!((&motion["start"], &motion["after"]), (&"mode 3".into(), &"rests".into()));
    let loud = &study(folder.path(), "out")["loudness"]["motions"][0]["measured"]["points"];
    let speeds = loud.as_array().unwrap().iter().map(|point| point["rms"].as_f64().unwrap());
    assert_eq!(motion["before"].as_f64().unwrap(), speeds.fold(0.0, f64::max));
    assert!(told.contains("from the same start, along mode 3, comes to rest"), "{told}");
    // At this µ no single change stops the growth: the same start still squeals, as loudly as the changed scene does.
    let set = ["disc_brake", "--set=friction.coefficient=0.9", "--points=16"];
    let told = report(folder.path(), &[&set[..], &["--anew"]].concat());
    let motion: Value = study(folder.path(), "out")["after_changes"]["motion"].clone();
    let after = motion["after"]["lasts"].as_f64().unwrap();
    assert!(told.contains("still leads to a lasting motion"), "{told}");
    let place = usize::try_from(motion["change"].as_u64().unwrap()).unwrap();
    let change = study(folder.path(), "out")["sliding"]["changes"][place].clone();
    let name = change["parameters"][0][0].as_str().unwrap();
    let set = format!("--set={name}={}", change["values"][0][1]);
    let command =
        ["study", "loudness", "disc_brake", "--set=friction.coefficient=0.9", &set, "-o=changed"];
    assert!(amontons(folder.path(), &command).status.success());
    let found = study(folder.path(), "changed");
    let motions = found["found"]["motions"].as_array().unwrap();
    let points = motions.iter().filter_map(|it| it["measured"]["points"].as_array()).flatten();
    let largest = points.map(|it| it["rms"].as_f64().unwrap()).fold(0.0, f64::max);
    assert!((after / largest - 1.0).abs() < 1e-3, "{after} {largest}");
}

#[test]
fn a_scatter_that_the_change_does_not_move_is_told() {
    let folder = folder();
    let scatter = "--uncertain=mass.disc.mass=normal(1.2,0.06)";
    report(folder.path(), &["disc_brake", "--points=16", scatter]);
    let page = page(folder.path()).replace("<wbr>", "");
    assert!(page.contains(
        "mass.disc.mass scatters about a value that is given for it, which the change does not move"
    ));
}

/// Modes are numbered by frequency at the scene's µ. At µ = 0 the lowest of the disc brake is another one: the modes at 1011 and
/// 1125 Hz have changed places at µ = 0.6.
#[test]
fn modes_over_friction_have_the_numbers_of_the_table() {
    let folder = folder();
    report(folder.path(), &QUICK);
    let page = page(folder.path());
    let modes = cells(&page, "Modes of uniform sliding");
    let curves = cells(&page, "Curves over friction coefficient");
    let own = curves.iter().min_by(|a, b| {
        let miss = |row: &[String]| (row[0].parse::<f64>().unwrap() - 0.6).abs();
        miss(a).total_cmp(&miss(b))
    });
    let own = own.unwrap();
    assert_eq!(own.len(), 7);
    for (mode, row) in modes.iter().enumerate() {
        let at_own: f64 = own[4 + mode].parse().unwrap();
        let frequency: f64 = row[1].parse().unwrap();
        assert!((at_own - frequency).abs() < 2.0, "{row:?} {own:?}");
    }
    let first = |column: usize| curves[0][column].parse::<f64>().unwrap();
    assert!(first(4) > first(5), "the first mode is not the lowest one at µ = 0");
}

#[test]
fn the_command_that_finds_a_design_runs_as_it_is_printed() {
    let folder = folder();
    report(folder.path(), &QUICK);
    let page = page(folder.path()).replace("&apos;", "'");
    let command = page.lines().find_map(|line| line.split("amontons study design ").nth(1));
    let command = command.expect("a command that finds a design");
    let words: Vec<String> = command.split_whitespace().map(|it| it.replace('\'', "")).collect();
    assert_eq!(words[..3], ["disc_brake", "--vary", "mass.disc.mass=±10%"]);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let quick = ["--starts=1", "--points=0", "--runs=0", "-o=design"];
    let output = amontons(folder.path(), &[&["study", "design"], &words[..], &quick].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("the design, for any command: --set 'mass.disc.mass="));
}
