//! Rasters: colours for values over a plane.

use serde::Serialize;

/// Values of one quantity over the plane of x and y, in cells of equal size.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Raster {
    /// The outer edges of the first and the last column, in the unit of the x axis.
    pub x: [f64; 2],
    /// The outer edges of the lowest and the highest row, in the unit of the y axis.
    pub y: [f64; 2],
    /// Rows of values, the lowest row first; what is not finite stays white.
    pub rows: Vec<Vec<f64>>,
    /// The values of the first and the last colour; what is beyond them has these colours, too.
    pub range: [f64; 2],
    /// The quantity, with its unit, for the scale of colours.
    pub label: String,
}
