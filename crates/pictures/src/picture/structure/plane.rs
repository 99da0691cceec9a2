//! Points and segments of the plane, and what room is left between them.

use crate::picture::canvas::Point;

pub(super) fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

pub(super) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn scaled(a: Point, factor: f64) -> Point {
    [a[0] * factor, a[1] * factor]
}

/// The point at a distance from another along a way.
pub(super) fn along(from: Point, way: Point, distance: f64) -> Point {
    add(from, scaled(way, distance))
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Not `hypot`, whose last bits are the system's own.
pub(super) fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn unit(a: Point) -> Point {
    scaled(a, 1.0 / length(a))
}

/// (cos, sin) of an angle, rad.
pub(super) fn way(angle: f64) -> Point {
    [libm::cos(angle), libm::sin(angle)]
}

/// A quarter of a turn on, from the first axis to the second.
pub(super) fn across(a: Point) -> Point {
    [-a[1], a[0]]
}

/// A way turned from the first axis to the second by an angle, rad.
pub(super) fn turned(a: Point, angle: f64) -> Point {
    let [cos, sin] = way(angle);
    add(scaled(a, cos), scaled(across(a), sin))
}

/// The segment through a point along a way, as far to both sides.
pub(super) fn centred(middle: Point, way: Point, half: f64) -> [Point; 2] {
    [along(middle, way, -half), along(middle, way, half)]
}

/// Distance from a point to the nearest point of a segment.
fn distance(point: Point, [from, to]: [Point; 2]) -> f64 {
    let whole = sub(to, from);
    let square = dot(whole, whole);
    let part = if square > 0.0 { dot(sub(point, from), whole) / square } else { 0.0 };
    length(sub(point, along(from, whole, part.clamp(0.0, 1.0))))
}

/// Distance between the nearest points of two segments.
pub(super) fn apart(a: [Point; 2], b: [Point; 2]) -> f64 {
    let side = |[from, to]: [Point; 2], point| dot(across(sub(to, from)), sub(point, from));
    if side(a, b[0]) * side(a, b[1]) < 0.0 && side(b, a[0]) * side(b, a[1]) < 0.0 {
        return 0.0;
    }
    let ends = [distance(a[0], b), distance(a[1], b), distance(b[0], a), distance(b[1], a)];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

/// Extent of points along x and y, each with the extent of its ink: least and most.
pub(super) fn reach(points: impl Iterator<Item = (Point, Point)>) -> [[f64; 2]; 2] {
    let nothing = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    points.fold(nothing, |reach, (point, half)| {
        [0, 1].map(|axis| {
            let [from, to] = reach[axis];
            [from.min(point[axis] - half[axis]), to.max(point[axis] + half[axis])]
        })
    })
}

/// Lines that stand already, each with how far it reaches to its sides.
#[derive(Clone, Default)]
pub(super) struct OccupiedLines(Vec<([Point; 2], f64)>);

impl OccupiedLines {
    pub(super) fn take(&mut self, line: [Point; 2], reach: f64) {
        self.0.push((line, reach));
    }

    /// `true` if a line keeps farther than the gap off all lines in the room.
    pub(super) fn has(&self, line: [Point; 2], gap: f64) -> bool {
        // The last lines are the likeliest to be met.
        self.0.iter().rev().all(|&(other, reach)| {
            // Most are far off, as one look at each axis tells.
            let ends = |axis: usize| {
                [line, other].map(|[a, b]| [a[axis].min(b[axis]), a[axis].max(b[axis])])
            };
            let off = |[[a, b], [c, d]]: [[f64; 2]; 2]| (c - b).max(a - d) > reach + gap;
            off(ends(0)) || off(ends(1)) || apart(line, other) > reach + gap
        })
    }
}
