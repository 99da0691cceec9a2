//! What stands for springs, dashpots, ground, sliders and guides, as strokes and areas. Lengths are
//! in px, and y is downwards.

use super::plane::{across, add, along, length, scaled, sub, unit};
use crate::picture::canvas::{Canvas, Failure, Point};
use crate::picture::palette::{GREY, INK, colour};
use plotters::backend::DrawingBackend;
use plotters::style::{RGBColor, WHITE};

/// How deep hatches are.
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

/// Of forces and preloads.
pub(super) fn force_colour() -> RGBColor {
    colour(3)
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    Line(Vec<Point>, RGBColor, f64),
    Area(Vec<Point>, RGBColor),
    Dot(Point, f64, RGBColor),
}

impl Shape {
    pub(super) fn moved(&self, by: Point) -> Self {
        let moved = |points: &[Point]| points.iter().map(|&point| add(point, by)).collect();
        match self {
            Self::Line(points, colour, width) => Self::Line(moved(points), *colour, *width),
            Self::Area(corners, colour) => Self::Area(moved(corners), *colour),
            Self::Dot(at, radius, colour) => Self::Dot(add(*at, by), *radius, *colour),
        }
    }

    /// Larger by a factor, about the origin, ink included.
    pub(super) fn enlarged(&self, factor: f64) -> Self {
        let large = |points: &[Point]| points.iter().map(|&point| scaled(point, factor)).collect();
        match self {
            Self::Line(points, colour, width) => Self::Line(large(points), *colour, width * factor),
            Self::Area(corners, colour) => Self::Area(large(corners), *colour),
            Self::Dot(at, radius, colour) => {
                Self::Dot(scaled(*at, factor), radius * factor, *colour)
            }
        }
    }

    pub(super) fn paint<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Result<(), Failure> {
        match self {
            Self::Line(points, colour, width) => canvas.line(points, *colour, *width, &[]),
            Self::Area(corners, colour) => canvas.fill(corners, *colour),
            Self::Dot(at, radius, colour) => canvas.dot(*at, *radius, *colour),
        }
    }

    /// All its corners, and how far ink reaches around them.
    pub(super) fn extent(&self) -> (Vec<Point>, f64) {
        match self {
            Self::Line(points, _, width) => (points.clone(), 0.5 * width),
            Self::Area(corners, _) => (corners.clone(), 0.0),
            Self::Dot(at, radius, _) => (vec![*at], *radius),
        }
    }
}

pub(super) fn line(points: &[Point], colour: RGBColor) -> Shape {
    Shape::Line(points.to_vec(), colour, MIDDLE)
}

/// A zigzag, as wide as twice the amplitude.
pub(super) fn spring([from, to]: [Point; 2], amplitude: f64, shapes: &mut Vec<Shape>) {
    let whole = sub(to, from);
    let size = length(whole);
    let (forth, side) = (unit(whole), across(unit(whole)));
    let turns = (size / (2.3 * amplitude)).round().clamp(2.0, 6.0);
    let lead = (0.16 * size).clamp(3.0, 16.0);
    let step = (size - 2.0 * lead) / (2.0 * turns);
    let mut points = vec![from, along(from, forth, lead)];
    let mut at = lead + 0.5 * step;
    let mut sign = 1.0;
    while at < size - lead {
        points.push(add(along(from, forth, at), scaled(side, sign * amplitude)));
        (at, sign) = (at + step, -sign);
    }
    points.extend([along(from, forth, size - lead), to]);
    shapes.push(line(&points, spring_colour()));
}

/// How long the straight part of a spring's or a dashpot's ends is at least, px.
const LEAD: f64 = 14.0;

/// A head on the first end of a link, which pulls there along the link, or pushes against it.
pub(super) fn preload([from, to]: [Point; 2], pulls: bool, shapes: &mut Vec<Shape>) {
    let forth = unit(sub(to, from));
    let (tip, foot) = (along(from, forth, LEAD), along(from, forth, 1.0));
    let (tip, back) = if pulls { (tip, scaled(forth, -1.0)) } else { (foot, forth) };
    shapes.push(head(tip, back, LEAD - 1.0, force_colour()));
}

