//! The symbols of a structure and what is written at them, px.

use super::course::{Bundle, Course, GROUND, NAME, taken};
use super::labels::{Labels, Request, half_size};
use super::place::directions;
use super::plane::{add, along, dot, scaled, sub, unit, way};
use super::symbols::{self, HATCH, Shape};
use super::text::written;
use super::{MassMark, SliderMark, Structure};
use crate::picture::canvas::{Point, WIDTH};

/// How much is written into the picture.
#[derive(Clone, Copy)]
pub(super) struct Style {
    /// Values beside the names? Else they are listed below.
    pub(super) values: bool,
    /// Of letters, px.
    pub(super) size: f64,
    /// Free for labels at the left and the right, px.
    pub(super) margin: f64,
    /// Half of the width of springs and dashpots, px.
    pub(super) amplitude: f64,
    /// The largest half of a mass's side, in units.
    pub(super) largest: f64,
}

/// Structure, places and sizes, while the symbols are drawn.
pub(super) struct Plot<'a> {
    pub(super) structure: &'a Structure,
    pub(super) bundles: &'a [Bundle],
    /// Of masses, with y upwards.
    pub(super) places: &'a [Point],
    pub(super) style: Style,
    /// px for a unit along x and y.
    pub(super) scale: Point,
    /// Of the masses' squares, px.
    pub(super) half: f64,
    pub(super) middles: Vec<Point>,
    pub(super) shapes: Vec<Shape>,
    pub(super) requests: Vec<Request>,
}

impl<'a> Plot<'a> {
    pub(super) fn of(
        structure: &'a Structure,
        places: &'a [Point],
        bundles: &'a [Bundle],
        style: Style,
    ) -> Self {
        // What reaches how far, in units.
        let mut reach = [[0.0_f64; 2]; 2];
        let first = places.first().copied().unwrap_or_default();
        let mut extend = |point: Point| {
            for (axis, [from, to]) in reach.iter_mut().enumerate() {
                *from = from.min(point[axis] - first[axis]);
                *to = to.max(point[axis] - first[axis]);
            }
        };
        for &place in places {
            extend(add(place, [0.25, 0.25]));
            extend(sub(place, [0.25, 0.25]));
        }
        for force in &structure.forces {
            extend(along(places[force.mass], way(force.angle), -0.6));
        }
        let mut upright = true;
        let mut along_axes = |way: Point| upright &= way[0].abs() < 1e-6 || way[1].abs() < 1e-6;
        for Bundle { course, .. } in bundles {
            match *course {
                Course::Straight([a, b]) => along_axes(unit(sub(places[b], places[a]))),
                Course::Ground(mass, way) => extend(along(places[mass], way, GROUND + 0.1)),
                Course::Named(pair, ways) => {
                    for (mass, way) in pair.into_iter().zip(ways) {
                        extend(along(places[mass], way, NAME + 0.1));
                    }
                }
            }
        }
        for slider in &structure.sliders {
            extend(along(places[slider.mass], directions(slider)[1], -0.5));
            if let Some(on) = slider.on {
                along_axes(unit(sub(places[slider.mass], places[on])));
            }
        }
        let [[left, right], [low, high]] = reach;
        let across = (WIDTH - 2.0 * style.margin) / (right - left);
        // Pictures that are too tall to be seen at once are drawn smaller.
        let pitch = across.min(190.0).min((1000.0 / (high - low)).max(85.0));
        let upwards = if upright { pitch.max((1.75 * pitch).min(115.0)) } else { pitch };
        // As large as names need that are not too long.
        let need = |mass: &MassMark| {
            let half = half_size(std::slice::from_ref(&mass.name), false, style.size);
            let [cos, sin] = way(mass.angle).map(f64::abs);
            (half[0] * cos + half[1] * sin).max(half[0] * sin + half[1] * cos) + 3.0
        };
        let needs = structure.masses.iter().map(need);
        let most = needs.filter(|need| *need <= style.largest * pitch).fold(0.0, f64::max);
        let half = most.max((0.17 * pitch).min(36.0));
        let scale = [pitch, upwards];
        let middle = 0.5 * (left + right) + first[0];
        let middles = places
            .iter()
            .map(|place| [0.5 * WIDTH + (place[0] - middle) * pitch, -place[1] * upwards])
            .collect();
        let (shapes, requests) = (Vec::new(), Vec::new());
        Self { structure, bundles, places, style, scale, half, middles, shapes, requests }
    }

    pub(super) fn drawn(mut self) -> (Self, Labels) {
        for slider in &self.structure.sliders {
            self.slider(slider);
        }
        for bundle in self.bundles {
            self.bundle(bundle);
        }
        for mass in 0..self.middles.len() {
            symbols::mass(self.middles[mass], self.axes(mass), self.half, &mut self.shapes);
            self.guides(mass);
        }
        for force in &self.structure.forces {
            self.force(force);
        }
        let mut labels = Labels::new(self.style.size, &self.shapes);
        let mut outside = Vec::new();
        for mass in 0..self.middles.len() {
            outside.extend(self.mass(mass, &mut labels));
        }
        // Masses first: their names have the least choice.
        let requests: Vec<&Request> = outside.iter().chain(&self.requests).collect();
        labels.place(&requests);
        (self, labels)
    }

    /// Of a mass, px.
    pub(super) fn axes(&self, mass: usize) -> [Point; 2] {
        let [x, y] = way(self.structure.masses[mass].angle);
        [[x, -y], [-y, -x]]
    }

