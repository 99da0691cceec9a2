//! Legends: rows below the title, where no data are.

use super::axes::{LEFT, MEDIUM, RIGHT};
use super::canvas::{Align, Canvas, Failure, text_width};
use super::chart::Marker;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;

const ROW: f64 = 22.0;
/// Length of a sample, px.
const SAMPLE: f64 = 32.0;

/// Half of the height of a sample of an area, px.
const PATCH: f64 = 7.0;
/// Radius of points that are not joined, px.
pub(super) const DOT: f64 = 2.5;

/// The sample of an entry.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Sample {
    /// A stroke, unless the points are not joined, with the marker of its points.
    Curve { colour: RGBColor, dashes: Option<Vec<f64>>, marker: Option<Marker> },
    /// Stripes, one below the other.
    Patch(Vec<RGBColor>),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) label: String,
    pub(super) sample: Sample,
}

/// Entries and where they stand, px from the legend's own corner.
#[derive(Clone, Debug)]
pub(super) struct Legend {
    entries: Vec<(Entry, f64, f64)>,
    pub(super) height: f64,
}

impl Legend {
    /// Sets entries in rows; equal ones are one.
    pub(super) fn new(all: impl Iterator<Item = Entry>) -> Self {
        let mut legend = Self { entries: Vec::new(), height: 0.0 };
        let (mut x, mut y) = (LEFT, 0.0);
        for entry in all {
            if legend.entries.iter().any(|(known, ..)| *known == entry) {
                continue;
            }
            // The reader's own font may be a little wider.
            let width = SAMPLE + 30.0 + 1.1 * text_width(&entry.label, MEDIUM);
            if x > LEFT && x + width > RIGHT {
                (x, y) = (LEFT, y + ROW);
            }
            legend.height = y + ROW;
            legend.entries.push((entry, x, y));
            x += width;
        }
        legend
    }

    pub(super) fn paint<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        top: f64,
    ) -> Result<(), Failure> {
        for (Entry { label, sample }, x, y) in &self.entries {
            let (from, to, middle) = (*x, x + SAMPLE, top + y + 0.5 * ROW);
            match sample {
                Sample::Curve { colour, dashes, marker } => {
                    if let Some(dashes) = dashes {
                        canvas.line(&[[from, middle], [to, middle]], *colour, 2.0, dashes)?;
                    }
                    let at = [0.5 * (from + to), middle];
                    match marker {
                        Some(marker) => marker.paint(canvas, at, *colour)?,
                        None if dashes.is_none() => canvas.dot(at, DOT, *colour)?,
                        None => {}
                    }
                }
                Sample::Patch(colours) => {
                    let corners = [from, middle - PATCH, to, middle + PATCH];
                    #[allow(clippy::cast_precision_loss)]
                    let stripe = 2.0 * PATCH / colours.len() as f64;
                    canvas.striped(corners, colours, corners[1], stripe)?;
                }
            }
            canvas.text(label, [to + 8.0, middle], MEDIUM, Align::Left)?;
        }
        Ok(())
    }
}
