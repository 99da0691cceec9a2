//! The search for all eigenvalues in a rectangle.

use super::analysis::Analysis;
use super::arnoldi::{Pair, Wish};
use super::disc::{self, Disc};
use super::merge::Merged;
use super::shifted::Shifted;
use super::{Eigenvalues, Mode, Options, Quadratic, Rectangle, Trusted};
use amontons::Error;
use amontons_analysis::stability::parallel;
use amontons_analysis::watch::Watch;
use faer::c64;

/// The choice of start vectors of a second look, none of which the first can have come to.
const SECOND: u64 = 1 << 32;
/// A chosen shift is so far from a rough place of an eigenvalue, relative to the distance of the shift that showed it.
const ASIDE: f64 = 0.02;
/// A rough place counts as real if its imaginary part is as small, relative to its distance from the shift.
const ROUGH: f64 = 0.01;
/// After as many generations of shifts without new modes, what is left of the rough places does not converge.
const IDLE: usize = 5;
/// The part of the diagonal of the rectangle within which no second shift is placed.
const CLOSEST: f64 = 1e-6;
/// A shift at which P is singular, or which hides eigenvalues, is moved by this part of the wanted radius.
const STEP: f64 = 1e-3;

/// Looks for all eigenvalues in a rectangle.
///
/// Of each shift a disc is trusted, up to the farthest eigenvalue before the first one that has not converged. Unless the
/// options give the shifts, the first one is the centre of the rectangle, and others follow where Ritz values that have not
/// converged tell eigenvalues in the rectangle, until all of them are in discs. Discs need not cover parts without
/// eigenvalues: [`count`](super::count) shows if one is missing. Start vectors are fixed, so results do not depend on the run
/// or the number of threads.
///
/// Memory: each thread needs 2 × size × (dimension + 1) complex numbers beside the factors.
///
/// # Errors
/// Returns an error if the work has been ended or if P(λ) is singular for all λ.
pub fn eigenvalues(
    problem: &Quadratic,
    rectangle: &Rectangle,
    options: &Options,
    watch: Watch,
) -> Result<Eigenvalues, Error> {
    let analysis = Analysis::new(problem)?;
    let search = Search { problem, analysis: &analysis, options, watch };
    let discs = if options.shifts.is_empty() {
        search.cover(rectangle)?
    } else {
        let (count, radius) = (options.shifts.len(), f64::INFINITY);
        parallel::collect(
            count,
            &|number| search.look(options.shifts[number], radius, 0, &[]),
            &|done| (watch.progress)(done as f64 / count as f64),
        )?
    };
    Ok(collected(rectangle, discs))
}

/// Looks again with the same shifts for eigenvalues that were missed: from other start vectors, orthogonal to what is known,
/// until a look shows no new ones.
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
    let mut all = found.clone();
    let mut seed = SECOND;
    loop {
        let next = search.again(&all, seed)?;
        let more = next.modes.len() > all.modes.len();
        all = next;
        if !more {
            return Ok(all);
        }
        seed += SECOND;
    }
}

/// The result of all discs.
fn collected(rectangle: &Rectangle, discs: Vec<Disc>) -> Eigenvalues {
    let trusted =
        discs.iter().map(|disc| Trusted { centre: disc.centre, radius: disc.radius }).collect();
    let larger = rectangle.enlarged();
    let rough = rough(&discs).into_iter().map(|(place, _)| place);
    let rough = rough.filter(|&place| !larger.contains(place)).collect();
    let factorizations = discs.len();
    let solves = discs.iter().map(|disc| disc.solves).sum();
    let mut merged = Merged::default();
    discs.into_iter().for_each(|disc| merged.add(disc));
    let modes = merged.finish();
    let values: Vec<c64> = modes.iter().map(|mode| mode.eigenvalue).collect();
    let (edges, _) = rectangle.cleared(&values);
    Eigenvalues { modes, rectangle: *rectangle, edges, rough, trusted, factorizations, solves }
}

/// Rough places of eigenvalues, not below the real axis, outside the discs, each from the shift that is nearest to it, with the
/// number of its disc.
fn rough(discs: &[Disc]) -> Vec<(c64, usize)> {
    let mut places = vec![];
    for (number, disc) in discs.iter().enumerate() {
        for &place in &disc.rough {
            // Rough places of real ones are on both sides of the axis.
            let real = place.im.abs() <= ROUGH * (place - disc.centre).norm();
            let place = if real { c64::new(place.re, 0.0) } else { place };
            let distance = (place - disc.centre).norm();
            let other = |other: &Disc| {
                let away = (place - other.centre).norm();
                away < distance || away <= other.empty
            };
            if place.im >= 0.0 && !discs.iter().any(other) {
                places.push((place, number));
            }
        }
    }
    places
}

struct Search<'a> {
    problem: &'a Quadratic,
    analysis: &'a Analysis,
    options: &'a Options,
    watch: Watch<'a>,
}