/// A piston in its cylinder.
pub(super) fn dashpot([from, to]: [Point; 2], amplitude: f64, shapes: &mut Vec<Shape>) {
    let whole = sub(to, from);
    let size = length(whole);
    let (forth, side) = (unit(whole), across(unit(whole)));
    let deep = (0.36 * size).min(26.0);
    let at = |forwards: f64, sideways: f64| {
        add(along(from, forth, 0.5 * size + forwards), scaled(side, sideways))
    };
    let (bottom, open, piston) = (-0.5 * deep, 0.5 * deep, 0.1 * deep);
    let a = amplitude + 0.5;
    let colour = damper_colour();
    shapes.push(line(&[from, at(bottom, 0.0)], colour));
    shapes.push(line(&[at(open, -a), at(bottom, -a), at(bottom, a), at(open, a)], colour));
    shapes.push(Shape::Line(vec![at(piston, -a + 2.0), at(piston, a - 2.0)], colour, THICK));
    shapes.push(line(&[at(piston, 0.0), to], colour));
}

/// A surface with hatches behind it: `out` points away from what it holds.
fn surface(
    middle: Point,
    out: Point,
    half: f64,
    colour: RGBColor,
    width: f64,
    shapes: &mut Vec<Shape>,
) {
    let side = across(out);
    shapes.push(Shape::Line(
        vec![along(middle, side, -half), along(middle, side, half)],
        colour,
        width,
    ));
    let strokes = (2.0 * half / 7.0).floor().max(2.0);
    let step = 2.0 * half / strokes;
    let mut at = -half + step;
    while at < half + 0.5 * step {
        let foot = along(middle, side, at);
        let end = add(along(foot, out, HATCH), scaled(side, -(HATCH - 2.0).min(step)));
        shapes.push(Shape::Line(vec![foot, end], colour, THIN));
        at += step;
    }
}

pub(super) fn ground(middle: Point, out: Point, half: f64, shapes: &mut Vec<Shape>) {
    surface(middle, out, half, GREY, 2.0, shapes);
}

/// A bar across that several links have in common.
pub(super) fn bar(middle: Point, way: Point, half: f64, shapes: &mut Vec<Shape>) {
    let side = across(way);
    shapes.push(Shape::Line(
        vec![along(middle, side, -half), along(middle, side, half)],
        INK,
        MIDDLE,
    ));
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
        surface(middle, out, half, colour, THICK, shapes);
    } else {
        let side = across(out);
        let ends = vec![along(middle, side, -half), along(middle, side, half)];
        shapes.push(Shape::Line(ends, colour, THICK));
    }
    if let Some(way) = moves {
        let middle = along(foot, out, if rigid { HATCH + 11.0 } else { 11.0 });
        let half = half.min(26.0);
        arrow(along(middle, way, -half), along(middle, way, half), colour, shapes);
    }
}

pub(super) fn arrow(from: Point, to: Point, colour: RGBColor, shapes: &mut Vec<Shape>) {
    let back = unit(sub(from, to));
    shapes.push(Shape::Line(vec![from, along(to, back, 5.0)], colour, 2.0));
    shapes.push(head(to, back, 9.0, colour));
}

fn head(tip: Point, back: Point, size: f64, colour: RGBColor) -> Shape {
    let foot = along(tip, back, size);
    let side = scaled(across(back), 0.45 * size);
    Shape::Area(vec![tip, add(foot, side), sub(foot, side)], colour)
}

/// A small arrow with two heads: the direction in which a link acts.
pub(super) fn acts(middle: Point, way: Point, half: f64, shapes: &mut Vec<Shape>) {
    let [from, to] = [-half, half].map(|at| along(middle, way, at));
    let head_size = 0.75 * half;
    shapes.push(Shape::Line(
        vec![along(from, way, 0.6 * head_size), along(to, way, -0.6 * head_size)],
        INK,
        1.2,
    ));
    shapes.push(head(to, scaled(way, -1.0), head_size, INK));
    shapes.push(head(from, way, head_size, INK));
}

/// Two rollers between a face and ground: no motion along `out`.
pub(super) fn guide(face: Point, out: Point, half: f64, shapes: &mut Vec<Shape>) {
    let side = across(out);
    let radius = 3.0;
    for place in [-0.55, 0.55] {
        let middle = add(along(face, out, radius + 0.8), scaled(side, place * half));
        shapes.push(Shape::Dot(middle, radius, INK));
        shapes.push(Shape::Dot(middle, radius - 1.2, WHITE));
    }
    surface(along(face, out, 2.0 * radius + 2.2), out, 0.9 * half, GREY, 2.0, shapes);
}

/// The square of a mass, with its outline.
pub(super) fn mass(middle: Point, axes: [Point; 2], half: f64, shapes: &mut Vec<Shape>) {
    let corner = |[x, y]: Point| add(along(middle, axes[0], x * half), scaled(axes[1], y * half));
    let mut corners: Vec<Point> =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).to_vec();
    shapes.push(Shape::Area(corners.clone(), MASS));
    corners.push(corners[0]);
    shapes.push(Shape::Line(corners, INK, 1.8));
}
