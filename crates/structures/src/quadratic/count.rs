//! The count of eigenvalues in a rectangle by the argument principle.

use super::analysis::Analysis;
use super::drift::Drift;
use super::factors::Factors;
use super::shifted::{factorise, norm};
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
/// Where an interval is looked at once more, as a part of it: 0.618 of the way to the first of its equidistant points.
const ASKEW: f64 = 0.618_033_988_75 / 4.0;
/// A place at which P cannot be factorised is moved by this part of the shorter side.
const ASIDE: f64 = 1e-5;
/// The shortest interval that is looked at, relative to the length of the edges.
const SHORTEST: f64 = 1e-9;

/// The most factorisations, to which [`MORE`] are added for each found eigenvalue: an interval is halved near each of those
/// next to an edge. Work that is not done by then grows without a bound, since rounding decides the determinant.
const MOST: usize = 2000;
const MORE: usize = 20;
/// The largest error of a solution with factors, relative to the solution, on the edges.
const FORWARD: f64 = 0.1;

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
/// outside, are divided out: g(λ) = det P(λ) / ∏ (λ − λₖ), with the conjugates; so is exp(q) with a polynomial q that fits
/// log |g|, which has no zeros. The rest varies slowly, and few points are needed. An interval of an edge is accepted if the
/// logarithm of the rest, magnitude and phase, at its quarter points differs by less than 0.3 from the parabola through its
/// ends and its middle, and if the phase changes by less than π/3 between neighbouring points; and if a point that is not equidistant
/// with the others agrees too.
/// Edges on the real axis are left out: the determinant is real there, and the rest is half of the way about the rectangle
/// and its mirror image.
///
/// `rough` are places outside the rectangle that are divided out as well. They need not be exact: a number outside the edges
/// does not change how often g winds about 0, but makes log g smoother.
///
/// `found` has imaginary parts of at least 0. The edges are [cleared](Rectangle::cleared) of it.
///
/// # Errors
/// Returns an error if the work has been ended.
pub fn count(
    problem: &Quadratic,
    rectangle: &Rectangle,
    found: &[c64],
    rough: &[c64],
    watch: Watch,
) -> Result<Count, Error> {
    let analysis = Analysis::new(problem)?;
    let (edges, distance) = rectangle.cleared(found);
    let mirrored = edges.imaginary()[0] == 0.0;
    let factor = |value: &&c64| if mirrored && value.im != 0.0 { 2 } else { 1 };
    let inside = found.iter().filter(|&&value| edges.contains(value));
    let divisors: Vec<c64> = found
        .iter()
        .copied()
        .chain(rough.iter().copied().filter(|&place| !rectangle.enlarged().contains(place)))
        .collect();
    let [width, height] = edges.sides();
    let mut path = Path {
        problem,
        analysis: &analysis,
        edges,
        mirrored,
        step: (ASIDE * width.min(height)).min(0.1 * distance),
        divisors: &divisors,
        watch,
        factorizations: 0,
    };
    let mut corners = edges.corners().to_vec();
    if !mirrored {
        corners.push(corners[0]);
    }
    let outcome = match path.turn(&corners) {
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
        Err(Stop::Reason(reason)) => Outcome::NotShown(reason),
        Err(Stop::Ended(error)) => return Err(error),
    };
    let found = inside.map(|value| factor(&value)).sum();
    Ok(Count { edges, distance, found, outcome, factorizations: path.factorizations })
}

/// A place with log g, whose imaginary part is known up to 2π.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) place: c64,
    pub(super) value: c64,
}

/// The place in the middle of two.
fn middle(a: Point, b: Point) -> c64 {
    0.5 * (a.place + b.place)
}

struct Path<'a> {
    problem: &'a Quadratic,
    analysis: &'a Analysis,
    edges: Rectangle,
    /// `true` if the edges touch the real axis.
    mirrored: bool,
    /// The distance by which a place is moved at which P cannot be factorised.
    step: f64,
    /// The numbers that are divided out with their conjugates.
    divisors: &'a [c64],
    watch: Watch<'a>,
    factorizations: usize,
}

