//! Lanes: rows of coloured stretches over x, such as the states of contacts over time.

use serde::Serialize;

/// A row of stretches.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Lane {
    /// Written at its left.
    pub name: String,
    /// What is between them, or where they are not finite, stays empty.
    pub stretches: Vec<Stretch>,
}

/// A range of x in which a lane is of one class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Stretch {
    /// Where it begins, in the unit of the x axis.
    pub from: f64,
    /// Where it ends, in the unit of the x axis.
    pub to: f64,
    /// Its place in the panel's `classes`.
    pub class: usize,
}
