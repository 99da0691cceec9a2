//! A branch of periodic motions over a parameter, by pseudo-arclength.
//!
//! The parameter is one more unknown of the [chain](super::chain), and the distance from the last point along the
//! branch one more equation, so folds are points like others. Distances are measured in the first state, in parts of
//! the motion's size, and in the parameter, in parts of its range.
//!
//! Each point is confirmed by the event-driven integrator. Where the integrator finds another sequence of events than
//! the chain has, a contact touches, lifts, stops or reaches its limit of friction just there. The place is bisected,
//! and the branch goes on with the sequence that a run beyond it finds, on either side of the parameter; if there is
//! none near, it ends there. Points at which the number of multipliers outside the unit circle changes are bisected
//! too.

use super::chain::{Chain, Change, Condensed, Residuals, Unsolved};
use super::check::{Difference, compare};
use super::flow::Flow;
use super::search::{NoOrbit, Start, orbit, search};
use super::{KNOWN, Orbit};
use amontons::Error;
use amontons::integrator::Event;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// The flow with a value of the parameter.
pub type FlowAt<'a> = dyn Fn(f64) -> Result<Flow, Error> + 'a;

/// First, largest and least distance from point to point.
const FIRST: f64 = 0.01;
const LARGEST: f64 = 0.05;
const LEAST: f64 = 1e-9;
/// Most corrections of a point.
const MOST_CORRECTIONS: usize = 10;
/// Distance of the values by which derivatives by the parameter are taken, in parts of its range.
const APART: f64 = 1e-6;
/// A point is found if its next correction is smaller.
const FOUND: f64 = 1e-11;
/// Corrections this small that no longer fall are rounding.
const ROUNDING: f64 = 1e-8;
/// The cosine between the directions of two neighbouring points is at least this.
const STRAIGHT: f64 = 0.97;
/// Special points are bisected until their parameter is known to this part of the range.
const LOCATED: f64 = 1e-13;
/// Most bisections.
const MOST_BISECTIONS: usize = 60;
/// A motion is at the end of its branch the largest of neutral cycles if contacts leave uniform sliding for less than this
/// part of the period.
const VANISHED: f64 = 1e-2;
/// A multiplier at a fold is this near to 1.
const NEAR_ONE: f64 = 1e-2;
/// Distances behind a change of the sequence of events at which its continuation is looked for, in parts of the range.
const BEYOND: [f64; 5] = [1e-8, 1e-7, 1e-6, 1e-5, 1e-4];

/// A periodic motion at a value of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BranchPoint {
    /// The value of the parameter.
    pub parameter: f64,
    /// The motion.
    pub orbit: Orbit,
}

/// What is special at a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpecialKind {
    /// The branch turns back; a multiplier is 1.
    Fold,
    /// A multiplier is 1 without a fold: branches cross, as where a symmetry is lost.
    BranchPoint,
    /// A multiplier is −1: a motion of twice the period begins.
    PeriodDoubling,
    /// A pair of multipliers has magnitude 1: beyond it the motion is quasi-periodic, and not followed.
    NeimarkSacker,
    /// The sequence of events changes: this event of a contact (from 0) appears or vanishes, where it is known.
    Sequence(Option<(usize, Event)>),
    /// The sequence of events changes, and the branch turns back at once without a multiplier 1.
    SequenceFold(Option<(usize, Event)>),
}

/// A special point of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpecialPoint {
    /// The value of the parameter.
    pub parameter: f64,
    /// Its kind.
    pub kind: SpecialKind,
    /// The motion nearest to it.
    pub orbit: Orbit,
    /// The place among the points of the branch behind which it is.
    pub place: usize,
}

/// How a branch ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BranchEnd {
    /// At the end of the parameter's range.
    Range,
    /// Where it began.
    Closed,
    /// At a change of the sequence of events, beyond which no motion is near: a discontinuous fold, or a place where the
    /// motion has no derivative. The contact, and its event that appears or vanishes.
    Grazing(usize, Event),
    /// In a motion without any event, which is linear: one of the neutral cycles of every size at a critical value.
    Linear,
    /// After as many points as were allowed.
    Points,
    /// Where no next point was found.
    NotConverged,
}

/// A branch of periodic motions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Branch {
    /// Its points, in their order along the branch.
    pub points: Vec<BranchPoint>,
    /// Its special points, in the same order.
    pub specials: Vec<SpecialPoint>,
    /// How it ends before its first and behind its last point.
    pub ends: [BranchEnd; 2],
}

