//! Maps: which class each point of a plane belongs to.

use super::axes::{Frame, LARGE, LEFT, X_AXIS};
use super::canvas::{self, Align, Canvas, Drawing, Failure};
use super::class::Class;
use super::legend::Legend;
use amontons::Error;
use plotters::backend::DrawingBackend;
use serde::Serialize;
use std::path::Path;

const TITLE: f64 = 38.0;
const HEIGHT: f64 = 480.0;
/// Height of a class's stripes, px.
const STRIPE: f64 = 5.0;

/// Classes over a plane. Labels with units are treated as those of a [`Chart`](super::Chart).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Map {
    /// Title of the picture.
    pub title: String,
    /// The quantity along x, with its unit.
    pub x_label: String,
    /// The quantity along y, with its unit.
    pub y_label: String,
    /// Range from the middle of the first column to the middle of the last: the picture ends there.
    pub x: [f64; 2],
    /// Range from the middle of the first row to the middle of the last.
    pub y: [f64; 2],
    /// Rows of cells, the lowest row first: each cell's place in `classes`.
    pub cells: Vec<Vec<usize>>,
    /// The classes that the cells can have.
    pub classes: Vec<Class>,
}

impl Map {
    /// Writes the map as the path's ending asks, `.svg` or `.png`.
    ///
    /// # Errors
    /// Another ending, no cells, rows that differ in length, a cell of no class, axes that do not
    /// ascend, or a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        self.whole().map_err(|failure| canvas::cannot_draw(path, &failure))?;
        let legend = Legend::new(self.classes.iter().map(Class::entry));
        canvas::write(&MapLayout { map: &self.in_prefixed_units(), legend }, path)
    }

    /// The text of an SVG, as [`write`](Self::write) writes it.
    ///
    /// # Errors
    /// No cells, rows that differ in length, a cell of no class, or axes that do not ascend.
    pub fn svg(&self) -> Result<String, Error> {
        self.whole().map_err(|failure| canvas::cannot_draw_titled(&self.title, &failure))?;
        let legend = Legend::new(self.classes.iter().map(Class::entry));
        canvas::svg_text(&MapLayout { map: &self.in_prefixed_units(), legend })
    }

    fn whole(&self) -> Result<(), Failure> {
        let columns = self.cells.first().map_or(0, Vec::len);
        if columns == 0 {
            return Err(Failure("a map needs at least one cell".into()));
        }
        for (name, [from, to]) in [("x", self.x), ("y", self.y)] {
            if !(from.is_finite() && to.is_finite() && from < to) {
                return Err(Failure(format!("the {name} axis from {from} to {to} must ascend")));
            }
        }
        for (place, row) in self.cells.iter().enumerate() {
            if row.len() != columns {
                let count = row.len();
                return Err(Failure(format!("row {place} has {count} cells, row 0 has {columns}")));
            }
            if let Some(class) = row.iter().find(|&&class| class >= self.classes.len()) {
                let count = self.classes.len();
                return Err(Failure(format!(
                    "row {place} has class {class}, but there are {count} classes, counted from 0"
                )));
            }
        }
        Ok(())
    }
}

/// A map with places for everything, px.
struct MapLayout<'a> {
    map: &'a Map,
    legend: Legend,
}

impl MapLayout<'_> {
    fn frame(&self) -> Frame<'_> {
        let top = TITLE + self.legend.height + 8.0;
        Frame {
            left: LEFT,
            top,
            bottom: top + HEIGHT,
            x: self.map.x,
            y: self.map.y,
            y_label: &self.map.y_label,
            x_label: Some(&self.map.x_label),
            grid: false,
            y_axis: true,
            logarithmic: false,
        }
    }
}

impl Drawing for MapLayout<'_> {
    fn title(&self) -> &str {
        &self.map.title
    }

    fn description(&self) -> String {
        let Map { x_label, y_label, cells, classes, .. } = self.map;
        let all: usize = cells.iter().map(Vec::len).sum();
        let parts = classes.iter().enumerate().map(|(place, class)| {
            let count = cells.iter().flatten().filter(|&&cell| cell == place).count();
            format!("“{}” in {count} of {all} cells", class.name)
        });
        let parts: Vec<String> = parts.collect();
        format!("A map over “{x_label}” (across) and “{y_label}” (up): {}.", parts.join(", "))
    }

    fn height(&self) -> f64 {
        (self.frame().bottom + X_AXIS + 8.0).ceil()
    }

    fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        canvas.text(&self.map.title, [LEFT, 0.5 * TITLE], LARGE, Align::Left)?;
        self.legend.paint(canvas, TITLE)?;
        let frame = self.frame();
        let cells = &self.map.cells;
        for (row, classes) in cells.iter().enumerate() {
            let edge = |place: usize| part(place, cells.len(), frame.bottom, frame.top);
            // A little under the next row, so that no light line shines through between them.
            let (down, up) = (edge(row), (edge(row + 1) - 0.5).max(frame.top));
            let mut start = 0;
            for run in classes.chunk_by(|a, b| a == b) {
                // For the same reason up to the end of the row; the next run covers it.
                let left = part(start, classes.len(), LEFT, super::axes::RIGHT);
                let corners = [left, up, super::axes::RIGHT, down];
                let colours = self.map.classes[run[0]].colours();
                canvas.striped(corners, &colours, frame.top, STRIPE)?;
                start += run.len();
            }
        }
        frame.paint(canvas)
    }
}

/// The edge before a cell. The frame goes through the middles of the first and the last.
#[allow(clippy::cast_precision_loss)]
fn part(place: usize, count: usize, from: f64, to: f64) -> f64 {
    let part = match count {
        1 => place as f64,
        _ => ((place as f64 - 0.5) / (count - 1) as f64).clamp(0.0, 1.0),
    };
    from + part * (to - from)
}
