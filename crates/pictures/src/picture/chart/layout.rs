//! A chart with places for everything, px.

use super::curves::{beside_points, paint_series};
use super::lanes;
use super::marks::{MARK_ROW, MarkLabel, mark_labels, paint_label, paint_marks};
use super::{Band, Chart, Panel, Series, raster};
use crate::picture::axes::{Frame, LARGE, LEFT, RIGHT, SMALL, X_AXIS, range, roomy};
use crate::picture::beside::SideText;
use crate::picture::canvas::{Align, Canvas, Drawing, Failure, Point};
use crate::picture::legend::Legend;
use crate::picture::palette::INK;
use plotters::backend::DrawingBackend;

const TITLE: f64 = 38.0;
/// Space between panels, px, of which `ABOVE` is above the marks' labels.
const GAP: f64 = 18.0;
const ABOVE: f64 = 8.0;

/// A chart with places for everything, px.
pub(super) struct Layout<'a> {
    chart: &'a Chart,
    legend: Legend,
    panels: Vec<Placed<'a>>,
}

/// A panel with its places.
struct Placed<'a> {
    panel: &'a Panel,
    /// Position of its scale of colours or its heading.
    head: f64,
    frame: Frame<'a>,
    labels: Vec<MarkLabel<'a>>,
    beside: Vec<SideText>,
}

impl<'a> Layout<'a> {
    pub(super) fn of(chart: &'a Chart) -> Result<Self, Failure> {
        let panels = &chart.panels;
        for panel in panels {
            lanes::check(panel)?;
            panel.raster.iter().try_for_each(|r| r.check(&panel.y_label, chart.logarithmic))?;
        }
        let curves = panels.iter().flat_map(|panel| panel.series.iter().filter_map(Series::entry));
        let bands = panels.iter().flat_map(|panel| panel.bands.iter().filter_map(Band::entry));
        let legend = Legend::new(curves.chain(bands).chain(panels.iter().flat_map(lanes::entries)));
        let x = chart.x_range()?;
        let left = panels.iter().map(|panel| lanes::left(&panel.lanes)).fold(LEFT, f64::max);
        let height = match panels.iter().filter(|panel| panel.lanes.is_empty()).count() {
            0 | 1 => 400.0,
            2 => 260.0,
            _ => 190.0,
        };
        let mut top = TITLE + legend.height;
        let mut placed = Vec::new();
        for (place, panel) in panels.iter().enumerate() {
            let last = place + 1 == panels.len();
            let mut frame = Frame {
                left,
                top: 0.0,
                bottom: 0.0,
                x,
                y: chart.y_range(panel)?,
                y_label: &panel.y_label,
                x_label: last.then_some(&chart.x_label),
                grid: panel.raster.is_none(),
                y_axis: panel.lanes.is_empty(),
                logarithmic: chart.logarithmic,
            };
            let head = top + ABOVE;
            let labels = mark_labels(chart, &frame, &panel.marks);
            let rows = labels.iter().map(|label| label.row + 1).max().unwrap_or(0);
            frame.top = head + panel.head() + MARK_ROW * f64::from(rows);
            frame.bottom =
                frame.top + if frame.y_axis { height } else { lanes::height(&panel.lanes) };
            top = frame.bottom + if last { X_AXIS } else { GAP - ABOVE };
            let beside = beside_points(chart, &frame, panel);
            placed.push(Placed { panel, head, frame, labels, beside });
        }
        Ok(Self { chart, legend, panels: placed })
    }
}

impl Panel {
    /// Height of its scale of colours or its heading above the marks' labels, px.
    fn head(&self) -> f64 {
        match (&self.raster, self.lanes.is_empty() || self.y_label.is_empty()) {
            (Some(_), _) => raster::SCALE,
            (None, false) => lanes::HEADING,
            (None, true) => 0.0,
        }
    }

    /// Description of the panel over the x axis in words, for readers who cannot see it.
    fn words(&self, x_label: &str) -> String {
        let quoted = |label: &str| format!("“{label}”");
        let curves = self.series.iter().filter_map(|series| series.label.as_deref());
        let marks = self.marks.iter().filter_map(|mark| mark.label.as_deref());
        let mut text = format!("{} over {}", quoted(&self.y_label), quoted(x_label));
        if let Some(raster) = &self.raster {
            text += &format!(", {}", raster.words());
        }
        text += &match self.lanes.is_empty() {
            true if self.series.len() == 1 => ", 1 curve".to_owned(),
            true => format!(", {} curves", self.series.len()),
            false => format!(", {}", lanes::words(self)),
        };
        let lists: [(&str, Vec<String>); 3] = [
            (": ", curves.map(quoted).collect()),
            ("; marked: ", marks.map(quoted).collect()),
            ("; shaded: ", self.bands.iter().map(Band::words).collect()),
        ];
        for (what, names) in lists.iter().filter(|(_, names)| !names.is_empty()) {
            text += what;
            text += &names.join(", ");
        }
        text + ". "
    }
}

