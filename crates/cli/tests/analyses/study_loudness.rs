//! Tests of the loudness of motions: known motions of the paper's sets, powers against a quadrature of their own, the balance
//! of energy, and the program.

use crate::program::{assert_refused, folder, run, text};
use amontons::integrator::Motion;
use amontons::scene::{Scene, builtin, parse};
use amontons::simulation::Simulation;
use amontons_analysis::assign::assign;
use amontons_analysis::study::loudness::{
    Loudness, LoudnessQuestion, Measured, WayKind, loudness, measured_points, ways,
};
use amontons_analysis::study::{
    Journal, Kind, ObservationRequest, ObservationSettings, Push, Watch,
};
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

fn amontons(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_amontons"), folder, arguments)
}

/// A built-in scene at rest with other values, by exact motion.
fn scene_of(name: &str, values: &[(&str, f64)]) -> (Scene, ObservationSettings) {
    let mut scene = builtin(name).unwrap().scene();
    for (name, value) in values {
        assign(&mut scene, name, *value).unwrap();
    }
    scene.rest();
    let observation =
        ObservationSettings::paced(&mut scene, &ObservationRequest::default()).unwrap();
    (scene, observation)
}

fn found(scene: &Scene, observation: &ObservationSettings) -> Loudness {
    let question = LoudnessQuestion {
        push: Push::of(scene).velocity,
        points: measured_points(scene, &[]).unwrap(),
    };
    let ways = ways(scene, 20, Watch::IDLE).unwrap();
    loudness(scene, &ways, &question, observation, &Journal::forgotten(), Watch::IDLE)
        .unwrap()
        .unwrap()
}

/// After a period the stored energy is what it was: friction feeds in what dampers and impacts take.
fn assert_balanced(measured: &Measured) {
    let power = measured.power.as_ref().unwrap();
    let taken = power.damping + power.impact;
    assert!((power.friction / taken - 1.0).abs() < 1e-6, "{power:?}");
    let sum: f64 = power.contacts.iter().map(|one| one.power).sum();
    assert!((sum / power.friction - 1.0).abs() < 1e-12, "{power:?}");
    let energy = power.energy.unwrap();
    assert!((energy / (taken * measured.span) - 1.0).abs() < 1e-6, "{power:?}");
}

/// Mean power T u_T of each contact over a period (s) in which contacts do not land, and the mean square of the speed of
/// module 1's mass m2, (m/s)², by the trapezoidal rule from rows of the motion.
fn quadrature(simulation: &mut Simulation, period: f64) -> ([f64; 2], f64) {
    const ROWS: u32 = 40_000;
    let start = simulation.time();
    let (mut powers, mut square) = ([0.0; 2], 0.0);
    for row in 0..=ROWS {
        simulation.advance_to(start + f64::from(row) / f64::from(ROWS) * period).unwrap();
        let weight = if row == 0 || row == ROWS { 0.5 } else { 1.0 } / f64::from(ROWS);
        let forces = simulation.contact_forces().unwrap().to_vec();
        let v = simulation.velocity();
        for (contact, power) in powers.iter_mut().enumerate() {
            *power += weight * forces[contact].friction_force * v[4 * contact + 2];
        }
        square += weight * (v[2] * v[2] + v[3] * v[3]);
    }
    (powers, square)
}

/// A motion that flies, lands and slips, whose amplitude is that of a table of limit cycles (docs/analyses/limit-cycles.md).
#[test]
fn what_friction_feeds_into_a_cycle_with_impacts_is_what_dampers_and_impacts_take() {
    let values = [("friction.coefficient", 1.5), ("slider.velocity", 0.25)];
    let (scene, observation) = scene_of("set1", &values);
    let found = found(&scene, &observation);
    let [row] = &found.rows[..] else { panic!("{found:?}") };
    let motion = &found.motions[row.attempt().motion.unwrap()];
    assert_eq!(motion.ending.kind, Kind::Periodic);
    assert!((motion.ending.amplitude / 6.53483e-4 - 1.0).abs() < 1e-4, "{:?}", motion.ending);
    let measured = motion.measured.as_ref().unwrap();
    assert!(measured.power.as_ref().unwrap().impact > 0.0);
    assert_balanced(measured);
    // Masses that fly move along the normal, too.
    assert!(measured.loudest_along_normal().unwrap().normal_rms.unwrap() > 0.0);
}

