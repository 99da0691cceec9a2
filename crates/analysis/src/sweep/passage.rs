//! Analysis of a motion between rows: the time that contacts are in each state, and the smallest and largest values
//! of outputs. Changes of contact states and turning points between two rows are located in the motion itself, so
//! none of this depends on the positions of the rows.
//!
//! When a contact changes its state or lands, a value has a kink, beside which no polynomial through rows holds. So a
//! span between two rows is halved until nothing changes in it. There a displacement is a cubic through its values
//! and velocities.

use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::{Method, Scene};
use amontons::simulation::{Simulation, Snapshot, Variable};

/// A span with a change of contact state is halved this often: its instant is then known to 1e-5 of a row.
const CHANGE_DEPTH: u32 = 16;
/// A span with a turn of a displacement is halved this often: of the 1/20 of a period that a row is at the most the cubic
/// is then off by 1e-7 of the amplitude.
const TURN_DEPTH: u32 = 2;
/// A span in which another output may have its extreme value is halved this often.
const OTHER_DEPTH: u32 = 12;
/// Relative accuracy of the cubic's contribution beyond the values beside it.
const CUBIC: f64 = 0.01;
/// A change of an extreme value by less than this part of the range is ignored.
const NOTHING: f64 = 1e-9;

/// A quantity that is followed.
enum FollowedQuantity {
    /// The displacement of a degree of freedom, whose velocity is known.
    Displacement(usize),
    Other(Variable),
}

/// The motion at one instant.
struct PassagePoint {
    saved: Snapshot,
    /// Time, s.
    time: f64,
    /// The followed quantities, in their units, and the rates of displacements, m/s.
    values: Vec<f64>,
    rates: Vec<Option<f64>>,
    states: Vec<ContactState>,
    /// Number of changes of state and landings of contacts since the start: a contact that is thrown off at its
    /// landing keeps its state.
    changes: u64,
}

/// A simulation followed row by row.
pub(crate) struct Passage {
    followed: Vec<FollowedQuantity>,
    /// A simulation that looks between the rows.
    scout: Option<Simulation>,
    last: Option<PassagePoint>,
    /// Change of each value over the span before, or less.
    slack: Vec<f64>,
    extremes: Vec<[f64; 2]>,
    /// Time in each state, s, all contacts together.
    dwell: [f64; 4],
}

impl Passage {
    /// Follows these outputs of a scene.
    pub(crate) fn new(scene: &Scene, outputs: &[Variable]) -> Self {
        let dofs = scene.dof_names();
        let followed = |output: &Variable| {
            let dof = dofs.iter().position(|name| *name == output.name);
            dof.map_or_else(
                || FollowedQuantity::Other(output.clone()),
                FollowedQuantity::Displacement,
            )
        };
        Self {
            followed: outputs.iter().map(followed).collect(),
            scout: None,
            last: None,
            slack: Vec::new(),
            extremes: Vec::new(),
            dwell: [0.0; 4],
        }
    }

    /// Follows all displacements, too, after the outputs.
    pub(crate) fn with_displacements(mut self, dofs: usize) -> Self {
        self.followed.extend((0..dofs).map(FollowedQuantity::Displacement));
        self
    }

    /// Takes note of the next row.
    ///
    /// # Errors
    /// Returns an error if a step between the rows fails.
    pub(crate) fn note(&mut self, simulation: &mut Simulation) -> Result<(), Error> {
        let now = self.point(simulation)?;
        let Some(before) = self.last.take() else {
            self.extremes = now.values.iter().map(|value| [*value; 2]).collect();
            self.slack = vec![0.0; now.values.len()];
            self.last = Some(now);
            return Ok(());
        };
        let mut scout = match self.scout.take() {
            Some(scout) => scout,
            None => Simulation::resume(before.saved.clone())?,
        };
        let change = changes(&before, &now);
        let slack: Vec<f64> = change.iter().zip(&self.slack).map(|(a, b)| a.max(*b)).collect();
        self.slack = change;
        self.pass(&mut scout, &before, &now, &slack, 0)?;
        (self.scout, self.last) = (Some(scout), Some(now));
        Ok(())
    }

    /// Half of the difference between the largest and the smallest value of each output, in its unit.
    pub(crate) fn amplitudes(&self) -> impl Iterator<Item = f64> {
        self.extremes.iter().map(|[least, most]| 0.5 * (most - least))
    }

    /// The part of the time for which contacts are in each state, in the order of [`ContactState::ALL`], all contacts
    /// together.
    pub(crate) fn shares(&self) -> [f64; 4] {
        let all: f64 = self.dwell.iter().sum();
        self.dwell.map(|dwell| if all > 0.0 { dwell / all } else { 0.0 })
    }

