//! Tests of the motions in which perturbations end, and of the thresholds between them: closed forms, and the paper's
//! Fig. 5.

use crate::driven_block::driven_block;
use crate::program::{assert_refused, folder, run, text};
use amontons::scene::{Method, Scene, builtin, parse};
use amontons::simulation::Simulation;
use amontons_analysis::assign::assign;
use amontons_analysis::study::perturbation::{Direction, Perturbations, perturbation};
use amontons_analysis::study::{
    Journal, Kind, ObservationRequest, ObservationSettings, Watch, history, pace,
};
use std::process::Output;

fn amontons(folder: &std::path::Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

fn looked(scene: &Scene) -> ObservationSettings {
    ObservationSettings::of(scene, &ObservationRequest::default()).unwrap()
}

/// By exact motion.
fn found(scene: &Scene, name: &str, amplitudes: &[f64], resolution: f64) -> Perturbations {
    let (mut scene, observation) = (scene.clone(), looked(scene));
    pace(&mut scene, &observation);
    assert_eq!(scene.method, Method::EventDriven);
    with_method(&scene, name, amplitudes, resolution)
}

fn with_method(scene: &Scene, name: &str, amplitudes: &[f64], resolution: f64) -> Perturbations {
    let direction =
        Direction { name: name.to_owned(), amplitudes: amplitudes.to_vec(), resolution };
    let journal = Journal::forgotten();
    perturbation(scene, &direction, &looked(scene), &journal, Watch::IDLE).unwrap().unwrap()
}

const KINDS: fn(&Perturbations) -> Vec<Kind> =
    |found| found.attractors.iter().map(|ending| ending.kind).collect();

// ---- A block on a belt ----

/// ω₀ of the block, 1/s, and the belt's velocity, m/s.
const OMEGA: f64 = 10.0;
const BELT: f64 = 0.1;

/// The block of `stick_slip`, damped: it may slide for ever, or stick and slip for ever.
fn damped_block(zeta: f64) -> Scene {
    let damper = format!(
        "\n[[damper]]\nname = \"air\"\nbetween = [\"block\", \"ground\"]\ndirection = \"x\"\ndamping = {:?}\n",
        2.0 * zeta * OMEGA
    );
    let text = builtin("stick_slip").unwrap().text;
    let at_rest = text.replace("vx = 0.1 ", "vx = 0.0 ");
    assert_ne!(at_rest, text);
    parse("damped", &(at_rest + &damper)).unwrap()
}

/// The amplitude, m, of what slides for ever under 0.15 N.
fn forced(frequency: f64) -> f64 {
    let pulsation = std::f64::consts::TAU * frequency;
    0.15 / (OMEGA * OMEGA - pulsation * pulsation).hypot(0.4 * pulsation)
}

/// A motion that a sine drives is where all others end that slide; no contact ever changes its state in it. It was once
/// said to have no size of its own, as a motion has that nothing drives and nothing damps, and a threshold beside it stayed
/// hidden.
#[test]
fn what_a_sine_drives_for_ever_is_an_attractor_though_its_contact_always_slides() {
    for frequency in [1.0, 1.2687] {
        let found = found(&driven_block(0.15, frequency), "mass.p.vx", &[0.0, 0.02, 0.3], 1e-2);
        let [slides, .., sticks] = &found.attractors[..] else { panic!("{:?}", found.attractors) };
        assert!(slides.kind == Kind::Periodic && sticks.kind.is_cycle(), "{sticks:?}");
        assert!((slides.amplitude / forced(frequency) - 1.0).abs() < 1e-6, "{slides:?}");
        assert!(!slides.taken[2] && sticks.amplitude > BELT / OMEGA, "{sticks:?}");
        let [threshold] = &found.thresholds[..] else { panic!("{:?}", found.thresholds) };
        assert_eq!(threshold.attractors, [0, 1]);
        // It has to reach the belt's velocity, damped a little on the way and helped or hindered by the sine.
        assert!((0.8 * BELT..1.2 * BELT).contains(&threshold.between[0]), "{threshold:?}");
    }
}

/// A block that sticks and slips under a sine of 1.4 Hz has lines 0.043 Hz beside that one, which a window of 50 s does not
/// tell apart: 1.387 Hz was told. Followed for 400 s by a time stepping of another author (Moreau and Jean), the strongest
/// line is the sine's.
#[test]
fn lines_that_lie_near_each_other_are_told_apart_over_several_windows() {
    let mut scene = driven_block(0.2, 1.4);
    for (name, value) in [("slider.velocity", -0.1), ("damper.d.damping", 0.6)] {
        assign(&mut scene, name, value).unwrap();
    }
    let found = found(&scene, "mass.p.vx", &[0.3], 1e-2);
    let [sticks] = &found.attractors[..] else { panic!("{:?}", found.attractors) };
    assert!((sticks.frequency.unwrap() - 1.4).abs() < 1e-3, "{sticks:?}");
}

/// Nothing damps the block, so each motion that stays slower than the belt goes on with the size that it has. Those that
/// stick lose energy until they just touch the belt's velocity, with an amplitude of v/ω₀, whatever they began with. Rounding
/// says whether such a motion sticks for an instant, and once decided whether it was an attractor.
#[test]
fn undamped_motions_that_have_stuck_all_end_in_the_one_that_just_touches_the_velocity_of_the_belt()
{
    let belt = builtin("belt").unwrap().scene();
    let amplitudes: Vec<f64> = (3..=20).map(|i| 0.017 * f64::from(i)).collect();
    let found = found(&belt, "mass.block.vx", &amplitudes, 1e-3);
    let [touches] = &found.attractors[..] else { panic!("{:?}", found.attractors) };
    assert!((touches.amplitude * OMEGA / BELT - 1.0).abs() < 1e-5, "{touches:?}");
    for run in &found.runs {
        assert_eq!(run.attractor, Some(0), "{}", run.amplitude);
    }
    let mut small = belt;
    assign(&mut small, "initial.mass.block.x", 0.0).unwrap();
    let small = self::found(&small, "mass.block.vx", &[0.03, 0.06, 0.09], 1e-3);
    assert!(small.attractors.is_empty(), "{:?}", small.attractors);
}

/// Let go at −d, a block that slides has its largest velocity, d ω₀ e^{−δt}, at t = atan2(ω_d, δ)/ω_d; let go at +d,
/// half a period later. Where that is the belt's velocity it sticks, and then slips and sticks for ever.
#[test]
fn a_block_sticks_and_slips_for_ever_once_it_has_reached_the_velocity_of_the_belt() {
    let zeta = 0.05;
    let (delta, omega) = (zeta * OMEGA, OMEGA * (1.0 - zeta * zeta).sqrt());
    let first = omega.atan2(delta) / omega;
    let reach = |time: f64| BELT / (OMEGA * (-delta * time).exp());
    let expected = [-reach(first), reach(first + std::f64::consts::PI / omega)];

    let amplitudes = [-0.02, -0.005, 0.001, 0.006, 0.02];
    let found = found(&damped_block(zeta), "mass.block.x", &amplitudes, 1e-7);
    assert_eq!(KINDS(&found), [Kind::Equilibrium, Kind::Periodic]);
    let [left, right] = &found.thresholds[..] else { panic!("{:?}", found.thresholds) };
    assert_eq!([left.attractors, right.attractors], [[1, 0], [0, 1]]);
    for (threshold, expected) in [left, right].into_iter().zip(expected) {
        let [below, above] = threshold.between;
        assert!(above - below <= 1e-7 * expected.abs() * (1.0 + 1e-6), "{threshold:?}");
        let miss = (0.5 * (below + above) / expected - 1.0).abs();
        assert!(miss < 1e-7, "{threshold:?}, by the closed form {expected}");
    }
    for run in &found.runs {
        let slides = (expected[0]..=expected[1]).contains(&run.amplitude);
        assert_eq!(run.attractor, Some(usize::from(!slides)), "{}", run.amplitude);
    }
}

/// A damping with which the block has lost the belt's velocity before it comes back from slipping.
#[test]
fn a_scene_without_a_limit_cycle_has_no_threshold() {
    let mut scene = damped_block(0.5);
    assign(&mut scene, "friction.static", 0.4).unwrap();
    let found = found(&scene, "mass.block.x", &[-0.1, -0.01, 0.0, 0.01, 0.1], 1e-3);
    assert_eq!((KINDS(&found), found.runs.len()), (vec![Kind::Equilibrium], 5));
    assert!(found.thresholds.is_empty());
}

// ---- The paper's Set 2 ----

const PUSHED: &str = "initial.module[1].v2";

fn set2() -> Scene {
    let mut scene = builtin("set2").unwrap().scene();
    assign(&mut scene, PUSHED, 0.0).unwrap();
    scene
}

/// Below this push no contact ever sticks, so that the motion is linear and decays: from a run so small that it is
/// linear, the push with which the slip velocity of one contact first vanishes.
fn first_sticks() -> f64 {
    let (mut scene, small) = (set2(), 1e-4);
    let observation = looked(&scene);
    pace(&mut scene, &observation);
    assign(&mut scene, PUSHED, small).unwrap();
    let velocity = scene.slider.velocity;
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let mut largest = 0.0;
    for i in 1..=20_000 {
        simulation.advance_to(f64::from(i) * 1e-4).unwrap();
        for slip in simulation.contact_forces().unwrap().iter().map(|force| force.slip_velocity) {
            largest = f64::max(largest, velocity - slip);
        }
    }
    assert_eq!(simulation.statistics().state_changes(), 0);
    small * velocity / largest
}

#[test]
fn a_small_push_of_set_2_decays_and_a_large_one_makes_it_squeal() {
    let sticks = first_sticks();
    let found = found(&set2(), PUSHED, &[1e-4, 0.99 * sticks, 0.3], 1e-3);
    assert_eq!(KINDS(&found)[0], Kind::Equilibrium);
    assert!(found.attractors[1..].iter().all(|ending| ending.kind.is_cycle()));
    let threshold = found.thresholds[0];
    let [below, above] = threshold.between;
    assert!(threshold.attractors[0] == 0 && threshold.attractors[1] > 0, "{threshold:?}");
    assert!(below >= 0.99 * sticks && above - below <= 1e-3 * above, "{threshold:?} {sticks}");

    // Fig. 5: what is just below is soon smaller than it was, what is just above larger.
    let mut scene = set2();
    let observation = looked(&scene);
    pace(&mut scene, &observation);
    let largest = |amplitude: f64| {
        let rows =
            history(&scene, (PUSHED, amplitude), &observation, 8.0, &|| false).unwrap().unwrap();
        rows[rows.len() - 5000..].iter().fold(0.0, |most, x| f64::max(most, x.abs()))
    };
    assert!(largest(above) > 10.0 * largest(below));
}

/// The paper's scheme has order 1, so its threshold comes to that of exact motion with the step.
#[test]
fn the_threshold_of_the_papers_scheme_comes_to_that_of_exact_motion_with_order_1() {
    // One threshold lies between these, m/s.
    let bracket = [0.231, 0.235];
    let middle = |found: &Perturbations| {
        let [threshold] = &found.thresholds[..] else { panic!("{:?}", found.thresholds) };
        threshold.between.iter().sum::<f64>() / 2.0
    };
    let exact = middle(&found(&set2(), PUSHED, &bracket, 1e-6));
    let miss = |step: f64| {
        let mut scene = set2();
        scene.step = step;
        middle(&with_method(&scene, PUSHED, &bracket, 1e-6)) - exact
    };
    let [coarse, fine] = [miss(5e-6), miss(2.5e-6)];
    let order = (coarse / fine).log2();
    // At these steps the remaining part of order 2 is a tenth of the whole.
    assert!((order - 1.0).abs() < 0.15, "{order}: {coarse:e} and {fine:e}");
    assert!(fine.abs() < 2e-4 * exact);
}

// ---- The program ----

#[test]
fn the_program_tells_and_draws_thresholds() {
    let folder = folder();
    let arguments = [
        "study",
        "perturbation",
        "set2",
        "--direction=module[1].v2",
        "--amplitude=0.05:0.25/3",
        "--resolution=0.05",
        "-o=out",
    ];
    let output = amontons(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    for word in ["rest", "Hz", "thresholds, to a relative accuracy of 5e-2", "below 1, above"] {
        assert!(told.contains(word), "{word} is missing in {told}");
    }
    let read = |file: &str| std::fs::read_to_string(folder.path().join("out").join(file)).unwrap();
    let csv = read("results.csv");
    assert_eq!(csv.lines().next(), Some("amplitude,kind,attractor,final_amplitude,frequency,time"));
    assert!(csv.lines().nth(1).unwrap().starts_with("0.05,equilibrium,1,"), "{csv}");
    assert!(read("perturbation.svg").contains("threshold"));
    assert!(read("histories.svg").contains("Time [s]"));
    let study: serde_json::Value = serde_json::from_str(&read("study.json")).unwrap();
    let between = &study["results"]["found"]["thresholds"][0]["between"];
    let [below, above] = [0, 1].map(|place| between[place].as_f64().unwrap());
    assert!(below < above && above - below <= 0.05 * above, "{between}");
    // A finer look has all that was found.
    let before = read("journal.jsonl").lines().count();
    let finer =
        arguments.map(|word| if word.contains("resolution") { "--resolution=0.01" } else { word });
    assert!(amontons(folder.path(), &finer).status.success());
    assert!((1..=2).contains(&(read("journal.jsonl").lines().count() - before)));
}

#[test]
fn perturbations_that_make_no_sense_are_refused_with_what_would() {
    let folder = folder();
    let refused = |direction: &str, amplitude: &str, more: &[&str], code, words: &[&str]| {
        let all =
            ["study", "perturbation", "set2", "--direction", direction, "--amplitude", amplitude];
        assert_refused(&amontons(folder.path(), &[&all, more].concat()), code, words);
    };
    let v2 = "module[1].v2";
    refused(
        "module[1].w2",
        "0:1/3",
        &[],
        2,
        &["no initial value module[1].w2", "initial.module[1]."],
    );
    refused(v2, "0:1", &[], 2, &["A:B/N"]);
    refused(v2, "1:0/3", &[], 2, &["first value must be below the last"]);
    refused(v2, "0:1/3", &["--resolution", "2"], 2, &["--resolution", "1e-3"]);
    std::fs::write(folder.path().join("file"), "").unwrap();
    refused(v2, "0:1/3", &["-o", "file"], 1, &["file"]);
}
