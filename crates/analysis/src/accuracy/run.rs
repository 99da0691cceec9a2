//! One run over a grid: all displacements, and the changes of contact states with their times.

use super::grid::{Grid, StepCandidate};
use crate::statistics::{place_of_largest, variance};
use crate::watch::Watch;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::integrator::Statistics;
use amontons::scene::{Method, Scene};
use amontons::simulation::{Simulation, Snapshot};

/// An interval of up to this number of steps is searched step by step; a longer one is halved until the step is
/// found.
const WALKED: u64 = 32;
/// The event-driven integrator's step is halved into this number of parts, which is the accuracy of its event times;
/// a simulation ignores a millionth of its step.
const PARTS: u64 = 1 << 18;

/// A contact takes another state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateChange {
    /// The contact, from 0.
    pub contact: usize,
    /// The state that it takes.
    pub state: ContactState,
    /// Time of the change, s: the end of the step in which it happens, or of the part of one.
    pub time: f64,
}

/// The recorded data of a run.
pub(super) struct AccuracyRun {
    pub(super) statistics: Statistics,
    dofs: usize,
    /// One row of displacements for each interval, the start among them.
    displacements: Vec<f64>,
    changes: Vec<StateChange>,
}

impl AccuracyRun {
    /// Runs a scene; `None` if the watch ended it.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn of(
        scene: &Scene,
        grid: Grid,
        candidate: StepCandidate,
        watch: Watch<'_>,
    ) -> Result<Option<Self>, Error> {
        let mut simulation = Simulation::new(candidate.scene(scene), 0.0)?;
        let mut changes = Vec::new();
        let mut displacements = simulation.displacement().to_vec();
        let dofs = displacements.len();
        for interval in 0..grid.intervals {
            if watch.ends_after(interval as f64 / grid.intervals as f64) {
                return Ok(None);
            }
            let first = interval * candidate.steps;
            let parts = if candidate.method == Method::EventDriven { PARTS } else { 1 };
            let (from, to) = (first, first + candidate.steps);
            let steps = Units { origin: 0.0, length: candidate.step, from, to, parts };
            if candidate.method == Method::ForwardIncrement && candidate.steps <= WALKED {
                steps.walk(&mut simulation, &mut changes)?;
            } else {
                let before = simulation.save();
                let count = simulation.statistics().state_changes();
                simulation.advance_to(grid.time(interval + 1))?;
                let count = simulation.statistics().state_changes() - count;
                if count > 0 {
                    let after = simulation.save();
                    steps.search(&mut simulation, &before, count, &mut changes)?;
                    simulation.restore(&after)?;
                }
            }
            displacements.extend_from_slice(simulation.displacement());
        }
        Ok(Some(Self { statistics: simulation.statistics(), dofs, displacements, changes }))
    }

    /// Resolution of the times of state changes, s, with the event-driven integrator at this step (s).
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn resolution(step: f64) -> f64 {
        step / PARTS as f64
    }

    pub(super) fn changes(&self) -> &[StateChange] {
        &self.changes
    }

    /// One displacement over time, m.
    pub(super) fn history(&self, dof: usize) -> Vec<f64> {
        self.displacements.iter().skip(dof).step_by(self.dofs).copied().collect()
    }

    /// All displacements about their means, root mean square, m.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn deviation(&self) -> f64 {
        (self.variances().iter().sum::<f64>() / self.dofs.max(1) as f64).sqrt()
    }

    /// Variance of each displacement, m².
    fn variances(&self) -> Vec<f64> {
        (0..self.dofs).map(|dof| variance(&self.history(dof))).collect()
    }

    /// The degree of freedom that moves most.
    pub(super) fn most_moving(&self) -> usize {
        place_of_largest(&self.variances()).unwrap_or(0)
    }

    /// All displacements against those of another run, root mean square, m.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let both = self.displacements.iter().zip(&other.displacements);
        let squares = both.fold(0.0, |sum, (a, b)| sum + (a - b) * (a - b));
        (squares / self.displacements.len().max(1) as f64).sqrt()
    }

    /// Distance between the times of state changes and those of another run, s: root mean square and largest; `None`
    /// unless each contact goes through the same states, or if there are no changes.
    #[allow(clippy::cast_precision_loss)]
    pub(super) fn event_times_apart(&self, other: &Self) -> Option<[f64; 2]> {
        let sorted = |run: &Self| {
            let mut changes = run.changes.clone();
            // Stable: those of one contact stay in their order.
            changes.sort_by_key(|change| change.contact);
            changes
        };
        let (ours, theirs) = (sorted(self), sorted(other));
        let same =
            |(a, b): (&StateChange, &StateChange)| (a.contact, a.state) == (b.contact, b.state);
        if ours.len() != theirs.len() || ours.is_empty() || !ours.iter().zip(&theirs).all(same) {
            return None;
        }
        let apart = ours.iter().zip(&theirs).map(|(a, b)| (a.time - b.time).abs());
        let (sum, largest) =
            apart.fold((0.0, 0.0), |(sum, most), t| (sum + t * t, f64::max(most, t)));
        Some([(sum / ours.len() as f64).sqrt(), largest])
    }
}