    fn point(&self, simulation: &mut Simulation) -> Result<PassagePoint, Error> {
        let (mut values, mut rates) = (Vec::new(), Vec::new());
        for followed in &self.followed {
            match followed {
                FollowedQuantity::Displacement(dof) => {
                    values.push(simulation.displacement()[*dof]);
                    rates.push(Some(simulation.velocity()[*dof]));
                }
                FollowedQuantity::Other(output) => {
                    values.push(simulation.read(output)?);
                    rates.push(None);
                }
            }
        }
        let statistics = simulation.statistics();
        Ok(PassagePoint {
            saved: simulation.save(),
            time: simulation.time(),
            values,
            rates,
            states: simulation.contact_states().to_vec(),
            changes: statistics.state_changes() + statistics.touch_downs,
        })
    }

    /// Looks at the span between two points, halved so often before. Beyond its ends another output than a displacement
    /// may change by as much as `slack`.
    fn pass(
        &mut self,
        scout: &mut Simulation,
        before: &PassagePoint,
        now: &PassagePoint,
        slack: &[f64],
        depth: u32,
    ) -> Result<(), Error> {
        for (extreme, value) in self.extremes.iter_mut().zip(&now.values) {
            *extreme = [extreme[0].min(*value), extreme[1].max(*value)];
        }
        let is_changed = before.changes != now.changes;
        let span = now.time - before.time;
        let scene = scout.scene();
        let (is_stepped, step) = (scene.method == Method::ForwardIncrement, scene.step);
        // Between its steps the paper's scheme has no motion.
        let is_whole = is_stepped && span <= step * (1.0 + 1e-6);
        let is_split = !is_whole
            && (is_changed && depth < CHANGE_DEPTH
                || self.may_turn(before, now, slack, depth, is_stepped));
        if is_split {
            let half =
                if is_stepped { (0.5 * span / step).round().max(1.0) * step } else { 0.5 * span };
            scout.restore(&before.saved)?;
            scout.advance_to(before.time + half)?;
            let middle = self.point(scout)?;
            for (from, to) in [(before, &middle), (&middle, now)] {
                let slack: Vec<f64> =
                    changes(from, to).iter().zip(slack).map(|(a, b)| a.max(0.5 * b)).collect();
                self.pass(scout, from, to, &slack, depth + 1)?;
            }
            return Ok(());
        }
        for (was, is) in before.states.iter().zip(&now.states) {
            let was = if is_changed { was } else { is };
            self.dwell[*was as usize - 1] += 0.5 * span;
            self.dwell[*is as usize - 1] += 0.5 * span;
        }
        if !is_stepped {
            for place in 0..self.followed.len() {
                if let Some(turn) = turn(before, now, place, is_changed) {
                    let [least, most] = self.extremes[place];
                    self.extremes[place] = [least.min(turn), most.max(turn)];
                }
            }
        }
        Ok(())
    }

    /// `true` if a value may turn in this span where it is smaller or larger than it was ever seen, as far as that is
    /// not known yet.
    fn may_turn(
        &self,
        before: &PassagePoint,
        now: &PassagePoint,
        slack: &[f64],
        depth: u32,
        is_stepped: bool,
    ) -> bool {
        (0..self.followed.len()).any(|place| {
            let [least, most] = self.extremes[place];
            let nothing = NOTHING * (most - least);
            let ends = [before.values[place], now.values[place]];
            let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            if before.rates[place].is_some() {
                let Some(turn) = turn(before, now, place, false) else { return false };
                let beyond = (1.0 + CUBIC) * (turn - high).max(low - turn);
                (is_stepped || depth < TURN_DEPTH)
                    && (high + beyond > most + nothing || low - beyond < least - nothing)
            } else {
                let slack = slack[place];
                depth < OTHER_DEPTH
                    && slack > nothing
                    && (high + slack > most + nothing && high >= most - slack
                        || low - slack < least - nothing && low <= least + slack)
            }
        })
    }
}

/// Change of each value.
fn changes(before: &PassagePoint, now: &PassagePoint) -> Vec<f64> {
    before.values.iter().zip(&now.values).map(|(before, now)| (now - before).abs()).collect()
}

/// The value at which a displacement turns between two points, m: of the cubic through its values and velocities or,
/// where a kink lies between them, of the two tangents. `None` where it does not turn.
fn turn(before: &PassagePoint, now: &PassagePoint, place: usize, has_kink: bool) -> Option<f64> {
    let [from, to] = [before.rates[place]?, now.rates[place]?];
    if from * to >= 0.0 {
        return None;
    }
    let span = now.time - before.time;
    let (start, end) = (before.values[place], now.values[place]);
    if has_kink {
        let time = (end - start - to * span) / (from - to);
        return Some(start + from * time.clamp(0.0, span));
    }
    // In parts of the span: start + from·s + second·s² + third·s³.
    let [from, to, rise] = [from * span, to * span, end - start];
    let (second, third) = (3.0 * rise - 2.0 * from - to, from + to - 2.0 * rise);
    let value = |s: f64| start + s * (from + s * (second + s * third));
    // A quadratic whose values at both ends have opposite signs has one root between them.
    let root = (second * second - 3.0 * third * from).max(0.0).sqrt();
    let q = -(second + root.copysign(second));
    let roots = [from / q, q / (3.0 * third)];
    roots.into_iter().find(|s| (0.0..=1.0).contains(s)).map(value)
}
