//! The symbols of a structure and their labels, px.

use super::labels::{Labels, Request, half_size};
use super::layout::{End, Run, STUB, directions};
use super::plane::{across, along, centred, dot, reach, scaled, unit, way};
use super::symbols::{self, HATCH, Shape, room};
use super::text::written;
use super::{ForceMark, MassMark, SliderMark, Structure};
use crate::picture::canvas::{Point, WIDTH};

/// Settings of the texts and symbols in the picture.
#[derive(Clone, Copy)]
pub(super) struct SheetStyle {
    /// `true` if values stand beside the names; otherwise they are listed below.
    pub(super) values: bool,
    /// Size of letters, px.
    pub(super) size: f64,
    /// Free space for labels at the left and the right, px.
    pub(super) margin: f64,
    /// Half of the width of springs and dashpots, px.
    pub(super) amplitude: f64,
    /// The largest half of a mass's side, in steps of the grid.
    pub(super) largest: f64,
}

/// Structure, middles and sizes, while the symbols are drawn.
pub(super) struct Plot<'a> {
    pub(super) structure: &'a Structure,
    pub(super) style: SheetStyle,
    /// Length of a step of the grid along x and y, px.
    pub(super) scale: Point,
    /// Half of the side of the masses' squares, px.
    pub(super) half: f64,
    pub(super) middles: Vec<Point>,
    pub(super) shapes: Vec<Shape>,
    pub(super) requests: Vec<Request>,
}

impl<'a> Plot<'a> {
    /// Draws all symbols and finds places for their labels.
    pub(super) fn of(
        structure: &'a Structure,
        places: &[Point],
        runs: &[Run],
        style: SheetStyle,
    ) -> (Self, Labels) {
        let mut plot = Self::sized(structure, places, runs, style);
        structure.sliders.iter().for_each(|slider| plot.slider(slider));
        runs.iter().for_each(|run| plot.run(run));
        for (mass, &middle) in plot.middles.iter().enumerate() {
            symbols::mass(middle, plot.axes(mass), plot.half, &mut plot.shapes);
        }
        (0..structure.masses.len()).for_each(|mass| plot.guides(mass));
        structure.forces.iter().for_each(|force| plot.force(force));
        let mut labels = Labels::new(style.size, room(&plot.shapes));
        // Masses first: their names have the least choice.
        let outside = (0..structure.masses.len()).filter_map(|mass| plot.mass(mass, &mut labels));
        let outside: Vec<Request> = outside.collect();
        labels.place(&outside);
        labels.place(&plot.requests);
        (plot, labels)
    }

    /// Finds how large a step of the grid and a mass are.
    fn sized(structure: &'a Structure, places: &[Point], runs: &[Run], style: SheetStyle) -> Self {
        let masses = places.iter().map(|&place| (place, [0.25; 2]));
        let stubs = runs.iter().filter(|run| !matches!(run.end, End::Mass(_)));
        let stubs = stubs.map(|run| (along(places[run.mass], run.way, STUB), [0.05; 2]));
        let [[left, right], [low, high]] = reach(masses.chain(stubs));
        let across = (WIDTH - 2.0 * style.margin) / (right - left);
        // Pictures that are too tall to be seen at once are drawn smaller.
        let pitch = across.min(190.0).min((1000.0 / (high - low)).max(85.0));
        // In a picture without oblique lines, directions stay when a narrow picture is drawn taller.
        let upright = runs.iter().all(|run| run.way[0].abs() < 1e-6 || run.way[1].abs() < 1e-6);
        let upwards = if upright { pitch.max((1.75 * pitch).min(115.0)) } else { pitch };
        // Masses are as large as names need that are not too long.
        let need = |mass: &MassMark| {
            let half = half_size(std::slice::from_ref(&mass.name), false, style.size);
            let [cos, sin] = way(mass.angle).map(f64::abs);
            (half[0] * cos + half[1] * sin).max(half[0] * sin + half[1] * cos) + 3.0
        };
        let needs = structure.masses.iter().map(need);
        let most_needed = needs.filter(|need| *need <= style.largest * pitch).fold(0.0, f64::max);
        let middle = 0.5 * (left + right);
        let middles = places
            .iter()
            .map(|place| [0.5 * WIDTH + (place[0] - middle) * pitch, -place[1] * upwards]);
        Self {
            structure,
            style,
            scale: [pitch, upwards],
            half: most_needed.max((0.17 * pitch).min(36.0)),
            middles: middles.collect(),
            shapes: Vec::new(),
            requests: Vec::new(),
        }
    }

    /// Unit vectors of the axes of a mass, in the picture, where y is downwards.
    pub(super) fn axes(&self, mass: usize) -> [Point; 2] {
        let [x, y] = way(self.structure.masses[mass].angle);
        [[x, -y], [-y, -x]]
    }

