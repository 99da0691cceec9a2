//! The picture of growth and decay in one run.

use amontons::contact::ContactState;
use amontons::numerics::max_norm;
use amontons::scene::Scene;
use amontons_analysis::study::transient::{Band, Finding, Phase, Transient};
use amontons_pictures::picture::{Chart, Class, Lane, LaneInterval, Panel, Raster, Series, Style};
use std::f64::consts::TAU;

/// Number of pieces of a curve with many values; each is drawn by its extrema.
const PIECES: usize = 1200;
/// Limits of the number of bands and of lanes that are drawn.
const MOST_BANDS: usize = 5;
const MOST_LANES: usize = 16;
/// Values below this part of the largest one are rounding errors and are not drawn.
const ROUNDING: f64 = 1e-12;
/// A line that begins after this part of the run is labelled at its beginning.
const LATE: f64 = 0.1;
/// Lower limit of the powers drawn, relative to the largest, dB.
const DEEPEST: f64 = -80.0;

/// The history, the logarithms of its amplitudes, its spectrogram, and the contact states.
#[must_use]
pub fn chart(scene: &Scene, found: &Transient) -> Chart {
    let panels = [Some(history(found)), amplitudes(found), spectrogram(found), states(found)];
    Chart {
        title: format!("Growth and decay of {} in {}", found.output, scene.name),
        x_label: "Time [s]".to_owned(),
        panels: panels.into_iter().flatten().collect(),
        ..Chart::default()
    }
}

/// Limit of the number of findings that are printed and drawn.
const MOST_LISTED: usize = 12;

/// The findings with the largest changes, in order of time: growth is preferred to decay, and combinations come last.
#[must_use]
pub fn most_telling(findings: &[Finding]) -> Vec<&Finding> {
    let change = |finding: &Finding| {
        let Phase { rate, span, .. } = &finding.phase;
        (rate * (span[1] - span[0])).abs()
    };
    let rank = |finding: &Finding| (finding.phase.combination.is_some(), finding.phase.rate < 0.0);
    let mut order: Vec<&Finding> = findings.iter().collect();
    order.sort_by(|a, b| rank(a).cmp(&rank(b)).then(change(b).total_cmp(&change(a))));
    order.truncate(MOST_LISTED);
    order.sort_by(|a, b| a.phase.span[0].total_cmp(&b.phase.span[0]));
    order
}

fn history(found: &Transient) -> Panel {
    let size = found.history.len().div_ceil(PIECES).max(1);
    let mut points = Vec::new();
    for (place, piece) in found.history.chunks(size).enumerate() {
        let ends = |better: &dyn Fn(f64, f64) -> bool| {
            (0..piece.len()).reduce(|a, b| if better(piece[b], piece[a]) { b } else { a })
        };
        // In the order of time, each once.
        let mut rows: Vec<usize> =
            [ends(&|b, a| b < a), ends(&|b, a| b > a)].into_iter().flatten().collect();
        rows.sort_unstable();
        rows.dedup();
        points.extend(
            rows.into_iter().map(|row| [(place * size + row) as f64 * found.interval, piece[row]]),
        );
    }
    Panel {
        y_label: format!("{} [{}]", found.output, found.unit),
        series: vec![Series { points, ..Series::default() }],
        ..Panel::default()
    }
}

/// The panel of the logarithms of amplitudes to base ten, with the fitted lines.
fn amplitudes(found: &Transient) -> Option<Panel> {
    let floor = ROUNDING * max_norm(&found.history);
    let logarithms = |points: &[[f64; 2]]| {
        let logarithm = |[time, amplitude]: &[f64; 2]| {
            [*time, if *amplitude > floor { amplitude.log10() } else { f64::NAN }]
        };
        points.iter().map(logarithm).collect::<Vec<_>>()
    };
    let growth = &found.growth;
    let whole = Series {
        label: Some("whole motion".to_owned()),
        points: logarithms(&thinned(&growth.envelope)),
        colour: 2,
        ..Series::default()
    };
    let has_shown = whole.points.iter().any(|[_, y]| y.is_finite());
    let bands = shown(found).into_iter().zip([0, 1, 3, 4, 5]).map(|(band, colour)| Series {
        label: Some(format!("band about {:.0} Hz", band.frequency)),
        points: broken(&logarithms(&band.amplitude)),
        colour,
        ..Series::default()
    });
    // If there is growth, decaying modes would only extend the axis far down.
    let grows = found.findings.iter().any(|finding| finding.phase.rate > 0.0);
    let own = most_telling(&found.findings).into_iter().filter(|finding| {
        let Phase { combination, displacement, amplitude, band, rate, .. } = &finding.phase;
        combination.is_none()
            && displacement.is_none()
            && amplitude.iter().all(|a| *a > floor)
            && (*rate > 0.0 || band.is_some() || !grows)
    });
    let fits = own.map(|Finding { phase, .. }| Series {
        label: Some("fitted exponential with its growth rate".to_owned()),
        points: phase.span.into_iter().zip(phase.amplitude).map(|(t, a)| [t, a.log10()]).collect(),
        labels: labels(phase, found.end),
        colour: 6,
        style: Style::Dashed,
        ..Series::default()
    });
    has_shown.then(|| Panel {
        y_label: format!("log10 of amplitude in {}", found.unit),
        series: std::iter::once(whole).chain(bands).chain(fits).collect(),
        ..Panel::default()
    })
}

