//! `amontons study limit-cycle`.

use super::arguments::{Common, Looking};
use super::folder::{Folder, quoted};
use super::{heading, interrupted, kinds, over, prepared, prepared_again, watched};
use crate::arguments::Values;
use crate::say::say;
use amontons::contact::ContactState;
use amontons::numerics::range;
use amontons::scene::Scene;
use amontons_analysis::assign::assign;
use amontons_analysis::study::{
    Ending, Kind, LimitCycles, Look, MotionBracket, Outcome, Portrait, Push, Question,
    limit_cycles, output, unit,
};
use amontons_analysis::sweep::range::{self, number};
use amontons_analysis::sweep::{Possible, axis};
use amontons_pictures::picture::{Chart, Mark, Panel, Series, Style};
use clap::Args;
use serde_json::json;
use std::error::Error;
use std::io::{Write, stdout};

#[derive(Args)]
pub struct LimitCycle {
    #[command(flatten)]
    pub common: Common,
    /// The parameter or input, and its values from A to B, in steps or N of them, or its one value [default: the slider's
    /// velocity, as the scene has it]
    #[arg(long, value_name = "NAME=A:B:STEP|A:B/N|VALUE", value_parser = named_values)]
    pub parameter: Option<(String, Values)>,
    #[command(flatten)]
    pub looking: Looking,
    /// Find where the motion changes to this part of the distance between two values
    #[arg(long, value_name = "PART", default_value = "1e-3", value_parser = part, allow_hyphen_values = true)]
    pub resolution: f64,
    /// Draw the phase portraits of the motion with this value; may be given again [default: of one value in the
    /// middle of each regime]
    #[arg(long, value_name = "VALUE", value_parser = number, allow_hyphen_values = true)]
    pub portrait: Vec<f64>,
    /// How many contacts portraits show, the first ones
    #[arg(long, value_name = "N", default_value = "2")]
    pub contacts: usize,
}

/// A parameter with a range of values, or with one.
fn named_values(text: &str) -> Result<(String, Values), String> {
    range::named(text, |values| {
        let is_range = values.contains([':', '/']);
        if is_range { range::steps(values) } else { Ok(vec![number(values)?]) }.map(Values)
    })
}

fn part(text: &str) -> Result<f64, String> {
    match number(text)? {
        part if part > 0.0 && part <= 1.0 => Ok(part),
        _ => Err("must be above 0 and at most 1, such as 1e-3".to_owned()),
    }
}

/// The velocity of the slider as the scene has it, or that of the first contact where each has one of its own.
fn as_it_is(scene: &Scene) -> (String, Values) {
    let contacts = scene.network().map_or(&[][..], |network| &network.contacts);
    let own = contacts.first().filter(|_| !scene.has_common_velocity());
    let own =
        own.and_then(|first| Some((format!("contact.{}.velocity", first.name), first.velocity?)));
    let (name, value) =
        own.unwrap_or_else(|| ("slider.velocity".to_owned(), scene.slider.velocity));
    (name, Values(vec![value]))
}

