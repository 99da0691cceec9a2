//! Solutions that hold between the values of µ, from several starts.

use super::limits::{Found, Place, Structure, by_growth, fastest};
use super::solver::{Aim, Search, Solved, squares};
use super::vary::{Part, Varied};
use crate::spectral::largest;
use crate::stability::candidates::spread;
use crate::stability::locus::{Between, Root, in_branches};
use amontons::Error;
use amontons::numerics::bisect;

/// The range of µ in steps, at first.
const STEPS: f64 = 40.0;
/// The steps with which a solution is looked at, for each of the first ones.
const FINER: f64 = 10.0;
/// The part of the unit of growth within which a larger change is tried.
const NEAR: f64 = 0.1;
/// The most peaks between values of µ that are looked at, the highest first.
const MOST_PEAKS: usize = 5;
/// The most rounds in which values of µ are added.
const MOST_ROUNDS: usize = 12;

/// A range of µ with the contact states in which no mode may grow.
#[derive(Clone, Copy)]
pub(super) struct OverRange<'a> {
    pub(super) structure: Structure<'a>,
    pub(super) range: [f64; 2],
}

/// A look at a solution over the whole range of µ.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    /// The mode that grows fastest, at the values of [`OverRange::finer`] or between them.
    pub(super) worst: Found,
    /// The largest growth rate at each of these values, 1/s.
    pub(super) rates: Vec<f64>,
}

