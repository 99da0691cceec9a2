//! Where masses stand: a scene knows directions only, so places are found that show them.
//!
//! Masses are set one after the other along the directions of what joins them, a unit apart, where
//! nothing stands yet; then all are moved a little to agree with all directions. y is upwards.

use super::plane::{across, add, along, apart, distance, dot, length, scaled, sub, way};
use super::{Link, LinkKind, SliderMark, Structure};
use crate::picture::canvas::Point;
use std::f64::consts::FRAC_1_SQRT_2;

/// A mass and the one that it rubs on are closer than those that springs join.
pub(super) const CONTACT: f64 = 0.85;
/// A slider takes the place of a mass this far from its own.
const SLIDER: f64 = 0.6;
/// Nothing else comes as close to a mass.
const ALONE: f64 = 0.4;
/// Rows of parts that nothing joins are about this wide.
const ROW: f64 = 6.0;
const BETWEEN_PARTS: f64 = 2.0;

/// Where one mass would stand from another.
struct Wish {
    pair: [usize; 2],
    /// Of length 1, from the first to the second.
    way: Point,
    length: f64,
}

/// t and n of a slider.
pub(super) fn directions(slider: &SliderMark) -> [Point; 2] {
    let tangent = way(slider.angle);
    [tangent, across(tangent)]
}

/// A place for each mass; no two are the same.
pub(super) fn places(structure: &Structure) -> Vec<Point> {
    let wishes = wishes(structure);
    let mut found = vec![None; structure.masses.len()];
    let mut parts = Vec::new();
    while let Some(first) = found.iter().position(Option::is_none) {
        found[first] = Some([0.0, 0.0]);
        let mut part = vec![first];
        // The first wish that can be met: what closes a ring comes last and is left out.
        while let Some((wish, from, to)) = next(&wishes, &found) {
            found[to] = Some(free_place(structure, wish, from, to, &found, &part));
            part.push(to);
        }
        parts.push(part);
    }
    let mut places: Vec<Point> = found.into_iter().map(Option::unwrap_or_default).collect();
    relax(&wishes, &mut places);
    pack(&parts, &mut places);
    places
}

/// Contacts first, then one wish for each pair that links join.
fn wishes(structure: &Structure) -> Vec<Wish> {
    let mut wishes: Vec<Wish> = Vec::new();
    let known = |wishes: &[Wish], pair: [usize; 2]| {
        wishes.iter().any(|wish| wish.pair == pair || wish.pair == [pair[1], pair[0]])
    };
    for slider in &structure.sliders {
        if let Some(on) = slider.on {
            let pair = [on, slider.mass];
            if !known(&wishes, pair) {
                wishes.push(Wish { pair, way: directions(slider)[1], length: CONTACT });
            }
        }
    }
    for link in &structure.links {
        if let [Some(a), Some(b)] = link.ends
            && !known(&wishes, [a, b])
        {
            wishes.push(Wish { pair: [a, b], way: best_way(structure, [a, b]), length: 1.0 });
        }
    }
    wishes
}

/// Springs of several directions may join a pair. What rubs stands at the slider's side of what
/// does not; else the most horizontal one is shown. Dashpots have no say where there are springs.
fn best_way(structure: &Structure, pair: [usize; 2]) -> Point {
    let [a, b] = pair.map(|mass| {
        let own = structure.sliders.iter().find(|slider| slider.mass == mass);
        own.map(|slider| directions(slider)[1])
    });
    let joins =
        |ends: [Option<usize>; 2]| ends == pair.map(Some) || ends == [Some(pair[1]), Some(pair[0])];
    let mut links: Vec<&Link> = structure.links.iter().filter(|link| joins(link.ends)).collect();
    if links.iter().any(|link| link.kind == LinkKind::Spring) {
        links.retain(|link| link.kind == LinkKind::Spring);
    }
    let ways = links.into_iter().map(|link| {
        let forth = way(link.direction);
        if link.ends[0] == Some(pair[0]) { forth } else { scaled(forth, -1.0) }
    });
    let towards = match (a, b) {
        (Some(normal), None) => normal,
        (None, Some(normal)) => scaled(normal, -1.0),
        _ => [1.0, 0.0],
    };
    let rubs = a.is_some() != b.is_some();
    let mut best: Option<(f64, Point)> = None;
    for way in ways {
        let fit = dot(way, towards);
        if best.is_none_or(|(most, _)| fit.abs() > most.abs() + 1e-6) {
            best = Some((fit, way));
        }
    }
    match best {
        Some((fit, way)) if rubs && fit < -0.3 => scaled(way, -1.0),
        Some((_, way)) => way,
        None => towards,
    }
}

fn next<'a>(wishes: &'a [Wish], found: &[Option<Point>]) -> Option<(&'a Wish, usize, usize)> {
    wishes.iter().find_map(|wish| {
        let [a, b] = wish.pair;
        match (found[a], found[b]) {
            (Some(_), None) => Some((wish, a, b)),
            (None, Some(_)) => Some((wish, b, a)),
            _ => None,
        }
    })
}

