//! Basins: what is decided early is what settling says, and the plane has the symmetry of the scene.

use crate::program::{assert_refused, folder, run, text};
use Coverage::{EveryPoint, EveryPointSettled, Traced};
use amontons::scene::{Scene, builtin, parse};
use amontons_analysis::assign::assign;
use amontons_analysis::study::basin::{Axis, Basin, Coverage, basin};
use amontons_analysis::study::perturbation::{Direction, perturbation};
use amontons_analysis::study::{Journal, Kind, ObservationRequest, ObservationSettings, Watch};
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

const V1: &str = "initial.module[1].v2";
const V2: &str = "initial.module[2].v2";

fn set2() -> Scene {
    let mut scene = builtin("set2").unwrap().scene();
    assign(&mut scene, V1, 0.0).unwrap();
    scene.step = 2e-5;
    scene
}

fn axis(name: &str, last: f64, count: u32) -> Axis {
    let at = |i| last * (2.0 * f64::from(i) / f64::from(count - 1) - 1.0);
    Axis { name: name.to_owned(), values: (0..count).map(at).collect() }
}

fn of(scene: &Scene, axes: [&Axis; 2], coverage: Coverage) -> Basin {
    let observation = ObservationSettings::of(scene, &ObservationRequest::default()).unwrap();
    basin(scene, axes, &observation, coverage, &Journal::forgotten(), Watch::IDLE).unwrap().unwrap()
}

/// The kind of motion of each cell, in rows.
fn kinds(basin: &Basin) -> Vec<Vec<Kind>> {
    let kind =
        |place: Option<usize>| place.map_or(Kind::Unsettled, |place| basin.attractors[place].kind);
    basin.rows.iter().map(|row| row.iter().map(|cell| kind(cell.attractor)).collect()).collect()
}

#[test]
fn what_is_decided_early_is_what_settling_says() {
    let scene = set2();
    let axes = [&axis(V1, 0.3, 12), &axis(V2, 0.25, 11)];
    let (early, settled) = (of(&scene, axes, EveryPoint), of(&scene, axes, EveryPointSettled));
    let cells = || early.rows.iter().zip(&settled.rows).flat_map(|(a, b)| a.iter().zip(b));
    for (a, b) in cells() {
        assert_eq!((a.attractor, &a.failure), (b.attractor, &b.failure));
        assert!(!b.early);
    }
    assert_eq!(early.attractors.len(), settled.attractors.len());
    // Else the comparison would say little.
    let count = |attractor| cells().filter(|(cell, _)| cell.attractor == Some(attractor)).count();
    assert!(count(0) > 10 && count(1) > 10, "{:?}", [count(0), count(1)]);
    // All but the 36 that were followed first.
    assert!(cells().filter(|(cell, _)| cell.early).count() > 90);
}

/// Two masses on springs with five motions that go on for ever, two of them with nearly one frequency (4.48 and 4.52 Hz)
/// and, root mean square, one size: 6.33 and 9.28 mm at the most.
#[test]
fn a_motion_on_its_way_to_one_cycle_is_not_taken_for_another_of_nearly_its_size_and_frequency() {
    let scene = parse(
        "two",
        "slider = { velocity = 0.2, angle = 0.0 }\n\
         friction = { coefficient = 0.25, static = 0.5 }\n\
         integrator = { method = \"event-driven\", step = 2e-3 }\n\
         mass = [{ name = \"m\", mass = 1.0, force = [0.0, -20.0] },\n\
         { name = \"p\", mass = 0.6, force = [0.0, -25.0] }]\n\
         spring = [{ name = \"k\", between = [\"m\", \"ground\"], direction = \"x\", stiffness = 1.0e3 },\n\
         { name = \"kk\", between = [\"m\", \"p\"], direction = \"x\", stiffness = 1.2e3 },\n\
         { name = \"kp\", between = [\"p\", \"ground\"], direction = \"x\", stiffness = 0.4e3 }]\n\
         damper = [{ name = \"d\", between = [\"m\", \"ground\"], direction = \"x\", damping = 3.0 }]\n\
         contact = [{ name = \"c\", mass = \"m\" }, { name = \"cp\", mass = \"p\" }]\n",
    )
    .unwrap();
    let x = axis("initial.mass.m.x", 0.012, 13);
    let y = axis("initial.mass.p.vx", 0.3, 2);
    let [early, settled] =
        [EveryPoint, EveryPointSettled].map(|coverage| of(&scene, [&x, &y], coverage));
    let amplitude = |basin: &Basin, row: usize, column: usize| {
        basin.attractors[basin.rows[row][column].attractor.unwrap()].amplitude
    };
    for row in 0..2 {
        for column in 0..13 {
            let [found, expected] = [&early, &settled].map(|basin| amplitude(basin, row, column));
            assert!((found - expected).abs() <= 1e-2 * expected.max(1e-6), "{row} {column}");
        }
    }
    // From x = −2 mm with 0.3 m/s: 9.276 mm by a Runge–Kutta method of order 8 that looks for events.
    assert!((amplitude(&early, 1, 5) - 9.276e-3).abs() < 1e-5);
    assert!(early.rows.iter().flatten().filter(|cell| cell.early).count() > 8);
}

