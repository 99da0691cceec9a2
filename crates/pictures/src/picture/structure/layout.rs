//! Layout of a structure: the positions of masses and the runs of links, each at the first free place of a list.
//!
//! A scene knows directions only. So masses stand on a grid: one after the other, each at the next free point in the
//! direction of the link or surface that joins it to those that have a place. Links run straight between two masses
//! if nothing is in the way. The other links are drawn as stubs: to ground, or from each of the two masses to the
//! other's name. Lengths are in steps of the grid, and y is upwards.

use super::plane::{
    OccupiedLines, across, add, along, centred, dot, length, scaled, sub, turned, unit, way,
};
use super::{Link, SliderMark, Structure};
use crate::picture::canvas::Point;
use std::f64::consts::{FRAC_PI_4, FRAC_PI_8};

/// Length of a stub, from its mass's middle.
pub(super) const STUB: f64 = 0.85;
/// Extent of a mass, with the space around it that is to stay free.
const MASS: f64 = 0.14;
/// Least distance of lines from each other, and from masses beyond their extent.
const GAP: f64 = 0.25;
/// Distance from a mass's middle at which lines begin: those that leave one mass are then 40° apart.
const START: f64 = 0.4;
/// Distance of a surface from its mass's middle, and half of its width.
const SURFACE: [f64; 2] = [0.42, 0.25];
/// Nothing else stands as close to a mass or its surface.
const ALONE: f64 = 0.46;
/// The longest straight line between two masses.
const LONGEST: f64 = 2.9;
/// Rows of parts that nothing joins are about this wide.
const ROW: f64 = 6.0;
/// Distance between the masses of two such parts.
const BETWEEN_PARTS: f64 = 2.0;

/// The end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Mass(usize),
    Ground,
    /// The name of a mass that no straight line leads to; there is another run from that mass.
    Name(usize),
}

/// Links that leave a mass side by side.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    pub(super) mass: usize,
    /// Direction of the run, of length 1.
    pub(super) way: Point,
    pub(super) end: End,
    /// Places in the structure's links.
    pub(super) links: Vec<usize>,
}

/// t and n of a slider.
pub(super) fn directions(slider: &SliderMark) -> [Point; 2] {
    let tangent = way(slider.angle);
    [tangent, across(tangent)]
}

/// A mass and the surfaces at its foot take their room.
fn stand(structure: &Structure, mass: usize, place: Point, room: &mut OccupiedLines) {
    room.take([place; 2], MASS);
    surfaces(structure, mass, place).for_each(|line| room.take(line, 0.0));
}

fn surfaces(
    structure: &Structure,
    mass: usize,
    place: Point,
) -> impl Iterator<Item = [Point; 2]> + '_ {
    let own = structure.sliders.iter().filter(move |s| s.mass == mass && s.on.is_none());
    own.map(move |slider| {
        let [tangent, normal] = directions(slider);
        centred(along(place, normal, -SURFACE[0]), tangent, SURFACE[1])
    })
}