pub fn run(arguments: &LimitCycle) -> Result<(), Box<dyn Error>> {
    let LimitCycle { common, parameter, looking, .. } = arguments;
    let (scene, source, look) = prepared(common, looking)?;
    let (name, Values(values)) = &parameter.clone().unwrap_or_else(|| as_it_is(&scene));
    // Before there is a folder.
    let possible = Possible::of(&scene, name, values)?;
    if let Some(note) = possible.note(name) {
        eprintln!("note: {note}");
    }
    let values = possible.values;
    let mut first = scene.clone();
    assign(&mut first, name, values[0])?;
    if parameter.is_some() && common.set.iter().any(|(set, _)| set == name) {
        eprintln!("note: {name} takes the values of --parameter, not that of --set");
    }
    if let Some(push) = Push::of_resting(&first) {
        eprintln!(
            "note: {} starts at rest in its equilibrium; {} is pushed, with {:?} m/s where {name} = {:?}",
            scene.name,
            scene.dof_names()[push.dof],
            push.velocity,
            values[0]
        );
    }
    let mut drawn = arguments.portrait.clone();
    drawn.sort_by(f64::total_cmp);
    drawn.dedup();
    let question = Question {
        name: name.clone(),
        values,
        resolution: arguments.resolution,
        portraits: (!drawn.is_empty()).then_some(drawn),
        contacts: arguments.contacts,
    };
    let prepare = |scene: &mut Scene| prepared_again(scene, common, looking);
    let mut runs = Vec::with_capacity(question.values.len());
    for value in &question.values {
        let mut scene = scene.clone();
        assign(&mut scene, name, *value)?;
        let look = prepare(&mut scene)?;
        runs.push((scene, look));
    }
    let folder = Folder::open(common, "limit-cycle", (&scene, &source), (&look, looking))?;
    let found =
        watched(|watch| limit_cycles(&scene, &prepare, &question, folder.journal(), watch))?;
    let Some(found) = found else { return Err(interrupted(&folder)) };
    let told = Told { scene: &scene, of: &look.of, question: &question, found: &found };
    folder.write_csv(&told.head(), told.rows())?;
    folder.write_json(json!({ "question": question, "found": found }))?;
    folder.draw("limit-cycle", &told.chart())?;
    // What is drawn is the motion of contacts.
    for portrait in found.portraits.iter().filter(|_| scene.contact_count() > 0) {
        for direction in ["tangential", "normal"] {
            let name = format!("portrait-{:?}-{direction}", portrait.value);
            folder.draw(&name, &told.portrait(portrait, direction))?;
        }
    }
    told.print(&runs, &mut stdout().lock())?;
    say!("{} has results.csv, study.json and pictures", folder.path().display());
    Ok(())
}

/// What is told of a study.
pub struct Told<'a> {
    pub scene: &'a Scene,
    /// The output that is looked at.
    pub of: &'a str,
    pub question: &'a Question,
    pub found: &'a LimitCycles,
}

