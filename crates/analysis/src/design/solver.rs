//! Sequential quadratic programs in a trust region.
//!
//! With relative changes x of n values each, costs c and growth rates g, the aim is the least ½ Σ nᵢ (cᵢ xᵢ)² with max g ≤
//! limit, between bounds.
//! Each step solves it with g linear in x, and with a price ρ on what is above the limit: a quadratic program, which has a
//! solution even where the limit cannot be kept. The step is taken if the true function becomes less by a part of what was
//! foretold (Fletcher, Practical Methods of Optimization, 2000, sec. 14.5).

use super::limits::{Found, Place, Row, Structure, fastest};
use amontons::Error;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
};
use std::cell::OnceCell;

/// The most steps.
const MOST_STEPS: usize = 200;
/// The most modes whose derivatives a step takes.
const MOST_ROWS: usize = 80;
/// The price of what is above the limit; both parts of the function have the size 1.
const PRICE: f64 = 10.0;
/// The most by which the price grows where the limit is not kept.
const HIGHEST_PRICE: f64 = 1e5;
/// A step that foretells less than this part of the function ends the search.
const ROUNDING: f64 = 1e-12;
/// A limit that is broken by less than this part of the unit is kept but for the rounding of quadratic programs.
const KEPT: f64 = 1e-6;
/// The part of the way to a trial at which its mode is made linear: equal modes are apart there.
const LITTLE: f64 = 1e-4;
/// A trust region narrower than this part of the bounds ends the search.
const NARROWEST: f64 = 1e-9;

/// An aim of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// The growth rate, 1/s, that no mode may have more of.
    pub(super) limit: f64,
    /// A growth rate, 1/s, that makes others comparable.
    pub(super) unit: f64,
    /// `false` if the size of the change does not count: the search is for the least growth rate.
    pub(super) is_small: bool,
    /// `true` if nothing damps the structure, whatever the changes are: growth rates above 0 are then roots of the distance to a merging, and the search takes
    /// their squares, which are smooth.
    pub(super) is_undamped: bool,
}

impl Aim {
    /// A growth rate (1/s) in units, smooth in the changes.
    fn measure(&self, growth: f64) -> f64 {
        let part = growth / self.unit;
        if self.is_undamped && part > 0.0 { part * part } else { part }
    }

    /// The derivative of the measure by the growth rate, s.
    fn slope(&self, growth: f64) -> f64 {
        let part = growth / self.unit;
        if self.is_undamped && part > 0.0 { 2.0 * part / self.unit } else { 1.0 / self.unit }
    }
}

/// An end of the search.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    /// The relative changes.
    pub(super) changes: Vec<f64>,
    /// The mode that grows fastest.
    pub(super) worst: Found,
}

/// The search at a set of friction coefficients.
pub(super) struct Search<'a> {
    structure: Structure<'a>,
    frictions: &'a [f64],
    aim: Aim,
    /// The scene itself, which several ways begin at.
    itself: OnceCell<At>,
}

/// A trial that was worse than foretold: by a mode that was not near the limit before, or by one of several equal modes, of which
/// each direction has another.
struct Trial {
    /// The place of its fastest mode.
    place: Place,
    changes: Vec<f64>,
    /// The growth rate of this mode, linear about a place a little on the way from the present changes to the trial.
    row: Option<Row>,
}

/// Relative changes with all modes there.
#[derive(Clone)]
struct At {
    changes: Vec<f64>,
    modes: Vec<Found>,
    worst: Found,
}

impl<'a> Search<'a> {
    pub(super) fn new(structure: Structure<'a>, frictions: &'a [f64], aim: Aim) -> Self {
        Self { structure, frictions, aim, itself: OnceCell::new() }
    }