/// What a branch is continued in.
pub struct Continued<'a> {
    /// The flow with a value of the parameter.
    pub flow_at: &'a FlowAt<'a>,
    /// The range of the parameter.
    pub range: [f64; 2],
    /// Most points to either side.
    pub most_points: usize,
    /// Hears the number of points, and decides if the work goes on.
    pub goes_on: &'a dyn Fn(usize) -> bool,
}

/// A point of a branch with its direction.
#[derive(Clone)]
struct Node {
    chain: Chain,
    parameter: f64,
    orbit: Orbit,
    /// The direction of the branch, of length 1: first state, in units of the motion's size, and parameter, in units of
    /// its range.
    tangent: (DVector<f64>, f64),
    /// The change of everything along it.
    change: Change,
}

/// The part of a branch to one side of its first point.
struct Side {
    points: Vec<BranchPoint>,
    specials: Vec<SpecialPoint>,
    end: BranchEnd,
}

/// Why the next point was not found.
enum Missed {
    Error(Error),
    Unsolved(Option<usize>),
}

impl From<Error> for Missed {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

impl From<Unsolved> for Missed {
    fn from(unsolved: Unsolved) -> Self {
        match unsolved {
            Unsolved::Grazes { segment } | Unsolved::Unknown { segment } => {
                Self::Unsolved(Some(segment))
            }
            Unsolved::Failed(_) | Unsolved::Stalled => Self::Unsolved(None),
        }
    }
}

/// Follows a branch from a periodic motion at a value of the parameter to both sides. `None` where the work was ended.
///
/// # Errors
/// Returns an error if the scene cannot have a value of the parameter.
pub fn branch(
    continued: &Continued<'_>,
    chain: &Chain,
    parameter: f64,
) -> Result<Option<Branch>, Error> {
    let chain = away_from_events(&mut (continued.flow_at)(parameter)?, chain.clone());
    let mut sides = Vec::with_capacity(2);
    for sign in [-1.0, 1.0] {
        let first = match continued.node(chain.clone(), parameter, None, sign) {
            Ok(node) => node,
            Err(Missed::Error(error)) => return Err(error),
            Err(Missed::Unsolved(_)) => {
                return Err(Error::scene(
                    "the first motion of the branch has no direction: its equations are singular",
                ));
            }
        };
        match continued.follow(first)? {
            Some(side) => sides.push(side),
            None => return Ok(None),
        }
        if sides.len() == 1 && sides[0].end == BranchEnd::Closed {
            break;
        }
    }
    Ok(Some(together(sides)))
}

/// Joins two sides at their first point.
fn together(mut sides: Vec<Side>) -> Branch {
    let after = if sides.len() == 2 { sides.pop() } else { None };
    let before = sides.pop().expect("there is a first side");
    let Some(after) = after else {
        let Side { points, specials, end } = before;
        return Branch { points, specials, ends: [end; 2] };
    };
    let behind = before.points.len() - 1;
    let mut points = before.points;
    points.reverse();
    let turned = before.specials.into_iter().rev().map(|special| SpecialPoint {
        place: behind - 1 - special.place.min(behind - 1),
        ..special
    });
    let mut specials: Vec<SpecialPoint> = turned.collect();
    points.extend(after.points.into_iter().skip(1));
    specials.extend(
        after
            .specials
            .into_iter()
            .map(|special| SpecialPoint { place: special.place + behind, ..special }),
    );
    Branch { points, specials, ends: [before.end, after.end] }
}

impl Continued<'_> {
    fn width(&self) -> f64 {
        self.range[1] - self.range[0]
    }

    /// The flow with a value in the range or just beyond: values farther off are not tried, and those that the scene
    /// cannot have are not reached.
    fn flow_near(&self, parameter: f64) -> Result<Flow, Missed> {
        let beyond = f64::max(self.range[0] - parameter, parameter - self.range[1]);
        if beyond > LARGEST * self.width() {
            return Err(Missed::Unsolved(None));
        }
        match (self.flow_at)(parameter) {
            Err(_) if beyond > 0.0 => Err(Missed::Unsolved(None)),
            flow => Ok(flow?),
        }
    }

