//! Tests of `amontons accuracy`: the numbers of the table against independent ones, and the command as its user meets
//! it.

use crate::program::{assert_refused, folder, run, text};
use amontons::contact::ContactState;
use amontons::scene::{Method, Preset, Scene, Selection, builtin, parse};
use amontons::simulation::Simulation;
use amontons_analysis::accuracy::{ConvergenceStudy, Row, StepCandidate, dof_named};
use amontons_analysis::watch::Watch;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

/// Output of a command that must succeed.
fn printed(folder: &Path, arguments: &[&str]) -> String {
    let output = amontons(folder, arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// A built-in scene over a shorter window.
fn scene(name: &str, stop: f64) -> Scene {
    let mut scene = builtin(name).unwrap().scene();
    scene.experiment.stop_time = stop;
    scene
}

/// Set 1, pushed by 0.01 m/s: its contacts stick from the first hundredths of a second on.
fn set1(stop: f64) -> Scene {
    let mut scene = scene("set1", stop);
    scene.modules_mut()[0].velocity = [0.01, 0.0, 0.0, 0.0];
    scene
}

fn study(scene: &Scene) -> ConvergenceStudy {
    ConvergenceStudy::new(scene, None, Watch::IDLE).unwrap().unwrap()
}

fn row(study: &ConvergenceStudy, candidate: StepCandidate) -> Row {
    study.row(candidate, Watch::IDLE).unwrap().unwrap()
}

fn scheme(study: &ConvergenceStudy) -> Vec<StepCandidate> {
    let ladder = study.candidates().into_iter();
    ladder.filter(|candidate| candidate.method == Method::ForwardIncrement).collect()
}

#[test]
fn the_papers_scheme_is_of_first_order_on_set_1() {
    let study = study(&set1(0.25));
    let short = scheme(&study).into_iter().filter(|candidate| candidate.step < 3e-6);
    let rows: Vec<Row> = short.map(|candidate| row(&study, candidate)).collect();
    assert!(rows.len() >= 5 && rows.iter().all(|row| row.events_more == 0));
    assert!(rows[0].statistics.state_changes() > 40, "{:?}", rows[0]);
    for two in rows.windows(2) {
        let order = study.order(&two[0], &two[1]).unwrap();
        assert!((0.9..1.1).contains(&order), "{order} {two:?}");
        // So are the times of events.
        let times = two.iter().map(|row| row.errors.event_time.unwrap()).collect::<Vec<f64>>();
        let steps = two[0].candidate.step / two[1].candidate.step;
        assert!((0.8..1.2).contains(&((times[0] / times[1]).ln() / steps.ln())), "{times:?}");
    }
    // None of a row against another method's.
    let event_driven =
        study.candidates().into_iter().find(|candidate| candidate.method == Method::EventDriven);
    let event_driven = row(&study, event_driven.unwrap());
    assert_eq!(study.order(&rows[0], &event_driven), None);
    assert!(event_driven.errors.rms.unwrap() < 1e-10 && event_driven.events_more == 0);
}

#[test]
fn the_rms_error_is_the_one_computed_by_hand() {
    let scene = set1(0.1);
    let study = study(&scene);
    let trajectory = |method, step| {
        let mut simulation = Simulation::new(Scene { method, step, ..scene.clone() }, 0.0).unwrap();
        let mut rows = vec![simulation.displacement().to_vec()];
        for i in 1..=500 {
            simulation.advance_to(f64::from(i) * 2e-4).unwrap();
            rows.push(simulation.displacement().to_vec());
        }
        rows
    };
    let exact = trajectory(Method::EventDriven, 1e-4);
    let mut variance = 0.0;
    for dof in 0..8 {
        let mean = exact.iter().map(|x| x[dof]).sum::<f64>() / 501.0;
        variance += exact.iter().map(|x| (x[dof] - mean).powi(2)).sum::<f64>();
    }
    for candidate in
        scheme(&study).into_iter().filter(|candidate| (1e-6..2e-5).contains(&candidate.step))
    {
        let run = trajectory(Method::ForwardIncrement, candidate.step);
        let squares = run.iter().zip(&exact).flat_map(|(a, b)| a.iter().zip(b));
        let error = (squares.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / variance).sqrt();
        let found = row(&study, candidate).errors.rms.unwrap();
        assert!((found / error - 1.0).abs() < 1e-6, "{found} {error}");
    }
}

#[test]
fn the_reference_agrees_with_itself_to_rounding() {
    for scene in [set1(0.25), scene("set2", 0.25), scene("disc_brake", 0.05), scene("belt", 3.0)] {
        let floor = study(&scene).floor();
        assert!(floor.rms.unwrap() < 1e-10, "{}: {floor:?}", scene.name);
    }
}

#[test]
fn an_event_is_found_where_its_closed_form_has_it() {
    // The shaft comes back to the wall after (2/ω) atan(v ω m / (Fx − µFy)).
    let scene = scene("corner", 0.1);
    let study = study(&scene);
    let mass = scene.network().unwrap().masses[0].mass;
    let stiffness = scene.network().unwrap().springs[0].stiffness;
    let omega = (stiffness / mass).sqrt();
    let time = 2.0 / omega * (0.1 * omega * mass / (30.0 - 0.3 * 50.0)).atan();
    let changes = study.reference_changes();
    let touch = changes.iter().find(|change| change.state != ContactState::Detached).unwrap();
    assert!((touch.time - time).abs() < 1e-9, "{touch:?} {time}");
    // The scheme has it at the end of a step.
    let row = row(&study, scheme(&study)[3]);
    let error = row.errors.largest_event_time.unwrap();
    assert!(
        error < 3.0 * row.candidate.step && error > study.floor().event_time.unwrap(),
        "{row:?}"
    );
}

#[test]
fn what_is_out_of_phase_still_has_amplitude_and_frequency() {
    let study = study(&scene("set2", 1.0));
    let coarse = row(&study, scheme(&study)[0]);
    assert!(coarse.is_out_of_phase() && !study.is_chaotic(), "{coarse:?}");
    assert!(coarse.errors.amplitude.unwrap() < 0.2 && coarse.errors.frequency.unwrap() < 0.02);
    assert_eq!(study.order(&coarse, &row(&study, scheme(&study)[3])), None);
}

#[test]
fn a_scene_at_rest_has_times_and_no_errors() {
    let folder = folder();
    let rest = ["--set", "initial.module[1].v1=0", "--stop-time", "0.05"];
    let printed = printed(folder.path(), &[&["accuracy", "set1"], &rest[..]].concat());
    assert!(printed.contains("does not move"), "{printed}");
    assert!(!printed.contains("NaN") && !printed.contains("inf"), "{printed}");
    // A picture of nothing is refused.
    let plot = ["accuracy", "set1", "--plot", "rest.svg"];
    let output = amontons(folder.path(), &[&plot, &rest[..]].concat());
    assert_refused(&output, 1, &["rest.svg", "finite point"]);
}

#[test]
fn a_displacement_that_does_not_move_is_said_not_to() {
    // The block is pressed on its belt.
    let printed = printed(folder().path(), &["accuracy", "belt", "--of", "mass.block.y"]);
    assert!(printed.contains("mass.block.y does not move over the last half"), "{printed}");
}

#[test]
fn a_preset_of_the_scene_changes_nothing_in_a_study() {
    let mut scene = set1(0.05);
    let given = study(&scene);
    scene.selection = Selection::Preset(Preset::Preview);
    let chosen = study(&scene);
    let candidate = scheme(&given)[4];
    assert_eq!(row(&given, candidate), row(&chosen, candidate));
    assert_eq!((given.floor(), given.candidates()), (chosen.floor(), chosen.candidates()));
}

/// A mass on a spring that slides on a belt, with a sine on this input.
fn sliding(input: &str) -> Scene {
    let text = "[slider]\nvelocity = 1.0\nangle = 0.0\n[friction]\ncoefficient = 0.3\n[[mass]]\nname = \"a\"\n\
        mass = 0.5\nforce = [0.0, -10.0]\n[[spring]]\nname = \"k\"\nbetween = [\"a\", \"ground\"]\n\
        direction = \"x\"\nstiffness = 200.0\n[[contact]]\nname = \"c\"\nmass = \"a\"\n[integrator]\n\
        method = \"event-driven\"\nstep = 1e-3\n[experiment]\noutput_interval = 0.01\n[[signal]]\n\
        sine = { amplitude = 0.1, frequency = 2.0, phase = 1.0 }\n";
    parse("sliding", &format!("{text}input = \"{input}\"\n")).unwrap()
}

#[test]
fn a_force_or_a_friction_that_curves_within_a_step_costs_exact_motion_nothing() {
    for input in ["mass.a.fx", "friction.coefficient"] {
        let study = study(&sliding(input));
        assert!(study.floor().rms.unwrap() < 1e-12, "{input}: {:?}", study.floor());
        let candidates = study.candidates().into_iter();
        let ladder = candidates.filter(|candidate| candidate.method == Method::EventDriven);
        for row in ladder.map(|candidate| row(&study, candidate)) {
            assert!(row.errors.rms.unwrap() < 1e-12, "{input}: {row:?}");
        }
    }
}

#[test]
fn every_built_in_scene_has_a_reference() {
    for (name, stop, floor) in [("den_hartog", 1.0, 1e-5), ("hoffmann", 60.0, 1e-8)] {
        let study = study(&scene(name, stop));
        assert!(study.floor().rms.unwrap() < floor, "{name}: {:?}", study.floor());
    }
}

#[test]
fn no_step_is_above_the_critical_one_and_a_method_without_one_is_left_out() {
    let mut coarse = set1(0.1);
    coarse.experiment.output_interval = 1e-2;
    let study_1 = study(&coarse);
    let critical = study_1.critical_step().unwrap().step;
    let rungs = scheme(&study_1);
    assert!(
        rungs.iter().all(|candidate| candidate.step <= critical) && rungs[0].step > 0.5 * critical
    );

    // Seven contacts in a stack share masses and may jam, so no critical step is known.
    let mut text = String::from(
        "[slider]\nvelocity = 0.1\nangle = 0.0\n[friction]\ncoefficient = 0.3\n\
         [integrator]\nmethod = \"event-driven\"\nstep = 1e-3\n[experiment]\nstop_time = 0.2\n",
    );
    for i in 0..7 {
        text += &format!(
            "[[mass]]\nname = \"m{i}\"\nmass = 1.0\nforce = [0.0, -10.0]\n[[spring]]\nname = \"k{i}\"\n\
             between = [\"m{i}\", \"ground\"]\ndirection = \"x\"\nstiffness = {}e3\n",
            i + 1
        );
        let on = if i == 0 { String::new() } else { format!("on = \"m{}\"\n", i - 1) };
        text += &format!("[[contact]]\nname = \"c{i}\"\nmass = \"m{i}\"\nvelocity = 0.1\n{on}");
    }
    text += "[[initial]]\nmass = \"m6\"\nvx = 0.2\n";
    let study = study(&parse("stack", &text).unwrap());
    assert!(study.critical_step().is_err());
    assert!(!study.candidates().is_empty() && scheme(&study).is_empty());
}

#[test]
fn json_has_what_is_needed_to_run_it_again_and_the_same_numbers_each_time() {
    let folder = folder();
    let arguments = ["accuracy", "set2", "--stop-time", "0.05", "--format", "json", "--plot"];
    let set = ["--set", "friction.coefficient=1.9", "--of", "module[2].x1"];
    let read = |plot: &str| -> Value {
        let all = [&arguments[..], &[plot], &set].concat();
        let mut found: Value = serde_json::from_str(&printed(folder.path(), &all)).unwrap();
        for row in found["rows"].as_array_mut().unwrap() {
            let time = row.as_object_mut().unwrap().remove("seconds_per_second").unwrap();
            assert!(time.as_f64().unwrap() > 0.0, "{row}");
        }
        found
    };
    let found = read("a.svg");
    assert_eq!(found, read("b.png"));
    assert_eq!(found["scene"], "set2");
    assert_eq!(found["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(found["values"]["friction.coefficient"], 1.9);
    assert_eq!(found["stop_time"], 0.05);
    assert_eq!(found["complete"], true);
    assert_eq!(found["reference"]["cycle_of"], "module[2].x1");
    let floor = found["reference"]["errors"]["rms"].as_f64().unwrap();
    let rows = found["rows"].as_array().unwrap();
    assert!(rows.iter().all(|row| row["errors"]["rms"].as_f64().unwrap() >= floor));
    for method in ["forward-increment", "event-driven"] {
        assert!(rows.iter().filter(|row| row["method"] == method).count() >= 3, "{method}");
    }
    // Both curves are there, in their colours, with steps beside them.
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
    for part in ["#0072B2", "#D55E00", "forward increment", "event-driven", "own error", "µs"] {
        assert!(svg.contains(part), "{part}");
    }
}

#[test]
fn csv_has_a_row_for_the_reference_and_one_for_each_step() {
    let folder = folder();
    let printed = printed(folder.path(), &["accuracy", "belt", "--format", "csv"]);
    let mut reader = csv::Reader::from_reader(printed.as_bytes());
    let columns = reader.headers().unwrap().len();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(&rows[0][0], "reference");
    assert!(rows.len() > 10 && rows.iter().all(|row| row.len() == columns));
    // One mass that sticks once: smooth but for that, so of second order.
    let order: f64 = rows[5][columns - 2].parse().unwrap();
    assert!((1.9..2.1).contains(&order), "{order}");
}

#[test]
fn what_makes_no_sense_is_refused_with_what_would() {
    let folder = folder();
    let refused = |arguments: &[&str], code, words: &[&str]| {
        let all = [&["accuracy"], arguments].concat();
        assert_refused(&amontons(folder.path(), &all), code, words);
    };
    refused(&["set3"], 1, &["set3"]);
    refused(&["set1", "--of", "module[1].x5"], 2, &["module[1].x5", "module[1].x"]);
    refused(&["belt", "--of", "mass.blok.x"], 2, &["did you mean mass.block.x?"]);
    refused(&["set1", "--plot", "a.pdf"], 1, &[".svg or .png"]);
    // Before the work, and not after it.
    refused(&["set1", "--plot", "nowhere/a.svg"], 1, &["there is no folder nowhere"]);
    refused(&["set1", "--set", "integrator.step=1e-5"], 2, &["integrator.step", "ladder of steps"]);
    refused(&["set1", "--stop-time", "-1"], 2, &["above zero"]);
    refused(&["set1", "--stop-time", "1e4"], 2, &["--stop-time"]);
    refused(&["disc_brake", "--set", "friction.coefficient=5"], 3, &["lower_lining jams"]);
    refused(&["set1", "--format", "xml"], 2, &["table", "csv", "json"]);
    assert!(dof_named(&scene("belt", 1.0), "mass.block.x").is_ok());
}

#[test]
fn an_interrupted_command_prints_what_is_done() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.args(["accuracy", "set1", "--stop-time", "20", "--format", "json"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_secs(2));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_refused(&output, 130, &["interrupted"]);
    // Or nothing, if there was no reference yet.
    if !output.stdout.is_empty() {
        let found: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
        assert_eq!(found["complete"], false);
    }
}
