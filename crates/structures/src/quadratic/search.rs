//! The search for all eigenvalues in a rectangle.

use super::analysis::Analysis;
use super::arnoldi::{Pair, Wish};
use super::disc::{self, Disc};
use super::merge::Merged;
use super::shifted::Shifted;
use super::{Eigenvalues, Options, Quadratic, Rectangle, Trusted};
use amontons::Error;
use amontons_analysis::stability::parallel;
use amontons_analysis::watch::Watch;
use faer::c64;

/// A part of the rectangle is given up if it is smaller than this part of the whole.
const SMALLEST: f64 = 1e-9;
/// A shift at which P is singular is moved by this part of the wanted radius.
const STEP: f64 = 1e-3;

/// Looks for all eigenvalues in a rectangle.
///
/// Of each shift a disc is trusted, up to the farthest eigenvalue before the first one that has not converged. The discs
/// cover the rectangle, unless the options give the shifts. Start vectors are fixed, so results do not depend on the run or
/// the number of threads. [`count`](super::count) shows if one is missing.
///
/// Memory: each thread needs 2 × size × (dimension + 1) complex numbers beside the factors.
///
/// # Errors
/// Returns an error if the work has been ended, if P(λ) is singular for all λ, or if the rectangle cannot be covered.
pub fn eigenvalues(
    problem: &Quadratic,
    rectangle: &Rectangle,
    options: &Options,
    watch: Watch,
) -> Result<Eigenvalues, Error> {
    let analysis = Analysis::new(problem)?;
    let search = Search { problem, analysis: &analysis, options, watch };
    let mut discs = vec![];
    if options.shifts.is_empty() {
        search.cover(rectangle, &mut discs)?;
    } else {
        let (count, radius) = (options.shifts.len(), f64::INFINITY);
        discs = parallel::collect(
            count,
            &|number| search.look(options.shifts[number], radius, 0, &[]),
            &|done| (watch.progress)(done as f64 / count as f64),
        )?;
    }
    Ok(collected(rectangle, discs))
}

/// Looks once more with the same shifts for eigenvalues that were missed: from other start vectors, orthogonal to what is
/// known.
///
/// # Errors
/// Returns an error if the work has been ended, or if P(λ) cannot be factorised.
pub fn eigenvalues_again(
    problem: &Quadratic,
    found: &Eigenvalues,
    options: &Options,
    watch: Watch,
) -> Result<Eigenvalues, Error> {
    let analysis = Analysis::new(problem)?;
    let search = Search { problem, analysis: &analysis, options, watch };
    let count = found.trusted.len();
    let look = |number: usize| {
        let Trusted { centre, radius } = found.trusted[number];
        let known: Vec<Pair> = found
            .modes
            .iter()
            .filter(|mode| (mode.eigenvalue - centre).norm() <= radius)
            .map(|mode| Pair { eigenvalue: mode.eigenvalue, vector: mode.vector.clone() })
            .collect();
        search.look(centre, radius, 1000, &known)
    };
    let discs =
        parallel::collect(count, &look, &|done| (watch.progress)(done as f64 / count as f64))?;
    Ok(collected(&found.rectangle, discs))
}

/// The result of all discs.
fn collected(rectangle: &Rectangle, discs: Vec<Disc>) -> Eigenvalues {
    let trusted =
        discs.iter().map(|disc| Trusted { centre: disc.centre, radius: disc.radius }).collect();
    let rough = rough(rectangle, &discs);
    let factorizations = discs.len();
    let solves = discs.iter().map(|disc| disc.solves).sum();
    let mut merged = Merged::default();
    discs.into_iter().for_each(|disc| merged.add(disc));
    let modes = merged.finish();
    let values: Vec<c64> = modes.iter().map(|mode| mode.eigenvalue).collect();
    let (edges, _) = rectangle.cleared(&values);
    Eigenvalues { modes, rectangle: *rectangle, edges, rough, trusted, factorizations, solves }
}

/// Rough places of eigenvalues outside the rectangle and the discs, each from the shift that is nearest to it.
fn rough(rectangle: &Rectangle, discs: &[Disc]) -> Vec<c64> {
    let larger = rectangle.enlarged();
    let from = |disc: &Disc| -> Vec<c64> {
        let belongs = |place: &&c64| {
            let distance = (*place - disc.centre).norm();
            let other = |other: &Disc| {
                let away = (*place - other.centre).norm();
                away < distance || away <= other.radius
            };
            place.im > 0.0 && !larger.contains(**place) && !discs.iter().any(other)
        };
        disc.rough.iter().filter(belongs).copied().collect()
    };
    discs.iter().flat_map(from).collect()
}

