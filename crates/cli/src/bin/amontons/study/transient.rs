//! `amontons study transient`: growth and decay in one run.

use super::arguments::StudyArguments;
use super::folder::Folder;
use super::{found, set_pace, watched};
use crate::arguments::positive;
use amontons::decimal::to_significant;
use amontons::error::Rounded;
use amontons::scene::{Experiment, Scene};
use amontons_analysis::study::transient::{
    Eigenvalue, Finding, OpenQuestion, Phase, StateShare, Transient, interval, transient,
};
use amontons_analysis::study::{ObservationSettings, output, pace};
use amontons_cli::charts::transient::{chart, most_telling};
use amontons_cli::interrupt::Interrupted;
use clap::Args;
use serde_json::json;
use std::error::Error;
use std::f64::consts::TAU;
use std::io::{ErrorKind, Write, stdout};

#[derive(Args)]
pub struct TransientArguments {
    #[command(flatten)]
    common: StudyArguments,
    /// Output to analyse, such as a displacement or a velocity [default: the displacement that moves most]
    #[arg(long, value_name = "NAME")]
    of: Option<String>,
    /// End of the run, s [default: the scene's]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    stop_time: Option<f64>,
    /// Time between two values of the output, s; divided by a whole number if the fastest mode's period would have
    /// fewer than 20 values [default: the scene's]
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    output_interval: Option<f64>,
}

pub fn run(arguments: &TransientArguments) -> Result<(), Box<dyn Error>> {
    let (mut scene, source) = found(&arguments.common)?;
    if let Some(name) = &arguments.of {
        output(&scene, name)?;
    }
    let Experiment { stop_time, output_interval } = scene.experiment;
    let stop_time = arguments.stop_time.unwrap_or(stop_time);
    let output_interval = arguments.output_interval.unwrap_or(output_interval);
    let experiment = Experiment { stop_time, output_interval };
    Scene { experiment, ..scene.clone() }.check()?;
    let observation = ObservationSettings {
        of: arguments.of.clone().unwrap_or_default(),
        interval: interval(&scene, output_interval),
        window: stop_time,
        longest: stop_time,
    };
    set_pace(&mut scene, &arguments.common, &observation, pace)?;
    let settings = json!({
        "of": arguments.of,
        "stop_time": stop_time,
        "output_interval": output_interval,
    });
    let folder = Folder::open(&arguments.common, "transient", (&scene, &source), settings)?;
    let of = arguments.of.as_deref();
    let found = watched(|watch| transient(&scene, experiment, of, watch))?;
    write(&folder, &scene, &found)?;
    match print(&scene, &found, &mut stdout().lock()) {
        // The reader of standard output has closed it.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
        result => result?,
    }
    if found.complete {
        return Ok(());
    }
    eprintln!(
        "note: the run ended at {} s of {stop_time} s; the results up to then are in {}, and the same command starts \
         again from the beginning",
        found.end,
        folder.path().display()
    );
    Err(found.failure.map_or_else(|| Interrupted.into(), Into::into))
}

fn write(folder: &Folder, scene: &Scene, found: &Transient) -> Result<(), Box<dyn Error>> {
    let states = found.courses.iter().map(|course| format!("{}.state", course.contact));
    let head: Vec<String> =
        ["time".to_owned(), found.output.clone()].into_iter().chain(states).collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let rows = found.history.iter().enumerate().map(|(row, value)| {
        let states = found.states.iter().map(|states| (states[row] as u8).to_string());
        let time = row as f64 * found.interval;
        [format!("{time:?}"), format!("{value:?}")].into_iter().chain(states).collect::<Vec<_>>()
    });
    folder.write_table("history", &head, rows)?;
    folder.write_csv(&COLUMNS, found.findings.iter().map(cells))?;
    folder.write_json(found)?;
    // A run that ended at its start has nothing to draw.
    if found.history.len() > 1 {
        folder.draw("transient", &chart(scene, found))?;
    }
    Ok(())
}

const COLUMNS: [&str; 14] = [
    "from",
    "to",
    "frequency",
    "frequency_error",
    "rate",
    "rate_error",
    "amplitude_from",
    "amplitude_to",
    "displacement",
    "combination",
    "resting_frequency",
    "resting_rate",
    "states",
    "eigenvalues",
];