    /// From a mass's middle to the edge of its square along a way.
    pub(super) fn edge(&self, mass: usize, way: Point) -> f64 {
        let [a, b] = self.axes(mass).map(|axis| dot(axis, way).abs());
        self.half / a.max(b)
    }

    /// How far a mass reaches along a way.
    pub(super) fn support(&self, mass: usize, way: Point) -> f64 {
        let [a, b] = self.axes(mass).map(|axis| dot(axis, way).abs());
        self.half * (a + b)
    }

    /// A length along a way of the picture, where its axes have different scales.
    pub(super) fn stretched(&self, units: f64, [x, y]: Point) -> f64 {
        let (x, y) = (x.abs(), y.abs());
        units * (x * self.scale[0] + y * self.scale[1]) / (x + y)
    }

    fn slider(&mut self, slider: &SliderMark) {
        let [tangent, normal] = directions(slider).map(|[x, y]| [x, -y]);
        let out = scaled(normal, -1.0);
        let foot = along(self.middles[slider.mass], out, self.support(slider.mass, out));
        // Surfaces that meet in a corner end there.
        let alone = self.structure.sliders.iter().filter(|s| s.mass == slider.mass).count() == 1;
        let half = if alone { 1.2 * self.half + 4.0 } else { self.half };
        let moves = (slider.velocity != 0.0)
            .then(|| scaled(tangent, if slider.velocity < 0.0 { -1.0 } else { 1.0 }));
        if let Some(on) = slider.on {
            // A stem from the surface to the mass that it belongs to.
            let (end, wide) = (self.middles[on], 0.5 * self.half);
            let corners = [
                along(foot, tangent, -wide),
                along(foot, tangent, wide),
                along(end, tangent, wide),
                along(end, tangent, -wide),
            ];
            self.shapes.push(Shape::Area(corners.to_vec(), symbols::MASS));
        }
        symbols::slider(foot, out, half, slider.on.is_none(), moves, &mut self.shapes);
        let deep = if moves.is_some() { HATCH + 20.0 } else { HATCH + 5.0 };
        let mut spots = Vec::new();
        if slider.on.is_none() {
            let base = along(foot, out, deep);
            spots.extend([0.0, 1.0, -1.0].map(|part| [along(base, tangent, part * half), out]));
        }
        for side in [tangent, scaled(tangent, -1.0)] {
            let end = along(foot, side, half + 6.0);
            spots.extend([0.0, 8.0, 16.0, -8.0].map(|down| [along(end, out, down), side]));
        }
        let texts = match written(&slider.name, &slider.label, self.style.values) {
            texts if texts.is_empty() => return,
            texts => texts,
        };
        self.requests.push(Request { texts, spots, acts: None, of: (along(foot, out, 4.0), 4.0) });
    }

    /// Guides stand at the side of a mass that has most room.
    fn guides(&mut self, mass: usize) {
        let taken = taken(self.structure, self.places, self.bundles, mass);
        for (locked, axis) in self.structure.masses[mass].locked.into_iter().zip(self.axes(mass)) {
            if !locked {
                continue;
            }
            let crowd =
                |way: Point| taken.iter().map(|&[x, y]| dot([x, -y], way)).fold(-1.0, f64::max);
            let back = scaled(axis, -1.0);
            let out = if crowd(axis) < crowd(back) - 1e-6 { axis } else { back };
            let face = along(self.middles[mass], out, self.half);
            symbols::guide(face, out, self.half, &mut self.shapes);
        }
    }

    /// Writes a mass's name into its square if there is room; what has none is to stand outside.
    fn mass(&self, mass: usize, labels: &mut Labels) -> Option<Request> {
        let MassMark { name, label, .. } = &self.structure.masses[mass];
        let middle = self.middles[mass];
        let fits = |lines: &[String]| {
            let half = half_size(lines, false, self.style.size);
            self.axes(mass)
                .iter()
                .all(|axis| half[0] * axis[0].abs() + half[1] * axis[1].abs() < self.half - 2.0)
        };
        let label = if self.style.values { &**label } else { "" };
        let both: Vec<String> =
            [&**name, label].iter().filter(|t| !t.is_empty()).map(|&t| t.to_owned()).collect();
        if both.is_empty() {
            return None;
        }
        if fits(&both) {
            labels.set(both, middle);
            return None;
        }
        let texts = if fits(&both[..1]) {
            labels.set(both[..1].to_vec(), middle);
            vec![both[1..].to_vec()]
        } else {
            vec![vec![both.join(" ")], both]
        };
        let mut spots = Vec::new();
        let h = std::f64::consts::FRAC_1_SQRT_2;
        for [x, y] in [[h, -h], [-h, -h], [h, h], [-h, h]] {
            // Beside a corner of the picture's own axes, at its height and above it.
            let corner =
                add(middle, scaled([x.signum(), y.signum()], self.support(mass, [1.0, 0.0])));
            spots.push([add(corner, [3.0 * x.signum(), 0.0]), [x.signum(), 0.0]]);
            spots.push([add(corner, [0.0, 3.0 * y.signum()]), [0.0, y.signum()]]);
            spots.push([along(middle, [x, y], self.support(mass, [x, y]) + 3.0), [x, y]]);
        }
        for out in [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]] {
            spots.push([along(middle, out, self.support(mass, out) + 4.0), out]);
        }
        Some(Request { texts, spots, acts: None, of: (middle, self.half) })
    }
}