impl Told<'_> {
    fn outcomes(&self) -> impl Iterator<Item = (f64, &Outcome)> {
        self.question.values.iter().copied().zip(&self.found.outcomes)
    }

    fn head(&self) -> [&str; 13] {
        [
            &self.question.name,
            "kind",
            "amplitude",
            "frequency",
            "share.slide",
            "share.reverse_slide",
            "share.stick",
            "share.detached",
            "taken",
            "time",
            "period",
            "closure",
            "failure",
        ]
    }

    fn rows(&self) -> impl Iterator<Item = Vec<String>> {
        self.outcomes().map(|(value, outcome)| {
            let mut row = vec![format!("{value:?}")];
            match outcome {
                Outcome::Ending(ending) => {
                    let amplitude = match ending.kind {
                        Kind::Unbounded => String::new(),
                        _ => format!("{:?}", ending.amplitude),
                    };
                    row.extend([ending.kind.name().to_owned(), amplitude]);
                    row.push(ending.frequency.map_or_else(String::new, |hz| format!("{hz:?}")));
                    row.extend(ending.shares.map(|share| format!("{share:?}")));
                    row.extend([taken(&ending.taken), format!("{:?}", ending.time)]);
                    let number = |value: Option<f64>| {
                        value.map_or_else(String::new, |value| format!("{value:?}"))
                    };
                    row.extend([number(ending.period), number(ending.closure), String::new()]);
                }
                Outcome::Failure(failure) => {
                    row.push("failed".to_owned());
                    row.extend(vec![String::new(); 10]);
                    row.push(quoted(failure));
                }
            }
            row
        })
    }

    /// The unit of the output that is looked at, in brackets.
    fn unit(&self) -> String {
        let unit = output(self.scene, self.of).map_or("1", |output| unit(&output));
        if unit == "1" { String::new() } else { format!(" [{unit}]") }
    }

    /// Amplitude, frequency and shares of the states over the parameter.
    pub fn chart(&self) -> Chart {
        let marks: Vec<Mark> = self.found.thresholds.iter().map(mark).collect();
        let plain: Vec<Mark> =
            marks.iter().map(|mark| Mark { label: None, ..mark.clone() }).collect();
        let panel = |y_label: String, series, marks: &[Mark]| Panel {
            y_label,
            series,
            marks: marks.to_vec(),
            zero_line: true,
            ..Panel::default()
        };
        let mut amplitude = self.curve(None, 0, |ending| {
            (ending.kind != Kind::Unbounded).then(|| kinds::amplitude(ending))
        });
        let settled = self.outcomes().filter_map(|(value, found)| Some((value, found.settled()?)));
        amplitude.extend(kinds::marks(&[settled.collect()]));
        let mut frequency = self.curve(None, 0, |ending| {
            // Of a decay no one asks.
            ending.frequency.filter(|_| !ending.rests())
        });
        // Another line may become the strongest one between two values.
        frequency.iter_mut().for_each(|series| series.style = Style::Dots);
        let is_taken = |&state: &usize| {
            self.outcomes().any(
                |(_, outcome)| matches!(outcome, Outcome::Ending(ending) if ending.taken[state]),
            )
        };
        let states = (0..4).filter(is_taken).map(|state| {
            let name = ContactState::ALL[state].to_string();
            self.curve(Some(&name), state + 2, |ending| Some(ending.shares[state]))
        });
        let mut panels = vec![
            panel(format!("amplitude{}", self.unit()), amplitude, &marks),
            Panel { zero_line: false, ..panel("frequency [Hz]".to_owned(), frequency, &plain) },
            panel("share of time".to_owned(), states.flatten().collect(), &plain),
        ];
        panels.retain(|panel| {
            panel.series.iter().flat_map(|series| &series.points).any(|point| point[1].is_finite())
        });
        Chart {
            title: format!("{}: what {} ends in", self.scene.name, self.of),
            x_label: axis(self.scene, &self.question.name),
            panels,
            logarithmic: false,
        }
    }

    /// A quantity over the parameter: a curve of the values that have settled, broken where the motion comes to
    /// rest, and dots for those that have not.
    fn curve(
        &self,
        label: Option<&str>,
        colour: usize,
        quantity: impl Fn(&Ending) -> Option<f64>,
    ) -> Vec<Series> {
        let (mut settled, mut left) = (Vec::new(), Vec::new());
        let mut moved = None;
        for (value, outcome) in self.outcomes() {
            let moves = outcome.settled().map(|ending| ending.kind.is_cycle());
            if moves.is_none() || moves != moved {
                settled.push([value, f64::NAN]);
            }
            moved = moves;
            let Outcome::Ending(ending) = outcome else { continue };
            let point = [value, quantity(ending).unwrap_or(f64::NAN)];
            if moves.is_some() { settled.push(point) } else { left.push(point) }
        }
        let dots = Series {
            label: Some("not settled".to_owned()),
            points: left,
            colour: 1,
            style: Style::Dots,
            ..Series::default()
        };
        let label = label.map(str::to_owned);
        let mut series = vec![Series { label, points: settled, colour, ..Series::default() }];
        if !dots.points.is_empty() {
            series.push(dots);
        }
        series
    }

    /// The orbits of the contacts in one plane.
    pub fn portrait(&self, portrait: &Portrait, direction: &str) -> Chart {
        let is_tangential = direction == "tangential";
        let orbits: Vec<&Vec<[f64; 2]>> = portrait
            .orbits
            .iter()
            .map(|orbit| if is_tangential { &orbit.tangential } else { &orbit.normal })
            .collect();
        let is_point = orbits.iter().all(|points| points.windows(2).all(|two| two[0] == two[1]));
        let style = |colour| match (is_point, colour) {
            (true, _) => Style::Dots,
            (false, 0) => Style::Line,
            // Modules may move alike.
            (false, _) => Style::Dashed,
        };
        let mut series: Vec<Series> = Vec::new();
        for (colour, (contact, points)) in portrait.orbits.iter().zip(&orbits).enumerate() {
            series.push(Series {
                label: Some(contact.name.clone()),
                points: (*points).clone(),
                colour,
                style: style(colour),
                ..Series::default()
            });
        }
        if is_tangential {
            let across = orbits.iter().flat_map(|points| points.iter().map(|point| point[0]));
            let ends = range(across);
            let mut velocities: Vec<f64> =
                portrait.orbits.iter().map(|contact| contact.slider_velocity).collect();
            velocities.dedup();
            let slider = velocities.into_iter().map(|velocity| Series {
                label: Some("slider".to_owned()),
                points: ends.map(|x| [x, velocity]).to_vec(),
                colour: 2,
                ..Series::default()
            });
            // Below the orbits, which stick to it.
            series = slider.chain(series).collect();
        }
        let kind = portrait.ending.kind.name();
        let what = if is_point { format!("{kind}, contacts stay closed") } else { kind.to_owned() };
        Chart {
            title: format!(
                "{}, {} = {:?}: {what}",
                self.scene.name, self.question.name, portrait.value
            ),
            x_label: format!("{direction} displacement [m]"),
            panels: vec![Panel {
                y_label: format!("{direction} velocity [m/s]"),
                series,
                ..Panel::default()
            }],
            logarithmic: false,
        }
    }

    fn print(&self, runs: &[(Scene, Look)], out: &mut dyn Write) -> std::io::Result<()> {
        let Self { scene, question, found, .. } = self;
        match &question.values[..] {
            [value] => {
                let is_driven = scene.signals.iter().any(|signal| signal.input == question.name);
                let added = if is_driven { ", to which a signal adds" } else { "" };
                writeln!(
                    out,
                    "{}: what it ends in with {} = {value:?}{added}",
                    scene.name, question.name
                )?;
            }
            _ => writeln!(out, "{}: limit cycles over {}", scene.name, question.name)?,
        }
        writeln!(
            out,
            "{}",
            heading(&runs.iter().map(|(scene, look)| (scene, look)).collect::<Vec<_>>())
        )?;
        writeln!(out)?;
        let width = question.name.chars().count();
        let amplitude = format!("amplitude{}", self.unit());
        writeln!(
            out,
            "{:>width$}  {:14}  {amplitude:>13}  {:>14}  {:>6}  {:>6}  {:>6}  {:>6}  {:>11}",
            question.name, "kind", "frequency [Hz]", "Sl", "R-Sl", "St", "Dt", "settled [s]"
        )?;
        for (value, outcome) in self.outcomes() {
            let value = format!("{value:?}");
            match outcome {
                Outcome::Ending(Ending {
                    kind, amplitude, frequency, shares, taken, time, ..
                }) => {
                    let is_cycle = !matches!(kind, Kind::Equilibrium | Kind::Unbounded);
                    let frequency = frequency.filter(|_| is_cycle);
                    let amplitude = match kind {
                        Kind::Unbounded => "-".to_owned(),
                        _ => format!("{amplitude:.4e}"),
                    };
                    let frequency =
                        frequency.map_or_else(|| "-".to_owned(), |hz| format!("{hz:.3}"));
                    write!(
                        out,
                        "{value:>width$}  {:14}  {amplitude:>13}  {frequency:>14}",
                        kind.name()
                    )?;
                    for (share, taken) in shares.iter().zip(taken) {
                        let share = if *taken { format!("{share:.4}") } else { "-".to_owned() };
                        write!(out, "  {share:>6}")?;
                    }
                    let time = match kind {
                        Kind::Unsettled => "not".to_owned(),
                        _ => format!("{time:.3}"),
                    };
                    writeln!(out, "  {time:>11}")?;
                }
                Outcome::Failure(failure) => writeln!(out, "{value:>width$}  failed: {failure}")?,
            }
        }
        writeln!(out)?;
        self.print_evidence(out)?;
        if !found.thresholds.is_empty() {
            writeln!(out, "as {} rises:", question.name)?;
        } else if question.values.len() > 1 {
            writeln!(out, "no thresholds between values that have settled")?;
        }
        for threshold in &found.thresholds {
            let [low, high] = bounds(threshold);
            write!(out, "  between {low} and {high}: {}", changes(threshold))?;
            match threshold.unknown {
                Some(value) => writeln!(out, " (no nearer: {value:?} has not settled)")?,
                None => writeln!(out)?,
            }
        }
        if question.values.len() > 1 {
            writeln!(
                out,
                "changes that come and go between two neighbouring values are not seen; a smaller step of --parameter shows \
                 them"
            )?;
        }
        let is_left = |outcome: &Outcome| matches!(outcome, Outcome::Ending(ending) if ending.kind == Kind::Unsettled);
        let left: Vec<(f64, &Look)> = self
            .outcomes()
            .zip(runs)
            .filter(|((_, outcome), _)| is_left(outcome))
            .map(|((value, _), (_, look))| (value, look))
            .collect();
        if !left.is_empty() {
            let longest = over(left.iter().map(|(_, look)| look.longest));
            let values: Vec<String> = left.iter().map(|(value, _)| format!("{value:?}")).collect();
            writeln!(
                out,
                "not settled within {longest} s: {}; a longer --longest or, of a beat, a --window that holds more of it may \
                 decide",
                values.join(", ")
            )?;
        }
        let stands = |(value, outcome): (f64, &Outcome)| {
            let ending = outcome.settled().filter(|ending| ending.kind.is_cycle())?;
            (ending.amplitude == 0.0).then_some(value)
        };
        if let Some(value) = self.outcomes().find_map(stands) {
            writeln!(
                out,
                "{} does not move at {value:?}, where others do: look at another output with --of",
                self.of
            )?;
        }
        Ok(())
    }
}

