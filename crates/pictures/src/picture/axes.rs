//! Axes: ranges, ticks and the frame that charts and maps have in common.

use super::canvas::{Canvas, Failure, Point};
use super::number::typeset;
use super::palette::{GRID, INK};
use amontons::decimal::to_significant;
use amontons::numerics;
use plotters::backend::DrawingBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::ranged1d::{BoldPoints, DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// Left and right end of frames, px.
pub(super) const LEFT: f64 = 84.0;
pub(super) const RIGHT: f64 = 876.0;
/// Free space at the left of the y label, px.
const EDGE: f64 = 8.0;
/// Height of the ticks and the label of the x axis below a frame, px.
pub(super) const X_AXIS: f64 = 52.0;
/// Size of ticks and marks, px.
pub(super) const SMALL: f64 = 15.0;
/// Size of axis labels and legends, px.
pub(super) const MEDIUM: f64 = 16.0;
/// Size of titles, px.
pub(super) const LARGE: f64 = 20.0;

/// A frame of a picture and the values that it shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<'a> {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    pub(super) y_label: &'a str,
    /// Label of the x axis; `None` leaves the ticks of the x axis without numbers.
    pub(super) x_label: Option<&'a str>,
    /// `true` if lines are drawn from the ticks across the frame.
    pub(super) grid: bool,
    /// `true` if y has a label, ticks and numbers.
    pub(super) y_axis: bool,
    /// `true` if the values are decimal logarithms of the numbers on the axes.
    pub(super) logarithmic: bool,
}

/// An axis with its ticks: round numbers, or of logarithms whole powers of ten.
struct Axis {
    linear: RangedCoordf64,
    logarithmic: bool,
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.linear.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if !self.logarithmic {
            return self.linear.key_points(hint);
        }
        powers(self.range(), hint.max_num_points())
    }

    fn range(&self) -> Range<f64> {
        self.linear.range()
    }
}

/// Ticks of an axis of logarithms: whole ones, as many apart as needed for `most` of them; within less than
/// two powers of ten those of 1, 2 and 5.
#[allow(clippy::cast_precision_loss)]
fn powers(range: Range<f64>, most: usize) -> Vec<f64> {
    let whole = |apart: f64| {
        let first = (range.start / apart).ceil() * apart;
        let ticks = (0..).map(move |i: u32| first + f64::from(i) * apart);
        ticks.take_while(|tick| *tick <= range.end).collect::<Vec<f64>>()
    };
    if range.end - range.start < 2.0 {
        let first = range.start.floor();
        let digits = [0.0, 2_f64.log10(), 5_f64.log10()];
        let ticks = (0..3).flat_map(|power| digits.map(|digit| first + f64::from(power) + digit));
        return ticks.filter(|tick| range.contains(tick)).collect();
    }
    let apart = [1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0];
    apart.into_iter().map(whole).find(|ticks| ticks.len() <= most.max(2)).unwrap_or_default()
}

impl Frame<'_> {
    pub(super) fn at_x(&self, value: f64) -> f64 {
        self.left + (value - self.x[0]) / (self.x[1] - self.x[0]) * (RIGHT - self.left)
    }

    pub(super) fn at_y(&self, value: f64) -> f64 {
        self.bottom + (value - self.y[0]) / (self.y[1] - self.y[0]) * (self.top - self.bottom)
    }

    pub(super) fn at(&self, [x, y]: Point) -> Point {
        [self.at_x(x), self.at_y(y)]
    }

    fn axis(&self, [from, to]: [f64; 2]) -> Axis {
        Axis { linear: (from..to).into(), logarithmic: self.logarithmic }
    }

    /// Axes, ticks, numbers and labels.
    pub(super) fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        let below = if self.x_label.is_some() { X_AXIS } else { 0.0 };
        let pixels = |length: f64| canvas.pixels(length);
        let corner = (pixels(self.left - LEFT + EDGE), pixels(self.top));
        let size = (pixels(RIGHT) - corner.0, pixels(self.bottom + below - self.top));
        let part = canvas.area.clone().shrink(corner, size);
        let mut chart = ChartBuilder::on(&part)
            .x_label_area_size(pixels(below))
            .y_label_area_size(pixels(LEFT - EDGE))
            .build_cartesian_2d(self.axis(self.x), self.axis(self.y))?;
        let text = |value: f64, range| match self.logarithmic {
            true => power_of_ten(value),
            false => number(value, range),
        };
        let number_x = |value: &f64| text(*value, self.x);
        let number_y = |value: &f64| text(*value, self.y);
        let rows = if self.bottom - self.top > 200.0 { 7 } else { 5 };
        let mut mesh = chart.configure_mesh();
        mesh.axis_style(canvas.pen(INK, 1.0))
            .bold_line_style(canvas.pen(GRID, 1.0))
            .max_light_lines(0)
            .label_style(canvas.font(SMALL))
            .axis_desc_style(canvas.font(MEDIUM))
            .set_all_tick_mark_size(pixels(5.0))
            .x_labels(10)
            .y_labels(rows)
            .x_label_formatter(&number_x)
            .y_label_formatter(&number_y);
        if self.y_axis {
            mesh.y_desc(self.y_label);
        } else {
            mesh.disable_y_axis().disable_y_mesh();
        }
        if let Some(label) = self.x_label {
            mesh.x_desc(label);
        }
        if !self.grid {
            mesh.disable_mesh();
        }
        Ok(mesh.draw()?)
    }
}

