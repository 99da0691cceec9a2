//! The page of `study report` for scenes that are not like a brake: parameters of zero, overdamped modes, many contacts; and the end of
//! its work by the user.

use super::study_report::{amontons, cells, page, report, study};
use crate::program::{folder, text};
use amontons::scene::builtin;
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A block on a belt whose own friction is zero, with a damper that is stronger than the critical one, 2 √(k m) = 200 N s/m.
const OVERDAMPED: &str = "slider = { velocity = 0.1, angle = 0.0 }\nfriction = { coefficient = 0.3 }\nintegrator = { step = 1e-5 }\n\
     mass = [{ name = \"block\", mass = 1.0, force = [0.0, -10.0] }]\n\
     spring = [{ name = \"hold\", between = [\"block\", \"ground\"], direction = \"x\", stiffness = 1e4 }]\n\
     damper = [{ name = \"loss\", between = [\"block\", \"ground\"], direction = \"x\", damping = 500.0 }]\n\
     contact = [{ name = \"belt\", mass = \"block\", friction = 0.0 }]\n";

/// Blocks on a belt, each with a spring and a friction coefficient of its own.
fn blocks(count: usize) -> String {
    let block = |i: usize| {
        format!(
            "[[mass]]\nname = \"m{i}\"\nmass = 1.0\nforce = [0.0, -10.0]\n\
             [[spring]]\nname = \"s{i}\"\nbetween = [\"m{i}\", \"ground\"]\ndirection = \"x\"\nstiffness = {}\n\
             [[contact]]\nname = \"c{i}\"\nmass = \"m{i}\"\nfriction = 0.3\n",
            10_000 + 200 * i
        )
    };
    let blocks: String = (0..count).map(block).collect();
    format!(
        "slider = {{ velocity = 0.1, angle = 0.0 }}\nfriction = {{ coefficient = 0.3 }}\nintegrator = {{ step = 1e-5 }}\n{blocks}"
    )
}

#[test]
fn one_unit_of_an_angle_of_zero_is_not_told_as_one_per_cent() {
    let folder = folder();
    report(folder.path(), &["set1", "--set=slider.angle=0", "--points=16"]);
    let page = page(folder.path());
    let has_angle = |rows: &[Vec<String>]| rows.iter().position(|row| row[0] == "slider.angle");
    let titles = page.match_indices("changes for +1 % of each parameter").count();
    assert!(titles > 0);
    for title in page.split("<span>").skip(1).map(|rest| rest.split("</span>").next().unwrap()) {
        if title.ends_with("changes for +1 % of each parameter") {
            assert_eq!(has_angle(&cells(&page, title)), None, "{title}");
        }
    }
    let unit = page.split("<span>").skip(1).map(|rest| rest.split("</span>").next().unwrap());
    let unit = unit.into_iter().find(|title| title.ends_with("of parameters that are 0 here"));
    let rows = cells(&page, unit.expect("a table of changes by units"));
    let angle = has_angle(&rows).expect("the angle has an effect");
    assert_eq!(rows[angle][1], "per rad");
    // The bars are for +1 %.
    let bars = page.split("<figure").find(|figure| figure.contains("what +1 % of each changes"));
    let bars = bars.unwrap().split("</figure>").next().unwrap();
    assert!(!bars.contains("slider.angle"));
}

#[test]
fn an_overdamped_mode_decays_without_being_called_divergence_and_friction_of_zero_is_shown() {
    let folder = folder();
    fs::write(folder.path().join("block.toml"), OVERDAMPED).unwrap();
    let told = report(folder.path(), &["block.toml", "--points=16"]);
    assert!(told.contains("without oscillating (overdamped), decays by 20.87 1/s"), "{told}");
    assert!(!told.contains("divergence"), "{told}");
    let values = cells(&page(folder.path()), "Values of the scene");
    assert!(
        values.contains(&vec!["contact.belt.friction".to_owned(), "0".to_owned()]),
        "{values:?}"
    );
}

/// Of the two modes in a scene without damping none decays, so that the page must not say that motions die out.
#[test]
fn a_scene_without_damping_is_not_said_to_let_motions_die_out() {
    let folder = folder();
    let undamped = OVERDAMPED.replace("damping = 500.0", "damping = 0.0");
    fs::write(folder.path().join("block.toml"), undamped).unwrap();
    let told = report(folder.path(), &["block.toml", "--points=16"]);
    assert!(told.contains("neither grows nor decays, since nothing damps it"), "{told}");
    let page = page(folder.path());
    assert!(!page.contains("mall motions die out") && page.contains("o small motion grows"));
    assert!(!page.contains("−0.000 %"));
}