    /// The derivative of what is left of a chain's equations by the parameter in units of its range.
    fn by_parameter(&self, chain: &Chain, parameter: f64) -> Result<Residuals, Missed> {
        let residuals = |parameter: f64| -> Result<Residuals, Missed> {
            let mut flow = (self.flow_at)(parameter)?;
            let mut chain = chain.clone();
            chain.set_times(&flow);
            Ok(chain.residuals(&mut flow)?)
        };
        // The scene may have no values beyond the range.
        let apart = APART * self.width();
        let centre = parameter.clamp(self.range[0] + apart, self.range[1] - apart);
        let [from, to] = [centre - apart, centre + apart];
        let [low, high] = [residuals(from)?, residuals(to)?];
        let factor = self.width() / (to - from);
        let defects =
            high.defects.iter().zip(&low.defects).map(|(high, low)| (high - low) * factor);
        let values = high.values.iter().zip(&low.values).map(|(high, low)| (high - low) * factor);
        Ok(Residuals { defects: defects.collect(), values: values.collect() })
    }

    /// A solved chain as a point, with its direction: that of `before`, or the one in which the parameter has this
    /// sign. Its motion is confirmed beforehand.
    fn node(
        &self,
        mut chain: Chain,
        parameter: f64,
        before: Option<&(DVector<f64>, f64)>,
        sign: f64,
    ) -> Result<Node, Missed> {
        let mut flow = (self.flow_at)(parameter)?;
        let dofs = flow.dofs();
        chain.set_scales(&mut flow).map_err(|_| Missed::Unsolved(None))?;
        let linear = chain.linear(&mut flow)?;
        let residuals = chain.residuals(&mut flow)?;
        let by_parameter = self.by_parameter(&chain, parameter)?;
        let condensed = Condensed::of(&linear, &residuals, Some(&by_parameter));
        let (closure, _, right) = condensed.closure(dofs, chain.scales);
        let motion = right.len();
        let plain = (DVector::zeros(motion), 1.0);
        let along = before.filter(|(state, _)| state.len() == motion).unwrap_or(&plain);
        let bordered = bordered(&closure, &right, along);
        let mut unit = DVector::zeros(motion + 1);
        unit[motion] = 1.0;
        let direction = bordered.lu().solve(&unit).ok_or(Missed::Unsolved(None))?;
        let mut direction = &direction / direction.norm();
        // Without an earlier direction the parameter decides.
        if before.is_none() && direction[motion] * sign < 0.0 {
            direction = -direction;
        }
        let tangent = (direction.rows(0, motion).into_owned(), direction[motion]);
        let first = in_units(&tangent.0, dofs, chain.scales);
        let change = condensed.direction(&first, tangent.1).ok_or(Missed::Unsolved(None))?;
        if flow.is_driven() && !flow.returns_after(chain.period()) {
            return Err(Missed::Unsolved(None));
        }
        let Difference::None { defect, closure } =
            compare(&chain, &mut flow).map_err(|_| Missed::Unsolved(None))?
        else {
            return Err(Missed::Unsolved(None));
        };
        let orbit =
            orbit(&chain, &mut flow, [defect, closure]).map_err(|_| Missed::Unsolved(None))?;
        Ok(Node { chain, parameter, orbit, tangent, change })
    }

