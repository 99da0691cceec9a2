//! Straight pieces of a curve.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

/// The straight line of least squares through points (x, y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    pub(super) slope: f64,
    /// The middle of the points, through which the line goes.
    pub(super) middle: [f64; 2],
    /// Distance of the farthest point from the line, along y.
    pub(super) apart: f64,
}

impl Fit {
    /// The line through points with at least two different x.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn of(points: &[[f64; 2]]) -> Self {
        let count = points.len() as f64;
        let [x, y] = points.iter().fold([0.0, 0.0], |[x, y], point| [x + point[0], y + point[1]]);
        let middle = [x / count, y / count];
        let (mut square, mut product) = (0.0, 0.0);
        for [x, y] in points {
            square += (x - middle[0]) * (x - middle[0]);
            product += (x - middle[0]) * (y - middle[1]);
        }
        let mut fit = Self { slope: product / square, middle, apart: 0.0 };
        fit.apart = points.iter().fold(0.0, |most, [x, y]| f64::max(most, (y - fit.at(*x)).abs()));
        fit
    }

    pub(super) fn at(&self, x: f64) -> f64 {
        self.middle[1] + self.slope * (x - self.middle[0])
    }

    /// Bound on the error of the slope if no point is farther from the true line than from this one: points all above
    /// it on one half and all below it on the other, by r over the length L, would turn it by 3 r / L.
    pub(super) fn slope_error(&self, length: f64) -> f64 {
        3.0 * self.apart / length
    }
}

/// Parts a curve into the fewest pieces, about, that are straight to within `apart` along y. Neighbours are merged
/// in the order in which they fit best; a piece has two points at least, but for an odd one at the end.
pub(super) fn pieces(points: &[[f64; 2]], apart: f64) -> Vec<Range<usize>> {
    let count = points.len();
    let mut found: Vec<Option<Range<usize>>> =
        (0..count).step_by(2).map(|from| Some(from..(from + 2).min(count))).collect();
    let mut before: Vec<Option<usize>> =
        (0..found.len()).map(|place| place.checked_sub(1)).collect();
    let mut after: Vec<Option<usize>> =
        (1..=found.len()).map(|place| (place < found.len()).then_some(place)).collect();
    // Costs are not negative, so their bits are in their order; of equal ones the last goes first.
    let mut costs = BinaryHeap::new();
    let cost = |left: &Range<usize>, right: &Range<usize>| {
        let apart = Fit::of(&points[left.start..right.end]).apart;
        Reverse((apart.to_bits(), Reverse(left.start), right.end))
    };
    for two in found.windows(2) {
        let [Some(left), Some(right)] = two else { continue };
        costs.push(cost(left, right));
    }
    while let Some(Reverse((bits, Reverse(start), end))) = costs.pop() {
        if f64::from_bits(bits) > apart {
            break;
        }
        let place = start / 2;
        let Some(right_place) = after[place] else { continue };
        // Either may have grown since.
        let (Some(left), Some(right)) = (&found[place], &found[right_place]) else { continue };
        if right.end != end {
            continue;
        }
        let merged = left.start..right.end;
        found[right_place] = None;
        after[place] = after[right_place];
        if let Some(next) = after[place] {
            before[next] = Some(place);
            costs.extend(found[next].iter().map(|next| cost(&merged, next)));
        }
        if let Some(last) = before[place] {
            costs.extend(found[last].iter().map(|last| cost(last, &merged)));
        }
        found[place] = Some(merged);
    }
    found.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_line_is_parted_at_its_bends() {
        let bent = |x: f64| if x < 4.0 { 2.0 * x } else { 8.0 - 0.5 * (x - 4.0).min(3.0) };
        let wiggle = |i: i32| if i % 2 == 0 { 0.01 } else { -0.01 };
        let points: Vec<[f64; 2]> =
            (0..100).map(|i| [0.1 * f64::from(i), bent(0.1 * f64::from(i)) + wiggle(i)]).collect();
        let found = pieces(&points, 0.1);
        let ends: Vec<usize> = found.iter().map(|piece| piece.end).collect();
        assert_eq!(found.len(), 3, "{found:?}");
        for (end, bend) in ends.iter().zip([40, 70, 100]) {
            assert!(end.abs_diff(bend) <= 3, "{ends:?}");
        }
        let first = Fit::of(&points[..39]);
        assert!((first.slope - 2.0).abs() <= first.slope_error(3.8) && first.apart < 0.011);
        assert_eq!(pieces(&[], 0.1), []);
        let single = pieces(&[[0.0, 1.0]], 0.1);
        assert_eq!((single.len(), single[0].clone()), (1, 0..1));
    }
}
