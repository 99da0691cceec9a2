//! The picture of branches of periodic motions over a parameter.

use super::continuation;
use amontons::scene::Scene;
use amontons_analysis::orbit::{Branch, BranchPoint, SpecialKind};
use amontons_analysis::study::{Branches, Continuation, RestBranch, SweepDirection};
use amontons_analysis::sweep::axis;
use amontons_pictures::picture::{Chart, Marker, Panel, Series, Style};

/// Colours of rest and of neutral cycles, behind those of branches.
const REST: usize = 2;
const NEUTRAL: usize = 6;

/// Colours of the quasi-static ways upwards and downwards, behind everything.
const WAYS: [usize; 2] = [4, 3];
/// Heads of arrows along a quasi-static way over the whole range.
const HEADS: u32 = 6;

/// Amplitude of a degree of freedom and frequency over the parameter: stable motions as full lines, others dashed.
/// A continuation of the same amplitude over the same parameter is laid behind them.
#[must_use]
pub fn chart(
    scene: &Scene,
    (name, range): (&str, [f64; 2]),
    dof: usize,
    found: &Branches,
    over: Option<&Continuation>,
) -> Chart {
    let amplitude = |point: &BranchPoint| point.orbit.extents[dof];
    let frequency = |point: &BranchPoint| 1.0 / point.orbit.period;
    let mut amplitudes = over.map_or_else(Vec::new, |over| ways(over, range));
    let mut frequencies = Vec::new();
    if let Ok(rest) = &found.rest {
        amplitudes.extend(rest_curves(rest, range, dof));
    }
    let known = found.branches.iter().filter_map(|branch| branch.as_ref().ok());
    for (colour, branch) in known.enumerate() {
        amplitudes.extend(curves(branch, colour, &amplitude));
        frequencies.extend(curves(branch, colour, &frequency));
        amplitudes.extend(marks(branch, colour, dof));
    }
    let displacement = &scene.dof_names()[dof];
    let mut panels = vec![Panel {
        y_label: format!("Amplitude of {displacement} [m]"),
        series: amplitudes,
        zero_line: true,
        ..Panel::default()
    }];
    if !frequencies.is_empty() {
        panels.push(Panel {
            y_label: "Frequency [Hz]".to_owned(),
            series: frequencies,
            ..Panel::default()
        });
    }
    Chart {
        title: format!("{}: branches of periodic motions", scene.name),
        x_label: axis(scene, name),
        panels,
        logarithmic: false,
    }
}

/// The name of a kind of special point.
#[must_use]
pub fn kind(kind: &SpecialKind) -> &'static str {
    match kind {
        SpecialKind::Fold => "fold",
        SpecialKind::BranchPoint => "branch point",
        SpecialKind::PeriodDoubling => "period doubling",
        SpecialKind::NeimarkSacker => "Neimark–Sacker",
        SpecialKind::Sequence(_) => "change of events",
        SpecialKind::SequenceFold(_) => "fold at a change of events",
    }
}

fn marker(kind: &SpecialKind) -> Marker {
    match kind {
        SpecialKind::Fold => Marker::Disc,
        SpecialKind::BranchPoint => Marker::Diamond,
        SpecialKind::PeriodDoubling => Marker::Triangle,
        SpecialKind::NeimarkSacker => Marker::Square,
        SpecialKind::Sequence(_) => Marker::Ring,
        SpecialKind::SequenceFold(_) => Marker::Cross,
    }
}

/// A quantity along a branch, in pieces that are stable or not.
fn curves(branch: &Branch, colour: usize, of: &dyn Fn(&BranchPoint) -> f64) -> Vec<Series> {
    let is_stable = |point: &BranchPoint| point.orbit.is_stable() == Some(true);
    let mut pieces: Vec<Series> = Vec::new();
    for (style, stable, label) in
        [(Style::Line, true, "stable"), (Style::Dashed, false, "not stable")]
    {
        let mut points: Vec<[f64; 2]> = Vec::new();
        for two in branch.points.windows(2) {
            // A piece belongs to the kind of its ends; where they differ, to the one that is not stable.
            let piece = is_stable(&two[0]) && is_stable(&two[1]);
            if piece == stable {
                points.extend(two.iter().map(|point| [point.parameter, of(point)]));
            } else {
                points.push([two[1].parameter, f64::NAN]);
            }
        }
        if points.iter().any(|point| point[1].is_finite()) {
            let label = Some(label.to_owned());
            pieces.push(Series { label, points, colour, style, ..Series::default() });
        }
    }
    pieces
}

