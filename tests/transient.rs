//! Growth and decay in a run against eigenvalues, and the command as its user meets it.
#![cfg(feature = "tools")]

mod program;

use amontons::contact::ContactState::Slide;
use amontons::model::LumpedModel;
use amontons::scene::{Experiment, Method, Scene, builtin};
use amontons::stability::Spectrum;
use amontons::study::Watch;
use amontons::study::transient::{Finding, Transient, transient};
use program::{assert_refused, folder, run, text};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// How far a printed eigenvalue of the paper may be off, Hz.
const PRINTED: f64 = 0.006;

fn scene(name: &str) -> Scene {
    builtin(name).unwrap().scene().with_integrator(Method::EventDriven, 2e-4)
}

fn found(scene: &Scene, stop_time: f64, of: Option<&str>) -> Transient {
    let experiment = Experiment { stop_time, ..scene.experiment };
    let found = transient(scene, experiment, of, Watch::IDLE).unwrap();
    assert!(found.complete && found.failure.is_none());
    found
}

/// The one finding of its own, no combination of others, near a frequency (Hz).
fn near(found: &Transient, frequency: f64) -> &Finding {
    let is_near = |finding: &&Finding| {
        finding.phase.combination.is_none() && (finding.phase.frequency - frequency).abs() < 3.0
    };
    let mut all = found.findings.iter().filter(is_near);
    let one = all.next().unwrap_or_else(|| panic!("{:?}", found.findings));
    assert!(all.next().is_none(), "{:?}", found.findings);
    one
}

/// Asserts that a finding is a mode of uniform sliding: to what the fit says of itself, and to the paper's digits,
/// real and imaginary part in Hz.
fn assert_mode(finding: &Finding, scene: &Scene, [real, imaginary]: [f64; 2]) {
    let model = LumpedModel::from(scene);
    let spectrum = Spectrum::of(&model, &[Slide, Slide], scene.friction_coefficient).unwrap();
    let phase = &finding.phase;
    let is_mode = |mode: &&nalgebra::Complex<f64>| {
        (mode.im / TAU - phase.frequency).abs() <= phase.frequency_error
            && (mode.re - phase.rate).abs() <= phase.rate_error
    };
    assert!(spectrum.oscillating.iter().find(is_mode).is_some(), "{phase:?} {spectrum:?}");
    assert!((phase.frequency - imaginary).abs() < PRINTED + phase.frequency_error, "{phase:?}");
    assert!((phase.rate / TAU - real).abs() < PRINTED + phase.rate_error / TAU, "{phase:?}");
}

#[test]
fn set_1_grows_as_its_unstable_mode_of_uniform_sliding() {
    let scene = scene("set1");
    let found = found(&scene, 1.2, None);
    let first = near(&found, 219.38);
    assert_mode(first, &scene, [2.68, 219.38]);
    // Ten e-folds of a nearly pure mode: four digits.
    assert!(first.phase.rate_error < 1e-3 && first.phase.frequency_error < 1e-3, "{first:?}");
    assert!((first.phase.amplitude[1] / first.phase.amplitude[0]).ln() > 10.0, "{first:?}");
    assert_eq!((first.taken.len(), &*first.taken[0].states), (1, "Sl-Sl"));
    assert_eq!(first.taken[0].eigenvalue, first.resting);
    let [course, _] = &found.courses[..] else { panic!("{:?}", found.courses) };
    assert_eq!((&*course.contact, &course.stretches[0].states[..]), ("contact[1]", &[Slide][..]));
}

#[test]
fn a_second_growth_near_168_hz_is_found_under_the_orbit_of_set_1() {
    let scene = scene("set1");
    let second = |of: Option<&str>| {
        let found = found(&scene, 6.0, of);
        let second = near(&found, 169.0).clone();
        // In the paper between 1 and 3 s; it is over when it has become the larger of the two.
        let [from, to] = second.phase.span;
        assert!((0.9..2.5).contains(&from) && (3.0..4.3).contains(&to), "{second:?}");
        assert!((168.0..170.0).contains(&second.phase.frequency), "{second:?}");
        // By turns each contact sticks, the other sliding: there the paper's Table 2 has 1.74 ± 167.81i.
        for states in ["Sl-St", "St-Sl"] {
            let taken = second.taken.iter().find(|taken| taken.states == states).unwrap();
            assert!((0.25..0.45).contains(&taken.share), "{taken:?}");
            let eigenvalue = taken.eigenvalue.unwrap();
            assert!((eigenvalue.rate / TAU - 1.74).abs() < PRINTED, "{taken:?}");
            assert!((eigenvalue.frequency - 167.81).abs() < PRINTED, "{taken:?}");
        }
        // In uniform sliding alone it would decay.
        assert!(second.resting.unwrap().rate < 0.0 && second.phase.rate > 0.0, "{second:?}");
        second
    };
    // What grows is one motion of all masses: each output has the same rate and frequency.
    let outputs = [None, Some("module[1].x1"), Some("module[1].x2"), Some("module[2].v1")];
    let all = outputs.map(second);
    for other in &all[1..] {
        let (a, b) = (&all[0].phase, &other.phase);
        assert!((a.rate - b.rate).abs() < a.rate_error + b.rate_error, "{a:?} {b:?}");
        assert!((a.rate_error + b.rate_error) < 0.1 * a.rate, "{a:?} {b:?}");
        let apart = (a.frequency - b.frequency).abs();
        assert!(apart < a.frequency_error + b.frequency_error, "{a:?} {b:?}");
    }
}

