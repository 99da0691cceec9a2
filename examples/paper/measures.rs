//! Measures of a motion on which verdicts are based. Each is a plain function of recorded data.

use amontons_analysis::spectral::{demodulate, lines};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Half of the range of the values in each piece of `rows` rows.
pub fn half_ranges(history: &[f64], rows: usize) -> Vec<f64> {
    let half = |piece: &[f64]| {
        let least = piece.iter().copied().fold(f64::INFINITY, f64::min);
        let most = piece.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        0.5 * (most - least)
    };
    history.chunks_exact(rows).map(half).collect()
}

/// Largest deviation of values from their mean, as part of the mean; infinite unless the mean is positive.
pub fn spread(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let part = values.iter().map(|value| (value - mean).abs() / mean).fold(0.0, f64::max);
    if mean > 0.0 { part } else { f64::INFINITY }
}

/// Index of the first of `count` successive values that deviate from their mean by no more than the part `part`.
pub fn first_plateau(values: &[f64], count: usize, part: f64) -> Option<usize> {
    values.windows(count).position(|window| spread(window) <= part)
}

/// The slope of the line through points, and the largest distance of a point from it.
pub fn straight(points: &[[f64; 2]]) -> Option<(f64, f64)> {
    if points.len() < 3 {
        return None;
    }
    let found = broken_line(points, &[])?;
    Some((found.coefficients[1], found.worst))
}

/// A line broken at knots.
struct Broken {
    /// The value at 0, the first slope, and the change of the slope at each knot.
    coefficients: Vec<f64>,
    /// The sum of the squares of the points' distances from it.
    squares: f64,
    /// The largest of the distances.
    worst: f64,
}

/// The line broken at the `knots` that fits the points best by least squares; `None` if it is not determined.
fn broken_line(points: &[[f64; 2]], knots: &[f64]) -> Option<Broken> {
    let base = |x: f64, column: usize| match column {
        0 => 1.0,
        1 => x,
        _ => (x - knots[column - 2]).max(0.0),
    };
    let matrix =
        DMatrix::from_fn(points.len(), 2 + knots.len(), |row, column| base(points[row][0], column));
    let values = DVector::from_iterator(points.len(), points.iter().map(|point| point[1]));
    let found = matrix.clone().svd(true, true).solve(&values, 1e-12).ok()?;
    let left = &matrix * &found - values;
    let coefficients = found.iter().copied().collect();
    let broken = Broken { coefficients, squares: left.norm_squared(), worst: left.amax() };
    broken.squares.is_finite().then_some(broken)
}

/// Three straight pieces through points.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreePieces {
    /// The positions at which the slope changes.
    pub knots: [f64; 2],
    /// The slopes from left to right.
    pub slopes: [f64; 3],
    /// Largest distance of a point from the three pieces.
    pub worst: f64,
    /// Largest distance of a point from the best two pieces.
    pub worst_of_two: f64,
}

/// Fits three pieces to points by least squares, with knots at the points or midway between neighbours.
pub fn three_pieces(points: &[[f64; 2]]) -> Option<ThreePieces> {
    // Each piece has two points or more.
    let mut places = Vec::new();
    for pair in points.windows(2).skip(1).take(points.len().saturating_sub(3)) {
        places.extend([pair[0][0], 0.5 * (pair[0][0] + pair[1][0])]);
    }
    let nearest = |all: Vec<Vec<f64>>| {
        let fits = all.into_iter().filter_map(|knots| Some((broken_line(points, &knots)?, knots)));
        fits.min_by(|a, b| a.0.squares.total_cmp(&b.0.squares))
    };
    let are_apart = |from: f64, to: f64| {
        points.iter().filter(|point| from <= point[0] && point[0] <= to).count() >= 2
    };
    let pairs = (0..places.len()).flat_map(|i| (i + 1..places.len()).map(move |j| (i, j)));
    let pairs = pairs.map(|(i, j)| vec![places[i], places[j]]);
    let pairs = pairs.filter(|knots| are_apart(knots[0], knots[1]));
    let (three, knots) = nearest(pairs.collect())?;
    let (two, _) = nearest(places.iter().map(|&place| vec![place]).collect())?;
    let c = &three.coefficients;
    let slopes = [c[1], c[1] + c[2], c[1] + c[2] + c[3]];
    let knots = [knots[0], knots[1]];
    Some(ThreePieces { knots, slopes, worst: three.worst, worst_of_two: two.worst })
}

/// The growth of one line of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// Growth rate, 1/s.
    pub rate: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Largest distance of the logarithm of the amplitude from a straight line.
    pub bend: f64,
    /// First and last amplitude.
    pub amplitude: [f64; 2],
}

/// The growth of the line near a frequency (Hz) in a history in steps of `interval` (s), seen through windows of
/// `window` s, a quarter of it apart. `None` for a history of less than two windows, and for one that does not move.
pub fn growth(history: &[f64], interval: f64, frequency: f64, window: f64) -> Option<Growth> {
    let count = (window / interval).round() as usize;
    let hop = count / 4;
    if history.len() < 2 * count || hop == 0 {
        return None;
    }
    let found = demodulate(history, interval, frequency, count, hop);
    if found.iter().any(|phasor| phasor.amplitude.is_nan() || phasor.amplitude <= 0.0) {
        return None;
    }
    let time = |place: usize| place as f64 * hop as f64 * interval;
    let mut turned = 0.0;
    let mut phases = vec![[0.0, 0.0]];
    for (place, pair) in found.windows(2).enumerate() {
        let step = (pair[1].phase - pair[0].phase) / TAU;
        turned += step - step.round();
        phases.push([time(place + 1), turned]);
    }
    let logarithms: Vec<[f64; 2]> =
        found.iter().enumerate().map(|(place, p)| [time(place), p.amplitude.ln()]).collect();
    let (rate, bend) = straight(&logarithms)?;
    let (offset, _) = straight(&phases)?;
    let amplitude = [found[0].amplitude, found[found.len() - 1].amplitude];
    Some(Growth { rate, frequency: frequency + offset, bend, amplitude })
}