    /// The chain at this distance along the branch from a point.
    fn correct(&self, from: &Node, distance: f64) -> Result<(Chain, f64), Missed> {
        let width = self.width();
        let mut parameter = from.parameter + distance * from.tangent.1 * width;
        let mut flow = self.flow_near(parameter)?;
        let dofs = flow.dofs();
        let mut chain = from.chain.clone();
        chain.apply(&flow, distance, &from.change);
        let scales = from.chain.scales;
        let anchor = &from.chain.segments[0].start;
        let mut last = f64::INFINITY;
        let mut by_parameter = None;
        for _ in 0..MOST_CORRECTIONS {
            let linear = chain.linear(&mut flow)?;
            let residuals = chain.residuals(&mut flow)?;
            if by_parameter.is_none() {
                by_parameter = Some(self.by_parameter(&chain, parameter)?);
            }
            let condensed = Condensed::of(&linear, &residuals, by_parameter.as_ref());
            let (closure, own, right) = condensed.closure(dofs, scales);
            let motion = own.len();
            let gone = DVector::from_fn(motion, |i, _| {
                (chain.segments[0].start[i] - anchor[i]) / scales[usize::from(i >= dofs)]
            });
            let gone =
                from.tangent.0.dot(&gone) + from.tangent.1 * (parameter - from.parameter) / width;
            let mut residual = DVector::zeros(motion + 1);
            residual.rows_mut(0, motion).copy_from(&own);
            residual[motion] = distance - gone;
            let solved = bordered(&closure, &right, &from.tangent).lu().solve(&residual);
            let solved = solved.ok_or(Missed::Unsolved(None))?;
            let first = in_units(&solved.rows(0, motion).into_owned(), dofs, scales);
            let change = condensed.expand(&first, solved[motion]).ok_or(Missed::Unsolved(None))?;
            let size = chain.size_of(dofs, &change).max(solved[motion].abs());
            chain.apply(&flow, 1.0, &change);
            parameter += solved[motion] * width;
            if size <= FOUND || size <= ROUNDING && size > 0.5 * last {
                // Durations may be below zero on the way only.
                if let Some(segment) = chain.segments.iter().position(|s| s.duration <= 0.0) {
                    return Err(Missed::Unsolved(Some(segment)));
                }
                chain.set_times(&self.flow_near(parameter)?);
                return Ok((chain, parameter));
            }
            if size > 4.0 * last {
                break;
            }
            last = size;
            flow = self.flow_near(parameter)?;
            chain.set_times(&flow);
        }
        Err(Missed::Unsolved(None))
    }

    /// The chain at this distance, if the integrator confirms it; else the event that it finds in its place.
    #[allow(clippy::type_complexity)]
    fn confirmed(
        &self,
        from: &Node,
        distance: f64,
    ) -> Result<Result<(Chain, f64), Option<(usize, Event)>>, Error> {
        let (chain, parameter) = match self.correct(from, distance) {
            Ok(found) => found,
            Err(Missed::Error(error)) => return Err(error),
            Err(Missed::Unsolved(segment)) => {
                let event = segment.and_then(|k| from.chain.segments[k].stages.first());
                return Ok(Err(event.and_then(|stage| stage.events.first().copied())));
            }
        };
        let mut flow = (self.flow_at)(parameter)?;
        Ok(match compare(&chain, &mut flow) {
            Ok(Difference::None { .. }) => Ok((chain, parameter)),
            Ok(Difference::Elsewhere { segment, found }) => {
                let own = chain.segments[segment].stages.first();
                Err(found.or_else(|| own.and_then(|stage| stage.events.first().copied())))
            }
            Err(_) => Err(None),
        })
    }

    fn is_inside(&self, parameter: f64) -> bool {
        let slack = 1e-12 * self.width();
        self.range[0] - slack <= parameter && parameter <= self.range[1] + slack
    }

