//! `amontons accuracy`: what accuracy costs, on the user's own scene.

use crate::Interrupted;
use crate::arguments::{Accuracy, Format};
use crate::draw::prefixed;
use amontons::accuracy::{Errors, Row, Rung, Study, dof_named};
use amontons::picture::{self, Chart, Panel, Series, Style};
use amontons::scene::{self, Method, Scene};
use amontons::simulation::{Simulation, assign};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Map, Value, json};
use std::error::Error;
use std::io::{self, ErrorKind, Write, stdout};
use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A time is the best of so many runs, of more until they have taken so long, of fewer if they take too long.
const FEWEST_RUNS: u32 = 3;
const MOST_RUNS: u32 = 50;
const LONG_ENOUGH: Duration = Duration::from_millis(200);
const TOO_LONG: Duration = Duration::from_secs(3);
/// A reference's cost against the whole ladder's, as the bar shows it.
const REFERENCE_SHARE: f64 = 0.1;
/// A step of the event-driven integrator costs about so many of the paper's scheme.
const STEPS_A_STEP: f64 = 100.0;

static STOP: AtomicBool = AtomicBool::new(false);

fn stopped() -> ControlFlow<()> {
    if STOP.load(Ordering::Relaxed) { Break(()) } else { Continue(()) }
}

/// A row with its time.
struct Timed {
    row: Row,
    /// Order of the error, from the row before.
    order: Option<f64>,
    /// Seconds of computing for a simulated one; `None` where the run was ended.
    seconds: Option<f64>,
}

/// What is to be printed.
struct Report<'a> {
    arguments: &'a Accuracy,
    study: Study,
    rows: Vec<Timed>,
    notes: Vec<String>,
    complete: bool,
}

pub fn run(arguments: &Accuracy) -> Result<(), Box<dyn Error>> {
    arguments.plot.as_deref().map_or(Ok(()), picture::check_name)?;
    let (mut scene, _) = scene::find(&arguments.scene)?;
    for (name, value) in &arguments.set {
        assign(&mut scene, name, *value)?;
    }
    scene.experiment.stop_time = arguments.stop_time.unwrap_or(scene.experiment.stop_time);
    let dof = arguments.of.as_deref().map(|name| dof_named(&scene, name)).transpose()?;
    // Without a handler Ctrl-C ends the program at once, as ever.
    let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));

    let bar = progress_bar();
    let (mut runs, mut last) = (0.0, 0.0);
    let watch = &mut |passed: f64| {
        // How many runs the reference takes is not known before.
        if passed < last {
            runs += 1.0;
        }
        last = passed;
        bar.set_position(ticks(REFERENCE_SHARE * (1.0 - 0.5_f64.powf(runs + passed))));
        stopped()
    };
    let Some(study) = Study::new(&scene, dof, watch)? else {
        bar.finish_and_clear();
        return Err(Box::new(Interrupted));
    };
    let mut report =
        Report { arguments, study, rows: Vec::new(), notes: Vec::new(), complete: false };
    report.complete = report.climb(&bar).is_continue();
    bar.finish_and_clear();
    report.explain();
    match report.print(&mut stdout().lock()) {
        // Whoever reads has read enough.
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

/// A bar on standard error, shown only to a person.
fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}")
        .expect("the template is fixed");
    ProgressBar::new(1000).with_style(style).with_message("the reference")
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn ticks(part: f64) -> u64 {
    (1e3 * part) as u64
}