    /// The end of the search from a start, within the bounds.
    ///
    /// # Errors
    /// Returns an error if the start cannot be analysed, or if the watch has ended the work.
    pub(super) fn from(&self, start: &[f64]) -> Result<Solved, Error> {
        let mut here = self.at(start)?;
        let mut inside = None;
        if self.is_flat(&here) {
            (here, inside) = self.edge(here)?;
        }
        let mut price = PRICE;
        let mut radius = 0.3;
        let mut trials: Vec<Trial> = Vec::new();
        let mut near = self.near(&here)?;
        for _ in 0..MOST_STEPS {
            let now = self.merit(&here.changes, here.worst.eigenvalue.re, price);
            let linear: Vec<Row> = near
                .iter()
                .chain(trials.iter().filter_map(|it| it.row.as_ref()))
                .cloned()
                .collect();
            let Some(step) = self.step(&here.changes, &linear, price, radius)? else {
                radius *= 0.3;
                continue;
            };
            let foretold = now - self.foretold(&step, &here.changes, &linear, price);
            if foretold <= ROUNDING * now.abs().max(1e-6) || radius < NARROWEST {
                let above = here.worst.eigenvalue.re - self.aim.limit;
                let is_kept = above <= KEPT * self.aim.unit;
                if is_kept || price >= HIGHEST_PRICE || !self.aim.is_small {
                    break;
                }
                (price, radius) = (10.0 * price, 0.3);
                continue;
            }
            let trial = match self.at(&step) {
                Ok(trial) => trial,
                Err(error) if self.structure.watch.is_over() => return Err(error),
                // Such values are impossible together.
                Err(_) => {
                    radius *= 0.3;
                    continue;
                }
            };
            let (trial, trial_inside) =
                if self.is_flat(&trial) { self.edge(trial)? } else { (trial, None) };
            let gained = now - self.merit(&trial.changes, trial.worst.eigenvalue.re, price);
            let is_taken = gained > 1e-3 * foretold;
            if gained < 0.25 * foretold {
                let (place, changes) = (trial.worst.place, trial.changes.clone());
                // Rows about changes that the search leaves are of no use.
                let row = if is_taken { None } else { self.towards(&here, place, &changes)? };
                trials.retain(|it| it.place != place);
                trials.push(Trial { place, changes, row });
                radius *= 0.3;
            } else if gained > 0.7 * foretold {
                radius = f64::min(2.0 * radius, 1.0);
            }
            if is_taken {
                (here, inside) = (trial, trial_inside.or(inside));
                near = self.near(&here)?;
                for it in &mut trials {
                    it.row = self.towards(&here, it.place, &it.changes)?;
                }
            }
        }
        let At { changes, worst, .. } = match inside {
            Some(inside) => self.last_stable(here, inside)?,
            None => here,
        };
        Ok(Solved { changes, worst })
    }

    /// `true` for changes after which a structure that nothing damps is stable: its growth rates are 0 in the neighbourhood, and do
    /// not tell where they begin.
    fn is_flat(&self, at: &At) -> bool {
        let Aim { limit, is_small, is_undamped, .. } = self.aim;
        is_undamped && is_small && limit <= 0.0 && at.worst.eigenvalue.re <= 0.0
    }

    /// Two changes on the way from the scene itself to stable ones: one that grows a little, and a stable one near it. If the scene
    /// itself does not grow, the stable changes alone.
    fn edge(&self, stable: At) -> Result<(At, Option<At>), Error> {
        let mut grows = match self.itself.get() {
            Some(itself) => itself.clone(),
            None => {
                let itself = self.at(&vec![0.0; stable.changes.len()])?;
                self.itself.get_or_init(|| itself).clone()
            }
        };
        if grows.worst.eigenvalue.re <= 0.0 {
            return Ok((stable, None));
        }
        let mut stable = stable;
        // Nearer to the merging shapes are too much alike for derivatives.
        while grows.worst.eigenvalue.re > 0.03 * self.aim.unit {
            let Some(middle) = self.middle(&grows, &stable)? else { break };
            if self.is_flat(&middle) { stable = middle } else { grows = middle }
        }
        Ok((grows, Some(stable)))
    }