impl Path<'_> {
    /// The change of the phase of g along a line of corners.
    fn turn(&mut self, corners: &[c64]) -> Result<f64, Stop> {
        let ends = self.evaluate(corners)?;
        let middles: Vec<c64> = ends.windows(2).map(|ends| middle(ends[0], ends[1])).collect();
        let middles = self.evaluate(&middles)?;
        let mut known: Vec<Point> = ends.iter().chain(&middles).copied().collect();
        let halves =
            ends.windows(2).zip(middles).map(|(ends, middle)| [ends[0], middle, ends[1]]).collect();
        let mut open = self.with_quarters(halves, &mut known)?;
        let length = |points: &[Point; 5]| (points[4].place - points[0].place).norm();
        let all: f64 = open.iter().map(length).sum();
        let mut turn = 0.0;
        loop {
            let drift = self.drift(&known);
            let (smooth, rough): (Vec<_>, Vec<_>) = open
                .into_iter()
                .map(|points| (points, Smooth::new(points, &drift)))
                .partition(|(_, smooth)| smooth.is_some());
            open = rough.into_iter().map(|(points, _)| points).collect();
            let place =
                |points: &[Point; 5]| points[0].place + ASKEW * (points[4].place - points[0].place);
            let places: Vec<c64> = smooth.iter().map(|(points, _)| place(points)).collect();
            let askew = self.evaluate(&places)?;
            known.extend(&askew);
            for ((points, smooth), point) in smooth.into_iter().zip(askew) {
                match smooth {
                    Some(smooth) if smooth.agrees(points[0], point, &drift) => {
                        turn += smooth.change;
                    }
                    _ => open.push(points),
                }
            }
            (self.watch.progress)(1.0 - open.iter().map(length).sum::<f64>() / all);
            let longest = open.iter().map(length).fold(0.0, f64::max);
            if longest == 0.0 {
                return Ok(turn);
            }
            if longest < SHORTEST * all {
                let place = open[0][2].place;
                return Err(Stop::Reason(format!("the determinant changes too fast near {place}")));
            }
            // The points of long intervals make the smooth part better known, which may do for the others.
            let (long, rest): (Vec<_>, Vec<_>) =
                open.into_iter().partition(|points| length(points) > 0.5 * longest);
            let halves =
                long.into_iter().flat_map(|[a, b, c, d, e]| [[a, b, c], [c, d, e]]).collect();
            open = rest;
            open.extend(self.with_quarters(halves, &mut known)?);
        }
    }

    /// Puts points in the middles between the points of intervals.
    fn with_quarters(
        &mut self,
        halves: Vec<[Point; 3]>,
        known: &mut Vec<Point>,
    ) -> Result<Vec<[Point; 5]>, Stop> {
        let places: Vec<c64> =
            halves.iter().flat_map(|&[a, b, c]| [middle(a, b), middle(b, c)]).collect();
        let quarters = self.evaluate(&places)?;
        known.extend(&quarters);
        let intervals = halves.into_iter().zip(quarters.chunks_exact(2));
        Ok(intervals.map(|([a, b, c], new)| [a, new[0], b, new[1], c]).collect())
    }

    /// The smooth part of log g on the edges.
    fn drift(&self, known: &[Point]) -> Drift {
        let mut centre = self.edges.centre();
        if self.mirrored {
            centre.im = 0.0;
        }
        let corners = self.edges.corners();
        let radius = corners.iter().map(|corner| (corner - centre).norm()).fold(0.0, f64::max);
        Drift::fit(known, centre, radius, self.mirrored)
    }

    /// log g at places.
    fn evaluate(&mut self, places: &[c64]) -> Result<Vec<Point>, Stop> {
        let most = MOST + MORE * self.divisors.len();
        if self.factorizations + places.len() > most {
            let edge = places[0];
            return Err(Stop::Reason(format!(
                "more than {most} factorizations are needed to follow the determinant, last near {edge}"
            )));
        }
        let evaluate = |number: usize| {
            self.watch.check()?;
            // A block in the order of elimination may be singular at a place; next to it, it is not.
            let mut place = places[number];
            let mut factors = factorise(self.problem, self.analysis, place);
            for attempt in 1..4 {
                if factors.is_err() {
                    let angle = f64::from(attempt);
                    place = places[number] + c64::from_polar(angle * self.step, angle);
                    factors = factorise(self.problem, self.analysis, place);
                }
            }
            let determinant = match factors {
                Ok(factors) => {
                    let forward = forward(self.problem, &factors, place);
                    if forward.is_nan() || forward > FORWARD {
                        return Ok(Err(Stop::Reason(format!(
                            "rounding of the matrices moves eigenvalues as far as the edges: solutions at {place} have an error of {forward:.1e}"
                        ))));
                    }
                    factors.determinant
                }
                Err(error) => return Ok(Err(Stop::Reason(error.to_string()))),
            };
            let mut value = c64::new(determinant.log, determinant.phase);
            for &divisor in self.divisors {
                value -= (place - divisor).ln();
                if divisor.im != 0.0 {
                    value -= (place - divisor.conj()).ln();
                }
            }
            Ok(Ok(Point { place, value }))
        };
        let points = parallel::collect(places.len(), &evaluate, &|_| ()).map_err(Stop::Ended)?;
        self.factorizations += places.len();
        points.into_iter().collect()
    }
}