    /// Follows the branch from a point in its direction.
    fn follow(&self, first: Node) -> Result<Option<Side>, Error> {
        let start = (first.chain.segments[0].start.clone(), first.parameter, first.chain.scales);
        let mut points = vec![point(&first)];
        let mut specials: Vec<SpecialPoint> = Vec::new();
        let mut node = first;
        let mut step = FIRST;
        let done = |points, specials, end| Ok(Some(Side { points, specials, end }));
        while points.len() <= self.most_points {
            if !(self.goes_on)(points.len()) {
                return Ok(None);
            }
            if !self.is_inside(node.parameter + step * node.tangent.1 * self.width()) {
                if let Some(last) = self.at_end(&node)? {
                    self.note_specials(&node, &last, points.len() - 1, &mut specials)?;
                    points.push(point(&last));
                    return done(points, specials, BranchEnd::Range);
                }
                if step > LEAST {
                    step *= 0.5;
                    continue;
                }
            }
            let next = match self.confirmed(&node, step)? {
                // A branch that bends may leave the range although its direction does not.
                Ok((_, parameter)) if !self.is_inside(parameter) && step > LEAST => {
                    step *= 0.5;
                    continue;
                }
                Ok((chain, parameter)) => {
                    match self.node(chain, parameter, Some(&node.tangent), 1.0) {
                        Ok(next) => Some(next),
                        Err(Missed::Error(error)) => return Err(error),
                        Err(Missed::Unsolved(_)) => None,
                    }
                }
                Err(_) => None,
            };
            if let Some(next) = next {
                let along = next.tangent.0.dot(&node.tangent.0) + next.tangent.1 * node.tangent.1;
                if along < STRAIGHT && step > 1e-4 {
                    step *= 0.5;
                    continue;
                }
                self.note_specials(&node, &next, points.len() - 1, &mut specials)?;
                points.push(point(&next));
                let (state, parameter, scales) = &start;
                let dofs = next.orbit.displacement.len();
                let apart = (0..2 * dofs).map(|i| {
                    let off = next.chain.segments[0].start[i] - state[i];
                    off.abs() / scales[usize::from(i >= dofs)]
                });
                let apart = apart.fold((next.parameter - parameter).abs() / self.width(), f64::max);
                if points.len() > 10 && apart < step {
                    return done(points, specials, BranchEnd::Closed);
                }
                node = next;
                step = (1.5 * step).min(LARGEST);
                continue;
            }
            // A little farther on the sequence of events may change.
            if step > 1e-3 {
                step *= 0.25;
                continue;
            }
            let (last, event) = self.bisect_sequence(&node, step)?;
            let event = event.or_else(|| self.nearest_change(&last));
            let place = points.len() - 1;
            if last.parameter != node.parameter {
                self.note_specials(&node, &last, place, &mut specials)?;
            }
            match self.beyond(&last)? {
                Ok((next, turned)) => {
                    points.push(point(&last));
                    // The search for the next point may only have begun anew.
                    if !has_same_events(&next.orbit, &last.orbit) {
                        let kind = if turned {
                            SpecialKind::SequenceFold(event)
                        } else {
                            SpecialKind::Sequence(event)
                        };
                        specials.push(special(&last, kind, points.len() - 1));
                    }
                    points.push(point(&next));
                    node = next;
                    step = FIRST;
                }
                Err(is_linear) => {
                    points.push(point(&last));
                    let vanishes = last.chain.part_away_from_longest() < VANISHED;
                    let end = if is_linear && vanishes {
                        BranchEnd::Linear
                    } else {
                        event.map_or(BranchEnd::NotConverged, |(contact, event)| {
                            BranchEnd::Grazing(contact, event)
                        })
                    };
                    return done(points, specials, end);
                }
            }
        }
        done(points, specials, BranchEnd::Points)
    }

    /// The point at the end of the range in the direction of a point.
    fn at_end(&self, node: &Node) -> Result<Option<Node>, Error> {
        let end = if node.tangent.1 > 0.0 { self.range[1] } else { self.range[0] };
        let mut flow = (self.flow_at)(end)?;
        let mut chain = node.chain.clone();
        let distance = (end - node.parameter) / (node.tangent.1 * self.width());
        chain.apply(&flow, distance, &node.change);
        if chain.segments.iter().any(|segment| segment.duration <= 0.0)
            || chain.solve(&mut flow).is_err()
            || !matches!(compare(&chain, &mut flow), Ok(Difference::None { .. }))
        {
            return Ok(None);
        }
        match self.node(chain, end, Some(&node.tangent), 1.0) {
            Ok(node) => Ok(Some(node)),
            Err(Missed::Error(error)) => Err(error),
            Err(Missed::Unsolved(_)) => Ok(None),
        }
    }

    /// The last point before the sequence of events changes within this distance, and the event that changes it. Each
    /// point that is found is the base of the next one: near a tangential event a branch bends without a bound.
    #[allow(clippy::type_complexity)]
    fn bisect_sequence(
        &self,
        node: &Node,
        distance: f64,
    ) -> Result<(Node, Option<(usize, Event)>), Error> {
        let (mut last, mut event) = (node.clone(), None);
        let mut ahead = distance;
        for _ in 0..MOST_BISECTIONS {
            ahead *= 0.5;
            if ahead <= LOCATED {
                break;
            }
            match self.confirmed(&last, ahead)? {
                Ok((chain, parameter)) => {
                    match self.node(chain, parameter, Some(&last.tangent), 1.0) {
                        Ok(next) => last = next,
                        Err(Missed::Error(error)) => return Err(error),
                        Err(Missed::Unsolved(_)) => {}
                    }
                }
                Err(found) => event = found.or(event),
            }
        }
        Ok((last, event))
    }