impl Told<'_> {
    /// How the kinds are known: once for values in a row that come back or combine two frequencies, by the value that is known
    /// least well; of other kinds for each value.
    fn print_evidence(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let endings: Vec<(f64, &Ending)> = self
            .outcomes()
            .filter_map(|(value, outcome)| match outcome {
                Outcome::Ending(ending) => Some((value, ending)),
                Outcome::Failure(_) => None,
            })
            .collect();
        let is_alike = |a: &Ending, b: &Ending| {
            a.kind == b.kind
                && matches!(a.kind, Kind::Periodic | Kind::QuasiPeriodic)
                && (a.linear, a.follows, a.two_frequencies)
                    == (b.linear, b.follows, b.two_frequencies)
        };
        for run in endings.chunk_by(|a, b| is_alike(a.1, b.1)) {
            let closure = |ending: &Ending| ending.closure.unwrap_or(0.0);
            let least = run.iter().max_by(|a, b| closure(a.1).total_cmp(&closure(b.1)));
            let Some((value, ending)) = least else { continue };
            let Some(evidence) = ending.evidence() else { continue };
            writeln!(out, "{} at {value:?}: {evidence}", ending.kind.name())?;
        }
        for run in endings.chunk_by(|a, b| a.1.fading == b.1.fading) {
            let states = taken(&run[0].1.fading);
            if states.is_empty() {
                continue;
            }
            let values = match [run[0].0, run[run.len() - 1].0] {
                [first, last] if first == last => format!("at {first:?}"),
                [first, last] => format!("from {first:?} to {last:?}"),
            };
            writeln!(
                out,
                "{values} contacts take {states} ever more briefly, and in the end not at all: the table leaves this out"
            )?;
        }
        Ok(())
    }
}

/// The states that were taken, as a table has them.
fn taken(taken: &[bool; 4]) -> String {
    let states = ContactState::ALL.iter().zip(taken).filter(|(_, taken)| **taken);
    states.map(|(state, _)| state.to_string()).collect::<Vec<_>>().join(" ")
}

fn changes(threshold: &MotionBracket) -> String {
    threshold.changes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Both bounds with the digits in which they differ, and one more.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn bounds(threshold: &MotionBracket) -> [String; 2] {
    let [low, high] = threshold.between;
    let decimals = (1.0 - (high - low).log10().floor()).clamp(0.0, 15.0) as usize;
    [low, high].map(|bound| format!("{bound:.decimals$}"))
}

fn mark(threshold: &MotionBracket) -> Mark {
    let [low, high] = threshold.between;
    let decimals = (-(high - low).log10().floor()).clamp(0.0, 15.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let place = format!("{:.*}", decimals as usize, f64::midpoint(low, high));
    Mark { x: f64::midpoint(low, high), label: Some(format!("{} at {place}", changes(threshold))) }
}
