//! Places for names and values: at what they speak of, over nothing else.

use super::plane::{Box, Room, add, along, sub};
use super::symbols::{self, Shape};
use crate::picture::canvas::{Point, WIDTH, text_width};
use crate::picture::palette::GREY;

/// Between labels, and between labels and what is drawn, px.
const GAP: f64 = 2.0;
/// Free at the left and the right of a picture, px.
pub(super) const EDGE: f64 = 8.0;
/// A row of text, in sizes of its letters.
const ROW: f64 = 1.15;
/// Width that an arrow of direction takes before a text, in sizes of its letters.
const ARROW: f64 = 1.35;

/// A label that wants a place.
pub(super) struct Request {
    /// Ways to write it, as lines, the best first.
    pub(super) texts: Vec<Vec<String>>,
    /// What it speaks of: a line, and how far that reaches to its sides.
    pub(super) line: [Point; 2],
    pub(super) reach: f64,
    /// Where it may lie from there, the best first.
    pub(super) outs: Vec<Point>,
    /// The direction in which a link acts, where it is drawn in another.
    pub(super) acts: Option<Point>,
}

/// A label in its place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) area: Box,
    pub(super) lines: Vec<String>,
    pub(super) acts: Option<Point>,
    /// To what it speaks of, where that is not near.
    pub(super) leader: Option<[Point; 2]>,
}

impl Label {
    /// The arrow of direction and the line that leads here.
    pub(super) fn shapes(&self, size: f64) -> Vec<Shape> {
        let mut shapes = Vec::new();
        shapes.extend(self.leader.map(|leader| symbols::line(&leader, GREY, 1.0)));
        if let Some(way) = self.acts {
            let left = self.area.middle[0] - self.area.half[0];
            let middle = [left + 0.45 * ARROW * size, self.area.middle[1]];
            symbols::acts(middle, way, 0.55 * size, &mut shapes);
        }
        shapes
    }

    /// The lines with their middles, px.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn texts(&self, size: f64) -> impl Iterator<Item = (&String, Point)> {
        let arrow = if self.acts.is_some() { ARROW * size } else { 0.0 };
        let first = 0.5 * (self.lines.len() as f64 - 1.0);
        self.lines.iter().enumerate().map(move |(row, line)| {
            (line, add(self.area.middle, [0.5 * arrow, (row as f64 - first) * ROW * size]))
        })
    }
}

/// Half of the width and height of lines of text, px.
#[allow(clippy::cast_precision_loss)]
pub(super) fn half_size(lines: &[String], acts: bool, size: f64) -> Point {
    // The reader's own font may be a little wider.
    let width = lines.iter().map(|text| 1.05 * text_width(text, size)).fold(0.0, f64::max);
    let arrow = if acts { ARROW * size } else { 0.0 };
    [0.5 * (width + arrow), 0.5 * ROW * size * lines.len() as f64]
}

/// Labels that have found their places, and what they must keep off.
pub(super) struct Labels {
    size: f64,
    room: Room,
    pub(super) placed: Vec<Label>,
}

impl Labels {
    pub(super) fn new(size: f64, room: Room) -> Self {
        Self { size, room, placed: Vec::new() }
    }

    /// Did all find a place right at what they speak of?
    pub(super) fn all_near(&self) -> bool {
        self.placed.iter().all(|label| label.leader.is_none())
    }

    /// Sets a label where it is wanted, which is where nothing else is.
    pub(super) fn set(&mut self, lines: Vec<String>, middle: Point) {
        let area = Box { middle, half: half_size(&lines, false, self.size) };
        self.placed.push(Label { area, lines, acts: None, leader: None });
    }

    /// Finds places for all: beside what each speaks of, or else, when all that can have theirs, farther away with a
    /// line that leads there.
    pub(super) fn place(&mut self, requests: &[Request]) {
        let near = [4.0, 10.0];
        let far: Vec<&Request> =
            requests.iter().filter(|request| !self.place_at(request, &near)).collect();
        let gaps: Vec<f64> = (2..200).map(|step| 10.0 * f64::from(step)).collect();
        for request in far {
            self.place_at(request, &gaps);
        }
    }

    /// Takes the first place that is free: the middle of the line before its ends.
    fn place_at(&mut self, request: &Request, gaps: &[f64]) -> bool {
        let Request { texts, line, reach, outs, acts } = request;
        let whole = sub(line[1], line[0]);
        for &gap in gaps {
            for lines in texts {
                let half = half_size(lines, acts.is_some(), self.size);
                for part in [0.5, 0.62, 0.38, 0.75, 0.25, 0.88, 0.12, 1.0, 0.0] {
                    for out in outs {
                        let foot = along(along(line[0], whole, part), *out, *reach);
                        let at = along(foot, *out, gap);
                        // With the nearest corner there, or the middle of a side.
                        let parts = out.map(|part| (4.0 * part).clamp(-1.0, 1.0));
                        let middle = add(at, [parts[0] * half[0], parts[1] * half[1]]);
                        let area = Box { middle, half };
                        let far = gap > 10.0;
                        if self.is_free(&area, far) {
                            let leader = far.then_some([foot, along(at, *out, -GAP)]);
                            leader.into_iter().for_each(|line| self.room.take(line, 0.5));
                            let (lines, acts) = (lines.clone(), *acts);
                            self.placed.push(Label { area, lines, acts, leader });
                            return true;
                        }
                    }
                }
            }
        }
        false
    }

    /// A picture grows wider for a label that has no room in it.
    fn is_free(&self, area: &Box, far: bool) -> bool {
        let inside = (area.middle[0] - 0.5 * WIDTH).abs() + area.half[0] < 0.5 * WIDTH - EDGE;
        (inside || far)
            && self.placed.iter().all(|label| !label.area.meets(area, 2.0 * GAP))
            && self.room.has_box(area, GAP)
    }
}
