//! Curves and points, and the texts beside them.

use super::{Chart, Panel, Series, Style};
use crate::picture::axes::Frame;
use crate::picture::beside::{self, SideText};
use crate::picture::canvas::{Canvas, Failure, Point};
use crate::picture::legend::{DOT, Entry, Sample};
use crate::picture::palette::{colour, dashes, muted};
use plotters::backend::DrawingBackend;
use plotters::style::{RGBColor, WHITE};
use std::collections::HashSet;

impl Series {
    fn pen(&self) -> (RGBColor, f64, &'static [f64]) {
        let (colour, gaps) = (colour(self.colour), dashes(self.colour));
        match self.style {
            Style::Line => (colour, 1.8, gaps),
            Style::Dashed => (colour, 1.8, &[6.0, 4.0]),
            Style::Muted => (muted(self.colour), 1.2, gaps),
            Style::Dots => (colour, 2.0 * DOT, &[]),
        }
    }

    pub(super) fn entry(&self) -> Option<Entry> {
        let (colour, _, dashes) = self.pen();
        let dashes = (self.style != Style::Dots).then(|| dashes.to_vec());
        let sample = Sample::Curve { colour, dashes, marker: self.marker };
        self.label.clone().map(|label| Entry { label, sample })
    }

    /// `true` if a curve turns back in x, as loops do.
    pub(super) fn turns(&self) -> bool {
        let finite = self.points.iter().filter(|[x, y]| x.is_finite() && y.is_finite());
        let x: Vec<f64> = finite.map(|[x, _]| *x).collect();
        !(x.is_sorted() || x.iter().rev().is_sorted())
    }
}

/// The points' own labels, where there is room.
pub(super) fn beside_points(chart: &Chart, frame: &Frame<'_>, panel: &Panel) -> Vec<SideText> {
    let place = |series| chart.shown(series).map(|point| frame.at(point));
    let lines = panel.series.iter().flat_map(|series| -> Vec<Vec<Point>> {
        match series.style {
            Style::Line | Style::Dashed | Style::Muted => vec![place(series).collect()],
            Style::Dots => place(series).map(|point| vec![point; 2]).collect(),
        }
    });
    let lines: Vec<Vec<Point>> = lines.collect();
    let labelled = panel.series.iter().flat_map(|series| {
        let points = chart.scaled_points(series).zip(&series.labels);
        let shown = points.filter(|([x, y], _)| x.is_finite() && y.is_finite());
        shown.map(|(point, label)| (frame.at(point), &**label))
    });
    beside::texts(frame, &labelled.collect::<Vec<_>>(), &lines)
}

/// A curve or points, with a white edge where they lie on the colours of a raster.
pub(super) fn paint_series<B: DrawingBackend>(
    canvas: &Canvas<B>,
    chart: &Chart,
    frame: &Frame<'_>,
    series: &Series,
    edged: bool,
) -> Result<(), Failure> {
    let (colour, width, dashes) = series.pen();
    if edged {
        paint_strokes(canvas, chart, frame, series, (WHITE, width + 2.0, &[]))?;
    }
    paint_strokes(canvas, chart, frame, series, (colour, width, dashes))
}

fn paint_strokes<B: DrawingBackend>(
    canvas: &Canvas<B>,
    chart: &Chart,
    frame: &Frame<'_>,
    series: &Series,
    (colour, width, dashes): (RGBColor, f64, &[f64]),
) -> Result<(), Failure> {
    let mut marks = dots(chart.shown(series).map(|point| frame.at(point)));
    match (series.style, series.marker) {
        (Style::Dots, None) => {
            return marks.try_for_each(|place| canvas.dot(place, 0.5 * width, colour));
        }
        (Style::Dots, Some(marker)) => {
            return marks.try_for_each(|place| marker.paint(canvas, place, colour));
        }
        (Style::Line | Style::Dashed | Style::Muted, _) => {}
    }
    let broken = |[x, y]: &Point| !(x.is_finite() && y.is_finite());
    let points: Vec<Point> = chart.scaled_points(series).collect();
    if series.marker.is_none() && !series.labels.is_empty() {
        for point in chart.shown(series) {
            canvas.dot(frame.at(point), 0.5 * width + 2.6, colour)?;
        }
    }
    for run in points.split(broken) {
        let places: Vec<Point> = run.iter().map(|&point| frame.at(point)).collect();
        match places[..] {
            [] => {}
            [alone] => canvas.dot(alone, 0.8 * width + 0.5, colour)?,
            _ => canvas.line(&places, colour, width, dashes)?,
        }
    }
    // Over the line, which is not to be seen within a ring.
    match series.marker {
        Some(marker) => marks.try_for_each(|place| marker.paint(canvas, place, colour)),
        None => Ok(()),
    }
}

/// Places, px, without those that the eye cannot tell from an earlier one: there may be very many.
fn dots(places: impl Iterator<Item = Point>) -> impl Iterator<Item = Point> {
    let mut taken = HashSet::new();
    #[allow(clippy::cast_possible_truncation)]
    places.filter(move |place| taken.insert(place.map(|px| px.round() as i64)))
}
