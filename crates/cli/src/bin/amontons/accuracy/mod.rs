//! `amontons accuracy`: the computing time for a given accuracy, on the user's own scene.

mod chart;
mod output;

use crate::arguments::Accuracy;
use crate::reference::{self, REFERENCE_SHARE};
use amontons::scene::Method;
use amontons::simulation::Simulation;
use amontons_analysis::accuracy::{ConvergenceStudy, Row, StepCandidate, assign, dof_named, short};
use amontons_analysis::sweep::range::check_once;
use amontons_analysis::watch::Watch;
use amontons_cli::arguments::Format;
use amontons_cli::interrupt::{self, Interrupted, stopped};
use amontons_cli::progress::Progress;
use amontons_export::scene;
use amontons_pictures::picture;
use std::error::Error;
use std::io::{ErrorKind, stdout};
use std::ops::ControlFlow::{self, Break, Continue};
use std::time::{Duration, Instant};

/// A time is the shortest of at least this many runs: more if they take less than `LONG_ENOUGH`, fewer if they take
/// more than `TOO_LONG`.
const FEWEST_RUNS: u32 = 3;
const MOST_RUNS: u32 = 50;
const LONG_ENOUGH: Duration = Duration::from_millis(200);
const TOO_LONG: Duration = Duration::from_secs(3);
/// Ratio of the cost of a step of the event-driven integrator to one of the paper's scheme, estimated.
const STEPS_A_STEP: f64 = 100.0;

/// A row of the table with its computing time.
struct Timed {
    row: Row,
    /// Order of the error, from the row before.
    order: Option<f64>,
    /// Seconds of computing for a simulated one; `None` where the run was ended.
    seconds: Option<f64>,
}

/// The results to be printed.
struct AccuracyReport<'a> {
    arguments: &'a Accuracy,
    study: ConvergenceStudy,
    rows: Vec<Timed>,
    notes: Vec<String>,
    complete: bool,
}

pub fn run(arguments: &Accuracy) -> Result<(), Box<dyn Error>> {
    arguments.plot.as_deref().map_or(Ok(()), picture::check_name)?;
    let (mut scene, _) = scene::find(&arguments.scene)?;
    check_once(&arguments.set)?;
    for (name, value) in &arguments.set {
        assign(&mut scene, name, *value)?;
    }
    scene.experiment.stop_time = arguments.stop_time.unwrap_or(scene.experiment.stop_time);
    let dof = arguments.of.as_deref().map(|name| dof_named(&scene, name)).transpose()?;
    interrupt::listen();
    let bar = reference::bar();
    let study = reference::study(&scene, dof, &bar)?;
    let mut report =
        AccuracyReport { arguments, study, rows: Vec::new(), notes: Vec::new(), complete: false };
    report.complete = report.climb(&bar).is_continue();
    bar.finish();
    report.explain();
    match report.print(&mut stdout().lock()) {
        // The reader of standard output has closed it.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
        result => result?,
    }
    if arguments.format != Format::Table {
        for note in &report.notes {
            eprintln!("note: {note}");
        }
    }
    if let Some(path) = &arguments.plot {
        report.chart().write(path)?;
    }
    if report.complete { Ok(()) } else { Err(Box::new(Interrupted)) }
}

impl AccuracyReport<'_> {
    /// Computes all rows of the ladder, or those up to an interruption.
    fn climb(&mut self, bar: &Progress) -> ControlFlow<()> {
        let ladder = self.study.candidates();
        let cost = |candidate: &StepCandidate| match candidate.method {
            Method::ForwardIncrement => candidate.steps as f64,
            Method::EventDriven => STEPS_A_STEP * candidate.steps as f64,
        };
        let whole: f64 = ladder.iter().map(cost).sum();
        let mut done = 0.0;
        for candidate in &ladder {
            let part = (1.0 - REFERENCE_SHARE) * cost(candidate) / whole;
            let start = REFERENCE_SHARE + (1.0 - REFERENCE_SHARE) * done / whole;
            bar.say(&format!("{}, step {} s", candidate.method, short(candidate.step)));
            // One run gives the errors, three give the time.
            let progress = |passed: f64| bar.set_part(start + 0.25 * part * passed);
            match self.study.row(*candidate, Watch { go_on: &stopped, progress: &progress }) {
                Ok(None) => return Break(()),
                Ok(Some(row)) => {
                    let before = self.rows.last().map(|timed: &Timed| timed.row);
                    let order = before.and_then(|before| self.study.order(&before, &row));
                    let seconds = seconds(&self.study, candidate, |passed| {
                        bar.set_part(start + part * (0.25 + 0.75 * passed));
                    });
                    self.rows.push(Timed { row, order, seconds });
                }
                Err(error) => {
                    let (method, step) = (candidate.method, short(candidate.step));
                    self.notes
                        .push(format!("{method} with a step of {step} s is left out: {error}"));
                }
            }
            done += cost(candidate);
            stopped()?;
        }
        Continue(())
    }

    /// Adds notes on facts that the rows do not show.
    fn explain(&mut self) {
        let rows: Vec<Row> = self.rows.iter().map(|timed| timed.row).collect();
        self.notes.extend(self.study.notes(&rows));
        if !self.complete {
            let all = self.study.candidates().len();
            self.notes.push(format!("interrupted after {} of {all} rows", rows.len()));
        }
    }
}

/// Seconds of computing for a simulated one, best of several runs; `None` if interrupted before the first
/// was over.
fn seconds(
    study: &ConvergenceStudy,
    candidate: &StepCandidate,
    watch: impl Fn(f64),
) -> Option<f64> {
    let (scene, grid) = (candidate.scene(study.scene()), study.grid());
    let (mut best, mut taken) = (None, Duration::ZERO);
    for run in 0..MOST_RUNS {
        watch((f64::from(run) / f64::from(FEWEST_RUNS)).min(1.0));
        if (run >= FEWEST_RUNS && taken > LONG_ENOUGH) || taken > TOO_LONG {
            break;
        }
        let mut simulation = Simulation::new(scene.clone(), 0.0).ok()?;
        let start = Instant::now();
        for interval in 1..=grid.intervals {
            simulation.advance_to(grid.time(interval)).ok()?;
            if stopped().is_break() {
                return best;
            }
        }
        let time = start.elapsed();
        taken += time;
        let time = time.as_secs_f64() / study.scene().experiment.stop_time;
        best = Some(best.map_or(time, |best: f64| best.min(time)));
    }
    best
}
