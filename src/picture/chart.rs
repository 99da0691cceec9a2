//! Curves in panels, one above the other, over one x axis.

use super::axes::{Frame, LARGE, LEFT, RIGHT, SMALL, X_AXIS, range, roomy};
use super::band::Band;
use super::beside::{self, Beside};
use super::canvas::{self, Align, Canvas, Drawing, Failure, Point, text_width};
use super::lanes::Lane;
use super::legend::{Entry, Legend, Sample};
use super::map::Class;
use super::palette::{GREY, INK, colour, dashes};
use super::raster::Raster;
use crate::Error;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;
use serde::Serialize;
use std::path::Path;

const TITLE: f64 = 38.0;
const MARK_ROW: f64 = 18.0;
/// Rows of marks' labels that a panel has room for.
const MARK_ROWS: u32 = 8;
/// Between panels, px, of which this is above the marks' labels.
const GAP: f64 = 18.0;
const ABOVE: f64 = 8.0;

/// Panels over one x axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chart {
    /// What is to be seen.
    pub title: String,
    /// The quantity along x, with its unit.
    pub x_label: String,
    /// From top to bottom.
    pub panels: Vec<Panel>,
    /// Are both axes logarithmic? Then what is not above zero breaks a curve.
    pub logarithmic: bool,
}

/// Curves of one quantity, colours of a second one, or lanes in place of a y axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Panel {
    /// The quantity along y, with its unit.
    pub y_label: String,
    /// Drawn in this order, later ones over earlier ones.
    pub series: Vec<Series>,
    /// Drawn below the curves.
    pub marks: Vec<Mark>,
    /// Show y = 0, with a line?
    pub zero_line: bool,
    /// Shaded ranges of x, behind everything.
    pub bands: Vec<Band>,
    /// Colours for values over the plane of x and y, behind the curves.
    pub raster: Option<Raster>,
    /// Rows from top to bottom that take the place of the y axis: such a panel has neither series nor raster.
    pub lanes: Vec<Lane>,
    /// What the lanes' stretches can be, for the legend.
    pub classes: Vec<Class>,
}

/// A curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Series {
    /// For the legend, which equal labels in the same colour and style share.
    pub label: Option<String>,
    /// (x, y); one that is not finite breaks the curve.
    pub points: Vec<[f64; 2]>,
    /// Place in the [palette](super::PALETTE); beyond its end the colours come again, dashed.
    pub colour: usize,
    /// How it is drawn.
    pub style: Style,
    /// One for each point, which is then a dot; written beside it where there is room. Or none at all.
    pub labels: Vec<String>,
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Style {
    /// In full.
    #[default]
    Line,
    /// With short dashes.
    Dashed,
    /// As points that are not joined.
    Dots,
}

/// A place on the x axis worth a vertical line.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Mark {
    /// Where.
    pub x: f64,
    /// Written above its panel, where there is room: at most eight labels stand above each other.
    pub label: Option<String>,
}

impl Chart {
    /// Writes the chart as the path's ending asks, `.svg` or `.png`.
    ///
    /// # Errors
    /// Another ending, nothing finite to draw in a panel, or a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let layout = Layout::of(self).map_err(|failure| canvas::cannot_draw(path, &failure))?;
        canvas::write(&layout, path)
    }
}

impl Series {
    fn pen(&self) -> (RGBColor, f64, &'static [f64]) {
        let (colour, gaps) = (colour(self.colour), dashes(self.colour));
        match self.style {
            Style::Line => (colour, 1.8, gaps),
            Style::Dashed => (colour, 1.8, &[6.0, 4.0]),
            Style::Dots => (colour, 1.8, &[]),
        }
    }

    fn entry(&self) -> Option<Entry> {
        let (colour, _, dashes) = self.pen();
        let sample = Sample::Line { colour, dashes: dashes.to_vec() };
        self.label.clone().map(|label| Entry { label, sample })
    }
}

/// A chart with places for everything, px.
struct Layout<'a> {
    chart: &'a Chart,
    legend: Legend,
    frames: Vec<Frame<'a>>,
    labels: Vec<Vec<Label<'a>>>,
    beside: Vec<Vec<Beside>>,
}

/// A mark's label.
struct Label<'a> {
    text: &'a str,
    x: f64,
    row: u32,
    /// Does it end at its line, because the frame does?
    ends: bool,
}