#[test]
fn a_small_push_of_set_2_decays_as_its_least_damped_modes() {
    let mut scene = scene("set2");
    scene.modules_mut()[0].velocity = [0.0, 1e-4, 0.0, 0.0];
    let found = found(&scene, 6.0, None);
    // Table 3, Sl-Sl: −0.18 ± 43.52i, −0.42 ± 66.48i.
    let slowest = near(&found, 43.52);
    assert_mode(slowest, &scene, [-0.18, 43.52]);
    assert!(slowest.phase.rate_error < 0.01, "{slowest:?}");
    assert_mode(near(&found, 66.48), &scene, [-0.42, 66.48]);
    assert!(found.findings.iter().all(|finding| finding.phase.rate < 0.0));
}

#[test]
fn a_coarse_interval_is_parted_for_the_fastest_mode() {
    let scene = scene("set1");
    let experiment = Experiment { stop_time: 0.1, output_interval: 1e-3 };
    let found = transient(&scene, experiment, None, Watch::IDLE).unwrap();
    // Sliding back, which is the stiffest, has 232.35 Hz at µ = 1.96 (Table 2): 20 values a period are 0.2152 ms.
    assert_eq!(found.interval, 2e-4);
    assert_eq!((found.history.len(), found.states.len(), found.states[0].len()), (501, 2, 501));
    assert!((found.end - 0.1).abs() < 1e-12);
}

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

#[test]
fn the_command_writes_rows_findings_and_a_picture_the_same_each_time() {
    let folder = folder();
    let command = ["study", "transient", "set1", "--stop-time", "1.2", "--pictures", "png"];
    let printed = || {
        let output = amontons(folder.path(), &command);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let first = printed();
    assert!(first.contains("grows from") && first.contains("219.384"), "{first}");
    let made = folder.path().join("set1-transient");
    let rows = read(&made.join("history.csv"));
    assert_eq!(rows.lines().count(), 1 + 6001);
    let head = rows.lines().next().unwrap();
    assert!(head.starts_with("time,module[") && head.ends_with(".state"), "{head}");
    let results = read(&made.join("results.csv"));
    assert!(results.starts_with("from,to,frequency,frequency_error,rate,"), "{results}");
    assert!(fs::read(made.join("transient.png")).unwrap().starts_with(b"\x89PNG"));
    let study: Value = serde_json::from_str(&read(&made.join("study.json"))).unwrap();
    let found = &study["results"];
    assert_eq!(found["complete"], true);
    let growing = &found["findings"][0];
    assert!((growing["rate"].as_f64().unwrap() - 16.8125).abs() < 1e-3, "{growing}");
    assert_eq!(growing["taken"][0]["states"], "Sl-Sl");

    assert_eq!(printed(), first);
    assert_eq!(read(&made.join("results.csv")), results);
}

#[test]
fn an_interrupted_run_leaves_what_it_has_done() {
    let folder = folder();
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    // The paper's scheme: some 15 s of work.
    command.args(["study", "transient", "set1", "--stop-time", "1000", "--of", "module[1].x1"]);
    command.args(["--integrator", "forward-increment", "-o", "out"]).current_dir(folder.path());
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_refused(&output, 130, &["the run ended at", "of 1000 s", "runs it anew"]);
    let rows = read(&folder.path().join("out/history.csv")).lines().count() - 1;
    let study: Value = serde_json::from_str(&read(&folder.path().join("out/study.json"))).unwrap();
    assert_eq!(study["results"]["complete"], false);
    let end = study["results"]["end"].as_f64().unwrap();
    assert!((end - 2e-4 * (rows - 1) as f64).abs() < 1e-6 && end < 1000.0, "{end} {rows}");
}

#[test]
fn what_is_not_there_or_cannot_be_written_is_said() {
    let folder = folder();
    let study = |more: &[&str]| {
        let arguments: Vec<&str> =
            ["study", "transient", "set1"].iter().chain(more).copied().collect();
        amontons(folder.path(), &arguments)
    };
    let words = ["set1 has no output module[1].xx1", "did you mean module[1].x1?"];
    assert_refused(&study(&["--of", "module[1].xx1"]), 2, &words);
    assert!(!folder.path().join("set1-transient").exists());
    fs::write(folder.path().join("file"), "").unwrap();
    assert_refused(&study(&["-o", "file/out"]), 1, &["cannot use file/out"]);
    let long = study(&["--stop-time", "1e5"]);
    assert_refused(&long, 2, &["values", "--stop-time", "--of"]);
}
