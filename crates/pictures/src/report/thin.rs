//! Points that can be told apart: what a curve of many points needs to look the same.

use crate::picture::{Series, Style};
use amontons::decimal::to_significant;
use amontons::numerics::range;

/// Parts of the x axis of which a curve keeps its lowest and its highest point. A screen has fewer columns.
const BINS: f64 = 2000.0;
/// Points that a curve without an order, or dots, may have.
const LIMIT: usize = 4000;

type Position = [f64; 2];

/// The places of the points to keep, in their order. Points with labels all stay.
pub(super) fn kept(series: &Series, logarithmic: bool) -> Vec<usize> {
    let count = series.points.len();
    if count <= LIMIT || !series.labels.is_empty() {
        return (0..count).collect();
    }
    let points = Scaled::new(&series.points, logarithmic);
    match series.style {
        Style::Dots => points.coarsest_needed(Scaled::one_in_each_cell),
        _ if is_ascending(&series.points) => points.lowest_and_highest(BINS),
        _ => points.coarsest_needed(Scaled::apart),
    }
}

/// The lowest and the highest point in each of `bins` parts of the x axis, of points along x, to seven digits.
pub fn envelope(points: &[Position], bins: f64) -> Vec<Position> {
    let kept = Scaled::new(points, false).lowest_and_highest(bins);
    kept.into_iter().map(|place| points[place].map(rounded)).collect()
}

/// Up to `most` of `count` places, from 0: evenly apart, with the first and, of two or more, the last; ascending.
#[must_use]
pub fn evenly_spaced(count: usize, most: usize) -> Vec<usize> {
    let kept = most.min(count);
    (0..kept).map(|place| place * (count - 1) / (kept - 1).max(1)).collect()
}

/// `true` if x never goes back.
pub(super) fn is_ascending(points: &[Position]) -> bool {
    let mut finite = points.iter().map(|[x, _]| *x).filter(|x| x.is_finite());
    let mut before = f64::NEG_INFINITY;
    finite.all(|x| std::mem::replace(&mut before, x) <= x)
}

/// A value to seven significant digits; a value that is not finite is unchanged.
pub(super) fn rounded(value: f64) -> f64 {
    to_significant(value, 7)
}

/// Points as parts of the ranges that they span, on the axes that show them.
struct Scaled {
    points: Vec<Position>,
}

impl Scaled {
    fn new(points: &[Position], logarithmic: bool) -> Self {
        let scale = |value: f64| if logarithmic { value.log10() } else { value };
        let mut points: Vec<Position> = points.iter().map(|point| point.map(scale)).collect();
        for axis in [0, 1] {
            let values = points.iter().map(|point| point[axis]);
            let [low, high] = range(values.filter(|value| value.is_finite()));
            let span = if high > low { high - low } else { 1.0 };
            points.iter_mut().for_each(|point| point[axis] = (point[axis] - low) / span);
        }
        Self { points }
    }

    fn is_gap(&self, place: usize) -> bool {
        self.points[place].iter().any(|value| !value.is_finite())
    }

    /// The lowest and the highest point of each part of the x axis and, if the curve breaks there, the break.
    fn lowest_and_highest(&self, bins: f64) -> Vec<usize> {
        let mut kept = Vec::new();
        let mut part = Part::default();
        let mut current = 0.0;
        for (place, &[x, y]) in self.points.iter().enumerate() {
            if self.is_gap(place) {
                part.gap = Some(place);
                continue;
            }
            let bin = (x * bins).floor();
            if bin > current {
                std::mem::take(&mut part).keep(&mut kept);
                current = bin;
            }
            part.add(place, y);
        }
        part.keep(&mut kept);
        // The ends show how far the curve goes.
        for end in [0, self.points.len() - 1] {
            if let Err(at) = kept.binary_search(&end) {
                kept.insert(at, end);
            }
        }
        kept
    }

    /// The points that a way of thinning keeps with the finest distance that leaves no more points than the limit.
    fn coarsest_needed(&self, thin: fn(&Self, f64) -> Vec<usize>) -> Vec<usize> {
        let mut distance = 1.0 / 4000.0;
        loop {
            let kept = thin(self, distance);
            if kept.len() <= LIMIT {
                return kept;
            }
            distance *= 1.25;
        }
    }