impl<'a> Layout<'a> {
    fn of(chart: &'a Chart) -> Result<Self, Failure> {
        let series = chart.panels.iter().flat_map(|panel| &panel.series);
        let legend = Legend::new(series.clone().filter_map(Series::entry));
        let marks = chart.panels.iter().flat_map(|panel| &panel.marks);
        let shown = |series: &'a Series| chart.shown(series);
        let marks = marks.map(|mark| chart.scaled(mark.x)).filter(|x| x.is_finite());
        let x = range(series.flat_map(shown).map(|[x, _]| x).chain(marks))
            .ok_or_else(|| Failure("a chart needs at least one finite point".into()))?;
        let x = if chart.logarithmic { roomy(x) } else { x };
        let height = match chart.panels.len() {
            1 => 400.0,
            2 => 260.0,
            _ => 190.0,
        };
        let mut top = TITLE + legend.height;
        let (mut frames, mut labels, mut beside) = (Vec::new(), Vec::new(), Vec::new());
        for (place, panel) in chart.panels.iter().enumerate() {
            let last = place + 1 == chart.panels.len();
            let zero = panel.zero_line.then_some(0.0);
            let values = panel.series.iter().flat_map(shown).map(|[_, y]| y);
            let y = range(values.chain(zero)).ok_or_else(|| {
                Failure(format!("the panel {:?} has no finite point", panel.y_label))
            })?;
            let mut frame = Frame {
                top: 0.0,
                bottom: 0.0,
                x,
                y: roomy(y),
                y_label: &panel.y_label,
                x_label: last.then_some(&chart.x_label),
                grid: true,
                logarithmic: chart.logarithmic,
            };
            let above = mark_labels(chart, &frame, &panel.marks);
            let rows = above.iter().map(|label| label.row + 1).max().unwrap_or(0);
            frame.top = top + ABOVE + MARK_ROW * f64::from(rows);
            frame.bottom = frame.top + height;
            top = frame.bottom + if last { X_AXIS } else { GAP - ABOVE };
            frames.push(frame);
            labels.push(above);
            beside.push(beside_points(chart, &frame, panel));
        }
        Ok(Self { chart, legend, frames, labels, beside })
    }
}

impl Chart {
    /// A value as the axes have it.
    fn scaled(&self, value: f64) -> f64 {
        match self.logarithmic {
            true if value > 0.0 => value.log10(),
            true => f64::NAN,
            false => value,
        }
    }

    fn scaled_points<'a>(&'a self, series: &'a Series) -> impl Iterator<Item = Point> + 'a {
        series.points.iter().map(|point| point.map(|value| self.scaled(value)))
    }

    /// The points that can be shown, as the axes have them.
    fn shown<'a>(&'a self, series: &'a Series) -> impl Iterator<Item = Point> + 'a {
        self.scaled_points(series).filter(|[x, y]| x.is_finite() && y.is_finite())
    }
}

/// The points' own labels, where there is room.
fn beside_points(chart: &Chart, frame: &Frame<'_>, panel: &Panel) -> Vec<Beside> {
    let place = |series| chart.shown(series).map(|point| frame.at(point));
    let lines: Vec<Vec<Point>> =
        panel.series.iter().map(|series| place(series).collect()).collect();
    let labelled = panel.series.iter().flat_map(|series| {
        let points = chart.scaled_points(series).zip(&series.labels);
        let shown = points.filter(|([x, y], _)| x.is_finite() && y.is_finite());
        shown.map(|(point, label)| (frame.at(point), &**label))
    });
    beside::texts(frame, &labelled.collect::<Vec<_>>(), &lines)
}

