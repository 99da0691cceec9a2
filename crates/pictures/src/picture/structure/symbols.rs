//! Symbols of springs, dashpots, ground, sliders and guides, as strokes and areas. Lengths are in px, and y is
//! downwards.

use super::plane::{OccupiedLines, across, add, along, centred, length, scaled, sub, unit, way};
use crate::picture::canvas::{Canvas, Failure, Point};
use crate::picture::palette::{GREY, INK, colour};
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;
use std::f64::consts::PI;

/// Depth of hatches.
pub(super) const HATCH: f64 = 8.0;
/// The inside of masses.
pub(super) const MASS: RGBColor = RGBColor(0xE3, 0xED, 0xF4);
const THIN: f64 = 1.0;
const MIDDLE: f64 = 1.6;
const THICK: f64 = 2.6;

pub(super) fn spring_colour() -> RGBColor {
    colour(0)
}

pub(super) fn damper_colour() -> RGBColor {
    colour(2)
}

pub(super) fn slider_colour() -> RGBColor {
    colour(1)
}

/// Colour of forces and preloads.
pub(super) fn force_colour() -> RGBColor {
    colour(3)
}

/// A line of a width, or else an area.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) points: Vec<Point>,
    pub(super) colour: RGBColor,
    pub(super) width: Option<f64>,
}

impl Shape {
    /// Larger by a factor about the origin, ink included, and then moved.
    pub(super) fn placed(&self, factor: f64, by: Point) -> Self {
        let points = self.points.iter().map(|&point| add(scaled(point, factor), by)).collect();
        Self { points, colour: self.colour, width: self.width.map(|width| width * factor) }
    }

    pub(super) fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        match self.width {
            Some(width) => canvas.line(&self.points, self.colour, width, &[]),
            None => canvas.fill(&self.points, self.colour),
        }
    }

    /// Extent of the ink around its points.
    pub(super) fn ink(&self) -> f64 {
        0.5 * self.width.unwrap_or(0.0)
    }
}

/// The room that shapes take.
pub(super) fn room(shapes: &[Shape]) -> OccupiedLines {
    let mut room = OccupiedLines::default();
    for shape in shapes {
        let points = &shape.points;
        points.windows(2).for_each(|pair| room.take([pair[0], pair[1]], shape.ink()));
        if shape.width.is_none() {
            // The diagonals stand for the inside.
            points.windows(3).for_each(|three| room.take([three[0], three[2]], 0.0));
        }
    }
    room
}

pub(super) fn line(points: &[Point], colour: RGBColor, width: f64) -> Shape {
    Shape { points: points.to_vec(), colour, width: Some(width) }
}

fn area(corners: &[Point], colour: RGBColor) -> Shape {
    Shape { points: corners.to_vec(), colour, width: None }
}

/// A zigzag, as wide as twice the amplitude.
pub(super) fn spring([from, to]: [Point; 2], amplitude: f64, shapes: &mut Vec<Shape>) {
    let size = length(sub(to, from));
    let forth = unit(sub(to, from));
    let side = scaled(across(forth), amplitude);
    let turns = (size / (2.3 * amplitude)).round().clamp(2.0, 6.0);
    let lead = (0.16 * size).clamp(3.0, 16.0);
    let step = (size - 2.0 * lead) / (2.0 * turns);
    let mut points = vec![from, along(from, forth, lead)];
    let (mut at, mut sign) = (lead + 0.5 * step, 1.0);
    while at < size - lead {
        points.push(along(along(from, forth, at), side, sign));
        (at, sign) = (at + step, -sign);
    }
    points.extend([along(to, forth, -lead), to]);
    shapes.push(line(&points, spring_colour(), MIDDLE));
}

/// A piston in its cylinder.
pub(super) fn dashpot([from, to]: [Point; 2], amplitude: f64, shapes: &mut Vec<Shape>) {
    let whole = sub(to, from);
    let forth = unit(whole);
    let deep = (0.36 * length(whole)).min(26.0);
    let middle = along(from, whole, 0.5);
    let wide = |forwards: f64, half: f64| {
        centred(along(middle, forth, forwards * deep), across(forth), half)
    };
    let half = amplitude + 0.5;
    let ([a, b], [c, d]) = (wide(0.5, half), wide(-0.5, half));
    let mut draw = |points: &[Point], width| shapes.push(line(points, damper_colour(), width));
    draw(&[from, along(middle, forth, -0.5 * deep)], MIDDLE);
    draw(&[a, c, d, b], MIDDLE);
    draw(&wide(0.1, half - 2.0), THICK);
    draw(&[along(middle, forth, 0.1 * deep), to], MIDDLE);
}

/// Least length of the straight part of a spring's or a dashpot's ends, px.
const LEAD: f64 = 14.0;

