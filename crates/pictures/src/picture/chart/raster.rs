//! Rasters: colours for values over a plane.

use crate::picture::axes::{Frame, MEDIUM, RIGHT, SMALL, range, ticks};
use crate::picture::canvas::{Align, Canvas, Failure};
use crate::picture::image::Image;
use crate::picture::palette::INK;
use plotters::backend::DrawingBackend;
use serde::Serialize;

/// Height of the scale of colours above its frame, px.
pub(super) const SCALE: f64 = 42.0;
/// The scale's length and thickness, px.
const LENGTH: f64 = 300.0;
const THICKNESS: f64 = 12.0;

/// Values of one quantity over the plane of x and y, in cells of equal size.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Raster {
    /// The outer edges of the first and the last column, in the unit of the x axis.
    pub x: [f64; 2],
    /// The outer edges of the lowest and the highest row, in the unit of the y axis.
    pub y: [f64; 2],
    /// Rows of values, the lowest row first; values that are not numbers stay white.
    pub rows: Vec<Vec<f64>>,
    /// The values of the first and the last colour; values beyond them have these colours, too.
    pub range: [f64; 2],
    /// The quantity, with its unit, for the scale of colours.
    pub label: String,
}

impl Raster {
    /// Refuses what cannot be drawn; `panel` is how errors name its panel.
    pub(super) fn check(&self, panel: &str, logarithmic: bool) -> Result<(), Failure> {
        let wrong =
            |what: String| Err(Failure(format!("the raster of the panel {panel:?} {what}")));
        if logarithmic {
            return wrong("needs linear axes: its cells are of equal size".into());
        }
        for (name, [from, to]) in [("x", self.x), ("y", self.y)] {
            if !(from.is_finite() && to.is_finite() && from < to) {
                return wrong(format!("is from {from} to {to} in {name}, which must ascend"));
            }
        }
        let [from, to] = self.range;
        if !(from.is_finite() && to.is_finite() && from <= to) {
            return wrong(format!("has colours from {from} to {to}, which must ascend"));
        }
        let columns = self.rows.first().map_or(0, Vec::len);
        if columns == 0 {
            return wrong("has no values".into());
        }
        match self.rows.iter().position(|row| row.len() != columns) {
            Some(place) => {
                let count = self.rows[place].len();
                wrong(format!("has {count} values in row {place} and {columns} in row 0"))
            }
            None => Ok(()),
        }
    }

    /// The values of the first and the last colour; not one for both.
    pub(super) fn colours(&self) -> [f64; 2] {
        range(self.range.into_iter()).unwrap_or([0.0, 1.0])
    }

    /// Description of the raster in words, for readers who cannot see it.
    pub(super) fn words(&self) -> String {
        let [from, to] = self.colours();
        format!("colours from dark blue for {from} to yellow for {to} of “{}”", self.label)
    }

    /// Fills its part of the frame, before all else.
    pub(super) fn paint<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        frame: &Frame<'_>,
    ) -> Result<(), Failure> {
        let ([left, bottom], [right, top]) =
            (frame.at([self.x[0], self.y[0]]), frame.at([self.x[1], self.y[1]]));
        let [from, to] = self.colours();
        let part = |value: &f64| ((value - from) / (to - from)).clamp(0.0, 1.0);
        let parts: Vec<Vec<f64>> =
            self.rows.iter().map(|row| row.iter().map(part).collect()).collect();
        // A px shows one value.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let [most_columns, most_rows] = [right - left, bottom - top].map(|px| px as usize);
        let shown = reduced(&parts, most_columns.max(1), most_rows.max(1));
        canvas.image([left, top, right, bottom], &Image::new(&shown))
    }

    /// The scale of colours, with its label before it and its numbers below.
    pub(super) fn paint_scale<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        top: f64,
    ) -> Result<(), Failure> {
        let (left, upper) = (RIGHT - LENGTH, top + 4.0);
        let lower = upper + THICKNESS;
        let parts = (0..=254).map(|place| f64::from(place) / 254.0).collect();
        canvas.image([left, upper, RIGHT, lower], &Image::new(&[parts]))?;
        let middle = 0.5 * (upper + lower);
        canvas.text(&self.label, [left - 10.0, middle], MEDIUM, Align::Right)?;
        let [from, to] = self.colours();
        for (tick, number) in ticks([from, to], 6) {
            let x = left + (tick - from) / (to - from) * LENGTH;
            canvas.line(&[[x, lower], [x, lower + 4.0]], INK, 1.0, &[])?;
            canvas.text(&number, [x, lower + 12.0], SMALL, Align::Centre)?;
        }
        Ok(())
    }
}

/// A raster of at most `most_columns` columns and `most_rows` rows: means over the parts of cells that a new cell
/// covers, omitting those that are not numbers.
fn reduced(rows: &[Vec<f64>], most_columns: usize, most_rows: usize) -> Vec<Vec<f64>> {
    let columns = covered(rows[0].len(), most_columns);
    let mean = |parts: &[(usize, f64)], value: &dyn Fn(usize) -> f64| {
        let known = parts.iter().map(|&(place, part)| (value(place), part));
        let known = known.filter(|(value, _)| !value.is_nan());
        let (sum, all) =
            known.fold((0.0, 0.0), |(sum, all), (value, part)| (sum + part * value, all + part));
        sum / all
    };
    let narrow: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| columns.iter().map(|parts| mean(parts, &|place| row[place])).collect())
        .collect();
    let rows = covered(rows.len(), most_rows);
    rows.iter()
        .map(|parts| {
            (0..columns.len()).map(|column| mean(parts, &|place| narrow[place][column])).collect()
        })
        .collect()
}

/// For each of at most `most` new cells, the cells out of `count` that it covers, and the covered part of each.
#[allow(clippy::cast_precision_loss)]
fn covered(count: usize, most: usize) -> Vec<Vec<(usize, f64)>> {
    let fewer = count.min(most);
    let part = |new: usize| {
        let (from, to) = (new * count, (new + 1) * count);
        let cells = from / fewer..to.div_ceil(fewer);
        // In whole numbers, with a cell as long as there are new ones.
        let common = |cell: usize| to.min((cell + 1) * fewer) - from.max(cell * fewer);
        cells.map(|cell| (cell, common(cell) as f64)).collect()
    };
    (0..fewer).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_cells_are_means_of_what_they_cover() {
        assert_eq!(reduced(&[vec![1.0, 2.0, 3.0]], 9, 9), [[1.0, 2.0, 3.0]]);
        // Three cells in two: the middle one is halved.
        assert_eq!(covered(3, 2), [[(0, 2.0), (1, 1.0)], [(1, 1.0), (2, 2.0)]]);
        let rows = [vec![0.0, 3.0, 6.0], vec![0.0, 9.0, f64::NAN]];
        assert_eq!(reduced(&rows, 2, 9), [[1.0, 5.0], [3.0, 9.0]]);
        assert_eq!(reduced(&rows, 2, 1), [[2.0, 7.0]]);
        assert!(reduced(&[vec![f64::NAN; 2]], 1, 1)[0][0].is_nan());
    }
}
