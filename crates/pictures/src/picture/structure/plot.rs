//! The symbols of a structure and what is written at them, px.

use super::labels::{Labels, Request, half_size};
use super::layout::{End, Run, STUB, directions};
use super::plane::{across, along, centred, dot, reach, scaled, sub, unit, way};
use super::symbols::{self, HATCH, Shape, room};
use super::text::written;
use super::{ForceMark, LinkKind, MassMark, SliderMark, Structure};
use crate::picture::canvas::{Point, WIDTH};
use crate::picture::palette::INK;

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
    /// The largest half of a mass's side, in steps of the grid.
    pub(super) largest: f64,
}

/// Structure, middles and sizes, while the symbols are drawn.
pub(super) struct Plot<'a> {
    structure: &'a Structure,
    pub(super) style: Style,
    /// px for a step of the grid along x and y.
    scale: Point,
    /// Of the masses' squares, px.
    half: f64,
    middles: Vec<Point>,
    pub(super) shapes: Vec<Shape>,
    requests: Vec<Request>,
}

impl<'a> Plot<'a> {
    /// Draws all symbols and finds places for what is written at them.
    pub(super) fn of(
        structure: &'a Structure,
        places: &[Point],
        runs: &[Run],
        style: Style,
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
    fn sized(structure: &'a Structure, places: &[Point], runs: &[Run], style: Style) -> Self {
        let masses = places.iter().map(|&place| (place, [0.25; 2]));
        let stubs = runs.iter().filter(|run| !matches!(run.end, End::Mass(_)));
        let stubs = stubs.map(|run| (along(places[run.mass], run.way, STUB), [0.05; 2]));
        let [[left, right], [low, high]] = reach(masses.chain(stubs));
        let across = (WIDTH - 2.0 * style.margin) / (right - left);
        // Pictures that are too tall to be seen at once are drawn smaller.
        let pitch = across.min(190.0).min((1000.0 / (high - low)).max(85.0));
        // Where nothing is oblique, directions stay when a narrow picture is drawn taller.
        let upright = runs.iter().all(|run| run.way[0].abs() < 1e-6 || run.way[1].abs() < 1e-6);
        let upwards = if upright { pitch.max((1.75 * pitch).min(115.0)) } else { pitch };
        // As large as names need that are not too long.
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

    /// Of a mass, px.
    fn axes(&self, mass: usize) -> [Point; 2] {
        let [x, y] = way(self.structure.masses[mass].angle);
        [[x, -y], [-y, -x]]
    }

    /// How far a mass reaches along a way.
    fn support(&self, mass: usize, way: Point) -> f64 {
        self.axes(mass).iter().map(|axis| self.half * dot(*axis, way).abs()).sum()
    }

    fn request(&mut self, texts: Vec<Vec<String>>, line: [Point; 2], reach: f64, outs: &[Point]) {
        self.requests.push(Request { texts, line, reach, outs: outs.to_vec(), acts: None });
    }

    /// How something may be written, by its name and value.
    fn written(&self, name: &str, label: &str) -> Vec<Vec<String>> {
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

    /// Links side by side, from bar to bar.
    fn run(&mut self, run: &Run) {
        let (way, stub) = match run.end {
            End::Mass(other) => (unit(sub(self.middles[other], self.middles[run.mass])), 0.0),
            _ => {
                let [x, y] = run.way.map(f64::abs);
                let step = (x * self.scale[0] + y * self.scale[1]) / (x + y);
                ([run.way[0], -run.way[1]], STUB * step)
            }
        };
        let start = self.leave(run.mass, way, run);
        let tip = along(self.middles[run.mass], way, stub);
        let half = 0.5 * self.spread(run, way);
        let end = match run.end {
            End::Mass(other) => self.leave(other, scaled(way, -1.0), run),
            End::Ground => {
                symbols::ground(tip, way, half + 16.0, &mut self.shapes);
                tip
            }
            End::Name(other) => {
                let end = along(tip, way, -14.0);
                symbols::bar(end, way, half, &mut self.shapes);
                symbols::arrow([end, tip], INK, &mut self.shapes);
                let name = &self.structure.masses[other].name;
                let texts = vec![vec![format!("to {name}")], vec!["to".into(), name.clone()]];
                let side = across(way);
                self.request(texts, [end, tip], 5.0, &[way, side, scaled(side, -1.0)]);
                end
            }
        };
        self.links(run, [start, end]);
    }

    /// Where links begin that leave a mass along a way: at its edge, or at a bar before it.
    fn leave(&mut self, mass: usize, way: Point, run: &Run) -> Point {
        let middle = self.middles[mass];
        let [a, b] = self.axes(mass).map(|axis| dot(axis, way).abs());
        let edge = along(middle, way, self.half / a.max(b));
        // A face that is wide enough needs no bar.
        let outermost = 0.5 * self.spread(run, way);
        if run.links.len() == 1 || (a.max(b) > 0.9999 && outermost < 0.85 * self.half) {
            return edge;
        }
        let short = 6.0_f64.min(0.1 * self.scale[0]);
        let end = along(middle, way, self.support(mass, way) + short);
        symbols::bar(end, way, outermost, &mut self.shapes);
        self.shapes.push(symbols::line(&[edge, end], INK, 1.6));
        end
    }

    /// Between the first and the last link of a run. The label of an inner one stands between it and the next.
    #[allow(clippy::cast_precision_loss)]
    fn spread(&self, run: &Run, way: Point) -> f64 {
        let Style { amplitude, size, .. } = self.style;
        let widths = run.links.iter().filter_map(|&place| {
            let link = &self.structure.links[place];
            Some(2.0 * half_size(self.written(&link.name, &link.label).first()?, true, size)[0])
        });
        let step = match run.links.len() {
            ..3 => 3.6 * amplitude,
            _ if way[0].abs() > 0.5 => 2.0 * amplitude + size + 10.0,
            _ => 2.0 * amplitude + 10.0 + widths.fold(24.0, f64::max),
        };
        step * (run.links.len() - 1) as f64
    }

    /// Side by side; the first is the upper or left one.
    #[allow(clippy::cast_precision_loss)]
    fn links(&mut self, run: &Run, ends: [Point; 2]) {
        let forth = unit(sub(ends[1], ends[0]));
        let side = across(forth);
        // Downwards, or to the right.
        let down = if side[1].abs() > 0.3 { side[1] > 0.0 } else { side[0] > 0.0 };
        let side = if down { side } else { scaled(side, -1.0) };
        let (amplitude, spread) = (self.style.amplitude, self.spread(run, forth));
        let steps = (run.links.len() - 1).max(1) as f64;
        for (at, &place) in run.links.iter().enumerate() {
            let offset = spread * (at as f64 / steps - 0.5);
            let line = ends.map(|end| along(end, side, offset));
            let link = &self.structure.links[place];
            match link.kind {
                LinkKind::Spring => symbols::spring(line, amplitude, &mut self.shapes),
                LinkKind::Damper => symbols::dashpot(line, amplitude, &mut self.shapes),
            }
            let acts = way(-link.direction);
            if link.preload != 0.0 {
                // The first end feels it along the direction, the second one against it.
                let first = link.ends[0] == Some(run.mass);
                let along_link = dot(acts, forth) >= -1e-9;
                let pulls = (link.preload > 0.0) == (first == along_link);
                symbols::preload(line, pulls, &mut self.shapes);
            }
            let turned = dot(acts, across(forth)).abs() > 0.05;
            // Above or to the right; but two links have theirs at their outer sides.
            let upright = side[1].abs() <= 0.3;
            let outer = if run.links.len() == 2 { offset > 0.0 } else { upright };
            let outwards = if outer { side } else { scaled(side, -1.0) };
            self.requests.push(Request {
                texts: self.written(&link.name, &link.label),
                line,
                reach: amplitude,
                outs: vec![outwards, scaled(outwards, -1.0)],
                acts: turned.then_some(acts),
            });
        }
    }

    /// Guides stand at a side of a mass where nothing else is.
    fn guides(&mut self, mass: usize) {
        for (locked, axis) in self.structure.masses[mass].locked.into_iter().zip(self.axes(mass)) {
            let back = scaled(axis, -1.0);
            let face = |out| along(self.middles[mass], out, self.half);
            let room = room(&self.shapes);
            let free = |out: &Point| {
                let line = centred(along(face(*out), *out, 12.0), across(*out), 0.6 * self.half);
                room.has(line, 8.0)
            };
            let out = [back, axis].into_iter().find(free).unwrap_or(back);
            if locked {
                symbols::guide(face(out), out, self.half, &mut self.shapes);
            }
        }
    }

    /// An arrow along its way: before the mass or behind it, at its middle or beside that, where nothing else is.
    fn force(&mut self, force: &ForceMark) {
        let (push, gap, size) = (way(-force.angle), 3.0, 40.0);
        let (middle, side) = (self.middles[force.mass], across(push));
        let reach = self.support(force.mass, push) + gap;
        let sideways = [0.0, 0.5, -0.5, 0.8, -0.8, 1.3, -1.3];
        let arrows = sideways.into_iter().flat_map(|sideways| {
            let foot = along(middle, side, sideways * self.half);
            [-reach - size, reach].map(|at| [along(foot, push, at), along(foot, push, at + size)])
        });
        let room = room(&self.shapes);
        let arrows: Vec<[Point; 2]> = arrows.collect();
        // The mass itself is near.
        let far = |&line: &[Point; 2]| {
            line.map(|end| {
                along(end, push, if dot(sub(line[0], middle), push) < 0.0 { -5.0 } else { 5.0 })
            })
        };
        let line = *arrows.iter().find(|line| room.has(far(line), 6.0)).unwrap_or(&arrows[0]);
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