    /// Points along a curve that are at least this far from the one kept before, its last one, and one for each gap.
    fn apart(&self, distance: f64) -> Vec<usize> {
        let mut kept: Vec<usize> = Vec::new();
        for place in 0..self.points.len() {
            let far = kept.last().is_none_or(|&before| {
                match [self.is_gap(before), self.is_gap(place)] {
                    [true, true] => false,
                    [false, false] => {
                        let [[x, y], [to_x, to_y]] = [self.points[before], self.points[place]];
                        (to_x - x).hypot(to_y - y) >= distance
                    }
                    // A break that is hardly longer than nothing would not be seen.
                    _ => true,
                }
            });
            if far {
                kept.push(place);
            }
        }
        kept
    }

    /// The first point in each cell of a grid.
    fn one_in_each_cell(&self, size: f64) -> Vec<usize> {
        let mut taken = std::collections::BTreeSet::new();
        let finite = (0..self.points.len()).filter(|&place| !self.is_gap(place));
        #[allow(clippy::cast_possible_truncation)]
        let cell = |place: usize| self.points[place].map(|value| (value / size) as i64);
        finite.filter(|&place| taken.insert(cell(place))).collect()
    }
}

/// The lowest and highest point and the gap of a part of the x axis.
#[derive(Default)]
struct Part {
    /// Place and value.
    low: Option<(usize, f64)>,
    high: Option<(usize, f64)>,
    gap: Option<usize>,
}

impl Part {
    fn add(&mut self, place: usize, y: f64) {
        if self.low.is_none_or(|(_, low)| y < low) {
            self.low = Some((place, y));
        }
        if self.high.is_none_or(|(_, high)| y > high) {
            self.high = Some((place, y));
        }
    }

    fn keep(self, kept: &mut Vec<usize>) {
        let mut places: Vec<usize> =
            [self.low, self.high].into_iter().flatten().map(|(place, _)| place).collect();
        places.extend(self.gap);
        places.sort_unstable();
        places.dedup();
        kept.extend(places);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_taken_from_the_first_to_the_last() {
        assert_eq!(evenly_spaced(3, 50), [0, 1, 2]);
        assert_eq!(evenly_spaced(101, 3), [0, 50, 100]);
        assert!(evenly_spaced(0, 50).is_empty());
        assert_eq!(evenly_spaced(7, 1), [0]);
    }

    fn series(points: Vec<Position>, style: Style) -> Series {
        Series { points, style, ..Series::default() }
    }

    #[test]
    fn a_single_peak_among_a_hundred_thousand_points_stays() {
        let points = (0..100_000).map(|i| [f64::from(i), if i == 61_803 { 7.0 } else { 0.0 }]);
        let series = series(points.collect(), Style::Line);
        let kept = kept(&series, false);
        assert!(kept.len() <= 4002, "{}", kept.len());
        assert!(kept.contains(&61_803));
        assert!(kept.is_sorted());
        assert_eq!([kept[0], kept[kept.len() - 1]], [0, 99_999]);
    }

    #[test]
    fn a_gap_stays_a_gap() {
        let points = (0..50_000).map(|i| [f64::from(i), if i == 700 { f64::NAN } else { 1.0 }]);
        let series = series(points.collect(), Style::Line);
        let kept = kept(&series, false);
        assert_eq!(kept.iter().filter(|&&place| place == 700).count(), 1);
    }

    #[test]
    fn an_orbit_of_many_turns_keeps_its_form() {
        let angle = |i: i32| f64::from(i) * 0.01;
        let points = (0..90_000).map(|i| [angle(i).cos(), angle(i).sin()]);
        let series = series(points.collect(), Style::Line);
        let kept = kept(&series, false);
        assert!(kept.len() <= LIMIT);
        for quarter in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
            let near = kept.iter().map(|&place| {
                let [x, y] = series.points[place];
                (x - quarter[0]).hypot(y - quarter[1])
            });
            assert!(near.fold(f64::INFINITY, f64::min) < 0.1, "{quarter:?}");
        }
    }

    #[test]
    fn dots_keep_their_extent_and_labelled_points_stay_all() {
        let points: Vec<Position> =
            (0..60_000).map(|i| [f64::from(i % 1000), f64::from(i / 1000)]).collect();
        let mut dots = series(points, Style::Dots);
        let kept = kept(&dots, false);
        assert!((1000..=LIMIT).contains(&kept.len()), "{}", kept.len());
        dots.labels = vec![String::new(); dots.points.len()];
        assert_eq!(super::kept(&dots, false).len(), 60_000);
    }
}