/// The wished place, or else the next best that is free.
fn free_place(
    structure: &Structure,
    wish: &Wish,
    from: usize,
    to: usize,
    found: &[Option<Point>],
    part: &[usize],
) -> Point {
    let start = found[from].unwrap_or_default();
    let forth = if wish.pair[0] == from { wish.way } else { scaled(wish.way, -1.0) };
    let side = across(forth);
    let turned = |a: f64, b: f64| add(scaled(forth, a), scaled(side, b));
    let oblique = FRAC_1_SQRT_2;
    let ways = [
        turned(1.0, 0.0),
        turned(-1.0, 0.0),
        turned(oblique, oblique),
        turned(oblique, -oblique),
        turned(-oblique, oblique),
        turned(-oblique, -oblique),
        turned(0.0, 1.0),
        turned(0.0, -1.0),
    ];
    let others: Vec<(usize, Point)> =
        part.iter().filter_map(|&mass| Some((mass, found[mass]?))).collect();
    for stretch in [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0] {
        for way in ways {
            let place = along(start, way, stretch * wish.length);
            if is_free(structure, [from, to], [start, place], &others) {
                return place;
            }
        }
    }
    // Right of everything there is room.
    let right = others.iter().map(|(_, place)| place[0]).fold(0.0, f64::max);
    [right + 1.0, start[1]]
}

fn is_free(
    structure: &Structure,
    [from, to]: [usize; 2],
    line: [Point; 2],
    others: &[(usize, Point)],
) -> bool {
    let sliders_of = |mass: usize, place: Point| {
        let own = structure.sliders.iter().filter(move |s| s.mass == mass && s.on.is_none());
        own.map(move |slider| along(place, directions(slider)[1], -SLIDER))
    };
    let clear_of = |&(mass, place): &(usize, Point)| {
        let near = if mass == from { CONTACT - 0.1 } else { 0.75 };
        length(sub(line[1], place)) > near
            && (mass == from || distance(place, line) > ALONE)
            && sliders_of(mass, place).all(|mark| distance(mark, line) > ALONE)
            && sliders_of(to, line[1]).all(|mark| length(sub(mark, place)) > ALONE)
    };
    // Nor between two that are joined.
    let between = structure.links.iter().any(|link| {
        let place = |end: Option<usize>| others.iter().find(|(mass, _)| Some(*mass) == end);
        match link.ends.map(place) {
            [Some((_, a)), Some((_, b))] => distance(line[1], [*a, *b]) < ALONE,
            _ => false,
        }
    });
    !between && others.iter().all(clear_of)
}

/// Moves all a little at a time towards all wishes that are nearly met, if none come too close.
fn relax(wishes: &[Wish], places: &mut Vec<Point>) {
    let met = |wish: &Wish, places: &[Point]| {
        let between = sub(places[wish.pair[1]], places[wish.pair[0]]);
        let part = dot(between, wish.way) / length(between).max(1e-9);
        part > 0.5 && length(between) < 2.2
    };
    let kept: Vec<&Wish> = wishes.iter().filter(|wish| met(wish, places)).collect();
    let mut moved = places.clone();
    for _ in 0..300 {
        for wish in &kept {
            let [a, b] = wish.pair;
            let between = sub(moved[b], moved[a]);
            let right = dot(between, wish.way).max(wish.length);
            let error = sub(scaled(wish.way, right), between);
            // Longer lines are no harm where directions ask for them.
            let pull = 0.05 * (wish.length - right);
            let step = scaled(add(error, scaled(wish.way, pull)), 0.25);
            moved[a] = sub(moved[a], step);
            moved[b] = add(moved[b], step);
        }
    }
    let lines = |places: &[Point]| -> Vec<([usize; 2], [Point; 2])> {
        kept.iter().map(|wish| (wish.pair, wish.pair.map(|mass| places[mass]))).collect()
    };
    let lines = lines(&moved);
    let clear = (0..moved.len()).all(|a| {
        (0..a).all(|b| {
            let near = length(sub(places[a], places[b])).min(0.95);
            length(sub(moved[a], moved[b])) > near - 0.15
        }) && lines
            .iter()
            .all(|(pair, line)| pair.contains(&a) || distance(moved[a], *line) > ALONE)
    });
    if clear {
        *places = moved;
    }
}

/// Sets parts that nothing joins side by side, and in rows when these grow wide.
fn pack(parts: &[Vec<usize>], places: &mut [Point]) {
    let (mut x, mut top, mut low) = (0.0, 0.0, 0.0_f64);
    for part in parts {
        let range = |axis: usize, places: &[Point]| {
            part.iter()
                .map(|&mass| places[mass][axis])
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], value| {
                    [f64::min(from, value), f64::max(to, value)]
                })
        };
        let ([left, right], [bottom, upper]) = (range(0, places), range(1, places));
        if x > 0.0 && x + right - left > ROW {
            (x, top) = (0.0, low - BETWEEN_PARTS);
        }
        for &mass in part {
            places[mass] = add(places[mass], [x - left, top - upper]);
        }
        low = low.min(top - (upper - bottom));
        x += right - left + BETWEEN_PARTS;
    }
}

/// Does a segment keep off what it has nothing to do with?
pub(super) fn keeps_off(line: [Point; 2], others: &[[Point; 2]], gap: f64) -> bool {
    others.iter().all(|&other| apart(line, other) > gap)
}