/// A scramble has at most 128 coordinates, and 43 blocks have 129 values.
#[test]
fn values_of_one_kind_scatter_together_where_there_are_too_many() {
    let folder = folder();
    fs::write(folder.path().join("many.toml"), blocks(43)).unwrap();
    let told = report(folder.path(), &["many.toml", "--points=16"]);
    assert!(
        told.contains("all of one kind by the same part (assumed standard deviations)"),
        "{told}"
    );
    let page = page(folder.path());
    assert!(page.contains("change by the same part of themselves here: 3 draws"));
    let rows = cells(&page, "What scatters");
    assert_eq!(rows[0][..2], ["contact.*.friction", "together normal(±10%)"]);
    // The command that repeats it takes the same words.
    let command = "--uncertain &apos;mass.*.mass=together normal(±5%)&apos;";
    assert!(page.contains(command));
    let command = ["study", "robustness", "many.toml", "--points=16", "-o=again"];
    let scatter = [
        "--uncertain=contact.*.friction=together normal(±10%)",
        "--uncertain=mass.*.mass=together normal(±5%)",
        "--uncertain=spring.*.stiffness=together normal(±5%)",
    ];
    let output = amontons(folder.path(), &[&command[..], &scatter].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let again: Value = study(folder.path(), "again");
    assert_eq!(study(folder.path(), "out")["robustness"], again["eigenvalues"]);
}

/// A mass with two springs, and one above it, whose spring between them makes a mode grow from µ = 0.3066 to 0.407.
const ISLAND: &str = "slider = { velocity = 0.1, angle = 0.0 }\nfriction = { coefficient = 0.35 }\nintegrator = { step = 1e-5 }\n\
     damping = { beta = 1e-6 }\n\
     mass = [{ name = \"a\", mass = 1.0, force = [0.0, -50.0] }, { name = \"b\", mass = 1.0, locked = [\"x\"] }]\n\
     spring = [{ name = \"ka\", between = [\"a\", \"ground\"], direction = \"x\", stiffness = 1e4 },\n\
     { name = \"kb\", between = [\"a\", \"ground\"], direction = 0.785398, stiffness = 2e4 },\n\
     { name = \"kc\", between = [\"b\", \"ground\"], direction = \"y\", stiffness = 1.5e4 },\n\
     { name = \"kd\", between = [\"a\", \"b\"], direction = 1.4, stiffness = 1500.0 }]\n\
     contact = [{ name = \"ca\", mass = \"a\" }]\n";

/// After 10 % more of a mass the range of growth lies below the scene's µ.
#[test]
fn a_range_without_growth_after_a_change_begins_at_the_friction_of_the_scene() {
    let folder = folder();
    fs::write(folder.path().join("island.toml"), ISLAND).unwrap();
    let told = report(folder.path(), &["island.toml", "--points=16"]);
    let mass = told.lines().find(|line| line.contains("mass.a.mass +10 %:")).unwrap();
    assert!(mass.contains("no mode grows from µ = 0.35 to 0.525;"), "{told}");
    let rows = cells(&page(folder.path()), "Changes of the most effective");
    let mass = rows.iter().find(|row| row[0] == "mass.a.mass +10 %").unwrap();
    assert_eq!(mass[4], "not from 0.35 to 0.525");
    // The statement is one on this range: below it a mode grows after the change.
    let below = ["study", "report", "island.toml", "--set=mass.a.mass=1.1", "-o=heavy"];
    let output = amontons(folder.path(), &[&below[..], &["--points=16"]].concat());
    assert!(text(&output.stdout).contains("At smaller µ a mode grows"));
}

/// Runs `study report` until it tells the progress of a part, and ends it as Ctrl-C does. Nothing may be left of it.
fn assert_ends(scene: &str, more: &[&str], part: &str) {
    let folder = folder();
    fs::write(folder.path().join("mine.toml"), scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command
        .current_dir(folder.path())
        .args(["study", "report", "mine.toml", "-o", "out"])
        .args(more);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap());
    let mut all = String::new();
    while !all.contains(part) {
        assert!(told.read_line(&mut all).unwrap() > 0, "it ended before it told of {part}: {all}");
    }
    let (id, begun) = (child.id().to_string(), Instant::now());
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    told.read_to_string(&mut all).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{all}");
    assert!(all.contains("interrupted"), "{all}");
    assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    assert!(!folder.path().join("out").exists());
}

/// The search for candidates among the 4^8 contact states of eight modules takes long where not all modules are equal.
#[test]
fn the_search_for_candidates_of_a_report_is_ended_by_ctrl_c() {
    let ring = builtin("set2").unwrap().text.replace("modules = 2", "modules = 8");
    let set = ["--set=friction.coefficient=1", "--set=module[1].k6=3e4", "--set=module[2].k6=4e4"];
    assert_ends(&ring, &set, "the candidates: ");
}

/// Of 130 equal blocks all modes have one eigenvalue, of which the derivatives by 390 parameters take half a minute.
#[test]
fn derivatives_that_take_long_are_ended_by_ctrl_c() {
    let blocks = blocks(130);
    let equal = blocks.lines().map(|line| match line.split_once(" = ") {
        Some(("stiffness", _)) => "stiffness = 10000\n".to_owned(),
        _ => format!("{line}\n"),
    });
    assert_ends(&equal.collect::<String>(), &[], "uniform sliding: ");
}
