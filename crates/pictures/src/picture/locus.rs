//! Root loci as charts: growth rates Re λ and frequencies Im λ/2π over a parameter.

use super::units::unit_of;
use super::{Chart, Mark, Panel, Series, prefixed, significant};
use amontons::decimal::to_significant;
use amontons_analysis::stability::locus::{Locus, Root};
use std::f64::consts::TAU;

/// The chart of one locus or of a family of them. In a family each has a label and a colour; a locus alone has one a
/// mode, and marks where modes begin to grow and where they merge.
#[must_use]
pub fn locus_chart(title: String, x_label: String, loci: &[(Option<String>, &Locus)]) -> Chart {
    drawn(title, x_label, loci, &|branch| branch + 1)
}

/// The chart of one locus whose branches have these numbers.
#[must_use]
pub fn numbered_locus_chart(
    title: String,
    x_label: String,
    locus: &Locus,
    numbers: &[usize],
) -> Chart {
    drawn(title, x_label, &[(None, locus)], &|branch| numbers[branch])
}

fn drawn(
    title: String,
    x_label: String,
    loci: &[(Option<String>, &Locus)],
    number: &dyn Fn(usize) -> usize,
) -> Chart {
    let panel = |y_label: &str, part: fn(&Root) -> f64, marks, zero_line| Panel {
        y_label: y_label.to_owned(),
        series: curves(loci, part, number),
        marks,
        zero_line,
        ..Panel::default()
    };
    let [critical, merging] = marks(loci, &x_label, number);
    Chart {
        title,
        x_label,
        panels: vec![
            panel("Growth rate [1/s]", |root| root.lambda.re, critical, true),
            panel("Frequency [Hz]", |root| root.lambda.im / TAU, merging, false),
        ],
        ..Chart::default()
    }
}

/// Curves in the order of their numbers.
fn curves(
    loci: &[(Option<String>, &Locus)],
    part: fn(&Root) -> f64,
    number: &dyn Fn(usize) -> usize,
) -> Vec<Series> {
    let mut curves = Vec::new();
    for (place, (label, locus)) in loci.iter().enumerate() {
        let mut followed: Vec<_> = locus.followed().map(|it| (number(it.0), it.1)).collect();
        followed.sort_by_key(|it| it.0);
        for (mode, branch) in followed {
            let (label, colour) = match label {
                Some(label) => (label.clone(), place),
                None => (format!("mode {mode}"), mode - 1),
            };
            let points = locus.values.iter().zip(branch);
            let points = points.filter(|(_, root)| locus.contains(**root));
            curves.push(Series {
                label: Some(label),
                points: points.map(|(&x, root)| [x, part(root)]).collect(),
                colour,
                ..Series::default()
            });
        }
    }
    curves
}

/// Marks at values where modes begin to grow, and where they merge; none for a family, which has too many.
fn marks(
    loci: &[(Option<String>, &Locus)],
    x_label: &str,
    number: &dyn Fn(usize) -> usize,
) -> [Vec<Mark>; 2] {
    let [(_, locus)] = loci else { return [Vec::new(), Vec::new()] };
    let mark = |x: f64, label: String| Mark { x, label: Some(label) };
    // The axis may have a prefix, so a value has its own unit.
    let value = |value: f64| match unit_of(x_label) {
        Some((_, unit)) if unit != "–" => prefixed(to_significant(value, 5), unit),
        _ => significant(value, 5),
    };
    let critical = locus.crossings.iter().map(|c| mark(c.value, value(c.value)));
    let merging = locus.coalescences.iter().map(|c| {
        let mut modes = c.modes.map(number);
        modes.sort_unstable();
        let [a, b] = modes;
        mark(c.value, format!("{a}–{b}: {}", value(c.value)))
    });
    // Double modes begin to grow at one place, which is marked once.
    let mut critical: Vec<Mark> = critical.collect();
    critical.dedup_by(|a, b| a.label == b.label);
    [critical, merging.collect()]
}
