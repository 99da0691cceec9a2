//! One run of a scene under the eyes of the judge, and what it came to.

use crate::case::{Case, Plan};
use crate::file;
use crate::judge::{LetOff, Run};
use amontons::Error;
use amontons::scene::{Method, Scene, parse};
use amontons::simulation::Simulation;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Missing the law by less than this part of the largest forces and velocities is rounding: masses differ by up to
/// four orders of magnitude and stiffnesses by six, each of which costs a digit.
const FORGIVEN: f64 = 1e-8;
/// The energy that may be missing in exact motion, as a part of what was turned over.
const ENERGY: f64 = 1e-8;
/// A run that computes for longer than this is given up.
pub const LONGEST: Duration = Duration::from_secs(10);
/// A run whose judge takes longer than this is judged no further.
const LONGEST_JUDGED: Duration = Duration::from_secs(30);

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Every step obeys the law.
    Kept,
    /// The scene was not taken, for this reason.
    Refused(String),
    /// The run ended since no contact forces obey the law.
    NoSolution(String),
    /// The run ended, for another reason.
    Early(String),
    /// A step breaks the law, or the program has panicked.
    Broke(String),
}

impl Outcome {
    /// Class of outcomes of one kind: the reason without names and numbers.
    pub fn class(&self) -> String {
        match self {
            Self::Kept => "kept the law".to_owned(),
            Self::Refused(why) | Self::NoSolution(why) | Self::Early(why) | Self::Broke(why) => {
                class_of(why)
            }
        }
    }

    pub fn is_failure(&self) -> bool {
        matches!(self, Self::Early(_) | Self::Broke(_))
    }

    /// `true` if the other outcome is a failure of the same class.
    pub fn is_like(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
            && self.class() == other.class()
    }
}

/// A message with a mark in place of each number and each name of a part.
fn class_of(message: &str) -> String {
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '[' | ']');
    let mark = |word: &str| {
        let parts = ["contact.", "mass.", "module[", "spring.", "contact["];
        let stripped = word.trim_matches(|c: char| ",:;()".contains(c));
        let is_marked = stripped.parse::<f64>().is_ok()
            || parts.iter().any(|part| word.starts_with(part))
            || (!stripped.is_empty() && stripped.chars().all(is_number));
        if is_marked { "#".to_owned() } else { word.to_owned() }
    };
    // Lists and values that follow are of one scene.
    let words = message
        .split_whitespace()
        .take_while(|word| !word.contains(['{', '[']) || word.starts_with("module["));
    words.map(mark).take(16).collect::<Vec<String>>().join(" ")
}

/// A run with all that is counted of it.
#[derive(Clone, Debug)]
pub struct Report {
    pub outcome: Outcome,
    /// Steps that were judged.
    pub steps: u32,
    pub let_off: LetOff,
    /// Hops that exact motion has ended before they began.
    pub ended_hops: u64,
    /// Did the judge take too long for the rest of the run?
    pub cut_short: bool,
}

impl Report {
    fn of(outcome: Outcome) -> Self {
        Self { outcome, steps: 0, let_off: LetOff::default(), ended_hops: 0, cut_short: false }
    }
}

