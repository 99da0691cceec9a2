//! Limit cycles over a parameter: the paper's Fig. 3, a closed form, and the command as its user meets it.

use crate::program::{assert_refused, folder, run, text};
use amontons::contact::ContactState::{self, Detached, Slide, Stick};
use amontons::scene::{Method, Scene, builtin};
use amontons::simulation::Simulation;
use amontons_analysis::assign::assign;
use amontons_analysis::study::{
    Change, Journal, Kind, LimitCycles, LongTermMotion, ObservationRequest, ObservationSettings,
    Question, Watch, limit_cycles,
};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

/// The paper's unstable case.
fn set1() -> Scene {
    let mut scene = builtin("set1").unwrap().scene();
    assign(&mut scene, "friction.coefficient", 1.5).unwrap();
    scene
}

/// A study by exact motion, or by the paper's scheme with a step, s.
fn study(scene: &Scene, name: &str, values: &[f64], step: Option<f64>) -> LimitCycles {
    let prepare = |scene: &mut Scene| {
        if let Some(step) = step {
            (scene.method, scene.step) = (Method::ForwardIncrement, step);
            return ObservationSettings::of(scene, &ObservationRequest::default());
        }
        ObservationSettings::paced(scene, &ObservationRequest::default())
    };
    let question = Question {
        name: name.to_owned(),
        values: values.to_vec(),
        resolution: 1e-3,
        portraits: None,
        contacts: 2,
    };
    limit_cycles(scene, &prepare, &question, &Journal::forgotten(), Watch::IDLE).unwrap().unwrap()
}

fn endings(found: &LimitCycles) -> Vec<&LongTermMotion> {
    found.outcomes.iter().map(|outcome| outcome.settled().expect("all settle")).collect()
}

fn assert_takes(ending: &LongTermMotion, states: &[ContactState]) {
    let taken: Vec<ContactState> =
        ContactState::ALL.into_iter().filter(|state| ending.taken[*state as usize - 1]).collect();
    assert_eq!(taken, states, "{ending:?}");
}

fn assert_near(a: f64, b: f64, relative: f64) {
    assert!((a / b - 1.0).abs() <= relative, "{a} {b}");
}

/// The paper's three ranges of the slider's velocity, in which the states that contacts take differ.
fn assert_three_regimes(found: &LimitCycles, kind: Kind) {
    let endings = endings(found);
    assert!(endings.iter().all(|ending| ending.kind == kind), "{endings:?}");
    assert_takes(endings[0], &[Slide, Stick]);
    assert_takes(endings[1], &[Slide, Stick, Detached]);
    assert_takes(endings[2], &[Slide, Detached]);
    let [first, second] = &found.thresholds[..] else { panic!("{:?}", found.thresholds) };
    assert_eq!(first.changes, [Change::Appears(Detached)]);
    assert_eq!(second.changes, [Change::Vanishes(Stick)]);
    assert!(0.05 < first.between[0] && first.between[1] < 0.15);
    assert!(0.15 < second.between[0] && second.between[1] < 0.25);
    for threshold in [first, second] {
        assert_eq!(threshold.unknown, None);
        assert!(threshold.between[1] - threshold.between[0] <= 1e-3 * 0.1 * (1.0 + 1e-9));
    }
    let velocities: Vec<f64> = found.portraits.iter().map(|portrait| portrait.value).collect();
    assert_eq!(velocities, [0.05, 0.15, 0.25]);
    for (portrait, sticks) in found.portraits.iter().zip([true, true, false]) {
        for orbit in &portrait.orbits {
            assert_eq!(orbit.slider_velocity, portrait.value);
            // The horizontal portion of Fig. 3(b), and no contact overtakes the slider.
            let level = |part: f64| part * portrait.value;
            let on =
                orbit.tangential.iter().filter(|[_, v]| (v - portrait.value).abs() < level(1e-9));
            assert_eq!(on.count() > 20, sticks, "{}", portrait.value);
            assert!(orbit.tangential.iter().all(|[_, v]| *v < level(1.0 + 1e-9)));
            // A point in Fig. 3(c), or jumps.
            let open = orbit.normal.iter().any(|[x, v]| *x > 1e-7 && v.abs() > 1e-3);
            let is_point = orbit.normal.iter().all(|point| *point == [0.0, 0.0]);
            assert_eq!((open, is_point), (portrait.value > 0.1, portrait.value < 0.1));
            if portrait.ending.kind != Kind::Periodic {
                continue;
            }
            // It closes: as far as a step between two points goes, and what settling leaves.
            let (begin, end) = (orbit.tangential[0], orbit.tangential[orbit.tangential.len() - 1]);
            let largest = orbit.tangential.iter().fold(0.0, |most, [_, v]| f64::max(most, v.abs()));
            assert!((begin[1] - end[1]).abs() < 0.05 * largest, "{begin:?} {end:?}");
        }
    }
}

