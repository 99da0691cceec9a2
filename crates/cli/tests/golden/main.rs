//! Today's behaviour, to the last bit: motions, saved states, model descriptions, output and exit codes of the command
//! line. The files in `tests/golden/` hold it, so that moved code is seen to do the same. A change of behaviour fails
//! here; `AMONTONS_WRITE=1 cargo test --release --locked --test golden` writes the files anew.
//!
//! Only what is the same on every machine is kept: no times, no bits of eigenvalues. A new version of the program
//! writes its number into FMUs, so it has other checksums.
#![allow(unsafe_code)] // The FMU's functions are C's.

#[path = "../../../../tests/support/c.rs"]
mod c;
mod cases;
mod commands;
mod description;
mod instance;
mod motion;
mod page;
// Its refusals are for other tests.
#[allow(dead_code)]
#[path = "../../../../tests/support/program.rs"]
mod program;

use amontons::simulation::Simulation;
use amontons_export::package;
use cases::{CASES, Case, Run};
use commands::COMMANDS;
use description::{checksum, shortened};
use fmu_check::Rule;
use instance::Instance;
use std::fmt::Write as _;
use std::fs;

const RULES: &str = "rules.txt";
const SAVED_STATES: &str = "saved_states.txt";

/// A scene's motions, or why there is none.
fn motions(case: &Case) -> String {
    let mut text = String::new();
    for run in case.runs() {
        let _ = writeln!(text, "{}: {}\n", case.name, run.name());
        let mut simulation = match Simulation::new(run.scene.clone(), 0.0) {
            Ok(simulation) => simulation,
            Err(error) => {
                let _ = writeln!(text, "refused: {error}\n");
                continue;
            }
        };
        for time in run.times(case.looks) {
            if let Err(error) = simulation.advance_to(time) {
                let _ = writeln!(text, "failed: {error}\n");
                break;
            }
            let _ = writeln!(text, "{}", motion::instant(&mut simulation));
        }
    }
    text
}

#[test]
fn motions_have_the_same_doubles_and_counts() {
    compare_each("motion", cases::all(), motions);
}

#[test]
fn model_descriptions_are_the_same() {
    compare_each("description", CASES.iter(), |case| {
        let (scene, source) = case.read();
        shortened(&package::model_description(&scene, &source, None))
    });
}

/// A page a scene.
#[track_caller]
fn compare_each(
    what: &str,
    cases: impl Iterator<Item = &'static Case>,
    page: impl Fn(&Case) -> String,
) {
    let pages: Vec<_> = cases.map(|case| (file(what, case.name), page(case))).collect();
    page::compare(&pages);
}

fn file(what: &str, name: &str) -> String {
    format!("{what}_{name}.txt")
}

/// Each scene that starts, with each integrator.
fn starting() -> impl Iterator<Item = (&'static Case, Run)> {
    let all = cases::all().flat_map(|case| case.runs().map(move |run| (case, run)));
    all.filter(|(_, run)| Simulation::new(run.scene.clone(), 0.0).is_ok())
}

#[test]
fn a_saved_motion_goes_on_with_the_same_doubles_in_a_new_simulation() {
    for (case, run) in starting() {
        let name = format!("{}: {}", case.name, run.name());
        let start = || Simulation::new(run.scene.clone(), 0.0).unwrap();
        let times: Vec<f64> = run.times(4).collect();
        let mut straight = start();
        for time in &times[..2] {
            straight.advance_to(*time).unwrap();
        }
        let saved = straight.save();
        let mut restored = start();
        restored.restore(&saved).unwrap();
        let mut resumed = Simulation::resume(saved).unwrap();
        for time in &times[2..] {
            let mut all = [&mut straight, &mut restored, &mut resumed];
            all.iter_mut().for_each(|simulation| simulation.advance_to(*time).unwrap());
            let [expected, restored, resumed] = all.map(motion::instant);
            assert_eq!(restored, expected, "{name}, restored");
            assert_eq!(resumed, expected, "{name}, resumed");
        }
    }
}

#[test]
fn saved_states_are_the_same_bytes_and_go_on_with_the_same_doubles_in_a_new_instance() {
    let mut page = String::new();
    for (case, run) in starting() {
        let name = format!("{}: {}", case.name, run.name());
        let times: Vec<f64> = [0.0].into_iter().chain(run.times(4)).collect();
        let mut straight = Instance::new(&run.scene, &run.source);
        let _ = writeln!(page, "{name}, at the start: {}", in_short(&straight.save()));
        for leg in times[..3].windows(2) {
            straight.step(leg[0], leg[1]);
        }
        let saved = straight.save();
        let _ = writeln!(page, "{name}, at {} s: {}", times[2], in_short(&saved));
        let mut resumed = Instance::new(&run.scene, &run.source);
        resumed.restore(&saved);
        assert!(resumed.save() == saved, "{name}");
        for leg in times[2..].windows(2) {
            straight.step(leg[0], leg[1]);
            resumed.step(leg[0], leg[1]);
            assert!(resumed.read() == straight.read(), "{name}, at {} s", leg[1]);
        }
        let end = straight.save();
        assert!(resumed.save() == end, "{name}");
        let _ = writeln!(page, "{name}, at {} s: {}", times[4], in_short(&end));
    }
    page::compare(&[(SAVED_STATES.to_owned(), page)]);
}

/// Saved bytes by their number and a checksum. They end in a checksum of the same kind, and with it all bytes would have
/// one and the same: it is left out.
fn in_short(saved: &[u8]) -> String {
    let (content, _) = saved.split_at(saved.len() - 4);
    format!("{}, and 4 more", checksum(content))
}

#[test]
fn the_programs_print_the_same_and_end_with_the_same_codes() {
    let pages = COMMANDS.map(|(name, commands)| (file("commands", name), commands::page(commands)));
    page::compare(&pages);
}

#[test]
fn the_checker_has_the_same_rules() {
    let rules = Rule::ALL.iter().map(|rule| format!("{}: {}\n", rule.id(), rule.line()));
    page::compare(&[(RULES.to_owned(), rules.collect())]);
}

#[test]
fn no_golden_file_is_left_over() {
    let motions = cases::all().map(|case| file("motion", case.name));
    let descriptions = CASES.iter().map(|case| file("description", case.name));
    let commands = COMMANDS.map(|(name, _)| file("commands", name));
    let others = [RULES, SAVED_STATES].map(str::to_owned);
    let known: Vec<String> = motions.chain(descriptions).chain(commands).chain(others).collect();
    for entry in fs::read_dir(page::folder()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let is_page = name.ends_with(".txt");
        assert!(
            !is_page || known.contains(&name),
            "crates/cli/tests/golden/{name} is of no test: delete it"
        );
    }
}