/// Labels to the right of their lines, or at the right end to the left, in rows such that neither
/// labels nor lines cross a label.
fn mark_labels<'a>(chart: &Chart, frame: &Frame<'_>, marks: &'a [Mark]) -> Vec<Label<'a>> {
    let finite = marks.iter().filter(|mark| chart.scaled(mark.x).is_finite());
    let place = |mark: &Mark| frame.at_x(chart.scaled(mark.x));
    let mut labelled: Vec<(f64, &str)> =
        finite.filter_map(|mark| Some((place(mark), mark.label.as_deref()?))).collect();
    labelled.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut edge = f64::INFINITY;
    let (mut ending, mut starting) = (Vec::new(), Vec::new());
    for (x, text) in labelled {
        let width = 1.1 * text_width(text, SMALL) + 12.0;
        if (x + width > RIGHT + 10.0 || x > edge) && x > width {
            edge = edge.min(x - width);
            ending.push(([x - width, x], Label { text, x, row: 0, ends: true }));
        } else {
            starting.push(([x, x + width], Label { text, x, row: 0, ends: false }));
        }
    }
    let mut placed: Vec<([f64; 2], Label<'a>)> = Vec::new();
    // A line stands at its label's outer end and goes down past the labels placed before it, so
    // the labels farthest in the direction of writing come first.
    for (span, mut label) in ending.into_iter().rev().chain(starting) {
        let meets = |other: &[f64; 2]| span[0] < other[1] && other[0] < span[1];
        let below = placed.iter().filter(|(other, _)| meets(other)).map(|(_, label)| label.row);
        label.row = below.max().map_or(0, |row| row + 1);
        if label.row < MARK_ROWS {
            placed.push((span, label));
        }
    }
    placed.into_iter().map(|(_, label)| label).collect()
}

impl Drawing for Layout<'_> {
    fn title(&self) -> &str {
        &self.chart.title
    }

    fn description(&self) -> String {
        let quoted = |label: &str| format!("“{label}”");
        let list = |labels: Vec<String>| labels.join(", ");
        let mut text = String::new();
        for panel in &self.chart.panels {
            let curves = panel.series.iter().filter_map(|series| series.label.as_deref());
            let marks = panel.marks.iter().filter_map(|mark| mark.label.as_deref());
            text += &format!("{} over {}", quoted(&panel.y_label), quoted(&self.chart.x_label));
            text += &format!(", {} curves", panel.series.len());
            let (curves, marks) =
                (list(curves.map(quoted).collect()), list(marks.map(quoted).collect()));
            for (what, names) in [(": ", curves), ("; marked: ", marks)] {
                if !names.is_empty() {
                    text += what;
                    text += &names;
                }
            }
            text += ". ";
        }
        text.trim_end().to_owned()
    }

    fn height(&self) -> f64 {
        self.frames.last().map_or(TITLE, |frame| frame.bottom + X_AXIS + 8.0).ceil()
    }

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        canvas.text(&self.chart.title, [LEFT, 0.5 * TITLE], LARGE, Align::Left)?;
        self.legend.paint(canvas, TITLE)?;
        let panels = self.chart.panels.iter().zip(&self.frames);
        let texts = self.labels.iter().zip(&self.beside);
        for ((panel, frame), (labels, beside)) in panels.zip(texts) {
            frame.paint(canvas)?;
            if panel.zero_line {
                let y = frame.at_y(0.0);
                canvas.line(&[[LEFT, y], [RIGHT, y]], INK, 1.0, &[])?;
            }
            let marks = panel.marks.iter().map(|mark| self.chart.scaled(mark.x));
            for x in marks.filter(|x| x.is_finite()).map(|x| frame.at_x(x)) {
                canvas.line(&[[x, frame.top], [x, frame.bottom]], GREY, 1.0, &[5.0, 4.0])?;
            }
            for label in labels {
                paint_label(canvas, frame, label)?;
            }
            for series in &panel.series {
                paint_series(canvas, self.chart, frame, series)?;
            }
            for Beside { text, at, align } in beside {
                canvas.text(text, *at, SMALL, *align)?;
            }
        }
        Ok(())
    }
}

fn paint_label<B: DrawingBackend>(
    canvas: &Canvas<B>,
    frame: &Frame<'_>,
    label: &Label<'_>,
) -> Result<(), Failure> {
    let bottom = frame.top - MARK_ROW * f64::from(label.row);
    let (x, middle) = (label.x, bottom - 0.5 * MARK_ROW);
    canvas.line(&[[x, bottom - MARK_ROW + 2.0], [x, frame.top]], GREY, 1.0, &[])?;
    if label.ends {
        canvas.text(label.text, [x - 4.0, middle], SMALL, Align::Right)
    } else {
        canvas.text(label.text, [x + 4.0, middle], SMALL, Align::Left)
    }
}

fn paint_series<B: DrawingBackend>(
    canvas: &Canvas<B>,
    chart: &Chart,
    frame: &Frame<'_>,
    series: &Series,
) -> Result<(), Failure> {
    let (colour, width, dashes) = series.pen();
    let broken = |[x, y]: &Point| !(x.is_finite() && y.is_finite());
    let points: Vec<Point> = chart.scaled_points(series).collect();
    if !series.labels.is_empty() {
        for point in chart.shown(series) {
            canvas.dot(frame.at(point), 3.5, colour)?;
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
    Ok(())
}