impl Report<'_> {
    /// All rows of the ladder, or those up to the interruption.
    fn climb(&mut self, bar: &ProgressBar) -> ControlFlow<()> {
        let ladder = self.study.ladder();
        let cost = |rung: &Rung| match rung.method {
            Method::ForwardIncrement => rung.steps as f64,
            Method::EventDriven => STEPS_A_STEP * rung.steps as f64,
        };
        let whole: f64 = ladder.iter().map(cost).sum();
        let mut done = 0.0;
        for rung in &ladder {
            let part = (1.0 - REFERENCE_SHARE) * cost(rung) / whole;
            let start = REFERENCE_SHARE + (1.0 - REFERENCE_SHARE) * done / whole;
            bar.set_message(format!("{}, step {} s", name(rung.method), short(rung.step)));
            // One run for the errors, three for the time.
            let row = self.study.row(*rung, &mut |passed| {
                bar.set_position(ticks(start + 0.25 * part * passed));
                stopped()
            });
            match row {
                Ok(None) => return Break(()),
                Ok(Some(row)) => {
                    let before = self.rows.last().map(|timed: &Timed| timed.row);
                    let order = before.and_then(|before| self.study.order(&before, &row));
                    let seconds = seconds(&self.study, rung, |passed| {
                        bar.set_position(ticks(start + part * (0.25 + 0.75 * passed)));
                    });
                    self.rows.push(Timed { row, order, seconds });
                }
                Err(error) => {
                    let (method, step) = (name(rung.method), short(rung.step));
                    self.notes.push(format!("{method} with {step} s is left out: {error}"));
                }
            }
            done += cost(rung);
            stopped()?;
        }
        Continue(())
    }

    fn print(&self, out: &mut dyn Write) -> io::Result<()> {
        match self.arguments.format {
            Format::Table => self.print_table(out)?,
            Format::Csv => self.print_csv(out)?,
            Format::Json => writeln!(out, "{:#}", self.as_json())?,
        }
        out.flush()
    }

    /// Words on what is not to be seen in the rows.
    fn explain(&mut self) {
        let mut notes = Vec::new();
        match self.study.critical_step() {
            Ok(critical) if critical.step < self.study.scene().experiment.output_interval => {
                notes.push(format!(
                    "the paper's scheme has no steps above its critical one, {critical}"
                ));
            }
            Ok(_) => {}
            Err(error) => notes.push(format!("the paper's scheme is left out: {error}")),
        }
        if self.study.scale().is_none() {
            notes.push(
                "the scene does not move: there is no amplitude to measure errors by; give it an \
                 [[initial]] velocity, or a [[signal]]"
                    .to_owned(),
            );
        }
        if self.study.is_chaotic() {
            notes.push(format!(
                "the reference agrees with itself to {:.0e} of the amplitude only, as motions do that \
                 forget their start: judge by amplitude and frequency, over a shorter --stop-time by \
                 the rms error too",
                self.study.floor().rms.unwrap_or(0.0)
            ));
        } else if self.rows.iter().any(|timed| timed.row.is_out_of_phase()) {
            notes.push(
                "out of phase: the displacements are off by more than half of the amplitude; judge by \
                 amplitude and frequency"
                    .to_owned(),
            );
        }
        if !self.complete {
            notes.push(format!(
                "interrupted: {} of {} rows",
                self.rows.len(),
                self.study.ladder().len()
            ));
        }
        self.notes.append(&mut notes);
    }

    fn print_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let study = &self.study;
        let Scene { name: scene, experiment, .. } = study.scene();
        let statistics = study.reference_statistics();
        writeln!(out, "{scene}: what accuracy costs over {} s", experiment.stop_time)?;
        writeln!(
            out,
            "  reference      event-driven, step {} s: {} changes of contact state, {} touch-downs",
            short(study.reference_step()),
            statistics.state_changes,
            statistics.touch_downs
        )?;
        let floor = study.floor();
        if floor.rms.is_some() {
            let of = |what: &str, error: Option<f64>, unit: &str| {
                error.map(|error| format!("{what} {error:.1e}{unit}"))
            };
            let all = [
                of("rms", floor.rms, ""),
                of("amplitude", floor.amplitude, ""),
                of("frequency", floor.frequency, ""),
                of("event times", floor.event_time, " s"),
            ];
            let all = all.into_iter().flatten().collect::<Vec<_>>().join(", ");
            writeln!(out, "  its own error  {all} (against itself at twice its step)")?;
        }
        if let Some(cycle) = self.cycle() {
            writeln!(out, "  cycle          {cycle}")?;
        }
        writeln!(out)?;
        writeln!(
            out,
            "{:17} {:>9} {:>10} {:>14} {:>11} {:>12} {:>9} {:>9} {:>11} {:>6} {:>9}",
            "method",
            "step [s]",
            "steps",
            "events",
            "touch-downs",
            "rms error",
            "amplitude",
            "frequency",
            "times [s]",
            "order",
            "ms per s"
        )?;
        for Timed { row, order, seconds } in &self.rows {
            let Row { rung, statistics, events_more, errors } = row;
            let events = match events_more {
                0 => statistics.state_changes.to_string(),
                more => format!("{} ({more:+})", statistics.state_changes),
            };
            let order = order.map_or_else(|| "-".to_owned(), |order| format!("{order:.2}"));
            let rms = match row.is_out_of_phase() {
                true => "out of phase".to_owned(),
                false => cell(errors.rms, floor.rms),
            };
            writeln!(
                out,
                "{:17} {:>9} {:>10} {:>14} {:>11} {:>12} {:>9} {:>9} {:>11} {:>6} {:>9}",
                name(rung.method),
                short(rung.step),
                statistics.steps,
                events,
                statistics.touch_downs,
                rms,
                cell(errors.amplitude, floor.amplitude),
                cell(errors.frequency, floor.frequency),
                cell(errors.event_time, floor.event_time),
                order,
                seconds.map_or_else(|| "-".to_owned(), |seconds| milliseconds(1e3 * seconds)),
            )?;
        }
        writeln!(out)?;
        for note in &self.notes {
            writeln!(out, "note: {note}")?;
        }
        writeln!(
            out,
            "rms error: of all displacements, over their deviation from the mean; amplitude, frequency: of \
             the cycle above.\n≤: below the reference's own error. order: how often the rms error halves \
             where the step does; with few\nevents they hide it. events: changes of contact state, and \
             how many more than the reference has.\ntimes: of events, where each contact goes through the same states. \
             ms per s: one thread, best of several runs,\n\
             without making the simulation."
        )
    }

    fn cycle(&self) -> Option<String> {
        let cycle = self.study.cycle();
        let dof = &self.study.scene().dof_names()[self.study.dof()];
        let amplitude = cycle.amplitude.filter(|_| self.study.scale().is_some())?;
        let at = cycle.frequency.map_or_else(String::new, |hz| format!(" at {hz:.2} Hz"));
        Some(format!("{dof}: ±{amplitude:.4e} m{at}, over the last half"))
    }

    fn print_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "method,step,steps,events,events_more,touch_downs,rms_error,amplitude_error,\
             frequency_error,event_time_error,largest_event_time_error,order,seconds_per_second"
        )?;
        let study = &self.study;
        let number =
            |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:?}"));
        let errors = |errors: &Errors| {
            let Errors { rms, amplitude, frequency, event_time, largest_event_time } = *errors;
            let all = [rms, amplitude, frequency, event_time, largest_event_time];
            all.map(number).join(",")
        };
        let statistics = study.reference_statistics();
        writeln!(
            out,
            "reference,{:?},{},{},0,{},{},,",
            study.reference_step(),
            statistics.steps,
            statistics.state_changes,
            statistics.touch_downs,
            errors(&study.floor())
        )?;
        for Timed { row, order, seconds } in &self.rows {
            writeln!(
                out,
                "{},{:?},{},{},{},{},{},{},{}",
                name(row.rung.method),
                row.rung.step,
                row.statistics.steps,
                row.statistics.state_changes,
                row.events_more,
                row.statistics.touch_downs,
                errors(&row.errors),
                number(*order),
                number(*seconds)
            )?;
        }
        Ok(())
    }

    fn as_json(&self) -> Value {
        let study = &self.study;
        let errors = |errors: &Errors| {
            json!({
                "rms": errors.rms,
                "amplitude": errors.amplitude,
                "frequency": errors.frequency,
                "event_time": errors.event_time,
                "largest_event_time": errors.largest_event_time,
            })
        };
        let rows = self.rows.iter().map(|Timed { row, order, seconds }| {
            json!({
                "method": name(row.rung.method),
                "step": row.rung.step,
                "steps": row.statistics.steps,
                "events": row.statistics.state_changes,
                "events_more": row.events_more,
                "touch_downs": row.statistics.touch_downs,
                "errors": errors(&row.errors),
                "out_of_phase": row.is_out_of_phase(),
                "order": order,
                "seconds_per_second": seconds,
            })
        });
        let values = self.arguments.set.iter().map(|(name, value)| (name.clone(), json!(value)));
        let statistics = study.reference_statistics();
        json!({
            "program": "amontons",
            "version": env!("CARGO_PKG_VERSION"),
            "scene": self.arguments.scene,
            "values": values.collect::<Map<_, _>>(),
            "stop_time": study.scene().experiment.stop_time,
            "interval": study.grid().interval,
            "critical_step": study.critical_step().ok().map(|critical| critical.step),
            "reference": {
                "method": name(Method::EventDriven),
                "step": study.reference_step(),
                "steps": statistics.steps,
                "events": statistics.state_changes,
                "touch_downs": statistics.touch_downs,
                "deviation": study.scale(),
                "cycle_of": study.scene().dof_names()[study.dof()],
                "amplitude": study.cycle().amplitude,
                "frequency": study.cycle().frequency,
                "errors": errors(&study.floor()),
            },
            "rows": rows.collect::<Vec<_>>(),
            "notes": self.notes,
            "complete": self.complete,
        })
    }

    /// Error against time, both logarithmic, with the reference's own error as a dashed line.
    fn chart(&self) -> Chart {
        let chaotic = self.study.is_chaotic();
        let pick = |errors: &Errors| if chaotic { errors.amplitude } else { errors.rms };
        let shown = self.rows.iter().filter_map(|timed| {
            Some((timed.row.rung, [1e3 * timed.seconds?, pick(&timed.row.errors)?]))
        });
        let shown: Vec<(Rung, [f64; 2])> = shown.collect();
        let curve = |method, label: &str, colour| {
            let rows = shown.iter().filter(|(rung, _)| rung.method == method);
            Series {
                label: Some(label.to_owned()),
                points: rows.clone().map(|(_, point)| *point).collect(),
                labels: rows.map(|(rung, _)| prefixed(parsed(&short(rung.step)), "s")).collect(),
                colour,
                style: Style::Line,
            }
        };
        let times = shown.iter().map(|(_, [time, _])| *time);
        let ends = [times.clone().fold(f64::INFINITY, f64::min), times.fold(0.0, f64::max)];
        let floor = pick(&self.study.floor()).map(|floor| Series {
            label: Some("the reference's own error".to_owned()),
            points: ends.map(|time| [time, floor]).to_vec(),
            colour: 6,
            style: Style::Dashed,
            ..Series::default()
        });
        let curves = [
            curve(Method::ForwardIncrement, "forward increment, by step", 0),
            curve(Method::EventDriven, "event-driven, by step", 1),
        ];
        let curves = curves.into_iter().filter(|series| !series.points.is_empty());
        let error = if chaotic { "Error of the amplitude" } else { "Relative rms error" };
        Chart {
            title: format!(
                "{}: what accuracy costs over {} s",
                self.study.scene().name,
                self.study.scene().experiment.stop_time
            ),
            x_label: "Computing time of a simulated second [ms]".to_owned(),
            panels: vec![Panel {
                y_label: format!("{error} [–]"),
                series: floor.into_iter().chain(curves).collect(),
                ..Panel::default()
            }],
            logarithmic: true,
        }
    }
}

/// Seconds of computing for a simulated one, best of several runs; `None` if interrupted before the first
/// was over.
fn seconds(study: &Study, rung: &Rung, watch: impl Fn(f64)) -> Option<f64> {
    let (scene, grid) = (rung.scene(study.scene()), study.grid());
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

fn name(method: Method) -> &'static str {
    match method {
        Method::ForwardIncrement => "forward-increment",
        Method::EventDriven => "event-driven",
    }
}

/// A number to four digits, without zeros at its end.
fn short(value: f64) -> String {
    format!("{:e}", parsed(&format!("{value:.3e}")))
}

fn parsed(number: &str) -> f64 {
    number.parse().expect("a number as Rust writes it")
}

/// An error; one at the floor is not larger than that.
fn cell(error: Option<f64>, floor: Option<f64>) -> String {
    match error {
        None => "-".to_owned(),
        Some(error) if Some(error) == floor => format!("≤{error:.1e}"),
        Some(error) => format!("{error:.1e}"),
    }
}

/// To three digits.
fn milliseconds(time: f64) -> String {
    match time {
        100.0.. => format!("{time:.0}"),
        10.0.. => format!("{time:.1}"),
        1.0.. => format!("{time:.2}"),
        _ => format!("{time:.3}"),
    }
}
