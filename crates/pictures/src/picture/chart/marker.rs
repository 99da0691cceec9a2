//! Markers: forms at the points of a curve.

use crate::picture::canvas::{Canvas, Failure, Point};
use plotters::backend::DrawingBackend;
use plotters::style::{RGBColor, WHITE};
use serde::Serialize;

/// Half of a marker's size, px.
const HALF: f64 = 4.2;

/// The form at each point of a series, such as one for each kind of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Marker {
    /// A filled circle.
    Disc,
    /// A circle with a white inside.
    Ring,
    /// A filled square.
    Square,
    /// A filled triangle, its tip up.
    Triangle,
    /// A filled square on its tip.
    Diamond,
    /// Two oblique strokes.
    Cross,
    /// The head of an arrow to the right.
    Right,
    /// The head of an arrow to the left.
    Left,
    /// The head of an arrow upwards.
    Up,
    /// The head of an arrow downwards.
    Down,
}

impl Marker {
    /// All markers but heads of arrows, those that are told apart best first.
    pub const ALL: [Self; 6] =
        [Self::Disc, Self::Ring, Self::Triangle, Self::Square, Self::Cross, Self::Diamond];

    /// Corners of the ones with straight sides, as parts of half of the size; y is downwards.
    fn corners(self) -> &'static [Point] {
        match self {
            Self::Square => &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
            Self::Triangle => &[[0.0, -1.2], [1.15, 0.85], [-1.15, 0.85]],
            Self::Diamond => &[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]],
            Self::Right => &[[1.7, 0.0], [-1.4, 1.2], [-0.7, 0.0], [-1.4, -1.2]],
            Self::Left => &[[-1.7, 0.0], [1.4, -1.2], [0.7, 0.0], [1.4, 1.2]],
            Self::Up => &[[0.0, -1.7], [1.2, 1.4], [0.0, 0.7], [-1.2, 1.4]],
            Self::Down => &[[0.0, 1.7], [-1.2, -1.4], [0.0, -0.7], [1.2, -1.4]],
            Self::Disc | Self::Ring | Self::Cross => &[],
        }
    }

    pub(in crate::picture) fn paint<B: DrawingBackend>(
        self,
        canvas: &Canvas<B>,
        at: Point,
        colour: RGBColor,
    ) -> Result<(), Failure> {
        let place = |[x, y]: Point| [at[0] + HALF * x, at[1] + HALF * y];
        match self {
            Self::Disc => canvas.dot(at, HALF, colour),
            Self::Ring => {
                canvas.dot(at, HALF + 0.3, colour)?;
                canvas.dot(at, HALF - 1.5, WHITE)
            }
            Self::Cross => [[-1.0, 1.0], [1.0, -1.0]].into_iter().try_for_each(|[from, to]| {
                canvas.line(&[place([-1.0, from]), place([1.0, to])], colour, 1.8, &[])
            }),
            _ => {
                let corners: Vec<Point> =
                    self.corners().iter().map(|&corner| place(corner)).collect();
                canvas.fill(&corners, colour)
            }
        }
    }
}
