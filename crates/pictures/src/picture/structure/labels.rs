//! Places for names and values: near what they speak of, over nothing else.

use super::plane::{Box, along, length, sub, unit, way};
use super::symbols::Shape;
use crate::picture::canvas::{Point, WIDTH, text_width};
use std::f64::consts::PI;

/// Between labels, and between labels and what is drawn, px.
const GAP: f64 = 2.0;
/// Free at the left and the right of a picture, px.
const EDGE: f64 = 8.0;
/// A row of text, in sizes of its letters.
const ROW: f64 = 1.15;
/// Width that an arrow of direction takes before a text, in sizes of its letters.
const ARROW: f64 = 1.35;

/// A label that wants a place.
pub(super) struct Request {
    /// Ways to write it, as lines, the best first.
    pub(super) texts: Vec<Vec<String>>,
    /// Points that its border would touch, and where it lies from there, the best first.
    pub(super) spots: Vec<[Point; 2]>,
    /// The direction in which a link acts, where it is drawn in another.
    pub(super) acts: Option<Point>,
    /// What it speaks of, and how far that reaches around.
    pub(super) of: (Point, f64),
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
    /// Where the double arrow and the texts' middles are, px.
    pub(super) fn parts(&self, size: f64) -> (Point, Vec<Point>) {
        let arrow = if self.acts.is_some() { ARROW * size } else { 0.0 };
        let [x, y] = self.area.middle;
        let rows = f64::from(u8::try_from(self.lines.len()).unwrap_or(u8::MAX));
        let middles = (0..self.lines.len()).map(|row| {
            let row = f64::from(u8::try_from(row).unwrap_or(u8::MAX));
            [x + 0.5 * arrow, y + (row - 0.5 * (rows - 1.0)) * ROW * size]
        });
        ([x - self.area.half[0] + 0.45 * arrow, y], middles.collect())
    }
}

/// Half of the width and height of lines of text, px.
pub(super) fn half_size(lines: &[String], acts: bool, size: f64) -> Point {
    // The reader's own font may be a little wider.
    let width = lines.iter().map(|text| 1.05 * text_width(text, size)).fold(0.0, f64::max);
    let rows = f64::from(u8::try_from(lines.len()).unwrap_or(u8::MAX));
    let arrow = if acts { ARROW * size } else { 0.0 };
    [0.5 * (width + arrow), 0.5 * ROW * size * rows]
}

/// Labels that have found their places, and what they must keep off.
pub(super) struct Labels {
    size: f64,
    pub(super) placed: Vec<Label>,
    /// Lines that are drawn, and half of their width.
    ink: Vec<([Point; 2], f64)>,
    /// Did all find a place right at what they speak of?
    pub(super) all_near: bool,
    /// Were some left out, as they stand elsewhere?
    pub(super) left_out: bool,
}

impl Labels {
    pub(super) fn new(size: f64, shapes: &[Shape]) -> Self {
        let mut ink = Vec::new();
        for shape in shapes {
            let (points, width) = shape.extent();
            if let Shape::Area(corners, _) = shape {
                // The diagonals stand for the inside.
                ink.extend((2..corners.len()).map(|end| ([corners[end - 2], corners[end]], 0.0)));
            }
            if let [point] = points[..] {
                ink.push(([point, point], width));
            }
            ink.extend(points.windows(2).map(|pair| ([pair[0], pair[1]], width)));
        }
        Self { size, placed: Vec::new(), ink, all_near: true, left_out: false }
    }

    /// Sets a label where it is wanted, which is where nothing else is.
    pub(super) fn set(&mut self, lines: Vec<String>, middle: Point) {
        let area = Box { middle, half: half_size(&lines, false, self.size) };
        self.placed.push(Label { area, lines, acts: None, leader: None });
    }

    /// Finds places: at one of the spots, or else farther away, with a line that leads there. A
    /// label that stands elsewhere already is left out rather than set far away.
    pub(super) fn place(&mut self, requests: &[&Request]) {
        let far: Vec<&Request> =
            requests.iter().copied().filter(|request| !self.place_near(request)).collect();
        far.into_iter().for_each(|request| self.place_far(request));
    }

    fn place_near(&mut self, request: &Request) -> bool {
        // With the nearest corner there, or else with the whole side beyond.
        for corner in [true, false] {
            for lines in &request.texts {
                let half = half_size(lines, request.acts.is_some(), self.size);
                for [at, way] in &request.spots {
                    let middle = if corner {
                        let parts = way.map(|part| (4.0 * part).clamp(-1.0, 1.0));
                        [0, 1].map(|axis| at[axis] + parts[axis] * half[axis])
                    } else {
                        along(*at, *way, Box::reach(half, *way))
                    };
                    let area = Box { middle, half };
                    if self.is_free(&area) {
                        self.push(request, lines, area, None);
                        return true;
                    }
                }
            }
        }
        false
    }

    fn place_far(&mut self, request: &Request) {
        self.all_near = false;
        let known = |lines: &Vec<String>| self.placed.iter().any(|label| label.lines == *lines);
        if request.texts.iter().any(known) {
            self.left_out = true;
            return;
        }
        let Some(lines) = request.texts.first() else { return };
        let half = half_size(lines, request.acts.is_some(), self.size);
        let (of, around) = request.of;
        let mut best = Box { middle: of, half };
        'found: for ring in 1..60 {
            for turn in 0..24 {
                let way = way(f64::from(turn) * PI / 12.0 - 0.5 * PI);
                let away = around + 10.0 * f64::from(ring);
                best.middle = along(of, way, away + Box::reach(half, way));
                if self.is_free(&best) {
                    break 'found;
                }
            }
        }
        // To the nearest point of its border.
        let end = [0, 1].map(|axis| {
            let from = best.middle[axis];
            of[axis].clamp(from - half[axis] - 1.0, from + half[axis] + 1.0)
        });
        let between = sub(end, of);
        let leader =
            (length(between) > around + 4.0).then(|| [along(of, unit(between), around), end]);
        self.push(request, lines, best, leader);
    }

    fn push(&mut self, request: &Request, lines: &[String], area: Box, leader: Option<[Point; 2]>) {
        if let Some(line) = leader {
            self.ink.push((line, 0.5));
        }
        self.placed.push(Label { area, lines: lines.to_vec(), acts: request.acts, leader });
    }

    fn is_free(&self, area: &Box) -> bool {
        let inside = (area.middle[0] - 0.5 * WIDTH).abs() + area.half[0] < 0.5 * WIDTH - EDGE;
        inside
            && self.placed.iter().all(|label| !label.area.meets(area, 2.0 * GAP))
            && self.ink.iter().all(|(line, width)| !area.met_by(*line, width + GAP))
    }
}
