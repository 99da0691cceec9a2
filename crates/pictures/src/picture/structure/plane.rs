//! Points, segments and boxes of the plane, and what room is left between them.

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

/// From a point to the nearest of a segment.
fn distance(point: Point, [from, to]: [Point; 2]) -> f64 {
    let whole = sub(to, from);
    let square = dot(whole, whole);
    let part = if square > 0.0 { dot(sub(point, from), whole) / square } else { 0.0 };
    length(sub(point, along(from, whole, part.clamp(0.0, 1.0))))
}

/// Between the nearest points of two segments.
pub(super) fn apart(a: [Point; 2], b: [Point; 2]) -> f64 {
    let side = |[from, to]: [Point; 2], point| dot(across(sub(to, from)), sub(point, from));
    if side(a, b[0]) * side(a, b[1]) < 0.0 && side(b, a[0]) * side(b, a[1]) < 0.0 {
        return 0.0;
    }
    let ends = [distance(a[0], b), distance(a[1], b), distance(b[0], a), distance(b[1], a)];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

/// How far points reach along x and y, each with how far its ink reaches: least and most.
pub(super) fn reach(points: impl Iterator<Item = (Point, Point)>) -> [[f64; 2]; 2] {
    let nothing = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    points.fold(nothing, |reach, (point, half)| {
        [0, 1].map(|axis| {
            let [from, to] = reach[axis];
            [from.min(point[axis] - half[axis]), to.max(point[axis] + half[axis])]
        })
    })
}

/// A box with sides along the axes: its middle and half of its width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box {
    pub(super) middle: Point,
    pub(super) half: Point,
}

impl Box {
    pub(super) fn meets(&self, other: &Self, gap: f64) -> bool {
        [0, 1].iter().all(|&axis| {
            let between = (self.middle[axis] - other.middle[axis]).abs();
            between < self.half[axis] + other.half[axis] + gap
        })
    }

    /// Does a segment come closer than the gap?
    pub(super) fn met_by(&self, [from, to]: [Point; 2], gap: f64) -> bool {
        // The part of the segment that is within both strips, if any.
        let (mut start, mut end) = (0.0_f64, 1.0_f64);
        for axis in [0, 1] {
            let (at, step) = (from[axis] - self.middle[axis], to[axis] - from[axis]);
            let reach = self.half[axis] + gap;
            if step.abs() < 1e-9 {
                if at.abs() >= reach {
                    return false;
                }
                continue;
            }
            let [a, b] = [(-reach - at) / step, (reach - at) / step];
            start = start.max(a.min(b));
            end = end.min(a.max(b));
        }
        start < end
    }
}

/// Lines that stand already, each with how far it reaches to its sides.
#[derive(Clone, Default)]
pub(super) struct Room(Vec<([Point; 2], f64)>);

impl Room {
    pub(super) fn take(&mut self, line: [Point; 2], reach: f64) {
        self.0.push((line, reach));
    }

    /// Does a line keep farther than the gap off all that stands?
    pub(super) fn has(&self, line: [Point; 2], gap: f64) -> bool {
        self.0.iter().all(|&(other, reach)| apart(line, other) > reach + gap)
    }

    /// Does a box keep farther than the gap off all that stands?
    pub(super) fn has_box(&self, area: &Box, gap: f64) -> bool {
        !self.0.iter().any(|&(line, reach)| area.met_by(line, reach + gap))
    }
}