    /// Extent of a mass along a direction, px.
    pub(super) fn support(&self, mass: usize, way: Point) -> f64 {
        self.axes(mass).iter().map(|axis| self.half * dot(*axis, way).abs()).sum()
    }

    pub(super) fn request(
        &mut self,
        texts: Vec<Vec<String>>,
        line: [Point; 2],
        reach: f64,
        outs: &[Point],
    ) {
        self.requests.push(Request { texts, line, reach, outs: outs.to_vec(), acts: None });
    }

    /// The possible notations of something, by its name and value.
    pub(super) fn written(&self, name: &str, label: &str) -> Vec<Vec<String>> {
        written(name, label, self.style.values)
    }

    fn slider(&mut self, slider: &SliderMark) {
        let [tangent, normal] = directions(slider).map(|[x, y]| [x, -y]);
        let out = scaled(normal, -1.0);
        let foot = along(self.middles[slider.mass], out, self.support(slider.mass, out));
        // Surfaces that meet in a corner end there.
        let alone = self.structure.sliders.iter().filter(|s| s.mass == slider.mass).count() == 1;
        let half = if alone { 1.2 * self.half + 4.0 } else { self.half };
        let moves = (slider.velocity != 0.0).then(|| scaled(tangent, slider.velocity.signum()));
        if let Some(on) = slider.on {
            let wide = [-0.5, 0.5].map(|part| scaled(tangent, part * self.half));
            symbols::stem([foot, self.middles[on]], wide, &mut self.shapes);
        }
        symbols::slider(foot, out, half, slider.on.is_none(), moves, &mut self.shapes);
        let deep = match (slider.on, moves) {
            (Some(_), _) => 4.0,
            (None, Some(_)) => HATCH + 17.0,
            (None, None) => HATCH + 2.0,
        };
        let base = centred(along(foot, out, deep), tangent, half);
        let texts = self.written(&slider.name, &slider.label);
        self.request(texts, base, 2.0, &[out, tangent, scaled(tangent, -1.0)]);
    }

    /// Guides stand at a side of a mass where nothing else is.
    fn guides(&mut self, mass: usize) {
        let locked = self.structure.masses[mass].locked.into_iter().zip(self.axes(mass));
        for (_, axis) in locked.filter(|(locked, _)| *locked) {
            let back = scaled(axis, -1.0);
            let face = |out| along(self.middles[mass], out, self.half);
            let room = room(&self.shapes);
            let free = |out: &Point| {
                let line = centred(along(face(*out), *out, 12.0), across(*out), 0.6 * self.half);
                room.has(line, 8.0)
            };
            let out = [back, axis].into_iter().find(free).unwrap_or(back);
            symbols::guide(face(out), out, self.half, &mut self.shapes);
        }
    }

    /// An arrow along its way: before the mass or behind it, at its middle or beside that, where nothing else is.
    fn force(&mut self, force: &ForceMark) {
        let (push, gap, size) = (way(-force.angle), 3.0, 40.0);
        let (middle, side) = (self.middles[force.mass], across(push));
        let reach = self.support(force.mass, push) + gap;
        let sideways = [0.0, 0.5, -0.5, 0.8, -0.8, 1.3, -1.3];
        let mut arrows = sideways.into_iter().flat_map(|part| {
            let foot = along(middle, side, part * self.half);
            [-1.0, 1.0].map(|sign| along(foot, push, sign * (reach + 0.5 * size)))
        });
        let room = room(&self.shapes);
        // Only the end at the mass itself may be near.
        let half = 0.5 * size - 5.0;
        let free = arrows.clone().find(|&middle| room.has(centred(middle, push, half), 6.0));
        let line = centred(free.or(arrows.next()).unwrap_or(middle), push, 0.5 * size);
        symbols::arrow(line, symbols::force_colour(), &mut self.shapes);
        let texts = self.written(&force.name, &force.label);
        self.request(texts, line, 5.0, &[scaled(side, -1.0), side, scaled(push, -1.0), push]);
    }

    /// Writes a mass's name into its square if there is room; else it is to stand outside.
    fn mass(&self, mass: usize, labels: &mut Labels) -> Option<Request> {
        let MassMark { name, label, .. } = &self.structure.masses[mass];
        let middle = self.middles[mass];
        let texts = self.written(name, label);
        let fits = |lines: &Vec<String>| {
            let half = half_size(lines, false, self.style.size);
            self.axes(mass)
                .iter()
                .all(|axis| half[0] * axis[0].abs() + half[1] * axis[1].abs() < self.half - 2.0)
        };
        if let Some(lines) = texts.iter().rev().find(|lines| fits(lines)) {
            labels.set(lines.clone(), middle);
            return None;
        }
        let corners = [[1.0, -1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(unit);
        let sides = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
        let outs = [&corners[..], &sides[..]].concat();
        let reach = self.support(mass, [1.0, 0.0]);
        Some(Request { texts, line: [middle; 2], reach, outs, acts: None })
    }
}
