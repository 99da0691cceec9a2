//! Sweeps: a sweep says of each value what the run of that value says.

use crate::program::{assert_refused, folder, run, text};
use amontons::scene::{Method, Scene, builtin, parse};
use amontons::simulation::Simulation;
use amontons_analysis::assign::assign;
use amontons_analysis::journal::Journal;
use amontons_analysis::sweep::observed::output;
use amontons_analysis::sweep::{View, sweep};
use amontons_analysis::watch::Watch;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

/// A mass on a spring.
const OSCILLATOR: &str = "[[mass]]\nname = \"a\"\nmass = 0.5\nlocked = [\"y\"]\n[[spring]]\nname = \"k\"\n\
    between = [\"a\", \"ground\"]\ndirection = \"x\"\nstiffness = 200.0\n[[initial]]\nmass = \"a\"\n\
    vx = 0.3\n[integrator]\nstep = 1e-4\n[experiment]\nstop_time = 8.0\noutput_interval = 0.01\n";

#[test]
fn the_amplitude_and_frequency_of_an_oscillator_are_those_of_its_closed_form() {
    for method in [Method::ForwardIncrement, Method::EventDriven] {
        let scene = Scene { method, ..parse("oscillator", OSCILLATOR).unwrap() };
        let view =
            View { outputs: vec![output(&scene, &scene.dof_names()[0]).unwrap()], window: 4.0 };
        let values = [100.0, 200.0, 300.0];
        let found =
            sweep(&scene, "spring.k.stiffness", &values, &view, &Journal::forgotten(), Watch::IDLE)
                .unwrap();
        for (stiffness, found) in values.into_iter().zip(found) {
            let found = found.unwrap().unwrap();
            let omega = f64::sqrt(stiffness / 0.5);
            // The scheme is of first order: ωh is 0.25 % at most.
            let tolerance = if method == Method::EventDriven { 1e-5 } else { 2e-3 };
            assert!((found.amplitudes[0] / (0.3 / omega) - 1.0).abs() < tolerance, "{found:?}");
            let frequency = found.frequency.unwrap();
            // Nine periods make a line of the spectrum wide; where it peaks is known to its thousandth.
            assert!((frequency / (omega / TAU) - 1.0).abs() < 1e-4, "{frequency}");
        }
    }
}

#[test]
fn amplitudes_and_shares_of_time_do_not_depend_on_the_rows() {
    // On the rail of the one friction turns where the block does, and the block of the other sticks: kinks both.
    for (name, outputs) in [
        ("den_hartog", ["mass.block.x", "mass.block.vx"]),
        ("stick_slip", ["mass.block.x", "mass.block.vx"]),
    ] {
        let mut scene = builtin(name).unwrap().scene();
        (scene.method, scene.step) = (Method::EventDriven, 1e-4);
        scene.experiment.stop_time = 12.0;
        let outputs: Vec<_> = outputs.iter().map(|name| output(&scene, name).unwrap()).collect();
        let view = View { outputs, window: 4.0 };
        let found = |interval: f64| {
            let mut scene = scene.clone();
            scene.experiment.output_interval = interval;
            let found = sweep(
                &scene,
                "spring.hold.stiffness",
                &[390.0],
                &view,
                &Journal::forgotten(),
                Watch::IDLE,
            )
            .unwrap();
            found.into_iter().next().unwrap().unwrap().unwrap()
        };
        let rows = found(1e-2);
        for interval in [1.0, 4e-3, 1e-3] {
            let nearer = found(interval);
            let pairs = rows.amplitudes.iter().zip(&nearer.amplitudes);
            for (a, b) in pairs {
                assert!((a / b - 1.0).abs() < 1e-6, "{name}, {interval} s: {a} {b}");
            }
            for (a, b) in rows.shares.iter().zip(nearer.shares) {
                assert!((a - b).abs() < 1e-6, "{name}, {interval} s: {rows:?} {nearer:?}");
            }
        }
        // The motion of that scene in its steps.
        let mut simulation = Simulation::new(
            {
                let mut scene = scene.clone();
                assign(&mut scene, "spring.hold.stiffness", 390.0).unwrap();
                scene
            },
            0.0,
        )
        .unwrap();
        simulation.advance_to(8.0).unwrap();
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for row in 1..=40_000 {
            simulation.advance_to(8.0 + 1e-4 * f64::from(row)).unwrap();
            let x = simulation.displacement()[0];
            (least, most) = (least.min(x), most.max(x));
        }
        let true_one = 0.5 * (most - least);
        assert!((rows.amplitudes[0] / true_one - 1.0).abs() < 2e-6, "{name}: {rows:?} {true_one}");
    }
}

