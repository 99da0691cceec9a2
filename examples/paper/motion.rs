//! A motion row by row, with what of it falls between the rows.

use amontons::Error;
use amontons::contact::ContactState;
use amontons::scene::Scene;
use amontons::simulation::Simulation;
use amontons_analysis::study::Watch;

/// s between two rows: 200 in a period of the fastest mode, which any sticking of the paper's motions outlasts.
pub const INTERVAL: f64 = 2e-5;
/// Rows between two questions whether the work is to end.
const ROWS_AT_ONCE: usize = 1000;
/// A motion is pushed by this part of its largest velocity.
const PUSH: f64 = 0.01;

/// Rows of a motion of two contacts.
pub struct Motion {
    simulation: Simulation,
    /// Displacement of the first degree of freedom, m; one row each [`INTERVAL`], from time 0 on.
    pub history: Vec<f64>,
    /// The contacts' states.
    pub states: Vec<[ContactState; 2]>,
    /// How often contacts had changed their state up to each row, changes between the rows included.
    pub changes: Vec<u64>,
}

impl Motion {
    /// At the start of a scene of two contacts.
    ///
    /// # Errors
    /// What is wrong with the scene.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        let simulation = Simulation::new(Scene { step: INTERVAL, ..scene.clone() }, 0.0)?;
        let mut motion =
            Self { simulation, history: Vec::new(), states: Vec::new(), changes: Vec::new() };
        motion.note();
        Ok(motion)
    }

    /// Records up to time `end` (s); `false` where the watch ended it.
    ///
    /// # Errors
    /// A run that fails.
    pub fn record(&mut self, end: f64, watch: Watch<'_>) -> Result<bool, Error> {
        for row in self.history.len()..=Self::row(end) {
            if row % ROWS_AT_ONCE == 0 {
                if (watch.go_on)().is_break() {
                    return Ok(false);
                }
                (watch.progress)(row as f64 * INTERVAL / end);
            }
            self.simulation.advance_to(row as f64 * INTERVAL)?;
            self.note();
        }
        Ok(true)
    }

    /// Pushes the motion a little.
    pub fn push(&mut self) {
        let fastest =
            self.simulation.velocity().iter().fold(0.0, |most, v| f64::max(most, v.abs()));
        self.simulation.push(0, PUSH * fastest);
    }

    /// The row at a time (s).
    pub fn row(time: f64) -> usize {
        (time / INTERVAL).round() as usize
    }

    /// The displacements from a time to another, s; fewer where the record ends before.
    pub fn between(&self, from: f64, to: f64) -> &[f64] {
        let end = Self::row(to).min(self.history.len());
        &self.history[Self::row(from).min(end)..end]
    }

    /// The states from a time to another, s.
    pub fn states_between(&self, from: f64, to: f64) -> &[[ContactState; 2]] {
        let end = Self::row(to).min(self.states.len());
        &self.states[Self::row(from).min(end)..end]
    }

    /// How many changes of state between two times (s) no row shows.
    pub fn hidden_changes(&self, from: f64, to: f64) -> u64 {
        let rows = self.states_between(from, to);
        let differ = |pair: &[[ContactState; 2]]| {
            u64::from(pair[0][0] != pair[1][0]) + u64::from(pair[0][1] != pair[1][1])
        };
        let seen: u64 = rows.windows(2).map(differ).sum();
        match rows.len() {
            0 => 0,
            count => {
                let first = Self::row(from);
                self.changes[first + count - 1] - self.changes[first] - seen
            }
        }
    }

    /// The time (s) of the first change of state; `None` where there is none.
    pub fn first_change(&self) -> Option<f64> {
        let row = self.changes.iter().position(|changes| *changes > 0)?;
        Some(row as f64 * INTERVAL)
    }

    fn note(&mut self) {
        let states = self.simulation.contact_states();
        self.history.push(self.simulation.displacement()[0]);
        self.states.push([states[0], states[1]]);
        self.changes.push(self.simulation.statistics().entered.iter().sum());
    }
}
