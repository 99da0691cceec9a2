//! A structure as an icon: a square without any text.

use super::course::bundles;
use super::place::places;
use super::plane::scaled;
use super::plot::Plot;
use super::sheet::FIRST;
use super::symbols::Shape;
use super::{Structure, text};
use crate::picture::canvas::{Canvas, Drawing, Failure, Point, WIDTH};
use plotters::backend::DrawingBackend;

/// Free at each side, px.
const MARGIN: f64 = 40.0;

pub(super) struct Icon<'a> {
    structure: &'a Structure,
    /// As large as there is room, px.
    shapes: Vec<Shape>,
}

impl<'a> Icon<'a> {
    pub(super) fn of(structure: &'a Structure) -> Self {
        let places = places(structure);
        let bundles = bundles(structure, &places);
        let (plot, _labels) = Plot::of(structure, &places, &bundles, FIRST).drawn();
        let mut reach = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for shape in &plot.shapes {
            let (points, half) = shape.extent();
            for point in points {
                for (axis, [from, to]) in reach.iter_mut().enumerate() {
                    *from = from.min(point[axis] - half);
                    *to = to.max(point[axis] + half);
                }
            }
        }
        let middle: Point = reach.map(|[from, to]| 0.5 * (from + to));
        let size = reach.map(|[from, to]| to - from);
        let factor = (WIDTH - 2.0 * MARGIN) / size[0].max(size[1]);
        let centred = |shape: &Shape| {
            let shape = shape.moved(scaled(middle, -1.0)).enlarged(factor);
            shape.moved([0.5 * WIDTH; 2])
        };
        Self { structure, shapes: plot.shapes.iter().map(centred).collect() }
    }
}

impl Drawing for Icon<'_> {
    fn title(&self) -> &str {
        &self.structure.title
    }

    fn description(&self) -> String {
        text::description(self.structure)
    }

    fn height(&self) -> f64 {
        WIDTH
    }

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        self.shapes.iter().try_for_each(|shape| shape.paint(canvas))
    }
}
