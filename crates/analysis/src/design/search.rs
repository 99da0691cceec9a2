//! Solutions that hold between the values of µ, from several starts.

use super::limits::{Found, Place, Structure, fastest};
use super::solver::{Aim, Search, Solved, squares};
use crate::spectral::largest;
use crate::stability::candidates::spread;
use amontons::Error;

/// The range of µ in steps, at first.
const STEPS: f64 = 40.0;
/// The steps with which a solution is looked at, for each of the first ones.
const FINER: f64 = 10.0;
/// The part of the unit of growth within which a larger change is tried.
const NEAR: f64 = 0.1;
/// The most rounds in which values of µ are added.
const MOST_ROUNDS: usize = 12;

/// A range of µ with the contact states in which no mode may grow.
#[derive(Clone, Copy)]
pub(super) struct OverRange<'a> {
    pub(super) structure: Structure<'a>,
    pub(super) range: [f64; 2],
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

    /// The end of a search for an aim from a start, with as many values of µ as it takes for the aim to be kept between them too.
    ///
    /// # Errors
    /// Returns an error if the start cannot be analysed, or if the watch has ended the work.
    pub(super) fn solve(&self, aim: Aim, start: &[f64]) -> Result<Solved, Error> {
        let mut frictions = self.values(STEPS);
        let mut from = start.to_vec();
        for _ in 0..MOST_ROUNDS {
            let search = Search { structure: self.structure, frictions: &frictions, aim };
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
            let worst = self.worst(&changes)?;
            if worst.eigenvalue.re <= aim.limit {
                return Ok(Solved { changes, worst });
            }
            part *= 4.0;
        }
        Ok(solved)
    }

    /// The mode that grows fastest in the range after these changes. It is sought at values ten times as dense as those of the
    /// search, and between them where the growth rate has a peak.
    ///
    /// # Errors
    /// Returns an error if a state cannot be analysed, or if the watch has ended the work.
    pub(super) fn worst(&self, changes: &[f64]) -> Result<Found, Error> {
        let values = self.finer();
        let modes = self.structure.modes(changes, &values)?;
        let none =
            || Error::analysis("contacts hold all motions in these states, so there is no mode");
        let worst = fastest(&modes).ok_or_else(none)?;
        let place = values.iter().position(|value| *value == worst.place.friction).unwrap_or(0);
        if place == 0 || place + 1 >= values.len() {
            return Ok(worst);
        }
        let Place { pattern, .. } = worst.place;
        let growth = |friction: f64| {
            let found = self.structure.modes(changes, &[friction]).ok()?;
            let of_pattern: Vec<Found> =
                found.into_iter().filter(|it| it.place.pattern == pattern).collect();
            fastest(&of_pattern)
        };
        let ends = [values[place - 1], values[place + 1]];
        let rate = |friction| growth(friction).map_or(f64::NEG_INFINITY, |it| it.eigenvalue.re);
        let peak = largest(&rate, ends);
        let peak = growth(peak).filter(|it| it.eigenvalue.re > worst.eigenvalue.re);
        Ok(peak.unwrap_or(worst))
    }

    /// The largest growth rate at each of these values of µ after these changes, 1/s.
    ///
    /// # Errors
    /// Returns an error if a state cannot be analysed, or if the watch has ended the work.
    pub(super) fn growth(&self, changes: &[f64], frictions: &[f64]) -> Result<Vec<f64>, Error> {
        let modes = self.structure.modes(changes, frictions)?;
        let at = modes.chunk_by(|a, b| a.place.friction == b.place.friction);
        Ok(at.filter_map(fastest).map(|it| it.eigenvalue.re).collect())
    }

    /// `true` if nothing damps the scene: without friction no mode decays or grows.
    pub(super) fn is_undamped(&self) -> Result<bool, Error> {
        let unchanged = vec![0.0; self.structure.varied.len()];
        let here = self.structure.model(&unchanged, self.range[0])?;
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