/// A head on the first end of a link, which pulls there along the link, or pushes against it.
pub(super) fn preload([from, to]: [Point; 2], pulls: bool, shapes: &mut Vec<Shape>) {
    let forth = unit(sub(to, from));
    let (tip, back) = if pulls { (LEAD, -1.0) } else { (1.0, 1.0) };
    shapes.push(head(along(from, forth, tip), scaled(forth, back), LEAD - 1.0, force_colour()));
}

/// A surface with hatches behind it: `out` points away from what it holds.
fn surface(
    middle: Point,
    out: Point,
    half: f64,
    (colour, width): (RGBColor, f64),
    shapes: &mut Vec<Shape>,
) {
    let side = across(out);
    shapes.push(line(&centred(middle, side, half), colour, width));
    let strokes = (2.0 * half / 7.0).floor().max(2.0);
    let step = 2.0 * half / strokes;
    let mut at = step - half;
    while at < half + 0.5 * step {
        let foot = along(middle, side, at);
        let end = along(along(foot, out, HATCH), side, -(HATCH - 2.0).min(step));
        shapes.push(line(&[foot, end], colour, THIN));
        at += step;
    }
}

pub(super) fn ground(middle: Point, out: Point, half: f64, shapes: &mut Vec<Shape>) {
    surface(middle, out, half, (GREY, 2.0), shapes);
}

/// A bar across that several links have in common.
pub(super) fn bar(middle: Point, way: Point, half: f64, shapes: &mut Vec<Shape>) {
    shapes.push(line(&centred(middle, across(way), half), INK, MIDDLE));
}

/// A slider's surface, hatched where it is a rigid body's, and the arrow of its velocity, which
/// points along `moves` if it moves.
pub(super) fn slider(
    foot: Point,
    out: Point,
    half: f64,
    rigid: bool,
    moves: Option<Point>,
    shapes: &mut Vec<Shape>,
) {
    let colour = slider_colour();
    let middle = along(foot, out, 0.5 * THICK + 0.8);
    if rigid {
        surface(middle, out, half, (colour, THICK), shapes);
    } else {
        shapes.push(line(&centred(middle, across(out), half), colour, THICK));
    }
    if let Some(way) = moves {
        let middle = along(foot, out, if rigid { HATCH + 11.0 } else { 11.0 });
        arrow(centred(middle, way, half.min(26.0)), colour, shapes);
    }
}

pub(super) fn arrow([from, to]: [Point; 2], colour: RGBColor, shapes: &mut Vec<Shape>) {
    let back = unit(sub(from, to));
    shapes.push(line(&[from, along(to, back, 5.0)], colour, 2.0));
    shapes.push(head(to, back, 9.0, colour));
}

fn head(tip: Point, back: Point, size: f64, colour: RGBColor) -> Shape {
    let [a, b] = centred(along(tip, back, size), across(back), 0.45 * size);
    area(&[tip, a, b], colour)
}

/// A small arrow with two heads: the direction in which a link acts.
pub(super) fn acts(middle: Point, way: Point, half: f64, shapes: &mut Vec<Shape>) {
    let size = 0.75 * half;
    shapes.push(line(&centred(middle, way, half - 0.6 * size), INK, 1.2));
    for out in [way, scaled(way, -1.0)] {
        shapes.push(head(along(middle, out, half), scaled(out, -1.0), size, INK));
    }
}

/// Two rollers between a face and ground: no motion along `out`.
pub(super) fn guide(face: Point, out: Point, half: f64, shapes: &mut Vec<Shape>) {
    let radius = 2.4;
    for middle in centred(along(face, out, radius + 1.4), across(out), 0.55 * half) {
        let circle = (0..=12).map(|turn| along(middle, way(f64::from(turn) * PI / 6.0), radius));
        shapes.push(line(&circle.collect::<Vec<_>>(), INK, 1.2));
    }
    ground(along(face, out, 2.0 * radius + 3.4), out, 0.9 * half, shapes);
}

/// The square of a mass, with its outline.
pub(super) fn mass(middle: Point, [a, b]: [Point; 2], half: f64, shapes: &mut Vec<Shape>) {
    let corner = |[x, y]: [f64; 2]| along(along(middle, a, x * half), b, y * half);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]].map(corner);
    shapes.push(area(&corners[..4], MASS));
    shapes.push(line(&corners, INK, 1.8));
}

/// The stem that joins a surface to the mass that it belongs to: half as wide as a mass.
pub(super) fn stem(line: [Point; 2], wide: [Point; 2], shapes: &mut Vec<Shape>) {
    let [a, b] = line.map(|end| wide.map(|to| add(end, to)));
    shapes.push(area(&[a[0], a[1], b[1], b[0]], MASS));
}