#[test]
fn set_1_has_the_papers_three_regimes_over_the_sliders_velocity() {
    assert_three_regimes(
        &study(&set1(), "slider.velocity", &[0.05, 0.15, 0.25], None),
        Kind::Periodic,
    );
}

#[test]
fn the_papers_scheme_has_them_too() {
    let exact = study(&set1(), "slider.velocity", &[0.05, 0.15, 0.25], None);
    let scheme = study(&set1(), "slider.velocity", &[0.05, 0.15, 0.25], Some(1e-5));
    // A step is a 70th of the way round, too long to tell a motion that comes back from one that nearly does.
    assert_three_regimes(&scheme, Kind::Undecided);
    // The error is of first order: 1e-5 s is 1.4 % of a radian of 219 Hz.
    for (exact, scheme) in endings(&exact).iter().zip(endings(&scheme)) {
        assert_near(scheme.amplitude, exact.amplitude, 0.05);
        assert_near(scheme.frequency.unwrap(), exact.frequency.unwrap(), 1e-3);
    }
    for (exact, scheme) in exact.thresholds.iter().zip(&scheme.thresholds) {
        assert_near(scheme.between[0], exact.between[0], 0.05);
    }
}

#[test]
fn without_stick_the_cycle_does_not_depend_on_the_sliders_velocity() {
    let found = study(&set1(), "slider.velocity", &[0.25, 0.3, 0.4], None);
    assert!(found.thresholds.is_empty() && found.regimes.len() == 1);
    let endings = endings(&found);
    for ending in &endings {
        assert_takes(ending, &[Slide, Detached]);
        assert_near(ending.amplitude, endings[0].amplitude, 1e-5);
        assert_near(ending.frequency.unwrap(), endings[0].frequency.unwrap(), 1e-6);
    }
}

/// While no contact opens, the slider's velocity is all that has a size: the motion about the equilibrium is
/// proportional to it, and so is what the contact force lacks.
#[test]
fn without_detachment_the_cycle_is_proportional_to_the_velocity_until_the_force_reaches_zero() {
    let found = study(&set1(), "slider.velocity", &[0.02, 0.04, 0.08], None);
    let ends = endings(&found);
    assert_takes(ends[1], &[Slide, Stick]);
    assert_near(ends[1].amplitude, 2.0 * ends[0].amplitude, 1e-4);
    assert_near(ends[1].frequency.unwrap(), ends[0].frequency.unwrap(), 1e-5);
    assert_near(ends[1].shares[2], ends[0].shares[2], 5e-3);
    let [threshold] = &found.thresholds[..] else { panic!("{:?}", found.thresholds) };

    let mut scene = set1();
    scene.slider.velocity = 0.04;
    (scene.method, scene.step) = (Method::EventDriven, 2e-6);
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let rest = simulation.contact_forces().unwrap()[0].normal_force;
    simulation.advance_to(20.0).unwrap();
    let mut least = f64::INFINITY;
    for row in 1..10_000 {
        simulation.advance_to(20.0 + f64::from(row) * 2e-6).unwrap();
        for force in simulation.contact_forces().unwrap() {
            least = least.min(force.normal_force);
        }
    }
    let velocity = 0.04 * rest / (rest - least);
    let [low, high] = threshold.between;
    let near = 1e-4 * velocity;
    assert!(low - near < velocity && velocity < high + near, "{low} {velocity} {high}");
}

#[test]
fn a_run_below_a_threshold_differs_from_one_above_it() {
    let found = study(&set1(), "slider.velocity", &[0.05, 0.15, 0.25], None);
    let entered = |velocity: f64| {
        let mut scene = set1();
        scene.slider.velocity = velocity;
        (scene.method, scene.step) = (Method::EventDriven, 1e-4);
        let mut simulation = Simulation::new(scene, 0.0).unwrap();
        simulation.advance_to(20.0).unwrap();
        let before = simulation.statistics().entered;
        simulation.advance_to(22.0).unwrap();
        let after = simulation.statistics().entered;
        [Stick, Detached].map(|state| after[state as usize - 1] > before[state as usize - 1])
    };
    let [detaches, slips] = &found.thresholds[..] else { panic!("{:?}", found.thresholds) };
    assert_eq!(detaches.between.map(entered), [[true, false], [true, true]]);
    assert_eq!(slips.between.map(entered), [[true, true], [false, true]]);
}