    /// Stable changes as near as can be to changes that grow, on the straight way between the two.
    fn last_stable(&self, mut grows: At, mut stable: At) -> Result<At, Error> {
        for _ in 0..30 {
            let Some(middle) = self.middle(&grows, &stable)? else { break };
            if self.is_flat(&middle) { stable = middle } else { grows = middle }
        }
        Ok(stable)
    }

    /// The changes half-way between two; `None` if the two are neighbours.
    fn middle(&self, a: &At, b: &At) -> Result<Option<At>, Error> {
        let both = a.changes.iter().zip(&b.changes);
        let middle: Vec<f64> = both.map(|(a, b)| 0.5 * (a + b)).collect();
        if middle == a.changes || middle == b.changes {
            Ok(None)
        } else {
            self.at(&middle).map(Some)
        }
    }

    fn at(&self, changes: &[f64]) -> Result<At, Error> {
        let modes = self.structure.modes(changes, self.frictions)?;
        let worst = fastest(&modes).ok_or_else(|| {
            Error::analysis("contacts hold all motions in these states, so there is no mode")
        })?;
        Ok(At { changes: changes.to_vec(), modes, worst })
    }

    /// The growth rates, linear in the changes, of the modes that are near the limit or grow fastest.
    fn near(&self, here: &At) -> Result<Vec<Row>, Error> {
        let from = here.worst.eigenvalue.re.min(self.aim.limit) - 0.5 * self.aim.unit;
        let mut places: Vec<usize> = (0..here.modes.len()).collect();
        let growth = |place: &usize| here.modes[*place].eigenvalue.re;
        places.sort_by(|a, b| growth(b).total_cmp(&growth(a)));
        let mut chosen: Vec<usize> =
            places.iter().copied().filter(|place| growth(place) >= from).take(MOST_ROWS).collect();
        chosen.sort_unstable();
        let modes: Vec<Found> = chosen.into_iter().map(|place| here.modes[place]).collect();
        self.structure.rows(&here.changes, &modes)
    }

    /// The growth rate of the fastest mode at the place of a trial, linear about a place a little on the way to it; `None` if there
    /// is no mode.
    fn towards(&self, here: &At, place: Place, trial: &[f64]) -> Result<Option<Row>, Error> {
        let way: Vec<f64> =
            trial.iter().zip(&here.changes).map(|(to, from)| LITTLE * (to - from)).collect();
        let moved: Vec<f64> = here.changes.iter().zip(&way).map(|(x, step)| x + step).collect();
        let Some(mode) = self.structure.fastest_at(&moved, place)? else { return Ok(None) };
        let row = self.structure.rows(&moved, &[mode])?.pop();
        Ok(row.map(|row| {
            let back = row.by.iter().zip(&way).map(|(by, step)| by * step).sum::<f64>();
            Row { growth: row.growth - back, ..row }
        }))
    }

    /// The largest Σ nᵢ (cᵢ xᵢ)² that the bounds allow.
    fn largest(&self) -> f64 {
        let largest = |[low, high]: [f64; 2]| high.max(-low);
        self.structure.varied.iter().map(|one| one.weight() * largest(one.bounds).powi(2)).sum()
    }

    /// The weight of ½ Σ nᵢ (cᵢ xᵢ)².
    fn weight(&self) -> f64 {
        let weight = if self.aim.is_small { 1.0 } else { 1e-6 };
        weight / self.largest()
    }

    fn merit(&self, changes: &[f64], growth: f64, price: f64) -> f64 {
        self.merit_of(changes, self.aim.measure(growth), price)
    }

    /// The merit of changes with this measure of the largest growth rate.
    fn merit_of(&self, changes: &[f64], measure: f64, price: f64) -> f64 {
        let above = measure - self.aim.measure(self.aim.limit);
        let above = if self.aim.is_small { above.max(0.0) } else { above };
        0.5 * self.weight() * squares(self.structure.varied, changes) + price * above
    }