/// A finding as a row; the states are a list with shares, the eigenvalue is given as rate and frequency.
fn cells(finding: &Finding) -> Vec<String> {
    let phase = &finding.phase;
    let numbers = [
        phase.span[0],
        phase.span[1],
        phase.frequency,
        phase.frequency_error,
        phase.rate,
        phase.rate_error,
        phase.amplitude[0],
        phase.amplitude[1],
    ];
    let mut cells: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    cells.push(phase.displacement.clone().unwrap_or_default());
    cells.push(combination(finding).unwrap_or_default());
    let resting = finding.resting.map(|Eigenvalue { rate, frequency }| [frequency, rate]);
    cells.extend(match resting {
        Some(pair) => pair.map(|number| format!("{number:?}")),
        None => [String::new(), String::new()],
    });
    let listed = |cell: &dyn Fn(&StateShare) -> String| {
        finding.taken.iter().map(cell).collect::<Vec<_>>().join("; ")
    };
    cells.push(listed(&|taken| format!("{} {:?}", taken.states, taken.share)));
    cells.push(listed(&|taken| match taken.eigenvalue {
        Some(Eigenvalue { rate, frequency }) => format!("{} {rate:?} {frequency:?}", taken.states),
        None => taken.states.clone(),
    }));
    cells
}

/// Formats a combination of frequencies (Hz) as `218.58 − 169.37`.
fn combination(finding: &Finding) -> Option<String> {
    let combination = finding.phase.combination?;
    let mut text = String::new();
    for (factor, frequency) in combination.factors.into_iter().zip(combination.frequencies) {
        let sign = match (text.is_empty(), factor < 0) {
            _ if factor == 0 => continue,
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let times = if factor.abs() == 1 { String::new() } else { format!("{}·", factor.abs()) };
        text += &format!("{sign}{times}{frequency:.2}");
    }
    Some(text)
}

fn print(scene: &Scene, found: &Transient, out: &mut dyn Write) -> std::io::Result<()> {
    let Transient { output, unit, interval, end, growth, findings, open, left_out, .. } = found;
    // Without the digits of a third.
    let shown = to_significant(*interval, 5);
    writeln!(
        out,
        "{}: {output} over {} s, one value every {shown:?} s",
        scene.name,
        Rounded(*end)
    )?;
    match growth.dominant {
        Some(dominant) => writeln!(out, "strongest line: {dominant:.2} Hz")?,
        None if findings.iter().any(|finding| finding.phase.frequency > 0.0) => {
            writeln!(out, "no strongest line: the output drifts by more than it oscillates")?;
        }
        None => writeln!(
            out,
            "no strongest line: the output does not oscillate, or the run has too few periods"
        )?,
    }
    match growth.window {
        window if window > 0.0 => writeln!(out, "bands evaluated in windows of {window:.3} s")?,
        _ => {}
    }
    for sentence in left_out {
        writeln!(out, "note: {sentence}")?;
    }
    if findings.is_empty() {
        writeln!(out, "no exponential growth or decay by a factor of ten was found")?;
    }
    let listed = most_telling(findings);
    for finding in &listed {
        let phase = &finding.phase;
        let (of, unit) = match &phase.displacement {
            Some(displacement) => (format!(" of {displacement}"), "m"),
            None => (String::new(), *unit),
        };
        writeln!(out)?;
        writeln!(
            out,
            "{} from {} to {} s: {} {}, {:.2e} to {:.2e} {unit}{of}",
            verb(phase.rate),
            time(phase.span[0], *interval),
            time(phase.span[1], *interval),
            growth_rate(phase),
            at_frequency(phase),
            phase.amplitude[0],
            phase.amplitude[1],
        )?;
        if let Some(combination) = combination(finding) {
            writeln!(out, "  a combination of stronger lines: {combination} Hz")?;
        }
        let eigenvalue = |eigenvalue: Option<Eigenvalue>| match eigenvalue {
            Some(Eigenvalue { rate, frequency: 0.0 }) => {
                format!("{rate:+10.4} 1/s without oscillation")
            }
            Some(Eigenvalue { rate, frequency }) => {
                format!("{rate:+10.4} 1/s at {frequency:8.3} Hz")
            }
            None => "none".to_owned(),
        };
        writeln!(out, "  nearest eigenvalue  at rest        {}", eigenvalue(finding.resting))?;
        for taken in &finding.taken {
            let StateShare { states, share, .. } = taken;
            let states = format!("{states} ({:.0} %)", 100.0 * share);
            writeln!(out, "                      {states:<15}{}", eigenvalue(taken.eigenvalue))?;
        }
    }
    if listed.len() < findings.len() {
        writeln!(out)?;
        writeln!(out, "and {} more, in results.csv", findings.len() - listed.len())?;
    }
    if !open.is_empty() {
        writeln!(out)?;
    }
    for question in open {
        writeln!(out, "unknown: {}", describe_question(question, *interval))?;
    }
    Ok(())
}

fn verb(rate: f64) -> &'static str {
    if rate > 0.0 { "grows" } else { "decays" }
}