/// The special points of a branch, by kind.
fn marks(branch: &Branch, colour: usize, dof: usize) -> Vec<Series> {
    let mut series: Vec<Series> = Vec::new();
    for special in &branch.specials {
        let name = kind(&special.kind);
        let point = [special.parameter, special.orbit.extents[dof]];
        match series.iter_mut().find(|known| known.label.as_deref() == Some(name)) {
            Some(known) => known.points.push(point),
            None => series.push(Series {
                label: Some(name.to_owned()),
                points: vec![point],
                colour,
                style: Style::Dots,
                marker: Some(marker(&special.kind)),
                ..Series::default()
            }),
        }
    }
    series
}

/// Both quasi-static ways: thin lines with heads of arrows along them and in their jumps.
fn ways(over: &Continuation, range: [f64; 2]) -> Vec<Series> {
    let mut series = Vec::new();
    for ((way, colour), head) in
        SweepDirection::ALL.into_iter().zip(WAYS).zip([Marker::Right, Marker::Left])
    {
        let is_within = |[x, _]: &[f64; 2]| (range[0]..=range[1]).contains(x);
        let (mut line, jumps) = continuation::way(over, way);
        line.retain(is_within);
        let heads = (0..HEADS).filter_map(|place| head_at(&line, way, place)).collect();
        let (mut up, mut down) = (Vec::new(), Vec::new());
        for jump in jumps.into_iter().filter(|jump| jump.iter().all(is_within)) {
            if let Some(two) = jump.windows(2).find(|two| two[0][0] == two[1][0]) {
                let [[x, from], [_, to]] = [two[0], two[1]];
                let heads = if to > from { &mut up } else { &mut down };
                heads.push([x, f64::midpoint(from, to)]);
            }
            line.push([f64::NAN; 2]);
            line.extend(jump);
        }
        series.push(Series { points: line, colour, style: Style::Muted, ..Series::default() });
        let label = Some(format!("quasi-static, {}", way.name()));
        for (marker, points, label) in
            [(head, heads, label), (Marker::Up, up, None), (Marker::Down, down, None)]
        {
            let (style, marker) = (Style::Dots, Some(marker));
            series.push(Series { label, points, colour, style, marker, ..Series::default() });
        }
    }
    series
}

/// The place of one of the heads of arrows along a way; those of the two ways take turns. `None` where the way has no line.
fn head_at(line: &[[f64; 2]], way: SweepDirection, place: u32) -> Option<[f64; 2]> {
    let shift = if way == SweepDirection::Rising { 0.25 } else { 0.75 };
    let ([first, _], [last, _]) = (line.first()?, line.last()?);
    let x = first + (last - first) * (f64::from(place) + shift) / f64::from(HEADS);
    let end = line.iter().position(|point| point[0] > x)?;
    let [[x0, y0], [x1, y1]] = [*line.get(end.checked_sub(1)?)?, line[end]];
    let y = y0 + (y1 - y0) * (x - x0) / (x1 - x0);
    y.is_finite().then_some([x, y])
}

/// Rest along zero, and neutral cycles as vertical lines.
fn rest_curves(rest: &RestBranch, [first, last]: [f64; 2], dof: usize) -> Vec<Series> {
    let mut stable = Vec::new();
    let mut unstable = Vec::new();
    let mut from = first;
    for [begins, ends] in &rest.stable {
        if *begins > from {
            unstable.extend([[from, 0.0], [*begins, 0.0], [*begins, f64::NAN]]);
        }
        stable.extend([[*begins, 0.0], [*ends, 0.0], [*ends, f64::NAN]]);
        from = *ends;
    }
    if from < last {
        unstable.extend([[from, 0.0], [last, 0.0]]);
    }
    let neutral = rest.crossings.iter().filter_map(|crossing| {
        let top = *crossing.neutral_up_to.as_ref()?.get(dof)?;
        let x = crossing.parameter;
        Some([[x, 0.0], [x, top], [x, f64::NAN]])
    });
    let neutral: Vec<[f64; 2]> = neutral.flatten().collect();
    [
        ("rest, stable", stable, REST, Style::Line),
        ("rest, unstable", unstable, REST, Style::Dashed),
        ("neutral cycles", neutral, NEUTRAL, Style::Line),
    ]
    .into_iter()
    .filter(|(_, points, ..)| !points.is_empty())
    .map(|(label, points, colour, style)| Series {
        label: Some(label.to_owned()),
        points,
        colour,
        style,
        ..Series::default()
    })
    .collect()
}