    /// The merit after a step, with measures of growth rates linear in the changes.
    fn foretold(&self, step: &[f64], from: &[f64], linear: &[Row], price: f64) -> f64 {
        let rates = linear.iter().map(|row| {
            let moved =
                row.by.iter().zip(step.iter().zip(from)).map(|(by, (to, from))| by * (to - from));
            self.aim.measure(row.growth) + self.aim.slope(row.growth) * moved.sum::<f64>()
        });
        self.merit_of(step, rates.fold(f64::NEG_INFINITY, f64::max), price)
    }

    /// The relative changes after the step of the quadratic program; `None` if its solver fails.
    fn step(
        &self,
        from: &[f64],
        linear: &[Row],
        price: f64,
        radius: f64,
    ) -> Result<Option<Vec<f64>>, Error> {
        let varied = self.structure.varied;
        let count = varied.len();
        let half: Vec<f64> =
            varied.iter().map(|one| 0.5 * (one.bounds[1] - one.bounds[0])).collect();
        // Unknowns: steps in halves of the bounds, then what is above the limit in units.
        let (mut diagonal, mut slope) = (Vec::new(), Vec::new());
        for (i, one) in varied.iter().enumerate() {
            let curvature = self.weight() * one.weight() * half[i].powi(2);
            diagonal.push(curvature);
            slope.push(curvature * from[i] / half[i]);
        }
        diagonal.push(0.0);
        slope.push(price);
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for row in linear {
            let slope = self.aim.slope(row.growth);
            let mut by: Vec<f64> =
                row.by.iter().zip(&half).map(|(by, half)| by * half * slope).collect();
            by.push(-1.0);
            rows.push(by);
            values.push(self.aim.measure(self.aim.limit) - self.aim.measure(row.growth));
        }
        let unknown = |i: usize, value: f64| {
            let mut row = vec![0.0; count + 1];
            row[i] = value;
            row
        };
        if self.aim.is_small {
            rows.push(unknown(count, -1.0));
            values.push(0.0);
        }
        let mut bounds = Vec::new();
        for (i, one) in varied.iter().enumerate() {
            let low = f64::max((one.bounds[0] - from[i]) / half[i], -radius).min(0.0);
            let high = f64::min((one.bounds[1] - from[i]) / half[i], radius).max(0.0);
            rows.extend([unknown(i, 1.0), unknown(i, -1.0)]);
            values.extend([high, -low]);
            bounds.push([low, high]);
        }
        let hessian =
            CscMatrix::from(&(0..=count).map(|i| unknown(i, diagonal[i])).collect::<Vec<_>>());
        let settings = DefaultSettingsBuilder::default().verbose(false).build();
        let settings = settings.map_err(|error| failed(&error))?;
        let cones = [NonnegativeConeT(rows.len())];
        let mut solver = DefaultSolver::new(
            &hessian,
            &slope,
            &CscMatrix::from(&rows),
            &values,
            &cones,
            settings,
        )
        .map_err(|error| failed(&error))?;
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {}
            _ => return Ok(None),
        }
        let steps = solver.solution.x.iter().zip(bounds).zip(from.iter().zip(&half));
        let steps =
            steps.map(|((step, [low, high]), (from, half))| from + half * step.clamp(low, high));
        Ok(Some(steps.collect()))
    }
}

/// Σ nᵢ (cᵢ xᵢ)².
pub(super) fn squares(varied: &[super::Varied], changes: &[f64]) -> f64 {
    varied.iter().zip(changes).map(|(one, change)| one.weight() * change.powi(2)).sum()
}

fn failed(error: &dyn std::fmt::Display) -> Error {
    Error::analysis(format!("a quadratic program of the search cannot be set up: {error}"))
}
