//! One point of a branch from another: the corrector of pseudo-arclength continuation.

use super::Orbit;
use super::branch::Continued;
use super::chain::{Chain, Change, Condensed, Residuals, Unsolved};
use super::check::{Difference, compare};
use super::flow::Flow;
use super::search::orbit;
use amontons::Error;
use amontons::integrator::Event;
use nalgebra::{DMatrix, DVector};

/// Most corrections of a point.
const MOST_CORRECTIONS: usize = 10;
/// Distance of the values by which derivatives by the parameter are taken, in parts of its range.
const APART: f64 = 1e-6;
/// A point is found if its next correction is smaller.
const FOUND: f64 = 1e-11;
/// Corrections this small that no longer fall are rounding.
const ROUNDING: f64 = 1e-8;
/// A parameter that changes by less in a direction of length 1 neither rises nor falls.
const LEVEL: f64 = 1e-6;
/// Values of the parameter farther beyond its range, in parts of it, are not tried.
const BEYOND_RANGE: f64 = 0.05;

/// A point of a branch with its direction.
#[derive(Clone)]
pub(super) struct Node {
    pub(super) chain: Chain,
    pub(super) parameter: f64,
    pub(super) orbit: Orbit,
    /// The direction of the branch, of length 1: first state, in units of the motion's size, and parameter, in units of
    /// its range.
    pub(super) tangent: (DVector<f64>, f64),
    /// 1 where the parameter rises in this direction, −1 where it falls; that of the point before where it does neither but
    /// for rounding, as where a motion meets an event tangentially.
    pub(super) sense: f64,
    /// The change of everything along it.
    pub(super) change: Change,
}

/// Why the next point was not found.
pub(super) enum Missed {
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

impl Continued<'_> {
    pub(super) fn width(&self) -> f64 {
        self.range[1] - self.range[0]
    }

    /// The flow with a value in the range or just beyond: values farther off are not tried, and those that the scene
    /// cannot have are not reached.
    fn flow_near(&self, parameter: f64) -> Result<Flow, Missed> {
        let beyond = f64::max(self.range[0] - parameter, parameter - self.range[1]);
        if beyond > BEYOND_RANGE * self.width() {
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

    /// A solved chain as a point, with its direction: that of the point `before`, or the one in which the parameter has this
    /// sign. Its motion is confirmed beforehand.
    pub(super) fn node(
        &self,
        mut chain: Chain,
        parameter: f64,
        before: Option<&Node>,
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
        let along = before.map(|node| &node.tangent);
        let along = along.filter(|(state, _)| state.len() == motion).unwrap_or(&plain);
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
        let is_level = tangent.1.abs() < LEVEL;
        let sense = before.filter(|_| is_level).map_or(tangent.1.signum(), |node| node.sense);
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
        Ok(Node { chain, parameter, orbit, tangent, sense, change })
    }

    /// The chain at this distance along the branch from a point.
    pub(super) fn correct(&self, from: &Node, distance: f64) -> Result<(Chain, f64), Missed> {
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
    pub(super) fn confirmed(
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

    pub(super) fn is_inside(&self, parameter: f64) -> bool {
        let slack = 1e-12 * self.width();
        self.range[0] - slack <= parameter && parameter <= self.range[1] + slack
    }
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