#[test]
fn stick_and_slip_on_a_belt_have_the_amplitude_and_period_of_their_closed_form() {
    let values = [0.02, 0.04, 0.06, 0.08];
    let scene = builtin("stick_slip").unwrap().scene();
    let found = study(&scene, "slider.velocity", &values, None);
    assert!(found.thresholds.is_empty());
    // k = 100 N/m, m = 1 kg, N = 10 N; µ_s − µ = 0.2.
    let (omega, d) = (10.0, 0.02);
    for (v, ending) in values.into_iter().zip(endings(&found)) {
        assert_eq!(ending.kind, Kind::Periodic);
        assert_takes(ending, &[Slide, Stick]);
        assert_near(ending.amplitude, f64::hypot(d, v / omega), 1e-3);
        let (stuck, slips) = (2.0 * d / v, 2.0 / omega * (PI - f64::atan(d * omega / v)));
        assert_near(ending.frequency.unwrap(), 1.0 / (stuck + slips), 1e-4);
        // The rows of a window, 0.02 s apart in 50 s, may begin and end anywhere in a period.
        let period = stuck + slips;
        assert!((ending.shares[2] - stuck / period).abs() < 0.5 * period / 50.0 + 1e-3);
    }
}

#[test]
fn a_scene_that_always_comes_to_rest_has_an_answer() {
    // Fig. 2(a): no mode of Set 1 grows up to µ of more than 1.
    let scene = builtin("set1").unwrap().scene();
    let found = study(&scene, "friction.coefficient", &[0.3, 0.6, 0.9], None);
    for ending in endings(&found) {
        assert_eq!(ending.kind, Kind::Equilibrium);
        assert_takes(ending, &[Slide]);
    }
    assert!(found.thresholds.is_empty() && found.portraits.is_empty());
    assert!(matches!(&found.regimes[..], [only] if only.places == [0, 2] && !only.is_cycle));
}

#[test]
fn a_cycle_begins_where_a_mode_of_sliding_begins_to_grow() {
    let mut scene = builtin("set1").unwrap().scene();
    // It rests, and is pushed for that.
    scene.rest();
    let found = study(&scene, "friction.coefficient", &[1.1, 1.3], None);
    let begins = found.thresholds.iter().find(|found| found.changes.contains(&Change::RestEnds));
    let [low, high] = begins.unwrap().between;
    let grows =
        amontons_analysis::stability::candidates::bistability(&scene, [1.0, 1.4], Watch::IDLE)
            .unwrap();
    let onset = grows.uniform.iter().find(|crossing| crossing.becomes_unstable).unwrap().value;
    assert!(high - low < 1e-3 && low - 1e-3 < onset && onset < high + 1e-3, "{low} {onset} {high}");
}

