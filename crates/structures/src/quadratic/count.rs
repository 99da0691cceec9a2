//! The count of eigenvalues in a rectangle by the argument principle.

use super::analysis::Analysis;
use super::shifted::factorise;
use super::{Quadratic, Rectangle};
use amontons::Error;
use amontons_analysis::stability::parallel;
use amontons_analysis::watch::Watch;
use faer::c64;
use std::f64::consts::PI;

/// The largest change of the phase between neighbouring points, rad.
const STEP: f64 = PI / 3.0;
/// The largest difference of log g from its interpolation.
const MISMATCH: f64 = 0.3;
/// An interval is halved at most as often.
const HALVINGS: usize = 40;

/// The comparison of the eigenvalues that were found with those that there are.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    /// The edges along which the determinant was followed.
    pub edges: Rectangle,
    /// The least distance of an eigenvalue that was found from the edges.
    pub distance: f64,
    /// The number of eigenvalues that were found in the edges; if they touch the real axis, in them and their mirror image
    /// below it.
    pub found: usize,
    /// The result.
    pub outcome: Outcome,
    /// The number of factorisations.
    pub factorizations: usize,
}

/// The result of a count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All eigenvalues have been found.
    Complete,
    /// As many eigenvalues are missing; if the edges touch the real axis, both of a pair are counted.
    Missing(usize),
    /// As many of those found do not exist, or were found twice.
    Surplus(usize),
    /// The number could not be shown, for this reason.
    NotShown(String),
}

/// Counts the eigenvalues that are missing in a list.
///
/// P(λ) has as many eigenvalues in the edges as its determinant winds about 0 along them. Here the found ones, inside and
/// outside, are divided out: g(λ) = det P(λ) / ∏ (λ − λₖ), with the conjugates; so log g varies slowly and few points are
/// needed. An interval of an edge is accepted if log g, magnitude and phase, at its quarter points differs by less than 0.3
/// from the parabola through its ends and its middle, and if the phase changes by less than π/3 between neighbouring points.
/// Edges on the real axis are left out: the determinant is real there, and the rest is half of the way about the rectangle
/// and its mirror image.
///
/// `found` has imaginary parts of at least 0. The edges are [cleared](Rectangle::cleared) of it.
///
/// # Errors
/// Returns an error if the work has been ended.
pub fn count(
    problem: &Quadratic,
    rectangle: &Rectangle,
    found: &[c64],
    watch: Watch,
) -> Result<Count, Error> {
    let analysis = Analysis::new(problem)?;
    let (edges, distance) = rectangle.cleared(found);
    let mirrored = edges.imaginary()[0] == 0.0;
    let factor = |value: &&c64| if mirrored && value.im != 0.0 { 2 } else { 1 };
    let inside = found.iter().filter(|&&value| edges.contains(value));
    let mut path = Path { problem, analysis: &analysis, found, watch, factorizations: 0 };
    let mut corners = edges.corners().to_vec();
    if !mirrored {
        corners.push(corners[0]);
    }
    let outcome = match path.turn(&corners)? {
        Ok(turn) => {
            // Half of the turn about the rectangle and its mirror image is seen.
            let winding = turn / if mirrored { PI } else { 2.0 * PI };
            let number = winding.round();
            if (winding - number).abs() > 0.1 {
                Outcome::NotShown(format!(
                    "the phase of the determinant turns by {winding:.3} of a whole number"
                ))
            } else if number > 0.0 {
                Outcome::Missing(number as usize)
            } else if number < 0.0 {
                Outcome::Surplus(-number as usize)
            } else {
                Outcome::Complete
            }
        }
        Err(reason) => Outcome::NotShown(reason),
    };
    let found = inside.map(|value| factor(&value)).sum();
    Ok(Count { edges, distance, found, outcome, factorizations: path.factorizations })
}

/// A place with log g, whose imaginary part is known up to 2π.
#[derive(Clone, Copy)]
struct Point {
    place: c64,
    value: c64,
}