#[test]
fn what_rests_has_no_amplitude_and_no_frequency_and_has_settled() {
    let folder = folder();
    // Its own start is at rest in the equilibrium of sliding, which rounding leaves by some 1e-20 m.
    let printed = amontons(
        folder.path(),
        &["simulate", "set2", "--set", "initial.module[1].v2=0", "--stop-time", "0.1", "--sweep"]
            .into_iter()
            .chain(["friction.coefficient=0.2:0.4/2", "--integrator", "event-driven"])
            .collect::<Vec<_>>(),
    );
    let (rows, notes) = (text(&printed.stdout), text(&printed.stderr));
    for row in rows.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        assert!(cells[1..9].iter().all(|amplitude| *amplitude == "0.0"), "{row}");
        assert_eq!(cells[9..11], ["", "yes"], "{row}");
    }
    assert!(rows.lines().count() == 3 && !notes.contains("unknown"), "{rows}{notes}");
}

#[test]
fn why_it_is_not_known_whether_a_motion_has_settled_is_said_once() {
    let folder = folder();
    let swept = |stop: &str| {
        let sweep = ["--sweep", "spring.hold.stiffness=90:100/3", "--integrator", "event-driven"];
        let run = ["simulate", "stick_slip", "--stop-time", stop];
        let output = amontons(folder.path(), &[&run[..], &sweep].concat());
        (text(&output.stdout), text(&output.stderr))
    };
    let (rows, notes) = swept("10");
    assert!(rows.lines().skip(1).all(|row| row.contains(",unknown,")), "{rows}");
    let told: Vec<&str> = notes.lines().filter(|line| line.contains("unknown")).collect();
    assert!(
        told.len() == 1
            && told[0]
                .contains("3 values, the first at spring.hold.stiffness = 90.0: a window of ")
            && told[0].contains("5 periods of the slowest mode"),
        "{notes}"
    );
    // The window that the note names is enough.
    let window = told[0].split("a window of ").nth(1).unwrap().split(' ').next().unwrap();
    let (rows, notes) = swept(&(4.0 * window.parse::<f64>().unwrap()).to_string());
    assert!(!rows.contains(",unknown,") || !notes.contains("a window of"), "{rows}{notes}");
}

#[test]
fn what_is_said_of_a_value_does_not_depend_on_the_other_values() {
    let scene = builtin("stick_slip").unwrap().scene();
    let view = View { outputs: vec![output(&scene, "mass.block.x").unwrap()], window: 2.0 };
    let swept = |stiffnesses: &[f64]| {
        sweep(
            &scene,
            "spring.hold.stiffness",
            stiffnesses,
            &view,
            &Journal::forgotten(),
            Watch::IDLE,
        )
        .unwrap()
    };
    // The stiffer spring has its rows ten times nearer to each other.
    let (soft, stiff, both) = (swept(&[100.0]), swept(&[1e4]), swept(&[100.0, 1e4]));
    assert_eq!(both, [soft, stiff].concat());
}