/// The frequency (Hz) of the strongest line of a history between two frequencies; `None` where there is no line.
pub fn strongest(history: &[f64], interval: f64, between: [f64; 2]) -> Option<f64> {
    let found = lines(history, interval, 1e-4).lines;
    let mut inside =
        found.iter().filter(|line| between[0] <= line.frequency && line.frequency <= between[1]);
    inside.next().map(|line| line.frequency)
}

/// A stretch of rows in which one contact sticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stuck {
    from: usize,
    to: usize,
    contact: usize,
}

/// The sticking of contacts by turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turns {
    /// Number of times that any contact sticks.
    pub count: usize,
    /// Number of times that the same contact sticks again before another one has.
    pub repeated: usize,
    /// Number of rows in which more than one contact sticks.
    pub together: usize,
}

/// Evaluates the turns of sticking; `rows` holds `true` for each contact that sticks in a row.
pub fn turns(rows: &[[bool; 2]]) -> Turns {
    let mut all = Vec::new();
    for contact in 0..2 {
        let mut from = 0;
        for piece in rows.chunk_by(|a, b| a[contact] == b[contact]) {
            let to = from + piece.len();
            if piece[0][contact] {
                all.push(Stuck { from, to, contact });
            }
            from = to;
        }
    }
    all.sort_by_key(|stuck| (stuck.from, stuck.to));
    Turns {
        count: all.len(),
        repeated: all.windows(2).filter(|pair| pair[0].contact == pair[1].contact).count(),
        together: rows.iter().filter(|row| row[0] && row[1]).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plateau_begins_where_values_stay() {
        let rising: Vec<f64> = (0..50).map(|i| (0.1 * f64::from(i)).exp().min(20.0)).collect();
        // ln 20 = 2.996; 5 % of a mean near 20 is reached half a step before.
        assert_eq!(first_plateau(&rising, 10, 0.05), Some(30));
        assert_eq!(first_plateau(&rising[..30], 10, 0.05), None);
        assert_eq!(first_plateau(&[0.0; 20], 10, 0.05), None);
    }

    #[test]
    fn three_pieces_are_found_where_they_are_and_not_where_there_are_two() {
        let broken = |x: f64| 3.0 * x - 2.0 * (x - 0.1).max(0.0) - (x - 0.2).max(0.0);
        let points = |value: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> {
            (1..=40).map(|i| 0.01 * f64::from(i)).map(|x| [x, value(x)]).collect()
        };
        let found = three_pieces(&points(&broken)).unwrap();
        for (found, expected) in found.knots.iter().zip([0.1, 0.2]) {
            assert!((found - expected).abs() < 1e-9, "{found}");
        }
        for (found, expected) in found.slopes.iter().zip([3.0, 1.0, 0.0]) {
            assert!((found - expected).abs() < 1e-9, "{found}");
        }
        assert!(found.worst < 1e-12 && found.worst_of_two > 0.01);
        let two = three_pieces(&points(&|x| 3.0 * x - 2.0 * (x - 0.1).max(0.0))).unwrap();
        assert!(two.worst_of_two < 1e-12);
    }

    #[test]
    fn growth_has_the_rate_and_frequency_that_were_put_in() {
        let dt = 1e-4;
        let value = |i: i32| {
            let t = dt * f64::from(i);
            1e-6 * (2.6 * t).exp() * (TAU * 169.38 * t).cos() + 1e-4 * (TAU * 218.6 * t).sin()
        };
        let history: Vec<f64> = (0..20_000).map(value).collect();
        let found = growth(&history, dt, 169.0, 0.1).unwrap();
        assert!((found.rate - 2.6).abs() < 0.02, "{found:?}");
        assert!((found.frequency - 169.38).abs() < 0.01, "{found:?}");
        assert!(found.bend < 0.02, "{found:?}");
        assert_eq!(growth(&[0.0; 20_000], dt, 169.0, 0.1), None);
        assert_eq!(growth(&history[..100], dt, 169.0, 0.1), None);
        assert!((strongest(&history, dt, [160.0, 190.0]).unwrap() - 169.38).abs() < 0.5);
        assert_eq!(strongest(&history, dt, [300.0, 400.0]), None);
    }

    #[test]
    fn turns_are_counted_and_so_is_what_is_none() {
        let rows = |text: &str| -> Vec<[bool; 2]> {
            text.chars().map(|c| [c == '1' || c == 'b', c == '2' || c == 'b']).collect()
        };
        assert_eq!(turns(&rows(".11..2.11.22")), Turns { count: 4, repeated: 0, together: 0 });
        assert_eq!(turns(&rows(".11..1.11.22")), Turns { count: 4, repeated: 2, together: 0 });
        assert_eq!(turns(&rows(".11b22")), Turns { count: 2, repeated: 0, together: 1 });
        assert_eq!(turns(&rows("......")), Turns::default());
    }
}