#[test]
fn powers_of_each_contact_and_speeds_are_those_of_a_quadrature_of_the_run() {
    let (scene, observation) = scene_of("set1", &[("friction.coefficient", 1.5)]);
    let found = found(&scene, &observation);
    let motion = &found.motions[found.rows[0].attempt().motion.unwrap()];
    let measured = motion.measured.as_ref().unwrap();
    assert_balanced(measured);
    let mut simulation = Simulation::new(scene, 0.0).unwrap();
    let mut velocity = vec![0.0; 8];
    velocity[1] = 1e-3;
    let states = simulation.contact_states().to_vec();
    simulation.go_on_from(&Motion::new(vec![0.0; 8], velocity, states));
    simulation.advance_to(30.0).unwrap();
    // Contacts slide and stick without landing. Jumps of T at the beginning of sticking cost parts of a row.
    let (powers, square) = quadrature(&mut simulation, motion.ending.period.unwrap());
    for (contact, power) in measured.power.as_ref().unwrap().contacts.iter().zip(powers) {
        assert!((contact.power / power - 1.0).abs() < 1e-3, "{contact:?} {power}");
    }
    let rms = measured.points[0].rms;
    assert!((rms / square.sqrt() - 1.0).abs() < 1e-5, "{rms} {}", square.sqrt());
    assert_eq!(measured.points[0].normal_rms, Some(0.0));
}

/// The paper's Figs. 5 and 6: a large push makes Set 2 squeal with both contacts sticking together, though sliding is stable.
#[test]
fn candidates_of_the_stable_sliding_of_set_2_lead_to_its_squeal() {
    let (scene, observation) = scene_of("set2", &[("friction.coefficient", 1.96)]);
    let found = found(&scene, &observation);
    assert!(!found.grows && !found.rows.is_empty());
    for row in &found.rows {
        assert_eq!(row.way.kind, WayKind::Candidate);
        let motion = &found.motions[row.attempt().motion.unwrap()];
        assert!((motion.ending.amplitude / 3.443e-4 - 1.0).abs() < 1e-3, "{:?}", motion.ending);
        assert!((motion.ending.frequency.unwrap() - 167.27).abs() < 0.01);
        assert_balanced(motion.measured.as_ref().unwrap());
        assert_eq!((row.attempt().meets, row.loudness_rank), (Some(false), Some(1)));
        // A small push decays.
        assert!(row.attempts.iter().any(|attempt| attempt.ending.as_ref().unwrap().rests()));
    }
    assert!(
        found
            .findings
            .iter()
            .any(|said| said.contains("not seen to take the states Sl-St together"))
    );
    assert!(found.findings.last().unwrap().contains("lead to the same one"));
}

/// At µ = 1.96 only the mode at 219 Hz grows, and the motion that the paper shows (Fig. 4) has its strongest line at 167 Hz.
#[test]
fn the_growing_mode_of_set_1_leads_to_a_motion_with_the_frequency_of_another_mode() {
    let (scene, observation) = scene_of("set1", &[]);
    let found = found(&scene, &observation);
    let [row] = &found.rows[..] else { panic!("{found:?}") };
    assert!((row.way.frequency - 219.4).abs() < 0.1 && row.way.growth_rate > 0.0);
    let motion = &found.motions[row.attempt().motion.unwrap()];
    assert!(motion.ending.kind.is_cycle() && motion.ending.kind != Kind::Periodic);
    let nearest = motion.nearest.as_ref().unwrap();
    assert!(!nearest.modes.contains(&row.way.number) && nearest.growth_rate < 0.0, "{nearest:?}");
    let measured = motion.measured.as_ref().unwrap();
    assert!(!measured.is_period && measured.power.as_ref().unwrap().energy.is_none());
    let [said] = &found.findings[..] else { panic!("{:?}", found.findings) };
    assert!(said.contains("alone grows, but its motion has 167"), "{said}");
}

/// On a belt with v = 0.1 m/s a mass of 1 kg on a spring of 100 N/m begins without a spring force. It sticks for 0.4 s, until
/// the spring has the force µN = 4 N: the work is ½ k (v t)² = 0.08 J. Then it slips under 4 N, and moves by (v/ω) sin ω t.
#[test]
fn friction_works_on_a_mass_that_sticks_as_its_spring_is_stretched_and_then_as_it_moves() {
    for (method, step) in [("event-driven", 1e-2), ("forward-increment", 1e-5)] {
        let text = format!(
            "integrator = {{ method = \"{method}\", step = {step} }}\n\
             slider = {{ velocity = 0.1, angle = 0.0 }}\nfriction = {{ coefficient = 0.4 }}\n\
             mass = [{{ name = \"m\", mass = 1.0, force = [0.0, -10.0] }}]\n\
             spring = [{{ name = \"k\", between = [\"m\", \"ground\"], direction = \"x\", stiffness = 100.0 }}]\n\
             contact = [{{ name = \"belt\", mass = \"m\" }}]\n\
             initial = [{{ mass = \"m\", x = -0.04, vx = 0.1 }}]\neffects = {{ energy = true }}\n"
        );
        let mut simulation = Simulation::new(parse("belt", &text).unwrap(), 0.0).unwrap();
        for visits in [false, true] {
            if visits {
                simulation.record_visits().unwrap();
            }
            let before = simulation.time();
            simulation.advance_to(before + 0.9).unwrap();
            if !visits {
                let expected = 0.08 + 0.04 * f64::sin(5.0);
                let [work] = simulation.friction_work().unwrap() else { panic!() };
                let budget = if method == "event-driven" { 1e-12 } else { 10.0 * step };
                assert!((work - expected).abs() < budget, "{method}: {work} {expected}");
            }
        }
        // A log of visits begins a count of its own.
        let energy = simulation.energy().unwrap();
        let [work] = simulation.friction_work().unwrap() else { panic!() };
        assert!((work - (energy.slider - energy.friction)).abs() > 1e-3);
    }
}

