//! Following the roots of one part of a contact state from value to value of a parameter.

use super::events::{
    BranchPoint, Located, closest_approaches, hidden_crossings, locate_coalescence, locate_crossing,
};
use super::narrow::{Between, DOUBLE, Point, assign};
use super::rounding::Branch;
use super::{Approach, Coalescence, Crossing, Root, order_of_merged};
use crate::stability::parallel;
use amontons::Error;
use nalgebra::Complex;
use std::cmp::Ordering;
use std::collections::HashMap;
use std::sync::Mutex;

/// Halvings of a step at most, where modes cannot be told apart by continuity.
const MAX_HALVINGS: u32 = 24;
/// The fewest steps in which a range is gone through.
const FEWEST_STEPS: f64 = 200.0;
/// An extremum beside an end of the range shows at a point this part of a step from it.
const BESIDE_END: f64 = 1e-3;

/// Number of values at which roots are found side by side, on up to as many cores.
const SIDE_BY_SIDE: usize = 8;

/// Gives the roots at a value of the parameter; always the same number of them.
pub(super) type Evaluate<'a> = dyn Fn(f64) -> Result<Vec<Root>, Error> + Sync + 'a;

/// The roots that matter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    /// Bounds of Im λ, 1/s.
    pub(super) frequencies: [f64; 2],
    /// `true` if roots can merge; where they cannot, their closest approaches are found.
    pub(super) merge: bool,
}

impl Watched {
    /// `true` if the frequency of a root lies between the bounds.
    pub(super) fn contains(&self, root: Root) -> bool {
        let [from, to] = self.frequencies;
        (from..=to).contains(&root.lambda.im)
    }
}

/// Roots that have been followed.
#[derive(Debug, Default)]
pub(super) struct FollowedRoots {
    /// One branch for each root, in the order of the first value; one root for each value.
    pub(super) branches: Vec<Vec<Root>>,
    pub(super) coalescences: Vec<Coalescence>,
    pub(super) crossings: Vec<Crossing>,
    /// Crossings of this kind at which no mode begins or ceases to grow.
    pub(super) splits: Vec<Crossing>,
    /// Closest approaches of roots that do not merge.
    pub(super) approaches: Vec<Approach>,
    /// Values near which roots could not be told apart by continuity.
    pub(super) undecided: Vec<f64>,
}

impl FollowedRoots {
    /// Replaces changes of sign by those between growth by more than rounding and none.
    ///
    /// # Errors
    /// Returns an error if the state cannot be analysed between two of them.
    fn keep_clear_crossings(
        &mut self,
        evaluate: &Evaluate<'_>,
        trace: &[Vec<BranchPoint>],
    ) -> Result<(), Error> {
        let all = std::mem::take(&mut self.crossings);
        for (mode, trace) in trace.iter().enumerate() {
            let mut own: Vec<Crossing> =
                all.iter().filter(|crossing| crossing.mode == mode).copied().collect();
            own.sort_by(|a, b| a.value.total_cmp(&b.value));
            self.crossings.extend(Branch { evaluate, mode, trace }.clear(&own)?);
        }
        Ok(())
    }

    fn add_crossings(&mut self, crossings: Vec<Located>) {
        for Located { crossing, is_split } in crossings {
            if is_split { &mut self.splits } else { &mut self.crossings }.push(crossing);
        }
    }
}