/// At most `most` round values of a range, with their numbers.
pub(super) fn ticks(range: [f64; 2], most: usize) -> Vec<(f64, String)> {
    let axis: RangedCoordf64 = (range[0]..range[1]).into();
    let found = axis.key_points(BoldPoints(most)).into_iter();
    found.map(|tick| (tick, number(tick, range))).collect()
}

/// Range from the smallest to the largest finite value, widened to a visible range where they are equal; `None`
/// without a finite value.
pub(super) fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let [from, to] = numerics::range(values.filter(|value| value.is_finite()));
    (from <= to).then(|| {
        // Closer values than these are one for the ticks, too.
        if to - from > 1e-9 * from.abs().max(to.abs()) {
            return [from, to];
        }
        let around = if from == 0.0 { 1.0 } else { 0.1 * from.abs() };
        [from - around, to + around]
    })
}

/// A range with room at both ends.
pub(super) fn roomy([from, to]: [f64; 2]) -> [f64; 2] {
    let room = 0.05 * (to - from);
    [from - room, to + room]
}

/// A tick's number: without the digits that rounding left, with a minus sign that is one.
fn number(value: f64, [from, to]: [f64; 2]) -> String {
    let largest = from.abs().max(to.abs());
    // Ticks are further apart than this; in digits, because a power of ten may not be exact.
    let finest = 1e-4 * (to - from);
    let digits = largest.log10().floor() - finest.log10().floor();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let digits = digits.clamp(0.0, 15.0) as usize;
    let short = if value.abs() < finest { 0.0 } else { to_significant(value, digits + 1) };
    typeset(short, short == 0.0 || (1e-3..1e6).contains(&largest))
}

/// The number of which a tick is the decimal logarithm.
fn power_of_ten(tick: f64) -> String {
    let value = to_significant(10_f64.powf(tick), 1);
    typeset(value, (1e-3..1e5).contains(&value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(0.1 + 0.2, [0.0, 1.0]), "0.3");
        assert_eq!(number(-0.0, [-1.0, 1.0]), "0");
        assert_eq!(number(-20.0, [-20.0, 40.0]), "−20");
        assert_eq!(number(-2.5e-7, [-1e-6, 1e-6]), "−2.5e−7");
        assert_eq!(number(163.905, [163.9, 163.91]), "163.905");
    }

    #[test]
    fn ticks_of_logarithms_are_powers_of_ten() {
        assert_eq!(powers(-3.2..1.4, 7), [-3.0, -2.0, -1.0, 0.0, 1.0]);
        assert_eq!(powers(-19.5..0.5, 7), [-18.0, -15.0, -12.0, -9.0, -6.0, -3.0, 0.0]);
        assert_eq!(powers(-0.1..1.0, 7).len(), 3);
        assert_eq!(power_of_ten(-12.0), "1e−12");
        assert_eq!(power_of_ten(2_f64.log10() + 1.0), "20");
    }

    #[test]
    fn ranges_leave_out_what_is_not_finite_and_are_never_empty() {
        let values = [f64::NAN, 2.0, f64::INFINITY, -1.0];
        assert_eq!(range(values.into_iter()), Some([-1.0, 2.0]));
        assert_eq!(range([f64::NAN].into_iter()), None);
        assert_eq!(range([0.0].into_iter()), Some([-1.0, 1.0]));
        assert_eq!(range([10.0, 10.0].into_iter()), Some([9.0, 11.0]));
    }
}
