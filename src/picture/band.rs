//! Bands: shaded ranges of x.

use serde::Serialize;

/// A range of the x axis worth a shade.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Band {
    /// Where it begins, in the unit of the x axis; −∞ is the left end of the axis.
    pub from: f64,
    /// Where it ends, in the unit of the x axis; ∞ is the right end of the axis.
    pub to: f64,
    /// For the legend, which equal labels in the same colour share.
    pub label: Option<String>,
    /// Place in the [palette](super::PALETTE), of which a pale tint is shown.
    pub colour: usize,
}
