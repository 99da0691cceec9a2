//! Where the arrows of forces stand, px: at their mass, along their way, over nothing else if there is room.

use super::ForceMark;
use super::labels::Request;
use super::plane::{Box, across, along, length, scaled, sub, unit, way};
use super::plot::Plot;
use super::symbols::{self, Shape, force_colour};
use super::text::written;
use crate::picture::canvas::{Point, WIDTH};

/// Length of an arrow, px.
const LENGTH: f64 = 40.0;
/// Between an arrow and its mass, px.
const GAP: f64 = 3.0;
/// Free around an arrow, px.
const AROUND: f64 = 6.0;
/// Free at the left and the right of a picture, px.
const EDGE: f64 = 10.0;

impl Plot<'_> {
    pub(super) fn force(&mut self, force: &ForceMark) {
        let push = way(-force.angle);
        let [from, to] = self.room(force.mass, push);
        symbols::arrow(from, to, force_colour(), &mut self.shapes);
        let side = across(push);
        let texts = written(&force.name, &force.label, self.style.values);
        if texts.is_empty() {
            return;
        }
        let back = scaled(push, -1.0);
        let mut spots = vec![[along(from, back, GAP), back], [along(to, push, GAP), push]];
        for part in [0.5, 0.25, 0.75, 0.0, 1.0] {
            let foot = along(from, push, part * LENGTH);
            spots.extend([side, scaled(side, -1.0)].map(|out| [along(foot, out, 7.0), out]));
        }
        let of = (along(from, push, 0.5 * LENGTH), 5.0);
        self.requests.push(Request { texts, spots, acts: None, of });
    }

    /// From and to of an arrow: before the mass or behind it, at its middle or beside that.
    fn room(&self, mass: usize, push: Point) -> [Point; 2] {
        let (middle, side) = (self.middles[mass], across(push));
        let reach = self.support(mass, push) + GAP;
        let mut found = Vec::new();
        for sideways in [0.0, 0.5, -0.5, 0.8, -0.8, 1.3, -1.3] {
            let foot = along(middle, side, sideways * self.half);
            found.push([along(foot, push, -reach - LENGTH), along(foot, push, -reach)]);
            found.push([along(foot, push, reach), along(foot, push, reach + LENGTH)]);
        }
        let free = found.iter().find(|arrow| {
            let inside = arrow.iter().all(|[x, _]| (EDGE..WIDTH - EDGE).contains(x));
            inside && !self.shapes.iter().any(|shape| meets(shape, &shortened(**arrow, middle)))
        });
        *free.unwrap_or(&found[0])
    }
}

/// An arrow without what is near its own mass.
fn shortened([from, to]: [Point; 2], mass: Point) -> [Point; 2] {
    let forth = unit(sub(to, from));
    if length(sub(from, mass)) > length(sub(to, mass)) {
        [from, along(to, forth, -2.0 * AROUND)]
    } else {
        [along(from, forth, 2.0 * AROUND), to]
    }
}

/// Is ink of the shape within the gap around an arrow?
fn meets(shape: &Shape, [from, to]: &[Point; 2]) -> bool {
    let (points, ink) = shape.extent();
    let around = AROUND + ink;
    let middle = [0, 1].map(|axis| 0.5 * (from[axis] + to[axis]));
    let half = [0, 1].map(|axis| 0.5 * (from[axis] - to[axis]).abs());
    let area = Box { middle, half };
    // An oblique arrow's box is larger than it has to be.
    match &points[..] {
        [point] => area.met_by([*point, along(*point, [1.0, 0.0], 1e-6)], around),
        _ => points.windows(2).any(|pair| area.met_by([pair[0], pair[1]], around)),
    }
}