fn at_frequency(phase: &Phase) -> String {
    match phase.frequency {
        0.0 => "without oscillation".to_owned(),
        frequency => format!("at {frequency:.3} ± {:.1e} Hz", phase.frequency_error),
    }
}

/// Formats a time with the digits needed for rows at an `interval` (s).
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn time(time: f64, interval: f64) -> String {
    let digits = (-interval.log10()).ceil().max(2.0) as usize;
    format!("{time:.digits$}")
}

/// The reason why a motion is not followed mode by mode, with the replacement.
const NO_MODES: &str = "growth is evaluated by the spectral lines of the output, not mode by mode (contacts change \
                        their states, signals drive the scene, or friction is not linear)";

/// A note on results that need no run.
const STATES_TELL: &str =
    "amontons-stability states computes the growth rate of each mode without a run";

fn describe_question(question: &OpenQuestion, interval: f64) -> String {
    let change = |phase: &Phase, until: &str| {
        format!(
            "a mode {} by a factor of {:.3} {until}, with a {} {}",
            verb(phase.rate),
            (phase.rate * (phase.span[1] - phase.span[0])).exp(),
            growth_rate(phase),
            at_frequency(phase)
        )
    };
    match question {
        OpenQuestion::LessThanTenfold { phase, stop_time, is_beside_growth } => {
            let decides = format!("--stop-time {} or more", rounded_up(*stop_time));
            let unless = if *is_beside_growth {
                ", unless a growing mode hides it or makes a contact change its state first"
            } else {
                ""
            };
            format!(
                "{}; {decides} would show whether the factor reaches ten{unless}; {STATES_TELL}",
                change(phase, "by the end of the run")
            )
        }
        OpenQuestion::EndsBeforeTenfold { phase, is_ended_by_others } => {
            let until = format!(
                "until {} s, the end of the part that can be followed mode by mode",
                time(phase.span[1], interval)
            );
            let decides = if *is_ended_by_others {
                ""
            } else {
                "; a run with a smaller initial perturbation shows it for longer"
            };
            format!("{}; {STATES_TELL}{decides}", change(phase, &until))
        }
        OpenQuestion::TooSlow { count, frequency, stop_time } => format!(
            "the run is too short to show whether {}; --stop-time {} or more may show it",
            match (count, *frequency) {
                (1, 0.0) => "a mode that does not oscillate grows or decays".to_owned(),
                (1, _) => format!("a mode of {frequency:.4} Hz grows or decays"),
                (_, 0.0) =>
                    format!("{count} modes grow or decay, of which the slowest does not oscillate"),
                _ =>
                    format!("{count} modes grow or decay, the slowest of them at {frequency:.4} Hz"),
            },
            rounded_up(*stop_time),
        ),
        OpenQuestion::TooShort { span, periods, stop_time } => format!(
            "from {} s on {NO_MODES}, and {periods:.1} periods of the strongest line are too few to see it; \
             --stop-time {} or more may decide, or a smaller initial perturbation, with which contacts keep their states \
             for longer",
            time(span[0], interval),
            rounded_up(*stop_time),
        ),
        OpenQuestion::Slower { span, rate } => format!(
            "from {} s on {NO_MODES}; a tenfold change that is slower than {rate:.2} 1/s, or of a line beside \
             stronger ones, may not be seen: a longer run (--stop-time), another output (--of), a smaller initial \
             perturbation or the scene without its signals may show it; amontons study limit-cycle finds the final \
             motion",
            time(span[0], interval),
        ),
    }
}

/// Formats a growth rate as `growth rate +175.7834 ± 6.8e-6 1/s (+27.9768 Hz)`.
fn growth_rate(phase: &Phase) -> String {
    let Phase { rate, rate_error, .. } = phase;
    format!("growth rate {rate:+.4} ± {rate_error:.1e} 1/s ({:+.4} Hz)", rate / TAU)
}

/// Rounds a value up to two digits.
fn rounded_up(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.log10().floor() - 1.0);
    to_significant((value / unit).ceil() * unit, 2)
}