#[test]
fn a_row_of_the_plane_ends_as_its_points_do_by_themselves() {
    let mut scene = set2();
    let (x, y) = (axis(V1, 0.3, 7), axis(V2, 0.25, 3));
    let plane = of(&scene, [&x, &y], EveryPoint);
    assign(&mut scene, V2, y.values[2]).unwrap();
    let direction =
        Direction { name: x.name.clone(), amplitudes: x.values.clone(), resolution: 0.99 };
    let observation = ObservationSettings::of(&scene, &ObservationRequest::default()).unwrap();
    let journal = Journal::forgotten();
    let single =
        perturbation(&scene, &direction, &observation, &journal, Watch::IDLE).unwrap().unwrap();
    for (value, kind) in x.values.iter().zip(&kinds(&plane)[2]) {
        let run = single.runs.iter().find(|run| run.amplitude == *value).unwrap();
        assert_eq!(run.ending.as_ref().unwrap().kind, *kind, "{value}");
    }
}

#[test]
fn a_plane_that_is_traced_is_the_plane_of_all_points() {
    let scene = set2();
    let axes = [&axis(V1, 0.3, 26), &axis(V2, 0.25, 23)];
    let [traced, every] = [Traced([4, 4]), EveryPoint].map(|coverage| of(&scene, axes, coverage));
    assert_eq!(traced.attractors, every.attractors);
    let (mut run, mut all) = (0, 0);
    for (traced, every) in traced.rows.iter().flatten().zip(every.rows.iter().flatten()) {
        assert_eq!(traced.attractor, every.attractor);
        assert!(every.run && (traced.run || (!traced.early && traced.attractor.is_some())));
        (run, all) = (run + u32::from(traced.run), all + 1);
    }
    assert!(4 * run < all, "{run} of {all}");
}

/// The modules of Set 2 are equal: to push one instead of the other changes names alone.
#[test]
fn exchanging_the_modules_of_set_2_mirrors_the_plane() {
    let plane = of(&set2(), [&axis(V1, 0.3, 8), &axis(V2, 0.3, 8)], EveryPoint);
    let kinds = kinds(&plane);
    for (row, cells) in kinds.iter().enumerate() {
        for (column, kind) in cells.iter().enumerate() {
            assert_eq!(*kind, kinds[column][row], "{column} {row}");
        }
    }
    for is_cycle in [true, false] {
        let alike = kinds.iter().flatten().filter(|kind| kind.is_cycle() == is_cycle);
        assert!(alike.count() > 8);
    }
}

/// A scene in which every motion ends at rest.
#[test]
fn a_plane_without_a_cycle_is_all_rest() {
    let mut scene = set2();
    scene.friction_coefficient = 0.5;
    let plane = of(&scene, [&axis(V1, 0.3, 4), &axis("module[1].x2", 1e-3, 3)], EveryPoint);
    assert!(plane.rows.iter().flatten().all(|cell| cell.attractor == Some(0)));
    assert_eq!((plane.attractors.len(), plane.attractors[0].kind), (1, Kind::Equilibrium));
}