impl Chart {
    /// A value as the axes have it.
    pub(super) fn scaled(&self, value: f64) -> f64 {
        match self.logarithmic {
            true if value > 0.0 => value.log10(),
            true => f64::NAN,
            false => value,
        }
    }

    pub(super) fn scaled_points<'a>(
        &'a self,
        series: &'a Series,
    ) -> impl Iterator<Item = Point> + 'a {
        series.points.iter().map(|point| point.map(|value| self.scaled(value)))
    }

    /// The points that can be shown, as the axes have them.
    pub(super) fn shown<'a>(&'a self, series: &'a Series) -> impl Iterator<Item = Point> + 'a {
        self.scaled_points(series).filter(|[x, y]| x.is_finite() && y.is_finite())
    }

    /// The values that the x axis of all panels shows.
    pub(in crate::picture) fn x_range(&self) -> Result<[f64; 2], Failure> {
        let of = |panel: &Panel| -> Vec<f64> {
            let series = panel.series.iter().flat_map(|series| self.shown(series));
            let bands = panel.bands.iter().flat_map(|band| [band.from, band.to]);
            let marks = panel.marks.iter().map(|mark| mark.x);
            let stretches = panel.lanes.iter().flat_map(|lane| &lane.stretches);
            let others = bands.chain(marks).chain(stretches.flat_map(|s| [s.from, s.to]));
            let raster = panel.raster.iter().flat_map(|raster| raster.x);
            series.map(|[x, _]| x).chain(others.map(|x| self.scaled(x))).chain(raster).collect()
        };
        let x = range(self.panels.iter().flat_map(of))
            .ok_or_else(|| Failure("a chart needs at least one finite point".into()))?;
        // Curves over x end at the frame; loops would lie on it.
        let loops = self.panels.iter().flat_map(|panel| &panel.series).any(Series::turns);
        let raster = self.panels.iter().any(|panel| panel.raster.is_some());
        Ok(if self.logarithmic || loops && !raster { roomy(x) } else { x })
    }

    /// The values that a panel's y axis shows. The cells of a raster end at the frame.
    pub(in crate::picture) fn y_range(&self, panel: &Panel) -> Result<[f64; 2], Failure> {
        if !panel.lanes.is_empty() {
            return Ok([0.0, 1.0]);
        }
        let zero = panel.zero_line.then_some(0.0);
        let values = panel.series.iter().flat_map(|series| self.shown(series)).map(|[_, y]| y);
        let raster = panel.raster.iter().flat_map(|raster| raster.y);
        let y = range(values.chain(zero).chain(raster))
            .ok_or_else(|| Failure(format!("the panel {:?} has no finite point", panel.y_label)))?;
        Ok(if panel.raster.is_some() { y } else { roomy(y) })
    }
}

impl Drawing for Layout<'_> {
    fn title(&self) -> &str {
        &self.chart.title
    }

    fn description(&self) -> String {
        let words = self.chart.panels.iter().map(|panel| panel.words(&self.chart.x_label));
        words.collect::<String>().trim_end().to_owned()
    }

    fn height(&self) -> f64 {
        self.panels.last().map_or(TITLE, |placed| placed.frame.bottom + X_AXIS + 8.0).ceil()
    }

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        canvas.text(&self.chart.title, [LEFT, 0.5 * TITLE], LARGE, Align::Left)?;
        self.legend.paint(canvas, TITLE)?;
        self.panels.iter().try_for_each(|placed| placed.paint(canvas, self.chart))
    }
}

impl Placed<'_> {
    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>, chart: &Chart) -> Result<(), Failure> {
        let Self { panel, head, frame, labels, beside } = self;
        if let Some(raster) = &panel.raster {
            raster.paint(canvas, frame)?;
            raster.paint_scale(canvas, *head)?;
        }
        let covered = panel.raster.is_some();
        if !covered {
            panel.bands.iter().try_for_each(|band| band.paint(canvas, chart, frame))?;
        }
        frame.paint(canvas)?;
        if covered {
            panel.bands.iter().try_for_each(|band| band.paint_ends(canvas, chart, frame))?;
        }
        if !frame.y_axis {
            if !panel.y_label.is_empty() {
                lanes::paint_heading(canvas, &panel.y_label, frame.left, *head)?;
            }
            lanes::paint(canvas, chart, frame, panel)?;
        }
        if panel.zero_line && frame.y_axis {
            let y = frame.at_y(0.0);
            canvas.line(&[[frame.left, y], [RIGHT, y]], INK, 1.0, &[])?;
        }
        paint_marks(canvas, chart, frame, &panel.marks, covered || !frame.y_axis)?;
        labels.iter().try_for_each(|label| paint_label(canvas, frame, label))?;
        for series in &panel.series {
            paint_series(canvas, chart, frame, series, covered)?;
        }
        for SideText { text, at, align } in beside {
            canvas.text(text, *at, SMALL, *align)?;
        }
        Ok(())
    }
}
