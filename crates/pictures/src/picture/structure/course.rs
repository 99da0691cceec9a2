//! How links run between the places: links of the same course are one bundle.

use super::Structure;
use super::place::{directions, keeps_off};
use super::plane::{along, apart, distance, dot, length, scaled, sub, unit, way};
use crate::picture::canvas::Point;
use std::f64::consts::PI;

/// How far from a mass's middle the ground is that a link ends at.
pub(super) const GROUND: f64 = 0.85;
/// How far from a mass's middle the name is that a link ends at.
pub(super) const NAME: f64 = 0.8;
/// Lines that leave a mass have at least 40° between them.
const COS_APART: f64 = 0.766;
/// The longest straight line between two masses.
const LONGEST: f64 = 2.6;
/// What keeps off a mass.
const OFF: f64 = 0.38;

/// Where links run; y is upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// Straight from one mass to the other.
    Straight([usize; 2]),
    /// From a mass to ground, along a way of length 1.
    Ground(usize, Point),
    /// Between masses that have no straight line: leaves each along a way, to the other's name.
    Named([usize; 2], [Point; 2]),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bundle {
    pub(super) course: Course,
    /// Places in the structure's links.
    pub(super) links: Vec<usize>,
}

/// What stands already, while courses are found.
struct Plan<'a> {
    structure: &'a Structure,
    places: &'a [Point],
    bundles: Vec<Bundle>,
}

/// Puts each link into one bundle.
pub(super) fn bundles(structure: &Structure, places: &[Point]) -> Vec<Bundle> {
    let mut plan = Plan { structure, places, bundles: Vec::new() };
    let mut pairs: Vec<([usize; 2], Vec<usize>)> = Vec::new();
    let mut grounds: Vec<(usize, Point, Vec<usize>)> = Vec::new();
    for (place, link) in structure.links.iter().enumerate() {
        let forth = way(link.direction);
        match link.ends {
            [Some(a), Some(b)] => {
                let same = |pair: [usize; 2]| pair == [a, b] || pair == [b, a];
                match pairs.iter_mut().find(|(pair, _)| same(*pair)) {
                    Some((_, links)) => links.push(place),
                    None => pairs.push(([a, b], vec![place])),
                }
            }
            [Some(mass), None] => to_ground(&mut grounds, mass, forth, place),
            [None, Some(mass)] => to_ground(&mut grounds, mass, scaled(forth, -1.0), place),
            [None, None] => {}
        }
    }
    let mut named = Vec::new();
    for (pair, links) in pairs {
        if plan.is_straight(pair) {
            plan.bundles.push(Bundle { course: Course::Straight(pair), links });
        } else {
            named.push((pair, links));
        }
    }
    for (pair, links) in named {
        let first = &structure.links[links[0]];
        let forth = way(first.direction);
        let back = scaled(forth, -1.0);
        let ends = [(pair[0], forth), (pair[1], back)].map(|(mass, way)| {
            // Out of the way of the wished one at the other side, too.
            plan.free_way(mass, &[way, scaled(way, -1.0)], NAME).unwrap_or(way)
        });
        plan.bundles.push(Bundle { course: Course::Named(pair, ends), links });
    }
    let mut left = Vec::new();
    for (mass, way, links) in grounds {
        match plan.first_free(mass, &[way, scaled(way, -1.0)], GROUND) {
            Some(way) => plan.bundles.push(Bundle { course: Course::Ground(mass, way), links }),
            None => left.push((mass, way, links)),
        }
    }
    for (mass, way, links) in left {
        plan.join_ground(mass, way, links);
    }
    plan.bundles
}

/// Links of one mass to ground that act along one line run side by side.
fn to_ground(grounds: &mut Vec<(usize, Point, Vec<usize>)>, mass: usize, way: Point, link: usize) {
    let same = |(other, known, _): &&mut (usize, Point, Vec<usize>)| {
        *other == mass && dot(*known, way).abs() > 0.99
    };
    match grounds.iter_mut().find(same) {
        Some((_, _, links)) => links.push(link),
        None => grounds.push((mass, way, vec![link])),
    }
}