const PLANE: [&str; 8] = [
    "study",
    "basin",
    "set2",
    "--step=2e-5",
    "--x=module[1].v2=-0.3:0.3/24",
    "--y=module[2].v2=-0.3:0.3/24",
    "--pictures=png",
    "-o",
];

fn all<'a>(folder: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&PLANE[..], &[folder], more].concat()
}

#[test]
fn an_interrupted_plane_is_finished_as_if_it_had_not_been() {
    let folder = folder();
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.current_dir(folder.path()).args(all("cut", &[]));
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let journal = folder.path().join("cut/journal.jsonl");
    let lines = || fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    let begun = Instant::now();
    while lines() < 2 && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(2));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_refused(
        &output,
        130,
        &["finished piece", "kept in", "journal.jsonl", "continues from there"],
    );
    assert!(!folder.path().join("cut/results.csv").exists());
    let kept = lines();

    let again = amontons(folder.path(), &all("cut", &[]));
    assert!(again.status.success(), "{}", text(&again.stderr));
    let whole = amontons(folder.path(), &all("whole", &[]));
    for file in ["results.csv", "basin.png"] {
        let read = |of: &str| fs::read(folder.path().join(of).join(file)).unwrap();
        assert!(read("cut") == read("whole"), "{file}");
    }
    let printed = |output: &Output, of: &str| text(&output.stdout).replace(of, "");
    assert_eq!(printed(&again, "cut"), printed(&whole, "whole"));
    let pieces = fs::read_to_string(folder.path().join("whole/journal.jsonl")).unwrap();
    assert!(kept < lines() && lines() == pieces.lines().count(), "{kept} {}", lines());
    let csv = fs::read_to_string(folder.path().join("cut/results.csv")).unwrap();
    assert_eq!(
        (csv.lines().next(), csv.lines().count()),
        (Some("x,y,attractor,kind,decided"), 1 + 24 * 24)
    );
    // The number of points that are not run is printed; on request every point is run.
    let filled_in = csv.lines().filter(|line| line.ends_with(",filled in")).count();
    let said = |output: &Output| {
        text(&output.stdout).contains(&format!("{filled_in} points were not run"))
    };
    assert!(filled_in > 100 && said(&whole), "{}", text(&whole.stdout));
    let json = fs::read_to_string(folder.path().join("whole/study.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let points = serde_json::json!({ "run": 24 * 24 - filled_in, "filled_in": filled_in });
    assert_eq!(json["results"]["points"], points);
    let every = amontons(folder.path(), &all("every", &["--every-point"]));
    let full = fs::read_to_string(folder.path().join("every/results.csv")).unwrap();
    let ends = |csv: &str| -> Vec<String> {
        csv.lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned()).collect()
    };
    assert!(!full.contains("filled in") && !text(&every.stdout).contains("were not run"));
    assert_eq!(ends(&full), ends(&csv));
}

#[test]
fn planes_that_make_no_sense_are_refused_with_what_would() {
    let folder = folder();
    let refused = |x: &str, y: &str, code, words: &[&str]| {
        let arguments = ["study", "basin", "set2", "--x", x, "--y", y, "-o", "plane"];
        assert_refused(&amontons(folder.path(), &arguments), code, words);
    };
    let x = "module[1].v2=-0.3:0.3/4";
    refused(
        x,
        "module[2].v9=-1:1/4",
        2,
        &["module[2].v9", "initial.module[2].v1", "initial.module[2].v4"],
    );
    refused(x, "initial.module[1].v2=-1:1/4", 2, &["both axes vary initial.module[1].v2"]);
    refused(x, "slider.velocity=-1:1/4", 2, &["no initial value slider.velocity"]);
    refused(x, "module[2].v2=-1:1", 2, &["A:B/N"]);
    refused(x, "module[2].v2", 2, &["NAME=A:B/N"]);
    let both = amontons(folder.path(), &all("plane", &["--islands=4", "--every-point"]));
    assert_refused(&both, 2, &["--islands", "--every-point"]);
    let none = amontons(folder.path(), &all("plane", &["--islands=0"]));
    assert_refused(&none, 2, &["power of two"]);
    fs::write(folder.path().join("file"), "").unwrap();
    let output = amontons(folder.path(), &all("file", &[]));
    assert_refused(&output, 1, &["file"]);
}