    /// The event that ends the segment which the motion leaves most nearly tangentially, or the one of the shortest
    /// segment if that is about to vanish.
    fn nearest_change(&self, node: &Node) -> Option<(usize, Event)> {
        /// Tangential, and about to vanish.
        const SMALL: f64 = 1e-3;
        let mut flow = (self.flow_at)(node.parameter).ok()?;
        let linear = node.chain.linear(&mut flow).ok()?;
        let period = node.chain.period();
        let mut least = (SMALL, None);
        for (segment, linear) in node.chain.segments.iter().zip(&linear) {
            // The function of the event, by how much it changes within the segment.
            let field = flow.field(&segment.states).ok()?;
            let parts = flow.powers(&field, &segment.start, segment.duration);
            let size =
                parts.map(|(powers, _)| linear.row.dot(&powers[0]).abs()).fold(0.0, f64::max);
            let steepness = (linear.slope * segment.duration).abs() / size.max(f64::MIN_POSITIVE);
            let measure = steepness.min(segment.duration / period);
            if measure < least.0 {
                least = (measure, segment.stages.first()?.events.first().copied());
            }
        }
        least.1
    }

    /// The continuation of a branch behind a change of the sequence of events; `true` beside it if the parameter turns
    /// back there. `Err(true)` if the motion beyond has no event at all.
    #[allow(clippy::type_complexity)]
    fn beyond(&self, last: &Node) -> Result<Result<(Node, bool), bool>, Error> {
        let mut is_linear = false;
        let onward = if last.tangent.1 < 0.0 { -1.0 } else { 1.0 };
        for (turned, sign) in [(false, onward), (true, -onward)] {
            for part in BEYOND {
                let parameter = last.parameter + sign * part * self.width();
                if !self.is_inside(parameter) {
                    continue;
                }
                let mut flow = (self.flow_at)(parameter)?;
                let mut ahead = last.chain.clone();
                // The motion goes on in its direction even where the parameter turns back.
                let rate = last.tangent.1.abs().max(1e-3);
                ahead.apply(&flow, part / rate, &last.change);
                let first = &ahead.segments[0];
                let start = Start {
                    motion: flow.motion(&first.start, &first.states),
                    time: flow.time_of(ahead.turn),
                    period: Some(ahead.period()),
                    longest: ahead.period(),
                };
                let (orbit, chain) = match search(&mut flow, &start, &|| true) {
                    Ok(Some(found)) => found,
                    Err(NoOrbit::Linear) => {
                        is_linear = true;
                        continue;
                    }
                    _ => continue,
                };
                let off = difference(&orbit, &last.orbit);
                let is_old = has_same_events(&orbit, &last.orbit);
                if off > (3.0 * part.sqrt()).max(1e-4) || turned && is_old {
                    continue;
                }
                let chain = away_from_events(&mut flow, chain);
                match self.node(chain, parameter, None, sign) {
                    Ok(node) => return Ok(Ok((node, turned))),
                    Err(Missed::Error(error)) => return Err(error),
                    Err(Missed::Unsolved(_)) => {}
                }
            }
        }
        Ok(Err(is_linear))
    }

    /// The distance of a later point along the direction of an earlier one.
    fn distance(&self, from: &Node, to: &Node) -> f64 {
        let [before, after] = [from, to].map(|node| &node.chain.segments[0].start);
        let dofs = from.orbit.displacement.len();
        let parts = from.tangent.0.iter().enumerate().map(|(i, along)| {
            along * (after[i] - before[i]) / from.chain.scales[usize::from(i >= dofs)]
        });
        parts.sum::<f64>() + from.tangent.1 * (to.parameter - from.parameter) / self.width()
    }

    /// Finds the special points between two neighbouring points.
    fn note_specials(
        &self,
        from: &Node,
        to: &Node,
        place: usize,
        specials: &mut Vec<SpecialPoint>,
    ) -> Result<(), Error> {
        let distance = self.distance(from, to);
        let turns = from.tangent.1 * to.tangent.1 < 0.0;
        if turns {
            let sign = from.tangent.1;
            let is_before = |node: &Node| node.tangent.1 * sign > 0.0;
            if let Some(node) = self.bisect(from, distance, &is_before)? {
                specials.push(special(&node, SpecialKind::Fold, place));
            }
        }
        let outside = growing(&from.orbit);
        if growing(&to.orbit) != outside {
            let is_before = |node: &Node| growing(&node.orbit) == outside;
            if let Some(node) = self.bisect(from, distance, &is_before)? {
                let off = |value: &[f64; 2]| (libm::hypot(value[0], value[1]) - 1.0).abs();
                let values = node.orbit.multipliers.iter();
                let nearest = values.min_by(|a, b| off(a).total_cmp(&off(b)));
                // Beside the one along the motion, a multiplier 1 is a double one, which rounding makes a pair.
                if turns && nearest.is_some_and(|[re, im]| libm::hypot(re - 1.0, *im) < NEAR_ONE) {
                    return Ok(());
                }
                let kind = match nearest {
                    Some([_, im]) if *im != 0.0 => SpecialKind::NeimarkSacker,
                    Some([re, _]) if *re < 0.0 => SpecialKind::PeriodDoubling,
                    _ => SpecialKind::BranchPoint,
                };
                specials.push(special(&node, kind, place));
            }
        }
        Ok(())
    }