#[test]
fn a_sweep_says_what_the_runs_of_its_values_say() {
    let folder = folder();
    // A number of values that fills no whole number of vectors.
    let common = ["simulate", "set1", "--stop-time", "0.2", "--set", "initial.module[1].v1=0.3"];
    let coarse = ["--step", "1e-5", "--output-interval", "1e-3"];
    // A sweep looks as often as the fastest mode asks for: a fifth of the output interval.
    let fine = ["--step", "1e-5", "--output-interval", "2e-4"];
    let sweep = ["--sweep", "friction.coefficient=0.5:2.5/11", "--window", "0.05", "-o", "all.csv"];
    let output = amontons(folder.path(), &[&common[..], &coarse, &sweep].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let all = fs::read_to_string(folder.path().join("all.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(all.as_bytes());
    let header: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(header[..2], ["friction.coefficient", "amplitude.module[1].x1"]);
    assert_eq!(
        header[9..],
        [
            "frequency",
            "settled",
            "share.slide",
            "share.reverse_slide",
            "share.stick",
            "share.detached"
        ]
    );
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 11);
    assert_eq!((&rows[0][0], &rows[4][0], &rows[10][0]), ("0.5", "1.3", "2.5"));
    let mut stuck = 0.0;
    for row in &rows {
        let number = |i: usize| row[i].parse::<f64>().unwrap();
        let value = format!("friction.coefficient={}", &row[0]);
        let output = amontons(folder.path(), &[&common[..], &fine, &["--set", &value]].concat());
        let printed = text(&output.stdout);
        let mut reader = csv::Reader::from_reader(printed.as_bytes());
        let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let run: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let column = |name: &str| {
            let i = names.iter().position(|known| known == name).unwrap();
            // The last 0.05 s.
            run[750..].iter().map(|row| row[i].parse::<f64>().unwrap()).collect::<Vec<f64>>()
        };
        for (i, name) in header.iter().enumerate().take(9).skip(1) {
            let values = column(name.strip_prefix("amplitude.").unwrap());
            let most = values.iter().fold(f64::NEG_INFINITY, |most, value| most.max(*value));
            let least = values.iter().fold(f64::INFINITY, |least, value| least.min(*value));
            let half = 0.5 * (most - least);
            // With what lies between the rows, of which there are at least twenty a period.
            assert!(half <= number(i) && number(i) <= 1.05 * half, "{name}: {half} {}", &row[i]);
        }
        let states = [column("contact[1].state"), column("contact[2].state")].concat();
        for state in 1..=4_u32 {
            let is_it = |value: &&f64| **value == f64::from(state);
            let share = states.iter().filter(is_it).count() as f64 / states.len() as f64;
            // A sweep's are those of the time, these of 251 rows.
            let error = share - number(10 + state as usize);
            assert!(error.abs() < 1e-2, "{value}: state {state}: {error}");
        }
        stuck += number(13);
    }
    assert!(stuck > 0.0 && rows.iter().any(|row| &row[11] == "1.0"));

    let one = ["--sweep", "friction.coefficient=0.5:2.5/2", "--of", "module[2].x3"];
    let printed = text(&amontons(folder.path(), &[&common[..], &one].concat()).stdout);
    assert!(
        printed.starts_with("friction.coefficient,amplitude.module[2].x3,frequency,settled,"),
        "{printed}"
    );
}

#[test]
fn a_value_that_cannot_run_is_left_out_with_its_reason() {
    let folder = folder();
    // At this angle Set 1 jams from 3.577 on.
    let jams = ["simulate", "set1", "--stop-time", "0.01", "--set", "slider.angle=-0.5"];
    let some = ["--sweep", "friction.coefficient=3:4/3"];
    let output = amontons(folder.path(), &[&jams[..], &some].concat());
    let (printed, notes) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success() && printed.lines().count() == 3, "{printed}{notes}");
    assert!(notes.contains("friction.coefficient = 4.0 is left out") && notes.contains("jams"));
    let none = ["--sweep", "friction.coefficient=3.8:4/3", "-o", "none.csv"];
    let output = amontons(folder.path(), &[&jams[..], &none].concat());
    assert_refused(&output, 3, &["no equilibrium", "jams"]);
    assert!(!folder.path().join("none.csv").exists());
}

/// A mass that a sine throws about lands where the forces already pull it off: its contact keeps its state, and the kink was
/// once taken for a turn of a smooth motion, below the surface.
#[test]
fn the_amplitude_of_a_mass_that_bounces_off_where_it_lands_ends_at_its_surface() {
    let scene = r#"
[slider]
velocity = 1.0
angle = 0.0
[friction]
law = "none"
[[mass]]
name = "m"
mass = 1.0
force = [0.0, -10.0]
[[spring]]
name = "x"
between = ["m", "ground"]
direction = "x"
stiffness = 100.0
[[spring]]
name = "y"
between = ["m", "ground"]
direction = "y"
stiffness = 100.0
[[damper]]
name = "d"
between = ["m", "ground"]
direction = "y"
damping = 4.0
[[contact]]
name = "c"
mass = "m"
[[signal]]
input = "mass.m.fy"
sine = { amplitude = 60.0, frequency = 7.0 }
[integrator]
method = "event-driven"
step = 1e-3
[experiment]
stop_time = 20.0
"#;
    let folder = folder();
    fs::write(folder.path().join("m.toml"), scene).unwrap();
    let column = |name: &str, arguments: &[&str]| -> Vec<f64> {
        let all = [&["simulate", "m.toml", "-o", "m.csv"], arguments].concat();
        let output = amontons(folder.path(), &all);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let mut reader = csv::Reader::from_path(folder.path().join("m.csv")).unwrap();
        let place = reader.headers().unwrap().iter().position(|head| head == name).unwrap();
        reader.records().map(|row| row.unwrap()[place].parse().unwrap()).collect()
    };
    let rows = column("mass.m.y", &["--output-interval", "1e-4"]);
    let highest = rows[150_000..].iter().fold(0.0, |most, y| f64::max(most, *y));
    for interval in ["1e-3", "1e-2", "0.03"] {
        let sweep =
            ["--sweep", "mass.m.mass=1:1.1/2", "--window", "5", "--output-interval", interval];
        let amplitude = column("amplitude.mass.m.y", &sweep)[0];
        assert!((amplitude / (0.5 * highest) - 1.0).abs() < 1e-5, "{interval}: {amplitude}");
    }
}

#[test]
fn sweeps_that_make_no_sense_are_refused_with_what_would() {
    let folder = folder();
    let refused = |arguments: &[&str], code, words: &[&str]| {
        let all = [&["simulate", "set1", "--stop-time", "0.01", "--sweep"], arguments].concat();
        assert_refused(&amontons(folder.path(), &all), code, words);
    };
    refused(&["friction.coeficient=0:1/3"], 2, &["did you mean friction.coefficient?"]);
    refused(&["module[1].x1=0:1/3"], 2, &["module[1].x1", "output"]);
    refused(&["module[1].m1=0:1/3"], 3, &["module[1].m1 = 0", "above zero"]);
    refused(&["friction.coefficient"], 2, &["NAME=A:B/N"]);
    refused(&["friction.coefficient=0:1"], 2, &["A:B/N"]);
    refused(&["friction.coefficient=0:1/1"], 2, &["whole number from 2"]);
    let both = ["0:1/3 for 3 values", "0:1:3.0 for steps of 3"];
    refused(&["friction.coefficient=0:1:3"], 2, &both);
    refused(&["friction.coefficient=1:0/3"], 2, &["first value must be below the last"]);
    refused(&["friction.coefficient=0:1/3", "--of", "module[1].x5"], 2, &["module[1].x"]);
    refused(
        &["friction.coefficient=0:1/3", "--window", "1e-5"],
        2,
        &["fewer than two rows", "0.0002 s"],
    );
    refused(&["friction.coefficient=0:1/3", "--input", "in.csv"], 2, &["--input"]);
    refused(&["friction.coefficient=0:1/3", "-o", "no/such/place.csv"], 1, &["place.csv"]);
}

#[test]
fn an_interrupted_sweep_leaves_no_file_that_looks_complete() {
    let folder = folder();
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.current_dir(folder.path());
    command.args(["simulate", "set1", "--stop-time", "20", "-o", "all.csv"]);
    command.args(["--sweep", "friction.coefficient=0.5:2.5/1000"]);
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_secs(2));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_refused(&output, 130, &["interrupted", "of 1000 values", "all.csv.partial"]);
    assert!(!folder.path().join("all.csv").exists());
    let partial = fs::read_to_string(folder.path().join("all.csv.partial")).unwrap();
    assert!(partial.starts_with("friction.coefficient,") && partial.ends_with('\n'));
}