impl Plan<'_> {
    fn is_straight(&self, [a, b]: [usize; 2]) -> bool {
        let line = [self.places[a], self.places[b]];
        let over = (0..self.places.len())
            .any(|mass| mass != a && mass != b && distance(self.places[mass], line) < OFF);
        let forth = unit(sub(line[1], line[0]));
        let rubs = |mass: usize, way: Point| {
            let own = self.structure.sliders.iter().filter(|slider| slider.mass == mass);
            own.into_iter().any(|s| s.on.is_none() && -dot(directions(s)[1], way) > COS_APART)
        };
        // What rubs has its slider there.
        let contact = self.structure.sliders.iter().any(|slider| {
            slider.on.is_some_and(|on| [on, slider.mass] == [a, b] || [on, slider.mass] == [b, a])
        });
        !contact
            && length(sub(line[1], line[0])) < LONGEST
            && !over
            && !rubs(a, forth)
            && !rubs(b, scaled(forth, -1.0))
    }

    /// The ways along which something leaves a mass already.
    fn taken(&self, mass: usize) -> Vec<Point> {
        taken(self.structure, self.places, &self.bundles, mass)
    }

    fn is_free(&self, mass: usize, way: Point, reach: f64) -> bool {
        if self.taken(mass).iter().any(|taken| dot(*taken, way) > COS_APART) {
            return false;
        }
        let start = self.places[mass];
        let ray = [along(start, way, 0.3), along(start, way, reach)];
        let off_masses = (0..self.places.len())
            .all(|other| other == mass || distance(self.places[other], ray) > OFF);
        let mut lines = Vec::new();
        for Bundle { course, .. } in &self.bundles {
            match *course {
                Course::Straight(pair) if pair.contains(&mass) => {}
                Course::Straight(pair) => lines.push(pair.map(|end| self.places[end])),
                Course::Ground(other, way) => {
                    let at = self.places[other];
                    lines.push([along(at, way, 0.3), along(at, way, GROUND)]);
                }
                Course::Named(pair, ways) => {
                    for (other, way) in pair.into_iter().zip(ways) {
                        let at = self.places[other];
                        lines.push([along(at, way, 0.3), along(at, way, NAME)]);
                    }
                }
            }
        }
        let off_sliders = self.structure.sliders.iter().all(|slider| {
            let [tangent, normal] = directions(slider);
            let foot = along(self.places[slider.mass], normal, -0.35);
            apart(ray, [along(foot, tangent, -0.25), along(foot, tangent, 0.25)]) > 0.2
        });
        off_masses && off_sliders && keeps_off(ray, &lines, 0.2)
    }

    fn first_free(&self, mass: usize, ways: &[Point], reach: f64) -> Option<Point> {
        ways.iter().copied().find(|&way| self.is_free(mass, way, reach))
    }

    /// One of the given ways, or else the nearest that is free of the sixteen of the compass.
    fn free_way(&self, mass: usize, ways: &[Point], reach: f64) -> Option<Point> {
        self.first_free(mass, ways, reach).or_else(|| {
            let mut compass: Vec<Point> =
                (0..16).map(|turn| way(f64::from(turn) * PI / 8.0)).collect();
            let fit = |way: &Point| dot(*way, ways[0]).abs();
            // Stable, and rounded: equal ones keep their order on every machine.
            compass.sort_by(|a, b| (fit(b) * 1e6).round().total_cmp(&(fit(a) * 1e6).round()));
            self.first_free(mass, &compass, reach)
        })
    }

    /// Links whose own way is taken run beside others of their mass, or where there is room.
    fn join_ground(&mut self, mass: usize, way: Point, mut links: Vec<usize>) {
        // The nearest in direction, and of equal ones the first.
        let mut beside: Option<(f64, &mut Bundle)> = None;
        for bundle in &mut self.bundles {
            if let Course::Ground(other, known) = bundle.course {
                let fit = dot(known, way).abs();
                if other == mass && beside.as_ref().is_none_or(|(best, _)| fit > best + 1e-6) {
                    beside = Some((fit, bundle));
                }
            }
        }
        if let Some((_, bundle)) = beside {
            bundle.links.append(&mut links);
            return;
        }
        let way = self.free_way(mass, &[way], GROUND).unwrap_or(way);
        self.bundles.push(Bundle { course: Course::Ground(mass, way), links });
    }
}

/// The ways along which links and sliders stand at a mass.
pub(super) fn taken(
    structure: &Structure,
    places: &[Point],
    bundles: &[Bundle],
    mass: usize,
) -> Vec<Point> {
    let mut ways = Vec::new();
    for Bundle { course, .. } in bundles {
        match *course {
            Course::Straight([a, b]) => {
                let forth = unit(sub(places[b], places[a]));
                ways.extend((a == mass).then_some(forth));
                ways.extend((b == mass).then_some(scaled(forth, -1.0)));
            }
            Course::Ground(other, way) => ways.extend((other == mass).then_some(way)),
            Course::Named(pair, ends) => {
                for (other, way) in pair.into_iter().zip(ends) {
                    ways.extend((other == mass).then_some(way));
                }
            }
        }
    }
    for slider in &structure.sliders {
        let normal = directions(slider)[1];
        if slider.mass == mass {
            ways.push(scaled(normal, -1.0));
        } else if slider.on == Some(mass) {
            ways.push(unit(sub(places[slider.mass], places[mass])));
        }
    }
    ways
}