/// Equal units of time, steps or parts of one.
#[derive(Clone, Copy)]
struct Units {
    /// Time at which unit 0 begins, s.
    origin: f64,
    /// Length of a unit, s.
    length: f64,
    from: u64,
    to: u64,
    /// Number of parts into which a unit itself is divided.
    parts: u64,
}

impl Units {
    #[allow(clippy::cast_precision_loss)]
    fn time(&self, unit: u64) -> f64 {
        self.origin + unit as f64 * self.length
    }

    /// Goes through all of them.
    fn walk(
        &self,
        simulation: &mut Simulation,
        changes: &mut Vec<StateChange>,
    ) -> Result<(), Error> {
        let mut before = simulation.contact_states().to_vec();
        for unit in self.from..self.to {
            simulation.advance_to(self.time(unit + 1))?;
            note(simulation, &mut before, self.time(unit + 1), changes);
        }
        Ok(())
    }

    /// Finds the units in which contacts change their states, `count` times in all, by halving; `start` is
    /// the motion at the first one's beginning.
    #[allow(clippy::cast_precision_loss)]
    fn search(
        &self,
        simulation: &mut Simulation,
        start: &Snapshot,
        count: u64,
        changes: &mut Vec<StateChange>,
    ) -> Result<(), Error> {
        simulation.restore(start)?;
        if self.to - self.from == 1 {
            if self.parts == 1 {
                return self.walk(simulation, changes);
            }
            let (origin, length) = (self.time(self.from), self.length / self.parts as f64);
            let parts = Self { origin, length, from: 0, to: self.parts, parts: 1 };
            return parts.search(simulation, start, count, changes);
        }
        let middle = self.from + (self.to - self.from) / 2;
        let before = simulation.statistics().state_changes();
        simulation.advance_to(self.time(middle))?;
        let first = simulation.statistics().state_changes() - before;
        let half = (first < count).then(|| simulation.save());
        if first > 0 {
            Self { to: middle, ..*self }.search(simulation, start, first, changes)?;
        }
        match half {
            Some(half) => {
                Self { from: middle, ..*self }.search(simulation, &half, count - first, changes)
            }
            None => Ok(()),
        }
    }
}

/// Takes note of the contacts whose state is not that of before.
fn note(
    simulation: &Simulation,
    before: &mut [ContactState],
    time: f64,
    changes: &mut Vec<StateChange>,
) {
    for (contact, (old, &state)) in before.iter_mut().zip(simulation.contact_states()).enumerate() {
        if std::mem::replace(old, state) != state {
            changes.push(StateChange { contact, state, time });
        }
    }
}