thread_local! {
    /// Message of the last panic of this thread.
    static SAID: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Keeps what panics say for [`run`], instead of printing it.
pub fn listen_to_panics() {
    std::panic::set_hook(Box::new(|info| {
        let place = info.location().map_or_else(String::new, |at| format!("{}:", at.file()));
        let payload = info.payload();
        let message = payload.downcast_ref::<String>().map(String::as_str);
        let message = message.or_else(|| payload.downcast_ref().copied()).unwrap_or_default();
        SAID.with(|said| *said.borrow_mut() = format!("{place} {message}"));
    }));
}

/// Runs a case by one of its plans.
pub fn run(case: &Case, plan: Plan) -> Report {
    reported(|report| match read_again(case.planned(plan)) {
        Ok(scene) => judged(scene, plan, [LONGEST, LONGEST_JUDGED], report),
        Err(refused) => refused,
    })
}

/// Runs a scene by its own plan, for as long as it takes.
pub fn run_scene(scene: Scene) -> Report {
    let plan = Plan::of(&scene);
    reported(|report| judged(scene, plan, [Duration::MAX; 2], report))
}

/// The report of a run, which may panic.
fn reported(run: impl FnOnce(&mut Report) -> Outcome) -> Report {
    let mut report = Report::of(Outcome::Kept);
    match catch_unwind(AssertUnwindSafe(|| run(&mut report))) {
        Ok(outcome) => report.outcome = outcome,
        Err(_) => report.outcome = panicked(SAID.with(|said| said.borrow().clone())),
    }
    report
}

/// Outcome of a run that ended in a panic with this message.
fn panicked(said: String) -> Outcome {
    // The judge takes parts of steps again, and one of them may end.
    if said.contains("`Err` value: Step(") { end_of(said) } else { Outcome::Broke(said) }
}

/// The scene as read from its text: the file of a failure must hold the scene that failed.
fn read_again(scene: Scene) -> Result<Scene, Outcome> {
    let read = parse("case", &file::text(&scene));
    let read = read.map_err(|error| Outcome::Refused(refusal(scene.method, &error)))?;
    assert_eq!(read, scene, "the file is another scene");
    Ok(read)
}

/// Runs a scene under the eyes of the judge. `limits` are the longest times of the run and of its judge.
fn judged(scene: Scene, plan: Plan, limits: [Duration; 2], report: &mut Report) -> Outcome {
    let method = scene.method;
    let simulation = match Simulation::new(scene, 0.0) {
        Ok(simulation) => simulation,
        Err(error) => return Outcome::Refused(refusal(method, &error)),
    };
    let mut run = Run::of(simulation);
    run.forgive(FORGIVEN);
    let outcome = steps(&mut run, plan, limits, report);
    report.let_off = std::mem::take(&mut run.let_off);
    report.ended_hops = run.simulation.statistics().ended_hops;
    outcome
}

/// The first line of a reason that says something, without the numbers of this scene.
fn refusal(method: Method, error: &Error) -> String {
    let text = error.to_string();
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    let line = lines.clone().find(|line| !line.ends_with(':')).unwrap_or_default();
    format!("{method}: {}", line.trim())
}

fn steps(run: &mut Run, plan: Plan, limits: [Duration; 2], report: &mut Report) -> Outcome {
    let [longest, longest_judged] = limits;
    let start = Instant::now();
    let mut judging = Duration::ZERO;
    let mut turned = 0.0;
    for _ in 0..plan.steps {
        let went = run.try_parts(|run| {
            let begun = Instant::now();
            run.judge_step();
            run.judge_report();
            judge_energy(run, &mut turned);
            report.let_off = run.let_off;
            judging += begun.elapsed();
        });
        if let Err(error) = went {
            return ended(&error);
        }
        report.steps += 1;
        if start.elapsed().saturating_sub(judging) > longest {
            return Outcome::Early(format!("takes longer than {} s", longest.as_secs()));
        }
        if judging > longest_judged {
            report.cut_short = true;
            break;
        }
    }
    Outcome::Kept
}

/// Outcome of a run that ended in an error.
fn ended(error: &Error) -> Outcome {
    let said = error.to_string();
    if error.is_step_too_large() {
        Outcome::Refused(format!("during the run: {said}"))
    } else {
        end_of(said)
    }
}

/// The outcome of a run that ended with this message.
fn end_of(said: String) -> Outcome {
    if said.contains("no contact force satisfies its law") {
        Outcome::NoSolution(said)
    } else {
        Outcome::Early(said)
    }
}

/// Asserts that exact motion has lost no energy, which the scheme does in proportion to its step; `turned` is what was turned over so far, J.
fn judge_energy(run: &Run, turned: &mut f64) {
    let Some(energy) = run.simulation.energy() else { return };
    let parts = energy.parts();
    let size = parts[..7].iter().map(|part| part.abs()).fold(0.0, f64::max);
    // All energies are differences from those at rest.
    *turned = f64::max(*turned, size.max(1e-4 * run.energy_at_rest()));
    assert!(parts.iter().all(|part| part.is_finite()), "energies are no numbers: {energy:?}");
    if run.method == Method::EventDriven {
        let missing = energy.residual.abs();
        assert!(missing <= ENERGY * *turned, "energy is missing: {energy:?}");
        // In an impact both directions take their parts of the energy together.
        let taken = energy.damping.min(energy.friction + energy.impact);
        let is_whole = run.model.law.sticking;
        assert!(!is_whole || taken >= -ENERGY * *turned, "friction gives energy: {energy:?}");
    }
}
