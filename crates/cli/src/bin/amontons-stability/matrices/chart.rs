//! Modes of matrices as a picture: over the parameter, or in the complex plane.

use super::found::{FollowedPoint, Found};
use amontons_pictures::picture::{Chart, Mark, Panel, Series, Style, significant};

pub fn chart(found: &Found) -> Chart {
    let title = format!("Modes of {} degrees of freedom", found.degrees_of_freedom);
    match &found.parameter {
        Some(parameter) if found.values.len() > 1 => {
            let x_label = if parameter.unit.is_empty() {
                parameter.name.clone()
            } else {
                format!("{} [{}]", parameter.name, parameter.unit)
            };
            over(found, title, x_label)
        }
        _ => plane(found, title),
    }
}

fn over(found: &Found, title: String, x_label: String) -> Chart {
    let panel = |y_label: &str, part: fn(&FollowedPoint) -> f64, marks, zero_line| Panel {
        y_label: y_label.to_owned(),
        series: found
            .branches
            .iter()
            .enumerate()
            .map(|(place, branch)| Series {
                points: branch.points.iter().map(|point| [point.value, part(point)]).collect(),
                colour: place,
                style: if branch.points.len() == 1 { Style::Dots } else { Style::Line },
                ..Series::default()
            })
            .collect(),
        marks,
        zero_line,
        ..Panel::default()
    };
    let turns = found.branches.iter().flat_map(|branch| &branch.crossings);
    let marks = turns.map(|turn| Mark { x: turn.value, label: Some(significant(turn.value, 4)) });
    Chart {
        title,
        x_label,
        panels: vec![
            panel("Growth rate [1/s]", |point| point.growth_rate, marks.collect(), true),
            panel("Frequency [Hz]", |point| point.frequency_hz, Vec::new(), false),
        ],
        ..Chart::default()
    }
}

/// Frequencies along x and growth rates along y: modes above the line grow.
fn plane(found: &Found, title: String) -> Chart {
    let modes = found.values.iter().flat_map(|value| &value.modes);
    let dots = |label: &str, colour, grows: Option<bool>| Series {
        label: Some(label.to_owned()),
        points: modes
            .clone()
            .filter(|mode| mode.grows == grows)
            .map(|mode| [mode.frequency_hz, mode.growth_rate])
            .collect(),
        colour,
        style: Style::Dots,
        ..Series::default()
    };
    let series = [
        dots("decays", 0, Some(false)),
        dots("grows", 1, Some(true)),
        dots("not known whether it grows", 2, None),
    ];
    Chart {
        title,
        x_label: "Frequency [Hz]".into(),
        panels: vec![Panel {
            y_label: "Growth rate [1/s]".into(),
            series: series.into_iter().filter(|series| !series.points.is_empty()).collect(),
            zero_line: true,
            ..Panel::default()
        }],
        ..Chart::default()
    }
}
