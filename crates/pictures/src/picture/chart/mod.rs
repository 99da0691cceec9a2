//! Curves, rasters and lanes in panels, one above the other, over one x axis.

mod band;
mod curves;
mod lanes;
mod layout;
mod marker;
mod marks;
mod raster;

pub use band::Band;
pub use lanes::{Lane, LaneInterval};
pub use marker::Marker;
pub use raster::Raster;

use super::canvas;
use super::class::Class;
use amontons::Error;
use layout::Layout;
use serde::Serialize;
use std::path::Path;

/// Panels over one x axis. A label that ends with an SI unit in brackets, as `Time [s]`, has its values in that unit;
/// the picture may show them with a prefix, as ms.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chart {
    /// Title of the picture.
    pub title: String,
    /// The quantity along x, with its unit.
    pub x_label: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// `true` if both axes are logarithmic. Values that are not above zero then break a curve.
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
    /// `true` if y = 0 is shown, with a line.
    pub zero_line: bool,
    /// Shaded ranges of x, behind everything.
    pub bands: Vec<Band>,
    /// Colours for values over the plane of x and y, behind the curves.
    pub raster: Option<Raster>,
    /// Rows from top to bottom that take the place of the y axis: such a panel has neither series nor raster.
    pub lanes: Vec<Lane>,
    /// The classes that the lanes' stretches can have, for the legend.
    pub classes: Vec<Class>,
}

/// A curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Series {
    /// Label in the legend, which equal labels in the same colour, style and marker share.
    pub label: Option<String>,
    /// (x, y); one that is not finite breaks the curve, which leaves a gap. A point between two gaps is a dot.
    pub points: Vec<[f64; 2]>,
    /// Place in the [palette](crate::picture::PALETTE); beyond its end the colours come again, dashed.
    pub colour: usize,
    /// The style in which the curve is drawn.
    pub style: Style,
    /// The form at each point: `None` leaves the points of a line unmarked, and makes those of dots small discs.
    pub marker: Option<Marker>,
    /// One label for each point, which is then a dot where there is no marker; written beside it where there is room.
    /// Or none at all.
    pub labels: Vec<String>,
}

/// Style of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Style {
    /// A full line.
    #[default]
    Line,
    /// A line with short dashes.
    Dashed,
    /// A thin line in a muted colour, for what is to stay behind other curves.
    Muted,
    /// Points that are not joined, each with the series' marker; of those at one place of the picture one is drawn.
    Dots,
}

/// A place on the x axis worth a vertical line.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Mark {
    /// Position on the x axis.
    pub x: f64,
    /// Label written above its panel, where there is room: at most eight labels stand above each other.
    pub label: Option<String>,
}

impl Chart {
    /// `true` if there is nothing to show: no point, mark, band or raster.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x_range().is_err()
    }

    /// Writes the chart as the path's ending asks, `.svg` or `.png`.
    ///
    /// # Errors
    /// Another ending, nothing finite to draw in a panel, a raster or lanes of the wrong shape, or a file that
    /// cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let shown = self.in_prefixed_units();
        let layout = Layout::of(&shown).map_err(|failure| canvas::cannot_draw(path, &failure))?;
        canvas::write(&layout, path)
    }

    /// The text of an SVG, as [`write`](Self::write) writes it.
    ///
    /// # Errors
    /// A panel has nothing finite to draw, or a raster or lanes have the wrong shape.
    pub fn svg(&self) -> Result<String, Error> {
        let shown = self.in_prefixed_units();
        let layout = Layout::of(&shown)
            .map_err(|failure| canvas::cannot_draw_titled(&self.title, &failure))?;
        canvas::svg_text(&layout)
    }
}