struct Search<'a> {
    problem: &'a Quadratic,
    analysis: &'a Analysis,
    options: &'a Options,
    watch: Watch<'a>,
}

impl Search<'_> {
    /// Places shifts until their discs cover the rectangle and the places of its edges.
    fn cover(&self, rectangle: &Rectangle, discs: &mut Vec<Disc>) -> Result<(), Error> {
        let whole = rectangle.enlarged();
        let area = |part: &Rectangle| part.sides().into_iter().product::<f64>();
        let mut parts = vec![whole];
        let mut covered = 0.0;
        // All parts of a generation are looked at independently, so the result does not depend on the number of threads.
        while !parts.is_empty() {
            if let Some(part) =
                parts.iter().find(|part| part.sides()[0] < SMALLEST * whole.sides()[0])
            {
                return Err(Error::analysis(format!(
                    "no eigenvalue converges near {}; a larger dimension of the Krylov space may help",
                    part.centre()
                )));
            }
            let shares: Vec<f64> = parts.iter().map(|part| area(part) / area(&whole)).collect();
            let found = parallel::collect(
                parts.len(),
                &|number| {
                    let [width, height] = parts[number].sides();
                    // A little more than the half diagonal, so that a mode at a corner does not decide.
                    let radius = 0.5 * width.hypot(height) * (1.0 + 1e-6);
                    self.look(parts[number].centre(), radius, 0, &[])
                },
                &|done| {
                    (self.watch.progress)((covered + shares[..done].iter().sum::<f64>()).min(1.0))
                },
            )?;
            covered += shares.iter().sum::<f64>();
            let mut next = vec![];
            for (part, disc) in parts.iter().zip(&found) {
                next.extend(rest(part, disc));
            }
            discs.extend(found);
            next.retain(|part| !discs.iter().any(|disc| holds(disc, part)));
            covered -= next.iter().map(|part| area(part) / area(&whole)).sum::<f64>();
            parts = next;
        }
        Ok(())
    }

    /// Looks at the surroundings of a shift.
    fn look(&self, shift: c64, radius: f64, seed: u64, known: &[Pair]) -> Result<Disc, Error> {
        self.watch.check()?;
        let wish =
            Wish { transposed: false, radius, dimension: self.options.dimension, seed, known };
        let mut error = None;
        for step in 0..4 {
            let away = if radius.is_finite() { radius } else { shift.norm().max(1.0) };
            let moved = shift + c64::from_polar(f64::from(step) * STEP * away, f64::from(step));
            let scale = moved.norm().max(if radius.is_finite() { radius } else { 0.0 });
            match Shifted::new(self.problem, self.analysis, moved, scale) {
                Ok(shifted) => return disc::look(&shifted, &wish, self.options.bounds, self.watch),
                Err(fault) => error = Some(fault),
            }
        }
        Err(error.expect("there was a step"))
    }
}

/// `true` if a disc covers a part of the plane.
fn holds(disc: &Disc, part: &Rectangle) -> bool {
    part.corners().iter().all(|corner| (corner - disc.centre).norm() <= disc.radius)
}

/// The rest of a part about whose centre a disc is known, in pieces.
fn rest(part: &Rectangle, disc: &Disc) -> Vec<Rectangle> {
    if holds(disc, part) {
        return vec![];
    }
    let sides = part.sides();
    let axis = usize::from(sides[1] > sides[0]);
    let (length, half) = (sides[axis], 0.5 * sides[1 - axis]);
    let centre = part.centre();
    let away = (disc.centre - centre).norm();
    let radius = disc.radius - away;
    if radius <= 1.1 * half {
        return vec![part.slice(axis, 0.0, 0.5), part.slice(axis, 0.5, 1.0)];
    }
    let reach = (radius * radius - half * half).sqrt();
    let end = 0.5 - reach / length;
    // Neighbouring discs will be about as large.
    let pieces = (end * length / (1.8 * reach)).ceil().max(1.0) as usize;
    let piece = |number: usize| end * number as f64 / pieces as f64;
    (0..pieces)
        .flat_map(|number| {
            let (from, to) = (piece(number), piece(number + 1));
            [part.slice(axis, from, to), part.slice(axis, 1.0 - to, 1.0 - from)]
        })
        .collect()
}