#[test]
fn a_value_without_a_motion_is_told_and_the_others_go_on() {
    // At this angle Set 1 jams from 3.577 on.
    let mut scene = builtin("set1").unwrap().scene();
    assign(&mut scene, "slider.angle", -0.5).unwrap();
    let found = study(&scene, "friction.coefficient", &[0.2, 3.6], None);
    let failure = serde_json::to_value(&found.outcomes[1]).unwrap();
    assert!(failure["failure"].as_str().unwrap().contains("jams"), "{failure}");
    assert!(found.outcomes[0].settled().is_some() && found.thresholds.is_empty());

    let folder = folder();
    let all = ["study", "limit-cycle", "set1", "--set", "slider.angle=-0.5", "--parameter"];
    let none = [&all[..], &["friction.coefficient=3.8:4:0.1"]].concat();
    assert_refused(&amontons(folder.path(), &none), 3, &["no equilibrium", "jams"]);
    let some = [&all[..], &["friction.coefficient=0.2:3.6:3.4", "-o", "some"]].concat();
    let output = amontons(folder.path(), &some);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(
        text(&output.stdout).contains("3.6  failed: ") && text(&output.stdout).contains("jams")
    );
    let csv = fs::read_to_string(folder.path().join("some/results.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!((&rows[0][1], &rows[1][1]), ("equilibrium", "failed"));
    assert!(rows[1][12].contains("jams") && rows[0][12].is_empty());
}

#[test]
fn the_command_writes_what_it_prints() {
    let folder = folder();
    let arguments = ["study", "limit-cycle", "set1", "--set", "friction.coefficient=1.5"];
    let values = ["--parameter", "slider.velocity=0.05:0.25:0.1", "--resolution", "0.1"];
    let drawn = ["--portrait", "0.1", "--pictures", "png"];
    let output = amontons(folder.path(), &[&arguments[..], &values, &drawn].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    assert!(printed.contains("Dt appears") && printed.contains("St vanishes"), "{printed}");
    let path = folder.path().join("set1-limit-cycle");
    let csv = fs::read_to_string(path.join("results.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    assert_eq!(
        reader.headers().unwrap().iter().collect::<Vec<_>>().join(","),
        "slider.velocity,kind,amplitude,frequency,share.slide,share.reverse_slide,share.stick,\
         share.detached,taken,time,period,closure,failure"
    );
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.iter().map(|row| &row[0]).collect::<Vec<_>>(), ["0.05", "0.15", "0.25"]);
    assert_eq!(rows.iter().map(|row| &row[8]).collect::<Vec<_>>(), ["Sl St", "Sl St Dt", "Sl Dt"]);
    for row in &rows {
        let amplitude = format!("{:.4e}", row[2].parse::<f64>().unwrap());
        let line = printed.lines().find(|line| line.trim_start().starts_with(&row[0])).unwrap();
        assert!(line.contains(&amplitude) && line.contains("periodic"), "{line}");
    }
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(path.join("study.json")).unwrap()).unwrap();
    let found = &json["results"]["found"];
    assert_eq!(found["outcomes"].as_array().unwrap().len(), 3);
    assert_eq!(found["thresholds"][0]["changes"][0]["appears"], "Detached");
    assert_eq!(found["portraits"][0]["value"], 0.1);
    for picture in ["limit-cycle", "portrait-0.1-tangential", "portrait-0.1-normal"] {
        let picture = fs::read(path.join(format!("{picture}.png"))).unwrap();
        assert_eq!(picture[..4], *b"\x89PNG");
    }
}

#[test]
fn one_value_is_studied_and_without_a_parameter_the_scene_as_it_is() {
    let folder = folder();
    let studied = |parameter: &[&str], name: &str| {
        let run = ["study", "limit-cycle", "stick_slip", "-o", name];
        let output = amontons(folder.path(), &[&run[..], parameter].concat());
        let printed = text(&output.stdout);
        assert!(output.status.success(), "{printed}{}", text(&output.stderr));
        assert!(!printed.contains("thresholds"), "{printed}");
        let row = printed.lines().find(|line| line.contains(" periodic ")).map(str::to_owned);
        row.unwrap_or_else(|| panic!("{printed}"))
    };
    let own = studied(&[], "own");
    let velocity = own.split_whitespace().next().unwrap().to_owned();
    let same = studied(&["--parameter", &format!("slider.velocity={velocity}")], "same");
    assert_eq!(own, same);
    let stiffer = studied(&["--parameter", "spring.hold.stiffness=90"], "stiffer");
    assert!(stiffer.trim_start().starts_with("90.0 "), "{stiffer}");
}

#[test]
fn what_makes_no_sense_is_refused_with_what_would() {
    let folder = folder();
    fs::write(folder.path().join("file"), "").unwrap();
    let refused = |arguments: &[&str], code, words: &[&str]| {
        let all = [&["study", "limit-cycle", "set1"], arguments].concat();
        assert_refused(&amontons(folder.path(), &all), code, words);
        assert!(!folder.path().join("set1-limit-cycle").exists(), "{arguments:?}");
    };
    let velocity = ["--parameter", "slider.velocity=0.1:0.2:0.1"];
    refused(&["--parameter", "slider.velocity"], 2, &["NAME=A:B"]);
    refused(&["--parameter", "slider.velocity=0.1:0.2"], 2, &["A:B:STEP"]);
    refused(&["--parameter", "slider.velocity=0.2:0.1:0.1"], 2, &["first value must be below"]);
    refused(&["--parameter", "slider.velocity=0.1:0.2:-0.1"], 2, &["step must be above zero"]);
    refused(&["--parameter", "slider.velocity=0.1:0.2:1e-9"], 2, &["at most 1e6 values"]);
    refused(&["--parameter", "slider.velocity=0.1:fast:0.1"], 2, &["fast is not a number"]);
    refused(&["--parameter", "slider.velocty=0.1:0.2:0.1"], 2, &["did you mean slider.velocity?"]);
    refused(&["--parameter", "module[1].x1=0.1:0.2:0.1"], 2, &["module[1].x1", "output"]);
    refused(&["--parameter", "module[1].m1=0:1:1"], 3, &["module[1].m1 = 0", "above zero"]);
    refused(&[&velocity[..], &["--of", "module[1].x5"]].concat(), 2, &["module[1].x5"]);
    refused(&[&velocity[..], &["--resolution", "0"]].concat(), 2, &["above 0 and at most 1"]);
    refused(&[&velocity[..], &["--portrait", "x"]].concat(), 2, &["x is not a number"]);
    refused(&[&velocity[..], &["-o", "file/inside"]].concat(), 1, &["file/inside"]);
    // No value can start: the folder is there by then.
    let coarse =
        ["study", "limit-cycle", "set1", "--integrator", "forward-increment", "--step", "1"];
    let output = amontons(folder.path(), &[&coarse[..], &velocity].concat());
    assert_refused(&output, 3, &["critical"]);
}

#[test]
fn a_full_disk_is_told() {
    let folder = folder();
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.current_dir(folder.path()).args(["study", "limit-cycle", "set1", "--parameter"]);
    command.arg("friction.coefficient=0.3:0.4:0.1");
    let output = command.stdout(full).stderr(Stdio::piped()).output().unwrap();
    assert_refused(&output, 1, &["No space left on device"]);
    assert!(folder.path().join("set1-limit-cycle/results.csv").exists());
}

#[test]
fn an_interrupted_study_goes_on_to_the_same_results() {
    let folder = folder();
    let arguments = ["study", "limit-cycle", "set1", "--set", "friction.coefficient=1.5"];
    let values = ["--parameter", "slider.velocity=0.01:0.25:0.01", "--resolution", "0.1", "-o"];
    let all = |name: &'static str| [&arguments[..], &values, &[name]].concat();
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.current_dir(folder.path()).args(all("ended")).stderr(Stdio::piped());
    let child = command.stdout(Stdio::piped()).spawn().unwrap();
    let journal = folder.path().join("ended/journal.jsonl");
    let lines = || fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    let begin = Instant::now();
    while lines() < 4 && begin.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success()
    );
    let output = child.wait_with_output().unwrap();
    assert_refused(
        &output,
        130,
        &["finished piece", "kept in ended/journal.jsonl", "continues from there"],
    );
    assert!(output.stdout.is_empty() && !folder.path().join("ended/results.csv").exists());
    let kept = fs::read_to_string(&journal).unwrap();
    assert!(kept.lines().count() < 20, "it was nearly done");

    for name in ["ended", "whole"] {
        let output = amontons(folder.path(), &all(name));
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let read = |name: &str, file: &str| fs::read(folder.path().join(name).join(file)).unwrap();
    for file in ["results.csv", "limit-cycle.svg", "portrait-0.03-tangential.svg"] {
        assert!(read("ended", file) == read("whole", file), "{file}");
    }
    assert!(text(&read("ended", "journal.jsonl")).starts_with(&kept));
}

/// Each value of the stiffness derives a step of its own, unless one step is chosen for all.
#[test]
fn a_study_with_a_chosen_step_takes_no_pieces_of_one_that_derives_the_step_of_each_value() {
    let folder = folder();
    let study = [
        "study",
        "limit-cycle",
        "stick_slip",
        "--parameter=spring.hold.stiffness=50:200/2",
        "--resolution=1",
        "-o",
        "one",
    ];
    let first = amontons(folder.path(), &study);
    assert!(first.status.success(), "{}", text(&first.stderr));
    let json = fs::read_to_string(folder.path().join("one/study.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let step = format!("--step={}", json["step"]);
    let chosen = [&study[..], &["--integrator=event-driven", &step]].concat();
    let chosen = amontons(folder.path(), &chosen);
    assert!(!chosen.status.success(), "{}", text(&chosen.stdout));
    assert!(
        text(&chosen.stderr).contains("the folder holds another study"),
        "{}",
        text(&chosen.stderr)
    );
}