/// A place on the grid for each mass; no two are the same.
pub(super) fn places(structure: &Structure) -> Vec<Point> {
    let wishes = wishes(structure);
    let mut places = vec![None; structure.masses.len()];
    // The upper left corner of the next part that nothing joins to others, and the lower end of its row.
    let (mut corner, mut low) = ([0.0, 0.0], 0.0_f64);
    while let Some(first) = places.iter().position(Option::is_none) {
        let mut part = vec![(first, [0.0; 2])];
        let mut room = OccupiedLines::default();
        stand(structure, first, [0.0; 2], &mut room);
        while let Some((from, to, way)) = next(&wishes, &part) {
            let place = free_place(structure, &room, from, to, way);
            stand(structure, to, place, &mut room);
            room.take([from, place], 0.0);
            part.push((to, place));
        }
        let least = |axis: usize| part.iter().map(|(_, at)| at[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| part.iter().map(|(_, at)| at[axis]).fold(-f64::INFINITY, f64::max);
        let size = [0, 1].map(|axis| most(axis) - least(axis));
        if corner[0] > 0.0 && corner[0] + size[0] > ROW {
            corner = [0.0, low - BETWEEN_PARTS];
        }
        let by = sub(corner, [least(0), most(1)]);
        part.iter().for_each(|&(mass, place)| places[mass] = Some(add(place, by)));
        low = low.min(corner[1] - size[1]);
        corner[0] += size[0] + BETWEEN_PARTS;
    }
    places.into_iter().map(Option::unwrap_or_default).collect()
}

/// Pairs of masses, and the way from the first to the second: contacts first, then links. The first wish of a pair counts.
fn wishes(structure: &Structure) -> Vec<([usize; 2], Point)> {
    let contacts = structure.sliders.iter();
    let contacts = contacts.filter_map(|s| Some(([s.on?, s.mass], directions(s)[1])));
    let links = structure.links.iter().filter_map(|link| match link.ends {
        [Some(a), Some(b)] => Some(([a, b], best_way(structure, link, [a, b]))),
        _ => None,
    });
    contacts.chain(links).collect()
}

/// The direction of the link, or the opposite one where that takes the one of the two masses that rubs to the side of
/// its slider.
fn best_way(structure: &Structure, link: &Link, [a, b]: [usize; 2]) -> Point {
    let way = forth(link, a);
    let normal = |mass: usize| {
        let own = structure.sliders.iter().find(|slider| slider.mass == mass);
        own.map(|slider| directions(slider)[1])
    };
    match (normal(a), normal(b)) {
        (Some(normal), None) if dot(way, normal) < -0.3 => scaled(way, -1.0),
        (None, Some(normal)) if dot(way, normal) > 0.3 => scaled(way, -1.0),
        _ => way,
    }
}

/// The direction of a link as it leaves a mass.
fn forth(link: &Link, mass: usize) -> Point {
    let sign = if link.ends[0] == Some(mass) { 1.0 } else { -1.0 };
    scaled(way(link.direction), sign)
}

/// The first wish of which one mass has a place and the other has none: the place of the former, the other mass, and
/// the direction to it. A wish that closes a ring comes last and is left out.
fn next(wishes: &[([usize; 2], Point)], part: &[(usize, Point)]) -> Option<(Point, usize, Point)> {
    let place = |mass| part.iter().find(|(other, _)| *other == mass).map(|(_, place)| *place);
    wishes.iter().find_map(|&([a, b], way)| match (place(a), place(b)) {
        (Some(from), None) => Some((from, b, way)),
        (None, Some(from)) => Some((from, a, scaled(way, -1.0))),
        _ => None,
    })
}

/// The nearest point of the grid that is free, first along the way, then against it, then to its sides.
fn free_place(
    structure: &Structure,
    room: &OccupiedLines,
    from: Point,
    mass: usize,
    way: Point,
) -> Point {
    for far in [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0] {
        for turn in [0.0, 4.0, 1.0, -1.0, 3.0, -3.0, 2.0, -2.0] {
            let step = turned(way, turn * FRAC_PI_4).map(|part| {
                // The nearest of the eight neighbours.
                if part.abs() > 0.38 { part.signum() } else { 0.0 }
            });
            let place = along(from, step, far);
            let line = [along(from, unit(step), START), place];
            let own = surfaces(structure, mass, place).all(|line| room.has(line, ALONE));
            if own && room.has(line, GAP) && room.has([place; 2], ALONE) {
                return place;
            }
        }
    }
    // Far out there is room; only it has no straight line there.
    add(from, [f64::from(u8::try_from(mass).unwrap_or(u8::MAX)) + 9.0, 0.0])
}

/// Puts each link into a run, or into two that end at names.
pub(super) fn runs(structure: &Structure, places: &[Point]) -> Vec<Run> {
    let mut room = OccupiedLines::default();
    for (mass, place) in places.iter().enumerate() {
        stand(structure, mass, *place, &mut room);
    }
    for slider in &structure.sliders {
        if let Some(on) = slider.on {
            room.take([places[slider.mass], places[on]], 0.0);
        }
    }
    let mut plan = Plan { places, room, runs: Vec::new() };
    let (pairs, grounds): (Vec<Run>, Vec<Run>) =
        bundles(structure).into_iter().partition(|run| run.end != End::Ground);
    let stubs: Vec<Run> = pairs.into_iter().filter_map(|run| plan.straight(run)).collect();
    for run in stubs {
        let End::Mass(other) = run.end else { continue };
        for (mass, way, end) in
            [(run.mass, run.way, other), (other, scaled(run.way, -1.0), run.mass)]
        {
            let way = plan.free_way(mass, way, &AROUND).unwrap_or(way);
            plan.stub(Run { mass, way, end: End::Name(end), links: run.links.clone() });
        }
    }
    let mut left = Vec::new();
    for run in grounds {
        match plan.free_way(run.mass, run.way, &AROUND[..2]) {
            Some(way) => plan.stub(Run { way, ..run }),
            None => left.push(run),
        }
    }
    // Links to ground whose own way is taken run beside others of their mass, or where there is room.
    for mut run in left {
        let is_beside = |other: &&mut Run| other.mass == run.mass && other.end == End::Ground;
        // The first of those that are as near in direction.
        let fit = |other: &Run| (dot(other.way, run.way).abs() * 1e6).round();
        let beside = plan.runs.iter_mut().filter(is_beside);
        let beside = beside.reduce(|a, b| if fit(b) > fit(a) { b } else { a });
        if let Some(other) = beside {
            other.links.append(&mut run.links);
        } else {
            let way = plan.free_way(run.mass, run.way, &AROUND).unwrap_or(run.way);
            plan.stub(Run { way, ..run });
        }
    }
    plan.runs
}

/// Links between the same two masses are one bundle, and so are those of a mass to ground along one line.
fn bundles(structure: &Structure) -> Vec<Run> {
    let mut bundles: Vec<Run> = Vec::new();
    for (place, link) in structure.links.iter().enumerate() {
        let (mass, end) = match link.ends {
            [Some(a), Some(b)] => (a, End::Mass(b)),
            [Some(mass), None] | [None, Some(mass)] => (mass, End::Ground),
            [None, None] => continue,
        };
        let way = forth(link, mass);
        let same = |other: &&mut Run| match end {
            End::Mass(b) => {
                (other.mass, other.end) == (mass, end)
                    || (other.mass, other.end) == (b, End::Mass(mass))
            }
            _ => (other.mass, other.end) == (mass, end) && dot(other.way, way).abs() > 0.99,
        };
        match bundles.iter_mut().find(same) {
            Some(bundle) => bundle.links.push(place),
            None => bundles.push(Run { mass, way, end, links: vec![place] }),
        }
    }
    bundles
}

/// The ways that a stub may take, in eighths of half a turn from its own: that one and its opposite, and the nearest to
/// these first.
const AROUND: [f64; 16] =
    [0.0, 8.0, -1.0, 1.0, -7.0, 7.0, -2.0, 2.0, -6.0, 6.0, -3.0, 3.0, -5.0, 5.0, -4.0, 4.0];

/// The placed parts while links find their ways.
struct Plan<'a> {
    places: &'a [Point],
    room: OccupiedLines,
    runs: Vec<Run>,
}

impl Plan<'_> {
    /// Runs straight to the other mass, or is given back.
    fn straight(&mut self, run: Run) -> Option<Run> {
        let End::Mass(other) = run.end else { return None };
        let line = [self.places[run.mass], self.places[other]];
        let whole = sub(line[1], line[0]);
        let way = unit(whole);
        let between = [along(line[0], way, START), along(line[1], way, -START)];
        if length(whole) > LONGEST || !self.room.has(between, GAP) {
            return Some(run);
        }
        self.room.take(line, 0.0);
        self.runs.push(Run { way, ..run });
        None
    }

    fn free_way(&self, mass: usize, way: Point, turns: &[f64]) -> Option<Point> {
        let ways = turns.iter().map(|turn| turned(way, turn * FRAC_PI_8));
        let start = self.places[mass];
        let line = |way| [along(start, way, START), along(start, way, STUB)];
        ways.into_iter().find(|&way| self.room.has(line(way), GAP))
    }

    fn stub(&mut self, run: Run) {
        let start = self.places[run.mass];
        self.room.take([start, along(start, run.way, STUB)], 0.0);
        self.runs.push(run);
    }
}