struct Path<'a> {
    problem: &'a Quadratic,
    analysis: &'a Analysis,
    found: &'a [c64],
    watch: Watch<'a>,
    factorizations: usize,
}

impl Path<'_> {
    /// The change of the phase of g along a line of corners, or the reason for which it is not known.
    fn turn(&mut self, corners: &[c64]) -> Result<Result<f64, String>, Error> {
        let points = match self.evaluate(corners)? {
            Ok(points) => points,
            Err(reason) => return Ok(Err(reason)),
        };
        let middles: Vec<c64> = corners.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect();
        let middles = match self.evaluate(&middles)? {
            Ok(points) => points,
            Err(reason) => return Ok(Err(reason)),
        };
        let mut intervals: Vec<[Point; 3]> = points
            .windows(2)
            .zip(middles)
            .map(|(ends, middle)| [ends[0], middle, ends[1]])
            .collect();
        let mut turn = 0.0;
        let all: f64 = corners.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
        for _ in 0..HALVINGS {
            if intervals.is_empty() {
                return Ok(Ok(turn));
            }
            let quarters: Vec<c64> = intervals
                .iter()
                .flat_map(|[first, middle, last]| {
                    [0.5 * (first.place + middle.place), 0.5 * (middle.place + last.place)]
                })
                .collect();
            let quarters = match self.evaluate(&quarters)? {
                Ok(points) => points,
                Err(reason) => return Ok(Err(reason)),
            };
            let mut next = vec![];
            for ([first, middle, last], quarters) in
                intervals.into_iter().zip(quarters.chunks_exact(2))
            {
                match smooth([first, quarters[0], middle, quarters[1], last]) {
                    Some(change) => turn += change,
                    None => {
                        next.push([first, quarters[0], middle]);
                        next.push([middle, quarters[1], last]);
                    }
                }
            }
            intervals = next;
            let left: f64 =
                intervals.iter().map(|[first, _, last]| (last.place - first.place).norm()).sum();
            (self.watch.progress)(1.0 - left / all);
        }
        let place = intervals[0][1].place;
        Ok(Err(format!("the determinant changes too fast near {place}")))
    }

    /// log g at places, or the reason for which one is not known.
    fn evaluate(&mut self, places: &[c64]) -> Result<Result<Vec<Point>, String>, Error> {
        let evaluate = |number: usize| {
            self.watch.check()?;
            let place = places[number];
            let determinant = match factorise(self.problem, self.analysis, place) {
                Ok(factors) => factors.determinant,
                Err(error) => return Ok(Err(error.to_string())),
            };
            let mut value = c64::new(determinant.log, determinant.phase);
            for &found in self.found {
                value -= (place - found).ln();
                if found.im != 0.0 {
                    value -= (place - found.conj()).ln();
                }
            }
            Ok(Ok(Point { place, value }))
        };
        let points = parallel::collect(places.len(), &evaluate, &|_| ())?;
        self.factorizations += places.len();
        Ok(points.into_iter().collect())
    }
}

/// The change of the phase along five equidistant points if log g is smooth there.
fn smooth(points: [Point; 5]) -> Option<f64> {
    let mut values = [c64::default(); 5];
    for step in 0..4 {
        let change = points[step + 1].value - points[step].value;
        let phase = change.im - 2.0 * PI * (change.im / (2.0 * PI)).round();
        if phase.abs() >= STEP {
            return None;
        }
        values[step + 1] = values[step] + c64::new(change.re, phase);
    }
    let [first, one, middle, three, last] = values;
    let mismatches = [
        (3.0 * first + 6.0 * middle - last) / 8.0 - one,
        (3.0 * last + 6.0 * middle - first) / 8.0 - three,
    ];
    // False for a value that is not a number.
    mismatches.iter().all(|mismatch| mismatch.norm() < MISMATCH).then_some(last.im)
}