/// Follows all roots over ascending values; those that are not watched may change places with each other. Where two may do
/// something between two values, another value is put there. `done` hears of each value done, and at last of the events.
pub(super) fn follow(
    evaluate: &Evaluate<'_>,
    values: &[f64],
    watched: Watched,
    done: &dyn Fn(),
) -> Result<FollowedRoots, Error> {
    let known: Mutex<HashMap<u64, Vec<Root>>> = Mutex::new(HashMap::new());
    let remembered = |value: f64| {
        let place = value.to_bits();
        let before = known.lock().expect("no evaluation panics").get(&place).cloned();
        if let Some(roots) = before {
            return Ok(roots);
        }
        let roots = evaluate(value)?;
        known.lock().expect("no evaluation panics").insert(place, roots.clone());
        Ok(roots)
    };
    let evaluate: &Evaluate<'_> = &remembered;
    let mut points = grid(values);
    let mut followed = Tracker::over(evaluate, values[0], &points, watched, done)?;
    let between = Between {
        evaluate: &remembered,
        merge: watched.merge,
        level: 0.0,
        is_watched: &|root| watched.contains(root),
    };
    let more = between.values(&followed.points())?;
    if !more.is_empty() {
        points.extend(more.into_iter().map(|value| GridPoint { value, is_given: false }));
        points.sort_by(|a, b| a.value.total_cmp(&b.value));
        followed = Tracker::over(evaluate, values[0], &points, watched, &|| {})?;
    }
    let Tracker { trace, branches, mut found, .. } = followed;
    // Roots that merge are undecided by nature at the merging, and are numbered by a rule.
    let range = values[values.len() - 1] - values[0];
    let FollowedRoots { undecided, coalescences, .. } = &mut found;
    undecided.retain(|value| {
        coalescences.iter().all(|event| (event.value - value).abs() > 1e-6 * range)
    });
    for (mode, trace) in trace.iter().enumerate() {
        found.add_crossings(hidden_crossings(evaluate, watched, trace, mode)?);
    }
    if !watched.merge {
        found.keep_clear_crossings(evaluate, &trace)?;
        found.approaches = closest_approaches(evaluate, watched, &trace)?;
    }
    done();
    Ok(FollowedRoots { branches, ..found })
}

/// A value at which roots are found.
#[derive(Clone, Copy)]
struct GridPoint {
    value: f64,
    /// `true` if the caller has given the value.
    is_given: bool,
}

/// The values after the first one, with others between them and beside both ends of the range.
fn grid(values: &[f64]) -> Vec<GridPoint> {
    let (first, last) = (values[0], values[values.len() - 1]);
    let longest = (last - first) / FEWEST_STEPS;
    let beside = BESIDE_END * longest.min(values[1] - first).min(last - values[values.len() - 2]);
    let between = |value: f64| GridPoint { value, is_given: false };
    let mut points = vec![between(first + beside)];
    for pair in values.windows(2) {
        let steps = ((pair[1] - pair[0]) / longest).ceil().clamp(1.0, FEWEST_STEPS);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let inner =
            (1..steps as u32).map(|i| pair[0] + (pair[1] - pair[0]) * (f64::from(i) / steps));
        points.extend(inner.map(between));
        if pair[1] == last {
            points.push(between(last - beside));
        }
        points.push(GridPoint { value: pair[1], is_given: true });
    }
    points
}

struct Tracker<'a> {
    evaluate: &'a Evaluate<'a>,
    watched: Watched,
    value: f64,
    roots: Vec<Root>,
    /// dσ/dp of each branch over the last step.
    rates: Vec<Complex<f64>>,
    /// Every point of each branch.
    trace: Vec<Vec<BranchPoint>>,
    /// The roots at the given values, for each branch.
    branches: Vec<Vec<Root>>,
    found: FollowedRoots,
}

impl<'a> Tracker<'a> {
    /// Follows the roots from the first value over the others. `done` hears of each given value.
    fn over(
        evaluate: &'a Evaluate<'a>,
        first_value: f64,
        others: &[GridPoint],
        watched: Watched,
        done: &dyn Fn(),
    ) -> Result<Self, Error> {
        let first = evaluate(first_value)?;
        let mut tracker = Self {
            evaluate,
            watched,
            value: first_value,
            rates: vec![Complex::new(0.0, 0.0); first.len()],
            trace: first.iter().map(|&root| vec![(first_value, root)]).collect(),
            branches: first.iter().map(|&root| vec![root]).collect(),
            roots: first,
            found: FollowedRoots::default(),
        };
        done();
        for points in others.chunks(SIDE_BY_SIDE) {
            let roots = parallel::collect(points.len(), &|i| evaluate(points[i].value), &|_| {})?;
            for (point, found) in points.iter().zip(roots) {
                tracker.move_to(point.value, found, 0)?;
                if point.is_given {
                    for (branch, &root) in tracker.branches.iter_mut().zip(&tracker.roots) {
                        branch.push(root);
                    }
                    done();
                }
            }
        }
        Ok(tracker)
    }

    /// The roots at all values, in the order of the branches.
    fn points(&self) -> Vec<Point> {
        let count = self.trace.first().map_or(0, Vec::len);
        let roots = |place: usize| self.trace.iter().map(|trace| trace[place].1).collect();
        (0..count).map(|place| (self.trace[0][place].0, roots(place))).collect()
    }

