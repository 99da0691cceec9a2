//! A branch from point to point: steps, special points, and changes of the sequence of events.

use super::branch::{Branch, BranchEnd, BranchPoint, Continued, SpecialKind, SpecialPoint};
use super::chain::Chain;
use super::check::{Difference, compare};
use super::corrector::{Missed, Node};
use super::flow::Flow;
use super::search::{NoOrbit, Start, search};
use super::{KNOWN, Orbit};
use amontons::Error;
use amontons::integrator::Event;

/// First, largest and least distance from point to point.
const FIRST: f64 = 0.01;
const LARGEST: f64 = 0.05;
const LEAST: f64 = 1e-9;
/// The cosine between the directions of two neighbouring points is at least this.
const STRAIGHT: f64 = 0.97;
/// Special points are bisected until their parameter is known to this part of the range.
const LOCATED: f64 = 1e-13;
/// Most bisections.
const MOST_BISECTIONS: usize = 60;
/// A motion is at the end of its branch the largest of neutral cycles if contacts leave uniform sliding for less than this
/// part of the period.
const VANISHED: f64 = 1e-2;
/// A branch of fewer points is not closed; a point is the first one again within this part of a step.
const FEWEST_OF_CLOSED: usize = 10;
const SAME_POINT: f64 = 0.5;
/// Distances behind a change of the sequence of events at which its continuation is looked for, in parts of the range.
const BEYOND: [f64; 5] = [1e-8, 1e-7, 1e-6, 1e-5, 1e-4];

/// The part of a branch to one side of its first point.
struct Side {
    points: Vec<BranchPoint>,
    specials: Vec<SpecialPoint>,
    end: BranchEnd,
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
    /// Follows the branch from a point in its direction.
    fn follow(&self, first: Node) -> Result<Option<Side>, Error> {
        let start = first.clone();
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
                Ok((chain, parameter)) => match self.node(chain, parameter, Some(&node), 1.0) {
                    Ok(next) => Some(next),
                    Err(Missed::Error(error)) => return Err(error),
                    Err(Missed::Unsolved(_)) => None,
                },
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
                if points.len() > FEWEST_OF_CLOSED && self.is_back(&next, &start, step) {
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
        match self.node(chain, end, Some(node), 1.0) {
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
                Ok((chain, parameter)) => match self.node(chain, parameter, Some(&last), 1.0) {
                    Ok(next) => last = next,
                    Err(Missed::Error(error)) => return Err(error),
                    Err(Missed::Unsolved(_)) => {}
                },
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
            // By how much the function of the event, linearised there, changes within the segment.
            let mut size = 0.0_f64;
            flow.each_part(&segment.states, &segment.start, segment.duration, |part| {
                size = size.max(linear.row.dot(&part.powers[0]).abs());
            })
            .ok()?;
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
        let onward = last.sense;
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
        let turns = from.sense != to.sense;
        if turns {
            let is_before = |node: &Node| node.tangent.1 * from.sense > 0.0;
            if let Some(node) = self.bisect(from, distance, &is_before)? {
                specials.push(special(&node, SpecialKind::Fold, place));
            }
        }
        let outside = |least: f64| [from, to].map(|node| growing(&node.orbit, least));
        let [before, after] = outside(1.0 + KNOWN);
        // The magnitude at which a multiplier passes is exactly 1, unless another stays there but for rounding.
        let passed = if outside(1.0) == [before, after] { 1.0 } else { 1.0 + KNOWN };
        for class in 0..before.len() {
            // At a fold one passes 1. A pair that becomes two real ones outside the unit circle, or comes of them, passes
            // nothing.
            let is_fold = turns && class == 0;
            let meets = before[2] != after[2] && sum(before) == sum(after);
            if before[class] == after[class] || is_fold || meets {
                continue;
            }
            let is_before = |node: &Node| growing(&node.orbit, passed)[class] == before[class];
            if let Some(node) = self.bisect(from, distance, &is_before)? {
                let kinds = [
                    SpecialKind::BranchPoint,
                    SpecialKind::PeriodDoubling,
                    SpecialKind::NeimarkSacker,
                ];
                specials.push(special(&node, kinds[class], place));
            }
        }
        Ok(())
    }

    /// `true` if a point of a branch is the one that it began with, again in the same direction.
    fn is_back(&self, node: &Node, start: &Node, step: f64) -> bool {
        let near = SAME_POINT * step;
        (node.parameter - start.parameter).abs() <= near * self.width()
            && node.tangent.1 * start.tangent.1 > 0.0
            && difference(&node.orbit, &start.orbit) <= near
            && has_same_events(&node.orbit, &start.orbit)
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
                Ok((chain, parameter)) => self.node(chain, parameter, Some(from), 1.0),
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

/// Numbers of multipliers with a larger magnitude than `least`: above 1, below −1, and those that are not real.
fn growing(orbit: &Orbit, least: f64) -> [usize; 3] {
    let mut numbers = [0; 3];
    for [re, im] in &orbit.multipliers {
        if libm::hypot(*re, *im) > least {
            numbers[if *im != 0.0 { 2 } else { usize::from(*re < 0.0) }] += 1;
        }
    }
    numbers
}

fn sum(numbers: [usize; 3]) -> usize {
    numbers.iter().sum()
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