/// The error of a solution with factors whose exact value is known, relative to it: how much rounding changes P⁻¹.
fn forward(problem: &Quadratic, factors: &Factors, lambda: c64) -> f64 {
    let exact = crate::random::vector(2, problem.size());
    let mut x = problem.apply(lambda, false, &exact);
    factors.solve(false, &mut x);
    x.iter_mut().zip(&exact).for_each(|(x, exact)| *x -= exact);
    norm(&x) / norm(&exact)
}

/// The reason for which a count ends early.
#[derive(Clone)]
enum Stop {
    /// The work has been ended.
    Ended(Error),
    /// The number cannot be shown.
    Reason(String),
}

/// log g without its smooth part along five equidistant points, where it changes little.
struct Smooth {
    /// The values at the first point, the middle and the last, from that of the first on.
    values: [c64; 3],
    /// The change of the phase of g.
    change: f64,
}

impl Smooth {
    fn new(points: [Point; 5], drift: &Drift) -> Option<Self> {
        let drifts = points.map(|point| drift.at(point.place));
        let mut values = [c64::default(); 5];
        for step in 0..4 {
            let change =
                (points[step + 1].value - drifts[step + 1]) - (points[step].value - drifts[step]);
            let phase = near(change.im);
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
        let is_smooth = mismatches.iter().all(|mismatch| mismatch.norm() < MISMATCH);
        let change = last.im + (drifts[4] - drifts[0]).im;
        is_smooth.then_some(Self { values: [first, middle, last], change })
    }

    /// `true` if the value at the point [`ASKEW`] is that of the parabola too. A phase that turns by 2π from each point to the next
    /// is not seen in equidistant points; here it is.
    fn agrees(&self, start: Point, point: Point, drift: &Drift) -> bool {
        let [first, middle, last] = self.values;
        let t = ASKEW;
        let expected = (1.0 - t) * (1.0 - 2.0 * t) * first
            + 4.0 * t * (1.0 - t) * middle
            + t * (2.0 * t - 1.0) * last;
        let value = (point.value - drift.at(point.place)) - (start.value - drift.at(start.place));
        let mismatch = value - expected;
        c64::new(mismatch.re, near(mismatch.im)).norm() < MISMATCH
    }
}

/// A phase without the nearest multiple of 2π.
fn near(phase: f64) -> f64 {
    phase - 2.0 * PI * (phase / (2.0 * PI)).round()
}