    /// The last point within this distance for which a condition holds that does not hold at its end.
    fn bisect(
        &self,
        from: &Node,
        distance: f64,
        is_before: &dyn Fn(&Node) -> bool,
    ) -> Result<Option<Node>, Error> {
        let (mut low, mut high) = (0.0, distance);
        let mut found = None;
        for _ in 0..MOST_BISECTIONS {
            if high - low <= LOCATED {
                break;
            }
            let middle = f64::midpoint(low, high);
            let node = match self.correct(from, middle) {
                Ok((chain, parameter)) => self.node(chain, parameter, Some(&from.tangent), 1.0),
                Err(missed) => Err(missed),
            };
            match node {
                Ok(node) if is_before(&node) => (low, found) = (middle, Some(node)),
                Ok(node) => {
                    high = middle;
                    found = found.or(Some(node));
                }
                Err(Missed::Error(error)) => return Err(error),
                Err(Missed::Unsolved(_)) => high = middle,
            }
        }
        Ok(found)
    }
}

/// The chain of a driven motion, begun where no event is near: an event that passes the beginning would end the chain.
fn away_from_events(flow: &mut Flow, chain: Chain) -> Chain {
    if !flow.is_driven() {
        return chain;
    }
    let Ok(mut moved) = chain.begun_between_events(flow) else { return chain };
    if moved.solve(flow).is_ok() { moved } else { chain }
}

fn point(node: &Node) -> BranchPoint {
    BranchPoint { parameter: node.parameter, orbit: node.orbit.clone() }
}

fn special(node: &Node, kind: SpecialKind, place: usize) -> SpecialPoint {
    SpecialPoint { parameter: node.parameter, kind, orbit: node.orbit.clone(), place }
}

/// Number of multipliers outside the unit circle, beyond rounding.
fn growing(orbit: &Orbit) -> usize {
    orbit.multipliers.iter().filter(|[re, im]| libm::hypot(*re, *im) > 1.0 + KNOWN).count()
}

/// `true` if contacts take the same states in the same order in both, from any instant on.
fn has_same_events(a: &Orbit, b: &Orbit) -> bool {
    let count = a.events.len();
    let state = |orbit: &Orbit, place: usize| orbit.events[place % count].states.clone();
    count == b.events.len()
        && (count == 0
            || (0..count).any(|off| (0..count).all(|k| state(a, k) == state(b, k + off))))
}

/// The largest difference of the extents and of the period of two orbits, relative.
fn difference(a: &Orbit, b: &Orbit) -> f64 {
    let largest = b.extents.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let off = a.extents.iter().zip(&b.extents).map(|(a, b)| (a - b).abs() / largest);
    off.fold((a.period / b.period - 1.0).abs(), f64::max)
}

/// The equations of closure with one more unknown, the parameter, and one more row.
fn bordered(
    closure: &DMatrix<f64>,
    by_parameter: &DVector<f64>,
    (state, parameter): &(DVector<f64>, f64),
) -> DMatrix<f64> {
    let motion = closure.nrows();
    let mut matrix = DMatrix::zeros(motion + 1, motion + 1);
    matrix.view_mut((0, 0), (motion, motion)).copy_from(closure);
    matrix.view_mut((0, motion), (motion, 1)).copy_from(&(-by_parameter));
    matrix.view_mut((motion, 0), (1, motion)).copy_from(&state.transpose());
    matrix[(motion, motion)] = *parameter;
    matrix
}

/// A first state from units of the motion's size.
fn in_units(state: &DVector<f64>, dofs: usize, scales: [f64; 2]) -> DVector<f64> {
    DVector::from_fn(state.len(), |i, _| state[i] * scales[usize::from(i >= dofs)])
}
