//! Bands: shaded ranges of x.

use super::Chart;
use crate::picture::axes::{Frame, RIGHT};
use crate::picture::canvas::{Canvas, Failure};
use crate::picture::legend::{Entry, Sample};
use crate::picture::palette::{colour, tint};
use plotters::backend::DrawingBackend;
use plotters::style::WHITE;
use serde::Serialize;

/// A range of the x axis worth a shade.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Band {
    /// Beginning of the band, in the unit of the x axis; −∞ is the left end of the axis.
    pub from: f64,
    /// End of the band, in the unit of the x axis; ∞ is the right end of the axis.
    pub to: f64,
    /// Label in the legend, which equal labels in the same colour share.
    pub label: Option<String>,
    /// Place in the [palette](crate::picture::PALETTE), of which a pale tint is shown, or over a raster two
    /// lines at the ends.
    pub colour: usize,
}

impl Band {
    pub(super) fn entry(&self) -> Option<Entry> {
        let sample = Sample::Patch(vec![tint(self.colour)]);
        self.label.clone().map(|label| Entry { label, sample })
    }

    /// Description of the band in words, for readers who cannot see it.
    pub(super) fn words(&self) -> String {
        let label = self.label.as_deref().map(|label| format!("“{label}” "));
        format!("{}from {} to {}", label.unwrap_or_default(), self.from, self.to)
    }

    /// Left and right in a frame, px.
    fn sides(&self, chart: &Chart, frame: &Frame<'_>) -> [f64; 2] {
        let end = |value: f64| {
            let value =
                if chart.logarithmic { value.clamp(0.0, f64::INFINITY).log10() } else { value };
            frame.at_x(value).clamp(frame.left, RIGHT)
        };
        [end(self.from), end(self.to)]
    }

    /// Fills the frame's part, below all else.
    pub(super) fn paint<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        chart: &Chart,
        frame: &Frame<'_>,
    ) -> Result<(), Failure> {
        let [left, right] = self.sides(chart, frame);
        // Not a number on either side is no range.
        if left < right {
            canvas.rectangle([left, frame.top, right, frame.bottom], tint(self.colour))?;
        }
        Ok(())
    }

    /// Paints the ends of the band as lines, where a raster would cover it.
    pub(super) fn paint_ends<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        chart: &Chart,
        frame: &Frame<'_>,
    ) -> Result<(), Failure> {
        let ends = [self.from, self.to].into_iter().zip(self.sides(chart, frame));
        for (_, x) in ends.filter(|(end, _)| end.is_finite()) {
            let line = [[x, frame.top], [x, frame.bottom]];
            canvas.line(&line, WHITE, 4.0, &[])?;
            canvas.line(&line, colour(self.colour), 2.0, &[])?;
        }
        Ok(())
    }
}