/// The labels of the growth rate, of which one is empty: at the end of the line, or at its beginning if that is late.
fn labels(phase: &Phase, end: f64) -> Vec<String> {
    let Phase { rate, frequency, span, .. } = phase;
    let label =
        format!("{rate:+.2} 1/s ({:+.2} Hz) at {frequency:.1} Hz", rate / TAU).replace('-', "−");
    if span[0] > LATE * end { vec![label, String::new()] } else { vec![String::new(), label] }
}

/// The strongest band, and those with growth or decay of their own.
fn shown(found: &Transient) -> Vec<&Band> {
    let is_shown = |place: usize| {
        place == 0
            || found.findings.iter().any(|Finding { phase, .. }| {
                phase.band == Some(place) && phase.combination.is_none()
            })
    };
    let bands = found.growth.bands.iter().enumerate();
    bands.filter(|(place, _)| is_shown(*place)).map(|(_, band)| band).take(MOST_BANDS).collect()
}

/// The largest value of each piece of a curve.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let largest =
        |piece: &[[f64; 2]]| piece.iter().copied().reduce(|a, b| if b[1] > a[1] { b } else { a });
    points.chunks(points.len().div_ceil(PIECES).max(1)).filter_map(largest).collect()
}

/// A curve that breaks where points are missing; otherwise the points are equidistant.
fn broken(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let distance = points.windows(2).map(|two| two[1][0] - two[0][0]).fold(f64::INFINITY, f64::min);
    let mut curve: Vec<[f64; 2]> = Vec::new();
    for point in points {
        if curve.last().is_some_and(|last| point[0] - last[0] > 1.5 * distance) {
            curve.push([point[0], f64::NAN]);
        }
        curve.push(*point);
    }
    curve
}

fn spectrogram(found: &Transient) -> Option<Panel> {
    let spectrogram = &found.spectrogram;
    Some(Panel {
        y_label: "Frequency [Hz]".to_owned(),
        raster: Some(Raster {
            x: edges(&spectrogram.times)?,
            y: edges(&spectrogram.frequencies)?,
            rows: spectrogram.power.clone(),
            range: [DEEPEST, 0.0],
            label: "Power [dB]".to_owned(),
        }),
        ..Panel::default()
    })
}

/// The outer edges of cells around values at equal distances; `None` for fewer than two values.
fn edges(values: &[f64]) -> Option<[f64; 2]> {
    let [first, second, ..] = values else { return None };
    let half = 0.5 * (second - first);
    Some([first - half, values[values.len() - 1] + half])
}

fn states(found: &Transient) -> Option<Panel> {
    let courses = &found.courses[..found.courses.len().min(MOST_LANES)];
    let mut kinds: Vec<&[ContactState]> = Vec::new();
    let mut lanes = Vec::new();
    for course in courses {
        let stretch = |stretch: &amontons_analysis::study::transient::StateInterval| LaneInterval {
            from: stretch.from,
            to: stretch.to,
            class: 0,
        };
        let mut stretches: Vec<LaneInterval> = course.stretches.iter().map(stretch).collect();
        for (drawn, stretch) in stretches.iter_mut().zip(&course.stretches) {
            let known = kinds.iter().position(|kind| *kind == &stretch.states[..]);
            drawn.class = known.unwrap_or(kinds.len());
            if known.is_none() {
                kinds.push(&stretch.states);
            }
        }
        lanes.push(Lane { name: course.contact.clone(), stretches });
    }
    let classes = kinds.into_iter().map(Class::of_states);
    (!lanes.is_empty()).then(|| Panel {
        y_label: "Contacts".to_owned(),
        classes: classes.collect(),
        lanes,
        ..Panel::default()
    })
}