impl Search<'_> {
    /// Places shifts until no rough place of an eigenvalue in the rectangle is outside the discs.
    fn cover(&self, rectangle: &Rectangle) -> Result<Vec<Disc>, Error> {
        let whole = rectangle.enlarged();
        let mut shifts = vec![whole.centre()];
        let mut discs: Vec<Disc> = vec![];
        let mut idle = 0;
        while !shifts.is_empty() && discs.len() < self.options.most && idle < IDLE {
            let before = covered(&whole, &discs);
            // All shifts of a generation are independent, so the result does not depend on the number of threads.
            let found = parallel::collect(
                shifts.len(),
                &|number| {
                    let corners = whole.corners();
                    let away = corners.iter().map(|corner| (corner - shifts[number]).norm());
                    self.look(shifts[number], away.fold(0.0, f64::max), 0, &[])
                },
                &|_| (self.watch.progress)(before),
            )?;
            let new = |mode: &Mode| {
                whole.contains(mode.eigenvalue)
                    && !discs.iter().any(|disc| {
                        (mode.eigenvalue - disc.centre).norm()
                            <= disc.radius + disc::nearness(disc.centre, mode.eigenvalue)
                    })
            };
            let more = found.iter().flat_map(|disc| &disc.modes).any(new);
            idle = if more { 0 } else { idle + 1 };
            discs.extend(found);
            (self.watch.progress)(covered(&whole, &discs));
            shifts = next(&whole, &discs);
        }
        Ok(discs)
    }

    /// Looks once more at all discs of a search. `seed` chooses the start vectors.
    fn again(&self, found: &Eigenvalues, seed: u64) -> Result<Eigenvalues, Error> {
        let count = found.trusted.len();
        let known = |number: usize| {
            let Trusted { centre, radius } = found.trusted[number];
            found.modes.iter().filter(move |mode| (mode.eigenvalue - centre).norm() <= radius)
        };
        let look = |number: usize| {
            let Trusted { centre, .. } = found.trusted[number];
            let pairs: Vec<Pair> = known(number)
                .map(|mode| Pair { eigenvalue: mode.eigenvalue, vector: mode.vector.clone() })
                .collect();
            self.look(centre, f64::INFINITY, seed, &pairs)
        };
        let progress = |done| (self.watch.progress)(done as f64 / count as f64);
        let seen = parallel::collect(count, &look, &progress)?;
        // A new disc may be smaller than the old one.
        let old = (0..count).map(|number| {
            let Trusted { centre, radius } = found.trusted[number];
            let modes = known(number).cloned().collect();
            Disc { centre, radius, empty: radius, modes, rough: vec![], hides: false, solves: 0 }
        });
        let seen = collected(&found.rectangle, old.chain(seen).collect());
        Ok(Eigenvalues {
            rough: found.rough.clone(),
            trusted: found.trusted.clone(),
            factorizations: found.factorizations + count,
            solves: found.solves + seen.solves,
            ..seen
        })
    }

    /// Looks at the surroundings of a shift.
    fn look(&self, shift: c64, radius: f64, seed: u64, known: &[Pair]) -> Result<Disc, Error> {
        self.watch.check()?;
        let wish =
            Wish { transposed: false, radius, dimension: self.options.dimension, seed, known };
        let mut result = None;
        for step in 0..4 {
            let away = if radius.is_finite() { radius } else { shift.norm().max(1.0) };
            let moved = shift + c64::from_polar(f64::from(step) * STEP * away, f64::from(step));
            let scale = moved.norm().max(if radius.is_finite() { radius } else { 0.0 });
            match Shifted::new(self.problem, self.analysis, moved, scale) {
                Ok(shifted) => {
                    let disc = disc::look(&shifted, &wish, self.options.bounds, self.watch)?;
                    let hides = disc.hides;
                    result = Some(Ok(disc));
                    if !hides {
                        break;
                    }
                }
                Err(fault) => result = result.filter(Result::is_ok).or(Some(Err(fault))),
            }
        }
        result.expect("there was a step")
    }
}

/// The part of the longer middle line of a rectangle that is in discs.
fn covered(rectangle: &Rectangle, discs: &[Disc]) -> f64 {
    let ([width, height], centre) = (rectangle.sides(), rectangle.centre());
    let side = if width > height { c64::new(width, 0.0) } else { c64::new(0.0, height) };
    let points = 100;
    let held = (0..points).filter(|&number| {
        let place = centre + side * ((f64::from(number) + 0.5) / f64::from(points) - 0.5);
        discs.iter().any(|disc| (place - disc.centre).norm() <= disc.radius)
    });
    held.count() as f64 / f64::from(points)
}

/// The next shifts: rough places of eigenvalues in the rectangle at such distances that discs as large as the one from which
/// the place is known will just touch it.
fn next(rectangle: &Rectangle, discs: &[Disc]) -> Vec<c64> {
    // A place, and its distance from the disc's centre and the disc's radius.
    let mut places: Vec<(c64, f64, f64)> = rough(discs)
        .into_iter()
        .filter(|&(place, _)| {
            let closest = CLOSEST * rectangle.sides().into_iter().fold(0.0, f64::hypot);
            rectangle.contains(place)
                && discs.iter().all(|disc| (place - disc.centre).norm() > closest)
        })
        .map(|(place, number)| {
            let disc = &discs[number];
            (place, (place - disc.centre).norm(), disc.empty)
        })
        .collect();
    // First those at up to 1.9 radii, from the farthest on; then the others, from the nearest on.
    let order = |&(_, away, radius): &(c64, f64, f64)| {
        let far = away > 1.9 * radius;
        (far, if far { away / radius } else { -away / radius })
    };
    places.sort_by(|a, b| {
        let (a, b) = (order(a), order(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut shifts: Vec<c64> = vec![];
    let mut taken: Vec<(c64, f64)> = vec![];
    for place in places {
        let (far, _) = order(&place);
        let (place, away, radius) = place;
        if taken.iter().any(|(other, radius)| (place - other).norm() <= *radius) {
            continue;
        }
        if far && !shifts.is_empty() {
            break;
        }
        // Not on the eigenvalue itself, which would hide the others.
        shifts.push(place + c64::from_polar(ASIDE * away, 1.0));
        taken.push((place, radius.max(0.5 * away)));
    }
    shifts
}