impl OverRange<'_> {
    /// Values of µ in this many steps.
    fn values(&self, steps: f64) -> Vec<f64> {
        let [from, to] = self.range;
        if from == to { vec![from] } else { spread(self.range, steps) }
    }

    /// The values of µ at which a solution is looked at.
    pub(super) fn finer(&self) -> Vec<f64> {
        self.values(STEPS * FINER)
    }

    /// The part of a change, halved until the scene is possible after it over the whole range.
    ///
    /// # Errors
    /// Returns an error if the watch has ended the work.
    pub(super) fn possible(&self, mut changes: Vec<f64>) -> Result<Vec<f64>, Error> {
        let values = self.values(STEPS);
        for _ in 0..30 {
            match self.structure.modes(&changes, &values) {
                Err(error) if self.structure.watch.is_over() => return Err(error),
                Err(_) => changes.iter_mut().for_each(|change| *change *= 0.5),
                Ok(_) => return Ok(changes),
            }
        }
        Ok(vec![0.0; changes.len()])
    }

    /// The end of a search for an aim from a start, with as many values of µ as it takes for the aim to be kept between them too.
    ///
    /// # Errors
    /// Returns an error if the start cannot be analysed, or if the watch has ended the work.
    pub(super) fn solve(&self, aim: Aim, start: &[f64]) -> Result<Solved, Error> {
        let mut frictions = self.values(STEPS);
        let mut from = start.to_vec();
        for _ in 0..MOST_ROUNDS {
            let search = Search::new(self.structure, &frictions, aim);
            let solved = search.from(&from)?;
            let worst = self.worst(&solved.changes)?;
            let is_known = frictions.contains(&worst.place.friction);
            let aim_is_met = worst.eigenvalue.re <= aim.limit.max(solved.worst.eigenvalue.re);
            if aim_is_met || is_known {
                return self.within(aim, Solved { worst, ..solved });
            }
            frictions.push(worst.place.friction);
            frictions.sort_by(f64::total_cmp);
            from = solved.changes;
        }
        let worst = self.worst(&from)?;
        self.within(aim, Solved { changes: from, worst })
    }

    /// A solution that is above its limit by little, with a slightly larger change that keeps it, if there is one.
    fn within(&self, aim: Aim, solved: Solved) -> Result<Solved, Error> {
        let above = solved.worst.eigenvalue.re - aim.limit;
        if !aim.is_small || above <= 0.0 || above > NEAR * aim.unit {
            return Ok(solved);
        }
        let mut part = 1e-7;
        while part < 0.1 {
            let larger = solved.changes.iter().zip(self.structure.varied);
            let larger = larger
                .map(|(change, one)| (change * (1.0 + part)).clamp(one.bounds[0], one.bounds[1]));
            let changes: Vec<f64> = larger.collect();
            part *= 4.0;
            // One spectrum shows that most of these changes are still too small.
            let there = self.structure.fastest_at(&changes, solved.worst.place)?;
            if there.is_some_and(|it| it.eigenvalue.re > aim.limit) {
                continue;
            }
            let worst = self.worst(&changes)?;
            if worst.eigenvalue.re <= aim.limit {
                return Ok(Solved { changes, worst });
            }
        }
        Ok(solved)
    }

    /// The mode that grows fastest in the range after these changes.
    ///
    /// # Errors
    /// Returns the errors of [`Self::survey`].
    pub(super) fn worst(&self, changes: &[f64]) -> Result<Found, Error> {
        Ok(self.survey(changes)?.worst)
    }

    /// The largest growth rates after these changes. The mode that grows fastest is sought at values ten times as dense as those of
    /// the search, at the highest peaks between them, and where two modes come near each other between them.
    ///
    /// # Errors
    /// Returns an error if a state cannot be analysed, or if the watch has ended the work.
    pub(super) fn survey(&self, changes: &[f64]) -> Result<Survey, Error> {
        let values = self.finer();
        let modes = self.structure.modes(changes, &values)?;
        let none =
            || Error::analysis("contacts hold all motions in these states, so there is no mode");
        let mut found = fastest(&modes).ok_or_else(none)?;
        let at = modes.chunk_by(|a, b| a.place.friction == b.place.friction);
        let rates = at.filter_map(fastest).map(|it| it.eigenvalue.re).collect();
        let mut peaks = self.peaks(&modes, &values);
        peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
        peaks.truncate(MOST_PEAKS);
        let peaks = peaks.into_iter().map(|(_, pattern, ends)| (pattern, ends));
        let narrow = self.narrow(changes, &modes, found.eigenvalue.re)?;
        for (pattern, ends) in peaks.chain(narrow) {
            let at =
                |friction: f64| self.structure.fastest_at(changes, Place { pattern, friction });
            let rate = |friction: f64| match at(friction) {
                Ok(Some(it)) => it.eigenvalue.re,
                _ => f64::NEG_INFINITY,
            };
            let peak = at(largest(&rate, ends))?;
            found = peak.into_iter().chain([found]).max_by(by_growth).unwrap_or(found);
        }
        Ok(Survey { worst: found, rates })
    }

    /// Ranges of µ between two values in which one of two modes that come near each other grows faster than any at the values, each
    /// with its contact state.
    ///
    /// # Errors
    /// Returns an error if a state cannot be analysed, or if the watch has ended the work.
    fn narrow(
        &self,
        changes: &[f64],
        modes: &[Found],
        level: f64,
    ) -> Result<Vec<(usize, [f64; 2])>, Error> {
        let mut ranges = Vec::new();
        for pattern in 0..self.structure.patterns.len() {
            let at = |friction: f64| self.structure.spectrum(changes, Place { pattern, friction });
            let evaluate = |friction: f64| Ok(oscillating(&at(friction)?));
            let grows = |friction: f64| {
                at(friction).is_ok_and(|found| found.iter().any(|it| it.eigenvalue.re > level))
            };
            let of_pattern: Vec<Found> =
                modes.iter().copied().filter(|it| it.place.pattern == pattern).collect();
            let points = of_pattern.chunk_by(|a, b| a.place == b.place);
            let points = points.map(|all| (all[0].place.friction, oscillating(all)));
            let between =
                Between { evaluate: &evaluate, merge: false, level, is_watched: &|_| true };
            for branches in in_branches(points.collect()) {
                for value in between.values(&branches)? {
                    let above = branches.partition_point(|point| point.0 < value);
                    let [low, high] = [branches[above - 1].0, branches[above].0];
                    let from = bisect(low, value, |it| !grows(it))[0];
                    ranges.push((pattern, [from, bisect(value, high, grows)[1]]));
                }
            }
        }
        Ok(ranges)
    }

    /// The peaks of each contact state's largest growth rate over values of µ: the rate, the state, and the neighbours between which
    /// the peak lies.
    fn peaks(&self, modes: &[Found], values: &[f64]) -> Vec<(f64, usize, [f64; 2])> {
        let mut peaks = Vec::new();
        for pattern in 0..self.structure.patterns.len() {
            let mut rates = vec![f64::NEG_INFINITY; values.len()];
            let at = modes.chunk_by(|a, b| a.place.friction == b.place.friction);
            for (rate, found) in rates.iter_mut().zip(at) {
                let of_pattern = found.iter().filter(|it| it.place.pattern == pattern);
                *rate = of_pattern.map(|it| it.eigenvalue.re).fold(*rate, f64::max);
            }
            for (place, three) in rates.windows(3).enumerate() {
                if three[1] >= three[0] && three[1] >= three[2] && three[1].is_finite() {
                    peaks.push((three[1], pattern, [values[place], values[place + 2]]));
                }
            }
        }
        peaks
    }

    /// `true` if nothing damps the scene, nor the scene after its changes: without friction no mode decays or grows.
    pub(super) fn is_undamped(&self) -> Result<bool, Error> {
        let varied = self.structure.varied;
        let damps = |one: &Varied| one.parts.iter().any(Part::damps);
        if varied.iter().any(damps) {
            return Ok(false);
        }
        let here = self.structure.model(&vec![0.0; varied.len()], self.range[0])?;
        let model = here.model();
        let friction =
            here.linear()?.friction().all(|it| it.damping == 0.0 && it.transverse == 0.0);
        let damping = model.damping.alpha == 0.0 && model.damping.beta == 0.0;
        Ok(friction && damping && model.dampers.entries().all(|entry| entry.2 == 0.0))
    }

    /// The relative size of a change: the root of Σ nᵢ (cᵢ xᵢ)².
    pub(super) fn size(&self, changes: &[f64]) -> f64 {
        squares(self.structure.varied, changes).sqrt()
    }
}

/// The modes of a place that oscillate.
fn oscillating(modes: &[Found]) -> Vec<Root> {
    let values = modes.iter().map(|it| it.eigenvalue).filter(|lambda| lambda.im > 0.0);
    values.map(|lambda| Root { sigma: -lambda * lambda, lambda }).collect()
}
