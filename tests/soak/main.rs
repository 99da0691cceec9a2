//! Random scenes of every kind, run by each integrator that takes them, with the law of contact judged after every
//! step.
//!
//! This is a tool to be run by hand, and no test of each change: each run draws scenes of its own, and one run of exact motion
//! in some ten thousands ends early (`docs/decisions/judging.md` has the counts). So `cargo test` leaves it out unless it
//! is asked for:
//!
//! ```sh
//! AMONTONS_SOAK_SCENES=1000 cargo test --release --test soak -- --nocapture
//! ```
//!
//! | variable | what it sets |
//! | --- | --- |
//! | `AMONTONS_SEED` | the seed; the seconds since 1970 unless given, so that each run has scenes of its own |
//! | `AMONTONS_SOAK_SCENES` | how many scenes are run, 100 unless given: half a minute for 1000 on two cores |
//! | `AMONTONS_SOAK_SCENE` | the number of the only scene that is run |
//! | `AMONTONS_SOAK_FILE` | a scene file that is run to its stop time in place of random scenes, by its own integrator; superelements are packed ones, as `resources/` of an FMU has them |
//!
//! The seed is printed first. A scene that fails is made as small as it goes and written to a file, whose name is printed
//! last.

mod apart;
mod case;
mod drive;
mod file;
// The closed forms are for other tests.
#[allow(dead_code)]
#[path = "../support/judge/mod.rs"]
mod judge;
mod minimise;
mod network;
mod outcome;
mod random;
mod ring;
mod tally;

use case::{Case, Plan};
use outcome::{Outcome, Report};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};
use tally::Tallies;

/// Number of scenes that are run unless another number is given.
const SCENES: u64 = 100;
/// Number of runs of which one may end early.
const RUNS_TO_ONE_EARLY_END: u64 = 10_000;
/// Limit of the number of failures that are minimised and written to files, each of another class.
const FILES: usize = 20;

/// The number that a variable of the environment gives.
fn given(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name} = {text:?} is no whole number")))
}

fn seconds_since_1970() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs())
}

/// A run that failed.
#[derive(Clone)]
struct Failure {
    scene: u64,
    case: Case,
    plan: Plan,
    outcome: Outcome,
}

/// State that all threads share.
struct Soak {
    seed: u64,
    next: AtomicU64,
    end: u64,
    tallies: Mutex<Tallies>,
    failures: Mutex<Vec<Failure>>,
}

impl Soak {
    fn new(seed: u64, scenes: std::ops::Range<u64>) -> Self {
        let tallies = judge::METHODS.map(|method| (method, tally::Tally::default()));
        Self {
            seed,
            next: AtomicU64::new(scenes.start),
            end: scenes.end,
            tallies: Mutex::new(tallies),
            failures: Mutex::new(Vec::new()),
        }
    }

    /// Runs scenes until none is left.
    fn work(&self) {
        loop {
            let scene = self.next.fetch_add(1, Ordering::Relaxed);
            if scene >= self.end {
                return;
            }
            let case = Case::drawn(self.seed, scene);
            for plan in case.plans {
                let report = outcome::run(&case, plan);
                self.take(scene, &case, plan, report);
            }
        }
    }

    fn take(&self, scene: u64, case: &Case, plan: Plan, report: Report) {
        let mut tallies = self.tallies.lock().unwrap();
        let own = tallies.iter_mut().filter(|(method, _)| *method == plan.method);
        own.for_each(|(_, tally)| tally.add(&report));
        drop(tallies);
        if report.outcome.is_failure() {
            println!("scene {scene}, {}: {:?}", plan.method, report.outcome);
            let failure = Failure { scene, case: case.clone(), plan, outcome: report.outcome };
            self.failures.lock().unwrap().push(failure);
        }
    }
}

/// Makes the first failure of each class small, writes it to a file, and tells of it.
fn written(seed: u64, failures: &[Failure]) -> String {
    let mut firsts = BTreeMap::new();
    for failure in failures {
        let key = (failure.plan.method.to_string(), failure.outcome.class());
        firsts.entry(key).or_insert(failure);
    }
    let mut told = String::new();
    for failure in firsts.into_values().take(FILES) {
        let path = write(seed, failure);
        let Failure { scene, plan, outcome, .. } = failure;
        writeln!(
            told,
            "{}: {outcome:?}, as AMONTONS_SEED={seed} AMONTONS_SOAK_SCENE={scene} with {} runs it",
            path.display(),
            plan.method
        )
        .expect("a string takes all");
    }
    told
}

fn write(seed: u64, failure: &Failure) -> PathBuf {
    let Failure { scene, case, plan, outcome } = failure;
    let (small, plan) = minimise::smallest(case, *plan, outcome);
    let mut scene_of_it = small.planned(plan);
    // One line, as a file has it.
    scene_of_it.description = outcome.class().replace(['"', '\\'], "'");
    let name = format!("soak_{seed}_{scene}_{}.toml", plan.method);
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, file::text(&scene_of_it)).expect("a temporary file");
    path
}

/// Runs the scene of a file.
fn run_file(path: &str) {
    let (scene, _) = amontons::scene::read(Path::new(path)).unwrap();
    outcome::listen_to_panics();
    let report = outcome::run_scene(scene);
    let _ = std::panic::take_hook();
    println!("{report:#?}");
    assert_eq!(report.outcome, Outcome::Kept);
}

#[test]
fn any_scene_obeys_the_law_of_contact_after_every_step() {
    if let Ok(path) = std::env::var("AMONTONS_SOAK_FILE") {
        return run_file(&path);
    }
    let scenes = match (given("AMONTONS_SOAK_SCENE"), given("AMONTONS_SOAK_SCENES")) {
        (Some(scene), _) => scene..scene + 1,
        (None, scenes) => 0..scenes.unwrap_or(SCENES),
    };
    let seed = given("AMONTONS_SEED").unwrap_or_else(seconds_since_1970);
    println!("AMONTONS_SEED={seed}, scenes from {} and below {}", scenes.start, scenes.end);
    let usual = std::panic::take_hook();
    outcome::listen_to_panics();
    let soak = Soak::new(seed, scenes);
    let threads = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| soak.work());
        }
    });
    let mut failures = soak.failures.into_inner().unwrap();
    failures.sort_by_key(|failure| failure.scene);
    let told = written(seed, &failures);
    std::panic::set_hook(usual);
    let tallies = soak.tallies.into_inner().unwrap();
    let mut all = tally::Tally::default();
    for (method, tally) in tallies {
        println!("{method}: {tally}");
        all.merge(tally);
    }
    assert!(all.kept > 0, "no scene was run to its end");
    assert_eq!(all.broke(), 0, "runs broke the law of contact:\n{told}");
    let allowed = all.to_end() / RUNS_TO_ONE_EARLY_END;
    assert!(
        all.early() <= allowed,
        "{} of {} runs ended early, and {allowed} may:\n{told}",
        all.early(),
        all.to_end()
    );
}
