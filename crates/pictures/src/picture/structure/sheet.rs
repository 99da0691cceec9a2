//! A structure with a place for everything, px: as a picture, or as an icon without any text.

use super::Structure;
use super::labels::{EDGE, Label};
use super::layout::{End, places, runs};
use super::legend::{StructureLegend, UsedSymbols};
use super::plane::{add, reach, scaled};
use super::plot::{Plot, SheetStyle};
use super::symbols::Shape;
use super::text::{description, rows, values};
use crate::picture::axes::{LARGE, SMALL};
use crate::picture::canvas::{Align, Canvas, Drawing, Failure, Point, WIDTH, text_width};
use plotters::backend::DrawingBackend;

const MARGIN: f64 = 20.0;
const TITLE_ROW: f64 = 28.0;
const TEXT_ROW: f64 = 22.0;
/// Free space at each side of an icon, px.
const ICON_MARGIN: f64 = 40.0;

/// Styles, tried in turn until every label has a place at the line that it belongs to.
const STYLES: [SheetStyle; 3] = [
    SheetStyle { values: true, size: 15.0, margin: 90.0, amplitude: 6.0, largest: 0.24 },
    SheetStyle { values: false, size: 15.0, margin: 40.0, amplitude: 6.0, largest: 0.28 },
    SheetStyle { values: false, size: 12.0, margin: 36.0, amplitude: 4.5, largest: 0.31 },
];

fn inked(shapes: &[Shape]) -> impl Iterator<Item = (Point, Point)> {
    shapes.iter().flat_map(|shape| shape.points.iter().map(|point| (*point, [shape.ink(); 2])))
}

pub(super) struct Sheet<'a> {
    structure: &'a Structure,
    /// Size of the letters of labels, px.
    size: f64,
    pub(super) shapes: Vec<Shape>,
    pub(super) labels: Vec<Label>,
    legend: StructureLegend,
    title: Vec<String>,
    list: Vec<String>,
    /// Shift of the drawing to the right and down.
    by: Point,
    /// Lower end of the drawing.
    bottom: f64,
    /// Width of the picture, with all its texts.
    width: f64,
}

impl<'a> Sheet<'a> {
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn of(structure: &'a Structure) -> Self {
        let places = places(structure);
        let runs = runs(structure, &places);
        let drawn = |style| Plot::of(structure, &places, &runs, style);
        let [first, other, last] = STYLES;
        let found = [first, other].into_iter().map(drawn).find(|(_, labels)| labels.all_near());
        let (plot, labels) = found.unwrap_or_else(|| drawn(last));
        let (shapes, labels, size) = (plot.shapes, labels.placed, plot.style.size);
        let used = UsedSymbols {
            acts: labels.iter().any(|label| label.acts.is_some()),
            named: runs.iter().any(|run| matches!(run.end, End::Name(_))),
        };
        let across = WIDTH - 2.0 * MARGIN;
        let words = |text: &str| text.split(' ').map(Into::into).collect::<Vec<String>>();
        let title = rows(&words(&structure.title), " ", LARGE, across);
        let list = if plot.style.values { Vec::new() } else { values(structure) };
        let list = rows(&list, ";   ", SMALL, across);
        // One of many names may be longer than a row.
        let list: Vec<String> =
            list.iter().flat_map(|row| rows(&words(row), " ", SMALL, across)).collect();
        let legend = StructureLegend::of(structure, used);
        // The drawing is in the middle of the picture, which is as wide as all texts need.
        let areas = labels.iter().map(|label| (label.middle, label.half));
        let [[left, right], [top, bottom]] = reach(inked(&shapes).chain(areas));
        let end = |row: &String, size| MARGIN + text_width(row, size);
        let texts = title.iter().map(|row| end(row, LARGE));
        let texts = texts.chain(list.iter().map(|row| end(row, SMALL))).chain([legend.width]);
        let width = texts.fold(right - left + EDGE, f64::max) + EDGE;
        let width = width.max(WIDTH).ceil();
        let head = 14.0 + TITLE_ROW * title.len() as f64 + 14.0;
        let by = [0.5 * (width - left - right), head - top];
        let bottom = (bottom + by[1] + 18.0).ceil();
        Self { structure, size, shapes, labels, legend, title, list, by, bottom, width }
    }
}

impl Drawing for Sheet<'_> {
    fn title(&self) -> &str {
        &self.structure.title
    }

    fn description(&self) -> String {
        description(self.structure)
    }

    fn width(&self) -> f64 {
        self.width
    }

    #[allow(clippy::cast_precision_loss)]
    fn height(&self) -> f64 {
        self.bottom + TEXT_ROW * self.list.len() as f64 + self.legend.height + 16.0
    }

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        let write_rows = |rows: &[String], top: f64, row: f64, size: f64| {
            rows.iter().try_fold(top, |y, text| {
                canvas.text(text, [MARGIN, y + 0.5 * row], size, Align::Left).map(|()| y + row)
            })
        };
        write_rows(&self.title, 14.0, TITLE_ROW, LARGE)?;
        let at_labels = self.labels.iter().flat_map(|label| label.shapes(self.size));
        for shape in self.shapes.iter().cloned().chain(at_labels) {
            shape.placed(1.0, self.by).paint(canvas)?;
        }
        for (line, middle) in self.labels.iter().flat_map(|label| label.texts(self.size)) {
            canvas.text(line, add(middle, self.by), self.size, Align::Centre)?;
        }
        let top = write_rows(&self.list, self.bottom, TEXT_ROW, SMALL)? + 4.0;
        self.legend.paint(top, canvas)
    }
}

pub(super) struct Icon<'a> {
    structure: &'a Structure,
    /// The shapes, as large as there is room, px.
    shapes: Vec<Shape>,
}

impl<'a> Icon<'a> {
    pub(super) fn of(structure: &'a Structure) -> Self {
        let places = places(structure);
        let runs = runs(structure, &places);
        let (plot, _labels) = Plot::of(structure, &places, &runs, STYLES[0]);
        let reach = reach(inked(&plot.shapes));
        let largest = reach.iter().map(|[from, to]| to - from).fold(0.0, f64::max);
        let factor = (WIDTH - 2.0 * ICON_MARGIN) / largest;
        let middle = reach.map(|[from, to]| 0.5 * (from + to));
        let by = add([0.5 * WIDTH; 2], scaled(middle, -factor));
        let shapes = plot.shapes.iter().map(|shape| shape.placed(factor, by)).collect();
        Self { structure, shapes }
    }
}

impl Drawing for Icon<'_> {
    fn title(&self) -> &str {
        &self.structure.title
    }

    fn description(&self) -> String {
        description(self.structure)
    }

    fn height(&self) -> f64 {
        WIDTH
    }

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        self.shapes.iter().try_for_each(|shape| shape.paint(canvas))
    }
}