    /// Moves to another value, at which roots have been found, in halves where they cannot be told apart.
    fn move_to(&mut self, value: f64, found: Vec<Root>, halvings: u32) -> Result<(), Error> {
        if found.len() != self.roots.len() {
            return Err(Error::analysis(format!(
                "the modes cannot be followed: their number changes from {} to {} at the parameter value {value}",
                self.roots.len(),
                found.len()
            )));
        }
        let step = value - self.value;
        let predicted: Vec<Complex<f64>> = self
            .roots
            .iter()
            .zip(&self.rates)
            .map(|(root, rate)| root.sigma + rate * step)
            .collect();
        let mut order = assign(&predicted, &found);
        self.number_merged(&found, &mut order);
        if self.is_ambiguous(&predicted, &found, &order) {
            if halvings < MAX_HALVINGS {
                let middle = self.value + 0.5 * step;
                self.move_to(middle, (self.evaluate)(middle)?, halvings + 1)?;
                return self.move_to(value, found, halvings + 1);
            }
            self.found.undecided.push(value);
        }
        let next: Vec<Root> = order.iter().map(|&place| found[place]).collect();
        self.note_events(value, &next)?;
        for (rate, (now, next)) in self.rates.iter_mut().zip(self.roots.iter().zip(&next)) {
            // Across a merging the rate is that of a root: it foretells nothing.
            let smooth = now.is_real() == next.is_real();
            *rate = if smooth { (next.sigma - now.sigma) / step } else { Complex::new(0.0, 0.0) };
        }
        for (trace, &root) in self.trace.iter_mut().zip(&next) {
            trace.push((value, root));
        }
        self.roots = next;
        self.value = value;
        Ok(())
    }

    /// `true` if a branch that is watched here or there might as well continue in another root. Double roots count as one.
    fn is_ambiguous(&self, predicted: &[Complex<f64>], found: &[Root], order: &[usize]) -> bool {
        let branches = predicted.iter().zip(order).zip(&self.roots);
        let watched = branches.filter(|((_, place), before)| {
            self.watched.contains(**before) || self.watched.contains(found[**place])
        });
        watched.map(|(ends, _)| ends).any(|(predicted, &place)| {
            let own = found[place].sigma;
            let miss = (predicted - own).norm();
            found.iter().any(|other| {
                let apart = (other.sigma - own).norm();
                apart > DOUBLE * own.norm() && miss > 0.2 * apart
            })
        })
    }

    /// Two roots that have just merged are alike: they are numbered by [`order_of_merged`].
    fn number_merged(&self, found: &[Root], order: &mut [usize]) {
        for i in 0..order.len() {
            for j in i + 1..order.len() {
                let (a, b) = (found[order[i]], found[order[j]]);
                let merged = self.roots[i].is_real()
                    && self.roots[j].is_real()
                    && !a.is_real()
                    && a.sigma == b.sigma.conj();
                if merged && order_of_merged(&a, &b) == Ordering::Greater {
                    order.swap(i, j);
                }
            }
        }
    }

    fn note_events(&mut self, value: f64, next: &[Root]) -> Result<(), Error> {
        let mut paired = vec![false; next.len()];
        for i in 0..next.len() {
            if ![self.roots[i], next[i]].iter().any(|&root| self.watched.contains(root)) {
                continue;
            }
            if self.roots[i].is_real() != next[i].is_real() && !paired[i] {
                let merge = self.roots[i].is_real();
                let pair = if merge { next } else { &self.roots };
                let partner = (i + 1..next.len())
                    .find(|&j| !paired[j] && pair[j].sigma == pair[i].sigma.conj());
                if let Some(j) = partner {
                    paired[j] = true;
                    let centre = |roots: &[Root]| 0.5 * (roots[i].sigma + roots[j].sigma);
                    let ends = [(self.value, centre(&self.roots)), (value, centre(next))];
                    let event = locate_coalescence(self.evaluate, [i, j], ends, merge)?;
                    self.found.coalescences.push(event);
                }
            }
            if self.roots[i].grows() != next[i].grows() {
                let ends = [(self.value, self.roots[i]), (value, next[i])];
                let located = locate_crossing(self.evaluate, i, ends)?;
                self.found.add_crossings(vec![located]);
            }
        }
        Ok(())
    }
}