// ---- The program ----

const SET1: [&str; 5] =
    ["study", "loudness", "set1", "--set=friction.coefficient=3", "--pictures=png"];

#[test]
fn the_program_tells_growth_beside_loudness_and_an_interrupted_study_ends_with_the_same_bytes() {
    let folder = folder();
    let output = amontons(folder.path(), &[&SET1[..], &["-o=out"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    for word in [
        "2 growing modes",
        "mode 4 ",
        "mode 6 ",
        "motion 1: periodic",
        "contact[2]: friction feeds in",
        "the contacts miss the energy ledger by",
        "mode 6 grows more slowly, but its motion has",
    ] {
        assert!(told.contains(word), "{word} is missing in {told}");
    }
    let path = |file: &str| folder.path().join("out").join(file);
    let files = ["results.csv", "study.json", "loudness.png"];
    let before = files.map(|file| fs::read(path(file)).unwrap());
    let csv = String::from_utf8(before[0].clone()).unwrap();
    let head: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    assert!(
        csv.lines().count() == 3 && csv.lines().all(|row| row.split(',').count() == head.len())
    );
    // The second piece was being written when the study was killed.
    let journal = fs::read_to_string(path("journal.jsonl")).unwrap();
    let whole: usize = journal.split_inclusive('\n').take(2).map(str::len).sum();
    fs::write(path("journal.jsonl"), &journal[..whole + 20]).unwrap();
    for file in files {
        fs::remove_file(path(file)).unwrap();
    }
    let again = amontons(folder.path(), &[&SET1[..], &["-o=out"]].concat());
    assert_eq!(text(&again.stdout), told);
    for (file, before) in files.iter().zip(before) {
        assert!(fs::read(path(file)).unwrap() == before, "{file}");
    }
}

#[test]
fn a_scene_without_a_growing_mode_or_candidate_has_that_as_its_result() {
    let folder = folder();
    let arguments = ["study", "loudness", "set2", "--set=friction.coefficient=0.1", "-o=out"];
    let output = amontons(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert!(told.contains("no mode of uniform sliding grows, and there is no candidate"), "{told}");
    let csv = fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1);
}

#[test]
fn loudness_that_makes_no_sense_is_refused_with_what_would() {
    let folder = folder();
    let refused = |more: &[&str], code, words: &[&str]| {
        let all = [&["study", "loudness"], more].concat();
        assert_refused(&amontons(folder.path(), &all), code, words);
    };
    refused(
        &["set1", "--points", "module[1].m2,modul[2].m2"],
        2,
        &["no point modul[2].m2", "did you mean module[2].m2?"],
    );
    refused(&["set1", "--push", "0"], 2, &["--push"]);
    refused(&["set1", "--push", "-1e-3"], 2, &["--push"]);
    refused(&["den_hartog"], 2, &["den_hartog has signals", "study transient"]);
    refused(&["set1", "--set", "slider.velocity=0"], 3, &["no surface moves"]);
    refused(&["set1", "--shard", "1/2"], 2, &["-o"]);
}

/// The search for candidates among the 4^8 contact states of eight modules takes long.
#[test]
fn points_are_checked_before_the_search_for_candidates_which_ctrl_c_ends() {
    let folder = folder();
    let ring = builtin("set2").unwrap().text.replace("modules = 2", "modules = 8");
    fs::write(folder.path().join("ring.toml"), ring).unwrap();
    // Uniform sliding is stable.
    let study = ["study", "loudness", "ring.toml", "--set=friction.coefficient=1", "-o=out"];
    let begun = Instant::now();
    let refused = amontons(folder.path(), &[&study[..], &["--points=module[9].m2"]].concat());
    assert_refused(&refused, 2, &["no point module[9].m2", "module[1].m1"]);
    assert!(begun.elapsed() < Duration::from_secs(5));
    let mut command = Command::new(env!("CARGO_BIN_EXE_amontons"));
    command.current_dir(folder.path()).args(study);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_refused(&output, 130, &["interrupted"]);
    assert!(!folder.path().join("out").exists());
}
