//! The picture of limit cycles over a parameter.

use super::kinds;
use amontons::contact::ContactState;
use amontons::numerics::range;
use amontons::scene::Scene;
use amontons_analysis::study::{
    Kind, LimitCycles, LongTermMotion, MotionBracket, Outcome, Portrait, Question, output, unit,
};
use amontons_analysis::sweep::axis;
use amontons_pictures::picture::{Chart, Mark, Panel, Series, Style};

/// A study of limit cycles: its question and its results.
pub struct Results<'a> {
    /// The scene that was studied.
    pub scene: &'a Scene,
    /// The output whose amplitude and frequency are computed.
    pub of: &'a str,
    /// The parameter and its values.
    pub question: &'a Question,
    /// The limit cycles, with an outcome for each value.
    pub found: &'a LimitCycles,
}

impl Results<'_> {
    /// The values of the parameter, each with its outcome.
    pub fn outcomes(&self) -> impl Iterator<Item = (f64, &Outcome)> {
        self.question.values.iter().copied().zip(&self.found.outcomes)
    }

    /// The unit of the observed output, in brackets.
    #[must_use]
    pub fn unit(&self) -> String {
        let unit = output(self.scene, self.of).map_or("1", |output| unit(&output));
        if unit == "1" { String::new() } else { format!(" [{unit}]") }
    }

    /// Amplitude, frequency and shares of the states over the parameter.
    #[must_use]
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
            // The frequency of a decaying motion is of no interest.
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
            title: format!("{}: limit cycles of {}", self.scene.name, self.of),
            x_label: axis(self.scene, &self.question.name),
            panels,
            logarithmic: false,
        }
    }

    /// The series of a quantity over the parameter: a curve of the values that have settled, broken where the motion is
    /// rest, and dots for those that have not.
    fn curve(
        &self,
        label: Option<&str>,
        colour: usize,
        quantity: impl Fn(&LongTermMotion) -> Option<f64>,
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

    /// The orbits of the contacts in one plane; `direction` is `tangential` or `normal`.
    #[must_use]
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
            // Modules may have the same motion.
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
            // The slider's line is drawn first, below the orbits, which stick to it.
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
}

/// Describes the changes of a motion between two values.
#[must_use]
pub fn changes(threshold: &MotionBracket) -> String {
    threshold.changes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

fn mark(threshold: &MotionBracket) -> Mark {
    let [low, high] = threshold.between;
    let decimals = (-(high - low).log10().floor()).clamp(0.0, 15.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let place = format!("{:.*}", decimals as usize, f64::midpoint(low, high));
    Mark { x: f64::midpoint(low, high), label: Some(format!("{} at {place}", changes(threshold))) }
}
