//! Places for names and values: at what they speak of, over nothing else.

use super::plane::{OccupiedLines, add, along, centred, sub};
use super::symbols::{self, Shape};
use crate::picture::canvas::{Point, WIDTH, text_width};
use crate::picture::palette::GREY;

/// Space between labels, and between labels and the drawing, px.
const GAP: f64 = 2.0;
/// Free space at the left and the right of a picture, px.
pub(super) const EDGE: f64 = 8.0;
/// A row of text, in sizes of its letters.
const ROW: f64 = 1.15;
/// Width that an arrow of direction takes before a text, in sizes of its letters.
const ARROW: f64 = 1.35;

/// Distances between a label and the line that it belongs to, px.
const NEAR: [f64; 2] = [4.0, 10.0];

/// A label that wants a place.
pub(super) struct Request {
    /// Ways to write it, as lines, the best first.
    pub(super) texts: Vec<Vec<String>>,
    /// The line that the label belongs to, and `reach`, its extent to its sides.
    pub(super) line: [Point; 2],
    pub(super) reach: f64,
    /// Directions in which the label may lie from the line, the best first.
    pub(super) outs: Vec<Point>,
    /// The direction in which a link acts, where it is drawn in another.
    pub(super) acts: Option<Point>,
}

/// A label in its place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) lines: Vec<String>,
    pub(super) middle: Point,
    /// Half of the label's width and height.
    pub(super) half: Point,
    pub(super) acts: Option<Point>,
    /// Leader to the line that the label belongs to, where that is not near.
    pub(super) leader: Option<[Point; 2]>,
}

impl Label {
    fn new(lines: Vec<String>, middle: Point, acts: Option<Point>, size: f64) -> Self {
        let half = half_size(&lines, acts.is_some(), size);
        Self { lines, middle, half, acts, leader: None }
    }

    /// The arrow of direction and the line that leads here.
    pub(super) fn shapes(&self, size: f64) -> Vec<Shape> {
        let mut shapes = Vec::new();
        shapes.extend(self.leader.map(|leader| symbols::line(&leader, GREY, 1.0)));
        if let Some(way) = self.acts {
            let left = add(self.middle, [0.45 * ARROW * size - self.half[0], 0.0]);
            symbols::acts(left, way, 0.55 * size, &mut shapes);
        }
        shapes
    }

    /// The middle of each row, px.
    #[allow(clippy::cast_precision_loss)]
    fn rows(&self, size: f64) -> impl Iterator<Item = Point> {
        let first = 0.5 * (self.lines.len() as f64 - 1.0);
        (0..self.lines.len())
            .map(move |row| add(self.middle, [0.0, (row as f64 - first) * ROW * size]))
    }

    /// The lines with their middles, px.
    pub(super) fn texts(&self, size: f64) -> impl Iterator<Item = (&String, Point)> {
        let arrow = if self.acts.is_some() { ARROW * size } else { 0.0 };
        let middles = self.rows(size).map(move |middle| add(middle, [0.5 * arrow, 0.0]));
        self.lines.iter().zip(middles)
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

/// A line through each row of a label, which reaches half of a row to all sides.
fn row_lines(label: &Label, size: f64) -> impl Iterator<Item = [Point; 2]> {
    let half = (label.half[0] - 0.5 * ROW * size).max(0.0);
    label.rows(size).map(move |middle| centred(middle, [1.0, 0.0], half))
}

/// Labels that have found their places, and what they must keep off.
pub(super) struct Labels {
    size: f64,
    room: OccupiedLines,
    pub(super) placed: Vec<Label>,
}

impl Labels {
    pub(super) fn new(size: f64, room: OccupiedLines) -> Self {
        Self { size, room, placed: Vec::new() }
    }

    /// `true` if all labels found a place right at the line that they belong to.
    pub(super) fn all_near(&self) -> bool {
        self.placed.iter().all(|label| label.leader.is_none())
    }

    /// Sets a label where it is wanted, which is where nothing else is.
    pub(super) fn set(&mut self, lines: Vec<String>, middle: Point) {
        self.push(Label::new(lines, middle, None, self.size));
    }

    /// Finds places for all: beside what each speaks of, or else, when all that can have theirs, farther away with a
    /// line that leads there.
    pub(super) fn place(&mut self, requests: &[Request]) {
        let far: Vec<&Request> =
            requests.iter().filter(|request| !self.place_at(request, &NEAR)).collect();
        let gaps = std::iter::successors(Some(20.0), |gap| Some(1.2 * gap)).take(32);
        let gaps: Vec<f64> = gaps.collect();
        for request in far {
            self.place_at(request, &gaps);
        }
    }

    /// Takes the first place that is free: the middle of the line before its ends.
    fn place_at(&mut self, request: &Request, gaps: &[f64]) -> bool {
        let Request { texts, line, reach, outs, acts } = request;
        let whole = sub(line[1], line[0]);
        let labels = texts.iter().map(|lines| Label::new(lines.clone(), line[0], *acts, self.size));
        let mut labels: Vec<Label> = labels.collect();
        for &gap in gaps {
            for label in &mut labels {
                for part in [0.5, 0.62, 0.38, 0.75, 0.25, 0.88, 0.12, 1.0, 0.0] {
                    for out in outs {
                        let foot = along(along(line[0], whole, part), *out, *reach);
                        // With the nearest corner at the gap, or the middle of a side.
                        let corner = out.map(|part| (4.0 * part).clamp(-1.0, 1.0));
                        let by = [corner[0] * label.half[0], corner[1] * label.half[1]];
                        label.middle = add(along(foot, *out, gap), by);
                        let far = gap > NEAR[1];
                        if self.is_free(label, far) {
                            label.leader = far.then_some([foot, along(foot, *out, gap - GAP)]);
                            self.push(label.clone());
                            return true;
                        }
                    }
                }
            }
        }
        false
    }

    fn push(&mut self, label: Label) {
        for row in row_lines(&label, self.size) {
            self.room.take(row, 0.5 * ROW * self.size);
        }
        label.leader.into_iter().for_each(|line| self.room.take(line, 0.5));
        self.placed.push(label);
    }

    /// A picture grows wider for a label that has no room in it.
    fn is_free(&self, label: &Label, far: bool) -> bool {
        let reach = (label.middle[0] - 0.5 * WIDTH).abs() + label.half[0];
        let gap = 0.5 * ROW * self.size + GAP;
        (far || reach < 0.5 * WIDTH - EDGE)
            && row_lines(label, self.size).all(|row| self.room.has(row, gap))
    }
}
