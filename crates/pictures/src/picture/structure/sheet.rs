//! A structure with a place for everything, px.

use super::Structure;
use super::course::{Course, bundles};
use super::labels::Label;
use super::legend::{Legend, Used};
use super::place::places;
use super::plane::add;
use super::plot::{Plot, Style};
use super::symbols::{self, Shape};
use super::text::{description, rows, values};
use crate::picture::axes::{LARGE, SMALL};
use crate::picture::canvas::{Align, Canvas, Drawing, Failure, Point, WIDTH, text_width};
use crate::picture::palette::GREY;
use plotters::backend::DrawingBackend;

const MARGIN: f64 = 20.0;
/// Free at least at the left and the right of all that there is, px.
const EDGE: f64 = 8.0;
const TITLE_ROW: f64 = 28.0;
const TEXT_ROW: f64 = 22.0;

pub(super) const FIRST: Style =
    Style { values: true, size: 15.0, margin: 90.0, amplitude: 6.0, largest: 0.24 };
/// Tried in turn after the first, until every label has a place at what it speaks of.
const STYLES: [Style; 2] = [
    Style { values: false, size: 15.0, margin: 40.0, amplitude: 6.0, largest: 0.28 },
    Style { values: false, size: 12.0, margin: 34.0, amplitude: 4.5, largest: 0.31 },
];

pub(super) struct Sheet<'a> {
    structure: &'a Structure,
    size: f64,
    pub(super) shapes: Vec<Shape>,
    pub(super) labels: Vec<Label>,
    legend: Legend,
    title: Vec<String>,
    list: Vec<String>,
    /// What is drawn is moved to the right and down by it.
    by: Point,
    /// Lower end of what is drawn.
    bottom: f64,
    /// Of the picture, with all its texts.
    width: f64,
}

impl<'a> Sheet<'a> {
    pub(super) fn of(structure: &'a Structure) -> Self {
        let places = places(structure);
        let bundles = bundles(structure, &places);
        let drawn = |style| Plot::of(structure, &places, &bundles, style).drawn();
        let mut styles = STYLES.into_iter();
        let (mut plot, mut labels) = drawn(FIRST);
        while !labels.all_near
            && let Some(style) = styles.next()
        {
            (plot, labels) = drawn(style);
        }
        let named = bundles.iter().any(|bundle| matches!(bundle.course, Course::Named(..)));
        let used = Used {
            acts: labels.placed.iter().any(|label| label.acts.is_some()),
            named,
            repeated: labels.left_out,
        };
        let words: Vec<String> = structure.title.split_whitespace().map(Into::into).collect();
        let across = WIDTH - 2.0 * MARGIN;
        let title = rows(&words, " ", LARGE, across);
        let list = if plot.style.values { Vec::new() } else { values(structure) };
        let list = rows(&list, ";   ", SMALL, across);
        let mut sheet = Self {
            structure,
            size: plot.style.size,
            shapes: plot.shapes,
            labels: labels.placed,
            legend: Legend::of(structure, used),
            title,
            list,
            by: [0.0; 2],
            bottom: 0.0,
            width: WIDTH,
        };
        sheet.fit();
        sheet
    }

    /// Finds how far what is drawn reaches, and gives the picture room for it and for all texts.
    #[allow(clippy::cast_precision_loss)]
    fn fit(&mut self) {
        let mut reach = [[EDGE, WIDTH - EDGE], [f64::INFINITY, f64::NEG_INFINITY]];
        let mut extend = |[x, y]: Point, half: Point| {
            for ([from, to], (at, half)) in reach.iter_mut().zip([(x, half[0]), (y, half[1])]) {
                (*from, *to) = (from.min(at - half), to.max(at + half));
            }
        };
        for shape in &self.shapes {
            let (points, half) = shape.extent();
            points.iter().for_each(|point| extend(*point, [half; 2]));
        }
        self.labels.iter().for_each(|label| extend(label.area.middle, label.area.half));
        let [[left, right], [top, bottom]] = reach;
        let head = 14.0 + TITLE_ROW * self.title.len() as f64 + 14.0;
        self.by = [EDGE - left, head - top];
        self.bottom = (bottom + self.by[1] + 18.0).ceil();
        let titles = self.title.iter().map(|row| text_width(row, LARGE));
        let rows = self.list.iter().map(|row| text_width(row, SMALL));
        let words = self.legend.words.iter().map(|(words, at)| at[0] + text_width(words, SMALL));
        let texts = titles.chain(rows).map(|width| MARGIN + width).chain(words);
        let widest = texts.map(|right| right + EDGE).fold(right + self.by[0] + EDGE, f64::max);
        self.width = widest.max(WIDTH).ceil();
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
        let mut y = 14.0 + 0.5 * TITLE_ROW;
        for row in &self.title {
            canvas.text(row, [MARGIN, y], LARGE, Align::Left)?;
            y += TITLE_ROW;
        }
        let moved = |point: Point| add(point, self.by);
        for label in &self.labels {
            if let Some(leader) = label.leader {
                canvas.line(&leader.map(moved), GREY, 1.0, &[])?;
            }
        }
        for shape in &self.shapes {
            shape.moved(self.by).paint(canvas)?;
        }
        for label in &self.labels {
            let (arrow, middles) = label.parts(self.size);
            if let Some(way) = label.acts {
                let mut shapes = Vec::new();
                symbols::acts(moved(arrow), way, 0.55 * self.size, &mut shapes);
                shapes.iter().try_for_each(|shape| shape.paint(canvas))?;
            }
            for (line, middle) in label.lines.iter().zip(middles) {
                canvas.text(line, moved(middle), self.size, Align::Centre)?;
            }
        }
        let mut y = self.bottom + 0.5 * TEXT_ROW;
        for row in &self.list {
            canvas.text(row, [MARGIN, y], SMALL, Align::Left)?;
            y += TEXT_ROW;
        }
        let top = y - 0.5 * TEXT_ROW + 4.0;
        for shape in &self.legend.shapes {
            shape.moved([0.0, top]).paint(canvas)?;
        }
        for (words, at) in &self.legend.words {
            canvas.text(words, add(*at, [0.0, top]), SMALL, Align::Left)?;
        }
        Ok(())
    }
}
